"""A swing to and fro, recorded over cycles that are all alike.

The equilibria that lead to its start are far apart, so that the rack may still roll into its cycle during the
record. It shows: the first cycle does not end where it began. Such a swing is made again with one more cycle
before the record.
"""

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.run_options import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.drive import Swing

CLOSED = 0.01  # of the largest torque, by which a cycle may end elsewhere than it began


def run_swing(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Make a swing, from one cycle earlier where the first one does not close."""
    run = run_maneuver(gear, fidelity, maneuver, options)
    if not run.ok or closes(run.signals, maneuver):
        return run
    return run_maneuver(gear, fidelity, maneuver.begun_a_cycle_earlier(), options)


def closes(signals: Signals, maneuver: Maneuver) -> bool:
    """Tell whether the first recorded cycle of a swing ends under the torque under which it began."""
    assert isinstance(maneuver.drive, Swing)
    time, torque = signals["time"], signals[maneuver.drive.signal]
    after = np.interp(time[0] + maneuver.drive.period, time, torque)
    return bool(abs(after - torque[0]) <= CLOSED * np.abs(torque).max())
