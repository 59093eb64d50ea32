"""A signal over time, as a scene records it: difference of two such curves, and resolution by the steps."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

EVEN_POINTS = 3601  # of a piece, at which curves are compared
UNEVEN = 1.5  # of neighbouring steps, from which on a cubic spline may overshoot


@dataclass(frozen=True, eq=False)
class Curve:
    """A signal over time, shape (n,) both; pieces rise in time, between them it jumps back."""

    time: np.ndarray  # [s]
    values: np.ndarray

    @property
    def pieces(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Time and values of each piece."""
        return ((self.time[part], self.values[part]) for part in pieces_of(self.time))

    def over(self, grids: Sequence[np.ndarray], smooth: bool = True) -> np.ndarray:
        """Values at given times [s], a grid for each piece, one after the other.

        Smooth is a cubic spline; between uneven steps, where that one overshoots, a monotone interpolant.
        """
        found = []
        for (time, values), grid in zip(self.pieces, grids, strict=True):
            if smooth and time.size > 3:
                found.append(_smooth(time, values)(grid))
            else:
                found.append(np.interp(grid, time, values))
        return np.concatenate(found)


def pieces_of(time: np.ndarray) -> Iterator[slice]:
    """Yield the instants of each piece of a record, over which time (n,) rises: of each maneuver."""
    begins = np.concatenate([[0], np.flatnonzero(np.diff(time) <= 0) + 1, [time.size]])
    return (slice(i, j) for i, j in pairwise(begins.tolist()))


def durations(time: np.ndarray) -> np.ndarray:
    """Return for how long each instant of a record stands, halfway to its neighbours (n,) [s]."""
    return np.diff(np.concatenate([time[:1], (time[1:] + time[:-1]) / 2, time[-1:]]))


def _smooth(time: np.ndarray, values: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """A smooth interpolant that stays between its values where steps of time are uneven."""
    # half a second, which runs that compare nothing are spared
    from scipy.interpolate import CubicSpline, PchipInterpolator

    steps = np.diff(time)
    even = (np.maximum(steps[1:], steps[:-1]) <= UNEVEN * np.minimum(steps[1:], steps[:-1])).all()
    return CubicSpline(time, values) if even else PchipInterpolator(time, values)


def size_of(curve: Curve) -> float:
    """Return the mean magnitude over time, to which errors are related."""
    area = sum(float(np.trapezoid(np.abs(values), time)) for time, values in curve.pieces)
    return area / sum(float(time[-1] - time[0]) for time, _ in curve.pieces)


def both_over_time(record: Curve, reference: Curve, smooth: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Return values of both at even times that both cover, piece by piece."""
    grids = []
    for (own, _), (true, _) in zip(record.pieces, reference.pieces, strict=True):
        grids.append(np.linspace(max(own[0], true[0]), min(own[-1], true[-1]), EVEN_POINTS))
    return record.over(grids, smooth), reference.over(grids)


def rms_difference(first: np.ndarray, second: np.ndarray, size: float) -> float:
    """Return the RMS of the difference of values, in % of a size."""
    return 100 * float(np.sqrt(np.mean((first - second) ** 2))) / size


def difference(record: Curve, truer: Curve) -> float:
    """Return how far a record lies from a truer one, RMS in % of the mean.

    It is the larger of joining its instants by straight lines and smoothly.
    """
    size = size_of(truer)
    return max(rms_difference(*both_over_time(record, truer, smooth), size) for smooth in (True, False))


# --- Resolution: whether the steps of a record show how large its signal becomes between them.
# Vibration that nothing damps, and peaks narrower than a few steps, leave a record whose mean is right and
# whose largest and smallest values are not. It shows: values do not lie on a smooth curve through their
# neighbours. Implicit time steps show vibration faster than themselves as a zigzag from step to step, so that
# none hides as a slow one.

LEAST_FOR_PEAKS = 12  # points in a tooth pitch: 8 went past a dip over a seventh of it, 5 % of the mean
UNRESOLVED = 0.03  # of the mean; below that the ripples of random gears are right to 4 % of it


def missed(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance of each value from the cubic through its four neighbours; 0 at the two ends each way.

    x of shape (n,), strictly monotone, y of shape (..., n).
    """
    distance = np.zeros(y.shape)
    at = x[2:-2]
    nodes = [x[:-4], x[1:-3], x[3:-1], x[4:]]
    values = [y[..., :-4], y[..., 1:-3], y[..., 3:-1], y[..., 4:]]
    cubic = np.zeros(y[..., 2:-2].shape)
    for i, value in enumerate(values):
        weight = np.ones(len(at))
        for j, node in enumerate(nodes):
            if j != i:
                weight *= (at - node) / (nodes[i] - node)
        cubic += weight * value
    distance[..., 2:-2] = np.abs(y[..., 2:-2] - cubic)
    return distance


def midpoints_added(y: np.ndarray) -> np.ndarray:
    """Return values (..., n) with one more between any two, (..., 2 n - 1): on the cubic through the four
    around it, at the ends on the parabola through three, of fewer values on straight lines. Where a curve has
    a kink, the value stands by as much beside the cubic as the kink does, or at the kink if that is extreme.
    """
    more = np.repeat(y, 2, axis=-1)[..., :-1].astype(float)
    if y.shape[-1] < 3:
        more[..., 1::2] = (y[..., :-1] + y[..., 1:]) / 2
        return more
    more[..., 3:-2:2] = (9 * (y[..., 1:-2] + y[..., 2:-1]) - y[..., :-3] - y[..., 3:]) / 16
    more[..., 1] = (3 * y[..., 0] + 6 * y[..., 1] - y[..., 2]) / 8
    more[..., -2] = (3 * y[..., -1] + 6 * y[..., -2] - y[..., -3]) / 8
    if y.shape[-1] >= 6:
        more[..., 5:-5:2] = _at_kinks(y, more[..., 5:-5:2])
    return more


def _at_kinks(y: np.ndarray, smooth: np.ndarray) -> np.ndarray:
    """Return the values that are to stand between those (..., n) and have three on each side, (..., n - 5),
    from the ones on the cubics.

    The parabolas through three values on either side meet between where both pass on the same side of the
    value next to it: there the curve has a kink. By how much they pass is a third difference, whose sign does
    not change from one interval to the next where the curve is smooth.
    """
    a_2, a_1, a, b, b_1, b_2 = (y[..., i : y.shape[-1] - 5 + i] for i in range(6))
    before, behind = b_2 - 3 * b_1 + 3 * b - a, a_2 - 3 * a_1 + 3 * a - b
    meet = before * behind > 0
    s = np.where(meet, before / np.where(meet, before + behind, 1.0), 0.5)
    t = 1 - s
    left = a + s * (a - a_1) + s * (s + 1) / 2 * (a - 2 * a_1 + a_2)
    right = b + t * (b - b_1) + t * (t + 1) / 2 * (b - 2 * b_1 + b_2)
    kink = np.where(before > 0, np.minimum(left, right), np.maximum(left, right))
    cubic = (s + 1) * (2 - s) * (t * a + s * b) / 2 - s * t * ((2 - s) * a_1 + (s + 1) * b_1) / 6
    extreme = np.where(before > 0, kink > np.maximum(a, b), kink < np.minimum(a, b))
    return np.where(meet, np.where(extreme, kink, smooth + kink - cubic), smooth)


def every_second(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Integral of y (..., n) over x (n,), and by how much that over every second step differs, (...) each."""
    even = (x.size - 1) // 2 * 2 + 1
    whole = np.trapezoid(y[..., :even], x[:even])
    return whole, np.abs(whole - np.trapezoid(y[..., :even:2], x[:even:2]))


def lag(x: np.ndarray, values: np.ndarray) -> np.ndarray:
    """What backward differences, half a step late, miss of the way that values (..., n) make, (...).

    x (n,) is time or an angle turned steadily, strictly monotone, in steps of any length.
    """
    steps = np.diff(x)
    rates = np.diff(values) / steps
    return np.asarray(np.abs(np.diff(rates) * steps[1:]).sum(axis=-1) / 2)


def unresolved(x: np.ndarray, y: np.ndarray, size: float) -> float:
    """Return the largest distance from such cubics over a size of the values; 0 for one of 0."""
    return float(missed(x, y).max(initial=0.0)) / size if size else 0.0
