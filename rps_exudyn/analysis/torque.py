"""Metrics of the pinion torque over the angle: mean, spread, orders; by direction; on and off centre.

A record in both directions is first divided into `passes`.
"""

import numpy as np

from rps_exudyn.analysis.harmonics import LEAST_PER_PERIOD, order_amplitude
from rps_exudyn.analysis.passes import Pass, Signals, at_instants, both_directions, number_of, passes, spread


def mean(angle: np.ndarray, values: np.ndarray) -> float:
    """Mean of values (..., n) over the angle (n,) by the trapezoidal rule."""
    if angle[-1] == angle[0]:
        return number_of(values[..., 0])
    return number_of(np.trapezoid(values, angle) / (angle[-1] - angle[0]))


def describe_torque(angle: np.ndarray, torque: np.ndarray, teeth: int) -> dict[str, float]:
    """The summary's torque figures from angle [rad], shape (n,), and torque [N m], shape (..., n).

    Orders are left out where the record is too short for them, or has too few instants in a period.
    """
    figures: dict[str, float | None] = {
        "torque_mean": mean(angle, torque),
        "torque_peak_to_peak": spread(torque),
    }
    per_pitch = 2 * np.pi / teeth / np.abs(np.diff(angle)).max() * (1 + 1e-9)
    if per_pitch >= LEAST_PER_PERIOD:
        figures["torque_tooth_order"] = order_amplitude(angle, torque, teeth)
    figures["torque_first_order"] = order_amplitude(angle, torque, 1)
    return {name: value for name, value in figures.items() if value is not None}


# --- Torque towards +X compared with torque towards -X at the same pinion angles


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


# --- Torque near the straight-ahead position and beyond it, as workshop manuals limit it
#
# Manuals allow so much variation within 100 degrees of the centre, and more outside (Nissan: 0.4 and
# 0.6 N m). Each direction of turning is a curve of its own.

WINDOW = np.deg2rad(100)  # either side of the centre, where none is given


def describe_on_centre(signals: Signals, teeth: int, window: float = WINDOW) -> dict[str, float]:
    """The summary's figures within the window and outside, where the record covers a tooth pitch there.

    Args:
        signals: pinion_angle [rad] and pinion_torque [N m].
        teeth: of the pinion.
        window: either side of the centre [rad].
    """
    pitch, runs = 2 * np.pi / teeth, passes(signals)
    on = [part for each in runs for part in parts(each, -window, window, least=pitch)]
    off = [
        part
        for each in runs
        for low, high in ((-np.inf, -window), (window, np.inf))
        for part in parts(each, low, high, least=pitch)
    ]
    figures: dict[str, float] = {}
    if on:
        figures |= {f"torque_on_centre{name}": value for name, value in _figures(on).items()}
    if off:
        figures |= {f"torque_off_centre{name}": value for name, value in _figures(off).items()}
    return figures


def _figures(pieces: list[tuple[np.ndarray, np.ndarray]]) -> dict[str, float]:
    """Mean, largest value and variation of pieces of curves, by the ends of their names."""
    return {
        "": number_of(np.mean([mean(*piece) for piece in pieces], axis=0)),
        "_max": number_of(np.max([torque.max(axis=-1) for _, torque in pieces], axis=0)),
        "_variation": number_of(np.max([spread(torque) for _, torque in pieces], axis=0)),
    }


def parts(turned: Pass, low: float, high: float, least: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Angle [rad] and torque against the motion [N m] from `low` to `high`; none over less than `least`."""
    inside = np.flatnonzero((turned.angle >= low) & (turned.angle <= high))
    angle = turned.angle[inside]
    if angle.size < 2 or np.ptp(angle) < least:
        return []
    return [(angle, turned.direction * at_instants(turned.signals["pinion_torque"], inside))]
