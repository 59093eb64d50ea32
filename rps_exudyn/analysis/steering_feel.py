"""Figures of torque over angle at the steering wheel, of a wheel that is steered to and fro.

The torque is that of the column, without the inertia of the wheel: what a sensor in the column reads. Each
figure is of the last whole cycle, or the mean over its ways.
"""

from collections.abc import Mapping

import numpy as np

from rps_exudyn.analysis.hysteresis import RUNNING, loop_area
from rps_exudyn.analysis.passes import Pass, passes

Signals = Mapping[str, np.ndarray]

GRADIENT = 0.5  # of the running torque either side of none, over which the stiffness is taken
YIELDED = 3.0  # angles in which the torque turns about, up to which a breakaway is looked for


def at_wheel(signals: Signals) -> dict[str, np.ndarray]:
    """Return the signals with the wheel's angle and torque in place of the pinion's."""
    seen = {"pinion_angle": signals["wheel_angle"], "pinion_torque": signals["column_torque"]}
    return {**signals, **seen}


def describe_feel(signals: Signals) -> dict[str, float]:
    """The summary's figures of steering feel; {} of a record without two ways of the wheel."""
    seen = at_wheel(signals)
    ways = passes(seen)[1:]  # each after a turn
    if not ways:
        return {}
    figures = {}
    if (area := loop_area(seen)) is not None:
        figures["feel_area"] = area
    running = float(np.mean([_running(way) for way in ways]))
    figures["feel_running_torque"] = running
    turned = [each for way in ways if (each := _turned_about(way)) is not None]
    if not turned:
        return figures
    figures["on_centre_stiffness"] = float(np.mean([stiffness for stiffness, _ in turned]))
    figures["feel_angle_hysteresis"] = float(np.mean([lost for _, lost in turned]))
    peaks = [_breakaway(way, lost) for way, (_, lost) in zip(ways, turned, strict=False)]
    figures["breakaway_torque"] = float(np.mean(peaks))
    figures["breakaway_ratio"] = figures["breakaway_torque"] / running
    return figures


def _against(way: Pass) -> np.ndarray:
    """Torque against the motion over a way [N m]."""
    return way.direction * way.signals["pinion_torque"]


def _running(way: Pass) -> float:
    """Mean torque against the motion over the later half of a way's angles [N m]."""
    turned, torque = np.abs(way.angle - way.angle[0]), _against(way)
    later = turned >= turned[-1] / 2
    return float(np.trapezoid(torque[later], turned[later]) / np.ptp(turned[later]))


def _turned_about(way: Pass) -> tuple[float, float] | None:
    """Stiffness at no torque after a turn [N m/rad], and the angle turned until the torque is nearly
    the running one [rad]; None where the record does not show them, as of a way that ends before the torque
    has turned about."""
    turned, torque, running = np.abs(way.angle - way.angle[0]), _against(way), _running(way)
    if running <= 0:
        return None
    reached = np.flatnonzero(torque >= RUNNING * running)
    if not reached.size or torque[0] > -GRADIENT * running or reached[0] < 2:
        return None
    rising = np.maximum.accumulate(torque[: reached[0] + 1])
    low, high = np.interp([-GRADIENT * running, GRADIENT * running], rising, turned[: reached[0] + 1])
    lost = float(np.interp(RUNNING * running, rising, turned[: reached[0] + 1]))
    return GRADIENT * 2 * running / float(high - low), lost


def _breakaway(way: Pass, lost: float) -> float:
    """Largest torque near the angle in which the torque turned about [N m]."""
    turned = np.abs(way.angle - way.angle[0])
    return float(_against(way)[turned <= YIELDED * lost].max())
