"""Loads of elastic contact that push and never pull.

At n stations along the lines of contact the forces F_i = f_i e_i (load per length, length) satisfy

    sum_j C_ij F_j + K f_i (L_i - ln f_i) = delta_i    where F_i > 0
    sum_j C_ij F_j >= delta_i                          where F_i = 0

with a symmetric positive definite compliance C and the logarithm of Hertz's line contact. The set of pressed
stations is found as in the primal-dual active set method, one station at a time should that not end
(Murty's rule, which ends for positive definite matrices), and Newton's method does the logarithm on the way.
"""

import numpy as np

from rps_exudyn.base.compiled import inlined

THICK = 3.0  # least L - ln f of the logarithm, which asks for flat strips in thick teeth; linear beyond
ROUNDS = 40  # changes of the set, or of the loads
ALL_AT_ONCE = 10  # rounds in which all stations that are wrong change at once
CLOSE = 5e-3  # last change of the loads over the largest: the next would be a square of it, 3e-6
LEAST = 1e-3  # load per length below which the logarithm stays what it is [N/m]


@inlined
def local_yield(f, top, k):  # type: ignore[no-untyped-def]
    """Return the yield K f (L - ln f) under a load per length [m], and its slope."""
    log = top - np.log(max(f, LEAST))
    if log < THICK:
        most = np.exp(top - THICK)
        return k * (THICK * most + (THICK - 1) * (f - most)), k * (THICK - 1)
    return k * f * log, k * (log - 1 if f > LEAST else log)


@inlined
def local_energy(f, top, k):  # type: ignore[no-untyped-def]
    """Return the yield's energy per length [J/m], its integral over the load."""
    log = top - np.log(max(f, LEAST))
    if log < THICK:
        most = np.exp(top - THICK)
        beyond = f - most
        return k * (
            most * most * (THICK / 2 + 0.25) + THICK * most * beyond + (THICK - 1) * beyond * beyond / 2
        )
    return k * f * f * (log / 2 + 0.25)


@inlined
def _solve(matrix, n, x):  # type: ignore[no-untyped-def]
    """Solve a symmetric system in place of its lower triangle and right side, by Cholesky's method.

    n is a multiple of four: four rows at a time keep four sums apart, which a processor adds side by side.
    Returns whether the matrix is positive definite.
    """
    for j in range(n):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k]
        if not pivot > 0:
            return False
        matrix[j, j] = pivot = 1 / np.sqrt(pivot)
        for i in range(j + 1, (j + 4) // 4 * 4):
            value = matrix[i, j]
            for k in range(j):
                value -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = value * pivot
        for i in range((j + 4) // 4 * 4, n, 4):
            v_0, v_1, v_2, v_3 = matrix[i, j], matrix[i + 1, j], matrix[i + 2, j], matrix[i + 3, j]
            for k in range(j):
                by = matrix[j, k]
                v_0 -= matrix[i, k] * by
                v_1 -= matrix[i + 1, k] * by
                v_2 -= matrix[i + 2, k] * by
                v_3 -= matrix[i + 3, k] * by
            matrix[i, j], matrix[i + 1, j] = v_0 * pivot, v_1 * pivot
            matrix[i + 2, j], matrix[i + 3, j] = v_2 * pivot, v_3 * pivot
    for j in range(n):
        x[j] *= matrix[j, j]
        for i in range(j + 1, n):
            x[i] -= matrix[i, j] * x[j]
    for j in range(n - 1, -1, -1):
        x[j] *= matrix[j, j]
        for i in range(j):
            x[i] -= matrix[j, i] * x[j]
    return True


@inlined
def press_stations(n, matrix, delta, length, top, k, guess, force):  # type: ignore[no-untyped-def]
    """Fill the forces [N] of n stations; returns whether they were found.

    `matrix` holds the compliance [m/N], its lower triangle; `delta` the depths of the undeformed flanks [m],
    `length` those of the stations' cells [m], `top` the constants L, `guess` a load per length and depth to
    begin with [N/m^2].
    """
    pressed, chosen = np.empty(n, np.bool_), np.empty(n, np.int64)
    padded = (n + 3) // 4 * 4
    system, step = np.empty((padded, padded)), np.empty(padded)
    for i in range(n):
        pressed[i] = delta[i] > 0
        force[i] = guess * max(delta[i], 0.0) * length[i]
    for turn in range(ROUNDS):
        m = 0
        for i in range(n):
            if pressed[i]:
                chosen[m] = i
                m += 1
        if m == 0:
            return True
        for row in range(m):
            step[row] = delta[chosen[row]]
        for row in range(m):
            i = chosen[row]
            value, slope = local_yield(force[i] / length[i], top[i], k)
            for col in range(row):
                entry = matrix[i, chosen[col]]
                system[row, col] = entry
                step[col] -= entry * force[i]
                value += entry * force[chosen[col]]
            value += matrix[i, i] * force[i]
            step[row] -= value
            system[row, row] = matrix[i, i] + slope / length[i]
        full = (m + 3) // 4 * 4
        for row in range(m, full):  # unit rows
            for col in range(row):
                system[row, col] = 0.0
            system[row, row], step[row] = 1.0, 0.0
        if not _solve(system, full, step):
            return False
        largest, move = 0.0, 0.0
        for row in range(m):
            force[chosen[row]] += step[row]
            largest, move = max(largest, force[chosen[row]]), max(move, abs(step[row]))
        changes = _revise(n, m, matrix, delta, force, chosen, pressed, turn >= ALL_AT_ONCE)
        if changes == 0 and move <= CLOSE * largest:
            return True
    return False


@inlined
def _revise(n, m, matrix, delta, force, chosen, pressed, one_by_one):  # type: ignore[no-untyped-def]
    """Release the stations that pull, press those that overlap; how many were wrong."""
    changes = 0
    for i in range(n):
        if one_by_one and changes:
            break
        if pressed[i]:
            if force[i] < 0:
                changes += 1
                pressed[i] = False
        else:
            gap = -delta[i]
            for col in range(m):
                j = chosen[col]
                gap += matrix[max(i, j), min(i, j)] * force[j]
            if gap < 0:
                changes += 1
                pressed[i] = True
    for i in range(n):
        if not pressed[i]:
            force[i] = 0.0
    return changes
