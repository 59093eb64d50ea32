"""The `[[axis]]` tables of a study file: what is varied, over which values or distribution."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from rps_exudyn.base.units import short, shown, to_si
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.study.description import Axis, Value
from rps_exudyn.study.toml_keys import Keys

SHAPES = ("values", "linspace", "logspace")
DISTRIBUTIONS = ("uniform", "loguniform", "normal")
AXIS_KEYS = ("name", "path", "paths", "unit", "along", *SHAPES, *DISTRIBUTIONS)
NOT_AXES = ("hash", "status", "message", "cpu_s", "wall_s", "bytes", "modified_ns", "case", "sample")
"""Names that tables of results need for themselves."""
MOST_ON_AN_AXIS = 100_000


def read_axes(keys: Keys, told: Any, grid: bool) -> tuple[Axis, ...]:
    """Those that are right; `grid` tells the axes of a grid from those of a sampled design."""
    if not isinstance(told, list) or not all(isinstance(item, Mapping) for item in told):
        keys.wrong("axis", "must be tables, each under [[axis]].")
        return ()
    if not told:
        keys.wrong("axis", "is missing: a study varies something; add an [[axis]].")
    axes = [_axis(keys, item, f"axis {number}", grid) for number, item in enumerate(told, 1)]
    return tuple(axis for axis in axes if axis)


def _axis(keys: Keys, told: Mapping[str, Any], where: str, grid: bool) -> Axis | None:
    before = len(keys.problems)
    for key in told.keys() - set(AXIS_KEYS):
        keys.wrong(
            where,
            f"has {short(key)}, which is no key of an axis; there are {', '.join(AXIS_KEYS)}.",
        )
    paths = _paths(keys, told, where)
    shapes = [key for key in (*SHAPES, *DISTRIBUTIONS) if key in told]
    if len(shapes) != 1:
        found = " and ".join(shapes) or "none"
        keys.wrong(where, f"needs exactly one of {', '.join((*SHAPES, *DISTRIBUTIONS))}; it has {found}.")
    elif grid and shapes[0] in DISTRIBUTIONS:
        keys.wrong(
            where, f"has {shapes[0]}, which only a sampled design draws from; a grid takes {_or(SHAPES)}."
        )
    elif not grid and shapes[0] not in (*DISTRIBUTIONS, "values"):
        keys.wrong(where, f"has {shapes[0]}; a sampled design draws from {_or((*DISTRIBUTIONS, 'values'))}.")
    name = keys.text(told, "name", paths[0] if paths else where)
    taken = name in NOT_AXES or name in SIGNALS or name in SUMMARY
    if not name or taken or "/" in name or not name.strip(".") or not name.isprintable():
        keys.wrong(
            f"{where}.name",
            f"is {shown(name)}; it must be another word than {', '.join(NOT_AXES)}, no quantity of a "
            "result, and without /.",
        )
    if len(keys.problems) > before:
        return None
    declared = keys.declared[paths[0]]
    unit = keys.text(told, "unit", declared.unit.display if declared.unit else "")
    quantity = _Quantity(keys, f"{where} ({name})", declared, told.get("unit"))
    along = _along(keys, told, f"{where} ({name})")
    axis = _varied(name, paths, unit, told, shapes[0], quantity, along)
    for path, values in along.items():
        if axis.values is None or len(values) != len(axis.values):
            keys.wrong(
                where, f"moves {path} along with {len(values)} values; it needs one for each of its own."
            )
    return axis if len(keys.problems) == before else None


def _paths(keys: Keys, told: Mapping[str, Any], where: str) -> tuple[str, ...]:
    if ("path" in told) == ("paths" in told):
        keys.wrong(where, "needs either path or paths: what it varies.")
        return ()
    paths = told.get("paths", [told.get("path")])
    if not isinstance(paths, list) or not paths:
        keys.wrong(f"{where}.paths", f"is {shown(paths)}; it must be a list of parameters.")
        return ()
    known = tuple(path for path in paths if keys.is_parameter(path, where))
    kinds = {keys.declared[path].unit for path in known}
    if len(kinds) > 1:
        keys.wrong(where, f"gives one value to {', '.join(known)}, which have different units; use along.")
    return known


def _along(keys: Keys, told: Mapping[str, Any], where: str) -> dict[str, tuple[Value, ...]]:
    found = {}
    for path, values in _flat_lists(keys, keys.table(told, "along"), where).items():
        quantity = _Quantity(keys, f"{where} along {path}", keys.declared[path], None)
        found[path] = tuple(quantity.value(value) for value in values)
    return found


def _flat_lists(keys: Keys, told: Mapping[str, Any], where: str) -> dict[str, list[Any]]:
    found = keys.flat(told, where)
    for path, values in found.items():
        if not isinstance(values, list) or not values:
            keys.wrong(where, f"moves {path} along by {shown(values)}; it must be a list of values.")
    return {path: values for path, values in found.items() if isinstance(values, list)}


def check_twice(keys: Keys, axes: tuple[Axis, ...], settings: Mapping[str, Any]) -> None:
    """Nothing may be said twice: a path on two axes, or on an axis and in [set]."""
    seen: dict[str, str] = dict.fromkeys(settings, "[set]")
    names: set[str] = set()
    for axis in axes:
        if axis.name in names:
            keys.wrong("axis", f"{axis.name} is there twice; give one of them another name.")
        names.add(axis.name)
        for path in (*axis.paths, *axis.along):
            if path in seen:
                keys.wrong(f"axis {axis.name}", f"varies {path}, which is also given by {seen[path]}.")
            seen[path] = f"axis {axis.name}"


@dataclass(frozen=True)
class _Quantity:
    """Reads the values of one parameter: text with unit, numbers in the axis' unit, or words."""

    keys: Keys
    where: str
    declared: Declared
    unit: Any

    def value(self, given: Any) -> Value:
        """SI."""
        if get_args(self.declared.field.annotation) or self.declared.field.annotation is int:
            return given if isinstance(given, str | int) else self.number(given)
        return self.number(given)

    def number(self, given: Any) -> float:
        si = self.declared.unit.si if self.declared.unit else ""
        try:
            if self.unit is not None and isinstance(given, int | float) and not isinstance(given, bool):
                return to_si(f"{given!r} {self.unit}".strip(), si)
            value = to_si(given, si)
        except ValueError as error:
            self.keys.wrong(self.where, f"{error}.")
            return np.nan
        if not np.isfinite(value):
            self.keys.wrong(self.where, f"is {shown(given)}; it must be finite.")
        return value


def _varied(
    name: str,
    paths: tuple[str, ...],
    unit: str,
    told: Mapping[str, Any],
    shape: str,
    quantity: _Quantity,
    along: Mapping[str, tuple[Value, ...]],
) -> Axis:
    given = told[shape]
    if not isinstance(given, list):
        quantity.keys.wrong(quantity.where, f"has {shape} = {shown(given)}; it must be a list.")
        given = []
    elif shape == "values":
        if not given:
            quantity.keys.wrong(quantity.where, "is empty; values needs at least one.")
        values = tuple(quantity.value(item) for item in given)
        if len(set(values)) < len(values):
            quantity.keys.wrong(quantity.where, "has a value twice.")
        return Axis(name, paths, unit, values, "grid", along)
    elif shape in ("linspace", "logspace"):
        return Axis(name, paths, unit, _spaced(given, shape, quantity), "grid", along)
    elif len(given) != 2:
        quantity.keys.wrong(quantity.where, f"has {shape} of {len(given)} items; it must be {_TWO[shape]}.")
    else:
        first, second = (quantity.number(item) for item in given)
        if not _DRAWABLE[shape](first, second):
            quantity.keys.wrong(quantity.where, f"has {shape} = {shown(given)}; it must be {_TWO[shape]}.")
        return Axis(name, paths, unit, None, "sampled", along, {"kind": shape, "numbers": [first, second]})
    return Axis(name, paths, unit, (), "grid")


_TWO = {
    "uniform": "[least, most] with least below most",
    "loguniform": "[least, most], both above 0, with least below most",
    "normal": "[mean, standard deviation] with a deviation above 0",
}
_DRAWABLE: dict[str, Callable[[float, float], bool]] = {
    "uniform": lambda least, most: least < most,
    "loguniform": lambda least, most: 0 < least < most,
    "normal": lambda mean, deviation: deviation > 0,
}


def _spaced(given: list[Any], shape: str, quantity: _Quantity) -> tuple[float, ...]:
    """[first, last, number] -> even steps, or even ratios."""
    count = given[2] if len(given) == 3 else None
    if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= MOST_ON_AN_AXIS:
        quantity.keys.wrong(
            quantity.where,
            f"has {shape} = {shown(given)}; it must be [first, last, number] with a number from 2 to "
            f"{MOST_ON_AN_AXIS}.",
        )
        return ()
    first, last = quantity.number(given[0]), quantity.number(given[1])
    if shape == "logspace" and not (first > 0 and last > 0):
        quantity.keys.wrong(quantity.where, f"has logspace = {shown(given)}; both ends must be above 0.")
        return ()
    if first == last:
        quantity.keys.wrong(quantity.where, f"has {shape} = {shown(given)}; its ends must differ.")
    spaced = np.linspace(first, last, count) if shape == "linspace" else np.geomspace(first, last, count)
    return tuple(float(f"{value:.12g}") for value in spaced)  # 0.3, not 0.30000000000000004


CUT = 3.0  # normal distributions end at this many standard deviations


def ends(axis: Axis) -> tuple[float, float]:
    """Least and greatest value a sampled axis may draw."""
    first, second = axis.distribution["numbers"]
    if axis.distribution["kind"] == "normal":
        return first - CUT * second, first + CUT * second
    return first, second


def _or(words: tuple[str, ...]) -> str:
    return ", ".join(words[:-1]) + " or " + words[-1]
