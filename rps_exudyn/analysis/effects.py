"""What each axis of a study does to a number: means over levels, shares of the variance, surfaces.

A main effect is the mean of the number over all cases with the same value of one axis; in a full grid the
other axes are then the same everywhere. The values of a sampled axis are put into classes of equal count.
Cases whose number is unknown (nan) are left out.
"""

from dataclasses import dataclass

import numpy as np

MOST_CLASSES = 8
LEAST_PER_CLASS = 4


@dataclass(frozen=True, eq=False)
class MainEffect:
    """One axis' effect on a number; arrays have the shape (levels,), the rest is shape (cases,)."""

    levels: np.ndarray  # values of the axis, or means of its classes; words as they are
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray
    share: float  # variance of the means over the variance of all cases, 0..1
    values: np.ndarray  # of the axis, one per known case
    numbers: np.ndarray

    @property
    def span(self) -> float:
        """Largest minus smallest mean."""
        return float(np.ptp(self.mean)) if self.mean.size else 0.0


def main_effect(values: np.ndarray, numbers: np.ndarray, sampled: bool = False) -> MainEffect:
    """The effect of an axis with one value per case on a number, both of shape (cases,)."""
    known = np.isfinite(numbers)
    values, numbers = values[known], numbers[known]
    if sampled and values.dtype.kind == "f":
        classes = _equal_classes(values)
        levels = np.array([values[classes == at].mean() for at in np.unique(classes)])
    else:
        levels, classes = np.unique(values, return_inverse=True)
    groups = [numbers[classes == at] for at in range(len(levels))]
    mean = np.array([group.mean() for group in groups])
    return MainEffect(
        levels=levels,
        mean=mean,
        low=np.array([group.min() for group in groups]),
        high=np.array([group.max() for group in groups]),
        share=_share(groups, numbers),
        values=values,
        numbers=numbers,
    )


def surface(first: np.ndarray, second: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, ...]:
    """Means of a number over two axes of a grid: levels (n,), levels (m,), means (n, m), nan if unknown."""
    levels, row = np.unique(first, return_inverse=True)
    others, column = np.unique(second, return_inverse=True)
    known = np.isfinite(numbers)
    place = (row[known], column[known])
    total, count = np.zeros((len(levels), len(others))), np.zeros((len(levels), len(others)))
    np.add.at(total, place, numbers[known])
    np.add.at(count, place, 1)
    with np.errstate(invalid="ignore"):
        return levels, others, total / count


def _equal_classes(values: np.ndarray) -> np.ndarray:
    """Number of each value's class; classes hold equally many, up to the remainder."""
    count = int(np.clip(values.size // LEAST_PER_CLASS, 1, MOST_CLASSES))
    ranks = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return ranks * count // max(values.size, 1)


def _share(groups: list[np.ndarray], numbers: np.ndarray) -> float:
    """Correlation ratio: what the means over the levels explain of the variance."""
    if not numbers.size or not (total := float(np.sum((numbers - numbers.mean()) ** 2))):
        return 0.0
    return sum(group.size * float(group.mean() - numbers.mean()) ** 2 for group in groups) / total
