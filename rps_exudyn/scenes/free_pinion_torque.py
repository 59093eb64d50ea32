"""Free pinion torque: the rig turns the pinion at the test's speed, the rack carries no load.

Signals are recorded over `test.turns` from `test.start_angle`. Solvers start a little earlier, from the
static equilibrium of steady turning, so that what the start stirs up has died when the record begins.
"""

from collections.abc import Callable
from dataclasses import replace
from time import process_time

import numpy as np
from scipy.integrate import cumulative_trapezoid

from rps_exudyn.analysis.torque import describe_torque
from rps_exudyn.analysis.work_balance import energy_residual
from rps_exudyn.closed_form import beyond_formulas, closed_form
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.forces import gear_forces
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.judge import judged
from rps_exudyn.outcome import Status
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.record import Record, repeated, signals_of
from rps_exudyn.scenes.scene_run import SceneRun, Turning, whole_periods, without_equilibrium
from rps_exudyn.solve import Outcome, SolverPlan, solve
from rps_exudyn.statics import TOLERANCE, adaptive_path, equilibrium_path

CLOSED = 1e-3  # of the torque: how well a period must end where it began to stand for all


def free_pinion_torque(gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """Turn the pinion and record.

    Raises:
        InputError: the test leaves the rack's travel.
    """
    turning = Turning.of(gear, fidelity.step_angle)
    return SOLVERS[fidelity.solver](gear, fidelity, turning)


def by_dynamics(gear: SteeringGear, fidelity: Fidelity, turning: Turning) -> SceneRun:
    """In Exudyn."""
    from rps_exudyn.model import build_model
    from rps_exudyn.recording import Recorder
    from rps_exudyn.scenes.drive import turn_pinion

    model = build_model(gear, fidelity, angle=turning.first)
    if not model.start.converged:
        return without_equilibrium(turning.first, model.start.residual)
    turn_pinion(model)
    recorder = Recorder(model).attach()
    model.mbs.Assemble()
    steps = turning.lead + turning.steps
    plan = SolverPlan(end_time=steps * turning.time_step, steps=steps, relative_tolerance=fidelity.tolerance)
    outcome = solve(model.mbs, plan)
    record = recorder.record().since(turning.lead * turning.time_step * (1 + 1e-9))
    return _told(gear, outcome, record)


def by_equilibrium(gear: SteeringGear, fidelity: Fidelity, turning: Turning) -> SceneRun:
    """From equilibrium to equilibrium; a curve that repeats is followed over one period only."""
    periods = whole_periods(gear) or 1
    once = replace(turning, steps=turning.steps // periods)
    run = _along_equilibria(gear, fidelity, once)
    if periods == 1 or run.outcome.status is not Status.OK:
        return run
    torque = run.signals["pinion_torque"]
    if abs(torque[-1] - torque[0]) > CLOSED * np.abs(torque).max():
        return _along_equilibria(gear, fidelity, turning)
    signals = repeated(run.signals, periods)
    outcome = replace(run.outcome, settings={**run.outcome.settings, "periods_alike": periods})
    # over more periods only the torque's figures can change: orders need whole turns
    torque_figures = describe_torque(signals["pinion_angle"], signals["pinion_torque"], gear.pinion.teeth)
    return SceneRun(outcome, signals, {**run.summary, **torque_figures})


def _along_equilibria(gear: SteeringGear, fidelity: Fidelity, turning: Turning) -> SceneRun:
    forces = gear_forces(gear, fidelity)
    start = process_time()
    pair, speed = GearPair.of(gear), gear.test.direction * gear.test.speed
    if fidelity.torque_tolerance > 0:
        allowed = fidelity.torque_tolerance * abs(closed_form(gear).free_torque)
        path = adaptive_path(*forces.statics, pair, turning.angles, speed, allowed)
    else:
        path = equilibrium_path(*forces.statics, pair, turning.angles, speed)
    cpu = process_time() - start
    found = len(path.coordinates)
    time = (turning.first + path.coordinates[:, 0]) / path.rates[0, 0] if found else np.zeros(0)
    outcome = Outcome(
        Status.OK,
        time_reached=float(time[-1]) if found else 0.0,
        cpu_s=cpu,
        counters={
            "steps": found,
            "newton_iterations": path.iterations,
            "jacobians": path.tangents,
            "force_evaluations": path.evaluations,
        },
        settings={"name": "equilibrium", "tolerance": TOLERANCE, "residual": path.residual, "angles": found},
    )
    if not path.converged:
        failed = without_equilibrium(turning.angles[found], path.residual).outcome
        outcome = replace(outcome, status=failed.status, message=failed.message)
    record = Record(forces.elements, time, path.coordinates, path.rates, path.forces[:, 0], np.zeros(found))
    return _told(gear, outcome, record.since(turning.lead * turning.time_step * (1 + 1e-9)))


def by_formula(gear: SteeringGear, fidelity: Fidelity, turning: Turning) -> SceneRun:
    """In closed form: mean torque and its losses, once-per-turn share of the runout, no ripple."""
    start = process_time()
    formula, direction = closed_form(gear), gear.test.direction
    beyond = beyond_formulas(gear)
    mean = formula.forward if direction > 0 else formula.backward
    angle = turning.angles[turning.lead :]
    phase = angle + gear.pinion.runout_angle
    # what the runout does to friction turns with the direction, what it stores in the spring does not
    torque = (
        mean.torque + direction * formula.runout_cosine * np.cos(phase) + formula.runout_sine * np.sin(phase)
    )
    turned = np.abs(angle - angle[0])
    signals = {
        "time": turned / gear.test.speed,
        "pinion_angle": angle,
        "pinion_torque": torque,
        "rack_displacement": formula.rack_gain * angle,
        "mesh_normal_force_drive": np.full_like(angle, mean.normal_drive),
        "mesh_normal_force_coast": np.full_like(angle, mean.normal_coast),
        "mesh_normal_force": np.full_like(angle, mean.normal_drive + mean.normal_coast),
        "seat_force": np.full_like(angle, mean.plunger_force),
        "work_drive": cumulative_trapezoid(torque, angle, initial=0.0),
        "work_mesh_friction": mean.mesh_loss * turned,
        "work_seat_friction": mean.plunger_loss * turned,
        "work_bush_friction": mean.bush_loss * turned,
        "work_bearing_friction": mean.bearing_loss * turned,
    }
    outcome = Outcome(
        Status.INVALID if beyond else Status.OK,
        beyond,
        time_reached=float(signals["time"][-1]),
        cpu_s=process_time() - start,
        settings={"name": "closed-form"},
    )
    return SceneRun(outcome, signals, figures(signals, gear))


def _told(gear: SteeringGear, outcome: Outcome, record: Record) -> SceneRun:
    """Signals and figures of a record, and whether it may be called ok."""
    if len(record.time) < 2:
        return SceneRun(outcome)
    signals = signals_of(record)
    summary = {**figures(signals, gear), "energy_residual": energy_residual(signals)}
    if outcome.status is Status.OK:
        outcome = judged(outcome, gear, record, signals, summary)
    return SceneRun(outcome, signals, summary)


def figures(signals: dict[str, np.ndarray], gear: SteeringGear) -> dict[str, float]:
    """The scene's figures, by the names of `quantities.SUMMARY`."""
    angle, place = signals["pinion_angle"], signals["rack_displacement"]
    formula = {}
    if not beyond_formulas(gear):
        mean = closed_form(gear)
        formula["torque_closed_form"] = (mean.forward if gear.test.direction > 0 else mean.backward).torque
    return {
        **describe_torque(angle, signals["pinion_torque"], gear.pinion.teeth),
        **formula,
        "rack_gain": float((place[-1] - place[0]) / (angle[-1] - angle[0]) * 2 * np.pi),
    }


SOLVERS: dict[str, Callable[[SteeringGear, Fidelity, Turning], SceneRun]] = {
    "generalized-alpha": by_dynamics,
    "equilibrium": by_equilibrium,
    "closed-form": by_formula,
}
