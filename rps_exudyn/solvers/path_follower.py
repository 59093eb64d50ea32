"""The compiled part of `statics`: from equilibrium to equilibrium while one coordinate is prescribed.

Newton's method with Broyden's update of the inverse tangent: along a smooth path one instant costs three or
four evaluations of the forces, and a new tangent is rare.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import kernel, kernel_over, nested
from rps_exudyn.base.linear import inverse, put
from rps_exudyn.forces.memory import begin_step

Kernel = Callable[..., Any]

TOLERANCE = 1e-3  # largest unbalanced force accepted [N], moments over 10 mm: 1e-5 of the torque
MAX_ITERATIONS = 60
FARTHEST_MOVE = 1e-4  # of one iteration [m]: the contact stays the same contact
SLOW = 0.9  # a step that leaves more of the largest_residual than this asks for a new tangent

# Loops in place of array expressions: numba compiles those much slower, with all their broadcasting.
# `free` are the numbers of the coordinates to be found, `lengths` turn all coordinates into lengths [m].


@kernel
def backward_difference(time, y, k, base):  # type: ignore[no-untyped-def]
    """Return the factor in y'(t_k) = factor (y_k - base) of the parabola through the last three
    points, and fill base."""
    h, g = time[k] - time[k - 1], time[k - 1] - time[k - 2]
    factor = (2 * h + g) / (h * (h + g))
    for i in range(base.size):
        base[i] = ((h + g) / (h * g) * y[k - 1, i] - h / (g * (h + g)) * y[k - 2, i]) / factor
    return factor


@nested
def largest_residual(forces, free, lengths):  # type: ignore[no-untyped-def]
    """Return the largest unbalanced force [N]; moments count over their length."""
    largest = 0.0
    for i in free:
        size = abs(forces[i]) / lengths[i]
        if not size <= largest:  # also a nan
            largest = size
    return largest


@nested
def newton_move(inverse, forces, free, lengths, move):  # type: ignore[no-untyped-def]
    """Fill the step of the free coordinates, shortened to `FARTHEST_MOVE`."""
    largest = 0.0
    for i in range(free.size):
        move[i] = 0.0
        for j in range(free.size):
            move[i] -= inverse[i, j] * forces[free[j]]
        largest = max(largest, abs(move[i]) * lengths[free[i]])
    if largest > FARTHEST_MOVE:
        for i in range(free.size):
            move[i] *= FARTHEST_MOVE / largest


@nested
def explain_step(inverse, move, free, before, after):  # type: ignore[no-untyped-def]
    """Apply Broyden's update: the inverse tangent that maps the change of the forces onto the step made."""
    n, size = free.size, 0.0
    mapped, row = np.zeros(n), np.zeros(n)
    for i in range(n):
        for j in range(n):
            mapped[i] += inverse[i, j] * (after[free[j]] - before[free[j]])
            row[i] += move[j] * inverse[j, i]
        size += move[i] * mapped[i]
    if size == 0 or not np.isfinite(size):
        return
    for i in range(n):
        for j in range(n):
            inverse[i, j] += (move[i] - mapped[i]) * row[j] / size


@nested
def shifted(q, move, fraction, free, trial):  # type: ignore[no-untyped-def]
    """Fill the coordinates a fraction of the step away."""
    put(q, trial)
    for i in range(free.size):
        trial[free[i]] += fraction * move[i]


@nested
def rates_from(q, base, per_time, free, v):  # type: ignore[no-untyped-def]
    """Fill the rates of the free coordinates that the path has at q; per_time 0 keeps those given."""
    if per_time != 0:
        for i in free:
            v[i] = (q[i] - base[i]) * per_time


@nested
def predict(k, time, coordinates, rates, free, base, q):  # type: ignore[no-untyped-def]
    """Extrapolate the free coordinates to instant k and fill base; return the factor of the rates, 0 if
    given.

    q holds the coordinates at the instant before.
    """
    if k == 0:
        return 0.0
    if k == 1:
        per_time = 1 / (time[1] - time[0])
        put(coordinates[0], base)
        for i in free:
            q[i] += rates[0, i] / per_time
        return per_time
    per_time = backward_difference(time, coordinates, k, base)
    stretch = (time[k] - time[k - 1]) / (time[k - 1] - time[k - 2])
    for i in free:
        q[i] += stretch * (q[i] - coordinates[k - 2, i])
    return per_time


@nested
def add(forces, applied):  # type: ignore[no-untyped-def]
    """Add what else acts on the coordinates at an instant."""
    for i in range(forces.size):
        forces[i] += applied[i]


@cache
def inverse_tangent_of(force: Kernel) -> Kernel:
    """Compile the inverse of the tangent of a law of forces, by one-sided differences: Broyden's updates
    refine what they miss."""

    def inverse_tangent(q, v, base, per_time, free, lengths, data, applied, r):  # type: ignore[no-untyped-def]
        n, trial = free.size, q.copy()
        tangent = np.empty((n, n))
        for j in range(n):
            step = 1e-9 if lengths[free[j]] == 1.0 else 1e-8
            trial[free[j]] = q[free[j]] + step
            rates_from(trial, base, per_time, free, v)
            moved = force(trial, v, data)
            add(moved, applied)
            for i in range(n):
                tangent[i, j] = (moved[free[i]] - r[free[i]]) / step
            trial[free[j]] = q[free[j]]
        return inverse(tangent)

    return kernel_over(inverse_tangent, force)


@cache
def line_search_of(force: Kernel) -> Kernel:
    """Compile the search along a step for a place with a smaller residual.

    Fills the trial place; returns the fraction of the step, forces and residual there, and evaluations. With
    an old tangent (`fresh` false) only the whole step is tried.
    """

    def line_search(q, v, move, base, per_time, free, lengths, data, applied, norm, fresh, trial):  # type: ignore[no-untyped-def]
        fraction, evaluations = 1.0, 0
        while True:
            shifted(q, move, fraction, free, trial)
            rates_from(trial, base, per_time, free, v)
            r = force(trial, v, data)
            add(r, applied)
            evaluations += 1
            residual = largest_residual(r, free, lengths)
            enough = SLOW if fraction == 1.0 else 1 - 0.1 * fraction
            if residual < enough * norm or fraction < 0.02 or not fresh:
                return fraction, r, residual, evaluations
            fraction *= 0.5

    return kernel_over(line_search, force)


@cache
def follower(force: Kernel) -> Kernel:
    """Compile follow(first, time, driven, free, lengths, coordinates, rates, forces, applied, kept, memory,
    data) for a law of forces.

    Fills `coordinates`, `rates` and `forces`, all (n, size), from row `first` on: from the rows before it, or
    from the guess in row 0; the driven coordinate's columns are given. `memory` (2, .) is what the law's
    friction remembers, `kept` (n, 2, .) what it did at each instant. `applied` acts besides and counts among
    the forces. Returns how many rows are found,
    evaluations of the forces, iterations, tangents, and the last residual [N].
    """
    inverse_tangent, line_search = inverse_tangent_of(force), line_search_of(force)

    def follow(first, time, driven, free, lengths, coordinates, rates, forces, applied, kept, memory, data):  # type: ignore[no-untyped-def]
        evaluations, iterations, tangents, n = 0, 0, 0, free.size
        inverse, move = np.empty((n, n)), np.empty(n)
        q, v = coordinates[max(first - 1, 0)].copy(), rates[max(first - 1, 0)].copy()
        base, trial = coordinates[0].copy(), np.empty(q.size)
        norm = np.inf
        for k in range(first, time.size):
            if k > 0:
                begin_step(memory, kept[k - 1, 1], time[k])
            per_time = predict(k, time, coordinates, rates, free, base, q)
            q[driven], v[driven] = coordinates[k, driven], rates[k, driven]
            rates_from(q, base, per_time, free, v)
            r = force(q, v, data)
            add(r, applied[k])
            evaluations += 1
            norm = largest_residual(r, free, lengths)
            fresh = False
            for _ in range(MAX_ITERATIONS):
                if norm <= TOLERANCE:
                    break
                if tangents == 0:
                    inverse = inverse_tangent(q, v, base, per_time, free, lengths, data, applied[k], r)
                    tangents, evaluations, fresh = tangents + 1, evaluations + n, True
                iterations += 1
                newton_move(inverse, r, free, lengths, move)
                fraction, r_trial, norm_trial, tried = line_search(
                    q, v, move, base, per_time, free, lengths, data, applied[k], norm, fresh, trial
                )
                evaluations += tried
                if not fresh and not norm_trial < SLOW * norm:  # an old tangent: try again with a new one
                    inverse = inverse_tangent(q, v, base, per_time, free, lengths, data, applied[k], r)
                    tangents, evaluations, fresh = tangents + 1, evaluations + n, True
                    continue
                for i in range(n):
                    move[i] *= fraction
                explain_step(inverse, move, free, r, r_trial)
                fresh = False
                put(trial, q)
                r, norm = r_trial, norm_trial
            if not norm <= TOLERANCE:
                return k, evaluations, iterations, tangents, norm
            rates_from(q, base, per_time, free, v)
            if memory.shape[1] > 0:  # what was evaluated last may have been a trial
                r = force(q, v, data)
                add(r, applied[k])
                for i in range(memory.shape[0]):
                    put(memory[i], kept[k, i])
            put(q, coordinates[k])
            put(v, rates[k])
            put(r, forces[k])
        return time.size, evaluations, iterations, tangents, norm

    return kernel_over(follow, force)
