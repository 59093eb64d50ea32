"""Numbers that describe a torque curve: mean, spread, orders.

Everything is taken over the pinion angle, not over time, and an order only over whole periods: of what was
recorded beyond the last whole tooth pitch (or revolution), nothing enters.
"""

import numpy as np

LEAST_PER_PITCH = 6  # points in a tooth pitch without which its ripple is not seen


def mean(angle: np.ndarray, values: np.ndarray) -> float:
    """Mean over the angle, by the trapezoidal rule."""
    if angle[-1] == angle[0]:
        return float(values[0])
    return float(np.trapezoid(values, angle) / (angle[-1] - angle[0]))


def order_amplitude(angle: np.ndarray, values: np.ndarray, order: int) -> float | None:
    """Amplitude of the harmonic `order` times per revolution; None if no whole period was recorded.

    `order` = number of teeth gives the tooth order, 1 the first order. Angles [rad] rise or fall.
    """
    period = 2 * np.pi / order
    whole = int(abs(angle[-1] - angle[0]) / period * (1 + 1e-9))
    if whole == 0:
        return None
    samples = 128 * whole  # even steps of the angle: sums are then integrals over whole periods
    sense = np.sign(angle[-1] - angle[0])
    phase = np.arange(samples) / 128 * 2 * np.pi
    even = angle[0] + sense * phase / order
    rising = slice(None) if sense > 0 else slice(None, None, -1)
    curve = np.interp(even, angle[rising], values[rising])
    return float(2 * abs(np.mean(curve * np.exp(-1j * phase))))


def describe_torque(angle: np.ndarray, torque: np.ndarray, teeth: int) -> dict[str, float]:
    """The summary's torque figures, by their names there; ripple and orders only where they can be told."""
    figures: dict[str, float | None] = {"torque_mean": mean(angle, torque)}
    if np.abs(np.diff(angle)).max() <= 2 * np.pi / teeth / LEAST_PER_PITCH * (1 + 1e-9):
        figures["torque_peak_to_peak"] = float(np.ptp(torque))
        figures["torque_tooth_order"] = order_amplitude(angle, torque, teeth)
    figures["torque_first_order"] = order_amplitude(angle, torque, 1)
    return {name: value for name, value in figures.items() if value is not None}
