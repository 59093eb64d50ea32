"""A signal over time, as a scene records it, and two such curves beside each other."""

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
