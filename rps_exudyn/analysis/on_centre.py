"""Torque near the straight-ahead position and beyond it, as workshop manuals limit it.

Manuals allow so much variation within 100 degrees of the centre, and more outside (Nissan: 0.4 and 0.6 N m).
Each direction of turning is a curve of its own.
"""

import numpy as np

from rps_exudyn.analysis.many import number_of, spread
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
    inside = (turned.angle >= low) & (turned.angle <= high)
    angle = turned.angle[inside]
    if angle.size < 2 or np.ptp(angle) < least:
        return []
    return [(angle, turned.direction * turned.signals["pinion_torque"][..., inside])]
