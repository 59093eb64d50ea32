"""Effects of a study's axes on a number: means over levels, fractions of the variance, surfaces.

A main effect is the mean of the number over all cases with the same value of one axis. In a full grid the
other axes are then the same at every level. Where cases are missing or failed, only settings of the other
axes enter that have a number at every level. The values of a sampled axis are put into classes of equal
count.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

MOST_CLASSES = 8
LEAST_PER_CLASS = 4
LEAST_KNOWN = (0.5, 0.75, 1.0)
"""Levels that miss more of their cases than others get no mean: fractions of the fullest level, in turn."""


@dataclass(frozen=True, eq=False)
class MainEffect:
    """The effect of one axis on a number, in the units of both."""

    levels: np.ndarray  # values of the axis (numbers or words), or means of its classes; shape (levels,)
    mean: np.ndarray  # of the number, shape (levels,), nan where too few cases have a number
    fraction: float  # of the variance that the levels explain, 0..1
    values: np.ndarray  # of the axis, shape (cases with numbers,)
    numbers: np.ndarray  # of those cases, the same shape
    limited: np.ndarray  # which of them met a limit of the gear, the same shape
    side: np.ndarray  # of each level: 0 none of its cases did, 1 all, nan some; shape (levels,)

    @property
    def span(self) -> float:
        """Largest minus smallest mean."""
        known = self.mean[np.isfinite(self.mean)]
        return float(np.ptp(known)) if known.size else 0.0


def grid_effect(
    axes: Mapping[str, np.ndarray], axis: str, numbers: np.ndarray, limited: np.ndarray
) -> MainEffect:
    """The effect of one axis of a grid; every array has one value per case, shape (cases,)."""
    levels, group = np.unique(axes[axis], return_inverse=True)
    mean = _balanced_means(group, len(levels), _others(axes, (axis,)), numbers)
    known = np.isfinite(numbers)
    return _effect(levels, group[known], mean, axes[axis][known], numbers[known], limited[known])


def sampled_effect(values: np.ndarray, numbers: np.ndarray, limited: np.ndarray) -> MainEffect:
    """The effect of an axis of a sampled design; one value per case, shape (cases,) both."""
    known = np.isfinite(numbers)
    values, numbers = values[known], numbers[known]
    if values.dtype.kind == "f":
        group = _equal_classes(values)
        levels = np.array([values[group == at].mean() for at in np.unique(group)])
    else:
        levels, group = np.unique(values, return_inverse=True)
    mean = np.array([numbers[group == at].mean() for at in range(len(levels))])
    return _effect(levels, group, mean, values, numbers, limited[known])


def _effect(
    levels: np.ndarray,
    group: np.ndarray,
    mean: np.ndarray,
    values: np.ndarray,
    numbers: np.ndarray,
    limited: np.ndarray,
) -> MainEffect:
    """The effect of cases with numbers by their groups, and the side of a limit on which each group is."""
    side = np.full(len(levels), np.nan)
    for at in range(len(levels)):
        of_group = limited[group == at]
        if of_group.size and of_group.all() == of_group.any():
            side[at] = float(of_group.all())
    return MainEffect(levels, mean, _explained(group, numbers), values, numbers, limited, side)


def surface(
    axes: Mapping[str, np.ndarray], first: str, second: str, numbers: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means of a number over two axes of a grid: levels (n,), levels (m,), means (n, m), nan if unknown."""
    levels, row = np.unique(axes[first], return_inverse=True)
    others, column = np.unique(axes[second], return_inverse=True)
    count = len(levels) * len(others)
    means = _balanced_means(row * len(others) + column, count, _others(axes, (first, second)), numbers)
    return levels, others, means.reshape(len(levels), len(others))


def _others(axes: Mapping[str, np.ndarray], left_out: tuple[str, ...]) -> np.ndarray:
    """Number of the setting of all other axes, one per case."""
    setting = np.zeros(len(next(iter(axes.values()))), dtype=int)
    for name, values in axes.items():
        if name not in left_out:
            levels, number = np.unique(values, return_inverse=True)
            setting = setting * len(levels) + number
    return np.unique(setting, return_inverse=True)[1]


def _balanced_means(group: np.ndarray, groups: int, setting: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Mean of each group over the settings that have a number in all of them, shape (groups,)."""
    cells = np.full((groups, setting.max(initial=0) + 1), np.nan)
    cells[group, setting] = numbers
    known = np.isfinite(cells)
    count = known.sum(axis=1)
    means = np.full(groups, np.nan)
    for least in LEAST_KNOWN:
        kept = (count >= least * count.max(initial=0)) & (count > 0)
        common = known[kept].all(axis=0)
        if common.any():
            means[kept] = cells[kept][:, common].mean(axis=1)
            break
    return means


def _equal_classes(values: np.ndarray) -> np.ndarray:
    """Number of each value's class; classes are of equal size, up to the remainder."""
    count = int(np.clip(values.size // LEAST_PER_CLASS, 1, MOST_CLASSES))
    ranks = np.argsort(np.argsort(values, kind="stable"), kind="stable")
    return ranks * count // max(values.size, 1)


def _explained(group: np.ndarray, numbers: np.ndarray) -> float:
    """Correlation ratio: the fraction of the variance that the means of the groups explain."""
    total = float(np.sum((numbers - numbers.mean()) ** 2)) if numbers.size else 0.0
    if not total:
        return 0.0
    parts = (numbers[group == at] for at in np.unique(group))
    return sum(part.size * float(part.mean() - numbers.mean()) ** 2 for part in parts) / total
