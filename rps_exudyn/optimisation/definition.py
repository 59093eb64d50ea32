"""The file of an optimisation, and every mistake in it reported before anything runs.

title = "Least ripple of a series"
fidelity = "quasi-static"        # scene, gear, [set] and time_limit as in a study file
errors = "series"                # over which quantiles are taken: series, unknown, own or none
samples = 96                     # gears with errors for each design
designs = 1000                   # that the search may try
requirements = ["rated_flank"]   # of the requirement sheet, kept by 95 % of the gears

[variables]
pinion.helix_angle = ["15 deg", "30 deg"]

[keep]
gain = "pinion.normal_module"    # the parameter follows, so that the travel per turn stays as given

[objectives.ripple]
metric = "torque_peak_to_peak"   # least unless goal = "most"
quantile = "90 %"

[constraints.torque_mean]
most = "given"                   # as the gear has it whose values are given
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.assessment.requirements.judging import ASSURED
from rps_exudyn.assessment.requirements.limits import REQUIRED, read_limits
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown, to_si
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.inference.uncertainty.input_sets import SETS, carried, uncertain_inputs
from rps_exudyn.optimisation.goals import (
    FORMULAS,
    RUNS,
    STRESSES,
    Constraint,
    Number,
    Objective,
    face_load_factor,
    unknown,
)
from rps_exudyn.parameters.declaration import read_toml
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.limit import Limit, limit_of
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.definition import Axis, Study, Value, settings_of
from rps_exudyn.study.study_file import study_of
from rps_exudyn.study.toml_keys import Keys

OWN_KEYS = {"variables", "keep", "objectives", "constraints", "requirements", "limits"}
SEARCH_KEYS = {"errors", "samples", "designs", "population", "confirm"}
OF_STUDIES = ("title", "scene", "fidelity", "gear", "set", "time_limit", "seed")
NUMBER_KEYS = {"metric", "scene", "set", "quantile"}
GIVEN = "given"  # limit: what the gear as given has
TRIED = 64  # gears within the bounds, of which one must exist
FOLLOWS = (0.25, 4.0)  # times its given value, between which a kept parameter is sought
NONE = "none"


@dataclass(frozen=True)
class Problem:
    """An optimisation. `study` has the gear as given, the model, and the variables as its axes.

    Attributes:
        study: see above; its samples are the designs that the search may try.
        keep: requirement by a formula -> parameter that follows.
        objectives: what is to be least or most.
        constraints: what is to be kept.
        errors: name of the set of errors, or "none".
        own: distributions that the gear itself carries.
        samples: gears with errors for each design.
        population: designs of a generation.
        confirm: fresh gears by the search's model, and by each of the others.
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
    kept: Mapping[str, float] = field(default_factory=dict)  # requirement -> its number, of the gear as given
    face_load_factor: float = (
        1.0  # of the gear as given: the search takes it for all; the best have their own
    )

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

    def setup(self, values: Mapping[str, Value]) -> Setup:
        """Return gear and model of a design: axis -> value; kept numbers are those of the gear as given.

        Raises:
            InputError: there is no such gear.
        """
        made = self.with_variables(values)
        for name, path in self.keep.items():
            made = _following(made, path, FORMULAS[name], self.kept[name])
        check_gear(made.steering_gear)
        return made

    def with_variables(self, values: Mapping[str, Value]) -> Setup:
        """Return the same before kept numbers are, whether the gear can be built or not."""
        axes = tuple(axis for axis in self.study.axes if axis.name in values)
        return self.study.setup(settings_of(axes, values))

    def inputs_of(self, gear: SteeringGear) -> Mapping[str, Distribution]:
        """Return the distributions of a design's errors."""
        return {} if self.errors == NONE else uncertain_inputs(gear, self.errors, self.own)


def _following(made: Setup, path: str, formula: Any, wanted: float) -> Setup:
    """Return a gear whose parameter is such that a formula has the wanted number."""
    from scipy.optimize import brentq

    here = float(made.value_at(path))

    def beyond(factor: float) -> float:
        return float(formula(made.replace({path: here * factor}))) - wanted

    try:
        factor = 1.0 if not beyond(1.0) else brentq(beyond, *FOLLOWS, xtol=1e-12)
    except ValueError:
        raise InputError(
            f"no {path} within {FOLLOWS[0]:g} to {FOLLOWS[1]:g} times its value keeps the number."
        ) from None
    return made.replace({path: float(f"{here * factor:.9g}")})


def read_problem(path: str | Path) -> Problem:
    """Return the optimisation in a TOML file.

    Raises:
        InputError: everything that is wrong with it: file, key, and what is allowed.
    """
    file = Path(path)
    content = read_toml(file)
    reader = _ProblemKeys(file)
    problem = reader.problem(content)
    if reader.problems or problem is None:
        raise InputError(reader.problems)
    return problem


class _ProblemKeys(Keys):
    """Reads the keys of an optimisation's file."""

    def problem(self, content: Mapping[str, Any]) -> Problem | None:
        allowed = OWN_KEYS | SEARCH_KEYS | set(OF_STUDIES)
        for key in content.keys() - allowed:
            self.wrong(key, f"is no key of an optimisation; there are {', '.join(sorted(allowed))}.")
        designs, population = (
            self.whole(content, "designs", 1000, 4, 10**6),
            self.whole(content, "population", 36, 4, 10**4),
        )
        if population > designs:
            self.wrong("population", f"is {population}; it must be at most designs, {designs}.")
        samples = self.whole(content, "samples", 96, 8, 10**5)
        errors = self.choice(content, "errors", (*SETS, NONE), "series")
        confirm = content.get("confirm", [512, 40])
        if (
            not isinstance(confirm, list)
            or len(confirm) != 2
            or not all(type(n) is int and 0 <= n <= 10**6 for n in confirm)
        ):
            self.wrong(
                "confirm", f"is {shown(confirm)}; it must be two whole numbers of gears, such as [512, 40]."
            )
            confirm = [0, 0]
        axes = [*self._axes(self.table(content, "variables"))]
        if self.problems:
            return None
        tables = {key: content[key] for key in OF_STUDIES if key in content}
        tables |= {
            "axis": axes,
            "design": "random",
            "samples": designs,
            "keep": {"signals": "none", "blocks": False},
        }
        with self.gathering():
            study = study_of(self.file, tables)
        if self.problems:
            return None
        own: Mapping[str, Distribution] = {}
        with self.gathering():
            own = carried(study.tables, study.settings)
        if twice := [axis.name for axis in study.axes if axis.name in own]:
            self.wrong("variables", f"has {twice[0]}, which carries a distribution; give it one of both.")
        keep = self._keep(content, study)
        if self.problems:
            return None
        problem = Problem(study, keep, (), (), errors, own, samples, population, (confirm[0], confirm[1]))
        with self.gathering():
            check_gear(study.base.steering_gear)
            kept = {name: FORMULAS[name](study.base.steering_gear) for name in keep}
            problem = replace(problem, kept=kept, face_load_factor=_factor_of(problem, content))
            problem = self._with_goals(problem, content)
            _check_bounds(problem)
        return problem

    def _axes(self, table: Mapping[str, Any], above: str = "") -> Iterator[dict[str, Any]]:
        """Yield the tables of a study's axes: whole numbers are listed, others even between their bounds."""
        if not above and not table:
            self.wrong(
                "variables",
                'is missing: path = [least, most], such as pinion.helix_angle = ["15 deg", "30 deg"].',
            )
        for key, value in table.items():
            path = f"{above}{key}"
            if isinstance(value, Mapping):
                yield from self._axes(value, f"{path}.")
            elif not isinstance(value, list) or len(value) != 2:
                self.wrong(f"variables: {path}", f"is {shown(value)}; it must be [least, most].")
            elif self.is_parameter(path, "variables"):
                declared = self.declared[path]
                if declared.field.annotation is int:
                    if not all(type(end) is int for end in value) or not value[0] < value[1]:
                        self.wrong(
                            f"variables: {path}",
                            f"is {shown(value)}; it must be two whole numbers, the less one first.",
                        )
                    else:
                        yield {"path": path, "values": [*range(value[0], value[1] + 1)]}
                elif declared.unit is None or path.startswith("fidelity."):
                    self.wrong(
                        f"variables: {path}",
                        "is no number of the gear; only numbers can be varied between bounds.",
                    )
                else:
                    yield {"path": path, "uniform": value}

    def _keep(self, content: Mapping[str, Any], study: Study) -> dict[str, str]:
        keep = {}
        for name, path in self.table(content, "keep").items():
            if name not in FORMULAS:
                self.wrong("keep", f"has {name}; it must be one of {', '.join(FORMULAS)}.")
            elif self.is_parameter(path, "keep"):
                if path in {axis.name for axis in study.axes}:
                    self.wrong(
                        "keep", f"lets {path} follow, which is a variable; leave it out of one of them."
                    )
                keep[name] = path
        return keep

    def _with_goals(self, problem: Problem, content: Mapping[str, Any]) -> Problem:
        """Return the problem with objectives and constraints; `given` stands for its own."""
        objectives, tables = [], self.table(content, "objectives")
        if not tables:
            self.wrong(
                "objectives",
                'is missing: a table for each, such as objectives.ripple.metric = "torque_peak_to_peak".',
            )
        for name, table in tables.items():
            where = f"objectives: {name}"
            if isinstance(table, Mapping) and (number := self._number(where, name, table, problem, {"goal"})):
                goal = self.choice(table, "goal", ("least", "most"), "least")
                objectives.append(Objective(number, 1 if goal == "least" else -1))
            elif not isinstance(table, Mapping):
                self.wrong(where, f"is {shown(table)}; it must be a table.")
        wanted: list[tuple[Number, Mapping[str, Any]]] = []
        for name, table in self.table(content, "constraints").items():
            where = f"constraints: {name}"
            if not isinstance(table, Mapping) or not table.keys() & {"most", "least"}:
                self.wrong(where, f"is {shown(table)}; it must be a table with most, least or both.")
            elif number := self._number(where, name, table, problem, {"most", "least", "share", "source"}):
                wanted.append((number, table))
        if self.problems:
            return problem
        constraints = [*self._constraints(problem, wanted), *self._requirements(content, problem)]
        _check_contradictions(problem, constraints)
        return replace(problem, objectives=tuple(objectives), constraints=tuple(constraints))

    def _number(
        self, where: str, name: str, table: Mapping[str, Any], problem: Problem, others: set[str]
    ) -> Number | None:
        for key in table.keys() - NUMBER_KEYS - others:
            self.wrong(
                where, f"has {key}, which is no key; there are {', '.join(sorted(NUMBER_KEYS | others))}."
            )
        of = self.text(table, "metric", name)
        share = self.share(where, table, "quantile")
        if share is not None and problem.errors == NONE:
            self.wrong(where, "has a quantile, but errors is none; leave it out.")
        gear = {item.path for item in SteeringGear.declared() if item.unit is not None}
        if of in STRESSES or of in FORMULAS or of in gear:
            return Number(name, of)
        if of not in SUMMARY and of not in RUNS:
            self.problems += [f"{self.file}: {unknown(where, of, [*SUMMARY, *REQUIRED]).problems[0]}"]
            return None
        scene = RUNS[of][0] if of in RUNS else self.choice(table, "scene", SCENE_NAMES, problem.study.scene)
        settings = tuple(self.flat(self.table(table, "set"), where).items())
        return Number(name, of, scene, settings, share)

    def share(self, where: str, table: Mapping[str, Any], key: str) -> float | None:
        """Return a share of the series, 0 to 1; None without one."""
        if key not in table:
            return None
        try:
            share = to_si(table[key], "")
        except ValueError as error:
            self.wrong(where, f"{key} {error}.")
            return None
        if 0 <= share <= 1:
            return share
        nearest = "0 %" if share < 0 else "100 %"
        self.wrong(
            where,
            f"{key} is {shown(table[key])}; it must lie between 0 % and 100 %, the nearest is {nearest}.",
        )
        return None

    def _constraints(
        self, problem: Problem, wanted: Sequence[tuple[Number, Mapping[str, Any]]]
    ) -> Iterator[Constraint]:
        """Yield the constraints of the file. A share of the gears that keep it makes two quantiles."""
        from rps_exudyn.optimisation.evaluation import numbers_of

        rows = []
        for number, table in wanted:
            share = self.share(f"constraints: {number.name}", table, "share")
            if share is not None and number.scene:
                ends = {"most": share, "least": 1 - share}
                rows += [(replace(number, quantile=ends[end]), table, {end}) for end in ends if end in table]
            else:
                rows.append((number, table, {"most", "least"}))
        asked = [number for number, table, ends in rows if GIVEN in {table.get(end) for end in ends}]
        found = dict(zip(asked, numbers_of(problem, problem.study.base, asked), strict=True)) if asked else {}
        for number, table, asked_ends in rows:
            limits = {
                end: found[number] if table[end] == GIVEN else table[end] for end in asked_ends & table.keys()
            }
            yield Constraint(
                number,
                limit_of(
                    f"{self.file}: constraints: {number.name}: ", limits, number.quantity, self.problems
                ),
            )

    def _requirements(self, content: Mapping[str, Any], problem: Problem) -> Iterator[Constraint]:
        """Yield the requirements of the sheet that are asked for, kept by so many of the gears as there."""
        names, path = content.get("requirements", []), content.get("limits")
        names = [*REQUIRED] if names == "all" else names
        if not isinstance(names, list):
            self.wrong("requirements", f'is {shown(names)}; it must be a list of names, or "all".')
            return
        limits = read_limits(self.file.parent / str(path) if path is not None else None)
        for name in names:
            if name not in REQUIRED:
                self.problems += [
                    f"{self.file}: {unknown('requirements', str(name), [*REQUIRED]).problems[0]}"
                ]
                continue
            scene, limit, spread = RUNS[name][0] if name in RUNS else "", limits[name], problem.errors != NONE
            for end, share in (("most", ASSURED), ("least", 1 - ASSURED)):
                if np.isfinite(getattr(limit, end)):
                    least, most = (limit.least, np.inf) if end == "least" else (-np.inf, limit.most)
                    of_series = share if scene and spread else None
                    yield Constraint(
                        Number(name, name, scene, (), of_series), Limit(least, most, limit.source)
                    )


def _factor_of(problem: Problem, content: Mapping[str, Any]) -> float:
    """Return the face load factor of the gear as given; 1 where no stress is asked for."""
    asked = str([content.get(key) for key in ("objectives", "constraints", "requirements")])
    return face_load_factor(problem.study.base.steering_gear) if "rated_" in asked or "all" in asked else 1.0


def _check_contradictions(problem: Problem, constraints: Sequence[Constraint]) -> None:
    """Refuse limits of one number, or of a variable, that no value keeps.

    Raises:
        InputError: they do, with the nearest limit that can be kept.
    """
    file, known = problem.study.file, dict[tuple[Any, ...], Limit]()
    for axis in problem.study.axes:
        low, high = bounds_of(axis)
        known[axis.name, "", ()] = Limit(low, high, f"the bounds of variables: {axis.name}")
    known |= {(name, "", ()): Limit(value, value, f"keep: {name}") for name, value in problem.kept.items()}
    for each in constraints:
        key = each.number.of, each.number.scene, each.number.settings
        before, own, show = known.get(key, Limit(-np.inf, np.inf, "")), each.limit, each.number.quantity.show
        for end, other, wrong in (
            ("least", "most", own.least > before.most),
            ("most", "least", own.most < before.least),
        ):
            if wrong:
                raise InputError(
                    f"{file}: constraints: {each.number.name}: {end} is {show(getattr(own, end))}, "
                    f"which contradicts {before.source}; the nearest that can be kept is "
                    f"{show(getattr(before, other))}."
                )
        source = f"constraints: {each.number.name}"
        known[key] = Limit(max(own.least, before.least), min(own.most, before.most), source)


def _check_bounds(problem: Problem) -> None:
    """Refuse bounds between which no gear exists.

    Raises:
        InputError: there is none, with the nearest value that a gear can have.
    """
    from scipy.stats import qmc

    axes, causes = problem.study.axes, list[str]()
    for point in qmc.LatinHypercube(len(axes), rng=np.random.default_rng(0)).random(TRIED):
        try:
            problem.setup(values_at(problem, point))
        except InputError as error:
            causes.append(" ".join(error.problems))
        else:
            return
    for number, axis in enumerate(axes):
        exists = partial(_exists, problem, number)
        if any(exists(place) for place in np.linspace(0, 1, TRIED)):
            continue
        low, high = bounds_of(axis)
        given = float(problem.study.base.value_at(axis.name))
        end = 0.0 if given < low else 1.0
        inside, outside = (given - low) / (high - low), end
        for _ in range(40):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if exists(middle) else (inside, middle)
        declared = SteeringGear.declared_at(axis.name)[0]
        nearest, bounds = declared.show(low + inside * (high - low)), (low, high)
        between = " to ".join(map(declared.show, bounds))
        raise InputError(
            f"{problem.study.file}: variables: {axis.name} from {between} allows no gear; "
            f"the nearest admissible value is {nearest}: {causes[0]}"
        )
    raise InputError(
        f"{problem.study.file}: variables: none of {TRIED} gears within the bounds exists; {causes[0]}"
    )


def _exists(problem: Problem, number: int, place: float) -> bool:
    """Return whether a gear exists whose variable alone is at a place between its bounds."""
    axis = problem.study.axes[number]
    alone = replace(problem, study=replace(problem.study, axes=(axis,)))
    with suppress(InputError):
        alone.setup(values_at(alone, np.array([place])))
        return True
    return False


def bounds_of(axis: Axis) -> tuple[float, float]:
    """Return least and greatest value of a variable."""
    low, high = (axis.values[0], axis.values[-1]) if axis.values else axis.distribution["numbers"]
    return float(low), float(high)


def values_at(problem: Problem, point: np.ndarray) -> dict[str, Value]:
    """Return the variables at a point of the unit cube, (variables,)."""
    values: dict[str, Value] = {}
    for axis, place in zip(problem.study.axes, point.tolist(), strict=True):
        if axis.values is not None:
            values[axis.name] = axis.values[min(int(place * len(axis.values)), len(axis.values) - 1)]
        else:
            low, high = axis.distribution["numbers"]
            values[axis.name] = float(f"{low + place * (high - low):.9g}")
    return values
