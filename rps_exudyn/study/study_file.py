"""Study files: what a TOML file may say, and every mistake in it told before anything runs.

    title = "Free pinion torque over preload and friction"
    scene = "free-pinion-torque"
    fidelity = "quasi-static"
    gear = "gears/paper.toml"        # beside or below the study file; without it the paper's gear
    design = "grid"                  # or latin-hypercube, sobol, random, morris, saltelli, which take samples
    time_limit = "60 s"              # of one case

    [set]                            # parameters of all cases
    test.turns = 1
    fidelity.step_angle = "1 deg"

    [[axis]]
    path = "yoke.preload"
    linspace = ["100 N", "600 N", 6]

    [keep]
    signals = ["pinion_torque", "rack_y"]   # or "all", "none"
    samples = 121

docs/studies.md explains every key.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

import numpy as np

from rps_exudyn import units
from rps_exudyn.declaration import Declared, read_toml
from rps_exudyn.errors import InputError
from rps_exudyn.fidelity import PRESETS, name_of
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.quantities import SIGNALS, SUMMARY
from rps_exudyn.setup import Setup
from rps_exudyn.study.description import DESIGNS, GRID_DESIGN, Axis, Keep, Value

KEYS = (
    "title",
    "scene",
    "gear",
    "fidelity",
    "accuracy",
    "design",
    "samples",
    "seed",
    "time_limit",
    "set",
    "axis",
    "keep",
)
SHAPES = ("values", "linspace", "logspace")
DISTRIBUTIONS = ("uniform", "loguniform", "normal")
AXIS_KEYS = ("name", "path", "paths", "unit", "along", *SHAPES, *DISTRIBUTIONS)
NOT_AXES = ("hash", "status", "message", "cpu_s", "wall_s", "bytes", "modified_ns", "case", "sample")
"""Names that tables of results need for themselves."""

FIDELITY = "fidelity."
MOST_ON_AN_AXIS = 100_000
MOST_SAMPLES = 1_000_000


@dataclass(frozen=True)
class Study:
    """A study file, read and judged. `tables` and `settings` make the base that the axes vary."""

    file: Path
    title: str
    scene: str
    tables: Mapping[str, Any]
    settings: Mapping[str, Any]
    axes: tuple[Axis, ...]
    design: str
    samples: int
    seed: int
    time_limit: float  # [s]
    keep: Keep

    @property
    def name(self) -> str:
        return self.file.stem

    @cached_property
    def base(self) -> Setup:
        """Gear and fidelity that the axes vary.

        Raises:
            InputError: parameters that are wrong.
        """
        return Setup.from_tables(self.tables, self.settings, where=str(self.file))

    def setup(self, settings: Mapping[str, Any]) -> Setup:
        """The base with these settings (path -> value); the fidelity's name says what they changed in it.

        Raises:
            InputError: they do not fit each other.
        """
        choices = _choices(settings)
        if choices:
            settings = {**settings, f"{FIDELITY}name": name_of(self.base.fidelity.name, choices)}
        tables = self._tables_for_choices if choices else self._base_tables
        return Setup.from_tables(tables, settings, where=str(self.file))

    @cached_property
    def _base_tables(self) -> dict[str, Any]:
        """All in SI: units are read once, not in every case."""
        return self.base.model_dump()

    @cached_property
    def _tables_for_choices(self) -> dict[str, Any]:
        """The fidelity as it was told: what follows from a choice must follow from a case's own."""
        return {**self._base_tables, "fidelity": {**self.tables["fidelity"], **_choices(self.settings)}}

    def toy(self) -> "Study":
        """The same study at the smallest size that still shows whether it works."""
        return replace(self, axes=tuple(_first_two(axis) for axis in self.axes), samples=min(self.samples, 4))


def _choices(settings: Mapping[str, Any]) -> dict[str, Any]:
    """What of the settings concerns the fidelity, by the names within it."""
    return {
        path.removeprefix(FIDELITY): value for path, value in settings.items() if path.startswith(FIDELITY)
    }


def read_study(path: str | Path) -> Study:
    """The study in a TOML file.

    Raises:
        InputError: all that is wrong with it: file, key, and what is allowed.
    """
    file = Path(path)
    told = read_toml(file)
    reader = _Reader(file)
    study = reader.study(told)
    if reader.problems:
        raise InputError(reader.problems)
    _check_axes_in_gear(study)
    return study


class _Reader:
    """Reads the tables and gathers what is wrong; a wrong part is replaced by its default to go on."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.problems: list[str] = []
        self.declared = {item.path: item for item in Setup.declared()}

    def wrong(self, where: str, sentence: str) -> None:
        self.problems.append(f"{self.file}: {where} {sentence}")

    @contextmanager
    def gathering(self) -> Iterator[None]:
        try:
            yield
        except InputError as error:
            self.problems += [
                problem if str(self.file) in problem else f"{self.file}: {problem}"
                for problem in error.problems
            ]

    def study(self, told: Mapping[str, Any]) -> Study:
        for key in told.keys() - set(KEYS):
            self.wrong(units.short(key), f"is no key of a study; there are {', '.join(KEYS)}.")
        design = self.choice(told, "design", DESIGNS, GRID_DESIGN)
        settings = self.flat(self.table(told, "set"), "set")
        axes = self.axes(told.get("axis", []), design == GRID_DESIGN)
        self.check_twice(axes, settings)
        gear = self.gear(told)
        model = self.cheapest if "accuracy" in told else self.fidelity
        fidelity = model(told, gear, settings)
        return Study(
            file=self.file,
            title=self.text(told, "title", self.file.stem),
            scene=self.scene(told),
            tables={**gear, "fidelity": fidelity},
            settings=settings,
            axes=axes,
            design=design,
            samples=self.samples(told, design),
            seed=self.whole(told, "seed", 0, 0, 2**32 - 1),
            time_limit=self.time_limit(told),
            keep=self.keep(self.table(told, "keep")),
        )

    # --- single keys ---------------------------------------------------------------------------

    def text(self, told: Mapping[str, Any], key: str, default: str) -> str:
        value = told.get(key, default)
        if isinstance(value, str):
            return value
        self.wrong(key, f"is {_shown(value)}; it must be text.")
        return default

    def choice(self, told: Mapping[str, Any], key: str, allowed: tuple[str, ...], default: str) -> str:
        value = told.get(key, default)
        if value in allowed:
            return str(value)
        self.wrong(key, f"is {_shown(value)}; it must be one of {', '.join(allowed)}.")
        return default

    def whole(self, told: Mapping[str, Any], key: str, default: int, least: int, most: int) -> int:
        value = told.get(key, default)
        if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
            return value
        self.wrong(key, f"is {_shown(value)}; it must be a whole number from {least} to {most}.")
        return default

    def table(self, told: Mapping[str, Any], key: str) -> Mapping[str, Any]:
        value = told.get(key, {})
        if isinstance(value, Mapping):
            return value
        self.wrong(key, f"is {_shown(value)}; it must be a table.")
        return {}

    def scene(self, told: Mapping[str, Any]) -> str:
        from rps_exudyn.simulate import SCENES

        return self.choice(told, "scene", tuple(SCENES), "free-pinion-torque")

    def fidelity(
        self, told: Mapping[str, Any], gear: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> dict[str, Any]:
        name = self.choice(told, "fidelity", tuple(PRESETS), "flank")
        return {"name": name_of(name, _choices(settings)), **PRESETS[name]}

    def cheapest(
        self, told: Mapping[str, Any], gear: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> dict[str, Any]:
        """The cheapest model, of all or of the preset named, that keeps the accuracy on the base gear."""
        from rps_exudyn.accuracy.choice import choose, percent

        if own := _choices(settings):
            self.wrong("accuracy", f"chooses the model itself; leave out fidelity.{', fidelity.'.join(own)}.")
            return {}
        preset = self.choice(told, "fidelity", tuple(PRESETS), "flank") if "fidelity" in told else None
        with self.gathering():
            of_gear = {path: value for path, value in settings.items() if not path.startswith(FIDELITY)}
            base = SteeringGear.from_tables(gear, of_gear, where=str(self.file))
            chosen = choose(self.scene(told), base, percent(self.text(told, "accuracy", "")), preset)
            return chosen.fidelity.model_dump()
        return {}

    def gear(self, told: Mapping[str, Any]) -> dict[str, Any]:
        """The gear file's tables; it must lie in the study file's folder or below."""
        if "gear" not in told:
            return {}
        given = Path(self.text(told, "gear", "."))
        folder = self.file.resolve().parent
        if given.is_absolute() or not (folder / given).resolve().is_relative_to(folder):
            self.wrong(
                "gear", f"is {_shown(told['gear'])}; it must lie in the study file's folder or below it."
            )
            return {}
        with self.gathering():
            tables = read_toml(folder / given)
            if "fidelity" in tables:
                self.wrong("gear", "has a table fidelity, which is no part of a gear; put it under [set].")
            return tables
        return {}

    def samples(self, told: Mapping[str, Any], design: str) -> int:
        if design == GRID_DESIGN:
            if "samples" in told:
                self.wrong("samples", "has no meaning for a grid; its axes say how many cases there are.")
            return 0
        if "samples" not in told:
            self.wrong("samples", f"is missing: how many points the {design} design draws.")
            return 0
        return self.whole(told, "samples", 1, 1, MOST_SAMPLES)

    def time_limit(self, told: Mapping[str, Any]) -> float:
        try:
            limit = units.to_si(told.get("time_limit", "600 s"), "s")
        except ValueError as error:
            self.wrong("time_limit", f"{error}.")
            return 600.0
        if not 0 < limit < np.inf:
            self.wrong("time_limit", f"is {_shown(told['time_limit'])}; it must be more than 0 s and finite.")
        return limit

    def keep(self, told: Mapping[str, Any]) -> Keep:
        for key in told.keys() - {"signals", "samples"}:
            self.wrong(f"keep.{key}", "is no key of keep; there are signals, samples.")
        samples = None
        if "samples" in told:
            samples = self.whole(told, "samples", 2, 2, 10**9)
        signals = told.get("signals", "all")
        if signals in ("all", "none"):
            return Keep(None if signals == "all" else (), samples)
        if not isinstance(signals, list) or any(name not in SIGNALS for name in signals):
            unknown = (
                [name for name in signals if name not in SIGNALS] if isinstance(signals, list) else signals
            )
            self.wrong(
                "keep.signals",
                f'has {_shown(unknown)}; it must be "all", "none", or names of {", ".join(SIGNALS)}.',
            )
            return Keep()
        return Keep(tuple(name for name in SIGNALS if name in ("time", "pinion_angle", *signals)), samples)

    def flat(self, told: Mapping[str, Any], where: str, above: str = "") -> dict[str, Any]:
        """Path -> value of nested tables, for known parameters; others are told."""
        found: dict[str, Any] = {}
        for key, value in told.items():
            path = f"{above}{key}"
            if isinstance(value, Mapping):
                found |= self.flat(value, where, f"{path}.")
            elif self.is_parameter(path, where):
                found[path] = value
        return found

    def is_parameter(self, path: Any, where: str) -> bool:
        if isinstance(path, str) and path in self.declared:
            return True
        if path == "fidelity.name":
            self.wrong(where, "cannot have fidelity.name: it says what was chosen.")
            return False
        try:
            Setup.declared_at(str(path))
        except InputError as error:
            self.wrong(f"{where}:", str(error))
        else:
            self.wrong(f"{where}:", f"{path} is a table; name one of its parameters.")
        return False

    # --- axes ----------------------------------------------------------------------------------

    def axes(self, told: Any, grid: bool) -> tuple[Axis, ...]:
        if not isinstance(told, list) or not all(isinstance(item, Mapping) for item in told):
            self.wrong("axis", "must be tables, each under [[axis]].")
            return ()
        if not told:
            self.wrong("axis", "is missing: a study varies something; add an [[axis]].")
        axes = [self.axis(item, f"axis {number}", grid) for number, item in enumerate(told, 1)]
        return tuple(axis for axis in axes if axis)

    def axis(self, told: Mapping[str, Any], where: str, grid: bool) -> Axis | None:
        before = len(self.problems)
        for key in told.keys() - set(AXIS_KEYS):
            self.wrong(
                where,
                f"has {units.short(key)}, which is no key of an axis; there are {', '.join(AXIS_KEYS)}.",
            )
        paths = self.paths(told, where)
        shapes = [key for key in (*SHAPES, *DISTRIBUTIONS) if key in told]
        if len(shapes) != 1:
            found = " and ".join(shapes) or "none"
            self.wrong(where, f"needs exactly one of {', '.join((*SHAPES, *DISTRIBUTIONS))}; it has {found}.")
        elif grid and shapes[0] in DISTRIBUTIONS:
            self.wrong(
                where, f"has {shapes[0]}, which only a sampled design draws from; a grid takes {_or(SHAPES)}."
            )
        elif not grid and shapes[0] not in (*DISTRIBUTIONS, "values"):
            self.wrong(
                where, f"has {shapes[0]}; a sampled design draws from {_or((*DISTRIBUTIONS, 'values'))}."
            )
        name = self.text(told, "name", paths[0] if paths else where)
        taken = name in NOT_AXES or name in SIGNALS or name in SUMMARY
        if not name or taken or "/" in name or not name.strip(".") or not name.isprintable():
            self.wrong(
                f"{where}.name",
                f"is {_shown(name)}; it must be another word than {', '.join(NOT_AXES)}, no quantity of a "
                "result, and without /.",
            )
        if len(self.problems) > before:
            return None
        declared = self.declared[paths[0]]
        unit = self.text(told, "unit", declared.unit.display if declared.unit else "")
        quantity = _Quantity(self, f"{where} ({name})", declared, told.get("unit"))
        along = self.along(told, f"{where} ({name})")
        axis = _axis(name, paths, unit, told, shapes[0], quantity, along)
        for path, values in along.items():
            if axis.values is None or len(values) != len(axis.values):
                self.wrong(
                    where, f"moves {path} along with {len(values)} values; it needs one for each of its own."
                )
        return axis if len(self.problems) == before else None

    def paths(self, told: Mapping[str, Any], where: str) -> tuple[str, ...]:
        if ("path" in told) == ("paths" in told):
            self.wrong(where, "needs either path or paths: what it varies.")
            return ()
        paths = told.get("paths", [told.get("path")])
        if not isinstance(paths, list) or not paths:
            self.wrong(f"{where}.paths", f"is {_shown(paths)}; it must be a list of parameters.")
            return ()
        known = tuple(path for path in paths if self.is_parameter(path, where))
        kinds = {self.declared[path].unit for path in known}
        if len(kinds) > 1:
            self.wrong(
                where, f"gives one value to {', '.join(known)}, which have different units; use along."
            )
        return known

    def along(self, told: Mapping[str, Any], where: str) -> dict[str, tuple[Value, ...]]:
        found = {}
        for path, values in self.flat_lists(self.table(told, "along"), where).items():
            quantity = _Quantity(self, f"{where} along {path}", self.declared[path], None)
            found[path] = tuple(quantity.value(value) for value in values)
        return found

    def flat_lists(self, told: Mapping[str, Any], where: str) -> dict[str, list[Any]]:
        found = self.flat(told, where)
        for path, values in found.items():
            if not isinstance(values, list) or not values:
                self.wrong(where, f"moves {path} along by {_shown(values)}; it must be a list of values.")
        return {path: values for path, values in found.items() if isinstance(values, list)}

    def check_twice(self, axes: tuple[Axis, ...], settings: Mapping[str, Any]) -> None:
        """Nothing may be said twice: a path on two axes, or on an axis and in [set]."""
        seen: dict[str, str] = dict.fromkeys(settings, "[set]")
        names: set[str] = set()
        for axis in axes:
            if axis.name in names:
                self.wrong("axis", f"{axis.name} is there twice; give one of them another name.")
            names.add(axis.name)
            for path in (*axis.paths, *axis.along):
                if path in seen:
                    self.wrong(f"axis {axis.name}", f"varies {path}, which is also given by {seen[path]}.")
                seen[path] = f"axis {axis.name}"


@dataclass(frozen=True)
class _Quantity:
    """Reads the values of one parameter: text with unit, numbers in the axis' unit, or words."""

    reader: _Reader
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
                return units.to_si(f"{given!r} {self.unit}".strip(), si)
            value = units.to_si(given, si)
        except ValueError as error:
            self.reader.wrong(self.where, f"{error}.")
            return np.nan
        if not np.isfinite(value):
            self.reader.wrong(self.where, f"is {_shown(given)}; it must be finite.")
        return value


def _axis(
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
        quantity.reader.wrong(quantity.where, f"has {shape} = {_shown(given)}; it must be a list.")
        given = []
    elif shape == "values":
        if not given:
            quantity.reader.wrong(quantity.where, "is empty; values needs at least one.")
        values = tuple(quantity.value(item) for item in given)
        if len(set(values)) < len(values):
            quantity.reader.wrong(quantity.where, "has a value twice.")
        return Axis(name, paths, unit, values, "grid", along)
    elif shape in ("linspace", "logspace"):
        return Axis(name, paths, unit, _spaced(given, shape, quantity), "grid", along)
    elif len(given) != 2:
        quantity.reader.wrong(quantity.where, f"has {shape} of {len(given)} items; it must be {_TWO[shape]}.")
    else:
        first, second = (quantity.number(item) for item in given)
        if not _DRAWABLE[shape](first, second):
            quantity.reader.wrong(quantity.where, f"has {shape} = {_shown(given)}; it must be {_TWO[shape]}.")
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
        quantity.reader.wrong(
            quantity.where,
            f"has {shape} = {_shown(given)}; it must be [first, last, number] with a number from 2 to "
            f"{MOST_ON_AN_AXIS}.",
        )
        return ()
    first, last = quantity.number(given[0]), quantity.number(given[1])
    if shape == "logspace" and not (first > 0 and last > 0):
        quantity.reader.wrong(quantity.where, f"has logspace = {_shown(given)}; both ends must be above 0.")
        return ()
    if first == last:
        quantity.reader.wrong(quantity.where, f"has {shape} = {_shown(given)}; its ends must differ.")
    spaced = np.linspace(first, last, count) if shape == "linspace" else np.geomspace(first, last, count)
    return tuple(float(f"{value:.12g}") for value in spaced)  # 0.3, not 0.30000000000000004


def _check_axes_in_gear(study: Study) -> None:
    """The base must be right, and each value of an axis must be allowed in it, alone.

    Raises:
        InputError: what is wrong, each sentence once.
    """
    _check_base(study)
    problems: dict[str, None] = {}
    for axis in study.axes:
        for settings in _alone(axis):
            try:
                study.setup(settings)
            except InputError as error:
                told = (f"{study.file}: axis {axis.name}: {problem}" for problem in error.problems)
                problems |= dict.fromkeys(told)
    if problems:
        shown = list(problems)[:10]
        raise InputError(
            shown + [f"{study.file}: {len(problems) - 10} more like these."] * (len(problems) > 10)
        )


def _check_base(study: Study) -> None:
    try:
        study.base  # noqa: B018 - read for what is wrong with it
    except InputError as error:
        name = str(study.file)
        raise InputError(
            problem if problem.startswith(name) else f"{name}: {problem}" for problem in error.problems
        ) from None


def _alone(axis: Axis) -> Iterator[dict[str, Value]]:
    """Settings of an axis by itself: all of its values, or the ends of what is drawn."""
    if axis.values is not None:
        for value in axis.values:
            yield axis.settings(value)
    else:
        for value in ends(axis):
            yield axis.settings(value)


CUT = 3.0  # normal distributions end at this many standard deviations


def ends(axis: Axis) -> tuple[float, float]:
    """Least and greatest value a sampled axis may draw."""
    first, second = axis.distribution["numbers"]
    if axis.distribution["kind"] == "normal":
        return first - CUT * second, first + CUT * second
    return first, second


def _first_two(axis: Axis) -> Axis:
    if axis.values is None:
        return axis
    along = {path: values[:2] for path, values in axis.along.items()}
    return replace(axis, values=axis.values[:2], along=along)


def _or(words: tuple[str, ...]) -> str:
    return ", ".join(words[:-1]) + " or " + words[-1]


def _shown(value: Any) -> str:
    try:
        return units.short(repr(value))
    except ValueError:  # a number of more digits than Python writes
        return "a number too long to be shown"
