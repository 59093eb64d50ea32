"""Loads of elastic contact that push and never pull.

At n stations along the lines of contact the forces F_i = f_i e_i (load per length, length) satisfy

    sum_j C_ij F_j + K f_i (L_i - ln f_i) = delta_i    where F_i > 0
    sum_j C_ij F_j >= delta_i                          where F_i = 0

with a symmetric positive definite compliance C and the logarithm of Hertz's line contact. The set of pressed
stations is found as in the primal-dual active set method, one station at a time should that not end
(Murty's rule, which ends for positive definite matrices), and Newton's method does the logarithm on the way.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, kernel, placed, placed_numbers

THICK = 3.0  # least L - ln f of the logarithm, which asks for flat strips in thick teeth; linear beyond
ROUNDS = 40  # changes of the set, or of the loads
ALL_AT_ONCE = 10  # rounds in which all stations that are wrong change at once
LIGHT = 0.02  # of the largest load per length: lighter ones have the slope of this one
SHRINKS = 0.06  # from step to step for which a tangent serves; what the first one with it is taken to leave
LEFT = 1e-6  # error of the loads over the largest
LEAST = 1e-3  # load per length below which the logarithm stays what it is [N/m]


@inline
def local_yield(f, top, k):  # type: ignore[no-untyped-def]
    """Return the yield K f (L - ln f) under a load per length [m], and its slope."""
    log = top - np.log(max(f, LEAST))
    if log < THICK:
        most = np.exp(top - THICK)
        return k * (THICK * most + (THICK - 1) * (f - most)), k * (THICK - 1)
    return k * f * log, k * (log - 1 if f > LEAST else log)


@inline
def local_energy(f, top, k):  # type: ignore[no-untyped-def]
    """Return the yield [m], and the energy per length stored [J/m]: load times yield, less its integral."""
    log = top - np.log(max(f, LEAST))
    if log < THICK:
        most = np.exp(top - THICK)
        beyond = f - most
        integral = most * most * (THICK / 2 + 0.25) + beyond * (THICK * most + (THICK - 1) * beyond / 2)
        value = k * (THICK * most + (THICK - 1) * beyond)
    else:
        integral, value = f * f * (log / 2 + 0.25), k * f * log
    return value, f * value - k * integral


@inline
def factorize(matrix, n):  # type: ignore[no-untyped-def]
    """Put Cholesky's factor in place of the lower triangle, its diagonal inverted; return success.

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


@inline
def _substitute(factor, n, x):  # type: ignore[no-untyped-def]
    """Solve with a factor of `factorize` in place of the right side."""
    for i in range(0, n, 2):
        a, b = 0.0, 0.0
        for k in range(i):
            a += factor[i, k] * x[k]
            b += factor[i + 1, k] * x[k]
        x[i] = (x[i] - a) * factor[i, i]
        x[i + 1] = (x[i + 1] - b - factor[i + 1, i] * x[i]) * factor[i + 1, i + 1]
    for j in range(n - 1, -1, -1):
        x[j] *= factor[j, j]
        for i in range(j):
            x[i] -= factor[j, i] * x[j]


@inline
def substitute_all(factor, n, rows):  # type: ignore[no-untyped-def]
    """Solve with a factor of `factorize` in place of six right sides, the columns of `rows`, whose sums a
    processor's registers hold."""
    for i in range(n):
        a, b, c, d, e, f = rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5]
        for k in range(i):
            by = factor[i, k]
            a, b, c = a - by * rows[k, 0], b - by * rows[k, 1], c - by * rows[k, 2]
            d, e, f = d - by * rows[k, 3], e - by * rows[k, 4], f - by * rows[k, 5]
        by = factor[i, i]
        rows[i, 0], rows[i, 1], rows[i, 2] = by * a, by * b, by * c
        rows[i, 3], rows[i, 4], rows[i, 5] = by * d, by * e, by * f
    for i in range(n - 1, -1, -1):
        a, b, c, d, e, f = rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5]
        for k in range(i + 1, n):
            by = factor[k, i]
            a, b, c = a - by * rows[k, 0], b - by * rows[k, 1], c - by * rows[k, 2]
            d, e, f = d - by * rows[k, 3], e - by * rows[k, 4], f - by * rows[k, 5]
        by = factor[i, i]
        rows[i, 0], rows[i, 1], rows[i, 2] = by * a, by * b, by * c
        rows[i, 3], rows[i, 4], rows[i, 5] = by * d, by * e, by * f


@inline
def _gather(m, chosen, matrix, block):  # type: ignore[no-untyped-def]
    """Fill the compliance between the pressed stations, the whole square."""
    for row in range(m):
        i = chosen[row]
        for col in range(row + 1):
            block[row, col] = block[col, row] = matrix[i, chosen[col]]


@inline
def _residual(m, chosen, block, delta, length, top, k, force, light, rest, slopes):  # type: ignore[no-untyped-def]
    """Fill what the pressed stations' yield lacks of their depth [m], and the slopes of the Hertzian part,
    of loads per length lighter than `light` those of that one."""
    for row in range(m):
        i = chosen[row]
        f = force[i] / length[i]
        value, slopes[row] = local_yield(f, top[i], k)
        if f < light:
            _, slopes[row] = local_yield(light, top[i], k)
        rest[row] = delta[i] - value
    for col in range(m):
        load = force[chosen[col]]
        for row in range(m):
            rest[row] -= block[col, row] * load


@inline
def _tangent(m, chosen, block, length, slopes, system):  # type: ignore[no-untyped-def]
    """Fill the tangent compliance of the pressed stations and unit rows to a multiple of four; how many."""
    full = (m + 3) // 4 * 4
    for row in range(m):
        for col in range(row):
            system[row, col] = block[row, col]
        system[row, row] = block[row, row] + slopes[row] / length[chosen[row]]
    for row in range(m, full):
        for col in range(row):
            system[row, col] = 0.0
        system[row, row] = 1.0
    return full


def room_of_loads(stations: int) -> int:
    """Return how much room `press_stations` takes, in numbers."""
    most = (stations + 3) // 4 * 4
    return 2 * stations + (2 * most + 4) * most


@kernel
def press_stations(n, matrix, delta, length, top, k, guess, force, room):  # type: ignore[no-untyped-def]
    """Fill the forces [N] of n stations; returns whether they were found.

    `matrix` holds the compliance [m/N], its lower triangle; `delta` the depths of the undeformed flanks [m],
    `length` those of the stations' cells [m], `top` the constants L, `guess` a load per length and depth to
    begin with [N/m^2]. The stations that overlap are taken first. A factor serves for as long as each step
    is much smaller than that before; by what the slopes have changed since, each step is corrected once.
    """
    most = (n + 3) // 4 * 4
    pressed, chosen = placed_numbers(room, 0, n), placed_numbers(room, n, n)
    work = placed(room, 2 * n, (2 * most + 4, most))
    system, block, step, slopes = work[:most], work[most : 2 * most], work[2 * most], work[2 * most + 1]
    factored, excess = work[2 * most + 2], work[2 * most + 3]
    for i in range(n):
        pressed[i] = 1 if delta[i] > 0 else 0
        force[i] = guess * max(delta[i], 0.0) * length[i]
    m, full, before, largest, serves, fade = 0, 0, np.inf, 0.0, False, 1.0
    for turn in range(ROUNDS):
        if not serves:
            m, largest = 0, 0.0
            for i in range(n):
                if pressed[i]:
                    chosen[m] = i
                    m += 1
                    largest = max(largest, force[i] / length[i])
            if m == 0:
                return True
            _gather(m, chosen, matrix, block)
        if turn > ALL_AT_ONCE:
            fade /= 2
        light = LIGHT * largest * fade  # a slope too small leads to and fro
        _residual(m, chosen, block, delta, length, top, k, force, light, step, slopes)
        if not serves:
            before = np.inf
            full = _tangent(m, chosen, block, length, slopes, system)
            if not factorize(system, full):
                return False
            for row in range(m):
                factored[row] = slopes[row]
        for row in range(m, full):
            step[row] = excess[row] = 0.0
        _substitute(system, full, step)
        if serves:
            for row in range(m):
                excess[row] = (slopes[row] - factored[row]) / length[chosen[row]] * step[row]
            _substitute(system, full, excess)
            for row in range(m):
                step[row] -= excess[row]
        most_force, move = 0.0, 0.0
        for row in range(m):
            force[chosen[row]] += step[row]
            most_force, move = max(most_force, force[chosen[row]]), max(move, abs(step[row]))
        changes = _revise(n, m, matrix, delta, force, chosen, pressed, turn >= ALL_AT_ONCE)
        shrinks = move / before if before < np.inf else max(move / most_force, SHRINKS)
        if changes == 0 and move * shrinks <= LEFT * most_force:
            return True
        serves, before = changes == 0 and move <= SHRINKS * before, move
    return False


@inline
def _revise(n, m, matrix, delta, force, chosen, pressed, one_by_one):  # type: ignore[no-untyped-def]
    """Release the stations that pull, press those that overlap; how many were wrong."""
    changes = 0
    for i in range(n):
        if one_by_one and changes:
            break
        if pressed[i]:
            if force[i] < 0:
                changes += 1
                pressed[i] = 0
        else:
            gap = -delta[i]
            for col in range(m):
                j = chosen[col]
                gap += matrix[max(i, j), min(i, j)] * force[j]
            if gap < 0:
                changes += 1
                pressed[i] = 1
    for i in range(n):
        if not pressed[i]:
            force[i] = 0.0
    return changes
