"""The right metrics of a plan, known before the plan is run, without what the plan is judged by.

    right = expected(plan)
    right.main_metric, right.ripple     the number that must be right, and the spread of the signal
    right.cause                    why there are none
    finer_metrics(plan)            every metric of the scene by finer runs, with its doubt
    curve(plan)                    the scene's signal over time, of slow motion

Equilibria come from far before the record (`approach_paths`). The seat is a sum over cells; the contact an
integral over generators, or over many stations where its law knows no generators; steps are fine whatever the
plan's are, and halved until halves of them say the same. Where a plan has inertia and its motion is fast,
classical Runge-Kutta goes on from there; slow motion is that without inertia.
"""

from dataclasses import dataclass, replace
from math import ceil, floor, nan
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import Curve
from rps_exudyn.forces.external_load import TimedForce
from rps_exudyn.forces.force_element import PLUNGER
from rps_exudyn.forces.pinion_support import with_float
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import PLAIN_LAW, RUBBING_PARTS
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import LOST_MOTIONS, VARIATIONS
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.scenes.run_maneuver import drift_beside_travel
from rps_exudyn.scenes.scene import WITHOUT_BARS
from rps_exudyn.scenes.yoke_impact import shaken
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.balance import eigenvalues
from rps_exudyn.solvers.closed_form import GRAVITY
from rps_exudyn.solvers.equilibrium import EquilibriumPath
from rps_exudyn.solvers.gear_forces import GearForces, accelerated, gear_forces
from rps_exudyn.solvers.prescribed_motion import Drive, Steady, Swing
from verification.approach_paths import (
    Pass,
    equilibria_at,
    followed,
    instants_before,
    passes_of,
    pitches_before,
    room_before,
)
from verification.refined_steps import Confirmed, NotFiniteError, NotFoundError, confirmed
from verification.runge_kutta import FreeMotion, runge_kutta
from verification.seat_cells import by_cells
from verification.stability import ScenePlan

RUN_IN = 0.5  # pitches by Runge-Kutta before the record
PER_CYCLE = 600  # equilibria of a swing
CYCLES, ALIKE = (2, 5, 15, 45), 1e-3  # after which its last two cycles may take works that are the same
CURVE_FINER, CURVE_PER_CYCLE = 2, 1600  # of a curve's steps, and of those of a swing
STATIONS: dict[str, Any] = {"mesh": "flank", "strip_stations": 12, "strip_points": 6}
PER_FASTEST = 2.0  # Runge-Kutta's step over the time constant of the fastest mode; stable to 2.8
MOST_EXPLICIT = 3000  # steps; motion that needs more is slow ...
HALVED = (0, 1, 2)  # times that the steps of finer runs are halved, ...
STEPS_OF_FINER = {"generalized-alpha": np.deg2rad((0.4, 2.0)), "equilibrium": np.deg2rad((0.2, 0.4))}
# ... which are the plan's within these bounds [rad], equilibria shorter for extremes at kinks, ...
STATIONS_OF_FINER = 6, 12  # ... twice the plan's stations of a strip within these ...
LARGEST_TOLERANCE = 1e-5  # ... and whose tolerance is at most this
SETTLED = 1e-3  # of its range, by which a motion beside the travel may end a cycle elsewhere than it began
NARROW_ZONE = 0.002  # of friction where motion stops: reversal_angle is then within 3 %
MOST_REFINED = 12000  # ... and parts of them
SLOW = 0.02  # of the preload: inertia most of the time, above which equilibria do not stand for a swing
INSTANTS, GROWN = 24, 0.5  # at which slow motion is linearised; powers of e by which a vibration may grow


@dataclass(frozen=True)
class Expected:
    """The right metrics of a plan.

    Attributes:
        main_metric: the scene's number: torque [N m], force [N], or work of the last cycle [J].
        ripple: largest less smallest value of the signal over a course, the larger of both; nan where the
            scene has none.
        main_metric_doubt, ripple_doubt: by how much half the steps change them.
        cause: why there are none; "" if there are.
        method: "equilibria" or "Runge-Kutta".
    """

    main_metric: float = nan
    ripple: float = nan
    cause: str = ""
    method: str = ""
    main_metric_doubt: float = 0.0
    ripple_doubt: float = 0.0

    @classmethod
    def of(cls, found: Confirmed, method: str) -> "Expected":
        """Return what a method found."""
        return cls(
            found.main_metric,
            found.ripple,
            method=method,
            main_metric_doubt=found.main_metric_doubt,
            ripple_doubt=found.ripple_doubt,
        )


def expected(plan: ScenePlan) -> Expected:
    """Return the right metrics of a plan of any scene, by the contact law that the scene needs."""
    law = scene_named(plan.scene).law
    plan = replace(plan, gear=resolve_contact_law(plan.gear, plan.fidelity, law))
    try:
        if plan.scene == "yoke-impact":
            return _shaken(replace(plan, fidelity=plan.fidelity.with_bending()))
        if plan.scene == "reversal":
            return _swung(replace(plan, fidelity=with_float(plan.gear, plan.fidelity)))
        return _turned(plan)
    except (NotFoundError, np.linalg.LinAlgError) as error:
        return Expected(cause=str(error))


# --- every metric ------------------------------------------------------------------------------------
def finer_metrics(plan: ScenePlan) -> dict[str, tuple[float, float]]:
    """Return each metric of the scene by finer quadrature and steps, and how far that can be doubted.

    They are those of dynamics where these end well, which equilibria do not judge themselves; else those of
    equilibria. In swings equilibria have no vibration, of which their user reads: how far their signals vary
    is judged by finer equilibria.

    Raises:
        NotFoundError: neither ends well in both lengths of its steps.
    """
    scene, own = scene_named(plan.scene), plan.fidelity.solver
    solvers = ["equilibrium"] if scene.at_rest else ["generalized-alpha", "equilibrium"]
    if scene.needs_inertia:
        solvers = ["generalized-alpha"]
    still, causes = own == "equilibrium" and "equilibrium" in solvers, []
    right: dict[str, tuple[float, float]] = {}
    for solver in solvers:
        if right and not still:
            break
        found, cause = _by_solver(plan, solver)
        causes.append(cause)
        if still and solver == "generalized-alpha":
            found = {name: each for name, each in found.items() if scene.steady or name not in VARIATIONS}
        right = found | right
    if not right:
        raise NotFoundError("; ".join(causes))
    return right


def _by_solver(plan: ScenePlan, solver: str) -> tuple[dict[str, tuple[float, float]], str]:
    """Return metrics in the shortest of three lengths of steps, in swings with friction zones as narrow, and
    their doubt; {} and why there are none.

    The doubt is the last change, or a quarter of that before: two lengths may agree by chance.
    """
    fidelity, scene = _finer_model(plan, solver), scene_named(plan.scene)
    swings = scene.motion == "to and fro"  # where creep in the friction zone may move it on
    runs = []
    for times in HALVED:
        options = replace(WITHOUT_BARS, level=1 + times)
        zone = fidelity.zone_ratio / 2 ** (swings * times)
        runs.append(run_unchecked(plan.scene, plan.gear, fidelity.replace({"zone_ratio": zone}), options))
        if times and runs[-1].status is not Status.OK:
            return {}, runs[-1].message
    first, coarse, fine = (run.summary for run in runs)
    # steps as given record a first cycle, from which a lost motion may go on to wander
    gain = float(GearPair.of(plan.gear).gain)
    if swings and drift_beside_travel(dict(runs[-1].signals), gain) > SETTLED:
        fine = {name: value for name, value in fine.items() if name not in LOST_MOTIONS}

    def doubt(name: str) -> float:
        before = abs(coarse[name] - first.get(name, coarse[name])) / 4  # of second order
        return max(abs(fine[name] - coarse[name]), before)

    return {name: (fine[name], doubt(name)) for name in fine.keys() & coarse.keys()}, ""


def _finer_model(plan: ScenePlan, solver: str) -> Fidelity:
    """The plan's model, finer; a chain of segments is condensed for equilibria, which have none."""
    model = plan.fidelity
    as_given = model.bush == "rigid" or solver == "generalized-alpha"
    finer = {
        "mesh": "flank",
        "strip_stations": int(np.clip(2 * model.strip_stations, *STATIONS_OF_FINER)),
        "strip_points": min(model.strip_points + 2, STATIONS["strip_points"]),
        "step_angle": float(np.clip(model.step_angle, *STEPS_OF_FINER[solver])),
        "tolerance": min(model.tolerance, LARGEST_TOLERANCE),
        "bush": model.bush if as_given else "condensed",
        "solver": solver,
    }
    return _with_narrow_zone(model.replace(finer))


def _has_state(plan: ScenePlan) -> bool:
    """Return whether friction depends on the motion before, which explicit steps do not follow."""
    return any(getattr(plan.gear, part).facts.has_state for part in RUBBING_PARTS)


# --- forces ----------------------------------------------------------------------------------------
def reference_forces(plan: ScenePlan, load: float = 0.0) -> GearForces:
    """Return the plan's force laws, integrated finely and by other means."""
    forces = gear_forces(plan.gear, plan.fidelity.replace(STATIONS), load)
    return by_cells(forces) if plan.gear.yoke.friction_law == PLAIN_LAW else forces


# --- steady scenes ---------------------------------------------------------------------------------
def _turned(plan: ScenePlan) -> Expected:
    test = plan.gear.test
    load = test.direction * GRAVITY * test.load_mass if plan.scene == "load-test" else 0.0
    forces = reference_forces(replace(plan, fidelity=_with_narrow_zone(plan.fidelity)), load)
    courses = passes_of(plan)[: None if plan.scene == "rack-push" else 1]  # whose mean is the main metric
    found = [_along(plan, forces, course) for course in courses]
    senses = [course.sense if plan.scene == "rack-push" else 1 for course in courses]
    mean_of_all = float(
        np.mean([each.main_metric * sense for each, sense in zip(found, senses, strict=True)])
    )
    largest = max(found, key=lambda each: each.ripple)
    mean = replace(
        largest, main_metric=mean_of_all, main_metric_doubt=max(each.main_metric_doubt for each in found)
    )
    if plan.scene == "load-test":
        return replace(mean, main_metric=mean_of_all * test.direction, ripple=nan)
    return mean


def _along(plan: ScenePlan, forces: GearForces, course: Pass) -> Expected:
    """Mean and spread of what the drive overcomes over one course."""
    gear, drive, pitches = plan.gear, course.drive(plan.gear), pitches_before(plan.gear, forces, course)
    if plan.fidelity.solver == "generalized-alpha":
        duration = course.length / gear.test.speed
        run_in = min(RUN_IN * 2 * np.pi / gear.pinion.teeth, room_before(gear, course)) / gear.test.speed
        motion = _motion(plan, forces, drive, instants_before(gear, pitches, -run_in))
        step = _explicit_step(motion)
        if (steps := ceil((duration + run_in) / step)) <= MOST_EXPLICIT and not _has_state(plan):
            shifted = replace(motion, drive=replace(drive, start=float(drive.place(-run_in))))

            def moved(parts: int) -> tuple[float, float]:
                led = equilibria_at(gear, forces, drive, instants_before(gear, pitches, -run_in, parts))
                begun = replace(shifted, place=led.coordinates[-1], rate=led.rates[-1])
                time, places, rates = explicit(begun, step, steps, parts)
                kept = time >= run_in - step / 2
                record = shifted.recorded(time[kept], places[kept], rates[kept])
                return _mean_and_range(plan, drive.place(time[kept] - run_in), record.drive)

            return Expected.of(confirmed(moved), "Runge-Kutta")
        _check_steady(motion, followed(gear, forces, course, pitches, 1)[1], duration)

    def rested(parts: int) -> tuple[float, float]:
        along, path = followed(gear, forces, course, pitches, parts)
        force = -drive.sign * path.forces[-along.size :, drive.coordinate]
        return _mean_and_range(plan, drive.place(along), force)

    return Expected.of(confirmed(rested), "equilibria")


def _mean_and_range(plan: ScenePlan, place: np.ndarray, force: np.ndarray) -> tuple[float, float]:
    """Mean and spread of a force over a course; the mean of a load test is that over whole tooth pitches from
    where it begins, if there is one."""
    along, pitch = np.abs(place - place[0]), 2 * np.pi / plan.gear.pinion.teeth
    end = along[-1]
    if plan.scene == "load-test" and (pitches := floor(end / pitch + 1e-9)):
        end = min(pitches * pitch, end)
    kept = np.append(along[along < end], end)
    return float(np.trapezoid(np.interp(kept, along, force), kept) / end), float(np.ptp(force))


def curve(plan: ScenePlan) -> Curve:
    """Return the scene's signal over the time of the rig's motion, in the limit of slow motion.

    Raises:
        NotFoundError: there is no equilibrium somewhere.
        LinAlgError: the gear has no stiffness against a force.
    """
    if plan.scene == "reversal":
        swing = _swing(plan)
        time = np.linspace(-swing.period, swing.period, 2 * CURVE_PER_CYCLE + 1)
        forces = reference_forces(plan)
        path = equilibria_at(plan.gear, forces, swing, time, accelerated(plan.gear, forces).masses)
        kept = time >= 0
        return Curve(time[kept], -swing.sign * path.forces[kept, swing.coordinate])
    test = plan.gear.test
    courses = passes_of(plan)
    if plan.scene == "load-test" and len(courses) == 1:
        courses.append(Pass(courses[0].body, courses[0].last, courses[0].first))
    load = test.direction * GRAVITY * test.load_mass if plan.scene == "load-test" else 0.0
    forces, begin, times, values = reference_forces(plan, load), 0.0, [], []
    for course in courses:
        along, path = followed(
            plan.gear, forces, course, pitches_before(plan.gear, forces, course), CURVE_FINER
        )
        drive = course.drive(plan.gear)
        times.append(begin + along)
        values.append(-drive.sign * path.forces[-along.size :, drive.coordinate])
        begin += float(along[-1])
    return Curve(np.concatenate(times), np.concatenate(values))


# --- with inertia ----------------------------------------------------------------------------------
def _motion(
    plan: ScenePlan, forces: GearForces, drive: Drive, before: np.ndarray, pulse: TimedForce | None = None
) -> FreeMotion:
    """The gear where equilibria from far before have led it, with the reference's forces."""
    path = equilibria_at(plan.gear, forces, drive, before)
    condensed = plan.fidelity.replace({"bush": "condensed"} if forces.has_chain else {})
    motion = FreeMotion.of(plan.gear, condensed, Steady("pinion", 0.0, 0.0), pulse)
    return replace(
        motion,
        forces=forces,
        drive=drive,
        place=path.coordinates[-1],
        rate=path.rates[-1],
        moving=forces.statics.free(drive.coordinate),
        balance=forces.statics,
    )


def _explicit_step(motion: FreeMotion) -> float:
    """Step in which Runge-Kutta resolves the fastest mode where the motion starts [s]."""
    return PER_FASTEST / float(np.abs(_eigenvalues(motion, motion.place, motion.rate)).max())


def _eigenvalues(motion: FreeMotion, place: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Eigenvalues of the motion linearised at a place and rate [1/s], (2m,)."""
    by_place, by_rate = motion.moving_slopes(place, rate)
    return eigenvalues(motion.moving_mass(place), by_place[None], by_rate[None])[0]


def _check_steady(motion: FreeMotion, path: EquilibriumPath, duration: float) -> None:
    """Check that no vibration grows along equilibria that are to stand for a motion of some duration [s].

    Raises:
        NotFoundError: one does, fed by friction: the motion is another one.
    """
    some = np.linspace(0, len(path.coordinates) - 1, INSTANTS).astype(int)
    values = np.array([_eigenvalues(motion, path.coordinates[i], path.rates[i]) for i in some])
    rates = np.where(values.imag != 0, values.real, 0.0).max(axis=1)
    if (grown := float(np.maximum(rates, 0).mean() * duration)) > GROWN:
        raise NotFoundError(f"friction feeds a vibration, which grows by e^{grown:.2g}: nothing is slow")


def explicit(
    motion: FreeMotion, step: float, steps: int, parts: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times, places and rates after each of some steps [s], each made in parts.

    Raises:
        NotFoundError: these are too many.
        NotFiniteError: the motion does not stay finite.
    """
    if steps * parts > MOST_REFINED:
        raise NotFoundError(f"{steps * parts} steps of Runge-Kutta")
    with np.errstate(all="ignore"):
        found = runge_kutta(motion, motion.rate, step / parts, steps * parts, parts)
    if not np.isfinite(found[1]).all():
        raise NotFiniteError("the motion does not stay finite by Runge-Kutta")
    return found


def _swing(plan: ScenePlan) -> Swing:
    test = plan.gear.test
    return Swing("pinion", test.start_angle, test.amplitude, test.direction * test.speed)


def _swung(plan: ScenePlan) -> Expected:
    """The work of a cycle like the one before it."""
    plan = replace(plan, fidelity=_with_narrow_zone(plan.fidelity))
    drive, forces = _swing(plan), reference_forces(plan)
    before, _ = _settled_cycles(plan, forces, drive, PER_CYCLE)
    motion = _motion(plan, forces, drive, before)
    step = _explicit_step(motion)
    steps = ceil(2 * drive.period / step)

    def moved(parts: int) -> tuple[float, float]:
        times, places, rates = explicit(motion, step, steps, parts)
        record, kept = motion.recorded(times, places, rates), times >= drive.period
        return float(np.trapezoid(record.drive[kept], drive.place(times[kept]))), nan

    def rested(parts: int) -> tuple[float, float]:
        return _settled_cycles(plan, forces, drive, PER_CYCLE * parts)[1], nan

    if steps <= MOST_EXPLICIT and not _has_state(plan):
        return Expected.of(confirmed(moved), "Runge-Kutta")
    if plan.fidelity.solver == "generalized-alpha":
        _check_slow(plan, motion, equilibria_at(plan.gear, forces, drive, before), before)
    return Expected.of(confirmed(rested), "equilibria")


def _check_slow(plan: ScenePlan, motion: FreeMotion, path: EquilibriumPath, time: np.ndarray) -> None:
    """Check that inertia is little of the preload along equilibria that are to stand for a motion.

    Raises:
        NotFoundError: it is more.
    """
    moved = np.gradient(path.rates[-time.size :], time, axis=0)[:, motion.moving]
    inertia = moved @ motion.moving_mass(motion.place).T / motion.balance.lengths[motion.moving]
    share = float(np.median(np.abs(inertia), axis=0).max()) / plan.gear.yoke.preload  # the ends are short
    if share > SLOW:
        raise NotFoundError(f"inertia is {share:.1%} of the preload: the swing is not slow")


def _with_narrow_zone(model: Fidelity) -> Fidelity:
    return model.replace({"zone_ratio": min(model.zone_ratio, NARROW_ZONE)})


def _settled_cycles(
    plan: ScenePlan, forces: GearForces, drive: Swing, per_cycle: int
) -> tuple[np.ndarray, float]:
    """Instants of equilibria to time 0, so many per cycle, from so many cycles before that all are alike
    then; the work of the one after it [J].

    Raises:
        NotFoundError: the cycles go on changing, or there is no equilibrium.
    """
    cycle = np.linspace(0, drive.period, per_cycle + 1)
    for cycles in CYCLES:
        time = drive.period * (np.arange(cycles * per_cycle + 1) / per_cycle - (cycles - 1))
        path = equilibria_at(plan.gear, forces, drive, time)
        overcome = -drive.sign * path.forces[:, drive.coordinate]
        earlier, work = (
            float(np.trapezoid(overcome[k * per_cycle : (k + 1) * per_cycle + 1], drive.place(cycle)))
            for k in (cycles - 2, cycles - 1)
        )
        if abs(work - earlier) <= ALIKE * abs(work):
            return time[: (cycles - 1) * per_cycle + 1], work
    raise NotFoundError(f"cycles still differ by {abs(work / earlier - 1):.1%} after {cycles}")


def _shaken(plan: ScenePlan) -> Expected:
    """The largest force of the yokenut."""
    maneuver = shaken(plan.gear)
    forces = reference_forces(plan)
    motion = _motion(plan, forces, maneuver.drive, np.zeros(1), maneuver.pulse)
    step = _explicit_step(motion)
    steps = ceil(maneuver.steps * maneuver.time_step / step)
    if steps > MOST_EXPLICIT or _has_state(plan):
        raise NotFoundError(f"{steps} steps of Runge-Kutta")

    def moved(parts: int) -> tuple[float, float]:
        depth = explicit(motion, step, steps, parts)[1][:, PLUNGER] - plan.gear.yoke.clearance
        return float(plan.gear.yoke.nut_stiffness * max(depth.max(), 0.0)), nan

    return Expected.of(confirmed(moved), "Runge-Kutta")
