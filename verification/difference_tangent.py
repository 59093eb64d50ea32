"""The tangent of a gear's forces by differences, the reference of the analytic one."""

import numpy as np

from rps_exudyn.solvers.balance import Balance

STEPS_PER_SECOND = 100.0  # of a rate's difference over that of its coordinate, at most ...
PART_OF_ZONE = 0.04  # ... and that difference over the friction zone


def difference_tangent(
    balance: Balance, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float
) -> np.ndarray:
    """Return factor_q dF/dq + factor_v dF/dv (n, n) by forward differences, with what turns with the bar's
    small angles.

    Steps are far below penetrations (micrometres) and within the friction zone; rotations act at centimetres.
    Across a corner of the forces a difference is no slope. Of friction without a state.
    """
    n = q.size
    total, moved, unused = np.empty(n), np.empty(n), np.zeros((0, 0))
    tangent, law = np.zeros((n, n)), balance.law
    rest = balance.gears, 0, balance.pool, balance.works, 0.0, 0.0
    step = np.where(angles(balance), 1e-8, 1e-9)
    per_step = min(STEPS_PER_SECOND, PART_OF_ZONE * float(balance.gears[0]["fit"]["zone"]) / 1e-9)
    law(q, v, *rest, total, unused)
    place, rate = q.copy(), v.copy()
    for j in range(n):
        if factor_q:
            place[j] += step[j]
            law(place, v, *rest, moved, unused)
            tangent[:, j] += factor_q / (place[j] - q[j]) * (moved - total)
            place[j] = q[j]
        if factor_v:
            rate[j] += per_step * step[j]
            law(q, rate, *rest, moved, unused)
            tangent[:, j] += factor_v / (rate[j] - v[j]) * (moved - total)
            rate[j] = v[j]
    return tangent


def angles(balance: Balance) -> np.ndarray:
    """Return which coordinates (n,) are angles: of pinion and rack, and of the supports."""
    found = np.zeros(balance.size, dtype=bool)
    found[[0, 4, 5, 6]] = True
    if len(balance.supported):
        found[-2:] = True
    return found
