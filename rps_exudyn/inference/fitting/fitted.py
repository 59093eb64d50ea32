"""The outcome of a fit: estimates, what they rest on, and what is to be said about them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from time import process_time

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.bench_tests import mixed_speeds
from rps_exudyn.inference.fitting.gauss_newton import Solved
from rps_exudyn.inference.fitting.identify import (
    NARROWED,
    WANTED,
    Advice,
    Combination,
    LevelData,
    MoreRuns,
    advice_of,
    combination_of,
    logarithmic_slopes,
    more_runs,
    students,
)
from rps_exudyn.inference.fitting.noise import REPEATABILITY, SENSOR, NoiseEstimate, Repeats, friction_part
from rps_exudyn.inference.fitting.nonlinear import OtherEnd, is_curved
from rps_exudyn.inference.fitting.prediction import NoPredictionError
from rps_exudyn.inference.fitting.problem import Problem, linearised, white_noise
from rps_exudyn.inference.fitting.series import Series, titles
from rps_exudyn.inference.fitting.unknowns import CURVED, LEVEL, SIGNED, VECTORS, Unknown, settings_of
from rps_exudyn.parameters.gear import SteeringGear

UNMOVED = 0.97  # of the prior's deviation: what is left of it where the data say nothing


class Verdict(StrEnum):
    """What a fit says of a parameter."""

    FOUND = "found"  # the data tell it, whatever the others are
    BY_PRIOR = "follows from what was given of others"
    OPEN = "not separable"
    NOT_MOVED = "as given, not found"
    NOT_ZERO = "found, differs from zero"
    MAYBE_ZERO = "not different from zero"
    UNEXPLAINED = "not identifiable: the curves are not explained to their noise"


def undetermined(sd: float, before: float) -> Verdict:
    """Verdict on an unknown that the data do not find: whether they narrowed its deviation at all."""
    return Verdict.NOT_MOVED if sd > UNMOVED * before else Verdict.OPEN


@dataclass(frozen=True)
class Estimate:
    """One parameter, SI."""

    path: str
    value: float
    interval: tuple[float, float]  # 95 %
    prior: float
    prior_sd: float  # relative where the parameter is positive, else SI
    sd: float  # the same
    by_law: float  # difference by the other contact law, likewise
    verdict: Verdict


@dataclass(frozen=True)
class Level:
    """Mean free torque, half the difference of both directions [N m]."""

    value: float
    interval: tuple[float, float]
    sd: float
    noise: str  # what the interval rests on


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
    unit: str


@dataclass(frozen=True, eq=False)
class Fit:
    """What follows from measured curves for a gear.

    Examples:
        >>> "converged" in rps.Fit.__annotations__
        True
    """

    gear: SteeringGear  # with the estimates in place
    given: SteeringGear
    level: Level | None
    estimates: list[Estimate]
    combinations: list[Combination]
    correlations: np.ndarray  # of the unknowns in `correlated`, (n, n)
    correlated: list[str]
    advice: Advice | None
    repeats: MoreRuns | None
    offset: float  # of the measured pinion angle [rad]
    offset_sd: float
    passes: list[FittedPass]
    assumed: tuple[str, ...]
    warnings: tuple[str, ...]
    converged: bool
    simulations: int
    cpu_s: float
    problem: Problem = field(repr=False)
    series: Series = field(repr=False)  # for the next gear

    def estimate(self, path: str) -> Estimate:
        """The estimate of one parameter.

        Raises:
            KeyError: it was not fitted.
        """
        for each in self.estimates:
            if each.path == path:
                return each
        raise KeyError(path)

    @property
    def left_out(self) -> tuple[str, ...]:
        """Rows of the files that were not fitted, and why."""
        return self.problem.measurement.left_out

    @property
    def found(self) -> list[str]:
        """Parameters that the data tell by themselves."""
        return [each.path for each in self.estimates if each.verdict in (Verdict.FOUND, Verdict.NOT_ZERO)]


# --- What the shape of curves tells: runout and bow by size and direction, and the angle error

SURE_SHAPE = 5.991  # chi squared of two components, 95 %
AS_GOOD = 3.84  # of chi squared, within which another end belongs to the 95 % interval
CHANCE = (
    6.0  # over the root of the points: by how much more than the white noise may be left, four deviations
)
ALIKE = 0.9  # correlation from which on two unknowns are named together
BY_HAND = "the bar between centres under a dial gauge shows its bow"


def shape_estimates(
    problem: Problem, u: np.ndarray, covariance: np.ndarray, by_law: np.ndarray, quantile: float
) -> list[Estimate]:
    """Return what is known of runout, bow and angle error."""
    found = []
    for j, unknown in enumerate(problem.unknowns):
        if unknown.component == "cos":
            found += _vector(problem, j, u[j : j + 2], covariance[j : j + 2, j : j + 2], by_law, quantile)
        elif not unknown.component and not unknown.is_level:
            found.append(_signed(unknown, float(u[j]), float(covariance[j, j]), float(by_law[j]), quantile))
    return found


def _signed(unknown: Unknown, value: float, variance: float, law: float, quantile: float) -> Estimate:
    sd = float(np.sqrt(variance))
    half = quantile * sd + abs(law)
    verdict = _shape_verdict(unknown, sd, abs(value) > half)
    return Estimate(
        unknown.path, value, (value - half, value + half), unknown.before, unknown.sd, sd, law, verdict
    )


def _shape_verdict(unknown: Unknown, sd: float, differs: bool) -> Verdict:
    """What is said of an unknown of this standard deviation, which differs from zero or not."""
    if unknown.is_curved and sd > NARROWED * unknown.sd:
        return undetermined(sd, unknown.sd)
    return Verdict.NOT_ZERO if differs else Verdict.MAYBE_ZERO


def _vector(
    problem: Problem, j: int, vector: np.ndarray, covariance: np.ndarray, by_law: np.ndarray, quantile: float
) -> list[Estimate]:
    unknown, size = problem.unknowns[j], float(np.hypot(*vector))
    along = vector / size if size else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    sds = [float(np.sqrt(way @ covariance @ way)) for way in (along, across)]
    laws = [float(by_law[j : j + 2] @ way) for way in (along, across)]
    sure = float(vector @ np.linalg.solve(covariance, vector)) > SURE_SHAPE and size > abs(laws[0])
    half = quantile * sds[0] + abs(laws[0])
    interval = max(0.0, size - half), size + half
    verdict = _shape_verdict(unknown, float(np.sqrt(np.max(np.linalg.eigvalsh(covariance)))), sure)
    before = np.hypot(unknown.before, problem.unknowns[j + 1].before)
    found = [Estimate(unknown.path, size, interval, float(before), unknown.sd, sds[0], laws[0], verdict)]
    if verdict is Verdict.NOT_ZERO:
        angle = float(np.arctan2(vector[1], vector[0]))
        half = (quantile * sds[1] + abs(laws[1])) / size
        path, sd, law = f"{unknown.path}_angle", sds[1] / size, laws[1] / size
        found.append(
            Estimate(path, angle, (angle - half, angle + half), 0.0, np.pi, sd, law, Verdict.NOT_ZERO)
        )
    return found


def with_others(each: Estimate, others: Sequence[OtherEnd]) -> Estimate:
    """Return an estimate whose interval also holds other ends that explain the curves as well."""
    values = [
        other.settings[each.path] for other in others if other.worse < AS_GOOD and each.path in other.settings
    ]
    if not values:
        return each
    low, high = min(*values, each.interval[0]), max(*values, each.interval[1])
    unsure = (low, high) != each.interval and each.path.endswith("_angle")
    return replace(each, interval=(low, high), verdict=Verdict.OPEN if unsure else each.verdict)


def unexplained(problem: Problem, converged: bool, found: Sequence[NoiseEstimate]) -> str:
    """Return what is to be said of a fit with bow or angle error that does not explain its curves' shape:
    then bow, angle error and runout may be those of a wrong end, which has small errors of its own.

    `found` is the noise of each pass about the shape's end. Noise that keeps its sign over some degrees looks
    the same; three runs or a dial gauge tell.
    """
    if not is_curved(problem):
        return ""
    passes = problem.measurement.passes
    free = [i for i, each in enumerate(passes) if each.test.of_kind.by_angle]
    left = [np.hypot(found[i].white, found[i].correlated) / white_noise(passes[i]) for i in free]
    misfit, points = float(np.sqrt(np.mean(np.square(left)))), sum(passes[i].value.size for i in free)
    if converged and misfit < 1 + CHANCE / np.sqrt(points):
        return ""
    return (
        f"what is left of the curves is {misfit:.2g} times their white noise: bow, angle error and "
        f"runout may be others, and have no interval; {BY_HAND}"
    )


def in_doubt(each: Estimate) -> Estimate:
    """Return an estimate of the shape without a claim, that of the level as it is."""
    return each if each.path in LEVEL else replace(each, verdict=Verdict.UNEXPLAINED)


def shape_sentences(
    problem: Problem, estimates: Sequence[Estimate], covariance: np.ndarray, others: Sequence[OtherEnd]
) -> Iterator[str]:
    """What the shape cannot tell apart, and which test would tell."""
    for other in others:
        size, angle = 1e3 * other.settings["rack.bow"], np.degrees(other.settings["rack.bow_angle"])
        yield (
            f"a bow of {size:.3f} mm at {angle:.0f} deg explains the curves nearly as well (chi squared "
            f"{other.worse:.1f} larger); {BY_HAND}"
        )
    unsure = (Verdict.OPEN, Verdict.NOT_MOVED)
    paths = [each.path for each in estimates if each.path in CURVED and each.verdict in unsure]
    if paths:
        yield (
            f"{' and '.join(paths)} not identifiable from these curves: an angle error shows in each turn, "
            f"a bow only over the rack's travel; turn the pinion from lock to lock, or {BY_HAND}"
        )
    sds = np.sqrt(np.diag(covariance))
    for i, one in enumerate(problem.unknowns):
        for j in range(i):
            other_one = problem.unknowns[j]
            alike = abs(covariance[i, j]) > ALIKE * sds[i] * sds[j]
            if alike and (one.is_curved or other_one.is_curved) and one.path != other_one.path:
                pair = f"{other_one.path} and {one.path}"
                yield f"{pair} are known together better than each by itself: {BY_HAND}"


# --- From where the steps of a fit ended to what is said about it

NORMAL = 1.959964  # quantile of 97.5 %
FAR_FROM_PRIOR = 2.5  # standard deviations from what was expected


def outcome_of(
    problem: Problem,
    gear: SteeringGear,
    solved: Solved,
    *,
    found: Sequence[NoiseEstimate],
    repeats: dict[str, Repeats],
    others: Sequence[OtherEnd] = (),
    by_law: np.ndarray,
    warnings: list[str],
    began: float,
) -> Fit:
    """Return the fit with its intervals, verdicts, combinations and warnings."""
    state, covariance = solved.state, covariance_of(problem, solved)
    quantile = _quantile(repeats)
    fitted = gear.replace(settings_of(problem.unknowns, state.u))
    data = level_data(problem, solved, fitted)
    estimates = [
        *_levels(problem, state.u, covariance, by_law, data, quantile),
        *shape_estimates(problem, state.u, covariance, by_law, quantile),
    ]
    count = len(problem.unknowns)
    spread = np.sqrt(np.diag(covariance))[:count]
    estimates = [with_others(each, others) for each in estimates]
    doubt = unexplained(problem, solved.converged, found)
    estimates = [in_doubt(each) for each in estimates] if doubt else estimates
    is_open = [each.path for each in estimates if each.verdict is Verdict.OPEN and each.path in LEVEL]
    unclear = [each.path for each in estimates if each.verdict in (Verdict.OPEN, Verdict.NOT_MOVED)]
    unclear = [path for path in unclear if path in LEVEL] if is_open else []
    where = [j for j, each in enumerate(problem.unknowns) if each.path in unclear]
    prior = np.array([problem.unknowns[j].sd for j in where])
    combination = combination_of(unclear, covariance[np.ix_(where, where)], prior)
    tests = problem.measurement.tests
    return Fit(
        gear=fitted,
        given=gear,
        level=_level(problem, solved, covariance, found, repeats, quantile),
        estimates=estimates,
        combinations=[combination] if combination else [],
        correlations=covariance[:count, :count] / np.outer(spread, spread),
        correlated=[f"{each.path} {each.component}".strip() for each in problem.unknowns],
        advice=advice_of(fitted, data, tests) if is_open else None,
        repeats=_more_runs(problem, solved, repeats, estimates),
        offset=state.offset,
        offset_sd=float(np.sqrt(covariance[count, count])),
        passes=_fitted_passes(problem, solved, covariance, quantile),
        assumed=problem.measurement.assumed,
        warnings=(
            *warnings,
            *_warnings(problem, fitted, solved, found, repeats, estimates),
            *shape_sentences(problem, estimates, covariance, others),
            *([doubt] if doubt else []),
        ),
        converged=solved.converged,
        simulations=problem.prediction.simulations,
        cpu_s=process_time() - began,
        problem=problem,
        series=Series(
            gear.mesh.law, tuple(each.path for each in problem.unknowns), titles(problem), state, by_law
        ),
    )


def covariance_of(problem: Problem, solved: Solved) -> np.ndarray:
    """Return the covariance of everything that was varied, (size, size).

    The shape was weighted as if its noise were white; what is correlated of it is added.
    """
    inverse = np.linalg.inv(solved.equations.information)
    added = np.zeros_like(inverse)
    for each, row, noise in zip(
        problem.measurement.passes, solved.equations.rows, problem.noises, strict=True
    ):
        if noise.correlated and row.shape.size:
            weighted = (row.weights / noise.white**2)[:, None] * row.shape
            added += weighted.T @ noise.covariance(each.angle) @ weighted
    return inverse + inverse @ added @ inverse


def level_data(problem: Problem, solved: Solved, fitted: SteeringGear) -> LevelData:
    """Return what the means tell of all level parameters, whatever the sensor's gain and zeros are."""
    paths, count, size = tuple(LEVEL), len(LEVEL), len(LEVEL) + 1 + len(problem.quiet)
    whole = np.zeros((size, size))
    whole[count:, count:] = np.diag(np.array([problem.calibrated, *problem.quiet]) ** -2.0)
    several = len(problem.prediction.blocks) > 1
    passes = problem.measurement.passes
    for each, row in zip(passes, solved.equations.rows, strict=True):
        level = np.zeros(size)
        level[:count] = logarithmic_slopes(fitted, each.test, paths)[0 if each.direction > 0 else 1]
        level[count], level[count + 1 + each.run] = float(each.value.mean()), 1.0
        model = SENSOR * friction_part(passes, each) if several else 0.0
        whole += np.outer(level, level) / (row.level_sd**2 + model**2)
    coupled = whole[:count, count:]
    left_over = coupled @ np.linalg.solve(whole[count:, count:], coupled.T)
    return LevelData(paths, whole[:count, :count] - left_over)


def _more_runs(
    problem: Problem,
    solved: Solved,
    repeats: dict[str, Repeats],
    estimates: Sequence[Estimate],
) -> MoreRuns | None:
    """What repeats of several tests would reach, where they tell preload and friction at all."""
    tests = len(problem.measurement.tests)
    known = (Verdict.FOUND, Verdict.BY_PRIOR)
    halves = {
        each.path: (each.interval[1] - each.interval[0]) / 2 / each.value
        for each in estimates
        if each.path in WANTED and each.verdict in known
    }
    if tests < 2 or not halves:
        return None
    runs = min((each.runs for each in repeats.values()), default=1) if len(repeats) == tests else 1
    return more_runs(halves, runs, tests, lambda count: _repeated(problem, solved, count / runs))


def _repeated(problem: Problem, solved: Solved, often: float) -> dict[str, float]:
    """Standard deviation of each level parameter's logarithm, were each run repeated so often: its mean and
    its own zero of the sensor scatter less, what is believed of the rest stays."""
    information = solved.equations.information.copy()
    for row in solved.equations.rows:
        information += (often - 1) * np.outer(row.level, row.level) / row.level_sd**2
    zeros = range(problem.size - len(problem.quiet), problem.size)
    information[zeros, zeros] += (often - 1) / np.array(problem.quiet) ** 2
    deviations = np.sqrt(np.diag(np.linalg.inv(information)))
    return {each.path: float(deviations[j]) for j, each in enumerate(problem.unknowns) if each.is_level}


def _quantile(repeats: dict[str, Repeats]) -> float:
    """The quantile of 97.5 %: Student's where repeats gave the scatter."""
    if not repeats:
        return NORMAL
    return students(min(each.freedom for each in repeats.values()))


def _levels(
    problem: Problem,
    u: np.ndarray,
    covariance: np.ndarray,
    by_law: np.ndarray,
    data: LevelData,
    quantile: float,
) -> list[Estimate]:
    alone, found = data.alone(), []
    for j, unknown in enumerate(problem.unknowns):
        if not unknown.is_level:
            continue
        sd, law = float(np.sqrt(covariance[j, j])), float(by_law[j])
        half, value = quantile * sd + abs(law), float(np.exp(u[j]))
        if alone[unknown.path] < NARROWED * LEVEL[unknown.path].sd:
            verdict = Verdict.FOUND
        elif sd < NARROWED * unknown.sd:
            verdict = Verdict.BY_PRIOR
        else:
            verdict = undetermined(sd, unknown.sd)
        interval = value * float(np.exp(-half)), value * float(np.exp(half))
        before = float(np.exp(unknown.before))
        found.append(Estimate(unknown.path, value, interval, before, unknown.sd, sd, law, verdict))
    return found


def _level(
    problem: Problem,
    solved: Solved,
    covariance: np.ndarray,
    found: Sequence[NoiseEstimate],
    repeats: dict[str, Repeats],
    quantile: float,
) -> Level | None:
    """The mean free torque, where it was measured."""
    turning = [i for i, block in enumerate(problem.prediction.blocks) if block.test.of_kind.by_angle]
    if not turning:
        return None
    block, count = problem.prediction.blocks[turning[0]], len(problem.unknowns)
    value = float(block.mean_torque(problem.prediction.part(turning[0], solved.state.values)))
    slope = np.zeros(problem.size)
    slope[:count] = block.mean_torque(problem.prediction.part(turning[0], solved.state.slopes))
    sd = float(np.sqrt(slope @ covariance @ slope))
    half = quantile * sd
    return Level(value, (value - half, value + half), sd, _noise_words(problem, found, repeats))


def _noise_words(problem: Problem, found: Sequence[NoiseEstimate], repeats: dict[str, Repeats]) -> str:
    """What the intervals rest on."""
    if repeats:
        runs = min(each.runs for each in repeats.values())
        freedom = min(each.freedom for each in repeats.values())
        several = f" of {len(repeats)} tests" if len(repeats) > 1 else ""
        return f"scatter of {runs} runs{several}, Student's t with {freedom} degrees of freedom"
    if any(each.correlated for each in found):
        return (
            "white and correlated noise by REML, and a declared repeatability of "
            f"{100 * REPEATABILITY:.2g} %; may be 10 % too narrow"
        )
    if len(problem.prediction.blocks) > 1:
        return f"white noise, and a declared repeatability of {100 * REPEATABILITY:.2g} % of each pass"
    return "white noise within this run; nothing is known of the scatter from run to run"


def _fitted_passes(
    problem: Problem, solved: Solved, covariance: np.ndarray, quantile: float
) -> list[FittedPass]:
    state, drawn = solved.state, []
    for number, each in enumerate(problem.measurement.passes):
        block, at = problem.block_of(number)
        values = problem.prediction.part(at, state.values)
        slopes = problem.prediction.part(at, state.slopes)
        angle = each.angle - state.offset
        if each.test.of_kind.by_angle:
            model = block.at(values, each.direction, angle)
            by_u = block.at(slopes, each.direction, angle)
        else:
            half = 0 if each.direction > 0 else 1
            model = np.full(angle.size, values[half])
            by_u = np.broadcast_to(slopes[half], (angle.size, slopes.shape[1]))
        count = by_u.shape[1]
        variance = np.einsum("ij,jk,ik->i", by_u, covariance[:count, :count], by_u)
        drawn.append(
            FittedPass(
                problem.measurement.names[each.run],
                each.test.title,
                each.test.of_kind.by_angle,
                each.direction,
                each.angle,
                each.value,
                (1 + state.gain) * model + state.zeros[each.run],
                quantile * np.sqrt(np.maximum(variance, 0.0)),
                problem.noises[number].white,
                each.test.unit,
            )
        )
    return drawn


def _warnings(
    problem: Problem,
    gear: SteeringGear,
    solved: Solved,
    found: Sequence[NoiseEstimate],
    repeats: dict[str, Repeats],
    estimates: Sequence[Estimate],
) -> list[str]:
    said = []
    if not solved.converged:
        said.append(f"the fit did not converge ({solved.why}); what it has is written, and is no estimate")
    if not repeats:
        said.append("no test was run three times: how much runs differ is not known from these data")
    if any(each.correlated for each in found):
        said.append("what is left of the curve keeps its sign over some degrees: noise is correlated")
    drifts = [each for each in found if abs(each.drift) > max(3 * each.drift_sd, 0.005)]
    if drifts:
        worst = max(abs(each.drift) for each in drifts)
        said.append(
            f"the torque drifts by {100 * worst:.2g} % over a pass: a bent rack, warming, or the sensor"
        )
    said += mixed_speeds(problem.measurement, float(GearPair.of(gear).gain))
    for name, zero, quiet in zip(problem.measurement.names, solved.state.zeros, problem.quiet, strict=True):
        if abs(zero) > 3 * quiet:
            said.append(
                f"the zero of the sensor is {zero:.2g} (SI) in {name}, which is a large part of its mean"
            )
    for test in problem.measurement.tests:
        ways = {each.direction for each in problem.measurement.passes if each.test == test}
        if len(ways) == 1:
            said.append(f"{test.title} was measured one way only: the sensor's zero counts as friction there")
    for each in estimates:
        if each.path in LEVEL and abs(np.log(each.value / each.prior)) > FAR_FROM_PRIOR * each.prior_sd:
            said.append(
                f"{each.path} lies far from what was expected: its prior pulls at it, or the model is wrong"
            )
        if each.path in LEVEL and each.path.endswith("friction") and each.value > 0.98:
            said.append(f"{each.path} is at its limit of 1")
    runouts = [each for each in estimates if each.path in (*VECTORS, *SIGNED)]
    if problem.with_offset and not any(each.verdict is Verdict.NOT_ZERO for each in runouts):
        said.append("the angle's offset is known but for whole tooth pitches: no runout separates them")
    return said


# --- What the shape of a free torque would claim to tell of the level's parameters, were the contact law true
#
# The fit does not use it (`problem`): data of one law fitted by another would move preload and friction by a
# fifth, with intervals of a few percent. It is worth seeing how sure a fit that trusts the shape would be.


def shape_claims(fit: Fit) -> dict[str, float]:
    """Return path -> standard deviation of the logarithm from means and shape together; {} if the gear has no
    equilibrium beside the fit.

    One simulation for each parameter of the level.
    """
    problem, state = fit.problem, fit.series.state
    slopes = state.slopes.copy()
    gear, unknowns = fit.given, problem.unknowns
    try:
        base = problem.prediction.simulated(gear.replace(settings_of(unknowns, state.u)))
        for j, unknown in enumerate(unknowns):
            if unknown.is_level:
                stepped = state.u.copy()
                stepped[j] += unknown.step
                moved = problem.prediction.simulated(gear.replace(settings_of(unknowns, stepped)))
                slopes[:, j] = (moved - base) / unknown.step
    except NoPredictionError:
        return {}
    trusting = linearised(replace(problem, trusted=True), replace(state, slopes=slopes))
    deviations = np.sqrt(np.diag(np.linalg.inv(trusting.information)))
    return {each.path: float(deviations[j]) for j, each in enumerate(unknowns) if each.path in LEVEL}
