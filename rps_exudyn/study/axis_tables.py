"""The `[[axis]]` tables of a study file: what is varied, over which values or distribution."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from rps_exudyn.base.units import short, shown, to_si
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.distribution import KINDS
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.study.definition import Axis, Value
from rps_exudyn.study.toml_keys import Keys

SHAPES = ("values", "linspace", "logspace")
DISTRIBUTIONS = tuple(KINDS)
AXIS_KEYS = ("name", "path", "paths", "unit", "along", *SHAPES, *DISTRIBUTIONS)
NOT_AXES = ("hash", "status", "message", "codes", "cpu_s", "wall_s", "bytes", "modified_ns", "case", "sample")
"""Names that tables of results need for themselves."""
MOST_ON_AN_AXIS = 100_000


def read_axes(keys: Keys, tables: Any, grid: bool) -> tuple[Axis, ...]:
    """The axes without mistakes, of a grid or of a sampled design; mistakes are added to `keys`."""
    if not isinstance(tables, list) or not all(isinstance(table, Mapping) for table in tables):
        keys.wrong("axis", "must be tables, each under [[axis]].")
        return ()
    if not tables:
        keys.wrong("axis", "is missing: a study varies something; add an [[axis]].")
    axes = [_axis(keys, table, f"axis {number}", grid) for number, table in enumerate(tables, 1)]
    return tuple(axis for axis in axes if axis)


def check_twice(keys: Keys, axes: tuple[Axis, ...], settings: Mapping[str, Any]) -> None:
    """Add to `keys` every name or path that is given twice: by two axes, or by an axis and [set]."""
    seen: dict[str, str] = dict.fromkeys(settings, "[set]")
    names: set[str] = set()
    for axis in axes:
        if axis.name in names:
            keys.wrong("axis", f"{axis.name} is given twice; rename one of them.")
        names.add(axis.name)
        for path in (*axis.paths, *axis.along):
            if path in seen:
                keys.wrong(f"axis {axis.name}", f"varies {path}, which is also given by {seen[path]}.")
            seen[path] = f"axis {axis.name}"


def _axis(keys: Keys, table: Mapping[str, Any], where: str, grid: bool) -> Axis | None:
    before = len(keys.problems)
    for key in table.keys() - set(AXIS_KEYS):
        keys.wrong(where, f"has {short(key)}, which is no key of an axis; there are {', '.join(AXIS_KEYS)}.")
    paths = _paths(keys, table, where)
    shape = _shape(keys, table, where, grid)
    name = _name(keys, table, where, paths)
    if len(keys.problems) > before:
        return None
    declared = keys.declared[paths[0]]
    unit = keys.text(table, "unit", declared.unit.display if declared.unit else "")
    along = _along(keys, table, f"{where} ({name})")
    quantity = _Quantity(keys, f"{where} ({name})", declared, table.get("unit"))
    values, distribution = None, {}
    if shape in DISTRIBUTIONS:
        distribution = {"kind": shape, "numbers": _distribution(table[shape], shape, quantity)}
    else:
        values = (_listed if shape == "values" else _spaced)(table[shape], shape, quantity)
    for path, moved in along.items():
        if values is None or len(moved) != len(values):
            keys.wrong(
                where, f"moves {path} along with {len(moved)} values; it needs one for each of its own."
            )
    if len(keys.problems) > before:
        return None
    return Axis(name, paths, unit, values, "sampled" if distribution else "grid", along, distribution)


def _paths(keys: Keys, table: Mapping[str, Any], where: str) -> tuple[str, ...]:
    if ("path" in table) == ("paths" in table):
        keys.wrong(where, "needs path or paths: the parameters that it varies.")
        return ()
    paths = table.get("paths", [table.get("path")])
    if not isinstance(paths, list) or not paths:
        keys.wrong(f"{where}.paths", f"is {shown(paths)}; it must be a list of parameters.")
        return ()
    known = tuple(path for path in paths if keys.is_parameter(path, where))
    if len({keys.declared[path].unit for path in known}) > 1:
        keys.wrong(where, f"gives one value to {', '.join(known)}, which have different units; use along.")
    return known


def _shape(keys: Keys, table: Mapping[str, Any], where: str, grid: bool) -> str:
    """The one key among SHAPES and DISTRIBUTIONS; "" if it is wrong."""
    given = [key for key in (*SHAPES, *DISTRIBUTIONS) if key in table]
    if len(given) != 1:
        found = " and ".join(given) or "none"
        keys.wrong(where, f"needs exactly one of {', '.join((*SHAPES, *DISTRIBUTIONS))}; it has {found}.")
        return ""
    if grid and given[0] in DISTRIBUTIONS:
        keys.wrong(
            where, f"has {given[0]}, which only a sampled design draws from; a grid takes {_or(SHAPES)}."
        )
    elif not grid and given[0] not in (*DISTRIBUTIONS, "values"):
        keys.wrong(where, f"has {given[0]}; a sampled design draws from {_or((*DISTRIBUTIONS, 'values'))}.")
    return given[0]


def _name(keys: Keys, table: Mapping[str, Any], where: str, paths: tuple[str, ...]) -> str:
    name = keys.text(table, "name", paths[0] if paths else where)
    taken = name in NOT_AXES or name in SIGNALS or name in SUMMARY
    if not name or taken or "/" in name or not name.strip(".") or not name.isprintable():
        keys.wrong(
            f"{where}.name",
            f"is {shown(name)}; it must be another word than {', '.join(NOT_AXES)}, no quantity of a "
            "result, and without /.",
        )
    return name


def _along(keys: Keys, table: Mapping[str, Any], where: str) -> dict[str, tuple[Value, ...]]:
    """Path -> values of the parameters that move along with the axis."""
    found = {}
    for path, values in keys.flat(keys.table(table, "along"), where).items():
        if not isinstance(values, list) or not values:
            keys.wrong(where, f"moves {path} along by {shown(values)}; it must be a list of values.")
        else:
            quantity = _Quantity(keys, f"{where} along {path}", keys.declared[path], None)
            found[path] = tuple(quantity.value(value) for value in values)
    return found


@dataclass(frozen=True)
class _Quantity:
    """Reads values of one parameter: text with unit, numbers in the axis' unit, or words."""

    keys: Keys
    where: str
    declared: Declared
    unit: Any

    def wrong(self, sentence: str) -> None:
        self.keys.wrong(self.where, sentence)

    def value(self, given: Any) -> Value:
        """SI; a choice's word or a whole number stays unmodified."""
        if get_args(self.declared.field.annotation) or self.declared.field.annotation is int:
            return given if isinstance(given, str | int) else self.number(given)
        return self.number(given)

    def plain(self, given: Any) -> float:
        """A number without unit: the factor of a log-normal distribution."""
        try:
            return to_si(given, "")
        except ValueError as error:
            self.wrong(f"{error}.")
            return np.nan

    def number(self, given: Any) -> float:
        if self.declared.unit and self.declared.unit.zero and given == self.declared.unit.zero:
            return 0.0
        si = self.declared.unit.si if self.declared.unit else ""
        try:
            if self.unit is not None and isinstance(given, int | float) and not isinstance(given, bool):
                return to_si(f"{given!r} {self.unit}".strip(), si)
            value = to_si(given, si)
        except ValueError as error:
            self.wrong(f"{error}.")
            return np.nan
        if not np.isfinite(value):
            self.wrong(f"is {shown(given)}; it must be finite.")
        return value


def _listed(given: Any, shape: str, quantity: _Quantity) -> tuple[Value, ...]:
    if not isinstance(given, list):
        quantity.wrong(f"has {shape} = {shown(given)}; it must be a list.")
        return ()
    if not given:
        quantity.wrong("is empty; values needs at least one.")
    if len(given) > MOST_ON_AN_AXIS:
        quantity.wrong(f"has {len(given)} values (limit {MOST_ON_AN_AXIS}).")
        return ()
    values = tuple(quantity.value(item) for item in given)
    if len(set(values)) < len(values):
        quantity.wrong("has a value twice.")
    return values


def _spaced(given: Any, shape: str, quantity: _Quantity) -> tuple[float, ...]:
    """Even steps (linspace) or even ratios (logspace) from [first, last, number]."""
    count = given[2] if isinstance(given, list) and len(given) == 3 else None
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST_ON_AN_AXIS:
        quantity.wrong(
            f"has {shape} = {shown(given)}; it must be [first, last, number] with a number from 2 to "
            f"{MOST_ON_AN_AXIS}."
        )
        return ()
    first, last = quantity.number(given[0]), quantity.number(given[1])
    if shape == "logspace" and not (first > 0 and last > 0):
        quantity.wrong(f"has logspace = {shown(given)}; both ends must be above 0.")
        return ()
    if first == last:
        quantity.wrong(f"has {shape} = {shown(given)}; its ends must differ.")
    spaced = np.linspace(first, last, count) if shape == "linspace" else np.geomspace(first, last, count)
    return tuple(float(f"{value:.12g}") for value in spaced)  # 0.3, not 0.30000000000000004


def _distribution(given: Any, shape: str, quantity: _Quantity) -> list[float]:
    if not isinstance(given, list):
        quantity.wrong(f"has {shape} = {shown(given)}; it must be a list.")
    elif len(given) != 2:
        quantity.wrong(f"has {shape} of {len(given)} items; it must be {KINDS[shape].numbers}.")
    else:
        first = quantity.number(given[0])
        second = quantity.plain(given[1]) if shape == "lognormal" else quantity.number(given[1])
        if not KINDS[shape].drawable(first, second):
            quantity.wrong(f"has {shape} = {shown(given)}; it must be {KINDS[shape].numbers}.")
        return [first, second]
    return []


def _or(words: tuple[str, ...]) -> str:
    return ", ".join(words[:-1]) + " or " + words[-1]
