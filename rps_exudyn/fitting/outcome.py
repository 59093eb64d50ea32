"""From where the steps of a fit ended to what is said about it."""

from collections.abc import Sequence
from time import process_time

import numpy as np

from rps_exudyn.fitting.bench_tests import mixed_speeds
from rps_exudyn.fitting.curved import OtherEnd
from rps_exudyn.fitting.estimate import Estimate, Fit, FittedPass, Level, Verdict, untold
from rps_exudyn.fitting.identify import (
    NARROWED,
    LevelData,
    advice_of,
    combination_of,
    logarithmic_slopes,
)
from rps_exudyn.fitting.more_runs import WANTED, MoreRuns, more_runs, students
from rps_exudyn.fitting.noise import REPEATABILITY, SENSOR, Found, Repeats, friction_part
from rps_exudyn.fitting.problem import Problem
from rps_exudyn.fitting.series import Series, titles
from rps_exudyn.fitting.shape_estimates import (
    in_doubt,
    shape_estimates,
    shape_sentences,
    unexplained,
    with_others,
)
from rps_exudyn.fitting.solve import Solved
from rps_exudyn.fitting.unknowns import LEVEL, SIGNED, VECTORS, settings_of
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear

NORMAL = 1.959964  # quantile of 97.5 %
FAR = 2.5  # standard deviations from what was expected


def outcome_of(
    problem: Problem,
    gear: SteeringGear,
    solved: Solved,
    *,
    found: Sequence[Found],
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
            verdict = untold(sd, unknown.sd)
        interval = value * float(np.exp(-half)), value * float(np.exp(half))
        before = float(np.exp(unknown.before))
        found.append(Estimate(unknown.path, value, interval, before, unknown.sd, sd, law, verdict))
    return found


def _level(
    problem: Problem,
    solved: Solved,
    covariance: np.ndarray,
    found: Sequence[Found],
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


def _noise_words(problem: Problem, found: Sequence[Found], repeats: dict[str, Repeats]) -> str:
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
    found: Sequence[Found],
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
        if each.path in LEVEL and abs(np.log(each.value / each.prior)) > FAR * each.prior_sd:
            said.append(
                f"{each.path} lies far from what was expected: its prior pulls at it, or the model is wrong"
            )
        if each.path in LEVEL and each.path.endswith("friction") and each.value > 0.98:
            said.append(f"{each.path} is at its limit of 1")
    runouts = [each for each in estimates if each.path in (*VECTORS, *SIGNED)]
    if problem.with_offset and not any(each.verdict is Verdict.NOT_ZERO for each in runouts):
        said.append("the angle's offset is known but for whole tooth pitches: no runout tells them apart")
    return said
