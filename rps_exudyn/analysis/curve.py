"""A signal over time, as a scene records it."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np


@dataclass(frozen=True, eq=False)
class Curve:
    """A signal over time, shape (n,) both; pieces rise in time, between them it jumps back."""

    time: np.ndarray  # [s]
    values: np.ndarray

    @property
    def pieces(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Time and values of each piece."""
        return [(self.time[part], self.values[part]) for part in pieces_of(self.time)]

    def over(self, grids: Sequence[np.ndarray]) -> np.ndarray:
        """Values at given times [s] on straight lines, a grid for each piece, one after the other."""
        return np.concatenate(
            [np.interp(grid, *piece) for piece, grid in zip(self.pieces, grids, strict=True)]
        )


def pieces_of(time: np.ndarray) -> list[slice]:
    """Return the instants of each piece of a record, over which time (n,) rises: of each maneuver."""
    begins = np.concatenate([[0], np.flatnonzero(np.diff(time) <= 0) + 1, [time.size]])
    return [slice(i, j) for i, j in pairwise(begins.tolist())]


def durations(time: np.ndarray) -> np.ndarray:
    """Return for how long each instant of a record stands, halfway to its neighbours (n,) [s]."""
    return np.diff(np.concatenate([time[:1], (time[1:] + time[:-1]) / 2, time[-1:]]))
