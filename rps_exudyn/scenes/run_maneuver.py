"""Make a maneuver: by dynamics in Exudyn, by equilibria, or by formula, as the fidelity says.

    run = run_maneuver(gear, fidelity, maneuver)

All give the same signals as far as they know them, and none is called ok before it was judged.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from time import process_time

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.checks.after_run import rolling_fraction, validated
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.multibody.solve import SolverPlan, solve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.by_formula import by_formula
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.scene_run import SceneRun, joined
from rps_exudyn.solvers.closed_form import closed_form
from rps_exudyn.solvers.drive import travel_per_radian
from rps_exudyn.solvers.equilibrium import EquilibriumPath, adaptive_path, settled_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.path_follower import TOLERANCE
from rps_exudyn.solvers.record import Record, repeated, signals_of

LEAST_FORCE = 10.0  # that a tolerance is a share of [N]
ROLLING = 2e-4  # of the rack's travel, over a tooth pitch or more: the torque is settled to 0.15 % then
CLOSED = 1e-3  # of the drive's force: how well a period must end where it began to stand for all


def run_maneuver(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver) -> SceneRun:
    """One maneuver; its run has no summary yet."""
    try:
        return SOLVERS[fidelity.solver](gear, fidelity, maneuver)
    except np.linalg.LinAlgError as error:
        message = f"the gear gives way without resistance at its start: {error}"
        return SceneRun(Outcome(Status.NO_CONVERGENCE, message))


def run_maneuvers(gear: SteeringGear, fidelity: Fidelity, maneuvers: Sequence[Maneuver]) -> SceneRun:
    """One after the other, until one fails."""
    runs: list[SceneRun] = []
    for maneuver in maneuvers:
        runs.append(run_maneuver(gear, fidelity, maneuver))
        if not runs[-1].ok:
            break
    return joined(runs)


# --- dynamics --------------------------------------------------------------------------------------
def by_dynamics(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver) -> SceneRun:
    """In Exudyn."""
    from rps_exudyn.multibody.model import build_model
    from rps_exudyn.multibody.recorder import Recorder

    model = build_model(
        gear,
        fidelity,
        maneuver.drive,
        rack_load=maneuver.rack_load,
        pulse=maneuver.pulse,
        settling=maneuver.settling_time,
    )
    if not model.start.converged:
        return SceneRun(lost(maneuver, model.start, Outcome(Status.OK)))
    recorder = Recorder(model).attach()
    model.mbs.Assemble()
    steps = maneuver.lead + maneuver.steps
    unbalanced = fidelity.tolerance * max(gear.yoke.preload, LEAST_FORCE)
    plan = SolverPlan(end_time=steps * maneuver.time_step, steps=steps, absolute_tolerance=unbalanced)
    outcome = solve(model.mbs, plan)
    record = recorder.record().since(maneuver.record_start)
    model.release()
    return _told(gear, maneuver, outcome, record, model.start, model.forces.friction_zone)


# --- equilibria ------------------------------------------------------------------------------------
def by_equilibrium(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver) -> SceneRun:
    """From equilibrium to equilibrium; a curve that repeats is followed over one period only."""
    if maneuver.pulse is not None:
        raise InputError("fidelity.solver is equilibrium, which knows no pulses: choose generalized-alpha.")
    run = _settled(gear, fidelity, maneuver.one_period())
    if maneuver.periods == 1 or not run.ok:
        return run
    force = run.signals[maneuver.drive.signal]
    if abs(force[-1] - force[0]) > CLOSED * np.abs(force).max():
        return _settled(gear, fidelity, maneuver)
    settings = {**run.outcome.settings, "periods_alike": maneuver.periods}
    return SceneRun(replace(run.outcome, settings=settings), repeated(run.signals, maneuver.periods))


def _settled(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver) -> SceneRun:
    """Without the equilibria that lead to the start, if a record of a tooth pitch or more shows that they are
    not needed: the rack hardly rolls over it."""
    if maneuver.turned(gear) >= 2 * np.pi / gear.pinion.teeth * (1 - 1e-9):
        run = _along_equilibria(gear, fidelity, maneuver.without_settling())
        if run.ok and rolling_fraction(run.signals, gear) <= ROLLING:
            return run
    return _along_equilibria(gear, fidelity, maneuver)


def _along_equilibria(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver) -> SceneRun:
    forces = gear_forces(gear, fidelity, maneuver.rack_load)
    start = process_time()
    pair, drive = GearPair.of(gear), maneuver.drive
    course = forces.statics, pair, drive, maneuver.settling_time, maneuver.time
    if fidelity.torque_tolerance > 0:
        allowed = fidelity.torque_tolerance * abs(closed_form(gear).free_torque)
        path = adaptive_path(*course, allowed / travel_per_radian(drive.body, pair.gain))
    else:
        path = settled_path(*course)
    found = len(path.time)
    outcome = Outcome(
        Status.OK,
        time_reached=float(path.time[-1]) if found else 0.0,
        cpu_s=process_time() - start,
        counters={
            "steps": found,
            "newton_iterations": path.iterations,
            "jacobians": path.tangents,
            "force_evaluations": path.evaluations,
        },
        settings={
            "name": "equilibrium",
            "tolerance": TOLERANCE,
            "residual": path.residual,
            "rescues": path.rescues,
            "angles": found,
        },
    )
    if not path.converged:
        outcome = lost(maneuver, path, outcome)
    overcome = -drive.sign * path.forces[:, drive.coordinate]
    record = Record(
        forces.elements, path.time, path.coordinates, path.rates, overcome, drive.body, np.zeros(found)
    )
    return _told(gear, maneuver, outcome, record.since(maneuver.record_start), path, forces.friction_zone)


# --- common ----------------------------------------------------------------------------------------
def _told(
    gear: SteeringGear,
    maneuver: Maneuver,
    outcome: Outcome,
    record: Record,
    start: EquilibriumPath,
    zone: float,
) -> SceneRun:
    """Signals of a record that began as `start` did, and whether it may be called ok."""
    if len(record.time) < 2:
        return SceneRun(outcome)
    pitch = 2 * np.pi / gear.pinion.teeth
    record = replace(record, settled=-start.begun * gear.test.speed >= pitch * (1 - 1e-9))
    signals = signals_of(record)
    if outcome.status is Status.OK:
        outcome = validated(outcome, gear, record, signals, zone if maneuver.is_steady else None)
    return SceneRun(outcome, signals)


def lost(maneuver: Maneuver, path: EquilibriumPath, outcome: Outcome) -> Outcome:
    """The outcome of a maneuver whose path ends where it found no equilibrium."""
    place = float(maneuver.drive.place(path.lost_at or 0.0))
    shown = (
        f"{np.degrees(place):.4g} deg"
        if maneuver.drive.body == "pinion"
        else f"{1e3 * place:.4g} mm of rack travel"
    )
    message = f"no equilibrium was found at {shown}, {path.residual:.3g} N remain unbalanced"
    return replace(outcome, status=Status.NO_CONVERGENCE, message=message)


SOLVERS: dict[str, Callable[[SteeringGear, Fidelity, Maneuver], SceneRun]] = {
    "generalized-alpha": by_dynamics,
    "equilibrium": by_equilibrium,
    "closed-form": by_formula,
}
