"""Make a maneuver: by dynamics in Exudyn, equilibria, a table of them or formulas, as the fidelity asks.

    run = run_maneuver(gear, fidelity, maneuver)
    run = run_maneuver(gear, fidelity, [there, back], options)

All give the same signals as far as they have them. None is called ok before its record is checked.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from time import process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.analysis.rack_motion import Gain, transmission_error
from rps_exudyn.analysis.work_balance import integral_from_start
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import begin_part
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.local_gear import LocalGears
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import law_of_formulas
from rps_exudyn.results.outcome import Code, Interrupted, Outcome, Remark, Status
from rps_exudyn.scenes.checks.before_run import check_memory
from rps_exudyn.scenes.ladder import cycles_before
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.run_reduced import by_reduced
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, RunOptions, SteadyRecord, SteadyTest
from rps_exudyn.scenes.scene_run import SceneRun, Signals, joined, lost, outcome_of_path
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.closed_form import beyond_formulas, mean_state, pushing_force, runout_harmonics
from rps_exudyn.solvers.equilibrium import EquilibriumPath, PathInterrupted, equilibrium_path
from rps_exudyn.solvers.gear_forces import accelerated, gear_forces
from rps_exudyn.solvers.prescribed_motion import SetOff, Steady, Swing, travel_per_radian
from rps_exudyn.solvers.record import (
    COORDINATES,
    Record,
    behind_column,
    record_of_path,
    repeated,
    signals_of,
    under_torque,
)
from rps_exudyn.solvers.settled_start import settled_behind, settled_path
from rps_exudyn.solvers.sliding_stability import presliding_angle
from rps_exudyn.solvers.steering_column import BehindColumn, ColumnModel, WheelTorque

if TYPE_CHECKING:
    from rps_exudyn.multibody.solve import SolverPlan
    from rps_exudyn.multibody.steering_model import SteeringModel

SHORTEST_STEP = 1e-7  # of the dynamics [s] ...
SHORTEST_AT_TURNS = 1e-9  # ... where all friction turns about at once
LEAST_FORCE = 10.0  # of which a tolerance is a fraction [N]
STEADY = 2e-4  # of the force and of the rack's travel, over a period: what drifts less is settled ...
RETURNED = 3e-3  # ... if each motion of the rack beside its travel returns, but for this part of its range
LEAST_RANGE = 1e-7  # of such a motion, below which it is none [m]
UNDER_TORQUE = 0.1  # of the tolerance where a torque is given, for what is left over would hold the gear
REVERSING_DRIVES = Swing, SetOff, WheelTorque  # drives under which friction turns about
TURNING_ABOUT = 0.005  # of the way between reversals: bristles take five times that of the work
CAUSE_MAY_BE_RECORDED = {Code.NO_EQUILIBRIUM, Code.GEAR_JUMPS, Code.NO_STEP, Code.STEPS_USED_UP}
"""Ends of a run whose record may show that the gear had left its contact's law, or its mesh, before."""
SHAKEN = 0.15  # contractivity: between impacts an old Jacobian takes twice the iterations
FOLLOWS = "only generalized-alpha follows a jump"
JUMPS = (
    "; where the gear's torque falls by more than the column's {:.4g} N*m/rad, or the rack snaps "
    f"through at a reversal, the gear jumps; {FOLLOWS}"
)
JUMPS_UNDER_TORQUE = f"; under a given torque the gear jumps where friction falls; {FOLLOWS}"
LENGTHS = dict(zip(COORDINATES, CHARACTERISTIC_LENGTHS[2:], strict=True))  # of the rack's coordinates
CYCLE_DRIFT_LIMIT = 1e-3  # of the drive's force: how much all periods may drift for one to stand for all


def run_maneuver(
    gear: SteeringGear,
    fidelity: Fidelity,
    maneuvers: Maneuver | Sequence[Maneuver],
    options: RunOptions = DEFAULT_OPTIONS,
) -> SceneRun:
    """Make maneuvers one after the other until one fails, joined to one record without a summary."""
    runs: list[SceneRun] = []
    maneuvers = [maneuvers] if isinstance(maneuvers, Maneuver) else maneuvers
    for number, maneuver in enumerate(each.halved(options.halvings) for each in maneuvers):
        begin_part(number, len(maneuvers))
        if fidelity.solver != "closed-form":
            spheres = fidelity.profile_samples * fidelity.axial_samples * 2 * gear.pinion.teeth
            check_memory(maneuver.parts, spheres if fidelity.mesh == "general-contact" else 0)
        try:
            runs.append(SOLVERS[fidelity.solver](gear, fidelity, maneuver, options))
        except np.linalg.LinAlgError as error:
            message = f"the gear has no stiffness against a force at its start: {error}"
            runs.append(SceneRun(Outcome(Status.NO_CONVERGENCE, message, (Code.NO_RESISTANCE,))))
        except Interrupted as interrupt:
            raise Interrupted(joined([*runs, interrupt.recorded])) from None
        if not runs[-1].ok:
            break
    return joined(runs)


def run_steady(test: SteadyTest, gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Make the recorded maneuvers of a steady test without a load."""
    maneuvers, _ = test.maneuvers(gear, fidelity.step_angle, options.least_steps)
    gain = GearPair.of(gear).travel_rule

    def metrics(signals: Signals) -> dict[str, float]:
        return test.metrics(SteadyRecord(gear, signals, {}, gain, 0.0))

    return run_maneuver(gear, fidelity, maneuvers, options).described(metrics, gear)


def run_swing(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Make a swing after as many cycles as the level has before its record."""
    return run_maneuver(gear, fidelity, maneuver.begun_earlier(cycles_before(options.level)), options)


# --- dynamics --------------------------------------------------------------------------------------
def by_dynamics(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Integrate the equations of motion in Exudyn."""
    from rps_exudyn.multibody.model import build_model
    from rps_exudyn.multibody.recorder import Recorder
    from rps_exudyn.multibody.solve import solve_one_after_another
    from rps_exudyn.multibody.steering_model import vibration

    model = build_model(
        gear,
        fidelity,
        maneuver.drive,
        rack_load=maneuver.rack_load,
        pulse=maneuver.pulse,
        approach=maneuver.approach,
        pictured=False,
    )
    try:
        if not model.start.converged:
            return SceneRun(lost(model.start, _end_of(model.start, maneuver), Outcome(Status.OK)))
        plans = _plans(gear, fidelity, maneuver, model)
        model.mbs.Assemble()
        recorder = Recorder(model).attach()
        recorder.end, recorder.planned = plans[-1].end_time, sum(plan.steps for plan in plans)
        interrupted = False
        try:
            outcome = solve_one_after_another(model.mbs, plans, recorder.rewind, recorder.reached)
        except KeyboardInterrupt:
            message = f"interrupted at {recorder.reached:.4g} s of {recorder.end:.4g} s"
            outcome = Outcome(Status.TIMEOUT, message, (Code.INTERRUPTED,))
            interrupted = True
        record = recorder.record()
        if maneuver.is_steady and outcome.status is Status.OK:
            outcome.findings.update(vibration(model, record))
        run = _finished(gear, maneuver, outcome, record, model.start, options)
    finally:
        model.release()
    if interrupted:
        raise Interrupted(run)
    return run


def _plans(
    gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, model: "SteeringModel"
) -> list["SolverPlan"]:
    """How Exudyn integrates the pieces of a maneuver."""
    from rps_exudyn.multibody.solve import SolverPlan

    tolerance = fidelity.tolerance * max(gear.yoke.preload, LEAST_FORCE)
    if isinstance(maneuver.drive, WheelTorque):
        tolerance *= UNDER_TORQUE
    return [
        SolverPlan(
            start_time=piece.before * maneuver.time_step,
            end_time=(piece.before + piece.steps) * maneuver.time_step,
            steps=piece.steps * piece.parts,
            absolute_tolerance=tolerance,
            # steadily none: what an equilibrium is off by, over the mass, would throw the rack out of the
            # contact in a long first step
            initial_accelerations=model.contacts is None and not maneuver.is_steady,
            contractivity=SHAKEN if maneuver.pulse is not None and model.modes else SolverPlan.contractivity,
            minimum_step=SHORTEST_AT_TURNS if isinstance(maneuver.drive, REVERSING_DRIVES) else SHORTEST_STEP,
        )
        for piece in maneuver.pieces()
    ]


# --- equilibria ------------------------------------------------------------------------------------
def by_equilibrium(
    gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions
) -> SceneRun:
    """Go from equilibrium to equilibrium; a curve that repeats is followed over one period only.

    It repeats if all periods together drift by little: under its weight a rack tilts more the farther it is
    out.
    """
    if maneuver.pulse is not None:
        raise InputError("fidelity.solver is equilibrium, which has no pulses: choose generalized-alpha.")
    run = _along_equilibria(gear, fidelity, maneuver.one_period(), options)
    if maneuver.periods == 1 or not run.ok:
        return run
    force = run.signals[maneuver.drive.signal]
    if maneuver.periods * abs(force[-1] - force[0]) > CYCLE_DRIFT_LIMIT * np.abs(force).max():
        return _along_equilibria(gear, fidelity, maneuver, options)
    run.outcome.findings["periods_alike"] = maneuver.periods
    return replace(run, signals=repeated(run.signals, maneuver.periods))


def _along_equilibria(
    gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions
) -> SceneRun:
    """Follow the equilibria of a maneuver from a settled start.

    Those that lead to the start are left out where at the end of a period the gear is as at its start.
    """
    forces, drive = gear_forces(gear, fidelity, maneuver.rack_load), maneuver.drive
    column = ColumnModel.of(gear) if drive.body == "wheel" else None
    turned = drive if column is None else replace(drive, body="pinion")
    pair, time = forces.pair, maneuver.time
    balance = forces.statics if isinstance(drive, Steady) else accelerated(gear, forces)
    closes = maneuver.closes and maneuver.approach is not None
    for approach in (None, maneuver.approach) if closes else (maneuver.approach,):
        start, interrupted = process_time(), False
        try:
            if column is None:
                path = settled_path(balance, pair, drive, approach, time)
            else:
                path = settled_behind(balance, pair, drive, column, approach)
                if path.converged:
                    behind = BehindColumn("pinion", drive, column)
                    path = equilibrium_path(balance, pair, behind, time, path, column)
        except PathInterrupted as interrupt:
            path, interrupted = interrupt.path, True
        outcome = outcome_of_path(path, process_time() - start)
        outcome.findings["angles"] = path.time.size
        if interrupted:
            message = f"interrupted at {drive.shown(path.time[-1])}"
            outcome = replace(outcome, status=Status.TIMEOUT, codes=(Code.INTERRUPTED,), message=message)
        elif not path.converged:
            outcome = lost(path, _end_of(path, maneuver), outcome)
            if column is not None:
                jumps = JUMPS_UNDER_TORQUE if isinstance(drive, WheelTorque) else JUMPS
                outcome = replace(outcome, message=outcome.message + jumps.format(column.stiffness))
            elif path.jumps:
                outcome = replace(outcome, message=f"{outcome.message}; {FOLLOWS}")
        record = record_of_path(forces, path, turned)
        if column is not None and path.wheel.size:  # else the gear was lost on its way to the start
            if isinstance(drive, WheelTorque):
                record = under_torque(record, column, drive, -path.wheel)
            else:
                record = behind_column(record, column, drive)
        run = _finished(gear, maneuver, outcome, record, path, options)
        if interrupted:
            raise Interrupted(run)
        if approach is not maneuver.approach and run.ok and _is_settled(run.signals, drive.signal, pair):
            break
    return run


def _is_settled(signals: Signals, driven: str, pair: GearPair) -> bool:
    """Return whether a gear ends a record as it began it."""
    travel, force = float(np.ptp(signals["rack_displacement"])), signals[driven]
    moved = max(_change(signals[name]) * length for name, length in LENGTHS.items())
    drift = max(moved / travel, _change(force) / (float(np.abs(force).max()) or 1.0))
    return drift <= STEADY and drift_beside_travel(signals, pair.travel_rule) <= RETURNED


def drift_beside_travel(signals: Signals, gain: Gain) -> float:
    """Return how far a record ends from where it began, in motions of the rack beside its travel: the largest
    share of a motion's range. `gain` is the rack's travel per radian [m]."""
    beside = [transmission_error(signals, gain)]
    beside += [signals[name] * length for name, length in LENGTHS.items() if name in signals]
    return max(_change(each) / max(float(np.ptp(each)), LEAST_RANGE) for each in beside)


def _change(values: np.ndarray) -> float:
    return abs(float(values[-1] - values[0]))


def _end_of(path: EquilibriumPath, maneuver: Maneuver) -> str:
    return f"at {maneuver.drive.shown(path.lost_at or 0.0)}"


# --- common ----------------------------------------------------------------------------------------
def _finished(
    gear: SteeringGear,
    maneuver: Maneuver,
    outcome: Outcome,
    record: Record,
    start: EquilibriumPath,
    options: RunOptions,
) -> SceneRun:
    """Signals of a record that began as `start` did, and whether it may be called ok."""
    record = record.since(maneuver.record_start)
    if len(record.time) < 2:
        return SceneRun(outcome)
    record = replace(record, start=start.start)
    signals = signals_of(record)
    if outcome.status is Status.OK or CAUSE_MAY_BE_RECORDED & {*outcome.codes}:
        outcome = options.check(outcome, gear, record, signals)
    if (depends := start.start.unsettled_behind) > 0:
        outcome = replace(outcome, findings={**outcome.findings, "start_unsettled": depends})
    return SceneRun(outcome, signals)


# --- formulas: mean values, losses, the runout's harmonic; no ripple, no elasticity ----------------


def by_formula(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Fill the maneuver's record, without its run-in, with mean values.

    No check follows: the formulas state where they do not hold.

    Raises:
        InputError: the maneuver shakes the rack, or turns the steering wheel.
    """
    if maneuver.drive.body == "wheel":
        raise InputError(
            "fidelity.solver is closed-form, which has no steering column; use equilibrium or "
            "generalized-alpha."
        )
    if maneuver.pulse is not None:
        raise InputError("fidelity.solver is closed-form, which has no pulses; use generalized-alpha.")
    start = process_time()
    beyond = beyond_formulas(gear) or beyond_formulas_in(gear, maneuver)
    signals = _mean_signals(gear, maneuver)
    outcome = Outcome(
        Status.INVALID if beyond else Status.OK,
        beyond,
        (Code.BEYOND_FORMULAS,) if beyond else (),
        time_reached=float(signals["time"][-1]),
        cpu_s=process_time() - start,
        settings={"name": "closed-form"},
    )
    law = gear.mesh.contact_law
    taken = law_of_formulas(law)
    text = f"mesh.law is {law}; the closed form takes loads per length as law {taken} has them"
    return SceneRun(outcome, signals).noting(None if taken == law else Remark(Code.OTHER_LAW, text))


def beyond_formulas_in(gear: SteeringGear, maneuver: Maneuver) -> str:
    """Return why the formulas, which hold for this gear, do not in this maneuver; "" where they do."""
    if gear.bush.viscous_drag and np.ptp(np.abs(maneuver.drive.rate(maneuver.time))) > 0:
        return "the formulas take bush.viscous_drag at a constant speed"
    turning = presliding_angle(gear) / np.ptp(maneuver.drive.place(maneuver.time))
    if turning > TURNING_ABOUT and not maneuver.is_steady:
        return (
            f"the formulas have no bristles, which turn about over {turning:.1%} of the way between reversals"
        )
    by_load = [f"{part}.load_exponent" for part in RUBBING_PARTS if getattr(gear, part).varies_with_load]
    if by_load and (maneuver.rack_load or maneuver.drive.body == "rack"):
        return f"the formulas take friction under the yoke's preload alone, without {', '.join(by_load)}"
    return ""


def _mean_signals(gear: SteeringGear, maneuver: Maneuver) -> Signals:
    """Signals of the mean forces, sense of motion by sense.

    Raises:
        InputError: the rack is pushed, and the gear locks itself.
    """
    time, pair = maneuver.time[maneuver.lead :], GearPair.of(gear)
    body, pull = maneuver.drive.body, maneuver.rack_load
    place, rate = maneuver.drive.place(time), maneuver.drive.rate(time)
    angle = pair.angle_at(place) if body == "rack" else place
    rate = rate / travel_per_radian(body, pair.gain_at(angle))
    local = LocalGears.between(gear, angle)
    weights = local.weights(pair.gain_at(angle))
    pushed = {
        sense: [pushing_force(each, sense, pull) if body == "rack" else 0.0 for each in local.gears]
        for sense in (-1, 1)
    }
    if not np.isfinite(list(pushed.values())).all():
        raise InputError(
            f"the gear locks itself by closed-form: with mesh.friction {gear.mesh.friction:g} and "
            f"yoke.friction {gear.yoke.friction:g} no force on the rack turns the pinion."
        )
    states = {
        sense: [
            mean_state(each, sense, pull - force) for each, force in zip(local.gears, forces, strict=True)
        ]
        for sense, forces in pushed.items()
    }

    def along(forward: Any, backward: Any) -> np.ndarray:
        """Numbers of the local gears, by the sense of motion, at each instant."""
        return np.asarray(np.where(rate > 0, weights @ forward, weights @ backward))

    def mean(name: str) -> np.ndarray:
        return along(*([getattr(state, name) for state in states[sense]] for sense in (1, -1)))

    def lost(name: str) -> np.ndarray:
        return integral_from_start(mean(name) * np.abs(rate), time)

    signals = {
        "time": time - time[0],
        "pinion_angle": angle,
        "pinion_torque": mean("torque"),
        "rack_displacement": pair.travel_at(angle),
        "mesh_normal_force_drive": mean("normal_drive"),
        "mesh_normal_force_coast": mean("normal_coast"),
        "mesh_normal_force": mean("normal_drive") + mean("normal_coast"),
        "seat_force": mean("plunger_force"),
        "work_mesh_friction": lost("mesh_loss"),
        "work_seat_friction": lost("plunger_loss"),
        "work_bush_friction": lost("bush_loss"),
        "work_bearing_friction": lost("bearing_loss"),
    }
    if pull:
        signals["load_force"] = np.full_like(angle, pull)
        signals["work_load"] = -pull * (signals["rack_displacement"] - signals["rack_displacement"][0])
    if body == "rack":
        del signals["pinion_torque"]  # nothing but friction acts on the pinion
        signals["rack_force"] = along(pushed[1], pushed[-1])
    else:
        # what the runout does to friction turns with the direction, what it stores in the spring does not
        cosine, sine = (weights @ np.array([runout_harmonics(each) for each in local.gears])).T
        phase = angle + gear.pinion.runout_angle
        signals["pinion_torque"] += np.sign(rate) * cosine * np.cos(phase) + sine * np.sin(phase)
    power = signals[maneuver.drive.signal] * maneuver.drive.rate(time)
    signals["work_drive"] = integral_from_start(power, time)
    return signals


Solver = Callable[[SteeringGear, Fidelity, Maneuver, RunOptions], SceneRun]

SOLVERS: dict[str, Solver] = {
    "generalized-alpha": by_dynamics,
    "equilibrium": by_equilibrium,
    "reduced": partial(by_reduced, by_equilibrium),
    "closed-form": by_formula,
}
