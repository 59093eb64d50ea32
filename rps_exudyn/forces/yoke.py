"""The yoke: a plunger that presses the rack into the mesh, its spring, and the yokenut behind it.

          yokenut (locked to the housing)
         ----------------   clearance, damped contact
        o | plunger    | o  spring, preload P at rest; O-rings in the bore that rub and damp
          |  .-~~~~-.  |
            (  rack  )      cylindrical seat, half angle phi_s, Coulomb friction
             `-....-'
       teeth   \\/\\/\\/

The plunger slides along Y only; its coordinate counts from the preloaded rest position. Seat and yokenut
press with k (d + tau d') at the depth d, never with less than nothing; what tau takes is lost.

The seat's arc has the bar's radius and a clearance c more. At the angle theta its depth under a bar displaced
by (y, z) from where it touches without load is, by theta_g = 0 of a round seat and 45 degrees of a gothic
arch, whose two arcs have their centres beside the middle,

    d = y cos(theta) + z sin(theta) - c (1 - cos(|theta| - theta_g))
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from rps_exudyn.base.compiled import inline, kernel, record, record_type, stacked
from rps_exudyn.forces.force_element import FRICTION_STATE, Part
from rps_exudyn.forces.friction import (
    ACROSS,
    ALONG,
    FRICTION_ACROSS,
    FRICTION_ALONG,
    LAW,
    WEIGHT,
    WHOLE_LOAD,
    Patches,
    add_direction,
    add_point,
    by_load,
    clear_patch,
    constant_law,
    coulomb,
    law_of,
    on_patch,
    patch_slopes,
    rubbing,
    slide,
    slide_patch,
    slide_slopes,
    stribeck,
)
from rps_exudyn.forces.rigid_motion import (
    cross,
    dot,
    minus,
    on_angles,
    plus,
    scaled,
    spin_of,
    turn_of,
    vector,
)
from rps_exudyn.parameters.gear import SteeringGear

ARC_POINTS, LENGTH_POINTS = 6, 2  # Gauss points of a seat that touches everywhere: to 1e-9
PIECE_POINTS = 10  # of each piece of the arc where part of the seat touches: to 1e-5


WHOLE = ARC_POINTS * LENGTH_POINTS  # points of a seat that touches everywhere
PIECES = 5  # of the arc at most
MOST_ENDS = PIECES + 1
MOST_POINTS = 2 * PIECES * PIECE_POINTS * LENGTH_POINTS  # of both arcs of a gothic arch
GOTHIC_ANGLE = np.pi / 4  # at which the arcs of a gothic arch touch, as of ball screws
LEAST_LOAD = 1.0  # at which the share of the seat that touches is found [N]

SEAT = record_type(
    [
        ("bar_radius", "f8"),
        ("friction", "f8"),
        ("zone", "f8"),  # friction zone [m/s]
        ("rest_gap", "f8"),  # Y of the plunger's zero above that of the rack: both rest at the preload [m]
        ("half_angle", "f8"),  # of the arc [rad]
        ("edge_y", "f8"),  # its cosine ...
        ("edge_z", "f8"),  # ... and sine
        ("half_length", "f8"),  # along the rack [m]
        ("density", "f8"),  # stiffness per angle and length [N/m per rad m]
        ("points", "f8", (WHOLE, 4)),  # of the whole seat, rows as `seat_points` fills them
        ("law", LAW),
        ("damping", "f8"),  # over stiffness [s]
        ("back", "f8"),  # slope of the bar's back against its axis
        ("tilt", "f8"),  # by which the plunger follows the bar's slope in its bore, at most [rad]
        ("clearance", "f8"),  # of the arc's radius to the bar's [m]
        ("over_y", "f8"),  # of the bar, at rest without load, over an arc's centre along Y [m]
        ("over_z", "f8"),  # and along Z, of both arcs of a gothic arch; else 0 [m]
    ]
)
"""Record of a cylindrical seat fixed to the plunger, with its Gauss points where all of it touches."""

SPRING = record_type([("rate", "f8"), ("preload", "f8")])  # [N/m], [N]
NUT = record_type([("stiffness", "f8"), ("clearance", "f8"), ("damping", "f8")])  # [N/m], [m], [s]
BORE = record_type([("friction", "f8"), ("damping", "f8"), ("law", LAW)])  # [N], [N s/m]

SEAT_PART = Part("seat", ("rack", "plunger"), ("seat_normal_force", "seat_force", *FRICTION_STATE))
SPRING_PART = Part("yoke_spring", ("plunger",), ("spring_force",))
NUT_PART = Part("yokenut", ("plunger",), ("yokenut_force",))
BORE_PART = Part("bore", ("plunger",), ("bore_force", *FRICTION_STATE))

# Gauss rules of the whole arc, of a piece of it and along the rack, over -1 .. 1: points and weights
WHOLE_ARC, WHOLE_ARC_WEIGHT = leggauss(ARC_POINTS)
ARC, ARC_WEIGHT = leggauss(PIECE_POINTS)
LENGTH, LENGTH_WEIGHT = leggauss(LENGTH_POINTS)


# The bar's axis stands at gap + station * slope, both (y, z), against that of the seat.


@inline
def touches_everywhere(gap, slope, data):  # type: ignore[no-untyped-def]
    """Return whether all of a round seat touches: if its four corners do, for its arc is no half circle."""
    if data.over_z > 0:
        return False
    for station in (-data.half_length, data.half_length):
        y, z = gap[0] + station * slope[0] + data.over_y, gap[1] + station * slope[1]
        if y * data.edge_y - abs(z) * data.edge_z <= data.clearance:
            return False
    return True


@inline
def touching_stations(angle, gap, slope, clearance, half_length):  # type: ignore[no-untyped-def]
    """Return the stations between which the seat touches at an angle of its arc; depth is linear there."""
    middle = gap[0] * np.cos(angle) + gap[1] * np.sin(angle) - clearance
    rise = slope[0] * np.cos(angle) + slope[1] * np.sin(angle)
    low, high = -half_length, half_length
    if abs(rise) * half_length <= abs(middle):
        return (low, high) if middle > 0 else (0.0, 0.0)
    zero = -middle / rise
    return (zero, high) if rise > 0 else (low, zero)


@inline
def arc_pieces(gap, slope, low, high, data, pieces):  # type: ignore[no-untyped-def]
    """Fill the angles from low to high between which the touching part changes smoothly, rising; return how
    many pieces.

    It changes its shape where an end face begins or ceases to touch: where the bar's axis, at the distance a
    from the arc's centre, is as deep as the clearance, arccos(c / a) from where it is deepest.
    """
    pieces[0], count = low, 1
    for station in (-data.half_length, data.half_length):
        y, z = gap[0] + station * slope[0], gap[1] + station * slope[1]
        beside = np.sqrt(y * y + z * z)
        if beside < data.clearance:
            continue
        deepest, turned = np.arctan2(z, y), 0.5 * np.pi
        if data.clearance > 0:
            turned = np.arccos(data.clearance / beside)
        for turn in (turned - 2 * np.pi, -turned, turned, 2 * np.pi - turned):
            if low < deepest + turn < high and count < 5:
                place = count
                while pieces[place - 1] > deepest + turn:
                    pieces[place] = pieces[place - 1]
                    place -= 1
                pieces[place], count = deepest + turn, count + 1
    pieces[count] = high
    return count


@inline
def seat_points(gap, slope, data, points):  # type: ignore[no-untyped-def]
    """Fill Gauss points of the touching part, rows (normal y, normal z, station [m], stiffness [N/m]);
    return their number."""
    if touches_everywhere(gap, slope, data):
        for i in range(WHOLE):
            for k in range(4):
                points[i, k] = data.points[i, k]
        return WHOLE
    return part_points(gap, slope, data, points)


@kernel
def part_points(gap, slope, data, points):  # type: ignore[no-untyped-def]
    """Fill the points of a seat of which a part touches; return their number."""
    pieces, n = stacked(MOST_ENDS), 0
    arcs = 2 if data.over_z > 0 else 1
    for arc in range(arcs):
        side = 0 if arcs == 1 else 2 * arc - 1
        first = 0.0 if side > 0 else -data.half_angle
        last = 0.0 if side < 0 else data.half_angle
        beside = (gap[0] + data.over_y, gap[1] + side * data.over_z)
        for piece in range(arc_pieces(beside, slope, first, last, data, pieces)):
            middle, half = (pieces[piece + 1] + pieces[piece]) / 2, (pieces[piece + 1] - pieces[piece]) / 2
            for i in range(PIECE_POINTS):
                angle = middle + half * ARC[i]
                low, high = touching_stations(angle, beside, slope, data.clearance, data.half_length)
                for j in range(LENGTH_POINTS):
                    points[n, 0], points[n, 1] = np.cos(angle), np.sin(angle)
                    points[n, 2] = (high + low) / 2 + (high - low) / 2 * LENGTH[j]
                    area = half * ARC_WEIGHT[i] * (high - low) / 2 * LENGTH_WEIGHT[j]
                    points[n, 3] = data.density * area
                    n += 1
    return n


@inline
def deeper_by_form(ny, nz, data):  # type: ignore[no-untyped-def]
    """Return what the seat's form adds to the depth at an angle, 0 or less [m]."""
    return data.over_y * ny + data.over_z * abs(nz) - data.clearance


@inline
def seat_stance(q, v, plunger, data, points):  # type: ignore[no-untyped-def]
    """How the bar stands in its seat: the rack's turn and spin, its slopes, the plunger's tilt; fills the
    Gauss points and returns their number behind."""
    turn = turn_of(q[3:6])
    slope_y, slope_z = turn.axis[1] / turn.axis[0] + data.back, turn.axis[2] / turn.axis[0]
    gap = (q[1] - q[0] * slope_y - plunger + data.rest_gap, q[2] - q[0] * slope_z)
    # a plunger with play in its bore lies along the bar, until it touches the bore: then it bears a moment
    tilt = min(max(slope_y, -data.tilt), data.tilt)
    count = seat_points(gap, (slope_y - tilt, slope_z), data, points)
    return turn, spin_of(turn, v[3:6]), slope_y, slope_z, tilt, count


@inline
def _whole_load(points, count, q, axis, tilt, data):  # type: ignore[no-untyped-def]
    """Sum of the seat's normal forces [N]."""
    total = 0.0
    for i in range(count):
        along, rise = (points[i, 2] - q[0]) / axis[0], data.back * (points[i, 2] - q[0])
        depth = (q[1] + along * axis[1] + rise - points[i, 2] * tilt - q[6] + data.rest_gap) * points[i, 0]
        depth += (q[2] + along * axis[2]) * points[i, 1] + deeper_by_form(points[i, 0], points[i, 1], data)
        total += points[i, 3] * max(depth, 0.0)
    return total


@inline
def seat_force(q, v, data, memory, rubbed, points, out):  # type: ignore[no-untyped-def]
    """Penalty contact of the seat with the back of the bar; q = rack (6), plunger (1), fills out (14,).

    It is integrated over the part that touches, which a tilted or shifted bar leaves; `points` is work space,
    and `rubbed` takes the sums over the patch of bristles.
    """
    for i in range(14):
        out[i] = 0.0
    turn, omega, slope_y, slope_z, tilt, count = seat_stance(q, v, q[6], data, points)
    axis_x, axis_y, axis_z = turn.axis
    moment_x = moment_y = moment_z = 0.0
    law, friction = data.law, data.friction
    if law.has_state:
        clear_patch(rubbed)
    elif law.load_exponent != 1.0:
        friction *= by_load(_whole_load(points, count, q, turn.axis, tilt, data), law)
    for i in range(count):
        ny, nz = points[i, 0], points[i, 1]
        # the point of the bar's axis that stands at this station of the housing
        along = (points[i, 2] - q[0]) / axis_x
        ay, az = along * axis_y + data.back * (points[i, 2] - q[0]), along * axis_z
        depth = (q[1] + ay - points[i, 2] * tilt - q[6] + data.rest_gap) * ny + (q[2] + az) * nz
        depth += deeper_by_form(ny, nz, data)
        if depth <= 0:
            continue
        elastic = load = points[i, 3] * depth
        # across the tilted bar, so that sliding along it does no work against the load
        nx = -(slope_y * ny + slope_z * nz)
        lx, ly, lz = along * axis_x, ay + data.bar_radius * ny, az + data.bar_radius * nz
        if data.damping > 0:
            ux, uy = v[0] + omega[1] * az - omega[2] * ay, v[1] - v[6] + omega[2] * lx - omega[0] * az
            deeper = ux * nx + uy * ny + (v[2] + omega[0] * ay - omega[1] * lx) * nz
            load = max(elastic + points[i, 3] * data.damping * deeper, 0.0)
            out[9] += (load - elastic) * deeper
        # slip of the bar's surface over the seat: its velocity less the part along the normal
        vx = v[0] + omega[1] * lz - omega[2] * ly
        vy = v[1] - v[6] + omega[2] * lx - omega[0] * lz
        vz = v[2] + omega[0] * ly - omega[1] * lx
        parting = (vx * nx + vy * ny + vz * nz) / (1 + nx * nx)
        vx, vy, vz = vx - parting * nx, vy - parting * ny, vz - parting * nz
        speed = np.sqrt(vx * vx + vy * vy + vz * vz)
        if law.has_state:
            # along the bar's surface and around it
            size = np.sqrt(1 + nx * nx)
            along_bar, around = (vx - nx * (vy * ny + vz * nz)) / size, vz * ny - vy * nz
            weight = add_point(load, along_bar, around, law, rubbed)
            on, beside = (1 / size, -nx * ny / size, -nx * nz / size), (0.0, -nz, ny)
            add_direction(ALONG, weight, on, cross((lx, ly, lz), on), rubbed)
            add_direction(ACROSS, weight, beside, cross((lx, ly, lz), beside), rubbed)
            fx = fy = fz = lost = 0.0
        else:
            drag = coulomb(load, friction, speed, data.zone) * stribeck(speed, law)
            fx, fy, fz = -drag * vx, -drag * vy, -drag * vz
            lost = drag * speed**2
        px, py, pz = -load * nx, -load * ny, -load * nz
        out[0] += fx + px
        out[1] += fy + py
        out[2] += fz + pz
        # friction acts on the surface, the load passes through the axis
        moment_x += ly * fz - lz * fy + ay * pz - az * py
        moment_y += lz * fx - lx * fz + az * px - lx * pz
        moment_z += lx * fy - ly * fx + lx * py - ay * px
        out[7] += 0.5 * elastic * depth
        out[8] += lost
        out[10] += load
        out[11] += load * ny
    if law.has_state:
        out[8], out[13], out[12] = slide_patch(friction, law.place, law, memory, rubbed)
        out[7] += out[13]
        for i in range(3):
            out[i] -= on_patch(i, rubbed)
        moment_x -= on_patch(3, rubbed)
        moment_y -= on_patch(4, rubbed)
        moment_z -= on_patch(5, rubbed)
    out[3], out[4], out[5] = on_angles(turn, (moment_x, moment_y, moment_z))
    out[6] = -out[1]


@inline
def add_seat_outer(tangent, factor, force, moment, plunger, by_force, by_moment, by_plunger):  # type: ignore[no-untyped-def]
    """Add factor times the product of two wrenches on rack and plunger to a tangent (7, 7)."""
    a = (force[0], force[1], force[2], moment[0], moment[1], moment[2], plunger)
    b = (by_force[0], by_force[1], by_force[2], by_moment[0], by_moment[1], by_moment[2], by_plunger)
    for i in range(7):
        for j in range(7):
            tangent[i, j] += factor * a[i] * b[j]


@inline
def add_seat_tangent(q, v, data, memory, rubbed, points, factor_q, factor_v, tangent, of_loads):  # type: ignore[no-untyped-def]
    """Add factor_q dF/dq + factor_v dF/dv of the seat on rack and plunger to a tangent (7, 7); fill
    `of_loads` (2, 7) with factor_q times the derivatives of its own outputs.

    A point under the load k depth acts on the bar along its normal n, its friction against the slip's
    direction t: -k (n + f t) w . dq with the wrench w of n, and its friction changes with the slip. Without
    a state, all friction changes with the whole load.
    """
    turn, omega, slope_y, slope_z, tilt, count = seat_stance(q, v, q[6], data, points)
    law, axis, friction, per_load = data.law, turn.axis, data.friction, 0.0
    if law.load_exponent != 1.0 and not law.has_state:
        whole = _whole_load(points, count, q, axis, tilt, data)
        friction *= by_load(whole, law)
        per_load = (law.load_exponent - 1.0) / whole if whole > 0 else 0.0
    rubs = rub_moments = (0.0, 0.0, 0.0)  # friction of all points, and its moment
    for i in range(7):
        of_loads[0, i] = of_loads[1, i] = 0.0
    for i in range(count):
        ny, nz, stiffness = points[i, 0], points[i, 1], points[i, 3]
        arm = scaled((points[i, 2] - q[0]) / axis[0], axis)
        arm = plus(arm, (0.0, data.back * (points[i, 2] - q[0]), 0.0))
        depth = (q[1] + arm[1] - points[i, 2] * tilt - q[6] + data.rest_gap) * ny + (q[2] + arm[2]) * nz
        depth += deeper_by_form(ny, nz, data)
        if depth <= 0:
            continue
        normal = (-(slope_y * ny + slope_z * nz), ny, nz)
        surface = plus(arm, (0.0, data.bar_radius * ny, data.bar_radius * nz))
        slip = plus(minus(vector(v[0:3]), (0.0, v[6], 0.0)), cross(omega, surface))
        # along the bar and around it
        ahead_of, around = (1.0, -normal[0] * ny, -normal[0] * nz), (0.0, -nz, ny)
        along, across = dot(slip, ahead_of), dot(slip, around)
        if law.has_state:
            g, weight = stribeck(np.sqrt(along * along + across * across), law), rubbed[WEIGHT]
            f_a, f_b = g * rubbed[FRICTION_ALONG] / weight, g * rubbed[FRICTION_ACROSS] / weight
            ahead, aside, d_a, d_b = 0.0, 0.0, 1.0, 0.0
        else:
            f_a, f_b, ahead, aside, d_a, d_b = rubbing(along, across, friction, data.zone, law)
        rub = plus(scaled(f_a, ahead_of), scaled(f_b, around))
        moment = cross(arm, normal)
        deeper = (normal[0], normal[1], normal[2], moment[0], moment[1], moment[2], -ny)
        load, factor = stiffness * depth, factor_q
        if data.damping > 0:
            rate = dot(normal, plus(vector(v[0:3]), (0.0, -v[6], 0.0))) + dot(moment, omega)
            load, factor = load + stiffness * data.damping * rate, factor_q + factor_v * data.damping
            if load <= 0:
                continue
        for j in range(7):
            of_loads[0, j] += factor * stiffness * deeper[j]
            of_loads[1, j] += factor * stiffness * ny * deeper[j]
        add_seat_outer(
            tangent,
            -factor * stiffness,
            plus(normal, rub),
            plus(moment, cross(surface, rub)),
            -ny - rub[1],
            normal,
            moment,
            -ny,
        )
        rubs = plus(rubs, scaled(load, rub))
        rub_moments = plus(rub_moments, scaled(load, cross(surface, rub)))
        drag = -factor_v * load
        if drag != 0 and not law.has_state:
            on, beside = scaled(d_a, ahead_of), scaled(d_a, around)
            on, beside = plus(on, scaled(d_b, around)), plus(beside, scaled(-d_b, ahead_of))
            if ahead != 0:
                moment = cross(surface, on)
                add_seat_outer(tangent, drag * ahead, on, moment, -on[1], on, moment, -on[1])
            moment = cross(surface, beside)
            add_seat_outer(tangent, drag * aside, beside, moment, -beside[1], beside, moment, -beside[1])
    if per_load != 0:
        by_force, by_moment = vector(of_loads[0, :3]), vector(of_loads[0, 3:6])
        at = rubs, rub_moments, -rubs[1]
        add_seat_outer(tangent, -per_load, *at, by_force, by_moment, of_loads[0, 6])
    if law.has_state:
        k_aa, k_ab, k_ba, k_bb, p_a, p_b = patch_slopes(friction, law.place, law, memory, rubbed)
        g = rubbed[WEIGHT] / rubbed[WHOLE_LOAD] if rubbed[WEIGHT] > 0 else 0.0
        for i in range(7):
            on_a = rubbed[ALONG + i] if i < 6 else -rubbed[ALONG + 1]
            on_b = rubbed[ACROSS + i] if i < 6 else -rubbed[ACROSS + 1]
            for j in range(7):
                by_a = rubbed[ALONG + j] if j < 6 else -rubbed[ALONG + 1]
                by_b = rubbed[ACROSS + j] if j < 6 else -rubbed[ACROSS + 1]
                slip_a, slip_b = k_aa * by_a + k_ab * by_b, k_ba * by_a + k_bb * by_b
                tangent[i, j] -= factor_v * (on_a * slip_a + on_b * slip_b)
                tangent[i, j] -= (on_a * p_a + on_b * p_b) * g * of_loads[0, j]


def seat_record(
    gear: SteeringGear, *, friction_zone: float, rest_gap: float, patches: Patches | None = None
) -> np.record:
    """Return the record of the contact of the plunger's seat with the back of the rack.

    Its pressure per depth is such that a seat without clearance has `yoke.seat_stiffness` along the yoke
    axis.
    """
    yoke, touches = gear.yoke, touching_angle(gear)
    s, ws = LENGTH, LENGTH_WEIGHT
    arc, arc_weight = yoke.seat_angle * WHOLE_ARC, yoke.seat_angle * WHOLE_ARC_WEIGHT
    fraction = arc_weight / np.sum(arc_weight * np.cos(arc) ** 2)
    stiffness = yoke.seat_stiffness * np.outer(fraction, ws / 2).ravel()
    normals = np.repeat(np.cos(arc), s.size), np.repeat(np.sin(arc), s.size)
    return record(
        SEAT,
        bar_radius=gear.rack.bar_diameter / 2,
        friction=yoke.friction,
        zone=friction_zone,
        rest_gap=rest_gap,
        half_angle=yoke.seat_angle,
        edge_y=np.cos(yoke.seat_angle),
        edge_z=np.sin(yoke.seat_angle),
        half_length=yoke.seat_length / 2,
        density=yoke.seat_stiffness / np.sum(arc_weight * np.cos(arc) ** 2) / yoke.seat_length,
        points=np.column_stack([*normals, np.tile(yoke.seat_length / 2 * s, arc.size), stiffness]),
        law=law_of(yoke, patches or Patches(), yoke.friction, yoke.preload * seat_under(gear).wedge),
        damping=yoke.seat_damping,
        back=gear.rack.back_parallelism,
        tilt=yoke.bore_clearance / yoke.plunger_length,
        clearance=yoke.seat_clearance,
        over_y=yoke.seat_clearance * np.cos(touches),
        over_z=yoke.seat_clearance * np.sin(touches),
    )


def touching_angle(gear: SteeringGear) -> float:
    """Return the angle theta_g at which the seat touches a bar without load [rad]."""
    return GOTHIC_ANGLE if gear.yoke.seat_form == "gothic" else 0.0


class PressedSeat(NamedTuple):
    """A seat under a force along the yoke axis, of the shape of the forces."""

    depth: Any  # of the bar below where it touches without load [m]
    wedge: Any  # sum of the normal forces over the force
    stiffness: Any  # along the yoke axis, for small changes [N/m]


def seat_under(gear: SteeringGear, force: float | None = None) -> PressedSeat:
    """Return the seat of a gear under a force, the preload without one [N]."""
    yoke, touches = gear.yoke, touching_angle(gear)
    unit = yoke.seat_angle + np.sin(yoke.seat_angle) * np.cos(yoke.seat_angle)
    form = yoke.seat_angle, yoke.seat_clearance * np.cos(touches), yoke.seat_clearance * np.sin(touches)
    pressed = pressed_seat(yoke.preload if force is None else force, yoke.seat_stiffness / unit, *form)
    return PressedSeat(*(float(value) for value in pressed))


def pressed_seat(force: Any, density: Any, half_angle: Any, over_y: Any, over_z: Any) -> PressedSeat:
    """Return seats under forces along the yoke axis [N]; all arguments have one shape.

    Each arc touches where a cos(theta - psi) > c, its centre at the distance a, the direction psi from the
    bar's axis; the force is the integral of density (a cos(theta - psi) - c) cos(theta). Newton's method
    begins beyond the solution, from where all would touch, and the force bends upwards: it cannot miss.

    Args:
        force: [N].
        density: stiffness per angle of the arc [N/(m rad)].
        half_angle: of the arc [rad].
        over_y: of the record `SEAT`, as the next [m].
        over_z: [m].
    """
    clear, phi = np.hypot(over_y, over_z), half_angle
    load = np.maximum(force, np.where(clear > 0, LEAST_LOAD, 0.0)) / (2 * density)
    whole = (phi + np.sin(phi) * np.cos(phi)) / 2
    depth = (load + clear * np.sin(phi) - over_z * np.sin(phi) ** 2 / 2) / whole - over_y
    normal, slope = np.sin(phi) / whole * load, whole
    for _ in range(NEWTONS if np.any(clear > 0) else 0):
        y = depth + over_y
        a, psi = np.hypot(y, over_z), np.arctan2(over_z, y)
        wide = np.arccos(np.minimum(clear / a, 1.0))
        first, last = np.maximum(psi - wide, 0.0), np.minimum(psi + wide, phi)
        rise = (np.sin(2 * last - psi) - np.sin(2 * first - psi)) / 2
        carried = a / 2 * ((last - first) * np.cos(psi) + rise) - clear * (np.sin(last) - np.sin(first))
        slope = (last - first) / 2 + (np.sin(2 * last) - np.sin(2 * first)) / 4
        normal = a * (np.sin(last - psi) - np.sin(first - psi)) - clear * (last - first)
        depth = np.where(clear > 0, depth - (carried - load) / slope, depth)
    lifted = np.asarray(force) < 2 * density * load  # by less than the least load: in proportion
    share = np.where(lifted, np.asarray(force) / (2 * density * np.where(load > 0, load, 1.0)), 1.0)
    wedge = np.where(load > 0, normal / np.where(load > 0, load, 1.0), np.sin(phi) / whole)
    return PressedSeat(depth * share, wedge, 2 * density * slope)


NEWTONS = 25


@inline
def spring_force(place, data, out):  # type: ignore[no-untyped-def]
    """Preloaded spring between yokenut and plunger, which is at `place` [m]; fills out (5,)."""
    force = data.preload + data.rate * place
    out[0], out[1] = -force, data.preload * place + 0.5 * data.rate * place**2
    out[2], out[3], out[4] = 0.0, 0.0, force


@inline
def nut_force(place, rate, data, out):  # type: ignore[no-untyped-def]
    """Contact of plunger and yokenut once the clearance is used up; fills out (5,)."""
    depth = max(place - data.clearance, 0.0)
    elastic = force = data.stiffness * depth
    if depth > 0 and data.damping > 0:
        force = max(elastic + data.stiffness * data.damping * rate, 0.0)
    out[0], out[1], out[2], out[3] = -force, 0.5 * elastic * depth, 0.0, (force - elastic) * rate
    out[4] = force


@inline
def nut_slope(place, rate, data, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """Derivative of the nut's force on the plunger."""
    depth = place - data.clearance
    if depth <= 0 or (data.damping > 0 and depth + data.damping * rate <= 0):
        return 0.0
    return -data.stiffness * (factor_q + factor_v * data.damping)


@inline
def bore_force(rate, data, memory, out):  # type: ignore[no-untyped-def]
    """Friction and damping of the plunger in its bore; fills out (7,), returns their derivative by the
    rate."""
    law = data.law
    for i in range(7):
        out[i] = 0.0
    slope = -data.damping
    if law.has_state:
        drag, _, out[1], out[5] = slide(data.friction, rate, 0.0, law.place, law, memory)
        ahead, _, _, _, _, _, _, _ = slide_slopes(data.friction, rate, 0.0, 0.0, law.place, law, memory)
        out[0], out[2], out[6] = -drag, drag * rate, out[1]
        slope -= ahead
    out[0] -= data.damping * rate
    out[3], out[4] = data.damping * rate * rate, -out[0]
    return slope


def nut_record(gear: SteeringGear) -> np.record:
    """Return the record of the yokenut, a one-sided stop behind the plunger."""
    yoke = gear.yoke
    return record(NUT, stiffness=yoke.nut_stiffness, clearance=yoke.clearance, damping=yoke.nut_damping)


def records(
    gear: SteeringGear, friction_zone: float, approach: float, patches: Patches
) -> dict[str, np.record]:
    """Return the records of the yoke's parts by their names; the preload presses the rack into the mesh by
    `approach` [m]."""
    yoke, rest_gap = gear.yoke, approach + seat_under(gear).depth
    seat = seat_record(gear, friction_zone=friction_zone, rest_gap=rest_gap, patches=patches)
    law = constant_law(patches, yoke.bore_friction, yoke.bristle_travel)
    bore = record(BORE, friction=yoke.bore_friction, damping=yoke.bore_damping, law=law)
    spring = record(SPRING, rate=yoke.spring_rate, preload=yoke.preload)
    return {"seat": seat, "spring": spring, "nut": nut_record(gear), "bore": bore}


def seat_wedge_factor(half_angle: float) -> float:
    """kappa: sum of the seat's normal forces over the force along the yoke axis.

    A cylinder pressed by a displacement has the pressure p ~ cos(theta) over |theta| <= half_angle, thus
    kappa = int cos / int cos^2 = 2 sin(phi) / (phi + sin(phi) cos(phi)); 1 for a flat seat.
    """
    return float(2 * np.sin(half_angle) / (half_angle + np.sin(half_angle) * np.cos(half_angle)))
