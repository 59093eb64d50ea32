"""Fit a gear to measured curves.

    fit = rps.fit(["free.csv", "yoke-out=b.csv", "bearing=c.csv", "load-test@80kg=d.csv"])
    fit.level.value, fit.found, fit.gear

The levels are found without any model of the gear (`level`). The model that explains them is the gear in
equilibrium: the closed form's steps, which simulations correct (`level_fit`). The same fit with another
contact law shows what that choice changes, which is added to the intervals.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from rps_exudyn.analysis.measured import TURN
from rps_exudyn.base.errors import InputError, check_kind
from rps_exudyn.base.units import shown
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting import bench_tests
from rps_exudyn.inference.fitting.bench_tests import MeasuredPass, Measurement
from rps_exudyn.inference.fitting.fitted import Fit, runout_in, with_runout_of
from rps_exudyn.inference.fitting.level import levels_of
from rps_exudyn.inference.fitting.level_fit import AGREED, LevelModel, fitted_levels, stepped
from rps_exudyn.inference.fitting.nonlinear import OtherShape, fit_shape
from rps_exudyn.inference.fitting.prediction import NoPredictionError, Prediction, formula_means
from rps_exudyn.inference.fitting.problem import FitState, Problem, found_offset, level_rows, white_noise
from rps_exudyn.inference.fitting.series import Series
from rps_exudyn.inference.fitting.unknowns import (
    BY_LOAD,
    SHAPE_PARAMETERS,
    SMALLEST,
    USUAL,
    WITHOUT_YOKE,
    nuisance_unknowns,
    settings_of,
    unknowns_of,
)
from rps_exudyn.parameters.fidelity import MEAN_STEP
from rps_exudyn.parameters.gear import SteeringGear, check_constant_ratio, check_gear
from rps_exudyn.results.requirements import read_limits
from rps_exudyn.results.result import MeasuredTorque
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.simulate.cases.run_cases import CaseRunner, cpu_time

LEAST_TURN = 0.8  # of a turn, that a curve must cover to show the runout
LEAST_SWING = np.radians(10.0)  # of a reversal beyond its turns
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
    limits: str | Path | None = None,
    jobs: int = 1,
    time_limit: float = float("inf"),
) -> Fit:
    """Estimate parameters of a gear from measured curves.

    Args:
        files: measured files, or one, "FILE" or "TEST=FILE" (`bench_tests.KINDS`); or a `Measurement`.
        gear: what is known of it; the expected values of all priors unless `priors` has others.
        free: parameters that are fitted, of `unknowns.FREEABLE`; bow and angle error, whose ripple preload
            and friction scale, alone are fitted beside the usual ones.
        priors: path -> (expected value, standard deviation), SI.
        columns: quantity -> "TITLE [unit]" of files whose header does not state it.
        other_law: fit by another contact law as well, whose difference is added to the intervals.
        like: the fit of another gear of the series, or what it left: with the same tests and free
            parameters, its end and its slopes are where this fit begins.
        limits: file of limits that replace the shipped ones, for the yoke's adjustment.
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
    began, gear = cpu_time(), SteeringGear() if gear is None else gear
    check_gear(gear)
    check_constant_ratio(gear, "a fit")
    files = [files] if isinstance(files, str | Path) else files
    free = [free] if isinstance(free, str) else free
    check_kind("files", files, Iterable | Measurement, "a list of files")
    check_kind("free", free, Iterable, "a list of parameters")
    check_kind("jobs", jobs, int, "a whole number")
    check_kind("time_limit", time_limit, int | float, "a number of seconds")
    check_kind("priors", priors, Mapping | None, "path -> (value, deviation), in SI")
    for path, prior in (priors or {}).items():
        if np.shape(prior) != (2,) or np.asarray(prior).dtype.kind not in "if":
            raise InputError(f"the prior of {path} is {shown(prior)}; it must be (value, deviation), in SI.")
    check_kind("limits", limits, str | Path | None, "a file")
    allowed = read_limits(Path(limits) if limits is not None else None)
    check_kind("like", like, Fit | Series | None, "the fit of another gear")
    read = bench_tests.read_measurement
    measurement = files if isinstance(files, Measurement) else read(files, columns, gear)
    check_sizes(measurement, gear)
    free = (*USUAL, *free) if free and {*free} <= {*SHAPE_PARAMETERS} else free
    free, warnings = identifiable_parameters(measurement, gear, list(free))
    warnings += beyond_the_teeth(measurement, gear)
    warnings += [
        f"the prior of {path} is not used, because it is not fitted: name it by --free, or set its value"
        for path in priors or {}
        if path not in free
    ]
    problem = _problem(measurement, gear, free, priors or {})
    before = like.series if isinstance(like, Fit) else like
    if before is not None and (why := before.reason_not_usable(problem, gear.mesh.contact_law)):
        warnings.append(f"the fit of the series is not used: {why}")
        before = None
    with CaseRunner(jobs, time_limit) as problem.prediction.runner:
        try:
            found = _searched(problem, gear, before, "pinion.runout" in (priors or {}))
        except NoPredictionError as error:
            raise InputError(
                f"the fit finds no equilibrium at its initial guess: {error}; give a gear that runs, by "
                f"--gear."
            ) from None
        if before is not None:
            found = replace(found, by_law=before.by_law)
        elif other_law:
            by_law, said = _by_other_law(found)
            found = replace(found, by_law=by_law)
            warnings += said
    simulations, spent = problem.prediction.simulations, cpu_time() - began
    return replace(found, limits=allowed, remarks=tuple(warnings), simulations=simulations, cpu_s=spent)


def identifiable_parameters(
    measurement: Measurement, gear: SteeringGear, free: list[str]
) -> tuple[list[str], list[str]]:
    """The freed parameters that curves of this length determine, and remarks on the others.

    Raises:
        InputError: curves too short for any parameter.
    """
    turning = [each for each in measurement.passes if each.test.of_kind.by_angle]
    pitch = TURN / gear.pinion.teeth
    for each in turning:
        swings = each.test.of_kind.turns_about
        if np.ptp(each.angle) < (LEAST_SWING if swings else 0.98 * pitch):
            needed = (
                f"a reversal needs {np.degrees(LEAST_SWING):.3g} deg beyond its turns"
                if swings
                else f"a level needs a tooth pitch, {np.degrees(pitch):.3g} deg, at least"
            )
            raise InputError(
                f"{measurement.names[each.run]} covers {np.degrees(np.ptp(each.angle)):.3g} deg in a pass; "
                f"{needed}: check the unit of its angle, or turn further."
            )
    longest, warnings = max((float(np.ptp(each.angle)) for each in turning), default=0.0), []
    if "pinion.runout" in free and longest < LEAST_TURN * TURN:
        free.remove("pinion.runout")
        if turning:
            needed = f"{np.degrees(LEAST_TURN * TURN):.4g} deg"
            warnings.append(f"pinion.runout is not fitted: that needs {needed} of free turning")
    if not turning and (shapes := [path for path in SHAPE_PARAMETERS if path in free]):
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
        farthest = largest_angle(gear) * (1 - 1e-6) - 2 * MEAN_STEP  # where the rack has teeth
        whole = max(float(angles.min()) - half, -farthest), min(float(angles.max()) + half, farthest)
    unknowns = unknowns_of(gear, free, priors)
    if not unknowns:
        raise InputError("a fit needs at least one free parameter that its curves depend on.")
    levels = levels_of(measurement.passes, gear.pinion.teeth, float(GearPair.of(gear).gain))
    return Problem(
        measurement=measurement,
        levels=levels,
        rows=level_rows(levels),
        prediction=Prediction.of(measurement.tests, whole),
        unknowns=unknowns,
        pitch=TURN / gear.pinion.teeth,
        whites=[white_noise(each) for each in measurement.passes],
        with_offset=bool(turning),
    )


def _searched(problem: Problem, gear: SteeringGear, before: Series | None, use_prior: bool) -> Fit:
    """Fit the levels, and before them the shape where a bow or an angle error is freed; `use_prior`: whether
    an own prior of the runout counts.

    Raises:
        NoPredictionError: there is no equilibrium where the fit begins.
    """
    given, unknowns = gear, problem.unknowns
    of_level = [j for j, each in enumerate(unknowns) if each.is_level]
    tests = problem.measurement.tests
    needed = [BY_LOAD] if any(test.of_kind.weighted for test in tests) else []
    needed += [WITHOUT_YOKE] if any(test.kind == "yoke-out" for test in tests) else []
    fitted = [*(unknowns[j] for j in of_level), *nuisance_unknowns(needed)]
    begin = np.array([each.before for each in fitted])
    model = LevelModel.of(problem.rows, fitted, gear)
    if before is not None:
        begin[: len(of_level)] = before.u[of_level]
        model = model.corrected(begin, problem.rows_of(before.values))
    shape: FitState | None = None
    others: list[OtherShape] = []
    if problem.needs_shape_fit:
        u = np.array([each.before for each in unknowns]) if before is None else before.u.copy()
        if before is None:
            u[of_level] = stepped(model, begin).u[: len(of_level)]
            free = _with_runout(problem, gear.replace(settings_of(unknowns, u)), 0.0, use_prior, None)
            u = with_runout_of(free, problem, u)
        shape, others = fit_shape(problem, gear, u, search=before is None)
        begin[: len(of_level)] = shape.u[of_level]
    fitted_to = _fit_levels(problem, model, gear, begin, shape, use_prior, corrected=before is not None)
    (model, state, gear, offset), by_law = fitted_to, np.zeros(len(unknowns))
    return Fit(problem, given, gear, model, state, shape, others, use_prior, *offset, by_law, {})


def _fit_levels(
    problem: Problem,
    model: LevelModel,
    gear: SteeringGear,
    begin: np.ndarray,
    shape: FitState | None,
    use_prior: bool,
    *,
    corrected: bool,
    agreed: float = AGREED,
) -> tuple[LevelModel, FitState, SteeringGear, tuple[float, float]]:
    """Fit the levels beside the shape's end; return model, state, fitted gear, and the angle's offset."""
    if shape is not None:
        held = settings_of(problem.unknowns, shape.u)
        gear = gear.replace({path: held[path] for path in held if path.startswith(SHAPE_PARAMETERS)})
        model = replace(model, gear=gear)

    def offset_of(values: np.ndarray | None) -> tuple[float, float]:
        if shape is not None:
            return shape.offset, float(np.sqrt(shape.covariance[-1, -1]))
        if values is None or not problem.with_offset:
            return 0.0, 0.0
        return found_offset(problem, values)

    def with_runout(fitted: SteeringGear, values: np.ndarray | None) -> SteeringGear:
        return _with_runout(problem, fitted, offset_of(values)[0], use_prior, shape)

    model, state = fitted_levels(
        model, problem.prediction, problem.rows_of, with_runout, begin, corrected=corrected, agreed=agreed
    )
    fitted = with_runout(gear.replace(settings_of(list(model.unknowns), state.u)), state.values)
    return model, state, fitted, offset_of(state.values)


def _with_runout(
    problem: Problem, gear: SteeringGear, offset: float, use_prior: bool, shape: FitState | None
) -> SteeringGear:
    """The gear with the runout that free torques show with its preload."""
    runout = runout_in(problem, gear.yoke.preload, 0.0, use_prior, shape)
    if runout is None:
        return gear
    e_c, e_s = -runout.vector[1], -runout.vector[0]  # of -P (e_c sin + e_s cos) over the measured angle
    angle = float(np.arctan2(e_s, e_c)) + offset
    return gear.replace({"pinion.runout": max(runout.size, SMALLEST), "pinion.runout_angle": angle})


def _by_other_law(fit: Fit) -> tuple[np.ndarray, list[str]]:
    """How far another contact law moves the unknowns, and a remark if that is unknown."""
    law, problem, shape = OTHER_LAW[fit.given.mesh.contact_law], fit.problem, fit.shape_state
    other, by_law = fit.given.replace({"mesh.law": law}), fit.by_law.copy()
    of_level = [j for j, each in enumerate(problem.unknowns) if each.is_level]
    try:
        if shape is not None:
            moved, _ = fit_shape(problem, other, shape.u, search=False)
            by_law, shape = moved.u - shape.u, moved
        model, begin = replace(fit.model, gear=other), fit.ended.u
        _, state, *_ = _fit_levels(
            problem, model, other, begin, shape, fit.use_runout_prior, corrected=True, agreed=np.inf
        )
    except NoPredictionError as error:
        return by_law, [f"the fit by mesh.law = {law} has no equilibrium: {error}"]
    by_law[of_level] = (state.u - begin)[: len(of_level)]
    if not state.converged:
        return by_law, [f"the fit by mesh.law = {law} did not converge: {state.why}"]
    return by_law, []


# --- Whether measured values can be those of a gear like the one that is expected: the wrong unit shows here

WRONG_UNIT = 6.0  # times what is expected, more or less: a wrong unit or factor shows, another gear does not
MOST_TRAVELS = 3.0  # times the angle over which the expected rack has teeth: rad for deg shows
ALL_TEETH = 1.02  # times the same: an encoder's ratio shows


def check_sizes(measurement: Measurement, gear: SteeringGear) -> None:
    """Refuse torques, forces and angles that no gear like the expected one can have.

    Raises:
        InputError: one sentence for each file that holds such.
    """
    if problems := _wrong_sizes(measurement, gear):
        raise InputError([f"{problem}." for problem in problems])


def doubts(curve: MeasuredTorque, gear: SteeringGear) -> list[str]:
    """Return what speaks against a free torque as it was read: wrong units, a channel that is late."""
    try:
        measurement = bench_tests.measurement_of([(bench_tests.BenchTest("free"), curve)])
    except InputError as error:
        return [problem.removesuffix(".") for problem in error.problems]
    wrong = _wrong_sizes(measurement, gear)
    return [*(wrong or beyond_the_teeth(measurement, gear)), *measurement.late]


def _wrong_sizes(measurement: Measurement, gear: SteeringGear) -> list[str]:
    files = _by_file(measurement)
    return [f"{name} {why}" for name, each in files for why in (*_sizes(each, gear), *_travels(each, gear))]


def _by_file(measurement: Measurement) -> Iterator[tuple[str, list[MeasuredPass]]]:
    for run, name in enumerate(measurement.names):
        yield name, [each for each in measurement.passes if each.run == run]


def _sizes(passes: list[MeasuredPass], gear: SteeringGear) -> Iterator[str]:
    expected = max(abs(mean) for mean in formula_means(gear, passes[0].test))
    size = max(abs(float(np.median(each.value))) for each in passes)
    if expected > 0 and not 1 / WRONG_UNIT < size / expected < WRONG_UNIT:
        unit = passes[0].test.unit.replace("*", " ")
        what = "force" if unit == "N" else "torque"
        yield (
            f"has a mean {what} of {size:.3g} {unit} where the gear given would show {expected:.3g} {unit}: "
            f"check the unit of its {what}, or give a more similar gear by --gear"
        )


def _travels(passes: list[MeasuredPass], gear: SteeringGear, most: float = MOST_TRAVELS) -> Iterator[str]:
    test, moved = passes[0].test, max(float(np.ptp(each.angle)) for each in passes)
    turned = moved / (float(GearPair.of(gear).gain) if test.pushed else 1.0)
    whole = 2 * largest_angle(gear)
    if test.kind == "bearing" or turned <= most * whole:
        return
    if test.pushed:
        covered, teeth = f"{1e3 * moved:.3g} mm of travel", f"{1e3 * moved * whole / turned:.3g} mm"
    else:
        covered, teeth = f"{turned / TURN:.3g} turns of the pinion", f"{whole / TURN:.3g}"
    what = "travel" if test.pushed else "angle or travel"
    yield f"covers {covered} where the gear given has teeth for {teeth}: check the unit of its {what}"


def beyond_the_teeth(measurement: Measurement, gear: SteeringGear) -> list[str]:
    """What is to be said of files whose angles the given gear cannot turn, though another could."""
    said = []
    for name, passes in _by_file(measurement):
        ratio = "" if passes[0].test.pushed else ", and whether its encoder has a ratio"
        said += [f"{name} {why}{ratio}" for why in _travels(passes, gear, ALL_TEETH)]
    return said
