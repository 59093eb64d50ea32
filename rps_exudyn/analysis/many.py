"""Signals of many gears over the same instants: values of shape (gears, n) beside those of one gear, (n,).

Figures of one gear are numbers; of many they are arrays of shape (gears,), by the same functions.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np


def number_of(value: Any) -> Any:
    """Return a plain number for one gear, and the array for many."""
    return float(value) if np.ndim(value) == 0 else value


def spread(values: np.ndarray) -> Any:
    """Return the peak to peak over the instants of values (..., n)."""
    return number_of(np.ptp(values, axis=-1))


def largest(figures: Sequence[Any]) -> Any:
    """Return the largest of several figures, of each gear."""
    return number_of(np.max(figures, axis=0))


def over_instants(at: np.ndarray, instants: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return values (..., n) at rising instants (n,) on straight lines between them, shape (..., at.size)."""
    if values.ndim == 1:
        return np.interp(at, instants, values)
    right = np.clip(np.searchsorted(instants, at), 1, instants.size - 1)
    share = np.clip((at - instants[right - 1]) / (instants[right] - instants[right - 1]), 0.0, 1.0)
    return np.asarray(values[..., right - 1] * (1 - share) + values[..., right] * share)
