"""Rack push: the rig moves the rack, the pinion follows freely. The force that drives the gear back.

The rack moves as fast as the pinion would move it at the test's speed, over the same travel.
"""

from functools import partial

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.run_maneuver import run_steady
from rps_exudyn.scenes.scene import Scene, SteadyRecord, SteadyTest
from rps_exudyn.scenes.scene_run import Signals


def _metrics(record: SteadyRecord) -> dict[str, float]:
    of_motion = metrics_of_motion(record.signals, record.gear, record.gain)
    return {**push_metrics(record.signals), **of_motion}


def push_metrics(signals: Signals) -> dict[str, float]:
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
    run=partial(run_steady, TEST),
    signal="rack_force",
    main_metric="push_force_mean",
    chart="rack_push",
    steady=True,
    test=TEST,
)
