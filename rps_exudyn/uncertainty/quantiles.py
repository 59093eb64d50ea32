"""Quantiles of drawn numbers, each with its own error; and what failed samples could make of them."""

from dataclasses import dataclass

import numpy as np

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Fractions below the quantiles: the band of 90 %, that of 50 %, and the median."""

MEDIAN = LEVELS.index(0.5)
RESAMPLES, SEED = 200, 0


@dataclass(frozen=True, eq=False)
class Quantiles:
    """Quantiles of one number at `LEVELS`, in its SI unit, shape (5,) each."""

    values: np.ndarray
    errors: np.ndarray  # standard errors, by bootstrap
    lowest: np.ndarray  # what they would be with every failed sample below all others, -inf: unknown
    highest: np.ndarray  # likewise above, inf: unknown

    @property
    def low(self) -> float:
        """Lower end of the band of 90 %."""
        return float(self.values[0])

    @property
    def median(self) -> float:
        """The median."""
        return float(self.values[MEDIAN])

    @property
    def high(self) -> float:
        """Upper end of the band of 90 %."""
        return float(self.values[-1])

    @property
    def half_width(self) -> float:
        """Half the width of the band of 90 %."""
        return (self.high - self.low) / 2

    @property
    def standard(self) -> float:
        """Standard uncertainty of a normal distribution with the same band of 90 %."""
        return self.half_width / 1.6449


def quantiles(numbers: np.ndarray, failed: int = 0, resampled: np.ndarray | None = None) -> Quantiles:
    """Return the quantiles of numbers of shape (n,), beside which `failed` samples gave none.

    Args:
        numbers: finite, at least one.
        failed: samples without a number.
        resampled: the numbers drawn again, shape (resamples, n), where they are not independent of each
            other; by default they are drawn with replacement.
    """
    if resampled is None:
        rng = np.random.default_rng(SEED)
        resampled = numbers[rng.integers(0, numbers.size, (RESAMPLES, numbers.size))]
    values = np.quantile(numbers, LEVELS)
    errors = np.quantile(resampled, LEVELS, axis=1).std(axis=1)
    whole, known = numbers.size + failed, np.sort(numbers)
    below = (np.array(LEVELS) * (whole - 1) - failed) / max(numbers.size - 1, 1)
    above = np.array(LEVELS) * (whole - 1) / max(numbers.size - 1, 1)
    return Quantiles(values, errors, _at(known, below, -np.inf), _at(known, above, np.inf))


def _at(known: np.ndarray, levels: np.ndarray, beyond: float) -> np.ndarray:
    """Quantiles at levels of which those outside 0 to 1 are not known."""
    inside = (levels >= -1e-9) & (levels <= 1 + 1e-9)
    return np.where(inside, np.quantile(known, np.clip(levels, 0, 1)), beyond)
