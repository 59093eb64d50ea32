"""Free pinion torque: the rig turns the pinion at the test's speed, the rack carries no load.

Signals are recorded over `test.turns` from `test.start_angle`. The model starts a little earlier, in its
static equilibrium, so that what the start stirs up has died when the record begins.
"""

import numpy as np

from rps_exudyn.analysis.torque import describe_torque
from rps_exudyn.analysis.work_balance import energy_residual
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.judge import judged
from rps_exudyn.model import build_model
from rps_exudyn.outcome import Status
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.recording import Recorder, signals_of
from rps_exudyn.scenes.drive import turn_pinion
from rps_exudyn.scenes.scene_run import SceneRun, check_travel, without_equilibrium
from rps_exudyn.solve import SolverPlan, solve

RUN_IN = np.deg2rad(0.5)  # pinion angle turned before the record starts, at least


def free_pinion_torque(gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """Turn the pinion in Exudyn and record.

    Raises:
        InputError: the test leaves the rack's travel.
    """
    test = gear.test
    angle = 2 * np.pi * test.turns
    check_travel(gear, test.start_angle, test.start_angle + test.direction * angle)

    steps = int(np.ceil(angle / fidelity.step_angle))
    step = angle / steps
    lead = int(np.ceil(RUN_IN / step))
    first = test.start_angle - test.direction * lead * step
    model = build_model(gear, fidelity, angle=first)
    if not model.start.converged:
        return without_equilibrium(first, model.start.residual)
    turn_pinion(model)
    recorder = Recorder(model).attach()
    model.mbs.Assemble()
    outcome = solve(model.mbs, SolverPlan(end_time=(lead + steps) * step / test.speed, steps=lead + steps))

    record = recorder.record().since(lead * step / test.speed * (1 + 1e-9))
    if len(record.time) < 2:
        return SceneRun(outcome)
    signals = signals_of(record)
    summary = summarise(signals, gear)
    if outcome.status is Status.OK:
        outcome = judged(outcome, record, signals, summary)
    return SceneRun(outcome, signals, summary)


def summarise(signals: dict[str, np.ndarray], gear: SteeringGear) -> dict[str, float]:
    """The scene's figures, by the names of `quantities.SUMMARY`."""
    angle, place = signals["pinion_angle"], signals["rack_displacement"]
    return {
        **describe_torque(angle, signals["pinion_torque"], gear.pinion.teeth),
        "rack_gain": float((place[-1] - place[0]) / (angle[-1] - angle[0]) * 2 * np.pi),
        "energy_residual": energy_residual(signals),
    }
