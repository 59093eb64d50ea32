"""The outcome of a fit: estimates, what they rest on, and what is to be said about them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from rps_exudyn.inference.fitting import identifiability
from rps_exudyn.inference.fitting.adjustment import Adjustment, adjustment_of
from rps_exudyn.inference.fitting.diagnosis import Refusal, notes, refusals
from rps_exudyn.inference.fitting.level import LevelEstimate, Runout, Wave, runout_of
from rps_exudyn.inference.fitting.level_fit import LevelModel, stepped
from rps_exudyn.inference.fitting.noise import NORMAL
from rps_exudyn.inference.fitting.nonlinear import OtherShape, first_slopes
from rps_exudyn.inference.fitting.posterior import SAMPLES, level_samples, runout_samples, shape_samples
from rps_exudyn.inference.fitting.prediction import NoPredictionError
from rps_exudyn.inference.fitting.problem import FitState, Problem, level_rows, linearised, white_noise
from rps_exudyn.inference.fitting.series import Series, titles
from rps_exudyn.inference.fitting.unknowns import (
    LEVEL,
    NUISANCES,
    SHAPE_PARAMETERS,
    SIGNED,
    VECTORS,
    WITHOUT_YOKE,
    Unknown,
    settings_of,
    unknowns_of,
)
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.judged_row import JudgedRow, Verdict
from rps_exudyn.results.limit import Limit

Ends = tuple[float, float]
UNMOVED = 0.97  # of the prior's deviation: what is left of it where the data determine nothing


def undetermined(sd: float, before: float) -> Verdict:
    """Verdict on an unknown that the data do not find: whether they narrowed its deviation at all."""
    return Verdict.NOT_MOVED if sd > UNMOVED * before else Verdict.OPEN


@dataclass(frozen=True, kw_only=True)
class Estimate(JudgedRow):
    """One parameter, by the name of its path, with its 95 % interval."""

    prior: float  # its value before the fit, SI
    prior_sd: float  # relative where the parameter is positive, else SI
    sd: float  # the same, after the fit
    by_law: float  # difference by the other contact law, likewise

    @classmethod
    def of(
        cls, path: str, value: float, interval: Ends, before: Ends, sd: float, by_law: float, verdict: Verdict
    ) -> "Estimate":
        """Return the estimate of a parameter; `before` are its prior value and deviation."""
        (low, high), (prior, prior_sd) = interval, before
        fields: dict[str, Any] = {"name": path, "value": value, "low": low, "high": high, "verdict": verdict}
        return cls(**fields, prior=prior, prior_sd=prior_sd, sd=sd, by_law=by_law)

    @property
    def path(self) -> str:
        return self.name

    @property
    def interval(self) -> Ends:
        return self.low, self.high


@dataclass(frozen=True, eq=False)
class FittedPass:
    """A measured pass with the model's curve and its 95 % band, for pictures."""

    name: str
    test: str
    by_angle: bool  # whether its curve is compared, not its mean alone
    direction: int
    angle: np.ndarray
    value: np.ndarray
    model: np.ndarray
    half_band: np.ndarray
    noise: float  # standard deviation of a point


@dataclass(frozen=True, eq=False)
class Fit:
    """What follows from measured curves for a gear. All values are SI.

    Attributes:
        problem: the data and unknowns of the fit.
        given: the gear before the fit.
        gear: the gear with the estimates in place.
        model: levels and their model, as the last simulation corrects it.
        ended: where the search of the levels ended.
        shape_state: where that of the shape ended; None without a bow or an angle error.
        other_shapes: other gears that explain the curves nearly as well.
        use_runout_prior: whether an own prior of the runout counts.
        offset: of the measured pinion angle [rad].
        offset_sd: its standard deviation [rad].
        by_law: what another contact law moves, shape (unknowns,).
        limits: within which the yoke's adjustment is to bring the gear.
        remarks: what was to be said before the search ended.
        simulations: how many gears were simulated.
        cpu_s: CPU time, of all processes [s].

    Examples:
        >>> curve = rps.run("free-pinion-torque", fidelity="quasi-static")
        >>> table = np.column_stack([curve["pinion_angle"], 1.05 * curve["pinion_torque"]])
        >>> np.savetxt("bench.csv", table, header="angle [rad],torque [N m]", delimiter=",", comments="")
        >>> found = rps.fit(["bench.csv"], free=["yoke.preload", "bush.drag"], other_law=False)
        >>> found.converged, found.correlations.shape
        (True, (2, 2))
        >>> found.gear.yoke.preload == found.estimate("yoke.preload").value
        True
    """

    problem: Problem = field(repr=False)
    given: SteeringGear
    gear: SteeringGear
    model: LevelModel = field(repr=False)
    ended: FitState = field(repr=False)
    shape_state: FitState | None = field(repr=False)
    other_shapes: Sequence[OtherShape]
    use_runout_prior: bool
    offset: float
    offset_sd: float
    by_law: np.ndarray
    limits: Mapping[str, Limit]
    remarks: tuple[str, ...] = ()
    simulations: int = 0
    cpu_s: float = 0.0

    @property
    def converged(self) -> bool:
        """Whether the search reached its minimum."""
        return self.ended.converged and (self.shape_state is None or self.shape_state.converged)

    @property
    def levels(self) -> tuple[LevelEstimate, ...]:
        return tuple(self.problem.levels)

    @property
    def level(self) -> LevelEstimate | None:
        """Level of the free torque: half the difference of both directions [N m]."""
        return next((each for each in self.levels if each.test.of_kind.by_angle), None)

    @cached_property
    def runout(self) -> Runout | None:
        """Size and direction of the pinion's runout; None where no curve shows a turn."""
        preload = self.gear.yoke.preload
        return runout_in(self.problem, preload, self.preload_sd, self.use_runout_prior, self.shape_state)

    @property
    def preload_sd(self) -> float:
        """Standard deviation of the preload's logarithm; 0 where it is not fitted."""
        sds = np.sqrt(np.diag(self.ended.covariance)).tolist()
        return dict(zip([each.path for each in self.model.unknowns], sds, strict=True)).get(
            "yoke.preload", 0.0
        )

    @cached_property
    def adjustment(self) -> Adjustment | None:
        """What brings the free torque within `limits`: a turn of the yoke's plug, or another spring; None
        without curves in both directions, or without convergence."""
        return adjustment_of(self, self.limits)

    @cached_property
    def refusals(self) -> tuple[Refusal, ...]:
        """Why nothing counts as found although its interval is narrow."""
        return tuple(refusals(self.problem, self.model, self.ended))

    @cached_property
    def estimates(self) -> list[Estimate]:
        """Value, 95 % interval and verdict of each fitted parameter."""
        found = _levels(self)
        if self.runout is not None:
            found += _runouts(self, self.runout)
        if self.shape_state is not None:
            shapes = shape_estimates(self, self.shape_state)
            shapes = [with_others(each, self.other_shapes) for each in shapes]
            doubt = unexplained(self.problem, self.shape_state)
            found += [replace(each, verdict=Verdict.UNEXPLAINED) for each in shapes] if doubt else shapes
        return found

    def estimate(self, path: str) -> Estimate:
        """The estimate of one parameter.

        Raises:
            KeyError: it was not fitted.
        """
        return {each.path: each for each in self.estimates}[path]

    @property
    def found(self) -> list[str]:
        """Parameters that the data determine by themselves."""
        return [each.path for each in self.estimates if each.verdict in (Verdict.FOUND, Verdict.NOT_ZERO)]

    @property
    def is_separable(self) -> bool:
        """Whether no parameter of the level is narrowed and yet open."""
        return not any(each.verdict is Verdict.OPEN and each.path in LEVEL for each in self.estimates)

    @property
    def combinations(self) -> list[identifiability.Combination]:
        """Products that the data determine where they do not determine each factor."""
        if self.is_separable:
            return []
        unsure, paths = (Verdict.OPEN, Verdict.NOT_MOVED), [each.path for each in self.model.unknowns]
        unclear = [each.path for each in self.estimates if each.verdict in unsure and each.path in LEVEL]
        where = [paths.index(path) for path in unclear]
        prior = np.array([self.model.unknowns[j].sd for j in where])
        found = identifiability.combination_of(unclear, self.ended.covariance[np.ix_(where, where)], prior)
        return [found] if found else []

    @cached_property
    def correlated(self) -> list[str]:
        """Paths of the unknowns of level and shape."""
        names = [each.path for each in self.model.unknowns]
        if self.shape_state is not None:
            shapes = [each for each in self.problem.unknowns if not each.is_level]
            names += [f"{each.path} {each.component}".strip() for each in shapes]
        return names

    @cached_property
    def correlations(self) -> np.ndarray:
        """Of the unknowns in `correlated`, shape (n, n); those of level and shape are none."""
        covariance = self.ended.covariance
        if self.shape_state is not None:
            where = [j for j, each in enumerate(self.problem.unknowns) if not each.is_level]
            shapes = self.shape_state.covariance[np.ix_(where, where)]
            zero = np.zeros((covariance.shape[0], shapes.shape[0]))
            covariance = np.block([[covariance, zero], [zero.T, shapes]])
        spread = np.sqrt(np.diag(covariance))
        return np.asarray(covariance / np.outer(spread, spread))

    @cached_property
    def advice(self) -> identifiability.Advice | None:
        """The tests that would determine most of the rest."""
        if self.is_separable:
            return None
        paths, rows, tests = (*LEVEL, *NUISANCES), self.problem.rows, self.problem.measurement.tests
        by_test = {test: identifiability.logarithmic_slopes(self.gear, test, paths) for test in tests}
        slopes = rows.of_means(by_test)
        data = identifiability.LevelData(paths, slopes.T @ np.linalg.solve(rows.covariance, slopes))
        return identifiability.advice_of(self.gear, data, tests)

    @cached_property
    def repeats(self) -> identifiability.MoreRuns | None:
        """How many more runs of all tests narrow the intervals; None of one test."""
        half_intervals = {
            each.path: (each.interval[1] - each.interval[0]) / 2 / each.value
            for each in self.estimates
            if each.path in identifiability.WANTED and each.verdict in (Verdict.FOUND, Verdict.BY_PRIOR)
        }
        if len(self.levels) < 2 or not half_intervals:
            return None
        runs = min(each.runs for each in self.levels)
        slopes, (_, sd) = self.model.slopes(self.ended.u), self.model.priors()

        def repeated(count: int) -> dict[str, float]:
            covariance = level_rows(self.levels, count / runs).covariance
            information = np.diag(sd**-2.0) + slopes.T @ np.linalg.solve(covariance, slopes)
            deviations = np.sqrt(np.diag(np.linalg.inv(information)))
            return {each.path: float(deviations[j]) for j, each in enumerate(self.model.unknowns)}

        return identifiability.more_runs(half_intervals, runs, repeated)

    @cached_property
    def passes(self) -> list[FittedPass]:
        """Measured and fitted curves of each pass."""
        problem, state, drawn = self.problem, self.ended, []
        slopes, rows = self.model.slopes(state.u), problem.rows
        variances = np.einsum("ij,jk,ik->i", slopes, state.covariance, slopes)
        of_rows = problem.rows_of(state.values)
        for number, each in enumerate(problem.measurement.passes):
            block, at = problem.block_of(number)
            values = problem.prediction.part(at, state.values)
            of_test = [i for i, test in enumerate(rows.tests) if test == each.test]
            zero = rows.values[of_test[1]] - of_rows[of_test[1]] if len(of_test) == 2 else 0.0
            half = NORMAL * float(np.sqrt(max(variances[of_test[0]], 0.0)))
            name, test, white = problem.measurement.names[each.run], each.test, problem.whites[number]
            model = block.at(values, each.direction, each.angle - self.offset) + zero
            band, by_angle = np.full(each.angle.size, half), test.of_kind.by_angle
            measured = name, test.title, by_angle, each.direction, each.angle, each.value
            drawn.append(FittedPass(*measured, model, band, white))
        return drawn

    @property
    def assumed(self) -> tuple[str, ...]:
        """What the files leave open, and what was assumed of it."""
        return self.problem.measurement.assumed

    @property
    def left_out(self) -> tuple[str, ...]:
        """Rows of the files that were not fitted, and why."""
        return self.problem.measurement.left_out

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What makes the estimates doubtful."""
        said = [*self.remarks, *(each.sentence for each in self.refusals), *notes(self.problem, self.gear)]
        said += _warnings(self)
        if self.shape_state is not None:
            said += shape_sentences(self, self.shape_state)
            said += [doubt] if (doubt := unexplained(self.problem, self.shape_state)) else []
        return tuple(said)

    @cached_property
    def series(self) -> Series:
        """What the fit of the next gear may begin with."""
        fitted = dict(zip([each.path for each in self.model.unknowns], self.ended.u, strict=True))
        unknowns = self.problem.unknowns
        u = np.zeros(len(unknowns)) if self.shape_state is None else self.shape_state.u
        u = with_runout_of(self.gear, self.problem, u)
        u = np.array([fitted.get(each.path, value) for each, value in zip(unknowns, u, strict=True)])
        paths, law = tuple(each.path for each in unknowns), self.given.mesh.contact_law
        return Series(law, paths, titles(self.problem), u, self.ended.values, self.by_law)

    @cached_property
    def posterior(self) -> dict[str, np.ndarray]:
        """Path -> values (SAMPLES,) of what was fitted, as it varies together, SI; {} without an estimate."""
        if not self.converged:
            return {}
        problem, state = self.problem, self.shape_state
        moved = np.array([self.laws.get(each.path, 0.0) for each in self.model.unknowns])
        found = level_samples(self.model, self.ended, moved)
        if self.runout is not None:
            preload = found.get("yoke.preload", np.full(SAMPLES, self.gear.yoke.preload))
            found |= runout_samples(self.runout, self.gear.pinion.runout_angle, self.offset_sd, preload)
        shaping = [j for j, each in enumerate(problem.unknowns) if each.path not in (*LEVEL, "pinion.runout")]
        if state is not None and shaping and not unexplained(problem, state):
            covariance = state.covariance[np.ix_(shaping, shaping)]
            unknowns = [problem.unknowns[j] for j in shaping]
            found |= shape_samples(unknowns, state.u[shaping], covariance, self.by_law[shaping])
        return found

    @property
    def laws(self) -> dict[str, float]:
        """Path of the level's parameters -> what another contact law moves."""
        unknowns = zip(self.problem.unknowns, self.by_law.tolist(), strict=True)
        return {each.path: law for each, law in unknowns if each.is_level}


# --- What the shape of curves determines: runout and bow by size and direction, and the angle error

SURE_SHAPE = 5.991  # chi squared of two components, 95 %
AS_GOOD = 3.84  # of chi squared, within which another end belongs to the 95 % interval
CHANCE = 6.0  # over the root of the points: four deviations of what may be left beside the white noise
SOFT = 1.22  # over the weighted mean square of white noise, whose tails the soft loss takes back
ALIKE = 0.9  # correlation from which on two unknowns are named together
BY_HAND = "the bar between centres under a dial gauge shows its bow"


def shape_estimates(fit: Fit, state: FitState) -> list[Estimate]:
    found, covariance = [], state.covariance
    for j, unknown in enumerate(fit.problem.unknowns):
        if unknown.path == "pinion.runout":
            continue
        if unknown.component == "cos":
            two = slice(j, j + 2)
            found += _vector(fit.problem.unknowns[two], state.u[two], covariance[two, two], fit.by_law[two])
        elif not unknown.component and not unknown.is_level:
            value, sd, law = float(state.u[j]), float(np.sqrt(covariance[j, j])), float(fit.by_law[j])
            half = NORMAL * sd + abs(law)
            verdict = _shape_verdict(unknown, sd, abs(value) > half)
            interval, before = (value - half, value + half), (unknown.before, unknown.sd)
            found.append(Estimate.of(unknown.path, value, interval, before, sd, law, verdict))
    return found


def _shape_verdict(unknown: Unknown, sd: float, differs: bool) -> Verdict:
    """What is said of an unknown of this standard deviation, which differs from zero or not."""
    if unknown.needs_shape_fit and sd > identifiability.NARROWED * unknown.sd:
        return undetermined(sd, unknown.sd)
    return Verdict.NOT_ZERO if differs else Verdict.MAYBE_ZERO


def _vector(
    unknowns: Sequence[Unknown], vector: np.ndarray, covariance: np.ndarray, by_law: np.ndarray
) -> list[Estimate]:
    """Estimates of a vector's size and, where it differs from zero, of its direction."""
    (unknown, other), size = unknowns, float(np.hypot(*vector))
    along = vector / size if size else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    sds = [float(np.sqrt(direction @ covariance @ direction)) for direction in (along, across)]
    laws = [float(by_law @ direction) for direction in (along, across)]
    sure = float(vector @ np.linalg.solve(covariance, vector)) > SURE_SHAPE and size > abs(laws[0])
    half = NORMAL * sds[0] + abs(laws[0])
    interval = max(0.0, size - half), size + half
    verdict = _shape_verdict(unknown, float(np.sqrt(np.max(np.linalg.eigvalsh(covariance)))), sure)
    before = float(np.hypot(unknown.before, other.before)), unknown.sd
    found = [Estimate.of(unknown.path, size, interval, before, sds[0], laws[0], verdict)]
    if verdict is Verdict.NOT_ZERO:
        angle = float(np.arctan2(vector[1], vector[0]))
        half = (NORMAL * sds[1] + abs(laws[1])) / size
        path, sd, law = f"{unknown.path}_angle", sds[1] / size, laws[1] / size
        ends = angle - half, angle + half
        found.append(Estimate.of(path, angle, ends, (0.0, np.pi), sd, law, Verdict.NOT_ZERO))
    return found


def with_others(each: Estimate, others: Sequence[OtherShape]) -> Estimate:
    """Return an estimate whose interval also holds other ends that explain the curves as well."""
    as_good = [other.settings for other in others if other.worse < AS_GOOD]
    values = [settings[each.path] for settings in as_good if each.path in settings]
    if not values:
        return each
    low, high = min(*values, each.interval[0]), max(*values, each.interval[1])
    unsure = (low, high) != each.interval and each.path.endswith("_angle")
    return replace(each, low=low, high=high, verdict=Verdict.OPEN if unsure else each.verdict)


def unexplained(problem: Problem, shape: FitState) -> str:
    """Return what is to be said of a fit with bow or angle error that does not explain its curves' shape:
    then bow, angle error and runout may be those of a wrong end, which has small errors of its own.

    Noise that keeps its sign over some degrees looks the same; three runs or a dial gauge decide.
    """
    passes = [each for each in problem.measurement.passes if each.test.of_kind.by_angle]
    squares = [float(row.weights @ row.deviation**2 / row.weights.sum()) for row in shape.rows]
    parts = [SOFT * (each / white_noise(of) ** 2) for each, of in zip(squares, passes, strict=True)]
    points = sum(each.value.size for each in passes)
    misfit = float(np.sqrt(np.mean(parts)))
    if shape.converged and misfit < 1 + CHANCE / np.sqrt(points):
        return ""
    return (
        f"the residual of the curves is {misfit:.2g} times their white noise: bow, angle error and runout "
        f"are uncertain and have no interval; {BY_HAND}"
    )


def shape_sentences(fit: Fit, state: FitState) -> Iterator[str]:
    """What the shape cannot separate, and which test would."""
    for other in fit.other_shapes:
        size, angle = 1e3 * other.settings["rack.bow"], np.degrees(other.settings["rack.bow_angle"])
        yield (
            f"a bow of {size:.3f} mm at {angle:.0f} deg explains the curves nearly as well (chi squared "
            f"{other.worse:.1f} larger); {BY_HAND}"
        )
    unsure = (Verdict.OPEN, Verdict.NOT_MOVED)
    paths = [e.path for e in fit.estimates if e.path in SHAPE_PARAMETERS and e.verdict in unsure]
    if paths:
        yield (
            f"{' and '.join(paths)} not identifiable from these curves: an angle error shows in each turn, "
            f"a bow only over the rack's travel; turn the pinion from lock to lock, or {BY_HAND}"
        )
    covariance, unknowns = state.covariance, fit.problem.unknowns
    sds = np.sqrt(np.diag(covariance))
    for i, one in enumerate(unknowns):
        for j, other_one in enumerate(unknowns[:i]):
            alike = abs(covariance[i, j]) > ALIKE * sds[i] * sds[j]
            if alike and (one.needs_shape_fit or other_one.needs_shape_fit) and one.path != other_one.path:
                pair = f"{other_one.path} and {one.path}"
                yield f"{pair} are known better in combination than each by itself: {BY_HAND}"


# --- From where the steps of a fit ended to what is said about it

FAR_FROM_PRIOR = 2.5  # standard deviations from what was expected
WIDER = 3.0  # times the deviations of all priors: what is found hardly moves by them
WIDEST = {
    "yoke.preload": 0.20,
    "mesh.friction": 0.35,
    "yoke.friction": 0.40,
    "bush.drag": 0.25,
    "bearing.friction_torque": 0.20,
}
"""Half of the 95 % interval with such wide priors, of the value, from which on nothing is found."""
DRAG_WITHOUT_YOKE = "bush.drag without yoke"


def runout_in(
    problem: Problem, preload: float, preload_sd: float, use_prior: bool, shape: FitState | None
) -> Runout | None:
    """Return the runout that the free torque shows, for a preload [N]; None where it is not fitted or no turn
    was covered.

    Half the sum of both directions shows it. With a bow, which moves that sum over the travel, it is what the
    shape's steps found beside the bow, if they explain the curves.
    """
    components = [each for each in problem.unknowns if each.path == "pinion.runout"]
    free = [each for each in problem.levels if each.test.of_kind.by_angle and each.first is not None]
    if not components or not free:
        return None
    if shape is not None and not unexplained(problem, shape):
        return runout_of(replace(free[0], first=_wave_of_shape(problem, shape, preload)), preload, preload_sd)
    seen = free[0].first
    if not use_prior or seen is None or not seen.size:
        return runout_of(free[0], preload, preload_sd)
    cos, sin = (each.before for each in components)
    size = float(np.hypot(cos, sin))  # in whatever direction the curve shows
    prior = Wave(preload * size * seen.vector / seen.size, preload * components[0].sd)
    found = runout_of(free[0], preload, preload_sd, prior)
    return found and replace(found, angle_sd=seen.sd / seen.size)


def _wave_of_shape(problem: Problem, shape: FitState, preload: float) -> Wave:
    """The half sum's wave of the runout that the shape's steps found, by the larger of its two deviations;
    `preload` is that of a fit that holds it.

    It is -P (e_c sin + e_s cos) over the model's angle, which is the measured one less the offset.
    """
    u, paths = shape.u, [each.path for each in problem.unknowns]
    j = paths.index("pinion.runout")
    of_preload = [k for k, path in enumerate(paths) if path == "yoke.preload"]
    where = [j, j + 1, *of_preload]
    by = np.column_stack([np.eye(2), *(u[j : j + 2] for _ in of_preload)])  # of P e by e and ln P, over P
    spread = by @ shape.covariance[np.ix_(where, where)] @ by.T
    preload = settings_of(problem.unknowns, u).get("yoke.preload", preload)
    e_c, e_s, sin, cos = float(u[j]), float(u[j + 1]), np.sin(shape.offset), np.cos(shape.offset)
    vector = -preload * np.array([e_s * cos - e_c * sin, e_c * cos + e_s * sin])
    return Wave(vector, preload * float(np.sqrt(np.linalg.eigvalsh(spread)[-1])))


def with_runout_of(gear: SteeringGear, problem: Problem, u: np.ndarray) -> np.ndarray:
    """Return the unknowns (unknowns,) with the components of a gear's runout in place."""
    u, size, angle = u.copy(), gear.pinion.runout, gear.pinion.runout_angle
    for j, each in enumerate(problem.unknowns):
        if each.path == "pinion.runout":
            u[j] = size * (np.cos(angle) if each.component == "cos" else np.sin(angle))
    return u


def _levels(fit: Fit) -> list[Estimate]:
    """Estimates of the level's parameters; found is what wider priors hardly move."""
    wide, unknowns, found = _with_wide_priors(fit), fit.model.unknowns, []
    has_yoke_out = any(test.kind == "yoke-out" for test in fit.problem.measurement.tests)
    paths = [each.path for each in unknowns]
    for unknown, direction in zip(unknowns, np.eye(len(paths)), strict=True):
        if unknown.is_nuisance:
            continue
        law = fit.laws[unknown.path]
        verdict = _verdict(unknown, direction, fit.ended, wide, law)
        if verdict is Verdict.FOUND and fit.refusals and unknown.path != "bearing.friction_torque":
            verdict = Verdict.BY_PRIOR
        if unknown.path == "bush.drag" and has_yoke_out and verdict is not Verdict.FOUND:
            verdict = Verdict.BY_RATIO
        found.append(_estimate(unknown, unknown.path, direction, fit.ended, law, verdict))
        if verdict is Verdict.BY_RATIO:
            direction = direction + np.eye(len(paths))[paths.index(WITHOUT_YOKE)]
            verdict = _verdict(unknown, direction, fit.ended, wide, law)
            if verdict is Verdict.FOUND:
                found.append(_estimate(unknown, DRAG_WITHOUT_YOKE, direction, fit.ended, law, verdict))
    return found


def _with_wide_priors(fit: Fit) -> FitState:
    """The end with priors three times as wide, parameters that were not freed doubted as well; of the fit's
    unknowns."""
    u, paths = fit.ended.u, [each.path for each in fit.model.unknowns]
    held = [path for path in LEVEL if path not in paths and fit.gear.value_at(path) > 0]
    doubted = unknowns_of(fit.gear, held, {})
    model = replace(fit.model, unknowns=[*fit.model.unknowns, *doubted]).with_priors(WIDER)
    wide = stepped(model, np.append(u, [each.before for each in doubted]))
    covariance = wide.covariance[: u.size, : u.size]
    return replace(wide, u=wide.u[: u.size], information=np.linalg.inv(covariance))


def _verdict(unknown: Unknown, direction: np.ndarray, end: FitState, wide: FitState, law: float) -> Verdict:
    """What is said of the sum of logarithms that `direction` (unknowns,) makes."""
    sd, widened = (float(np.sqrt(direction @ each @ direction)) for each in (end.covariance, wide.covariance))
    still = abs(float(direction @ (wide.u - end.u))) < sd
    narrow = np.exp(NORMAL * widened + abs(law)) - 1 <= WIDEST[unknown.path]
    if still and narrow and end.converged and wide.converged:
        return Verdict.FOUND
    return Verdict.BY_PRIOR if sd < identifiability.NARROWED * unknown.sd else undetermined(sd, unknown.sd)


def _estimate(
    unknown: Unknown, path: str, direction: np.ndarray, end: FitState, law: float, verdict: Verdict
) -> Estimate:
    sd, value = float(np.sqrt(direction @ end.covariance @ direction)), float(np.exp(direction @ end.u))
    half = NORMAL * sd + abs(law)
    interval = value * float(np.exp(-half)), value * float(np.exp(half))
    before = float(np.exp(unknown.before)), unknown.sd
    return Estimate.of(path, value, interval, before, sd, law, verdict)


def _runouts(fit: Fit, runout: Runout) -> list[Estimate]:
    unknown, other = (each for each in fit.problem.unknowns if each.path == "pinion.runout")
    law = -runout.size * fit.laws.get("yoke.preload", 0.0)
    low, high = runout.interval
    interval = max(0.0, low - abs(law)), high + abs(law)
    verdict = Verdict.NOT_ZERO if runout.is_found else Verdict.MAYBE_ZERO
    sd = (high - low) / 2 / NORMAL
    size = float(np.hypot(unknown.before, other.before))
    found = [Estimate.of(unknown.path, runout.size, interval, (size, unknown.sd), sd, law, verdict)]
    if runout.is_found:
        angle, sd = fit.gear.pinion.runout_angle, float(np.hypot(runout.angle_sd, fit.offset_sd))
        ends = angle - NORMAL * sd, angle + NORMAL * sd
        found.append(Estimate.of("pinion.runout_angle", angle, ends, (0.0, np.pi), sd, 0.0, verdict))
    return found


def _warnings(fit: Fit) -> Iterator[str]:
    if not fit.converged:
        why = fit.ended.why or (fit.shape_state.why if fit.shape_state else "")
        yield f"the fit did not converge ({why}); its last iteration is written, not an estimate"
    for each in fit.estimates:
        if each.path in LEVEL and abs(np.log(each.value / each.prior)) > FAR_FROM_PRIOR * each.prior_sd:
            yield f"{each.path} lies far from the prior: the prior or the model may be wrong"
        if each.path in LEVEL and each.path.endswith("friction") and each.value > 0.98:
            yield f"{each.path} is at its limit of 1"
    runouts = [each for each in fit.estimates if each.path in (*VECTORS, *SIGNED)]
    if fit.problem.with_offset and not any(each.verdict is Verdict.NOT_ZERO for each in runouts):
        yield "the offset of the angle is known except for whole tooth pitches, as there is no runout"


# --- What the shape of a free torque would determine of the level's parameters, were the contact law true
#
# The fit does not use it (`problem`): data of one law fitted by another would move preload and friction by a
# fifth, with intervals of a few percent. It is worth seeing how sure a fit that trusts the shape would be.


def shape_claims(fit: Fit) -> dict[str, float]:
    """Return path -> standard deviation of the logarithm from means and shape together; {} if the gear has no
    equilibrium beside the fit.

    One simulation for each parameter of the level.
    """
    problem, gear = fit.problem, fit.given
    held = {path: fit.gear.value_at(path) for path in (*VECTORS, *SIGNED, "rack.bow_angle")}
    names = [j for j, each in enumerate(problem.unknowns) if each.is_level]
    level_problem = replace(problem, unknowns=[problem.unknowns[j] for j in names])
    gear = gear.replace(held | {"pinion.runout_angle": fit.gear.pinion.runout_angle})
    u, values = fit.series.u[names], fit.series.values
    state = FitState(u, values, fit.offset, np.zeros((values.size, u.size)))
    if not problem.with_offset or not names:
        return {}
    try:
        slopes = first_slopes(level_problem, gear, state)
    except NoPredictionError:
        return {}
    trusting = linearised(level_problem, replace(state, slopes=slopes))
    deviations = np.sqrt(np.diag(np.linalg.inv(trusting.information)))
    return {each.path: float(deviations[j]) for j, each in enumerate(level_problem.unknowns)}
