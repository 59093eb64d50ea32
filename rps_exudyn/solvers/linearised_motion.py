"""The motion of a gear linearised at places that it passes: slopes of its forces, and eigenvalues.

An eigenvalue's real part is the rate at which its vibration grows, its imaginary part the angular frequency.
"""

import numpy as np

from rps_exudyn.solvers.balance import Balance


def slopes(balance: Balance, places: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces' slopes by places and by rates, (k, n, n) each, at k places and rates (k, n)."""
    by_place, by_rate = (
        np.array([balance.difference_tangent(q, v, *factors) for q, v in zip(places, rates, strict=True)])
        for factors in ((1.0, 0.0), (0.0, 1.0))
    )
    return by_place, by_rate


def eigenvalues(mass: np.ndarray, by_place: np.ndarray, by_rate: np.ndarray) -> np.ndarray:
    """Return the eigenvalues [1/s] of masses (n, n) under forces with such slopes (k, n, n), (k, 2n)."""
    k, n = by_place.shape[:2]
    accelerations = np.linalg.solve(mass, np.concatenate([by_place, by_rate], axis=2))
    moved = np.broadcast_to(np.eye(n, 2 * n, n), (k, n, 2 * n))
    return np.asarray(np.linalg.eigvals(np.concatenate([moved, accelerations], axis=1)))
