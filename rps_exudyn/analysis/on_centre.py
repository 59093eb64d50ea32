"""Torque near the straight-ahead position and beyond it, as workshop manuals limit it.

Manuals allow so much variation within 100 degrees of the centre, and more outside (Nissan: 0.4 and 0.6 N m).
Each direction of turning is a curve of its own.
"""

import numpy as np

from rps_exudyn.analysis.passes import Pass, Signals, passes
from rps_exudyn.analysis.torque import mean

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
    figures = {}
    if on:
        figures["torque_on_centre"] = float(np.mean([mean(*part) for part in on]))
        figures["torque_on_centre_max"] = max(float(torque.max()) for _, torque in on)
        figures["torque_on_centre_variation"] = max(float(np.ptp(torque)) for _, torque in on)
    if off:
        figures["torque_off_centre"] = float(np.mean([mean(*part) for part in off]))
        figures["torque_off_centre_max"] = max(float(torque.max()) for _, torque in off)
        figures["torque_off_centre_variation"] = max(float(np.ptp(torque)) for _, torque in off)
    return figures


def parts(turned: Pass, low: float, high: float, least: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Angle [rad] and torque against the motion [N m] from `low` to `high`; none over less than `least`."""
    inside = (turned.angle >= low) & (turned.angle <= high)
    angle = turned.angle[inside]
    if angle.size < 2 or np.ptp(angle) < least:
        return []
    return [(angle, turned.direction * turned.signals["pinion_torque"][inside])]
