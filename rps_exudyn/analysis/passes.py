"""Signals of a record, and the parts of it in which the pinion turns one way: passes.

    forward, backward = passes(signals)

Within a pass the pinion angle rises or falls strictly, so that signals can be drawn and averaged over it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

Signals = Mapping[str, np.ndarray]

LEAST_TURN = 5e-3  # of the whole range of angles: a smaller turn back begins no pass
SHORT_PASS, WHOLE_WAY = 3, 0.8  # rows of a pass, and part of the range that it covers, below which ...
MOST_ASTRAY, FEW_ROWS = 0.25, 12  # ... at most this part of a record lies, which has so many rows at least
LEAST_JUMP = 0.3  # of the range, that one step back goes where another pass in the same direction begins


@dataclass(frozen=True, eq=False)
class Pass:
    """The signals recorded while the pinion turned one way, each of shape (n,), of many gears (..., n).

    Many gears share time; their angles are the same too, or all rise or all fall.
    """

    direction: int  # +1 moves the rack along +X
    signals: dict[str, np.ndarray]  # in the order of time; the pinion angle strictly monotone

    @property
    def angle(self) -> np.ndarray:
        """Pinion angle [rad], shape (n,)."""
        return self.signals["pinion_angle"]

    def over(self, angle: np.ndarray, name: str) -> np.ndarray:
        """A signal at rising pinion angles [rad] within the pass, shape of the angles."""
        return interpolated(self.signals, name, angle, self.direction)


def passes(signals: Signals) -> list[Pass]:
    """All passes in the order of time, [] without an angle; standing still or jerking back belongs to none.

    A record joined from several, each of which begins at the time at which the one before ended, is divided
    there too.
    """
    if "pinion_angle" not in signals:
        return []
    steps = np.diff(signals["pinion_angle"])
    if steps.size and ("time" not in signals or (np.diff(signals["time"]) > 0).all()):
        for direction in (1, -1):
            if (direction * steps > 0).all():  # one pass, as most records are
                return [Pass(direction, dict(signals))]
    return [each for maneuver in _maneuvers(signals) for each in _passes_of_one(maneuver)]


def interpolated(signals: Signals, name: str, angle: np.ndarray, direction: int) -> np.ndarray:
    """A signal at rising pinion angles [rad]; its own angles rise (`direction` +1) or fall (-1)."""
    order = slice(None, None, direction)
    return over_instants(angle, signals["pinion_angle"][order], signals[name][..., order])


def turning_points(angle: np.ndarray) -> list[int]:
    """Indices at which the angle turns back, and both ends of the record; empty if it never moves."""
    least = LEAST_TURN * float(np.ptp(angle)) if angle.size else 0.0
    if not least > 0:
        return []
    steps = np.diff(angle)
    if (steps > 0).all() or (steps < 0).all():
        return [0, angle.shape[-1] - 1]
    points, low, high, direction = [], 0, 0, 0
    angles = angle.tolist()  # numbers one by one: an array's elements take ten times as long
    for i, value in enumerate(angles):
        if value > angles[high]:
            high = i
        if value < angles[low]:
            low = i
        if direction >= 0 and value < angles[high] - least:  # it has turned back at `high`
            points.append(high)
            direction, low = -1, i
        elif direction <= 0 and value > angles[low] + least:
            points.append(low)
            direction, high = 1, i
        if direction > 0:
            low = i
        elif direction < 0:
            high = i
    return [*points, high if direction > 0 else low]


def is_in_random_order(angle: np.ndarray) -> bool:
    """Return whether angles (n,) turn back after every few rows on the way, as those of a motion do not.

    Shuffled angles do after 1.5 rows on average; those of a motion turn back at its ends.
    """
    ends = turning_points(angle)
    rows, part = np.diff(ends), np.abs(np.diff(angle[ends])) / max(float(np.ptp(angle)), 1e-300)
    astray = rows[(rows <= SHORT_PASS) & (part < WHOLE_WAY)].sum()
    return bool(astray > MOST_ASTRAY * max(angle.size - 1, FEW_ROWS))


def _maneuvers(signals: Signals) -> list[Signals]:
    """The records from which this one was joined."""
    angle = signals["pinion_angle"]
    joints = np.flatnonzero(np.diff(signals.get("time", np.arange(angle.shape[-1]))) <= 0) + 1
    inner = sorted({*joints.tolist(), *(_jumps_back(angle) if angle.ndim == 1 else ())})
    if not inner:
        return [signals]
    ends = [0, *inner, angle.shape[-1]]
    return [{name: values[..., i:j] for name, values in signals.items()} for i, j in pairwise(ends)]


def _jumps_back(angle: np.ndarray) -> list[int]:
    """Indices at which the angle goes on in its direction after one step back by much more than a step.

    So do passes in one direction that follow each other in a measured file, without the way between them.
    """
    steps = np.diff(angle)
    if steps.size < 3:
        return []
    before, jump, after = np.sign(steps[:-2]), steps[1:-1], np.sign(steps[2:])
    far = np.abs(jump) > LEAST_JUMP * float(np.ptp(angle))
    return (np.flatnonzero(far & (before == after) & (before == -np.sign(jump))) + 2).tolist()


def _passes_of_one(signals: Signals) -> list[Pass]:
    angle = signals["pinion_angle"]
    ends = turning_points(angle)
    begins = ends[:1]
    for turn in ends[1:-1]:  # a pass begins where a turn is left: at rest there, friction still is as before
        moved = np.flatnonzero(angle[turn:] != angle[turn])
        begins.append(turn + (int(moved[0]) if moved.size else 1))
    return [_pass(signals, first, last) for first, (_, last) in zip(begins, pairwise(ends), strict=False)]


def longest_pass(signals: Signals, direction: int) -> Pass | None:
    """The pass towards +X (`direction` +1) or -X that covers most angles; None if there is none."""
    return _longest(passes(signals), direction)


def both_directions(runs: Sequence[Pass]) -> tuple[Pass, Pass, np.ndarray] | None:
    """The longest passes towards +X and -X, and their common angles [rad]; None if there are none."""
    forward, backward = _longest(runs, +1), _longest(runs, -1)
    if not (forward and backward):
        return None
    angle = common_angles(forward.angle, backward.angle)
    return (forward, backward, angle) if angle.size else None


def _longest(turned: Sequence[Pass], direction: int) -> Pass | None:
    return max(
        (each for each in turned if each.direction == direction),
        key=lambda each: float(np.ptp(each.signals["pinion_angle"])),
        default=None,
    )


def common_angles(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """All angles that either recorded in the range that both cover, rising [rad]; none if fewer than two."""
    if not (first.size and second.size):
        return np.zeros(0)
    both = np.unique(np.concatenate([first, second]))
    low, high = max(first.min(), second.min()), min(first.max(), second.max())
    common = both[(both >= low) & (both <= high)]
    return common if common.size > 1 else np.zeros(0)


def whole_periods(angle: np.ndarray, period: float) -> np.ndarray:
    """The rising angles up to the last whole number of periods from the first [rad]; else all of them."""
    count = np.floor((angle[-1] - angle[0]) / period * (1 + 1e-9))
    if count < 1:
        return angle
    end = angle[0] + count * period
    return np.append(angle[angle < end - 1e-9 * period], end)


def _pass(signals: Signals, first: int, last: int) -> Pass:
    angle = signals["pinion_angle"][..., first : last + 1]
    direction = 1 if np.all(angle[..., -1] > angle[..., 0]) else -1
    if (direction * np.diff(angle) > 0).all():
        return Pass(direction, {name: values[..., first : last + 1] for name, values in signals.items()})
    farthest = np.maximum.accumulate(direction * angle)
    ahead = np.append(True, direction * angle[1:] > farthest[:-1])
    kept = first + np.flatnonzero(ahead)
    return Pass(direction, {name: np.take(values, kept, axis=-1) for name, values in signals.items()})


# --- Signals of many gears over the same instants: values of shape (gears, n) beside those of one gear, (n,)
#
# Metrics of one gear are numbers; of many they are arrays of shape (gears,), by the same functions. Values by
# `np.take` lie side by side in memory: their sums are rounded alike for one gear and for many.


def plain(metrics: Mapping[str, Any]) -> dict[str, Any]:
    """Return the metrics of one gear as plain numbers, and the arrays of many."""
    return {name: float(value) if np.ndim(value) == 0 else value for name, value in metrics.items()}


def over_instants(at: np.ndarray, instants: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values (..., n) at rising instants (n,) on straight lines between them, shape (..., at.size)."""
    if values.ndim == 1:
        return np.interp(at, instants, values)
    right = np.clip(np.searchsorted(instants, at), 1, instants.size - 1)
    share = np.clip((at - instants[right - 1]) / (instants[right] - instants[right - 1]), 0.0, 1.0)
    before, after = np.take(values, right - 1, axis=-1), np.take(values, right, axis=-1)
    return np.asarray(before * (1 - share) + after * share)


def signals_over_instants(at: np.ndarray, instants: np.ndarray, signals: Signals) -> dict[str, np.ndarray]:
    """Return signals at rising instants (n,) as `over_instants` does, by their names."""
    return {name: over_instants(at, instants, values) for name, values in signals.items()}


# --- Where in a record something first holds, for a reader


def first_angle(signals: Signals, where: np.ndarray) -> str:
    """Return the pinion angle at which something first holds, for a reader; `where` has shape (n,)."""
    return f"{round(np.degrees(signals['pinion_angle'][np.argmax(where)]), 6) + 0.0:.4g} deg"
