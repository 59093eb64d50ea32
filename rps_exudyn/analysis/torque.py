"""Figures of a torque curve in one direction: mean, spread, orders; over the angle, not over time.

A record in both directions is first divided into `passes`.
"""

import numpy as np

from rps_exudyn.analysis.harmonics import LEAST_PER_PERIOD, order_amplitude
from rps_exudyn.analysis.many import number_of, spread
from rps_exudyn.analysis.resolution import LEAST_FOR_PEAKS


def mean(angle: np.ndarray, values: np.ndarray) -> float:
    """Mean of values (..., n) over the angle (n,) by the trapezoidal rule."""
    if angle[-1] == angle[0]:
        return number_of(values[..., 0])
    return number_of(np.trapezoid(values, angle) / (angle[-1] - angle[0]))


def describe_torque(angle: np.ndarray, torque: np.ndarray, teeth: int) -> dict[str, float]:
    """The summary's torque figures from angle [rad], shape (n,), and torque [N m], shape (..., n).

    Ripple and orders are left out where the record is too short or too coarse for them.
    """
    figures: dict[str, float | None] = {"torque_mean": mean(angle, torque)}
    per_pitch = 2 * np.pi / teeth / np.abs(np.diff(angle)).max() * (1 + 1e-9)
    if per_pitch >= LEAST_FOR_PEAKS:
        figures["torque_peak_to_peak"] = spread(torque)
    if per_pitch >= LEAST_PER_PERIOD:
        figures["torque_tooth_order"] = order_amplitude(angle, torque, teeth)
    figures["torque_first_order"] = order_amplitude(angle, torque, 1)
    return {name: value for name, value in figures.items() if value is not None}
