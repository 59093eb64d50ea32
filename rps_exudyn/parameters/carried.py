"""The distributions that the parameters of a gear carry, in its file or in settings."""

from collections.abc import Mapping
from operator import ge, gt, le, lt
from typing import Any

from annotated_types import Ge, Gt, Le, Lt

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.distribution import Distribution, is_distribution
from rps_exudyn.parameters.gear import SteeringGear

_HOLDS = ((Gt, "gt", gt), (Ge, "ge", ge), (Lt, "lt", lt), (Le, "le", le))


def carried(tables: Mapping[str, Any], settings: Mapping[str, Any]) -> dict[str, Distribution]:
    """Return path -> distribution of the gear's parameters that have one; settings come before tables.

    Raises:
        InputError: distributions that cannot be, or that leave what their parameters allow (all at once).
    """
    found, problems = {}, []
    for item in SteeringGear.declared():
        value = settings.get(item.path, _at(tables, item.path))
        if item.unit is None or not is_distribution(value):
            continue
        try:
            found[item.path] = Distribution.read(value, item.unit.si)
        except ValueError as error:
            problems.append(f"{item.path} {error}.")
            continue
        problems += outside(item, found[item.path])
    if problems:
        raise InputError(problems)
    return found


def outside(item: Declared, distribution: Distribution) -> list[str]:
    """Return a sentence if an end of the distribution is not allowed for the parameter; none otherwise."""
    for end in distribution.ends:
        if not _allows(item, end):
            return [
                f"the distribution of {item.path} reaches {item.show(end)}; {item.path} must be "
                f"{item.allowed}."
            ]
    return []


def _allows(item: Declared, value: float) -> bool:
    """Return whether a number in SI is within the parameter's limits."""
    return all(
        holds(value, getattr(limit, attribute))
        for kind, attribute, holds in _HOLDS
        for limit in item.field.metadata
        if isinstance(limit, kind)
    )


def _at(tables: Mapping[str, Any], path: str) -> Any:
    """Return what nested tables have at a dotted path, None without it."""
    value: Any = tables
    for name in path.split("."):
        value = value.get(name) if isinstance(value, Mapping) else None
    return value
