"""The line along which a plane flank of the rack meets an involute helicoid, and the loads on it.

Line frame of one side: origin in the gear's centre, axes e_r, e_t at the generator psi* whose normal is
parallel to the plane's in the transverse section, and the gear's axis k. With xi = psi - psi*, N the
rack flank's outward normal (tangential part -s N_p, axial part N_z) and q*(Z) = q(psi*, Z):

    P(xi, Z)     = r_b e_r(xi) + (s q* - r_b xi) e_t(xi) + Z k                       point of the flank
    depth(xi, Z) = c + N_p (s r_b (sin xi - xi cos xi) + q* cos xi) - N_z Z          exact for any pose
    dA           = (q* - s r_b xi) / cos beta_b dxi dZ

(derived here from the helicoid of `gears.helicoid`). The depth is linear along a generator xi = const and
close to a parabola across, d depth/d xi = -N_p q sin xi: the contact is a strip along the line xi = 0, the
line of contact.
In the expansions below only powers are left out that the strip's half width, some 0.05, makes < 1e-6.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline
from rps_exudyn.forces.friction import (
    ACROSS,
    ALONG,
    add_point,
    by_load,
    clear_patch,
    coulomb,
    duration,
    on_patch,
    patch_columns,
    slide_patch,
    stribeck,
)
from rps_exudyn.forces.rigid_motion import Vector
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS
from rps_exudyn.tooth_contact import wrench
from rps_exudyn.tooth_contact.flank_strip import MARGIN, SURPLUS, across
from rps_exudyn.tooth_contact.generated_flank import tangent_plane

Coefficients = tuple[float, float, float, float]


class Side(NamedTuple):
    """One side's line frame (r, t, z), and what does not change along its lines.

    Coefficients (c, c_r, c_t, c_z) stand for c + c_r P_r + c_t P_t + c_z Z, see `affine`.
    """

    sign: float  # s
    rate: float  # of the pinion [rad/s]
    psi: float  # psi*
    sin: float  # e_r = (cos, sin), e_t = (-sin, cos) in the (e, Y) plane
    cos: float
    n_p: float  # |transverse part| of the normal; N = (0, -s n_p, n_z)
    n_z: float
    offset: float  # depth of flank j at the gear's centre: offset + s j p_bn
    velocity: Vector  # of the rack relative to the pinion, at the gear's centre
    spin: Vector  # angular velocity of the rack relative to the pinion
    slip: Coefficients  # of the same motion along B = N x e_r
    part: Coefficients  # and along N, which parts the flanks when negative
    y: Coefficients  # the rack's own y coordinate of a point
    z: Coefficients  # and its z coordinate
    along_x: float  # |component| along X of the rack's own normal
    gain: float  # rack's travel per radian of the pinion
    bend: float  # 1 / Q, by which the rack is curved [1/m]; 0 of plane flanks


class Line(NamedTuple):
    """One tooth's line on one side: q*(Z) = q_0 + q_1 Z, depth at xi = 0 is d_0 + d_1 Z."""

    q_0: float
    q_1: float
    d_0: float
    d_1: float
    rack_tooth: float  # number of the rack's tooth that it lies on


class FlankZone(NamedTuple):
    """Part of the flank between two tangent lengths; tip relief is removed above `relief_from`."""

    low: float
    high: float
    relief: float
    relief_from: float


# What the loads of one side add up to, in the line frame about the gear's centre.
LOAD, LOAD_R, LOAD_T, LOAD_Z = 0, 1, 2, 3  # normal loads, and times P_r, P_t, Z
DRAG_R, DRAG_R_T, DRAG_R_Z = 4, 5, 6  # friction on the pinion along e_r, and times P_t, Z
DRAG_B, DRAG_B_R, DRAG_B_N = 7, 8, 9  # along B = N x e_r, and times P_r, times P . N
ENERGY, FRICTION_LOSS, DAMPING_LOSS, DEEPEST, LINES = 10, 11, 12, 13, 14
PER_ROLL = 15  # largest load per length over tangent length
FRICTION_LOST, FRICTION_STORED = 16, 17  # of bristles, work lost so far and energy
SUMS = 18
LEAST_ROLL = 1e-6  # tangent length where pressures are taken at least [m]


@inline
def affine(coefficients, p_r, p_t, z):  # type: ignore[no-untyped-def]
    """The value at a point of the line frame."""
    return coefficients[0] + coefficients[1] * p_r + coefficients[2] * p_t + coefficients[3] * z


@inline
def _to_pinion(x, z, data):  # type: ignore[no-untyped-def]
    """Components along e and k of the pinion frame from those along X and Z of the housing."""
    return data.cos_delta * x - data.sin_delta * z, data.sin_delta * x + data.cos_delta * z


@inline
def _to_line(e, y, sin, cos):  # type: ignore[no-untyped-def]
    """Components along e_r and e_t from those along e and Y."""
    return cos * e + sin * y, cos * y - sin * e


@inline
def gear_centre(angle, position, data):  # type: ignore[no-untyped-def]
    """The gear's centre from its axis of rotation (e, Y), and from the rack's reference point (X, Y, Z)."""
    ca, sa = np.cos(angle), np.sin(angle)
    ecc_e = ca * data.eccentric_e - sa * data.eccentric_y
    ecc_y = sa * data.eccentric_e + ca * data.eccentric_y
    gx = data.cos_delta * ecc_e - position[0]
    gy = ecc_y + data.axis_offset - position[1]
    gz = -data.sin_delta * ecc_e - position[2]
    return ecc_e, ecc_y, gx, gy, gz


@inline
def side_of(sign, angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """The line frame of side `sign` at this pose and motion."""
    ecc_e, ecc_y, gx, gy, gz = gear_centre(angle, position, data)
    along_x, along_y, along_z, offset = data.normal_x, data.normal_y, data.normal_z, data.flank_offset
    gain, bend = data.gain, 0.0
    if data.course_pieces > 0:
        plane = tangent_plane(sign, angle, gx, gy, gz, rotation, data)
        along_x, along_y, along_z, offset = plane.normal_x, plane.normal_y, plane.normal_z, plane.offset
        gain, bend = plane.gain, plane.bend
    # the normal: rack -> housing -> pinion frame (e, Y, k)
    bx, by, bz = sign * along_x, -along_y, -sign * along_z
    nx = rotation[0, 0] * bx + rotation[0, 1] * by + rotation[0, 2] * bz
    ny = rotation[1, 0] * bx + rotation[1, 1] * by + rotation[1, 2] * bz
    nz = rotation[2, 0] * bx + rotation[2, 1] * by + rotation[2, 2] * bz
    n_e, n_k = _to_pinion(nx, nz, data)
    n_p = np.sqrt(n_e * n_e + ny * ny)
    n_t = -sign * n_p
    sin, cos = sign * n_e / n_p, -sign * ny / n_p  # e_t(psi*) = -s N_xy / N_p
    # motion of the rack relative to the pinion, at the gear's centre
    ux = velocity[0] + spin[1] * gz - spin[2] * gy
    uy = velocity[1] + spin[2] * gx - spin[0] * gz
    uz = velocity[2] + spin[0] * gy - spin[1] * gx
    v_e, v_z = _to_pinion(ux, uz, data)
    w_e, w_z = _to_pinion(spin[0], spin[2], data)
    w_z -= rate
    v_r, v_t = _to_line(v_e + rate * ecc_y, uy - rate * ecc_e, sin, cos)
    w_r, w_t = _to_line(w_e, spin[1], sin, cos)
    return Side(
        sign,
        rate,
        np.arctan2(sin, cos),
        sin,
        cos,
        n_p,
        n_k,
        offset - (nx * gx + ny * gy + nz * gz),
        (v_r, v_t, v_z),
        (w_r, w_t, w_z),
        (n_k * v_t - n_t * v_z, n_k * w_z + n_t * w_t, -n_t * w_r, -n_k * w_r),
        (n_t * v_t + n_k * v_z, n_t * w_z - n_k * w_t, n_k * w_r, -n_t * w_r),
        _rack_axis(1, rotation, gx, gy, gz, sin, cos, data),
        _rack_axis(2, rotation, gx, gy, gz, sin, cos, data),
        along_x,
        gain,
        bend,
    )


@inline
def _rack_axis(i, rotation, gx, gy, gz, sin, cos, data):  # type: ignore[no-untyped-def]
    """The rack's own coordinate i of a point, as coefficients."""
    x, y, z = rotation[0, i], rotation[1, i], rotation[2, i]
    e, k = _to_pinion(x, z, data)
    r, t = _to_line(e, y, sin, cos)
    return x * gx + y * gy + z * gz, r, t, k


@inline
def first_tooth(angle, side, data):  # type: ignore[no-untyped-def]
    """Number of the first tooth whose line lies on the flank, and q*(0) there and per tooth further on."""
    theta = data.theta + angle
    if side.sign < 0:
        theta += data.theta_coast_to_drive
    rb = data.base_radius
    turn, per_tooth = theta - side.psi, 2 * np.pi / data.teeth
    reach = rb * (data.half_face * abs(data.twist) + MARGIN)
    low, high = (data.q_form - reach) / rb, (data.q_tip + reach) / rb
    if side.sign > 0:
        tooth = np.ceil((low - turn) / per_tooth)
        last = np.floor((high - turn) / per_tooth)
    else:
        tooth = np.ceil((-high - turn) / per_tooth)
        last = np.floor((-low - turn) / per_tooth)
    return int(tooth), int(last), turn


@inline
def line_of(tooth, turn, side, data):  # type: ignore[no-untyped-def]
    """The line of one tooth against the flank of the rack that is nearest to it."""
    s, rb, p = side.sign, data.base_radius, data.normal_base_pitch
    turn += data.turns[tooth % data.teeth]
    q_0 = s * rb * (turn + 2 * np.pi * tooth / data.teeth)
    q_1 = -s * rb * data.twist
    d_0 = side.offset + side.n_p * q_0
    rack_tooth = -s * np.rint(d_0 / p)
    d_0 += s * rack_tooth * p
    if data.has_rack_errors:
        place = int(rack_tooth) + data.rack_middle
        if 0 <= place <= 2 * data.rack_middle:
            d_0 += s * side.along_x * data.rack_shifts[place]
    return Line(q_0, q_1, d_0, side.n_p * q_1 - side.n_z, rack_tooth)


@inline
def bands(data):  # type: ignore[no-untyped-def]
    """How many bands the flank has: one, or with tip relief two."""
    return 2 if data.relief > 0 else 1


@inline
def band_of(part, data):  # type: ignore[no-untyped-def]
    """The band of the flank below the tip relief, 0, or that with it, 1."""
    if part == 0:
        return FlankZone(data.q_form, min(data.q_tip, data.relief_start), 0.0, 0.0)
    return FlankZone(data.relief_start, data.q_tip, data.relief, data.relief_start)


@inline
def surplus(q, z_squared, band, data):  # type: ignore[no-untyped-def]
    """Surplus of the flank along the transverse tangent, at the tangent length q and the square of Z [m]."""
    relieved = max(q - band.relief_from, 0.0)
    return data.slope * (q - data.q_form) - band.relief * relieved * relieved - data.crowning * z_squared


@inline
def band_on_flank(line, band, data):  # type: ignore[no-untyped-def]
    """The band with its ends where the modified flank meets form and tip circle.

    A surplus along the tangent brings the flank to the circle at a shorter tangent length of the perfect one.
    Crowning is taken where the line of contact crosses the circle; it changes too little across the strip.
    """
    if data.crowning == 0 and data.slope == 0 and band.relief == 0:
        return band
    low, high = band.low, band.high
    if low == data.q_form:
        low += data.crowning * _crossing_place(low, line, data)
    if high == data.q_tip:
        grown = surplus(high, _crossing_place(high, line, data), band, data)
        high -= grown / (1 + data.slope - 2 * band.relief * (high - band.relief_from))
    return FlankZone(low, high, band.relief, band.relief_from)


@inline
def _crossing_place(q, line, data):  # type: ignore[no-untyped-def]
    """Square of the Z where a line has the tangent length q, within the face."""
    z, b = (q - line.q_0) / line.q_1, data.half_face
    return z * z if abs(z) < b else b * b


# --- loads -----------------------------------------------------------------------------------------
@inline
def point(xi, z, line, side, data):  # type: ignore[no-untyped-def]
    """P_r, P_t and the tangent length q."""
    s, rb = side.sign, data.base_radius
    x2 = xi * xi
    cos, sin = 1 - x2 / 2 * (1 - x2 / 12), xi * (1 - x2 / 6 * (1 - x2 / 20))
    along = s * (line.q_0 + line.q_1 * z) - rb * xi
    return rb * cos - along * sin, rb * sin + along * cos, s * along


@inline
def formed_point(xi, z, strip, line, side, data):  # type: ignore[no-untyped-def]
    """P_r, P_t on the modified flank that a strip describes and the tangent length q of the perfect one."""
    p_r, p_t, q = point(xi, z, line, side, data)
    c_0, c_1, c_2 = across(strip, SURPLUS, z)
    along = side.sign * (c_0 + xi * (c_1 + xi * c_2))
    return p_r - along * xi, p_t + along, q


@inline
def add_load(load, p_r, p_t, z, side, data, work):  # type: ignore[no-untyped-def]
    """Add a normal load at a point, with its friction."""
    slip_r, slip_b = slip_at(p_r, p_t, z, side)
    slip = np.sqrt(slip_r * slip_r + slip_b * slip_b)
    if data.law.has_state:
        w_r, w_b = rolling_slip(p_r, p_t, side, data)
        along, across = slip_in_step(p_r, p_t, z, side, data, work)
        weight = add_point(load, along, across, data.law, work.rubbed)
        _add_direction(ALONG, weight * w_r, weight * w_b, p_r, p_t, z, side, work)
        _add_direction(ACROSS, -weight * w_b, weight * w_r, p_r, p_t, z, side, work)
        f_r = f_b = lost = 0.0
    else:
        drag = coulomb(load, data.friction, slip, data.zone) * stribeck(slip, data.law)
        f_r, f_b, lost = drag * slip_r, drag * slip_b, drag * slip * slip
    work.sums[LOAD] += load
    work.sums[LOAD_R] += load * p_r
    work.sums[LOAD_T] += load * p_t
    work.sums[LOAD_Z] += load * z
    work.sums[DRAG_R] += f_r
    work.sums[DRAG_R_T] += f_r * p_t
    work.sums[DRAG_R_Z] += f_r * z
    work.sums[DRAG_B] += f_b
    work.sums[DRAG_B_R] += f_b * p_r
    work.sums[DRAG_B_N] += f_b * (side.n_z * z - side.sign * side.n_p * p_t)
    work.sums[FRICTION_LOSS] += lost


@inline
def slip_at(p_r, p_t, z, side):  # type: ignore[no-untyped-def]
    """Return the slip velocity at a point of the line frame, along e_r and B."""
    return side.velocity[0] + side.spin[1] * z - side.spin[2] * p_t, affine(side.slip, p_r, p_t, z)


@inline
def slip_in_step(p_r, p_t, z, side, data, work):  # type: ignore[no-untyped-def]
    """Return the slip velocity along the rolling slip and across it where the point of contact, which moves
    along the path of contact, was in the middle of the step."""
    p_t -= data.base_radius * side.rate * duration(work.memory) / 2
    slip_r, slip_b = slip_at(p_r, p_t, z, side)
    w_r, w_b = rolling_slip(p_r, p_t, side, data)
    return w_r * slip_r + w_b * slip_b, w_r * slip_b - w_b * slip_r


@inline
def _add_direction(first, f_r, f_b, p_r, p_t, z, side, work):  # type: ignore[no-untyped-def]
    """Add friction at a point to the sums of a patch, in the order of the sums of drag."""
    sums = work.rubbed
    sums[first] += f_r
    sums[first + 1] += f_r * p_t
    sums[first + 2] += f_r * z
    sums[first + 3] += f_b
    sums[first + 4] += f_b * p_r
    sums[first + 5] += f_b * (side.n_z * z - side.sign * side.n_p * p_t)


@inline
def rolling_slip(p_r, p_t, side, data):  # type: ignore[no-untyped-def]
    """Direction of the slip at a point while pinion and rack run steadily, components along e_r and B.

    Bristles of one side share their forces along it and across: it differs from point to point, and what they
    share must not, or they would lose torque.
    """
    v_e, v_z = data.cos_delta * side.gain, data.sin_delta * side.gain
    r = side.cos * v_e - p_t
    b = side.n_z * (p_r - side.sin * v_e) + side.sign * side.n_p * v_z
    size = np.sqrt(r * r + b * b)
    return (r / size, b / size) if size > 0 else (1.0, 0.0)


@inline
def patch_of(side, data):  # type: ignore[no-untyped-def]
    """Place of one side's bristles in the state."""
    return data.law.place + (patch_columns(data.law.elements) if side.sign > 0 else 0)


@inline
def begin_side(side, data, work):  # type: ignore[no-untyped-def]
    """Begin to add up one side's loads."""
    for i in range(SUMS):
        work.sums[i] = 0.0
    if data.law.has_state:
        clear_patch(work.rubbed)


@inline
def _end_friction(side, data, work):  # type: ignore[no-untyped-def]
    """Give the friction the size that belongs to the side's whole load, or find that of its bristles."""
    law = data.law
    if law.has_state:
        power, stored, lost = slide_patch(data.friction, patch_of(side, data), law, work.memory, work.rubbed)
        for i in range(ACROSS - ALONG):
            work.sums[DRAG_R + i] = on_patch(i, work.rubbed)
        work.sums[FRICTION_LOSS] = power
        work.sums[ENERGY] += stored
        work.sums[FRICTION_LOST], work.sums[FRICTION_STORED] = lost, stored
        return
    factor = by_load(work.sums[LOAD], law)
    if factor != 1.0:
        for i in range(DRAG_R, DRAG_B_N + 1):
            work.sums[i] *= factor
        work.sums[FRICTION_LOSS] *= factor


@inline
def note_line_load(load_per_length, q, work):  # type: ignore[no-untyped-def]
    """Keep the largest load per length over tangent length [N/m^2]: Hertz's pressure is its root."""
    work.sums[PER_ROLL] = max(work.sums[PER_ROLL], load_per_length / max(q, LEAST_ROLL))


@inline
def add_side(work, angle, position, side, data, out):  # type: ignore[no-untyped-def]
    """Add one side's loads to `out` (`wrench` layout): line frame -> housing frame."""
    _end_friction(side, data, work)
    cd, sd, cos, sin = data.cos_delta, data.sin_delta, side.cos, side.sin
    ecc_e, ecc_y, gx, gy, gz = gear_centre(angle, position, data)
    n_t, n_z = -side.sign * side.n_p, side.n_z  # N, and B = (0, n_z, -n_t)
    load, drag = work.sums[LOAD], work.sums[DRAG_B]
    # on the pinion, line frame, about the gear's centre; on the rack the opposite
    f_r, f_t, f_z = work.sums[DRAG_R], n_t * load + n_z * drag, n_z * load - n_t * drag
    m_r = n_z * work.sums[LOAD_T] - n_t * work.sums[LOAD_Z] - work.sums[DRAG_B_N]
    m_t = -n_z * work.sums[LOAD_R] + n_t * work.sums[DRAG_B_R] + work.sums[DRAG_R_Z]
    m_z = n_t * work.sums[LOAD_R] + n_z * work.sums[DRAG_B_R] - work.sums[DRAG_R_T]
    f_e, f_y = cos * f_r - sin * f_t, sin * f_r + cos * f_t
    m_e, m_y = cos * m_r - sin * m_t, sin * m_r + cos * m_t
    out[wrench.TORQUE] += m_z + ecc_e * f_y - ecc_y * f_e
    fx, fy, fz = cd * f_e + sd * f_z, f_y, cd * f_z - sd * f_e
    mx, my, mz = cd * m_e + sd * m_z, m_y, cd * m_z - sd * m_e
    out[wrench.FORCE.start] -= fx
    out[wrench.FORCE.start + 1] -= fy
    out[wrench.FORCE.start + 2] -= fz
    out[wrench.MOMENT.start] -= mx + gy * fz - gz * fy
    out[wrench.MOMENT.start + 1] -= my + gz * fx - gx * fz
    out[wrench.MOMENT.start + 2] -= mz + gx * fy - gy * fx
    out[wrench.NORMAL_DRIVE if side.sign < 0 else wrench.NORMAL_COAST] += load
    out[wrench.ELASTIC_ENERGY] += work.sums[ENERGY]
    out[wrench.FRICTION_POWER] += work.sums[FRICTION_LOSS]
    out[wrench.DAMPING_POWER] += work.sums[DAMPING_LOSS]
    out[wrench.FRICTION_LOST] += work.sums[FRICTION_LOST]
    out[wrench.FRICTION_STORED] += work.sums[FRICTION_STORED]
    out[wrench.PENETRATION] = max(out[wrench.PENETRATION], work.sums[DEEPEST])
    out[wrench.TOUCHING] += work.sums[LINES]
    # Hertz: p^2 = f E* / (pi rho) with rho = q / cos(beta_b)
    pressure = np.sqrt(work.sums[PER_ROLL] * EFFECTIVE_MODULUS * data.cos_base_helix / np.pi)
    out[wrench.PRESSURE] = max(out[wrench.PRESSURE], pressure)


# --- flanks without modifications ------------------------------------------------------------------
# Without relief, crowning and slope the crest of the strip stands on xi = 0. There the depth, the distances
# to the limits of the flank and to the rack's tips are linear in Z, and the bar's surface is a parabola: the
# laws that take loads at the crest need no strip.


@inline
def clip(low, high, c_0, c_1, c_2):  # type: ignore[no-untyped-def]
    """The part of an interval where c_0 + c_1 Z + c_2 Z^2 > 0, c_2 <= 0."""
    square = c_1 * c_1 - 4 * c_2 * c_0
    if not square > 0:
        return (low, high) if c_1 == 0 and c_2 == 0 and c_0 > 0 else (1.0, -1.0)
    q = -(c_1 + np.copysign(np.sqrt(square), c_1)) / 2
    for root in (c_0 / q, q / c_2):
        rise = c_1 + 2 * c_2 * root
        if rise > 0:
            low = max(low, root)
        elif rise < 0:
            high = min(high, root)
    return low, high


@inline
def is_measured(data):  # type: ignore[no-untyped-def]
    """Return whether a flank of pinion or rack is given by a grid."""
    return data.pinion_grid.is_given + data.rack_grid.is_given > 0


@inline
def is_plain(data):  # type: ignore[no-untyped-def]
    """Return whether the flanks are unmodified."""
    return data.relief == 0 and data.crowning == 0 and data.slope == 0 and not is_measured(data)


@inline
def plain_point(z, line, side, data):  # type: ignore[no-untyped-def]
    """P_r, P_t, the tangent length q and the depth at Z."""
    q = line.q_0 + line.q_1 * z
    return data.base_radius, side.sign * q, q, line.d_0 + line.d_1 * z


@inline
def on_plain_line(coefficients, line, side, data):  # type: ignore[no-untyped-def]
    """An affine function of the point along the line: at Z = 0, and its slope."""
    at_middle = affine(coefficients, data.base_radius, side.sign * line.q_0, 0.0)
    return at_middle, coefficients[2] * side.sign * line.q_1 + coefficients[3]


class Turning(NamedTuple):
    """Where the flanks slide slowest along a line: with parallel axes, where sliding turns about."""

    z: float  # nan where nothing slides, or lines are taken whole
    p_t: float
    p_t_z: float  # change of that along the line with Z ...
    r_z: float  # ... of the slip along e_r ...
    b_z: float  # ... and along B


@inline
def turning_of(line, side, data):  # type: ignore[no-untyped-def]
    """Return a line's `Turning`: both components of the slip are linear in Z."""
    if not data.breaks_sliding:
        return Turning(np.nan, np.nan, 0.0, 0.0, 0.0)
    r, r_z = side.velocity[0] - side.spin[2] * side.sign * line.q_0, side.spin[1]
    r_z -= side.spin[2] * side.sign * line.q_1
    b, b_z = on_plain_line(side.slip, line, side, data)
    square = r_z * r_z + b_z * b_z
    z = -(r * r_z + b * b_z) / square if square > 0 else np.nan
    return Turning(z, side.sign * (line.q_0 + line.q_1 * z), side.sign * line.q_1, r_z, b_z)


@inline
def turning_end(from_, to, turning):  # type: ignore[no-untyped-def]
    """Return 1 over the width of a piece of a line that ends where sliding turns about, -1 over it of one
    that begins there, else 0 [1/m]."""
    if to == turning.z:
        return 1.0 / (to - from_)
    return -1.0 / (to - from_) if from_ == turning.z else 0.0


@inline
def plain_ends(line, margin, side, data):  # type: ignore[no-untyped-def]
    """Return between which Z the flanks are pressed, `margin` deeper than they are; low > high if nowhere."""
    pressing, per_z = line.d_0 + margin, line.d_1
    if data.damping > 0:
        rate, rate_per_z = on_plain_line(side.part, line, side, data)
        pressing, per_z = pressing + data.damping * rate, per_z + data.damping * rate_per_z
    low, high = _above(-data.half_face, data.half_face, pressing, per_z)
    low, high = _above(low, high, line.q_0 - data.q_form, line.q_1)
    low, high = _above(low, high, data.q_tip - line.q_0, -line.q_1)
    y, y_z = on_plain_line(side.y, line, side, data)
    low, high = _above(low, high, y + data.tip_depth, y_z)
    z, z_z = on_plain_line(side.z, line, side, data)
    bar = data.bar_radius * data.bar_radius - y * y - z * z
    return clip(low, high, bar, -2 * (y * y_z + z * z_z), -(y_z * y_z + z_z * z_z))


@inline
def _above(low, high, value, per_z):  # type: ignore[no-untyped-def]
    """The part of an interval where a linear function is positive."""
    zero = -value / per_z
    if per_z > 0:
        return max(low, zero), high
    if per_z < 0:
        return low, min(high, zero)
    return (low, high) if value > 0 else (high, low)
