"""The file of an optimisation, and every mistake in it reported before the search begins.

fidelity = "quasi-static"        # title, scene, gear, [set], seed and time_limit as in a study file
errors = "series"                # over which quantiles are taken: series, unknown, own or none
samples = 96                     # gears with errors for each design
designs = 1000                   # that the search may try, in generations of `population`
confirm = [512, 40]              # fresh gears by the search's model, and by each of two others
requirements = ["rated_flank"]   # of the requirement sheet, kept by 95 % of the gears

[variables]
pinion.helix_angle = ["15 deg", "30 deg"]

[keep]
gain = "pinion.normal_module"    # the parameter follows, so that the travel per turn stays as given

[objectives.ripple]
metric = "torque_peak_to_peak"   # least, unless goal = "most"
quantile = "90 %"

[constraints.torque_mean]
most = "given"                   # what the gear as given has
"""

import hashlib
import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from rps_exudyn.assessment.requirements.judging import ASSURED, BY_GEOMETRY, BY_RUNS, STRESSES
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown, to_si
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.inference.uncertainty.input_sets import SETS, carried, uncertain_inputs
from rps_exudyn.optimisation.evaluation import numbers_of
from rps_exudyn.optimisation.goals import (
    Constraint,
    Number,
    Objective,
    face_load_factor,
)
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.parameters.wrong_values import nearest_names
from rps_exudyn.results.limit import Limit, limit_of
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.requirements import REQUIRED, read_limits
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.definition import FIDELITY, Axis, Study, Value, settings_of
from rps_exudyn.study.study_file import study_of
from rps_exudyn.study.toml_keys import Keys

OF_STUDIES = ("title", "scene", "fidelity", "gear", "set", "time_limit", "seed")
KEYS = (
    *OF_STUDIES,
    *("errors", "samples", "designs", "population", "confirm", "limits", "requirements"),
    *("variables", "keep", "objectives", "constraints"),
)
NUMBER_KEYS = {"metric", "scene", "set"}
SIZES = {"samples": (96, 8, 10**5), "designs": (1000, 4, 10**5), "population": (36, 4, 10**5)}
"""Key -> default, least and most."""

MOST_CONFIRMED = 10**6  # fresh gears
GIVEN, NONE = "given", "none"  # limit of a constraint; no errors
Read = TypeVar("Read")
MOST_WHOLE = 1000  # whole numbers between the bounds of a variable
TRIED = 64  # gears within the bounds, of which one must exist
# times its given value: where a parameter that follows is sought, nearest first
FOLLOWS = (0.9, 1.1, 0.8, 1.25, 0.6, 1.6, 0.4, 2.5, 0.25, 4.0)


@dataclass(frozen=True)
class Problem:
    """An optimisation.

    Attributes:
        study: the gear as given, the model, the variables as axes; its samples are the designs.
        keep: requirement by a formula -> parameter that follows.
        objectives: what is to be least or most.
        constraints: what is to be kept.
        errors: name of the set of errors, or "none".
        own: distributions that the gear itself carries.
        samples: gears with errors for each design.
        population: designs of a generation.
        confirm: fresh gears by the search's model, and by each of the others.
        kept: requirement -> its number, of the gear as given.
        face_load_factor: of the gear as given; the search takes it for all designs.
    """

    study: Study
    keep: Mapping[str, str]
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...]
    errors: str
    own: Mapping[str, Distribution]
    samples: int
    population: int
    confirm: tuple[int, int]
    kept: Mapping[str, float] = field(default_factory=dict)
    face_load_factor: float = 1.0

    @property
    def numbers(self) -> tuple[Number, ...]:
        """All numbers that a design is judged by."""
        return (*(each.number for each in self.objectives), *(each.number for each in self.constraints))

    @property
    def needs_face_load(self) -> bool:
        """Whether a number is a stress at the rated torque."""
        return any(each.of in STRESSES for each in self.numbers)

    @cached_property
    def fingerprint(self) -> str:
        """What the numbers of a design depend on beside its parameters."""
        inputs = {path: str(each) for path, each in self.own.items()}
        of_stresses = self.face_load_factor if self.needs_face_load else None
        content = [str(self.numbers), self.errors, inputs, self.samples, self.study.seed, of_stresses]
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()

    def toy(self) -> "Problem":
        """The same at the smallest size: eight designs of as many gears, confirmed by the search's model."""
        return replace(self, study=replace(self.study, samples=8), population=4, samples=8, confirm=(8, 0))

    def with_variables(self, values: Mapping[str, Value]) -> Setup:
        """Return gear and model with these variables, whether the gear can be built or not."""
        axes = tuple(axis for axis in self.study.axes if axis.name in values)
        return self.study.setup(settings_of(axes, values))

    def setup(self, values: Mapping[str, Value]) -> Setup:
        """Return gear and model of a design; its kept numbers are those of the gear as given.

        Raises:
            InputError: there is no such gear.
        """
        made = self.with_variables(values)
        for name, path in self.keep.items():
            made = _following(made, path, name, self.kept[name])
        check_gear(made.steering_gear)
        return made

    def inputs_of(self, gear: SteeringGear) -> Mapping[str, Distribution]:
        """Return the distributions of a design's errors."""
        return {} if self.errors == NONE else uncertain_inputs(gear, self.errors, self.own)


def _following(made: Setup, path: str, name: str, wanted: float) -> Setup:
    """Return a gear whose parameter is such that a requirement's formula has the wanted number."""
    from scipy.optimize import brentq

    here = float(made.value_at(path))

    def beyond(factor: float) -> float:
        return float(BY_GEOMETRY[name](made.replace({path: here * factor}))) - wanted

    at_start, factor = beyond(1.0), 1.0
    if at_start:
        for other in FOLLOWS:  # the nearest change of sign, for gears far away need not exist
            with suppress(InputError):
                if at_start * beyond(other) <= 0:
                    factor = brentq(beyond, *sorted((1.0, other)), xtol=1e-12)
                    break
        else:
            shown = SteeringGear.declared_at(path)[0].show(here)
            raise InputError(f"no {path} near {shown} keeps the {name}.")
    return made.replace({path: float(f"{here * factor:.9g}")})


def bounds_of(axis: Axis) -> tuple[float, float]:
    """Return least and greatest value of a variable."""
    low, high = (axis.values[0], axis.values[-1]) if axis.values else axis.distribution["numbers"]
    return float(low), float(high)


def values_at(axes: Sequence[Axis], point: np.ndarray) -> dict[str, Value]:
    """Return the variables at a point of the unit cube, (variables,)."""
    values: dict[str, Value] = {}
    for axis, place in zip(axes, point.tolist(), strict=True):
        low, high = bounds_of(axis)
        if axis.values is None:
            values[axis.name] = float(f"{low + place * (high - low):.9g}")
        else:
            values[axis.name] = axis.values[min(int(place * len(axis.values)), len(axis.values) - 1)]
    return values


def read_problem(path: str | Path) -> Problem:
    """Return the optimisation in a TOML file.

    Raises:
        InputError: everything that is wrong with it: file, key, and what is allowed.
    """
    return problem_of(Path(path), read_toml(path))


def problem_of(file: Path, content: Mapping[str, Any]) -> Problem:
    """Return the optimisation in the tables of a TOML file.

    Raises:
        InputError: as `read_problem`.
    """
    reader = ProblemKeys(file)
    return reader.read(lambda: reader.problem(content))


class ProblemKeys(Keys):
    """Reads the keys of an optimisation's file."""

    def stop(self) -> None:
        """Go no further where something is wrong.

        Raises:
            InputError: it is.
        """
        if self.problems:
            found, self.problems = self.problems, []
            raise InputError(found)

    def read(self, make: Callable[[], Read]) -> Read:
        """Return what is made of the file.

        Raises:
            InputError: everything that is wrong with it.
        """
        with self.gathering():
            made = make()
        if self.problems:
            raise InputError(self.problems)
        return made

    def confirmed(self, content: Mapping[str, Any]) -> tuple[int, int]:
        """Return the fresh gears by the search's model, and by each of the others."""
        given = content.get("confirm", [512, 40])
        listed = isinstance(given, list) and len(given) == 2
        if not listed or any(type(n) is not int or not 0 <= n <= MOST_CONFIRMED for n in given):
            self.wrong("confirm", f"is {shown(given)}; it must be two numbers of gears, such as [512, 40].")
            return 0, 0
        return given[0], given[1]

    def check_keys(self, given: Collection[str], known: Sequence[str], file: str) -> None:
        """Report keys that such a file does not have."""
        for key in {*given} - {*known}:
            self.wrong(key, f"is no key of {file}; there are {', '.join(known)}.")

    def study(
        self, content: Mapping[str, Any], axes: Sequence[Mapping[str, Any]], samples: int
    ) -> tuple[Study, Mapping[str, Distribution]]:
        """Return the study whose random samples vary the axes, and what scatters in its gear.

        Raises:
            InputError: it, or its gear, is wrong.
        """
        tables = {key: content[key] for key in OF_STUDIES if key in content}
        kept = {"signals": "none", "blocks": False}
        tables |= {"axis": axes, "design": "random", "samples": samples, "keep": kept}
        study = study_of(self.file, tables)
        own = carried(study.tables, study.settings)
        check_gear(study.base.steering_gear)
        return study, own

    def problem(self, content: Mapping[str, Any]) -> Problem:
        if "tolerances" in content:
            self.wrong("tolerances", "is a table for rps.tolerances, not for rps.optimise.")
        self.check_keys(content.keys() - {"tolerances"}, KEYS, "an optimisation")
        samples, designs, population = (self.whole(content, key, *size) for key, size in SIZES.items())
        errors = self.choice(content, "errors", (*SETS, NONE), "series")
        confirm = self.confirmed(content)
        axes = [*self._axes(self.table(content, "variables"))]
        if not axes:
            self.wrong("variables", "must have at least one parameter with its bounds, [least, most].")
        self.stop()
        study, own = self.study(content, axes, designs)
        gear = study.base.steering_gear
        keep = self.table(content, "keep")
        for name, path in keep.items():
            declared = self.declared.get(path) if isinstance(path, str) else None
            if name not in BY_GEOMETRY or declared is None or declared.unit is None:
                allowed = f"{' or '.join(BY_GEOMETRY)}, and a parameter with a number"
                self.wrong("keep", f"has {name} = {shown(path)}; it must be {allowed}.")
        for axis in study.axes:
            if axis.name in own or axis.name in keep.values():
                self.wrong("variables", f"has {axis.name}, which is given by a distribution or by keep, too.")
        self.stop()
        numbers = {name: float(BY_GEOMETRY[name](gear)) for name in keep}
        problem = Problem(
            study, keep, (), (), errors, own, samples, min(population, designs), confirm, numbers
        )
        _check_bounds(problem)
        objectives = [*self._objectives(self.table(content, "objectives"), problem)]
        asked = [*self.asked(self.table(content, "constraints"), problem)]
        required = [*self.requirements(content, problem)]
        self.stop()
        constraints = (*self.constraints(problem, asked), *required)
        problem = replace(problem, objectives=tuple(objectives), constraints=constraints)
        self.stop()
        _check_contradictions(problem)
        numbers_of(
            problem, study.base, [replace(each, quantile=None) for each in problem.numbers]
        )  # are there
        return (
            replace(problem, face_load_factor=face_load_factor(gear)) if problem.needs_face_load else problem
        )

    def _axes(self, table: Mapping[str, Any], above: str = "") -> Iterator[dict[str, Any]]:
        """Yield the tables of a study's axes: whole numbers are listed, others even between their bounds."""
        for key, value in table.items():
            path, where = f"{above}{key}", f"variables: {above}{key}"
            if isinstance(value, Mapping):
                yield from self._axes(value, f"{path}.")
            elif not isinstance(value, list) or len(value) != 2:
                self.wrong(where, f"is {shown(value)}; it must be [least, most].")
            elif self.is_parameter(path, "variables"):
                declared = self.declared[path]
                if declared.field.annotation is int and all(type(end) is int for end in value):
                    if not 0 < value[1] - value[0] <= MOST_WHOLE:
                        self.wrong(
                            where, f"is {shown(value)}; it must be [least, most], {MOST_WHOLE} apart at most."
                        )
                        continue
                    yield {"path": path, "values": [*range(value[0], value[1] + 1)]}
                elif declared.unit is None or path.startswith(FIDELITY):
                    self.wrong(where, f"is {shown(value)}; only numbers of the gear can vary between bounds.")
                else:
                    yield {"path": path, "uniform": value}

    def _objectives(self, tables: Mapping[str, Any], problem: Problem) -> Iterator[Objective]:
        if not tables:
            self.wrong(
                "objectives", "must have at least one table, such as [objectives.torque_peak_to_peak]."
            )
        for name, table in tables.items():
            where = f"objectives: {name}"
            if number := self._number(where, name, table, problem, {"goal", "quantile"}):
                yield Objective(
                    number, -1 if self.choice(table, "goal", ("least", "most"), "least") == "most" else 1
                )

    def asked(self, tables: Mapping[str, Any], problem: Problem) -> Iterator[tuple[Number, dict[str, Any]]]:
        """Yield the number of each limit, and its ends; a share of the gears makes a quantile of each end."""
        for name, table in tables.items():
            where = f"constraints: {name}"
            number = self._number(where, name, table, problem, {"least", "most", "share"})
            ends = {end: table[end] for end in ("least", "most") if end in table} if number else {}
            if number and not ends:
                self.wrong(where, "must have most, least or both.")
            elif number and number.quantile is not None:
                for end, share in (("least", 1 - number.quantile), ("most", number.quantile)):
                    if end in ends:
                        yield replace(number, quantile=share), {end: ends[end]}
            elif number:
                yield number, ends

    def _number(self, where: str, name: str, table: Any, problem: Problem, others: set[str]) -> Number | None:
        before = len(self.problems)
        if not isinstance(table, Mapping):
            self.wrong(where, f"is {shown(table)}; it must be a table.")
            return None
        for key in table.keys() - NUMBER_KEYS - others:
            self.wrong(
                where, f"has {key}, which is no key; there are {', '.join(sorted(NUMBER_KEYS | others))}."
            )
        of, share = self.text(table, "metric", name), self._share(where, table, problem)
        declared = SteeringGear.declared()
        gear = [each.path for each in declared if each.unit is not None or each.field.annotation is int]
        if not self._is_known(where, of, [*SUMMARY, *REQUIRED, *gear]) or len(self.problems) > before:
            return None
        if of in STRESSES or of in BY_GEOMETRY or of in gear:
            return Number(name, of)
        scene = (
            BY_RUNS[of][0] if of in BY_RUNS else self.choice(table, "scene", SCENE_NAMES, problem.study.scene)
        )
        return Number(name, of, scene, tuple(self.flat(self.table(table, "set"), where).items()), share)

    def _is_known(self, where: str, name: str, known: Collection[str]) -> bool:
        if name in known:
            return True
        near = nearest_names(name, [*known], [*known][:3])
        self.wrong(where, f"{shown(name)} is unknown; {near}.")
        return False

    def _share(self, where: str, table: Mapping[str, Any], problem: Problem) -> float | None:
        """Return the quantile, or the share of the gears that keep a limit, 0 to 1; None without one."""
        key = next((key for key in ("quantile", "share") if key in table), "")
        try:
            share = to_si(table[key], "") if key else None
        except ValueError as error:
            self.wrong(where, f"{key} {error}.")
            return None
        if share is not None and not 0 <= share <= 1:
            nearest = "0 %" if share < 0 else "100 %"
            self.wrong(
                where, f"{key} is {shown(table[key])}; it must be 0 to 100 %, the nearest is {nearest}."
            )
        elif share is not None and problem.errors == NONE:
            self.wrong(where, f"has {key}, but errors is none; leave out one of them.")
        return share

    def constraints(
        self, problem: Problem, asked: Sequence[tuple[Number, dict[str, Any]]]
    ) -> Iterator[Constraint]:
        """Yield the constraints; numbers `given` are those of the gear as given."""
        base, of_given = problem.study.base, [number for number, ends in asked if GIVEN in ends.values()]
        if any(number.of in STRESSES for number in of_given):
            problem = replace(problem, face_load_factor=face_load_factor(base.steering_gear))
        found = dict(zip(of_given, numbers_of(problem, base, of_given), strict=True))
        for number, ends in asked:
            limits = {end: found[number] if value == GIVEN else value for end, value in ends.items()}
            where = f"{self.file}: constraints: {number.name}: "
            yield Constraint(number, limit_of(where, limits, number.quantity, self.problems))

    def requirements(self, content: Mapping[str, Any], problem: Problem) -> Iterator[Constraint]:
        """Yield the requirements of the sheet that are asked for, kept by so many of the gears as there."""
        names, path = content.get("requirements", []), content.get("limits")
        names = [*REQUIRED] if names == "all" else names
        limits = read_limits(self.file.parent / str(path) if path is not None else None)
        for name in names if isinstance(names, list) else [names]:
            if not self._is_known("requirements", str(name), [*REQUIRED]):
                continue
            scene, limit = BY_RUNS[name][0] if name in BY_RUNS else "", limits[name]
            for share, ends in ((1 - ASSURED, (limit.least, np.inf)), (ASSURED, (-np.inf, limit.most))):
                quantile = share if scene and problem.errors != NONE else None
                if np.isfinite(ends).any():
                    yield Constraint(Number(name, name, scene, (), quantile), Limit(*ends, limit.source))


def _check_contradictions(problem: Problem) -> None:
    """Refuse limits of one number, or of a variable, that no value keeps.

    Raises:
        InputError: they do, with the nearest limit that can be kept.
    """
    numbers = {axis.name: bounds_of(axis) for axis in problem.study.axes}
    numbers |= {name: (value, value) for name, value in problem.kept.items()}
    fixed = [Constraint(Number(name, name), Limit(*ends, "")) for name, ends in numbers.items()]
    for first, second in combinations((*fixed, *problem.constraints), 2):
        for end, other, low, high in (("least", "most", second, first), ("most", "least", first, second)):
            if low.limit.least > high.limit.most and low.number.is_at_most(high.number):
                show, name = second.number.quantity.show, second.number.name
                nearest = show(getattr(first.limit, other))
                given = "its bounds" if first in fixed else f"{first.number.words}, {other} {nearest}"
                raise InputError(
                    f"constraints: {name}: {end} is {show(getattr(second.limit, end))}, which contradicts "
                    f"{given}; the nearest that can be kept is {nearest}."
                )


def _check_bounds(problem: Problem) -> None:
    """Refuse bounds between which no gear exists.

    Raises:
        InputError: there is none, with the nearest value that a gear can have.
    """
    from scipy.stats import qmc

    axes, causes = problem.study.axes, list[str]()

    def exists(varied: Sequence[Axis], point: np.ndarray) -> bool:
        try:
            problem.setup(values_at(varied, point))
        except InputError as error:
            causes.append(" ".join(error.problems))
            return False
        return True

    points = qmc.LatinHypercube(len(axes), rng=np.random.default_rng(0)).random(TRIED)
    if any(exists(axes, point) for point in points):
        return
    for axis in axes:
        if axis.values or any(exists([axis], np.array([place])) for place in np.linspace(0, 1, TRIED)):
            continue
        (low, high), show = bounds_of(axis), SteeringGear.declared_at(axis.name)[0].show
        given = (float(problem.study.base.value_at(axis.name)) - low) / (high - low)
        inside, outside = given, float(np.clip(given, 0, 1))
        for _ in range(40):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if exists([axis], np.array([middle])) else (inside, middle)
        raise InputError(
            f"variables: {axis.name} from {show(low)} to {show(high)} allows no gear; the nearest admissible "
            f"value is {show(low + inside * (high - low))}: {causes[0]}"
        )
    raise InputError(f"variables: none of {TRIED} gears within the bounds exists; the first: {causes[0]}")
