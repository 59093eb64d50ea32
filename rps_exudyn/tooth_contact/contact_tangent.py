"""The tangent of the flank contact: how forces and moments change as the rack is moved against the pinion.

A load at a point r from the rack's reference point acts along the flank's normal N, its friction along h per
unit load. A small motion of the rack, u and a turn omega, deepens the flanks there by w . (u, omega) with

    w = (N, r x N)          and changes its wrench by        -(N + h, r x (N + h)) stiffness w . (u, omega).

Friction changes with the slip across the direction of sliding by drag over speed, along it by the slope of
the friction's law, with the load of its whole side, and as the place moves where sliding turns about within a
line. The loads turn with the flank, and their points move against the reference point. Left out: the ends of
the lines, which move with the motion under the loads that stand there, and the change of the sliding with the
rack's place: together below a hundredth of the largest entry.

The pinion's turn by phi is a turn of the rack by -phi about the pinion's axis, seen from a housing that turns
along. So one matrix C of the motions per coordinate serves: with the stiffness K of the wrench, that of the
forces on the coordinates is C^T K C.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline
from rps_exudyn.forces.friction import (
    ACROSS,
    ALONG,
    FRICTION_ACROSS,
    FRICTION_ALONG,
    SLIP_ACROSS,
    SLIP_ALONG,
    WEIGHT,
    WHOLE_LOAD,
    by_load,
    patch_slopes,
    rubbing,
    slide_slopes,
    stribeck,
)
from rps_exudyn.forces.rigid_motion import Vector, cross, dot, minus, on_angles, plus, scaled, vector
from rps_exudyn.tooth_contact import wrench
from rps_exudyn.tooth_contact.flank_line import (
    DAMPING_LOSS,
    DRAG_B,
    DRAG_R,
    ENERGY,
    LOAD,
    LOAD_R,
    LOAD_T,
    LOAD_Z,
    add_load,
    affine,
    gear_centre,
    patch_of,
    rolling_slip,
    slip_at,
    slip_in_step,
)


class Stance(NamedTuple):
    """A side's line frame in the housing."""

    normal: Vector  # N
    radial: Vector  # e_r
    across: Vector  # B = N x e_r
    tangential: Vector  # e_t
    axis: Vector  # k
    centre: Vector  # the gear's, from the rack's reference point


class Slopes(NamedTuple):
    """Where the tangent of one side is added up."""

    wanted: bool  # else nothing is added
    stiffness: np.ndarray  # of the wrench on the rack over its motion, (6, 6), housing, reference point
    rubbing: np.ndarray  # the same of a side's friction, (6, 6), before it gets the size of the whole load
    loads: np.ndarray  # of that load, its sign turned, (6,)
    factor_q: float  # of the derivative by places
    factor_v: float  # of that by rates
    stance: Stance


@inline
def stance_of(side, angle, position, data):  # type: ignore[no-untyped-def]
    """Return a side's line frame in the housing."""
    _, _, gx, gy, gz = gear_centre(angle, position, data)
    cd, sd, cos, sin = data.cos_delta, data.sin_delta, side.cos, side.sin
    radial, tangential, axis = (cd * cos, sin, -sd * cos), (-cd * sin, cos, sd * sin), (sd, 0.0, cd)
    normal = plus(scaled(-side.sign * side.n_p, tangential), scaled(side.n_z, axis))
    return Stance(normal, radial, cross(normal, radial), tangential, axis, (gx, gy, gz))


@inline
def slopes_of(work, factor_q, factor_v, side, angle, position, data):  # type: ignore[no-untyped-def]
    """Return a side's `Slopes`; none are wanted if both factors are 0."""
    wanted, number = factor_q != 0 or factor_v != 0, 1 if side.sign > 0 else 0
    rubbing, loads = work.rubbing[number], work.by_weight[number]
    if wanted and not data.law.has_state:
        for i in range(6):
            loads[i] = 0.0
            for j in range(6):
                rubbing[i, j] = 0.0
    stance = stance_of(side, angle, position, data)
    return Slopes(wanted, work.stiffness, rubbing, loads, factor_q, factor_v, stance)


@inline
def arm_of(p_r, p_t, z, stance):  # type: ignore[no-untyped-def]
    """From the rack's reference point to a point of the line frame."""
    along = plus(scaled(p_r, stance.radial), plus(scaled(p_t, stance.tangential), scaled(z, stance.axis)))
    return plus(stance.centre, along)


@inline
def add_outer(matrix, factor, force_a, moment_a, force_b, moment_b):  # type: ignore[no-untyped-def]
    """Add factor times the product of two wrenches."""
    a = (force_a[0], force_a[1], force_a[2], moment_a[0], moment_a[1], moment_a[2])
    b = (force_b[0], force_b[1], force_b[2], moment_b[0], moment_b[1], moment_b[2])
    for i in range(6):
        for j in range(6):
            matrix[i, j] += factor * a[i] * b[j]


class Rub(NamedTuple):
    """Friction on the pinion per unit load, and its derivatives by the slip along it and across it [s/m]."""

    force: Vector
    ahead: float
    aside: float
    on: Vector  # the slip's direction
    beside: Vector  # across it


@inline
def friction_at(slip_r, slip_b, data, slopes):  # type: ignore[no-untyped-def]
    """Return the friction at a point by its slip; none of bristles, which is found from all points."""
    stance = slopes.stance
    if data.law.has_state:
        f_r = f_b = ahead = aside = d_r = d_b = 0.0
    else:
        f_r, f_b, ahead, aside, d_r, d_b = rubbing(slip_r, slip_b, data.friction, data.zone, data.law)
    return Rub(
        plus(scaled(f_r, stance.radial), scaled(f_b, stance.across)),
        ahead,
        aside,
        plus(scaled(d_r, stance.radial), scaled(d_b, stance.across)),
        plus(scaled(-d_b, stance.radial), scaled(d_r, stance.across)),
    )


@inline
def add_station(stiffness, load, p_r, p_t, z, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add what a load at a point changes by: its own stiffness [N/m], and its friction's."""
    stance = slopes.stance
    arm = arm_of(p_r, p_t, z, stance)
    factor = -stiffness * (slopes.factor_q + data.damping * slopes.factor_v)
    moment = cross(arm, stance.normal)
    add_outer(slopes.stiffness, factor, stance.normal, moment, stance.normal, moment)
    if data.law.has_state:
        change = scaled(factor, stance.normal)
        turned = scaled(factor, moment)
        add_to_patch(change, turned, arm, p_r, p_t, z, side, data, work, slopes)
        return
    slip_r, slip_b = slip_at(p_r, p_t, z, side)
    rub = friction_at(slip_r, slip_b, data, slopes)
    add_outer(slopes.rubbing, factor, rub.force, cross(arm, rub.force), stance.normal, moment)
    for i in range(3):
        slopes.loads[i] += factor * stance.normal[i]
        slopes.loads[3 + i] += factor * moment[i]
    add_viscous(load, arm, rub, slopes)


@inline
def add_to_patch(force, moment, arm, p_r, p_t, z, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add a load's change over the rack's motion (force, moment), its sign turned, to what bristles change
    by with it: their directions, their weight and their mean slip."""
    stance, number = slopes.stance, 1 if side.sign > 0 else 0
    along, across = slip_in_step(p_r, p_t, z, side, data, work)
    g = stribeck(np.sqrt(along * along + across * across), data.law)
    w_r, w_b = rolling_slip(p_r, p_t, side, data)
    on = plus(scaled(g * w_r, stance.radial), scaled(g * w_b, stance.across))
    beside = plus(scaled(-g * w_b, stance.radial), scaled(g * w_r, stance.across))
    add_outer(work.by_direction[number, 0], 1.0, on, cross(arm, on), force, moment)
    add_outer(work.by_direction[number, 1], 1.0, beside, cross(arm, beside), force, moment)
    for i in range(3):
        of_force, of_moment = g * force[i], g * moment[i]
        work.by_weight[number, i] += of_force
        work.by_weight[number, 3 + i] += of_moment
        work.by_slip[number, 0, i] += along * of_force
        work.by_slip[number, 0, 3 + i] += along * of_moment
        work.by_slip[number, 1, i] += across * of_force
        work.by_slip[number, 1, 3 + i] += across * of_moment


@inline
def add_viscous(load, arm, rub, slopes):  # type: ignore[no-untyped-def]
    """Add the friction's change with the rates: along the sliding and across it."""
    drag = -slopes.factor_v * load
    if drag == 0:
        return
    if rub.ahead != 0:
        moment = cross(arm, rub.on)
        add_outer(slopes.rubbing, drag * rub.ahead, rub.on, moment, rub.on, moment)
    moment = cross(arm, rub.beside)
    add_outer(slopes.rubbing, drag * rub.aside, rub.beside, moment, rub.beside, moment)


@inline
def add_moved(load, growth, k, end, p_r, p_t, z, turning, side, data, slopes):  # type: ignore[no-untyped-def]
    """Add what a station's friction changes by as the place moves where sliding turns about and a line is
    taken in two pieces: by the rates of the rack's motion, of which the place's change is -s . v / s^2 with
    the change s of the slip along the line.

    Args:
        load: of the station [N].
        growth: of the load per length along the line, over the load per length [1/m].
        k: number of the station in its piece.
        end: of the piece, see `flank_line.turning_end` [1/m].
        p_r: of the station, as `p_t` and `z`.
        turning: the line's `Turning`.
        side: of the line.
        data: of the flanks.
        slopes: where the tangent is added up.
    """
    stance = slopes.stance
    slip_r, slip_b = slip_at(p_r, p_t, z, side)
    rub = friction_at(slip_r, slip_b, data, slopes)
    share = data.along[0, 0, k] if end > 0 else 1.0 - data.along[0, 0, k]  # of the place's motion
    along = plus(scaled(turning.r_z, stance.radial), scaled(turning.b_z, stance.across))
    ahead, aside = rub.ahead * dot(rub.on, along), rub.aside * dot(rub.beside, along)
    change = scaled(load * share, plus(scaled(ahead, rub.on), scaled(aside, rub.beside)))
    change = plus(change, scaled(load * (end + share * growth), rub.force))
    way = plus(scaled(turning.p_t_z, stance.tangential), stance.axis)
    moment = plus(cross(arm_of(p_r, p_t, z, stance), change), scaled(load * share, cross(way, rub.force)))
    moved = scaled(-1 / dot(along, along), along)
    there = arm_of(data.base_radius, turning.p_t, turning.z, stance)
    add_outer(slopes.rubbing, -slopes.factor_v, change, moment, moved, cross(there, moved))


@inline
def clear_patches(work):  # type: ignore[no-untyped-def]
    """Begin to add up what bristles of both sides change by with the loads."""
    for number in range(2):
        for i in range(6):
            work.by_weight[number, i] = work.by_slip[number, 0, i] = work.by_slip[number, 1, i] = 0.0
            for j in range(6):
                work.by_direction[number, 0, i, j] = work.by_direction[number, 1, i, j] = 0.0


@inline
def add_rubbing(side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add a side's friction without a state, whose coefficient changes with the side's whole load."""
    load, law = work.sums[LOAD], data.law
    factor, stiffness = by_load(load, law), slopes.stiffness
    for i in range(6):
        for j in range(6):
            stiffness[i, j] += factor * slopes.rubbing[i, j]
    if law.load_exponent != 1.0 and load > 0:
        force, moment = _of_direction(DRAG_R, side, slopes.stance, work.sums)
        loads = vector(slopes.loads[:3]), vector(slopes.loads[3:])
        add_outer(stiffness, (law.load_exponent - 1.0) / load, force, moment, *loads)


@inline
def _of_direction(first, side, stance, sums):  # type: ignore[no-untyped-def]
    """Force and moment about the rack's reference point on the pinion by friction of a side, from sums of it
    or of its directions."""
    n_t, n_z = -side.sign * side.n_p, side.n_z
    force = plus(scaled(sums[first], stance.radial), scaled(sums[first + 3], stance.across))
    moment = plus(
        scaled(-sums[first + 5], stance.radial),
        plus(
            scaled(n_t * sums[first + 4] + sums[first + 2], stance.tangential),
            scaled(n_z * sums[first + 4] - sums[first + 1], stance.axis),
        ),
    )
    return force, plus(moment, cross(stance.centre, force))


@inline
def add_patch_tangent(side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add the tangent of a side's bristles, after their friction was found: by the slip and by the loads."""
    law, sums, number = data.law, work.rubbed, 1 if side.sign > 0 else 0
    if not sums[WEIGHT] > 0:
        return
    place = patch_of(side, data)
    k_aa, k_ab, k_ba, k_bb, p_a, p_b = patch_slopes(data.friction, place, law, work.memory, sums)
    on, on_moment = _of_direction(ALONG, side, slopes.stance, work.rubbed)
    beside, beside_moment = _of_direction(ACROSS, side, slopes.stance, work.rubbed)
    stiffness, rate = slopes.stiffness, -slopes.factor_v
    add_outer(stiffness, rate * k_aa, on, on_moment, on, on_moment)
    add_outer(stiffness, rate * k_ab, on, on_moment, beside, beside_moment)
    add_outer(stiffness, rate * k_ba, beside, beside_moment, on, on_moment)
    add_outer(stiffness, rate * k_bb, beside, beside_moment, beside, beside_moment)
    # by the loads: their sum, and the mean slip, which moves towards the points whose loads grow while the
    # coefficient at each point stays
    limit = data.friction * by_load(sums[WHOLE_LOAD], law) * sums[WEIGHT]
    at = limit, sums[SLIP_ALONG], sums[SLIP_ACROSS], 0.0
    k_aa, k_ab, k_ba, k_bb, _, _, _, _ = slide_slopes(*at, place, law, work.memory)
    for i in range(6):
        weight = work.by_weight[number, i]
        d_a = (work.by_slip[number, 0, i] - sums[SLIP_ALONG] * weight) / sums[WEIGHT]
        d_b = (work.by_slip[number, 1, i] - sums[SLIP_ACROSS] * weight) / sums[WEIGHT]
        work.by_slip[number, 0, i] = p_a * weight + k_aa * d_a + k_ab * d_b
        work.by_slip[number, 1, i] = p_b * weight + k_ba * d_a + k_bb * d_b
    of_on, of_beside = work.by_slip[number, 0], work.by_slip[number, 1]
    add_outer(stiffness, 1.0, on, on_moment, vector(of_on[:3]), vector(of_on[3:]))
    add_outer(stiffness, 1.0, beside, beside_moment, vector(of_beside[:3]), vector(of_beside[3:]))
    of_a, of_b = sums[FRICTION_ALONG] / sums[WEIGHT], sums[FRICTION_ACROSS] / sums[WEIGHT]
    for i in range(6):
        for j in range(6):
            stiffness[i, j] += of_a * work.by_direction[number, 0, i, j]
            stiffness[i, j] += of_b * work.by_direction[number, 1, i, j]


@inline
def add_turn_of_loads(work, side, slopes):  # type: ignore[no-untyped-def]
    """Add what the loads of one side change by as they turn with the flank and as their points move."""
    stance = slopes.stance
    stiffness, factor, load = slopes.stiffness, slopes.factor_q, work.sums[LOAD]
    rub = plus(scaled(work.sums[DRAG_R], stance.radial), scaled(work.sums[DRAG_B], stance.across))
    on_pinion = plus(scaled(load, stance.normal), rub)
    points = plus(scaled(work.sums[LOAD_R], stance.radial), scaled(work.sums[LOAD_T], stance.tangential))
    points = plus(plus(points, scaled(work.sums[LOAD_Z], stance.axis)), scaled(load, stance.centre))
    swing = cross(stance.radial, scaled(work.sums[LOAD_T], stance.normal))
    n_t = -side.sign * side.n_p
    for j in range(3):
        way = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
        moment = cross(way, on_pinion)
        turned = cross(way, stance.normal)
        psi = -dot(turned, stance.radial) / n_t  # turn of the generator psi*
        swung = plus(scaled(-psi, swing), cross(points, turned))
        for i in range(3):
            stiffness[3 + i, j] += factor * moment[i]
            stiffness[i, 3 + j] -= factor * load * turned[i]
            stiffness[3 + i, 3 + j] -= factor * swung[i]


@inline
def _motion(coordinate, carried, axis, turn):  # type: ignore[no-untyped-def]
    """Motion of the rack against the pinion, and its turn, per coordinate of pinion (1) and rack (6)."""
    if coordinate == 0:
        return carried, scaled(-1.0, axis)
    if coordinate < 4:
        x, y = 1.0 if coordinate == 1 else 0.0, 1.0 if coordinate == 2 else 0.0
        return (x, y, 1.0 - x - y), (0.0, 0.0, 0.0)
    if coordinate == 4:
        return (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    return (0.0, 0.0, 0.0), turn.about_b if coordinate == 5 else turn.about_c


@inline
def _product(matrix, row, motion, turned):  # type: ignore[no-untyped-def]
    """Three rows of a matrix (6, 6), times a motion and a turn."""
    a = matrix[row, 0] * motion[0] + matrix[row, 1] * motion[1] + matrix[row, 2] * motion[2]
    b = matrix[row + 1, 0] * motion[0] + matrix[row + 1, 1] * motion[1] + matrix[row + 1, 2] * motion[2]
    c = matrix[row + 2, 0] * motion[0] + matrix[row + 2, 1] * motion[1] + matrix[row + 2, 2] * motion[2]
    a += matrix[row, 3] * turned[0] + matrix[row, 4] * turned[1] + matrix[row, 5] * turned[2]
    b += matrix[row + 1, 3] * turned[0] + matrix[row + 1, 4] * turned[1] + matrix[row + 1, 5] * turned[2]
    c += matrix[row + 2, 3] * turned[0] + matrix[row + 2, 4] * turned[1] + matrix[row + 2, 5] * turned[2]
    return a, b, c


@inline
def pinion_axis(angle, position, data):  # type: ignore[no-untyped-def]
    """Direction of the pinion's axis, and the way to it from the rack's reference point."""
    ecc_e, ecc_y, gx, gy, gz = gear_centre(angle, position, data)
    axis = (data.sin_delta, 0.0, data.cos_delta)
    return axis, (gx - data.cos_delta * ecc_e, gy - ecc_y, gz + data.sin_delta * ecc_e)


@inline
def add_on_coordinates(out, q, turn, axis, to_axis, stiffness, factor_q, tangent):  # type: ignore[no-untyped-def]
    """Add C^T K C to the tangent of the forces on pinion (1) and rack (6), and what C itself changes by
    under the contact's wrench `out`; `turn` is the rack's, `to_axis` the way from its reference point to the
    pinion's `axis`."""
    carried = cross(axis, to_axis)
    for j in range(7):
        motion, turning = _motion(j, carried, axis, turn)
        load = _product(stiffness, 0, motion, turning)
        couple = _product(stiffness, 3, motion, turning)
        tangent[0, j] += dot(carried, load) - dot(axis, couple)
        on_rack = on_angles(turn, couple)
        for i in range(3):
            tangent[1 + i, j] += load[i]
            tangent[4 + i, j] += on_rack[i]
    force, moment = vector(out[wrench.FORCE]), vector(out[wrench.MOMENT])
    turned = cross(axis, force)  # the loads turn with the pinion, which is seen to stand still
    turned_moment = plus(cross(axis, minus(moment, cross(to_axis, force))), cross(to_axis, turned))
    tangent[0, 0] += factor_q * dot(carried, turned)
    on_rack = on_angles(turn, turned_moment)
    for i in range(3):
        tangent[1 + i, 0] += factor_q * turned[i]
        tangent[0, 1 + i] += factor_q * turned[i]
        tangent[4 + i, 0] += factor_q * on_rack[i]
    ca, sa, cb, sb = np.cos(q[4]), np.sin(q[4]), np.cos(q[5]), np.sin(q[5])
    tangent[5, 4] += factor_q * (ca * moment[2] - sa * moment[1])
    tangent[6, 4] -= factor_q * cb * (ca * moment[1] + sa * moment[2])
    tangent[6, 5] += factor_q * (cb * moment[0] + sb * (sa * moment[1] - ca * moment[2]))


# --- Load at one point of the flanks by its depth, with friction, damping and, if asked for, its tangent


@inline
def press(depth, stiffness, eased, p_r, p_t, z, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add the load stiffness * (depth + d * its rate) at a point, with its friction.

    `eased` is the stiffness's weight over the load's in the rule that the point belongs to; `slopes` states
    where to add the tangent.
    """
    pressing = depth
    if data.damping > 0:
        approach = affine(side.part, p_r, p_t, z)
        pressing += data.damping * approach
        if not pressing > 0:
            return
        work.sums[DAMPING_LOSS] += stiffness * (pressing - depth) * approach
    add_load(stiffness * pressing, p_r, p_t, z, side, data, work)
    work.sums[ENERGY] += stiffness * depth * depth / 2
    if slopes.wanted:
        add_station(eased * stiffness, stiffness * pressing, p_r, p_t, z, side, data, work, slopes)
