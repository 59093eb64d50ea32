"""Rack push: the rig moves the rack, the pinion follows freely. The force that drives the gear back.

The rack moves as fast as the pinion would move it at the test's speed, over the same travel.
"""

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.rules import remarks
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.metrics import figures_of_motion
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene, SteadyTest, Turned
from rps_exudyn.scenes.scene_run import SceneRun, Signals


def rack_push(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Push the rack and record.

    Raises:
        InputError: the test leaves the rack's teeth.
    """
    maneuvers, _ = TEST.maneuvers(gear, fidelity.step_angle, options.least_steps)
    gain = float(GearPair.of(gear).gain)

    def metrics(signals: Signals) -> dict[str, float]:
        return _metrics(Turned(gear, signals, {}, gain, 0.0))

    run = run_maneuver(gear, fidelity, maneuvers, options).described(metrics)
    return run.noting(*remarks(gear, run.signals))


def _metrics(turned: Turned) -> dict[str, float]:
    """Metrics of the record."""
    of_motion = figures_of_motion(turned.signals, turned.gear, turned.gain)
    return {**push_figures(turned.signals), **of_motion}


def push_figures(signals: Signals) -> dict[str, float]:
    """Return the force along the motion: mean over all displacement, spread in the worse direction."""
    force, place = signals["rack_force"], signals["rack_displacement"]
    work = np.trapezoid(force, place)
    ranges = [np.ptp(each.signals["rack_force"], axis=-1) for each in passes(signals)]
    return {
        "push_force_mean": work / np.abs(np.diff(place)).sum(axis=-1),
        "push_force_peak_to_peak": np.max(ranges, axis=0),
    }


TEST = SteadyTest(
    maneuvers=lambda gear, step_angle, least: (maneuvers_of_test(gear, "rack", step_angle, least), None),
    metrics=_metrics,
    curve=("time", "pinion_angle", "rack_displacement", "rack_force"),
)

SCENE = Scene(
    name="rack-push",
    title="Rack push: force",
    run=rack_push,
    signal="rack_force",
    figure="push_force_mean",
    chart="rack_push",
    steady=True,
    test=TEST,
)
