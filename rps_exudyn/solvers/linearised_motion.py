"""The motion of a gear linearised at places that it passes: slopes of its forces, and eigenvalues.

An eigenvalue's real part is the rate at which its vibration grows, its imaginary part the angular frequency.
"""

import numpy as np

from rps_exudyn.solvers.balance import Balance

STEPS_PER_SECOND = 100.0  # of a rate's difference over that of its coordinate, at most ...
PART_OF_ZONE = 0.04  # ... and that difference over the friction zone


def slopes(balance: Balance, places: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces' slopes by places and by rates, (k, n, n) each, at k places and rates (k, n).

    By forward differences: the tangent of the laws leaves out what turns with the bar's small angles. Steps
    are far below penetrations (micrometres) and within the friction zone; rotations act at centimetres.
    """
    n = places.shape[1]
    step = np.where(balance.lengths[:n] < 1, 1e-8, 1e-9)
    step[8:] = 1e-9
    in_zone = PART_OF_ZONE * float(balance.gears[0]["fit"]["zone"]) / 1e-9
    rate_step = min(STEPS_PER_SECOND, in_zone) * step
    by_place, by_rate = np.empty((len(places), n, n)), np.empty((len(places), n, n))
    for k, (q, v) in enumerate(zip(places, rates, strict=True)):
        here = balance.force(q, v)
        for j in range(n):
            moved, turned = q.copy(), v.copy()
            moved[j] += step[j]
            turned[j] += rate_step[j]
            by_place[k, :, j] = (balance.force(moved, v) - here) / (moved[j] - q[j])
            by_rate[k, :, j] = (balance.force(q, turned) - here) / (turned[j] - v[j])
    return by_place, by_rate


def eigenvalues(mass: np.ndarray, by_place: np.ndarray, by_rate: np.ndarray) -> np.ndarray:
    """Return the eigenvalues [1/s] of masses (n, n) under forces with such slopes (k, n, n), (k, 2n)."""
    k, n = by_place.shape[:2]
    accelerations = np.linalg.solve(mass, np.concatenate([by_place, by_rate], axis=2))
    moved = np.broadcast_to(np.eye(n, 2 * n, n), (k, n, 2 * n))
    return np.asarray(np.linalg.eigvals(np.concatenate([moved, accelerations], axis=1)))
