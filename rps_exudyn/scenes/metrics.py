"""Metrics that several scenes share."""

from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import Pass, passes
from rps_exudyn.analysis.rack_motion import describe_rack
from rps_exudyn.analysis.torque import describe_turning
from rps_exudyn.analysis.work_balance import describe_balance, describe_losses
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.scene_run import Signals


def metrics_of_turning(signals: Signals, gear: SteeringGear, rack_gain: Any = None) -> dict[str, float]:
    """Return the metrics of a pinion turned steadily: its torque, and what any gear in motion shows."""
    runs = passes(signals)
    of_torque = describe_turning(runs, gear.pinion.teeth, gear.test.centre_window)
    return {**of_torque, **_motion(signals, runs, gear, rack_gain)}


def metrics_of_motion(signals: Signals, gear: SteeringGear, rack_gain: Any = None) -> dict[str, float]:
    """Return the metrics of any gear in motion: the rack's displacement per revolution of the pinion, how the
    rack moves in its guides, where the work goes.

    `rack_gain` is the rack's travel per radian [m], a number, one for each of many gears, or the travel by
    the pinion's angle; by default the gear's.
    """
    return _motion(signals, passes(signals), gear, rack_gain)


def _motion(signals: Signals, runs: list[Pass], gear: SteeringGear, rack_gain: Any) -> dict[str, float]:
    gain = GearPair.of(gear).travel_rule if rack_gain is None else rack_gain
    metrics: dict[str, Any] = {}
    if runs:  # else the gear stays where it is
        ends = (runs[0].signals[name] for name in ("rack_displacement", "pinion_angle"))
        travel, turned = (each[..., -1] - each[..., 0] for each in ends)
        metrics["rack_gain"] = travel / turned * 2 * np.pi
    return metrics | describe_rack(signals, runs, gain) | describe_losses(signals) | describe_balance(signals)


figures_of_motion, figures_of_turning = metrics_of_motion, metrics_of_turning
"""Former names, for own scenes."""
