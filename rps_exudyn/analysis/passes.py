"""A record taken apart where the pinion turns back: passes in one direction each.

    forward, backward = passes(signals)

Within a pass the pinion angle rises or falls strictly, so that signals can be drawn and averaged over it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

Signals = Mapping[str, np.ndarray]

LEAST_SHARE = 5e-3  # of the whole range of angles: a turn back smaller than that is no pass


@dataclass(frozen=True, eq=False)
class Pass:
    """What was recorded while the pinion turned one way."""

    direction: int  # +1 moves the rack along +X
    signals: dict[str, np.ndarray]  # in the order of time; the pinion angle strictly monotone

    @property
    def angle(self) -> np.ndarray:
        """Pinion angle [rad]."""
        return self.signals["pinion_angle"]

    def over(self, angle: np.ndarray, name: str) -> np.ndarray:
        """A signal at rising pinion angles [rad] within the pass."""
        order = slice(None, None, self.direction)
        return np.interp(angle, self.angle[order], self.signals[name][order])


def passes(signals: Signals) -> list[Pass]:
    """All passes in the order of time; instants of standing still or jerking back belong to none.

    A record that was put together of several, where one begins at the time at which the one before ended,
    is parted there too.
    """
    return [each for maneuver in _trips(signals) for each in _passes_of_one(maneuver)]


def turning_points(angle: np.ndarray) -> list[int]:
    """Indices at which the angle turns back, and both ends of the record; empty if it never moves."""
    least = LEAST_SHARE * float(np.ptp(angle)) if angle.size else 0.0
    if not least > 0:
        return []
    points, low, high, direction = [], 0, 0, 0
    for i, value in enumerate(angle):
        if value > angle[high]:
            high = i
        if value < angle[low]:
            low = i
        if direction >= 0 and value < angle[high] - least:  # it has turned back at `high`
            points.append(high)
            direction, low = -1, i
        elif direction <= 0 and value > angle[low] + least:
            points.append(low)
            direction, high = 1, i
        if direction > 0:
            low = i
        elif direction < 0:
            high = i
    return [*points, high if direction > 0 else low]


def _trips(signals: Signals) -> list[Signals]:
    """The records of which this one was put together."""
    angle = signals["pinion_angle"]
    joints = np.flatnonzero(np.diff(signals.get("time", np.arange(angle.size))) <= 0) + 1
    ends = [0, *joints.tolist(), angle.size]
    return [{name: values[i:j] for name, values in signals.items()} for i, j in pairwise(ends)]


def _passes_of_one(signals: Signals) -> list[Pass]:
    ends = turning_points(signals["pinion_angle"])
    begins = ends[:1] + [end + 1 for end in ends[1:]]  # where it turns back, friction still is as before
    return [_pass(signals, first, last) for first, (_, last) in zip(begins, pairwise(ends), strict=False)]


def longest_pass(signals: Signals, direction: int) -> Pass | None:
    """The pass towards +X (`direction` +1) or -X that covers most angles; None if there is none."""
    if "pinion_angle" not in signals:
        return None
    turned = [each for each in passes(signals) if each.direction == direction]
    return max(turned, key=lambda each: float(np.ptp(each.angle)), default=None)


def both_directions(signals: Signals) -> tuple[Pass, Pass] | None:
    """The longest pass towards +X and the longest towards -X, if there are both."""
    forward, backward = longest_pass(signals, +1), longest_pass(signals, -1)
    return (forward, backward) if forward and backward else None


def common_angles(first: Pass, second: Pass) -> np.ndarray:
    """All angles that either recorded in the range that both cover, rising [rad]; may be empty."""
    both = np.unique(np.concatenate([first.angle, second.angle]))
    low = max(first.angle.min(), second.angle.min())
    high = min(first.angle.max(), second.angle.max())
    return both[(both >= low) & (both <= high)]


def _pass(signals: Signals, first: int, last: int) -> Pass:
    angle = signals["pinion_angle"][first : last + 1]
    direction = 1 if angle[-1] > angle[0] else -1
    farthest = np.maximum.accumulate(direction * angle)
    ahead = np.append(True, direction * angle[1:] > farthest[:-1])
    return Pass(direction, {name: values[first : last + 1][ahead] for name, values in signals.items()})
