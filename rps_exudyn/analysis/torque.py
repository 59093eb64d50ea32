"""Metrics of the pinion torque over the angle: mean, spread, orders; by direction; on and off centre.

A record in both directions is first divided into `passes`.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from rps_exudyn.analysis.harmonics import LEAST_PER_PERIOD, order_amplitude
from rps_exudyn.analysis.passes import Pass, both_directions


def mean(angle: np.ndarray, values: np.ndarray) -> Any:
    """Mean of values (..., n) over the angle (n,) by the trapezoidal rule."""
    if angle[-1] == angle[0]:
        return values[..., 0]
    return np.trapezoid(values, angle) / (angle[-1] - angle[0])


def describe_turning(runs: Sequence[Pass], teeth: int, window: float) -> dict[str, float]:
    """Metrics of the torque of a pinion turned steadily: first pass, by direction, on and off centre."""
    first = runs[0].signals
    return {
        **describe_torque(first["pinion_angle"], first["pinion_torque"], teeth),
        **describe_directions(runs),
        **describe_on_centre(runs, teeth, window),
    }


def describe_torque(angle: np.ndarray, torque: np.ndarray, teeth: int) -> dict[str, float]:
    """Metrics of the torque from angle [rad], shape (n,), and torque [N m], shape (..., n).

    Orders are left out where the record is too short for them, or has too few instants in a period.
    """
    metrics = {"torque_mean": mean(angle, torque), "torque_peak_to_peak": np.ptp(torque, axis=-1)}
    per_pitch = 2 * np.pi / teeth / np.abs(np.diff(angle)).max() * (1 + 1e-9)
    if per_pitch >= LEAST_PER_PERIOD:
        metrics["torque_tooth_order"] = order_amplitude(angle, torque, teeth)
    metrics["torque_first_order"] = order_amplitude(angle, torque, 1)
    return {name: value for name, value in metrics.items() if value is not None}


# --- Torque towards +X compared with torque towards -X at the same pinion angles


def describe_directions(runs: Sequence[Pass]) -> dict[str, float]:
    """Metrics of both directions, each torque counted against the motion; {} without both."""
    if (both := both_directions(runs)) is None:
        return {}
    *directions, angle = both
    forward, backward = (
        each.direction * mean(angle, each.over(angle, "pinion_torque")) for each in directions
    )
    return {
        "torque_mean_forward": forward,
        "torque_mean_backward": backward,
        "torque_direction_difference": forward - backward,
    }


# --- Torque near the straight-ahead position and beyond it, as workshop manuals limit it
#
# Manuals allow so much variation within 100 degrees of the centre, and more outside (Nissan: 0.4 and
# 0.6 N m). Each direction of turning is a curve of its own.

WINDOW = np.deg2rad(100)  # either side of the centre, where none is given


def describe_on_centre(runs: Sequence[Pass], teeth: int, window: float = WINDOW) -> dict[str, float]:
    """Metrics within the window either side of the centre [rad] and outside, over at least a pitch."""
    pitch, metrics = 2 * np.pi / teeth, dict[str, Any]()
    for name, ranges in (("on", [(-window, window)]), ("off", [(-np.inf, -window), (window, np.inf)])):
        if pieces := [part for each in runs for ends in ranges for part in parts(each, *ends, least=pitch)]:
            metrics |= {
                f"torque_{name}_centre": np.mean([mean(*piece) for piece in pieces], axis=0),
                f"torque_{name}_centre_max": np.max([torque.max(axis=-1) for _, torque in pieces], axis=0),
                f"torque_{name}_centre_variation": np.max([np.ptp(piece[1], axis=-1) for piece in pieces], 0),
            }
    return metrics


def parts(turned: Pass, low: float, high: float, least: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Angle [rad] and torque against the motion [N m] from `low` to `high`; none over less than `least`."""
    angle = turned.signals["pinion_angle"]
    inside = np.flatnonzero((angle >= low) & (angle <= high))
    angle = angle[inside]
    if angle.size < 2 or np.ptp(angle) < least:
        return []
    return [(angle, turned.direction * np.take(turned.signals["pinion_torque"], inside, axis=-1))]
