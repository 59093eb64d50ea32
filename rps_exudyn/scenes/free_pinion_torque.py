"""Free pinion torque: the rig turns the pinion at the test's speed, the rack carries no load.

One way over `test.turns`, there and back, or lock to lock and back (`test.path`).
"""

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.rules import remarks
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.metrics import figures_of_turning
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene, SteadyTest
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import beyond_formulas, mean_state


def free_pinion_torque(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Turn the pinion and record.

    Raises:
        InputError: the test leaves the rack's teeth.
    """
    maneuvers, _ = TEST.maneuvers(gear, fidelity.step_angle, options.least_steps)
    formula = _by_formula(gear)

    def metrics(signals: Signals) -> dict[str, float]:
        return {**figures_of_turning(signals, gear), **formula}

    run = run_maneuver(gear, fidelity, maneuvers, options).described(metrics)
    return run.noting(*remarks(gear, run.signals))


def _by_formula(gear: SteeringGear) -> dict[str, float]:
    if beyond_formulas(gear):
        return {}
    return {"torque_closed_form": mean_state(gear, gear.test.direction, 0.0).torque}


TEST = SteadyTest(
    maneuvers=lambda gear, step_angle, least: (maneuvers_of_test(gear, "pinion", step_angle, least), None),
    metrics=lambda turned: figures_of_turning(turned.signals, turned.gear, turned.gain),
    curve=("time", "pinion_angle", "pinion_torque"),
    formulas=_by_formula,
)

SCENE = Scene(
    name="free-pinion-torque",
    title="Free pinion torque",
    run=free_pinion_torque,
    signal="pinion_torque",
    figure="torque_mean",
    chart="torque",
    steady=True,
    test=TEST,
)
