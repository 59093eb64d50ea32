"""Free pinion torque: the rig turns the pinion at the test's speed, the rack carries no load.

One way over `test.turns`, there and back, or lock to lock and back (`test.path`).
"""

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.figures import figures_of_turning
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.remarks import remarks
from rps_exudyn.scenes.run_maneuver import run_maneuvers
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.closed_form import beyond_formulas, closed_form


def free_pinion_torque(gear: SteeringGear, fidelity: Fidelity) -> SceneRun:
    """Turn the pinion and record.

    Raises:
        InputError: the test leaves the rack's teeth.
    """
    run = run_maneuvers(gear, fidelity, maneuvers_of_test(gear, "pinion", fidelity.step_angle))
    formula = {} if beyond_formulas(gear) else {"torque_closed_form": _by_formula(gear)}
    return run.noting(*remarks(gear, run.signals)).described(
        lambda signals: {**figures_of_turning(signals, gear), **formula}
    )


def _by_formula(gear: SteeringGear) -> float:
    return closed_form(gear).towards(gear.test.direction).torque
