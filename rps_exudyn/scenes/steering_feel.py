"""Steering feel: the hand turns the wheel to and fro; what it feels through the column, without a road.

The wheel is steered sinusoidally about `test.start_angle`, fastest, at the test's speed, in the middle.
Equilibria take the column as a spring in series, dynamics the vibration of the gear behind it as well.
"""

from rps_exudyn.analysis.hysteresis import lost_motion
from rps_exudyn.analysis.wheel_metrics import describe_feel
from rps_exudyn.forces.pinion_support import with_float
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import YIELDING, swing_maneuver
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.run_maneuver import run_swing
from rps_exudyn.scenes.scene import RunOptions, Scene, swept_revolutions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import free_torque
from rps_exudyn.solvers.steering_column import ColumnModel


def steering_feel(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Steer to and fro at the wheel and record."""
    fidelity = with_float(gear, fidelity)
    twisted = 2 * abs(free_torque(gear)) / ColumnModel.of(gear).stiffness
    maneuver = swing_maneuver(gear, fidelity.step_angle, "wheel", YIELDING + twisted)

    def metrics(signals: Signals) -> dict[str, float]:
        lost = lost_motion(signals)
        angle = {} if lost is None else {"lost_motion_angle": lost / float(GearPair.of(gear).gain)}
        return {**describe_feel(signals), **angle, **metrics_of_motion(signals, gear)}

    return run_swing(gear, fidelity, maneuver, options).described(metrics, gear)


SCENE = Scene(
    name="steering-feel",
    title="Steering feel: torque at the wheel",
    run=steering_feel,
    signal="column_torque",
    main_metric="feel_area",
    chart="steering_feel",
    swings=True,
    revolutions=swept_revolutions,
)
