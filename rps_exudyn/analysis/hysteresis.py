"""Metrics of reversals of the pinion: the loop of torque over angle, lost motion, sticking.

After a reversal the friction forces turn about only when their contacts have slipped; until then the gear
yields elastically. The *running torque* of a pass is the median of its torque.
"""

from itertools import pairwise

import numpy as np

from rps_exudyn.analysis.curve import durations
from rps_exudyn.analysis.passes import Pass, Signals, both_directions, passes, turning_points
from rps_exudyn.analysis.torque import mean

RUNNING = 0.9  # fraction of the running torque at which a gear counts as running again
CLOSED = 1e-3  # of the range of angles: how near to its beginning a cycle ends
MIDDLE = 0.5  # fraction of the common angles, about their middle, over which lost motion is taken


def describe_reversal(signals: Signals, gain: float = 0.0) -> dict[str, float]:
    """Metrics of reversals; {} without any, the area only if the record returns to an angle,
    the angle of lost motion only with the rack's travel per radian `gain` [m]."""
    runs = passes(signals)
    if len(runs) < 2:
        return {}
    reversals = [reversal(before, after) for before, after in pairwise(runs)]
    metrics = {"torque_jump": max(jump for jump, _ in reversals)}
    if turned := [angle for _, angle in reversals if angle is not None]:
        metrics["reversal_angle"] = max(turned)
    if (area := loop_area(signals)) is not None:
        metrics["hysteresis_area"] = area
    if (lost := lost_motion(signals)) is not None:
        metrics["lost_motion"] = lost
        if gain:
            metrics["lost_motion_angle"] = lost / gain
    return metrics


def loop_area(signals: Signals) -> float | None:
    """Work of the drive over the last whole cycle of torque over angle [J]; None without one.

    A cycle begins where the pinion last passed the angle of the record's end in the same direction.
    """
    angle, torque = signals["pinion_angle"], signals["pinion_torque"]
    ends = turning_points(angle)
    if len(ends) < 3:
        return None
    angle, torque = angle[: ends[-1] + 1], torque[: ends[-1] + 1]
    start = _same_place(angle, ends)
    if start is None:
        return None
    i, fraction = start
    first = [array[i] + fraction * (array[i + 1] - array[i]) for array in (angle, torque)]
    cycle = [np.append(value, array[i + 1 :]) for value, array in zip(first, (angle, torque), strict=True)]
    return float(np.trapezoid(cycle[1], cycle[0]))


def _same_place(angle: np.ndarray, ends: list[int]) -> tuple[int, float] | None:
    """Return where the last cycle begins: index, and fraction of the step after it.

    Two reversals before the end the pinion turned the same way; a record of one pass there and one back
    is a cycle if it ends where it began.
    """
    near = CLOSED * float(np.ptp(angle[ends[-3] :]))
    last = float(angle[-1])
    if len(ends) >= 4:
        before = angle[ends[-4] : ends[-3] + 1]
        if before.min() - near <= last <= before.max() + near:
            place = np.clip(last, before.min(), before.max())
            i = int(np.flatnonzero((before[:-1] - place) * (before[1:] - place) <= 0)[-1])
            step = before[i + 1] - before[i]
            return ends[-4] + i, float((place - before[i]) / step) if step else 0.0
    return (ends[-3], 0.0) if abs(angle[ends[-3]] - last) <= near else None


def lost_motion(signals: Signals) -> float | None:
    """Return the mean distance by which the rack lags at equal pinion angle, over the middle half [m].

    Elasticity holds the rack back; friction that rolls it to the other side may outweigh that and carry it
    ahead, which makes the lost motion negative.
    """
    if (both := both_directions(passes(signals))) is None:
        return None
    *directions, angle = both
    centre, reach = (angle[0] + angle[-1]) / 2, MIDDLE * (angle[-1] - angle[0]) / 2
    middle = angle[np.abs(angle - centre) <= reach]
    if middle.size < 2:
        return None
    forward, backward = (each.over(middle, "rack_displacement") for each in directions)
    return mean(middle, backward - forward)


def reversal(before: Pass, after: Pass) -> tuple[float, float | None]:
    """Change of the running torque [N m], and pinion angle from the reversal until the gear runs again [rad].

    It runs again when the torque is as near to the new running torque as a tenth of half the change, which
    without load is nine tenths of the running torque. The angle is None if it never does.
    """
    old, new = (_running_torque(each) for each in (before, after))
    jump = old - new
    missing = (after.signals["pinion_torque"] - new) * np.sign(jump)
    reached = np.flatnonzero(missing <= (1 - RUNNING) * abs(jump) / 2)
    if not reached.size:
        return abs(jump), None
    i = int(reached[0])
    turned = np.abs(after.angle - before.angle[-1])
    if i == 0:
        return abs(jump), float(turned[0])
    fraction = (missing[i - 1] - (1 - RUNNING) * abs(jump) / 2) / (missing[i - 1] - missing[i])
    return abs(jump), float(turned[i - 1] + fraction * (turned[i] - turned[i - 1]))


def _running_torque(each: Pass) -> float:
    """Median of a pass's torque, each instant counting for the time halfway to its neighbours [N m]."""
    torque = each.signals["pinion_torque"]
    time = each.signals.get("time", np.arange(torque.size))
    order = np.argsort(torque)
    weight = durations(time)[order]
    middle = np.cumsum(weight) - weight / 2  # share of the time with less torque
    return float(np.interp(weight.sum() / 2, middle, torque[order]))
