"""The compiled part of `newton_path`: equilibria along steady motion, with the tangent of all forces."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import kernel_over, nested
from rps_exudyn.base.linear import put
from rps_exudyn.solvers.newton_tangent import ALL_OUTPUTS, SEAT_LOADS, newton_forces
from rps_exudyn.solvers.path_follower import (
    FARTHEST_MOVE,
    TOLERANCE,
    backward_difference,
    largest_residual,
    rates_from,
)

Kernel = Callable[..., Any]

MAX_STEPS = 40
SMALLEST_FRACTION = 1 / 32
SMALL = 0.05  # residual [N] of which a step by the tangent leaves less than the tolerance: not evaluated


@nested
def solve_step(tangent, forces, free, lengths, system, move):  # type: ignore[no-untyped-def]
    """Fill Newton's step of the free coordinates, shortened to `FARTHEST_MOVE`; false if there is none.

    Elimination with pivots on columns and rows scaled to lengths; `system` (n, n + 1) is work space.
    """
    n = free.size
    for i in range(n):
        for j in range(n):
            system[i, j] = tangent[free[i], free[j]] / (lengths[free[i]] * lengths[free[j]])
        system[i, n] = -forces[free[i]] / lengths[free[i]]
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(system[i, k]) > abs(system[pivot, k]):
                pivot = i
        if not abs(system[pivot, k]) > 0:
            return False
        if pivot != k:
            for j in range(k, n + 1):
                system[k, j], system[pivot, j] = system[pivot, j], system[k, j]
        per_pivot = 1 / system[k, k]
        for i in range(k + 1, n):
            factor = system[i, k] * per_pivot
            if factor != 0:
                for j in range(k + 1, n + 1):
                    system[i, j] -= factor * system[k, j]
    largest = 0.0
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            system[i, n] -= system[i, j] * system[j, n]
        system[i, n] /= system[i, i]
        largest = max(largest, abs(system[i, n]))
    if not np.isfinite(largest):
        return False
    shorten = FARTHEST_MOVE / largest if largest > FARTHEST_MOVE else 1.0
    for i in range(n):
        move[i] = shorten * system[i, n] / lengths[free[i]]
    return True


@nested
def guess(k, per_pitch, coordinates, rates, time, free, kinematic, base, q):  # type: ignore[no-untyped-def]
    """Fill the free coordinates' guess at instant k and `base`; return the factor of the rates, 0 if given.

    What moves besides the kinematics moves as it did a tooth pitch before, in the first pitch on as before.
    """
    if k == 0:
        return 0.0
    if k == 1:
        per_time = 1 / (time[1] - time[0])
        put(coordinates[0], base)
        for i in free:
            q[i] += kinematic[1, i] - kinematic[0, i]
        return per_time
    per_time = backward_difference(time, coordinates, k, base)
    n = per_pitch if 0 < per_pitch < k else 0
    for i in free:
        before = coordinates[k - 1, i] - kinematic[k - 1, i]
        if n > 0:
            moved = (
                coordinates[k - n, i]
                - kinematic[k - n, i]
                - coordinates[k - n - 1, i]
                + kinematic[k - n - 1, i]
            )
        else:
            moved = before - coordinates[k - 2, i] + kinematic[k - 2, i]
        q[i] = kinematic[k, i] + before + moved
    return per_time


@cache
def newton_follower(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile follow(first, time, per_pitch, driven, free, lengths, kinematic, coordinates, rates, forces,
    outputs, handle) for laws of forces.

    Fills `coordinates`, `rates`, `forces` (n, 8) and the elements' `outputs` (n, 73) from row `first` on:
    from the rows before it, or from the guess in row 0; the driven coordinate's columns are given.
    `kinematic` (n, 8) is about what rigid bodies would do, `per_pitch` the number of instants in a tooth
    pitch, 0 if not a whole one. Returns how many rows are found, evaluations, iterations, and the largest
    residual left [N].
    """
    evaluate = newton_forces(mesh_tangent, seat_force)

    def follow_newton(  # type: ignore[no-untyped-def]
        first, time, per_pitch, driven, free, lengths, kinematic, coordinates, rates, forces, outputs, handle
    ):
        n, evaluations, iterations, left = free.size, 0, 0, 0.0
        system, move = np.empty((n, n + 1)), np.zeros(n)
        tangent, total, out, of_loads = np.empty((8, 8)), np.empty(8), np.empty(ALL_OUTPUTS), np.empty((2, 8))
        q, v = coordinates[max(first - 1, 0)].copy(), rates[max(first - 1, 0)].copy()
        base, here = coordinates[0].copy(), np.empty(8)
        for k in range(first, time.size):
            per_time = guess(k, per_pitch, coordinates, rates, time, free, kinematic, base, q)
            q[driven], v[driven] = coordinates[k, driven], rates[k, driven]
            put(q, here)
            norm, fraction, found = np.inf, 1.0, False
            for _ in range(MAX_STEPS):
                rates_from(q, base, per_time, free, v)
                evaluate(q, v, handle, per_time, out, total, tangent, of_loads)
                evaluations += 1
                residual = largest_residual(total, free, lengths)
                if not residual < norm:  # too far along the last step
                    fraction *= 0.5
                    if fraction < SMALLEST_FRACTION:
                        break
                    for i in range(n):
                        q[free[i]] = here[free[i]] + fraction * move[i]
                    continue
                norm, fraction = residual, 1.0
                if norm <= TOLERANCE:
                    found = True
                    break
                if not solve_step(tangent, total, free, lengths, system, move):
                    break
                iterations += 1
                put(q, here)
                for i in range(n):
                    q[free[i]] += move[i]
                if norm <= SMALL:
                    for j in range(n):
                        for i in range(8):
                            total[i] += tangent[i, free[j]] * move[j]
                        for i in range(2):
                            out[SEAT_LOADS + i] += of_loads[i, free[j]] * move[j]
                    found = True
                    break
            if not found:
                return k, evaluations, iterations, norm
            left = max(left, min(norm, TOLERANCE))
            rates_from(q, base, per_time, free, v)
            put(q, coordinates[k])
            put(v, rates[k])
            put(total, forces[k])
            put(out, outputs[k])
        return time.size, evaluations, iterations, left

    return kernel_over(follow_newton, evaluate)
