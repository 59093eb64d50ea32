"""The follower: equilibria of gears from instant to instant while the rig moves them.

Each gear's motion is sought as a deviation d from a motion that is known beforehand: what rigid bodies do,
or what a reference gear does. Only d is differenced for its rates and extrapolated, so that instants may lie
several degrees apart. Places are those at the mesh, which repeat with the tooth pitch: the reference point
of a tilted bar shifts across as it travels.

Newton's method with the analytic tangent of all forces; a tangent serves until it converges slowly. A step
is taken as far as it shortens the next one by the same tangent (the natural monotonicity test: P. Deuflhard,
Newton Methods for Nonlinear Problems, 2011, section 3.3): stiff teeth let the residual grow on the way. A
quarter of it is taken anyway: where friction turns about, shorter steps stop before the corner for ever.

Many gears save an evaluation: the step from a residual below `accept` is not evaluated where it should leave
less than the tolerance, and the forces there are those of the tangent. It leaves ten times the tolerance at
some instants, where lines of contact begin or end. Single runs evaluate all steps.

Behind the coordinates of the gear stands the wheel's, where there is a steering column: with the wheel at
theta, the joint's output at u(theta) and the pinion at phi, the column's torque k (u - phi) + c (u' - phi')
turns the pinion, and times u' the wheel. What is accelerated there is not prescribed: masses act against the
backward difference of the path's rates, so that the path is that of the second-order formula of BDF.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import (
    CUBE,
    HYPERCUBE,
    MATRIX,
    NUMBER,
    NUMBERS,
    VECTOR,
    WHOLE,
    Law,
    called,
    entry,
    inline,
    kernel,
    placed,
    placed_numbers,
)
from rps_exudyn.forces.friction import begin_step
from rps_exudyn.solvers.gear_model import GEARS, LAW, OUTPUTS, SEAT_LOADS, WORKS
from rps_exudyn.solvers.settling import TOLERANCE

MAX_STEPS = 40
LEAST_DAMPED = 0.25  # of a step, which is taken even where it lengthens the next one
SMALLEST_FRACTION = 1 / 32  # of one that leads to forces that are not finite
FARTHEST_MOVE = 1e-4  # of one iteration [m]: the contact stays the same contact
SLOW = 0.1  # a step that leaves more of the residual than this asks for a new tangent
FIRST_STRETCH = 1e-9  # of a creeping gear's first step [m/N]
CREEP_MOVE = 20e-6  # of one step of a creeping gear [m]
MAX_CREEPS = 100  # steps, of which most gears need 30 to 80
PATIENCE, PROGRESS = 15, 0.9  # steps of a creeping gear in which the residual must fall to that share
ACCEPT = 0.05  # residual [N] from which a step of many gears is not evaluated

X, Y, Z, YAW, PITCH = 1, 2, 3, 5, 6  # coordinates of the rack
RIGID = 8  # coordinates whose motion is known beforehand of a single gear


@inline
def put(numbers, row):  # type: ignore[no-untyped-def]
    """Copy numbers into a row: for `row[:] = numbers` numba compiles the message of an error, which takes
    half a second."""
    for i in range(numbers.size):
        row[i] = numbers[i]


class Column(NamedTuple):
    """A steering column and the tyres at the rack, for the follower."""

    exists: bool
    stiffness: float  # [N m/rad]
    damping: float  # [N m s/rad]
    bend: float  # of the joint [rad]
    phase: float  # of its wheel-side yoke at wheel angle 0 [rad]
    tyre: float  # stiffness of the tyres [N/m]
    relaxed: float  # place of the rack at which they carry nothing [m]


NO_COLUMN = np.zeros(7)


@inline
def at_mesh(q, u):  # type: ignore[no-untyped-def]
    """Fill the places at the mesh."""
    for i in range(q.size):
        u[i] = q[i]
    u[Y], u[Z] = q[Y] - q[X] * q[PITCH], q[Z] + q[X] * q[YAW]


@inline
def differenced(k, time, found, base):  # type: ignore[no-untyped-def]
    """Fill `base` and return the factor of the backward difference d'(t_k) = factor (d_k - base), by the
    parabola through three instants; 0 at the first instant."""
    if k == 0:
        return 0.0
    h = time[k] - time[k - 1]
    if k == 1:
        put(found[0], base)
        return 1 / h
    g = time[k - 1] - time[k - 2]
    factor = (2 * h + g) / (h * (h + g))
    for i in range(base.size):
        base[i] = ((h + g) / (h * g) * found[k - 1, i] - h / (g * (h + g)) * found[k - 2, i]) / factor
    return factor


@inline
def extrapolated(k, per_pitch, time, found, d):  # type: ignore[no-untyped-def]
    """Fill the deviation at instant k: it changes as a tooth pitch before, by second differences over the
    pitch; in the first pitch, and where there is none, by the parabola through three instants."""
    p = per_pitch
    if k == 0:
        for i in range(d.size):
            d[i] = 0.0
    elif k == 1:
        put(found[0], d)
    elif p > 0 and p + 1 < k:
        for i in range(d.size):
            before, earlier = found[k - 1, i] - found[k - 1 - p, i], found[k - 2, i] - found[k - 2 - p, i]
            d[i] = found[k - p, i] + 2 * before - earlier
    else:
        h, g = time[k] - time[k - 1], time[k - 1] - time[k - 2]
        f = time[k - 2] - time[k - 3] if k > 2 else 0.0
        for i in range(d.size):
            slope = (found[k - 1, i] - found[k - 2, i]) / g
            d[i] = found[k - 1, i] + h * slope
            if k > 2:
                d[i] += h * (h + g) / (g + f) * (slope - (found[k - 2, i] - found[k - 3, i]) / f)


@inline
def largest_residual(forces, free, lengths):  # type: ignore[no-untyped-def]
    """Return the largest unbalanced force [N]; moments count over their length."""
    largest = 0.0
    for i in free:
        size = abs(forces[i]) / lengths[i]
        if not np.isfinite(size):
            return np.inf
        largest = max(largest, size)
    return largest


@kernel
def factorized(tangent, damping, free, lengths, system, pivots):  # type: ignore[no-untyped-def]
    """Factorize the tangent by the free coordinates, scaled to lengths, less a damping [N/m], with pivots;
    false if it is singular."""
    n = free.size
    for i in range(n):
        for j in range(n):
            system[i, j] = tangent[free[i], free[j]] / (lengths[free[i]] * lengths[free[j]])
        system[i, i] -= damping
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(system[i, k]) > abs(system[pivot, k]):
                pivot = i
        pivots[k] = pivot
        if not abs(system[pivot, k]) > 0:
            return False
        if pivot != k:
            for j in range(n):
                system[k, j], system[pivot, j] = system[pivot, j], system[k, j]
        per_pivot = 1 / system[k, k]
        for i in range(k + 1, n):
            factor = system[i, k] * per_pivot
            system[i, k] = factor
            if factor != 0:
                for j in range(k + 1, n):
                    system[i, j] -= factor * system[k, j]
    return True


@kernel
def newton_move(system, pivots, forces, free, lengths, move):  # type: ignore[no-untyped-def]
    """Fill Newton's step of the free coordinates by a factorized tangent; return its size [m]."""
    n, largest = free.size, 0.0
    for i in range(n):
        move[i] = -forces[free[i]] / lengths[free[i]]
    for k in range(n):
        pivot = pivots[k]
        if pivot != k:
            move[k], move[pivot] = move[pivot], move[k]
    for i in range(n):
        for j in range(i):
            move[i] -= system[i, j] * move[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            move[i] -= system[i, j] * move[j]
        move[i] /= system[i, i]
        if not np.isfinite(move[i]):
            return np.inf
        largest = max(largest, abs(move[i]))
    for i in range(n):
        move[i] /= lengths[free[i]]
    return largest


# --- steering column -------------------------------------------------------------------------------
@inline
def joint(angle, column):  # type: ignore[no-untyped-def]
    """Return output u(theta) of a universal joint, its ratio u' and u'', see `steering_column`."""
    bend, phase = column[3], column[4]
    ratio, slope = 1.0, 0.0
    output = angle
    if bend != 0:
        bent, cosine = np.sin(bend) ** 2, np.cos(bend)
        yoke = angle + phase
        part = 1 - bent * np.cos(yoke) ** 2
        ratio, slope = cosine / part, -cosine * bent * np.sin(2 * yoke) / (part * part)
        output += _lead(yoke, cosine) - _lead(phase, cosine)
    return output, ratio, slope


@inline
def _lead(yoke, cosine):  # type: ignore[no-untyped-def]
    """Angle by which the joint's output leads its input."""
    sine, along = np.sin(yoke), np.cos(yoke)
    return np.arctan(sine * along * (1 - cosine) / (cosine * along**2 + sine**2))


@inline
def add_column(q, v, column, hand, per_time, wanted, total, tangent):  # type: ignore[no-untyped-def]
    """Add the column's torque to pinion and wheel, and the tyres' force to the rack; `hand` turns the wheel.

    Coordinates count against the angles.
    """
    w = q.size - 1
    output, ratio, slope = joint(-q[w], column)
    stiff = column[1] + column[2] * per_time
    torque = column[1] * (output + q[0]) + column[2] * (v[0] - ratio * v[w])
    total[0] -= torque
    total[w] = ratio * torque - hand
    total[X] -= column[5] * (q[X] - column[6])
    if wanted:
        tangent[0, 0] -= stiff
        tangent[0, w] += ratio * stiff
        tangent[w, 0] += ratio * stiff
        tangent[w, w] -= ratio * ratio * stiff + slope * torque
        tangent[X, X] -= column[5]


@inline
def inertia_force(i, masses, v, before, per_time):  # type: ignore[no-untyped-def]
    """Return the force on coordinate i of masses accelerated from the rates: (v - before) per_time."""
    force = 0.0
    for j in range(v.size):
        force -= masses[i, j] * (v[j] - before[j]) * per_time
    return force


@inline
def add_inertia(v, masses, before, per_time, wanted, total, tangent):  # type: ignore[no-untyped-def]
    """Add these forces to all coordinates."""
    for i in range(v.size):
        total[i] += inertia_force(i, masses, v, before, per_time)
        if wanted:
            for j in range(v.size):
                tangent[i, j] -= masses[i, j] * per_time * per_time


@entry(VECTOR, VECTOR, VECTOR, NUMBER, MATRIX, VECTOR, NUMBER, NUMBER, VECTOR, MATRIX)
def add_column_to(  # type: ignore[no-untyped-def]
    q, v, column, hand, masses, before, per_time, factor_v, total, tangent
):
    """Add both to forces (n,) and their tangent (n, n), with the rates' derivative; for Python."""
    if column[0] != 0:
        add_column(q, v, column, hand, factor_v, True, total, tangent)
    if masses.size > 0:
        add_inertia(v, masses, before, per_time, factor_v != 0, total, tangent)


# --- the follower ----------------------------------------------------------------------------------
@inline
def fill_rates(q, known, known_rates, base, per_time, free, u, w, v):  # type: ignore[no-untyped-def]
    """Fill the rates that the path has at q; `per_time` 0 leaves those that are given. Of the first
    coordinates the motion is known beforehand."""
    if per_time == 0:
        return
    at_mesh(q, u)
    put(v, w)
    for i in free:
        if i < known.size:
            w[i] = known_rates[i] + (u[i] - known[i] - base[i]) * per_time
        else:
            w[i] = (u[i] - base[i]) * per_time
    for i in free:
        v[i] = w[i]
        if i == Y:
            v[Y] = w[Y] + w[X] * u[PITCH] + u[X] * w[PITCH]
        elif i == Z:
            v[Z] = w[Z] - w[X] * u[YAW] - u[X] * w[YAW]


@inline
def place_at(d, known, free, u, q):  # type: ignore[no-untyped-def]
    """Fill the free coordinates from a deviation at the mesh; the others are given in q."""
    put(q, u)
    for i in free:
        u[i] = d[i] + (known[i] if i < known.size else 0.0)
    for i in free:
        q[i] = u[i]
        if i == Y:
            q[Y] = u[Y] + u[X] * u[PITCH]
        elif i == Z:
            q[Z] = u[Z] - u[X] * u[YAW]


@kernel
def evaluate(  # type: ignore[no-untyped-def]
    law,
    q,
    v,
    gears,
    g,
    pool,
    works,
    wanted,
    per_time,
    applied,
    column,
    hand,
    masses,
    before,
    own_total,
    own_tangent,
    total,
    tangent,
):
    """Fill the gear's own forces, those with all that acts besides, and both tangents if they are wanted."""
    own, n = own_total.size, total.size
    factor_q, factor_v = (1.0, per_time) if wanted else (0.0, 0.0)
    called(law, q[:own], v[:own], gears, g, pool, works, factor_q, factor_v, own_total, own_tangent)
    if wanted:
        for i in range(n):
            for j in range(n):
                tangent[i, j] = own_tangent[i, j] if i < own and j < own else 0.0
    for i in range(n):
        total[i] = (own_total[i] if i < own else 0.0) + applied[i]
    if n > own:
        add_column(q, v, column, hand, per_time, wanted, total, tangent)
    if masses.size > 0:
        add_inertia(v, masses, before, per_time, wanted, total, tangent)


ROWS = 12  # of coordinates, rates and forces


def room_to_follow(instants: int, coordinates: int) -> np.ndarray:
    """Return the room that `follow` takes, filled with zeros."""
    n = coordinates
    return np.zeros((ROWS + 1 + 3 * n + instants) * n)


@entry(
    Law(LAW),
    WHOLE,
    VECTOR,
    WHOLE,
    CUBE,
    CUBE,
    NUMBERS,
    VECTOR,
    MATRIX,
    VECTOR,
    VECTOR,
    MATRIX,
    NUMBER,
    CUBE,
    CUBE,
    CUBE,
    CUBE,
    HYPERCUBE,
    GEARS,
    VECTOR,
    WORKS,
    NUMBERS,
    MATRIX,
    VECTOR,
)
def follow(  # type: ignore[no-untyped-def]
    law,
    first,
    time,
    per_pitch,
    known,
    known_rates,
    free,
    lengths,
    applied,
    column,
    hand,
    masses,
    accept,
    coordinates,
    rates,
    forces,
    outputs,
    kept,
    gears,
    pool,
    works,
    ended,
    counts,
    room,
):
    """Follow the equilibria of gears from the instant `first` on: from those before it, or from the guess in
    row 0, whose rates are given. Coordinates that are not free are given everywhere, with their rates.

    Args:
        law: of `gear_model`.
        first: number of the first instant to find.
        time: instants (t,) [s].
        per_pitch: even instants in a tooth pitch, 0 if no whole number.
        known: motion known beforehand of the first coordinates, places at the mesh (g, t, .).
        known_rates: its rates, likewise.
        free: numbers of the unknown coordinates.
        lengths: turn all coordinates into lengths [m], (n,).
        applied: what acts besides and counts among the forces, (t, n).
        column: fields of `Column`; all 0 without one.
        hand: torque on the wheel (t,) [N m].
        masses: of what is accelerated as the path is (n, n) [kg, kg m, kg m^2]; (0, 0) if nothing is.
        accept: residual [N] from which a step by the tangent is not evaluated.
        coordinates: (g, t, n), to be filled.
        rates: the same.
        forces: generalised forces (g, t, n) with inertia, without those of column and tyres, to be filled.
        outputs: of all parts (g, t, OUTPUTS), to be filled.
        kept: state of the bristles at start and end of each step (g, t, 2, .), to be filled.
        gears: records of the gears (g,).
        pool: numbers that they point to.
        works: work space (1,).
        ended: numbers of instants found (g,), to be filled.
        counts: evaluations, iterations, tangents, largest residual left [N], residual where it ended [N];
            (g, 5), to be filled.
        room: for places and systems of equations, `room_to_follow` numbers.
    """
    work, n, has_column = works[0], lengths.size, column[0] != 0
    has_masses = masses.size > 0
    own = n - 1 if has_column else n  # coordinates of the gear
    m, memory, has_bristles = free.size, work.contact.memory, kept.shape[3] > 0
    rows, square, is_old = placed(room, 0, (ROWS, n)), room[ROWS * n :], False
    move, correction, own_total, total = rows[0, :m], rows[1, :m], rows[2, :own], rows[3]
    d, base, u, w = rows[4], rows[5], rows[6], rows[7]
    q, v, here, before = rows[8], rows[9], rows[10], rows[11]
    system, pivots = placed(square, 0, (m, m)), placed_numbers(square, n * n, m)
    own_tangent, tangent = placed(square, n * n + n, (own, own)), placed(square, 2 * n * n + n, (n, n))
    filled = own_total, own_tangent, total, tangent
    found = placed(square, 3 * n * n + n, (time.size, n))
    for g in range(gears.shape[0]):
        for k in range(first):
            at_mesh(coordinates[g, k], found[k])
            for i in range(known.shape[2]):
                found[k, i] -= known[g, k, i]
        evaluations, iterations, tangents, left, norm = 0, 0, 0, 0.0, 0.0
        ended[g] = time.size
        for k in range(first, time.size):
            put(coordinates[g, k], q)
            put(rates[g, k], v)
            per_time = differenced(k, time, found, base)
            if has_masses:
                differenced(k, time, rates[g], before)
            if k > 0:
                extrapolated(k, per_pitch, time, found, d)
                place_at(d, known[g, k], free, u, q)
                if has_bristles:
                    begin_step(memory, kept[g, k - 1, 1], time[k])
            put(q, here)
            at, beside = (law, q, v, gears, g, pool, works), (applied[k], column, hand[k], masses, before)
            norm, size, fraction, is_found, wanted = np.inf, np.inf, 1.0, False, True
            least = 0.0
            for _ in range(MAX_STEPS):
                fill_rates(q, known[g, k], known_rates[g, k], base, per_time, free, u, w, v)
                evaluate(*at, wanted, per_time, *beside, *filled)
                evaluations += 1
                tangents += wanted
                residual = largest_residual(total, free, lengths)
                if residual <= TOLERANCE:
                    norm, is_found = residual, True
                    break
                rate = 0.0 if wanted else np.inf  # a new tangent converges by squares
                if size < np.inf:
                    after = newton_move(system, pivots, total, free, lengths, correction)
                    if not after <= (1 - fraction / 4) * size:  # too far along the last step
                        if is_old:  # by a tangent of another place
                            put(here, q)
                            size, wanted = np.inf, True
                            continue
                        if fraction > least or not np.isfinite(after):
                            fraction *= 0.5
                            if fraction < SMALLEST_FRACTION:
                                break
                            for i in range(m):
                                q[free[i]] = here[free[i]] + fraction * move[i]
                            continue
                        if not wanted:  # goes on from here by a tangent of this place
                            size, wanted = np.inf, True
                            continue
                    slow = after > SLOW * size
                    if not wanted:
                        rate = after / size
                else:
                    after, slow = np.inf, False
                norm, is_old = residual, not wanted
                put(q, here)
                if wanted:
                    if not factorized(tangent, 0.0, free, lengths, system, pivots):
                        break
                    size = newton_move(system, pivots, total, free, lengths, move)
                else:
                    size = after
                    put(correction, move)
                if not np.isfinite(size):
                    break
                iterations += 1
                wanted, fraction = slow, min(1.0, FARTHEST_MOVE / size)
                least = LEAST_DAMPED * fraction
                for i in range(m):
                    q[free[i]] = here[free[i]] + fraction * move[i]
                if norm <= accept and fraction == 1.0 and rate * norm <= TOLERANCE:
                    for j in range(m):
                        if free[j] < own:
                            for i in range(own):
                                own_total[i] += own_tangent[i, free[j]] * move[j]
                        if 0 < free[j] < 8:
                            for i in range(2):
                                work.out[SEAT_LOADS + i] += work.of_loads[i, free[j] - 1] * move[j]
                    is_found = True
                    break
            if not is_found and k > 0:  # the gear creeps there, see `settling.settled`
                place_at(d, known[g, k], free, u, q)
                stretch, norm, accepted = FIRST_STRETCH, np.inf, True
                least, since = np.inf, 0
                for _ in range(MAX_CREEPS):
                    fill_rates(q, known[g, k], known_rates[g, k], base, per_time, free, u, w, v)
                    evaluate(*at, True, per_time, *beside, *filled)
                    evaluations, tangents = evaluations + 1, tangents + 1
                    residual = largest_residual(total, free, lengths)
                    if accepted and norm < np.inf:  # else it went back there
                        growth = norm / residual if residual < np.inf else 0.0
                        stretch *= min(max(growth, 1.3), 10.0) if growth > 0.9 else 0.2
                        if not growth > 0.2:
                            put(here, q)
                            accepted = False
                            continue
                    accepted, norm = True, residual
                    put(q, here)
                    if norm < PROGRESS * least:
                        least, since = norm, 0
                    since += 1
                    is_found = norm <= TOLERANCE
                    if is_found or since > PATIENCE:
                        break
                    if not factorized(tangent, 1 / stretch, free, lengths, system, pivots):
                        break
                    size = newton_move(system, pivots, total, free, lengths, move)
                    if not np.isfinite(size):
                        break
                    iterations += 1
                    for i in range(m):
                        q[free[i]] += min(1.0, CREEP_MOVE / size) * move[i]
            if not is_found:
                ended[g] = k
                break
            left = max(left, min(norm, TOLERANCE))
            fill_rates(q, known[g, k], known_rates[g, k], base, per_time, free, u, w, v)
            if has_bristles:  # what was evaluated last may have been a trial
                called(law, q[:own], v[:own], gears, g, pool, works, 0.0, 0.0, own_total, own_tangent)
                evaluations += 1
                for i in range(2):
                    put(memory[i], kept[g, k, i])
            at_mesh(q, found[k])
            for i in range(known.shape[2]):
                found[k, i] -= known[g, k, i]
            put(q, coordinates[g, k])
            put(v, rates[g, k])
            for i in range(own):
                forces[g, k, i] = own_total[i] + applied[k, i]
                if has_masses:
                    forces[g, k, i] += inertia_force(i, masses, v, before, per_time)
            for i in range(OUTPUTS):
                outputs[g, k, i] = work.out[i]
        counts[g, 0], counts[g, 1], counts[g, 2] = evaluations, iterations, tangents
        counts[g, 3], counts[g, 4] = left, norm
