"""Fit a gear to measured curves.

    fit = rps.fit(["free.csv", "yoke-out=b.csv", "bearing=c.csv", "load-test@80kg=d.csv"])
    fit.level.value, fit.found, fit.gear

The model is the gear in equilibrium. Gauss and Newton's steps with Broyden's slopes improve a start by the
closed form; the noise that is left gives the intervals; the same fit with another contact law tells what that
choice changes, which is added to the intervals.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.bench_tests import MeasuredPass, Measurement, read_measurement
from rps_exudyn.inference.fitting.fitted import Fit, outcome_of
from rps_exudyn.inference.fitting.gauss_newton import Solved, solve
from rps_exudyn.inference.fitting.initial_guess import first_slopes, scanned_offset, start_of
from rps_exudyn.inference.fitting.noise import (
    SENSOR,
    NoiseEstimate,
    Repeats,
    found_noise,
    noises_of,
    repeats_of,
)
from rps_exudyn.inference.fitting.nonlinear import OtherEnd, is_curved, level_of, shape_of
from rps_exudyn.inference.fitting.prediction import (
    TURN,
    NoPredictionError,
    Prediction,
    formula_means,
    within_the_teeth,
)
from rps_exudyn.inference.fitting.problem import ZERO, Problem, State, white_noise
from rps_exudyn.inference.fitting.series import Series
from rps_exudyn.inference.fitting.unknowns import CURVED, USUAL, settings_of, unknowns_of
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.simulate.cases.run_cases import CaseRunner
from rps_exudyn.solvers.closed_form import closed_form

LEAST_TURN = 0.8  # of a turn, that a curve must cover to tell of the runout
COARSE = 0.3  # of a standard error: a step that ends the fit by another law
OTHER_LAW = {"line": "teeth", "teeth": "line", "area": "line"}


def fit(
    files: Iterable[str | Path] | Measurement,
    gear: SteeringGear | None = None,
    *,
    free: Sequence[str] = USUAL,
    priors: Mapping[str, tuple[float, float]] | None = None,
    columns: Mapping[str, str] | None = None,
    other_law: bool = True,
    like: Fit | Series | None = None,
    jobs: int = 1,
    time_limit: float = float("inf"),
) -> Fit:
    """Estimate parameters of a gear from measured curves.

    Args:
        files: measured files, "FILE" or "TEST=FILE" (`bench_tests.KINDS`); or a `Measurement`.
        gear: what is known of it; the expected values of all priors unless `priors` has others.
        free: parameters that are fitted, of `unknowns.FREEABLE`.
        priors: path -> (expected value, standard deviation), SI.
        columns: quantity -> "TITLE [unit]" of files whose header does not tell.
        other_law: fit by another contact law as well, whose difference is added to the intervals.
        like: the fit of another gear of the series, or what it left: with the same tests and free
            parameters, its end and its slopes are where this fit begins.
        jobs: number of processes that share the simulations, as soon as that is quicker.
        time_limit: of each simulation [s]; one that takes longer counts as a gear without equilibrium.

    Raises:
        InputError: files that cannot be read, curves too short, values in a wrong unit, a prior that cannot
            be, or a gear that has no equilibrium where the fit begins.

    Examples:
        >>> curve = rps.run("free-pinion-torque", fidelity="quasi-static")
        >>> table = np.column_stack([curve["pinion_angle"], curve["pinion_torque"]])
        >>> np.savetxt("bench.csv", table, header="angle [rad],torque [N m]", delimiter=",", comments="")
        >>> found = rps.fit(["bench.csv"], free=["yoke.preload"], other_law=False)
        >>> round(found.estimate("yoke.preload").value, -1)
        300.0
    """
    began, gear = process_time(), gear or SteeringGear()
    measurement = files if isinstance(files, Measurement) else read_measurement(files, columns)
    check_sizes(measurement, gear)
    free, warnings = _tellable(measurement, gear, list(free))
    problem = _problem(measurement, gear, free, priors or {})
    before = like.series if isinstance(like, Fit) else like
    if before is not None and (why := before.misfit(problem, gear.mesh.law)):
        warnings.append(f"the fit of the series is not taken over: {why}")
        before = None
    with CaseRunner(jobs, time_limit) as problem.prediction.runner:
        try:
            begin = _in_two_parts if is_curved(problem) else _solved
            solved, problem, found, repeats, others = begin(problem, gear, before)
        except NoPredictionError as error:
            raise InputError(
                f"the fit finds no equilibrium where it begins: {error}; give a gear that runs, by --gear."
            ) from None
        by_law = np.zeros(len(problem.unknowns))
        if before is not None:
            by_law = before.by_law
        elif other_law:
            by_law, said = _by_other_law(problem, gear, solved)
            warnings += said
    return outcome_of(
        problem,
        gear,
        solved,
        found=found,
        repeats=repeats,
        others=others,
        by_law=by_law,
        warnings=warnings,
        began=began,
    )


def _tellable(measurement: Measurement, gear: SteeringGear, free: list[str]) -> tuple[list[str], list[str]]:
    """The freed parameters of which curves of this length can tell, and what is said about the others.

    Raises:
        InputError: curves too short to tell anything.
    """
    turning = [each for each in measurement.passes if each.test.of_kind.by_angle]
    pitch = TURN / gear.pinion.teeth
    for each in turning:
        if np.ptp(each.angle) < 0.98 * pitch:
            raise InputError(
                f"{measurement.names[each.run]} covers {np.degrees(np.ptp(each.angle)):.3g} deg in a pass; a "
                f"level needs a tooth pitch, {np.degrees(pitch):.3g} deg, at least."
            )
    longest = max((float(np.ptp(each.angle)) for each in turning), default=0.0)
    warnings = []
    if "pinion.runout" in free and longest < LEAST_TURN * TURN:
        free.remove("pinion.runout")
        if turning:
            needed = f"{np.degrees(LEAST_TURN * TURN):.4g} deg"
            warnings.append(f"pinion.runout is not fitted: that needs {needed} of free turning")
    if not turning and (shapes := [path for path in CURVED if path in free]):
        free = [path for path in free if path not in shapes]
        warnings.append(f"{' and '.join(shapes)} not fitted: that needs a curve of free turning")
    return free, warnings


def _problem(
    measurement: Measurement,
    gear: SteeringGear,
    free: Sequence[str],
    priors: Mapping[str, tuple[float, float]],
) -> Problem:
    turning = [each for each in measurement.passes if each.test.of_kind.by_angle]
    whole = None
    if gear.rack.bow or "rack.bow" in free:
        angles = np.concatenate([each.angle for each in turning]) if turning else np.array([-np.pi, np.pi])
        half = TURN / gear.pinion.teeth / 2  # by which an offset may shift them
        whole = within_the_teeth(gear, float(angles.min()) - half, float(angles.max()) + half)
    unknowns = unknowns_of(gear, free, priors)
    if not unknowns:
        raise InputError("a fit needs at least one free parameter of which its curves can tell.")
    torque = closed_form(gear).free_torque
    pushed = {each.run for each in measurement.passes if each.test.pushed}
    gain = float(GearPair.of(gear).gain)
    quiet = tuple(ZERO * torque / (gain if run in pushed else 1.0) for run in range(len(measurement.names)))
    tests = measurement.tests
    unknown_noise = NoiseEstimate(0.0, 0.0, 0.0, 0.0, np.inf)
    found = [replace(unknown_noise, white=white_noise(each)) for each in measurement.passes]
    return Problem(
        measurement=measurement,
        prediction=Prediction.of(tests, whole),
        unknowns=unknowns,
        pitch=TURN / gear.pinion.teeth,
        noises=noises_of(measurement.passes, found, {}, len(tests) > 1),
        quiet=quiet,
        with_offset=bool(turning),
        calibrated=SENSOR if len(tests) > 1 else 1e-9,
    )


Ended = tuple[Solved, Problem, list[NoiseEstimate], dict[str, Repeats], list[OtherEnd]]
"""Where a fit ended, the problem with its noises, these, the scatter of repeats, and other ends."""


def _solved(problem: Problem, gear: SteeringGear, before: Series | None) -> Ended:
    """Solve, find the noise in what is left, and solve again with that noise."""
    state = _start(problem, gear, before)
    solved = solve(problem, gear, state, lambda at: first_slopes(problem, gear, at))
    found = _found(problem, solved)
    repeats = repeats_of(problem.measurement.passes, solved.equations.rows)
    problem = _with_found(problem, found, repeats)
    again = solve(problem, gear, solved.state)
    why = solved.why or again.why
    again = replace(again, converged=again.converged and solved.converged, why=why)
    return again, problem, found, repeats, []


def _in_two_parts(problem: Problem, gear: SteeringGear, before: Series | None) -> Ended:
    """The same with a bow or an angle error: noise from what is left of the shape."""
    shape, others = shape_of(problem, gear, _start(problem, gear, before), search=before is None)
    found = _found(problem, shape)
    level = level_of(problem, gear, shape, _with_found(problem, found, {}).noises)
    repeats = repeats_of(problem.measurement.passes, level.equations.rows)
    problem = _with_found(problem, found, repeats)
    if repeats:
        level = level_of(problem, gear, shape, problem.noises)
    return level, problem, found, repeats, others


def _found(problem: Problem, solved: Solved) -> list[NoiseEstimate]:
    """The noise of each pass in what is left of it."""
    passes, rows = problem.measurement.passes, solved.equations.rows
    return [
        found_noise(each, row, noise.white, problem.pitch)
        for each, row, noise in zip(passes, rows, problem.noises, strict=True)
    ]


def _with_found(problem: Problem, found: list[NoiseEstimate], repeats: dict[str, Repeats]) -> Problem:
    passes, several = problem.measurement.passes, len(problem.prediction.blocks) > 1
    return problem.with_noises(noises_of(passes, found, repeats, several))


def _start(problem: Problem, gear: SteeringGear, before: Series | None) -> State:
    if before is None:
        return start_of(problem, gear)
    state = replace(before.state, zeros=np.zeros(len(problem.quiet)), offset=0.0, gain=0.0)
    return replace(state, offset=scanned_offset(problem, state)) if problem.with_offset else state


def _by_other_law(problem: Problem, gear: SteeringGear, solved: Solved) -> tuple[np.ndarray, list[str]]:
    """How far another contact law moves the unknowns, and what is said if that cannot be told."""
    law = OTHER_LAW[gear.mesh.law]
    other, state = gear.replace({"mesh.law": law}), solved.state
    try:
        values = problem.prediction.simulated(other.replace(settings_of(problem.unknowns, state.u)))
    except NoPredictionError as error:
        return np.zeros(state.u.size), [f"the fit by mesh.law = {law} has no equilibrium: {error}"]
    state = replace(state, values=values)
    if is_curved(problem):
        shape, _ = shape_of(problem, other, state, search=False)
        moved = level_of(problem, other, shape, problem.noises, COARSE)
    else:
        moved = solve(problem, other, state, enough=COARSE)
    said = [] if moved.converged else [f"the fit by mesh.law = {law} did not converge: {moved.why}"]
    return moved.state.u - state.u, said


# --- Whether measured values can be those of a gear like the one that is expected: the wrong unit shows here

WRONG_UNIT = (
    20.0  # times what is expected, more or less: N m for N mm, N cm or in-lb shows, another gear does not
)
MOST_TRAVELS = 3.0  # times the angle over which the expected rack has teeth: rad for deg shows


def check_sizes(measurement: Measurement, gear: SteeringGear) -> None:
    """Refuse torques, forces and angles that no gear like the expected one can have.

    Raises:
        InputError: one sentence for each file that holds such.
    """
    problems = []
    for run, name in enumerate(measurement.names):
        passes = [each for each in measurement.passes if each.run == run]
        problems += [f"{name} {why}." for why in (*_sizes(passes, gear), *_travels(passes, gear))]
    if problems:
        raise InputError(problems)


def _sizes(passes: list[MeasuredPass], gear: SteeringGear) -> Iterator[str]:
    expected = max(abs(mean) for mean in formula_means(gear, passes[0].test))
    size = max(abs(float(np.median(each.value))) for each in passes)
    if expected > 0 and not 1 / WRONG_UNIT < size / expected < WRONG_UNIT:
        unit = passes[0].test.unit.replace("*", " ")
        what = "force" if unit == "N" else "torque"
        yield (
            f"has a mean {what} of {size:.3g} {unit} where the gear given would show {expected:.3g} {unit}: "
            f"look at the unit of its {what}, or give a gear that is nearer by --gear"
        )


def _travels(passes: list[MeasuredPass], gear: SteeringGear) -> Iterator[str]:
    turned = max(float(np.ptp(each.angle)) for each in passes)
    whole = 2 * largest_angle(gear)
    if passes[0].test.of_kind.by_angle and turned > MOST_TRAVELS * whole:
        yield (
            f"covers {turned / TURN:.3g} turns of the pinion where the gear given has teeth for "
            f"{whole / TURN:.3g}: look at the unit of its angle"
        )
