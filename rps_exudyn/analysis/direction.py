"""Torque towards +X compared with torque towards -X at the same pinion angles."""

from rps_exudyn.analysis.passes import Signals, both_directions
from rps_exudyn.analysis.torque import mean


def describe_directions(signals: Signals) -> dict[str, float]:
    """The summary's figures of both directions, each torque counted against the motion; {} without both."""
    if (both := both_directions(signals)) is None:
        return {}
    *ways, angle = both
    forward, backward = (each.direction * mean(angle, each.over(angle, "pinion_torque")) for each in ways)
    return {
        "torque_mean_forward": forward,
        "torque_mean_backward": backward,
        "torque_direction_difference": forward - backward,
    }
