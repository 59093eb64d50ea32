"""Metrics of torque over angle at the steering wheel, of a wheel that is steered to and fro.

The torque is that of the column, without the inertia of the wheel: what a sensor in the column reads. Each
metric is of the last whole cycle, or the mean over its half cycles.
"""

import numpy as np

from rps_exudyn.analysis.hysteresis import RUNNING, loop_area
from rps_exudyn.analysis.passes import Pass, Signals, longest_pass, passes

GRADIENT = 0.5  # of the running torque either side of none, over which the stiffness is taken
YIELDED = 3.0  # angles in which the torque turns about, up to which a breakaway is looked for


def at_wheel(signals: Signals) -> dict[str, np.ndarray]:
    """Return the signals with the wheel's angle and torque in place of the pinion's."""
    wheel = {"pinion_angle": signals["wheel_angle"], "pinion_torque": signals["column_torque"]}
    return {**signals, **wheel}


def describe_feel(signals: Signals) -> dict[str, float]:
    """Metrics of steering feel; {} of a record without two half cycles of the wheel."""
    wheel = at_wheel(signals)
    half_cycles = passes(wheel)[1:]  # each after a turn
    if not half_cycles:
        return {}
    metrics = {}
    if (area := loop_area(wheel)) is not None:
        metrics["feel_area"] = area
    running = float(np.mean([_running(half) for half in half_cycles]))
    metrics["feel_running_torque"] = running
    turned = [each for half in half_cycles if (each := _turned_about(half)) is not None]
    if not turned:
        return metrics
    metrics["on_centre_stiffness"] = float(np.mean([stiffness for stiffness, _ in turned]))
    metrics["feel_angle_hysteresis"] = float(np.mean([lost for _, lost in turned]))
    peaks = []
    # near the angle in which the torque turned about
    for half, (_, lost) in zip(half_cycles, turned, strict=False):
        angle, torque = _against(half)
        peaks.append(float(torque[angle <= YIELDED * lost].max()))
    metrics["breakaway_torque"] = float(np.mean(peaks))
    metrics["breakaway_ratio"] = metrics["breakaway_torque"] / running
    return metrics


def _against(half: Pass) -> tuple[np.ndarray, np.ndarray]:
    """Angle turned over a half cycle [rad], and torque against the motion [N m]."""
    return np.abs(half.angle - half.angle[0]), half.direction * half.signals["pinion_torque"]


def _running(half: Pass) -> float:
    """Mean torque against the motion over the later half of the angles of a half cycle [N m]."""
    turned, torque = _against(half)
    later = turned >= turned[-1] / 2
    return float(np.trapezoid(torque[later], turned[later]) / np.ptp(turned[later]))


def _turned_about(half: Pass) -> tuple[float, float] | None:
    """Stiffness at no torque after a turn [N m/rad], and the angle turned until the torque is nearly
    the running one [rad]; None where the record does not show them, as of a half cycle that ends before the
    torque has turned about."""
    (turned, torque), running = _against(half), _running(half)
    reached = np.flatnonzero(torque >= RUNNING * running)
    if running <= 0 or not reached.size or torque[0] > -GRADIENT * running or reached[0] < 2:
        return None
    rising = np.maximum.accumulate(torque[: reached[0] + 1])
    low, high = np.interp([-GRADIENT * running, GRADIENT * running], rising, turned[: reached[0] + 1])
    lost = float(np.interp(RUNNING * running, rising, turned[: reached[0] + 1]))
    return GRADIENT * 2 * running / float(high - low), lost


# --- Metrics of a wheel that a torque steers: loop, dead bands and gradient, or where it moves off

MIDDLE = 0.2  # of the angles either side of the middle, over which the gradient is taken
MOVED_OFF = 0.5  # of the speed with which the pinion follows a growing torque without friction


def describe_breakaway(signals: Signals, speed: float, gain: float) -> dict[str, float]:
    """Metric of a torque that grows at a constant rate: the largest torque of the column, less
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
    """Metrics of steering by torque; {} of a record without both directions of the wheel.

    The torque is the column's, the angle the wheel's; `period` [s] is the hand's.
    Dead bands are the widths of the loop: of its angles without torque, of its torques at the middle angle.
    """
    wheel = at_wheel(signals)
    half_cycles = [longest_pass(wheel, direction) for direction in (+1, -1)]
    metrics: dict[str, float] = {}
    if signals["time"][-1] > period * (1 - 1e-6):
        last = signals["time"] >= signals["time"][-1] - period * (1 + 1e-6)
        metrics["feel_area"] = float(np.trapezoid(wheel["pinion_torque"][last], wheel["pinion_angle"][last]))
    angles, torques, slopes = [], [], []
    middle = float(wheel["pinion_angle"].max() + wheel["pinion_angle"].min()) / 2
    reach = MIDDLE * float(np.ptp(wheel["pinion_angle"]))
    for half in half_cycles:
        if half is None or not half.signals["pinion_torque"].min() < 0 < half.signals["pinion_torque"].max():
            return metrics
        rising = slice(None, None, half.direction)
        angle, torque = half.angle[rising], half.signals["pinion_torque"][rising]
        angles.append(float(np.interp(0.0, np.maximum.accumulate(torque), angle)))
        torques.append(float(np.interp(middle, angle, torque)))
        inner = np.abs(angle - middle) <= reach
        if np.count_nonzero(inner) > 2:
            slopes.append(float(np.polyfit(angle[inner], torque[inner], 1)[0]))
    metrics["angle_dead_band"] = angles[1] - angles[0]
    metrics["torque_dead_band"] = torques[0] - torques[1]
    if slopes:
        metrics["steering_gradient"] = float(np.mean(slopes))
    return metrics
