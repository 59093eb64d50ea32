"""The line along which a plane flank of the rack meets an involute helicoid, and the loads on it.

Line frame of one side: origin in the gear's centre, axes e_r, e_t at the generator psi* whose normal is
parallel to the plane's in the transverse section, and the gear's axis k. With xi = psi - psi*, N the
rack flank's outward normal (tangential part -s N_p, axial part N_z) and q*(Z) = q(psi*, Z):

    P(xi, Z)     = r_b e_r(xi) + (s q* - r_b xi) e_t(xi) + Z k                       point of the flank
    depth(xi, Z) = c + N_p (s r_b (sin xi - xi cos xi) + q* cos xi) - N_z Z          exact for any pose
    dA           = (q* - s r_b xi) / cos beta_b dxi dZ

(derived here from the helicoid of `gears.helicoid`). The depth is linear along a generator xi = const and
close to a parabola across, d depth/d xi = -N_p q sin xi: the contact is a strip along the line xi = 0.
In the expansions below only powers are left out that the strip's half width, some 0.05, makes < 1e-6.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inlined
from rps_exudyn.mesh_contact.flank_data import (
    AXIS_OFFSET,
    BASE_RADIUS,
    COS_DELTA,
    DAMPING,
    ECCENTRIC_E,
    ECCENTRIC_Y,
    FLANK_OFFSET,
    FRICTION,
    HALF_FACE,
    NORMAL_BASE_PITCH,
    NORMAL_X,
    NORMAL_Y,
    NORMAL_Z,
    PITCH_ERROR,
    Q_FORM,
    Q_TIP,
    SIN_DELTA,
    TEETH,
    THETA,
    THETA_COAST_TO_DRIVE,
    TWIST,
    ZONE,
)
from rps_exudyn.mesh_contact.flank_strip import MARGIN
from rps_exudyn.mesh_contact.wrench import (
    DAMPING_POWER,
    ELASTIC_ENERGY,
    FORCE,
    FRICTION_POWER,
    MOMENT,
    NORMAL_COAST,
    NORMAL_DRIVE,
    PENETRATION,
    TORQUE,
    TOUCHING,
)


class Side(NamedTuple):
    """One side's line frame, and what does not change along its lines."""

    sign: float  # s
    psi: float  # psi*
    sin: float  # e_r = (cos, sin), e_t = (-sin, cos) in the (e, Y) plane
    cos: float
    n_p: float  # |transverse part| of the normal; N = (0, -s n_p, n_z)
    n_z: float
    offset: float  # depth of flank j at the gear's centre: offset + s j p_bn
    v_r: float  # rack's velocity relative to the pinion, at the gear's centre
    v_t: float
    v_z: float
    w_r: float  # rack's angular velocity relative to the pinion
    w_t: float
    w_z: float
    slip: float  # the same motion along B = N x e_r: slip + slip_r P_r + slip_t P_t + slip_z Z
    slip_r: float
    slip_t: float
    slip_z: float
    part: float  # and along N, which parts the flanks when negative
    part_r: float
    part_t: float
    part_z: float
    y_0: float  # rack's own y and z coordinate of a point: y_0 + y_r P_r + y_t P_t + y_z Z
    y_r: float
    y_t: float
    y_z: float
    z_0: float
    z_r: float
    z_t: float
    z_z: float


class Line(NamedTuple):
    """One tooth's line on one side: q*(Z) = q_0 + q_1 Z, depth at xi = 0 is d_0 + d_1 Z."""

    q_0: float
    q_1: float
    d_0: float
    d_1: float


class Band(NamedTuple):
    """A part of the flank between two tangent lengths; above `relief_from` the tip relief is taken off."""

    low: float
    high: float
    relief: float
    relief_from: float


# What the loads of one side add up to, in the line frame about the gear's centre.
LOAD, LOAD_R, LOAD_T, LOAD_Z = 0, 1, 2, 3  # normal loads, and times P_r, P_t, Z
DRAG_R, DRAG_R_T, DRAG_R_Z = 4, 5, 6  # friction on the pinion along e_r, and times P_t, Z
DRAG_B, DRAG_B_R, DRAG_B_N = 7, 8, 9  # along B = N x e_r, and times P_r, times P . N
ENERGY, FRICTION_LOSS, DAMPING_LOSS, DEEPEST, LINES = 10, 11, 12, 13, 14
SUMS = 15


@inlined
def side_of(sign, angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """The line frame of side `sign` at this pose and motion."""
    cd, sd = data[COS_DELTA], data[SIN_DELTA]
    ca, sa = np.cos(angle), np.sin(angle)
    ecc_e = ca * data[ECCENTRIC_E] - sa * data[ECCENTRIC_Y]
    ecc_y = sa * data[ECCENTRIC_E] + ca * data[ECCENTRIC_Y]
    # gear centre from the rack's reference point
    gx = cd * ecc_e - position[0]
    gy = ecc_y + data[AXIS_OFFSET] - position[1]
    gz = -sd * ecc_e - position[2]
    # the normal: rack -> housing -> pinion frame (e, Y, k)
    bx, by, bz = sign * data[NORMAL_X], -data[NORMAL_Y], -sign * data[NORMAL_Z]
    nx = rotation[0, 0] * bx + rotation[0, 1] * by + rotation[0, 2] * bz
    ny = rotation[1, 0] * bx + rotation[1, 1] * by + rotation[1, 2] * bz
    nz = rotation[2, 0] * bx + rotation[2, 1] * by + rotation[2, 2] * bz
    n_e, n_k = cd * nx - sd * nz, sd * nx + cd * nz
    n_p = np.sqrt(n_e * n_e + ny * ny)
    sin, cos = sign * n_e / n_p, -sign * ny / n_p  # e_t(psi*) = -s N_xy / N_p
    # velocity of the rack relative to the pinion, at the gear's centre
    ux = velocity[0] + spin[1] * gz - spin[2] * gy
    uy = velocity[1] + spin[2] * gx - spin[0] * gz
    uz = velocity[2] + spin[0] * gy - spin[1] * gx
    v_e, v_y, v_z = cd * ux - sd * uz + rate * ecc_y, uy - rate * ecc_e, sd * ux + cd * uz
    w_e, w_y, w_z = cd * spin[0] - sd * spin[2], spin[1], sd * spin[0] + cd * spin[2] - rate
    # the rack's own axes y and z in the pinion frame
    r01, r11, r21 = rotation[0, 1], rotation[1, 1], rotation[2, 1]
    r02, r12, r22 = rotation[0, 2], rotation[1, 2], rotation[2, 2]
    y_e, z_e = cd * r01 - sd * r21, cd * r02 - sd * r22
    v_r, v_t = cos * v_e + sin * v_y, cos * v_y - sin * v_e
    w_r, w_t = cos * w_e + sin * w_y, cos * w_y - sin * w_e
    n_t = -sign * n_p
    return Side(
        sign,
        np.arctan2(sin, cos),
        sin,
        cos,
        n_p,
        n_k,
        data[FLANK_OFFSET] - (nx * gx + ny * gy + nz * gz),
        v_r,
        v_t,
        v_z,
        w_r,
        w_t,
        w_z,
        n_k * v_t - n_t * v_z,
        n_k * w_z + n_t * w_t,
        -n_t * w_r,
        -n_k * w_r,
        n_t * v_t + n_k * v_z,
        n_t * w_z - n_k * w_t,
        n_k * w_r,
        -n_t * w_r,
        r01 * gx + r11 * gy + r21 * gz,
        cos * y_e + sin * r11,
        cos * r11 - sin * y_e,
        sd * r01 + cd * r21,
        r02 * gx + r12 * gy + r22 * gz,
        cos * z_e + sin * r12,
        cos * r12 - sin * z_e,
        sd * r02 + cd * r22,
    )


@inlined
def first_tooth(angle, side, data):  # type: ignore[no-untyped-def]
    """Number of the first tooth whose line lies on the flank, and q*(0) there and per tooth further on."""
    theta = data[THETA] + angle
    if side.sign < 0:
        theta += data[THETA_COAST_TO_DRIVE]
    rb = data[BASE_RADIUS]
    turn, per_tooth = theta - side.psi, 2 * np.pi / data[TEETH]
    reach = rb * (data[HALF_FACE] * abs(data[TWIST]) + MARGIN)
    low, high = (data[Q_FORM] - reach) / rb, (data[Q_TIP] + reach) / rb
    if side.sign > 0:
        tooth = np.ceil((low - turn) / per_tooth)
        last = np.floor((high - turn) / per_tooth)
    else:
        tooth = np.ceil((-high - turn) / per_tooth)
        last = np.floor((-low - turn) / per_tooth)
    return int(tooth), int(last), turn


@inlined
def line_of(tooth, turn, side, data):  # type: ignore[no-untyped-def]
    """The line of one tooth, and the number of the rack's flank that is nearest to it."""
    s, rb, z = side.sign, data[BASE_RADIUS], int(data[TEETH])
    if tooth % z == 0:
        turn += data[PITCH_ERROR]
    q_0 = s * rb * (turn + 2 * np.pi * tooth / z)
    q_1 = -s * rb * data[TWIST]
    d_0 = side.offset + side.n_p * q_0
    d_1 = side.n_p * q_1 - side.n_z
    rack_tooth = -s * np.round(d_0 / data[NORMAL_BASE_PITCH])
    return Line(q_0, q_1, d_0 + s * rack_tooth * data[NORMAL_BASE_PITCH], d_1), int(rack_tooth)


# --- loads -----------------------------------------------------------------------------------------
@inlined
def point(xi, z, line, side, data):  # type: ignore[no-untyped-def]
    """P_r, P_t and the tangent length q."""
    s, rb = side.sign, data[BASE_RADIUS]
    x2 = xi * xi
    cos, sin = 1 - x2 / 2 * (1 - x2 / 12), xi * (1 - x2 / 6 * (1 - x2 / 20))
    along = s * (line.q_0 + line.q_1 * z) - rb * xi
    return rb * cos - along * sin, rb * sin + along * cos, s * along


@inlined
def press(depth, stiffness, p_r, p_t, z, side, data, sums):  # type: ignore[no-untyped-def]
    """Add the load stiffness * (depth + d * its rate) at a point, with its friction."""
    slip_r = side.v_r + side.w_t * z - side.w_z * p_t
    slip_b = side.slip + side.slip_r * p_r + side.slip_t * p_t + side.slip_z * z
    pressing = depth
    if data[DAMPING] > 0:
        approach = side.part + side.part_r * p_r + side.part_t * p_t + side.part_z * z
        pressing += data[DAMPING] * approach
        if not pressing > 0:
            return
        sums[DAMPING_LOSS] += stiffness * (pressing - depth) * approach
    load = stiffness * pressing
    slip = np.sqrt(slip_r * slip_r + slip_b * slip_b)
    drag = data[FRICTION] * load / max(slip, data[ZONE])
    f_r, f_b = drag * slip_r, drag * slip_b
    sums[LOAD] += load
    sums[LOAD_R] += load * p_r
    sums[LOAD_T] += load * p_t
    sums[LOAD_Z] += load * z
    sums[DRAG_R] += f_r
    sums[DRAG_R_T] += f_r * p_t
    sums[DRAG_R_Z] += f_r * z
    sums[DRAG_B] += f_b
    sums[DRAG_B_R] += f_b * p_r
    sums[DRAG_B_N] += f_b * (side.n_z * z - side.sign * side.n_p * p_t)
    sums[ENERGY] += stiffness * depth * depth / 2
    sums[FRICTION_LOSS] += drag * slip * slip


@inlined
def add_side(sums, angle, position, side, data, out):  # type: ignore[no-untyped-def]
    """Add one side's loads to `out` (`wrench` layout): line frame -> housing frame."""
    cd, sd, cos, sin = data[COS_DELTA], data[SIN_DELTA], side.cos, side.sin
    ca, sa = np.cos(angle), np.sin(angle)
    n_t, n_z = -side.sign * side.n_p, side.n_z  # N, and B = (0, n_z, -n_t)
    load, drag = sums[LOAD], sums[DRAG_B]
    # on the pinion, line frame, about the gear's centre; on the rack the opposite
    f_r, f_t, f_z = sums[DRAG_R], n_t * load + n_z * drag, n_z * load - n_t * drag
    m_r = n_z * sums[LOAD_T] - n_t * sums[LOAD_Z] - sums[DRAG_B_N]
    m_t = -n_z * sums[LOAD_R] + n_t * sums[DRAG_B_R] + sums[DRAG_R_Z]
    m_z = n_t * sums[LOAD_R] + n_z * sums[DRAG_B_R] - sums[DRAG_R_T]
    f_e, f_y = cos * f_r - sin * f_t, sin * f_r + cos * f_t
    m_e, m_y = cos * m_r - sin * m_t, sin * m_r + cos * m_t
    ecc_e = ca * data[ECCENTRIC_E] - sa * data[ECCENTRIC_Y]
    ecc_y = sa * data[ECCENTRIC_E] + ca * data[ECCENTRIC_Y]
    out[TORQUE] += m_z + ecc_e * f_y - ecc_y * f_e
    fx, fy, fz = cd * f_e + sd * f_z, f_y, cd * f_z - sd * f_e
    mx, my, mz = cd * m_e + sd * m_z, m_y, cd * m_z - sd * m_e
    gx = cd * ecc_e - position[0]
    gy = ecc_y + data[AXIS_OFFSET] - position[1]
    gz = -sd * ecc_e - position[2]
    out[FORCE.start] -= fx
    out[FORCE.start + 1] -= fy
    out[FORCE.start + 2] -= fz
    out[MOMENT.start] -= mx + gy * fz - gz * fy
    out[MOMENT.start + 1] -= my + gz * fx - gx * fz
    out[MOMENT.start + 2] -= mz + gx * fy - gy * fx
    out[NORMAL_DRIVE if side.sign < 0 else NORMAL_COAST] += load
    out[ELASTIC_ENERGY] += sums[ENERGY]
    out[FRICTION_POWER] += sums[FRICTION_LOSS]
    out[DAMPING_POWER] += sums[DAMPING_LOSS]
    out[PENETRATION] = max(out[PENETRATION], sums[DEEPEST])
    out[TOUCHING] += sums[LINES]
