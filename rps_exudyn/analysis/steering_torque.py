"""Figures of a wheel that a torque steers: loop, dead bands and gradient, or where it moves off."""

from collections.abc import Mapping

import numpy as np

from rps_exudyn.analysis.passes import longest_pass
from rps_exudyn.analysis.steering_feel import at_wheel

Signals = Mapping[str, np.ndarray]

MIDDLE = 0.2  # of the angles either side of the middle, over which the gradient is taken
MOVED_OFF = 0.5  # of the speed with which the pinion follows a growing torque without friction


def describe_breakaway(signals: Signals, speed: float, gain: float) -> dict[str, float]:
    """The summary's figure of a torque that grows at a constant rate: the largest torque of the column, less
    what the tyres take of it, until the pinion has moved off; {} of one that has not.

    `speed` [rad/s] is that with which the pinion would follow without friction, `gain` the rack's [m].
    """
    turning = np.sign(speed) * np.gradient(signals["pinion_angle"], signals["time"])
    moved = np.flatnonzero(turning > MOVED_OFF * abs(speed))
    if not moved.size:
        return {}
    overcome = np.sign(speed) * (signals["column_torque"] + gain * signals["tyre_force"])
    return {"breakaway_torque": float(overcome[: moved[0] + 1].max())}


def describe_steering_torque(signals: Signals, period: float) -> dict[str, float]:
    """The summary's figures of steering by torque; {} of a record without both ways of the wheel.

    The torque is the column's, the angle the wheel's; `period` [s] is the hand's.
    Dead bands are the widths of the loop: of its angles without torque, of its torques at the middle angle.
    """
    seen = at_wheel(signals)
    ways = [longest_pass(seen, direction) for direction in (+1, -1)]
    figures: dict[str, float] = {}
    if signals["time"][-1] > period * (1 - 1e-6):
        last = signals["time"] >= signals["time"][-1] - period * (1 + 1e-6)
        figures["feel_area"] = float(np.trapezoid(seen["pinion_torque"][last], seen["pinion_angle"][last]))
    angles, torques, slopes = [], [], []
    middle = float(seen["pinion_angle"].max() + seen["pinion_angle"].min()) / 2
    reach = MIDDLE * float(np.ptp(seen["pinion_angle"]))
    for way in ways:
        if way is None or not way.signals["pinion_torque"].min() < 0 < way.signals["pinion_torque"].max():
            return figures
        rising = slice(None, None, way.direction)
        angle, torque = way.angle[rising], way.signals["pinion_torque"][rising]
        angles.append(float(np.interp(0.0, np.maximum.accumulate(torque), angle)))
        torques.append(float(np.interp(middle, angle, torque)))
        inner = np.abs(angle - middle) <= reach
        if np.count_nonzero(inner) > 2:
            slopes.append(float(np.polyfit(angle[inner], torque[inner], 1)[0]))
    figures["angle_dead_band"] = angles[1] - angles[0]
    figures["torque_dead_band"] = torques[0] - torques[1]
    if slopes:
        figures["steering_gradient"] = float(np.mean(slopes))
    return figures
