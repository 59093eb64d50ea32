"""Reversal: sinusoidal steering about `test.start_angle`. Hysteresis of the torque, lost motion, sticking.

Steering is fastest, at the test's speed, where it passes the middle; it stands still at both ends.
"""

from rps_exudyn.analysis.hysteresis import describe_reversal
from rps_exudyn.forces.pinion_support import with_float
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.run_maneuver import run_swing
from rps_exudyn.scenes.scene import RunOptions, Scene, swept_revolutions
from rps_exudyn.scenes.scene_run import SceneRun, Signals


def reversal(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Steer to and fro and record."""
    fidelity = with_float(gear, fidelity)
    gain = float(GearPair.of(gear).gain_at(gear.test.start_angle))

    def metrics(signals: Signals) -> dict[str, float]:
        return {**describe_reversal(signals, gain), **metrics_of_motion(signals, gear)}

    run = run_swing(gear, fidelity, swing_maneuver(gear, fidelity.step_angle), options)
    return run.described(metrics, gear)


SCENE = Scene(
    name="reversal",
    title="Reversal",
    run=reversal,
    signal="pinion_torque",
    main_metric="hysteresis_area",
    chart="reversal",
    swings=True,
    revolutions=swept_revolutions,
)
