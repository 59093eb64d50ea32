"""What the shape of curves tells: runout and bow by size and direction, and the angle error."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from rps_exudyn.fitting.curved import OtherEnd
from rps_exudyn.fitting.estimate import Estimate, Verdict, untold
from rps_exudyn.fitting.identify import NARROWED
from rps_exudyn.fitting.noise import Found
from rps_exudyn.fitting.problem import Problem, white_noise
from rps_exudyn.fitting.two_parts import is_curved
from rps_exudyn.fitting.unknowns import CURVED, LEVEL, Unknown

SURE = 5.991  # chi squared of two components, 95 %
AS_GOOD = 3.84  # of chi squared, within which another end belongs to the 95 % interval
CHANCE = (
    6.0  # over the root of the points: by how much more than the white noise may be left, four deviations
)
ALIKE = 0.9  # correlation from which on two unknowns are named together
BY_HAND = "the bar between centres under a dial gauge tells its bow"


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
    verdict = _verdict(unknown, sd, abs(value) > half)
    return Estimate(
        unknown.path, value, (value - half, value + half), unknown.before, unknown.sd, sd, law, verdict
    )


def _verdict(unknown: Unknown, sd: float, differs: bool) -> Verdict:
    """What is said of an unknown of this standard deviation, which differs from zero or not."""
    if unknown.is_curved and sd > NARROWED * unknown.sd:
        return untold(sd, unknown.sd)
    return Verdict.NOT_ZERO if differs else Verdict.MAYBE_ZERO


def _vector(
    problem: Problem, j: int, vector: np.ndarray, covariance: np.ndarray, by_law: np.ndarray, quantile: float
) -> list[Estimate]:
    unknown, size = problem.unknowns[j], float(np.hypot(*vector))
    along = vector / size if size else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    sds = [float(np.sqrt(way @ covariance @ way)) for way in (along, across)]
    laws = [float(by_law[j : j + 2] @ way) for way in (along, across)]
    sure = float(vector @ np.linalg.solve(covariance, vector)) > SURE and size > abs(laws[0])
    half = quantile * sds[0] + abs(laws[0])
    interval = max(0.0, size - half), size + half
    verdict = _verdict(unknown, float(np.sqrt(np.max(np.linalg.eigvalsh(covariance)))), sure)
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


def unexplained(problem: Problem, converged: bool, found: Sequence[Found]) -> str:
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
            f"{' and '.join(paths)} not told by these curves: an angle error shows in each turn, a bow only "
            f"over the rack's travel; turn the pinion from lock to lock, or {BY_HAND}"
        )
    sds = np.sqrt(np.diag(covariance))
    for i, one in enumerate(problem.unknowns):
        for j in range(i):
            other_one = problem.unknowns[j]
            alike = abs(covariance[i, j]) > ALIKE * sds[i] * sds[j]
            if alike and (one.is_curved or other_one.is_curved) and one.path != other_one.path:
                pair = f"{other_one.path} and {one.path}"
                yield f"{pair} are known together better than each by itself: {BY_HAND}"
