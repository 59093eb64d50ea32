"""Inertia tensors in Exudyn's order."""

import numpy as np


def six_moments(inertia: np.ndarray) -> np.ndarray:
    """The components xx, yy, zz, yz, xz, xy of an inertia tensor (3, 3) [kg m^2], shape (6,)."""
    return inertia[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
