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
NEAR = 1e-2  # change of the loads over the largest from which on the last tangent serves
CLOSE = 1e-4  # last change: what it leaves is a thousandth of it
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
    """Return the energy per length stored [J/m]: load times yield, less the integral of the yield."""
    log = top - np.log(max(f, LEAST))
    if log < THICK:
        most = np.exp(top - THICK)
        beyond = f - most
        integral = most * most * (THICK / 2 + 0.25) + beyond * (THICK * most + (THICK - 1) * beyond / 2)
    else:
        integral = f * f * (log / 2 + 0.25)
    return f * local_yield(f, top, k)[0] - k * integral


@inlined
def _factorize(matrix, n):  # type: ignore[no-untyped-def]
    """Put Cholesky's factor in place of the lower triangle, its diagonal inverted; tell if that can be done.

    n is a multiple of four: four rows at a time keep four sums apart, which a processor adds side by side.
    """
    for j in range(n):
        pivot = matrix[j, j]
        for k in range(j):
            pivot -= matrix[j, k] * matrix[j, k]
        if not pivot > 0:
            return False
        matrix[j, j] = pivot = 1 / np.sqrt(pivot)
        block = (j + 4) // 4 * 4
        for i in range(j + 1, block):
            value = matrix[i, j]
            for k in range(j):
                value -= matrix[i, k] * matrix[j, k]
            matrix[i, j] = value * pivot
        for i in range(block, n, 4):
            v_0, v_1, v_2, v_3 = matrix[i, j], matrix[i + 1, j], matrix[i + 2, j], matrix[i + 3, j]
            for k in range(j):
                by = matrix[j, k]
                v_0 -= matrix[i, k] * by
                v_1 -= matrix[i + 1, k] * by
                v_2 -= matrix[i + 2, k] * by
                v_3 -= matrix[i + 3, k] * by
            matrix[i, j], matrix[i + 1, j] = v_0 * pivot, v_1 * pivot
            matrix[i + 2, j], matrix[i + 3, j] = v_2 * pivot, v_3 * pivot
    return True


@inlined
def _substitute(factor, n, x):  # type: ignore[no-untyped-def]
    """Solve with a factor of `_factorize` in place of the right side."""
    for j in range(n):
        x[j] *= factor[j, j]
        for i in range(j + 1, n):
            x[i] -= factor[i, j] * x[j]
    for j in range(n - 1, -1, -1):
        x[j] *= factor[j, j]
        for i in range(j):
            x[i] -= factor[j, i] * x[j]


@inlined
def _residual(m, chosen, matrix, delta, length, top, k, force, rest, slopes):  # type: ignore[no-untyped-def]
    """Fill what the pressed stations' yield lacks of their depth [m], and the slopes of the Hertzian part."""
    for row in range(m):
        rest[row] = delta[chosen[row]]
    for row in range(m):
        i = chosen[row]
        value, slopes[row] = local_yield(force[i] / length[i], top[i], k)
        for col in range(row):
            j = chosen[col]
            rest[col] -= matrix[i, j] * force[i]
            value += matrix[i, j] * force[j]
        rest[row] -= value + matrix[i, i] * force[i]


@inlined
def _tangent(m, chosen, matrix, length, slopes, system):  # type: ignore[no-untyped-def]
    """Fill the tangent compliance of the pressed stations and unit rows to a multiple of four; how many."""
    full = (m + 3) // 4 * 4
    for row in range(m):
        i = chosen[row]
        for col in range(row):
            system[row, col] = matrix[i, chosen[col]]
        system[row, row] = matrix[i, i] + slopes[row] / length[i]
    for row in range(m, full):
        for col in range(row):
            system[row, col] = 0.0
        system[row, row] = 1.0
    return full


@inlined
def press_stations(n, matrix, delta, length, top, k, guess, force):  # type: ignore[no-untyped-def]
    """Fill the forces [N] of n stations; returns whether they were found.

    `matrix` holds the compliance [m/N], its lower triangle; `delta` the depths of the undeformed flanks [m],
    `length` those of the stations' cells [m], `top` the constants L, `guess` a load per length and depth to
    begin with [N/m^2].
    """
    pressed, chosen = np.empty(n, np.bool_), np.empty(n, np.int64)
    most = (n + 3) // 4 * 4
    system, step, slopes = np.empty((most, most)), np.empty(most), np.empty(n)
    for i in range(n):
        pressed[i] = delta[i] > 0
        force[i] = guess * max(delta[i], 0.0) * length[i]
    m, full, close = 0, 0, False
    for turn in range(ROUNDS):
        if not close:
            m = 0
            for i in range(n):
                if pressed[i]:
                    chosen[m] = i
                    m += 1
            if m == 0:
                return True
        _residual(m, chosen, matrix, delta, length, top, k, force, step, slopes)
        if not close:
            full = _tangent(m, chosen, matrix, length, slopes, system)
            if not _factorize(system, full):
                return False
        for row in range(m, full):
            step[row] = 0.0
        _substitute(system, full, step)
        largest, move = 0.0, 0.0
        for row in range(m):
            force[chosen[row]] += step[row]
            largest, move = max(largest, force[chosen[row]]), max(move, abs(step[row]))
        changes = _revise(n, m, matrix, delta, force, chosen, pressed, turn >= ALL_AT_ONCE)
        if changes == 0 and move <= CLOSE * largest:
            return True
        close = changes == 0 and move <= NEAR * largest
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
