"""Equilibria of many gears of one design along the same pinion angles, in one compiled loop.

Each gear's motion is sought as a deviation d from what is known of it: a reference gear's coordinates u at
the same angle, and what rigid bodies do beside it. The u are places at the mesh, which repeat with the tooth
pitch: the reference point of a tilted bar shifts across as it travels. Only d is differenced for its rates
and extrapolated, so that angles may lie several degrees apart. The equations are those of `newton_follower`.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import kernel, kernel_over
from rps_exudyn.forces.bearing import bearing_force
from rps_exudyn.forces.external_load import add_dead_force
from rps_exudyn.forces.sliding_fit import held_fit_force
from rps_exudyn.forces.yoke import nut_force, spring_force
from rps_exudyn.mesh_contact.flank_element import flank_force_and_tangent
from rps_exudyn.solvers.gear_numbers import COUNT, PRELOAD, REST_GAP, flank_of, guides_of, seat_of
from rps_exudyn.solvers.newton_approach import CLOSE, newton_approach
from rps_exudyn.solvers.newton_follower import solve_step
from rps_exudyn.solvers.newton_tangent import add_fit_tangent, add_seat_tangent
from rps_exudyn.solvers.path_follower import largest_residual

Kernel = Callable[..., Any]

MAX_STEPS = 40
SMALLEST_FRACTION = 1 / 32
TYPICAL_APPROACH = 15e-6  # of the rack under the yoke's preload [m]
RENEWED = 4  # instants after which the tangent of seat and fit is computed again

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


@cache
def gear_loop(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile follow(handle, rows, references, points, stiffnesses, driven, free, lengths, swing, angles,
    speeds, per_pitch, known, known_rates, response, response_rates, features, adjusted, accepted, out, ended,
    counts) for laws of forces.

    For gear g with the numbers `rows[g]`, see `gear_numbers`: `known` (k, 8) are a reference gear's
    coordinates at the mesh beside gain and runout, `known_rates` their derivatives by the angle, `response`
    and `response_rates` (k, f, 8) what both change by per feature of the gear, `features[g]` (f,). `adjusted`
    is the place (x, y) of the reference rack under its preload, y less its axis offset, and y itself.
    Fills `out[g]` (k, `KEPT`), `ended[g]`, `counts[g]` (evaluations, instants found), and the row's rest gap,
    which stands for the seat's stiffness before.
    A step that begins at a residual up to `accepted` [N] is not evaluated.
    """
    approach_of = newton_approach(flank_force_and_tangent)

    def follow_gears(  # type: ignore[no-untyped-def]
        handle,
        rows,
        references,
        points,
        stiffnesses,
        driven,
        free,
        lengths,
        swing,
        angles,
        speeds,
        per_pitch,
        known,
        known_rates,
        response,
        response_rates,
        features,
        adjusted,
        accepted,
        out,
        ended,
        counts,
    ):
        n, instants, data = free.size, angles.size, handle.data
        system, move = np.empty((n, n + 1)), np.zeros(n)
        by_mesh, others, tangent, of_loads = (
            np.empty((7, 7)),
            np.zeros((8, 8)),
            np.empty((8, 8)),
            np.empty((2, 8)),
        )
        total, q, v, u, w, here = (
            np.empty(8),
            np.empty(8),
            np.empty(8),
            np.empty(8),
            np.empty(8),
            np.empty(8),
        )
        d, base, place, rate = np.empty(8), np.empty(8), np.empty(8), np.empty(8)
        found, ideal = np.zeros((instants, 8)), np.empty(COUNT)
        step = (angles[1] - angles[0]) if instants > 1 else 1.0
        loaded = data.load.force != (0.0, 0.0, 0.0) or data.weight.force != (0.0, 0.0, 0.0)
        for g in range(rows.shape[0]):
            row = rows[g]
            seat_stiffness = row[REST_GAP]
            ideal[:] = row
            ideal[9] = ideal[10] = ideal[29] = 0.0  # no runout, no friction
            reference = references[min(g, references.shape[0] - 1)]
            without = flank_of(ideal, reference, data.mesh)
            _, y, rest = approach_of(row[PRELOAD], adjusted[0], adjusted[1] + row[18], without)
            if not rest <= CLOSE:
                _, y, rest = approach_of(row[PRELOAD], 0.0, row[18] - TYPICAL_APPROACH, without)
            if not rest <= CLOSE:
                ended[g] = NO_REST
                continue
            row[REST_GAP] = row[PRELOAD] / seat_stiffness - y
            mesh_data = flank_of(row, reference, data.mesh)
            seat_data = seat_of(row, points[min(g, points.shape[0] - 1)], data.seat)
            spring, nut, bearing, fit = guides_of(
                row, stiffnesses[min(g, stiffnesses.shape[0] - 1)], data.bearing, data.fit
            )
            speed, shift = speeds[g], y - adjusted[2]
            time_step = step / speed
            ended[g], renew, lost = FOUND, 0, False
            for k in range(instants):
                rigid_motion_of(angles[k], speed, driven, row, swing, place, rate)
                place[Y] += shift
                for i in range(8):
                    at, turning = known[k, i], known_rates[k, i]
                    for f in range(features.shape[1]):
                        at += features[g, f] * response[k, f, i]
                        turning += features[g, f] * response_rates[k, f, i]
                    place[i] += at
                    rate[i] += turning * speed
                extrapolated(k, per_pitch, found, d)
                per_time = differenced(k, time_step, found, base)
                for i in range(8):
                    u[i] = place[i] + d[i]
                    w[i] = rate[i] + (d[i] - base[i]) * per_time
                u[driven], w[driven] = place[driven], rate[driven]
                placed(u, w, q, v)
                norm, fraction, done = np.inf, 1.0, False
                for attempt in range(MAX_STEPS):
                    by_mesh[:] = 0.0
                    mesh = mesh_tangent(q[0:7], v[0:7], mesh_data, 1.0, per_time, by_mesh)
                    seat = seat_force(q[1:8], v[1:8], seat_data)
                    bush = held_fit_force(q[1:7], v[1:7], fit)
                    total[7] = 0.0
                    for i in range(7):
                        total[i] = mesh[i]
                    for i in range(7):
                        total[1 + i] += seat[i]
                    for i in range(6):
                        total[1 + i] += bush[i]
                    total[7] += spring_force(q[7:8], v[7:8], spring)[0] + nut_force(q[7:8], v[7:8], nut)[0]
                    total[0] += bearing_force(q[0:1], v[0:1], bearing)[0]
                    if loaded:
                        add_dead_force(total[1:], q[1:7], data.load)
                        add_dead_force(total[1:], q[1:7], data.weight)
                    counts[g, 0] += 1
                    residual = largest_residual(total, free, lengths)
                    if not residual < norm:  # too far along the last step
                        fraction *= 0.5
                        if fraction < SMALLEST_FRACTION:
                            break
                        for i in range(n):
                            q[free[i]] = here[free[i]] + fraction * move[i]
                    else:
                        norm, fraction = residual, 1.0
                        if renew <= 0 or attempt > 1:
                            others[:] = 0.0
                            add_seat_tangent(q, v, seat_data, per_time, others, of_loads)
                            add_fit_tangent(q, v, fit, per_time, others)
                            renew = RENEWED if k > 1 else 0
                        for i in range(8):
                            for j in range(8):
                                tangent[i, j] = others[i, j]
                        for i in range(7):
                            for j in range(7):
                                tangent[i, j] += by_mesh[i, j]
                        tangent[7, 7] -= spring.rate
                        if q[7] > nut.clearance:
                            tangent[7, 7] -= nut.stiffness
                        if not solve_step(tangent, total, free, lengths, system, move):
                            break
                        here[:] = q
                        for i in range(n):
                            q[free[i]] += move[i]
                        if norm <= accepted:
                            for j in range(n):
                                total[driven] += tangent[driven, free[j]] * move[j]
                            done = True
                    at_mesh(q, u)
                    for i in range(8):
                        d[i] = u[i] - place[i]
                        w[i] = rate[i] + (d[i] - base[i]) * per_time
                    d[driven], w[driven] = 0.0, rate[driven]
                    placed(u, w, q, v)
                    if done:
                        break
                renew -= 1
                if not done:
                    lost = True
                    break
                found[k] = d
                keep(q, total[driven], mesh, seat, bush, out[g, k])
                counts[g, 1] += 1
            if lost:
                ended[g] = LOST

    return kernel_over(follow_gears, mesh_tangent, seat_force)
