"""Equilibria of many gears of one design along the same pinion angles, in one compiled loop.

Each gear's motion is sought as a deviation d from what is known of it: a reference gear's coordinates u at
the same angle, and what rigid bodies do beside it. The u are places at the mesh, which repeat with the tooth
pitch: the reference point of a tilted bar shifts across as it travels. Only d is differenced for its rates
and extrapolated, so that angles may lie several degrees apart. The equations are those of `newton_follower`.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel, kernel_over, unowned
from rps_exudyn.base.linear import put
from rps_exudyn.forces.external_load import add_dead_force
from rps_exudyn.forces.friction import constant_drag
from rps_exudyn.forces.sliding_fit import held_fit_force
from rps_exudyn.mesh_contact.flank_element import flank_force_and_tangent
from rps_exudyn.solvers.gear_numbers import (
    AXIS_OFFSET,
    COUNT,
    IDEAL,
    PRELOAD,
    REST_GAP,
    flank_of,
    guides_of,
    load_of,
    seat_of,
)
from rps_exudyn.solvers.newton_approach import CLOSE, newton_approach
from rps_exudyn.solvers.newton_follower import solve_step
from rps_exudyn.solvers.newton_tangent import add_fit_tangent, add_seat_tangent
from rps_exudyn.solvers.path_follower import largest_residual

Kernel = Callable[..., Any]

MAX_STEPS = 40
SMALLEST_FRACTION = 1 / 32
TYPICAL_APPROACH = 15e-6  # of the rack under the yoke's preload [m]
RENEWED = 8  # instants after which the tangent of seat and fit is computed again

# Columns of what the loop keeps of each instant: coordinates and the elements' outputs
FORCE = 8  # on the driven coordinate
MESH = slice(9, 17)  # its outputs behind the forces on the coordinates
SEAT = slice(17, 22)
BUSH = slice(22, 27)
KEPT = 27

# How a gear's row ends
FOUND, NO_REST, LOST = 0, 1, 2

X, Y, Z, ROLL, YAW, PITCH, PLUNGER = 1, 2, 3, 4, 5, 6, 7


@kernel
def placed(u, v, q, rates):  # type: ignore[no-untyped-def]
    """Fill coordinates and rates of the bar's reference point from those at the mesh."""
    for i in range(8):
        q[i], rates[i] = u[i], v[i]
    q[Y], rates[Y] = u[Y] + u[X] * u[PITCH], v[Y] + v[X] * u[PITCH] + u[X] * v[PITCH]
    q[Z], rates[Z] = u[Z] - u[X] * u[YAW], v[Z] - v[X] * u[YAW] - u[X] * v[YAW]


@kernel
def at_mesh(q, u):  # type: ignore[no-untyped-def]
    """Fill the coordinates at the mesh."""
    for i in range(8):
        u[i] = q[i]
    u[Y], u[Z] = q[Y] - q[X] * q[PITCH], q[Z] + q[X] * q[YAW]


@kernel
def rigid_motion_of(angle, speed, driven, numbers, swing, place, rate):  # type: ignore[no-untyped-def]
    """Fill about what rigid bodies do beside the reference gear: gain and runout; coordinates and rates.

    `swing` is the share of the runout across the pinion's axis that the rack follows along X.
    """
    towards_e, towards_y, gain = numbers[9], numbers[10], numbers[24]
    sin, cos = np.sin(angle), np.cos(angle)
    across, lift = towards_y * sin + towards_e * cos, towards_y * cos - towards_e * sin
    place[:], rate[:] = 0.0, 0.0
    if driven == X:
        place[X], rate[X] = gain * angle, gain * speed
        place[0], rate[0] = swing * across / gain - angle, (swing * lift / gain - 1) * speed
    else:
        place[X], rate[X] = gain * angle + swing * across, (gain + swing * lift) * speed
        place[0], rate[0] = -angle, -speed
    place[Y] = place[PLUNGER] = lift
    rate[Y] = rate[PLUNGER] = -across * speed


@kernel
def extrapolated(k, per_pitch, found, d):  # type: ignore[no-untyped-def]
    """Fill the deviation at instant k: it moves as a tooth pitch before, in the first pitch on as before."""
    for i in range(d.size):
        if k > per_pitch > 0:
            d[i] = found[k - per_pitch, i] + found[k - 1, i] - found[k - 1 - per_pitch, i]
        elif k > 1:
            d[i] = found[k - 1, i] + 0.7 * (found[k - 1, i] - found[k - 2, i])
        elif k == 1:
            d[i] = found[0, i]
        else:
            d[i] = 0.0


@kernel
def differenced(k, step, found, base):  # type: ignore[no-untyped-def]
    """Fill the base of the backward difference of even steps; return its factor, 0 at the first instant."""
    for i in range(base.size):
        if k > 1:
            base[i] = (4 * found[k - 1, i] - found[k - 2, i]) / 3
        elif k == 1:
            base[i] = found[0, i]
        else:
            base[i] = 0.0
    return 1.5 / step if k > 1 else (1 / step if k == 1 else 0.0)


@kernel
def keep(q, force, mesh, seat, bush, row):  # type: ignore[no-untyped-def]
    """Keep an instant."""
    for i in range(8):
        row[i] = q[i]
        row[9 + i] = mesh[7 + i]
    row[FORCE] = force
    for i in range(5):
        row[17 + i] = seat[7 + i]
        row[22 + i] = bush[6 + i]


class Parts(NamedTuple):
    """One gear's data."""

    mesh: Any
    seat: Any
    spring: Any
    nut: Any
    bearing: Any
    fit: Any
    load: Any
    weight: Any
    loaded: bool  # whether load or weight act


class Grid(NamedTuple):
    """What all gears of a loop have in common."""

    driven: int  # coordinate
    free: np.ndarray  # the unknown ones
    lengths: np.ndarray
    swing: float  # share of the runout across the axis that the rack follows along X
    angles: np.ndarray  # (k,) even [rad]
    per_pitch: int  # of them in a tooth pitch, 0 if no whole number
    accepted: float  # residual from which a step is not evaluated [N]


class Motion(NamedTuple):
    """What is known of the motion beside gain and runout, over the angles: (k, 8), per feature (k, f, 8)."""

    places: np.ndarray
    rates: np.ndarray  # by the angle
    response: np.ndarray
    response_rates: np.ndarray


@cache
def parts_of(seat_force: Kernel) -> Kernel:
    """Compile the forces beside the teeth's: (q, v, parts, total) -> outputs of seat and fit."""

    def beside_mesh(q, v, parts, total):  # type: ignore[no-untyped-def]
        seat = seat_force(q[1:8], v[1:8], parts.seat)
        bush = held_fit_force(q[1:7], v[1:7], parts.fit)
        for i in range(7):
            total[1 + i] += seat[i]
        for i in range(6):
            total[1 + i] += bush[i]
        total[7] -= parts.spring.preload + parts.spring.rate * q[7]
        total[7] -= parts.nut.stiffness * max(q[7] - parts.nut.clearance, 0.0)
        total[0] -= constant_drag(parts.bearing.torque, v[0], parts.bearing.zone)
        if parts.loaded:
            add_dead_force(total[1:], q[1:7], parts.load)
            add_dead_force(total[1:], q[1:7], parts.weight)
        return seat, bush

    return kernel_over(beside_mesh, seat_force)


@kernel
def beside_tangent(q, v, parts, per_time, tangent, work):  # type: ignore[no-untyped-def]
    """Fill the tangent of seat and fit, which changes little from instant to instant."""
    tangent[:] = 0.0
    add_seat_tangent(q, v, parts.seat, per_time, tangent, work)
    add_fit_tangent(q, v, parts.fit, per_time, tangent)


@kernel
def whole_tangent(q, spring, nut, by_mesh, others, tangent):  # type: ignore[no-untyped-def]
    """Fill the tangent of all forces."""
    for i in range(8):
        for j in range(8):
            tangent[i, j] = others[i, j]
    for i in range(7):
        for j in range(7):
            tangent[i, j] += by_mesh[i, j]
    tangent[7, 7] -= spring.rate
    if q[7] > nut.clearance:
        tangent[7, 7] -= nut.stiffness


@kernel
def begin_instant(k, g, motion, features, speed, shift, place, rate):  # type: ignore[no-untyped-def]
    """Add to rigid motion what is known beside it, and a shift along Y [m]."""
    place[Y] += shift
    for i in range(8):
        at, turning = motion.places[k, i], motion.rates[k, i]
        for f in range(features.shape[1]):
            at += features[g, f] * motion.response[k, f, i]
            turning += features[g, f] * motion.response_rates[k, f, i]
        place[i] += at
        rate[i] += turning * speed


@kernel
def moved(place, rate, d, base, per_time, driven, w, q, v):  # type: ignore[no-untyped-def]
    """Fill coordinates and rates where the deviation is d; w is work space (2, 8)."""
    for i in range(8):
        w[0, i] = place[i] + d[i]
        w[1, i] = rate[i] + (d[i] - base[i]) * per_time
    w[0, driven], w[1, driven] = place[driven], rate[driven]
    placed(w[0], w[1], q, v)


@cache
def instant_of(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile the search for one equilibrium: whether it is found, its evaluations, how long the tangent of
    seat and fit still serves; fills deviation, coordinates and the row that is kept."""
    beside = parts_of(seat_force)

    def instant(q, v, parts, per_time, place, rate, d, base, grid, renew, matrices, solving, w, kept):  # type: ignore[no-untyped-def]
        by_mesh, others, tangent, of_loads = matrices
        system, move, total, here = solving
        n, driven, free = grid.free.size, grid.driven, grid.free
        norm, fraction = np.inf, 1.0
        for attempt in range(MAX_STEPS):
            by_mesh[:] = 0.0
            mesh = mesh_tangent(q[0:7], v[0:7], parts.mesh, 1.0, per_time, by_mesh)
            total[7] = 0.0
            for i in range(7):
                total[i] = mesh[i]
            seat, bush = beside(q, v, parts, total)
            residual = largest_residual(total, free, grid.lengths)
            done = residual <= grid.accepted
            if residual < norm:
                norm, fraction = residual, 1.0
                if renew <= 0 or attempt > 1:
                    beside_tangent(q, v, parts, per_time, others, of_loads)
                    renew = RENEWED
                whole_tangent(q, parts.spring, parts.nut, by_mesh, others, tangent)
                if not solve_step(tangent, total, free, grid.lengths, system, move):
                    return False, attempt + 1, 0
                put(q, here)
            else:  # too far along the last step
                done, fraction = False, 0.5 * fraction
                if fraction < SMALLEST_FRACTION:
                    return False, attempt + 1, 0
            for i in range(n):
                q[free[i]] = here[free[i]] + fraction * move[i]
            at_mesh(q, w[0])
            for i in range(8):
                d[i] = w[0, i] - place[i]
            d[driven] = 0.0
            moved(place, rate, d, base, per_time, driven, w, q, v)
            if done:
                for j in range(n):
                    total[driven] += tangent[driven, free[j]] * move[j]
                keep(q, total[driven], mesh, seat, bush, kept)
                return True, attempt + 1, renew - 1
        return False, MAX_STEPS, 0

    return kernel_over(instant, mesh_tangent, seat_force)


@kernel
def work_space(grid):  # type: ignore[no-untyped-def]
    """Return arrays that the path of a gear needs: matrices, to solve with, vectors, deviations found."""
    n = grid.free.size
    matrices = np.zeros((7, 7)), np.zeros((8, 8)), np.zeros((8, 8)), np.zeros((2, 8))
    solving = np.zeros((n, n + 1)), np.zeros(n), np.zeros(8), np.zeros(8)
    vectors = np.zeros(8), np.zeros(8), np.zeros(8), np.zeros(8), np.zeros(8), np.zeros(8)
    return matrices, solving, vectors, np.zeros((2, 8)), np.zeros((grid.angles.size, 8))


@cache
def gear_of(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile the path of one gear: how it ends, and its evaluations."""
    instant = instant_of(mesh_tangent, seat_force)

    def follow_gear(g, row, parts, speed, shift, motion, features, grid, owned, kept):  # type: ignore[no-untyped-def]
        matrices, solving, vectors, w, found = unowned(owned)
        q, v, d, base, place, rate = vectors
        time_step = (grid.angles[1] - grid.angles[0]) / speed
        evaluations, renew = 0, 0
        for k in range(grid.angles.size):
            rigid_motion_of(grid.angles[k], speed, grid.driven, row, grid.swing, place, rate)
            begin_instant(k, g, motion, features, speed, shift, place, rate)
            extrapolated(k, grid.per_pitch, found, d)
            per_time = differenced(k, time_step, found, base)
            moved(place, rate, d, base, per_time, grid.driven, w, q, v)
            if k < 3:  # rates begin to count
                renew = 0
            here, tries, renew = instant(
                q, v, parts, per_time, place, rate, d, base, grid, renew, matrices, solving, w, kept[k]
            )
            evaluations += tries
            if not here:
                return LOST, evaluations
            put(d, found[k])
        return FOUND, evaluations

    return kernel_over(follow_gear, mesh_tangent, seat_force)


@cache
def adjusted_yoke(mesh_tangent: Kernel) -> Kernel:
    """Compile adjusted(row, near, without) -> the place of the rack along Y under the preload [m], and the
    residual [N]; `without` are the flanks without runout and friction."""
    approach = newton_approach(mesh_tangent)

    def adjusted(row, near, without):  # type: ignore[no-untyped-def]
        _, y, rest = approach(row[PRELOAD], near[0], near[1], without)
        if not rest <= CLOSE:
            _, y, rest = approach(row[PRELOAD], 0.0, row[AXIS_OFFSET] - TYPICAL_APPROACH, without)
        return y, rest

    return kernel_over(adjusted, mesh_tangent)


@cache
def gear_loop(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile follow(handle, rows, references, points, stiffnesses, speeds, near, resting, grid, motion,
    features, out, ended, evaluations) for laws of forces.

    Gear g has the numbers `rows[g]`, see `gear_numbers`; `near` (n, 2) is about the place (x, y) of the rack
    under the preload, `resting` that of the reference rack along Y. Fills `out[g]` (k, `KEPT`), `ended[g]`,
    `evaluations[g]`, and the row's rest gap, which stands for the seat's stiffness before.
    """
    adjusted, follow_gear = adjusted_yoke(flank_force_and_tangent), gear_of(mesh_tangent, seat_force)

    def follow_gears(  # type: ignore[no-untyped-def]
        handle,
        rows,
        references,
        points,
        stiffnesses,
        speeds,
        near,
        resting,
        grid,
        motion,
        features,
        out,
        ended,
        evaluations,
    ):
        data, ideal, work = unowned(handle.data), np.empty(COUNT), work_space(grid)
        rows, references, points, stiffnesses = unowned((rows, references, points, stiffnesses))
        grid, motion, features, out = unowned((grid, motion, features, out))
        for g in range(rows.shape[0]):
            row = rows[g]
            put(row, ideal)
            for column in IDEAL:
                ideal[column] = 0.0
            reference = references[min(g, references.shape[0] - 1)]
            y, rest = adjusted(row, near[g], flank_of(ideal, reference, data.mesh))
            if not rest <= CLOSE:
                ended[g] = NO_REST
                continue
            row[REST_GAP] = row[PRELOAD] / row[REST_GAP] - y
            seat = seat_of(row, points[min(g, points.shape[0] - 1)], data.seat)
            stiffness = stiffnesses[min(g, stiffnesses.shape[0] - 1)]
            spring, nut, bearing, fit = guides_of(row, stiffness, data.bearing, data.fit)
            mesh = flank_of(row, reference, data.mesh)
            load, none = load_of(row, data.load), (0.0, 0.0, 0.0)
            loaded = load.force != none or data.weight.force != none
            parts = Parts(mesh, seat, spring, nut, bearing, fit, load, data.weight, loaded)
            ended[g], evaluations[g] = follow_gear(
                g, row, parts, speeds[g], y - resting, motion, features, grid, work, out[g]
            )

    return kernel_over(follow_gears, mesh_tangent, seat_force)
