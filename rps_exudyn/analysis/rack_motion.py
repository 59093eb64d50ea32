"""Motion of the rack besides its travel: transmission error, lift, roll, yaw; and the yoke's force on it."""

import numpy as np

from rps_exudyn.analysis.harmonics import order_amplitude
from rps_exudyn.analysis.many import largest, number_of, spread
from rps_exudyn.analysis.passes import Signals, passes

RANGES = {"rack_lift_range": "rack_y", "rack_roll_range": "rack_roll", "rack_yaw_range": "rack_yaw"}


def transmission_error(signals: Signals, gain: float | np.ndarray) -> np.ndarray:
    """Rack displacement minus `gain` [m/rad] times pinion angle, from its mean, shape (..., n) [m].

    `gain` is a number, or one for each gear, (gears,).
    """
    error = signals["rack_displacement"] - np.asarray(gain)[..., None] * signals["pinion_angle"]
    return np.asarray(error - error.mean(axis=-1, keepdims=True) if error.size else error)


def describe_rack(signals: Signals, gain: float | np.ndarray) -> dict[str, float]:
    """The summary's figures of the motions that were recorded; `gain` is rack travel per radian [m].

    The transmission error is the larger of those in the two directions: the difference between directions is
    lost motion, see `hysteresis`.
    """
    figures = {name: spread(signals[signal]) for name, signal in RANGES.items() if signal in signals}
    if "seat_force" in signals:
        figures["yoke_force_min"] = number_of(signals["seat_force"].min(axis=-1))
        figures["yoke_force_max"] = number_of(signals["seat_force"].max(axis=-1))
    return _transmission(signals, gain) | figures


def _transmission(signals: Signals, gain: float | np.ndarray) -> dict[str, float]:
    each_way = [(turned.angle, transmission_error(turned.signals, gain)) for turned in passes(signals)]
    if not each_way:
        return {}
    figures = {"transmission_error_peak_to_peak": largest([spread(error) for _, error in each_way])}
    first = [order_amplitude(angle, error, 1) for angle, error in each_way]
    if known := [amplitude for amplitude in first if amplitude is not None]:
        figures["transmission_error_first_order"] = largest(known)
    return figures
