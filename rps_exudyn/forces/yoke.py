"""The yoke: a plunger that presses the rack into the mesh, its spring, and the yokenut behind it.

          yokenut (locked to the housing)
         ----------------   clearance
          | plunger    |    spring, preload P at rest, no damper
          |  .-~~~~-.  |
            (  rack  )      cylindrical seat, half angle phi_s, Coulomb friction
             `-....-'
       teeth   \\/\\/\\/

The plunger slides along Y only; its coordinate counts from the preloaded rest position.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import apart, kernel, nested
from rps_exudyn.base.quadrature import gauss_legendre
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import (
    BRISTLE,
    Law,
    bristle,
    by_load,
    clear,
    coulomb,
    law_of,
    stored,
    stribeck,
)
from rps_exudyn.forces.memory import Memory
from rps_exudyn.forces.rigid_motion import on_angles, spin_of, turn_of
from rps_exudyn.parameters.gear import SteeringGear

ARC_POINTS, LENGTH_POINTS = 6, 2  # Gauss points of a seat that touches everywhere: to 1e-9
PIECE_POINTS = 10  # of each piece of the arc where part of the seat touches: to 1e-5


class SeatData(NamedTuple):
    """A cylindrical seat fixed to the plunger, and its Gauss points where all of it touches."""

    bar_radius: float
    friction: float
    zone: float  # friction zone [m/s]
    rest_gap: float  # Y of the plunger's zero above that of the rack, so that both rest at the preload [m]
    half_angle: float  # of the arc [rad]
    edge_y: float  # its cosine ...
    edge_z: float  # ... and sine
    half_length: float  # along the rack [m]
    density: float  # stiffness per angle and length [N/m per rad m]
    arc: np.ndarray  # Gauss rule of a piece of the arc over -1 .. 1: points ...
    arc_weight: np.ndarray  # ... and weights
    length: np.ndarray  # the same along the rack
    length_weight: np.ndarray
    points: np.ndarray  # (n, 4) of the whole seat, rows as `seat_points` fills them
    law: Law
    tilt: float  # by which the plunger follows the bar's slope in its bore, at most [rad]


# The bar's axis stands at gap + station * slope, both (y, z), against that of the seat.


@nested
def touches_everywhere(gap, slope, data):  # type: ignore[no-untyped-def]
    """Tell whether all of the seat touches: it does if its four corners do, for its arc is no half circle."""
    for station in (-data.half_length, data.half_length):
        y, z = gap[0] + station * slope[0], gap[1] + station * slope[1]
        if y * data.edge_y - abs(z) * data.edge_z <= 0:
            return False
    return True


@nested
def touching_stations(angle, gap, slope, half_length):  # type: ignore[no-untyped-def]
    """Return the stations between which the seat touches at an angle of its arc; depth is linear there."""
    middle = gap[0] * np.cos(angle) + gap[1] * np.sin(angle)
    rise = slope[0] * np.cos(angle) + slope[1] * np.sin(angle)
    low, high = -half_length, half_length
    if abs(rise) * half_length <= abs(middle):
        return (low, high) if middle > 0 else (0.0, 0.0)
    zero = -middle / rise
    return (zero, high) if rise > 0 else (low, zero)


@nested
def arc_pieces(gap, slope, data):  # type: ignore[no-untyped-def]
    """Return the angles between which the touching part changes smoothly, rising.

    It changes its shape where an end face begins or ceases to touch, a right angle from where it is deepest.
    """
    pieces = np.empty(6)
    pieces[0], count = -data.half_angle, 1
    for station in (-data.half_length, data.half_length):
        deepest = np.arctan2(gap[1] + station * slope[1], gap[0] + station * slope[0])
        for turn in (-1.5 * np.pi, -0.5 * np.pi, 0.5 * np.pi, 1.5 * np.pi):
            if abs(deepest + turn) < data.half_angle and count < 5:
                place = count
                while pieces[place - 1] > deepest + turn:
                    pieces[place] = pieces[place - 1]
                    place -= 1
                pieces[place], count = deepest + turn, count + 1
    pieces[count] = data.half_angle
    return pieces[: count + 1]


@nested
def seat_points(gap, slope, data):  # type: ignore[no-untyped-def]
    """Return Gauss points of the touching part, rows (normal y, normal z, station [m], stiffness [N/m])."""
    if touches_everywhere(gap, slope, data):
        return data.points
    pieces = arc_pieces(gap, slope, data)
    points, n = np.empty(((pieces.size - 1) * data.arc.size * data.length.size, 4)), 0
    for piece in range(pieces.size - 1):
        middle, half = (pieces[piece + 1] + pieces[piece]) / 2, (pieces[piece + 1] - pieces[piece]) / 2
        for i in range(data.arc.size):
            angle = middle + half * data.arc[i]
            low, high = touching_stations(angle, gap, slope, data.half_length)
            for j in range(data.length.size):
                points[n, 0], points[n, 1] = np.cos(angle), np.sin(angle)
                points[n, 2] = (high + low) / 2 + (high - low) / 2 * data.length[j]
                area = half * data.arc_weight[i] * (high - low) / 2 * data.length_weight[j]
                points[n, 3] = data.density * area
                n += 1
    return points


@nested
def _whole_load(points, q, axis, tilt, data):  # type: ignore[no-untyped-def]
    """Sum of the seat's normal forces [N]."""
    total = 0.0
    for i in range(points.shape[0]):
        along = (points[i, 2] - q[0]) / axis[0]
        depth = (q[1] + along * axis[1] - points[i, 2] * tilt - q[6] + data.rest_gap) * points[i, 0]
        depth += (q[2] + along * axis[2]) * points[i, 1]
        total += points[i, 3] * max(depth, 0.0)
    return total


@apart
def seat_force(q, v, data):  # type: ignore[no-untyped-def]
    """Penalty contact of the seat with the back of the bar; q = rack (6), plunger (1).

    It is integrated over the part that touches, which a tilted or shifted bar leaves.
    """
    out = np.zeros(7 + 3 + 2)
    turn = turn_of(q[3:6])
    omega = spin_of(turn, v[3:6])
    axis_x, axis_y, axis_z = turn.axis
    slope_y, slope_z = axis_y / axis_x, axis_z / axis_x
    gap = (q[1] - q[0] * slope_y - q[6] + data.rest_gap, q[2] - q[0] * slope_z)
    # a plunger with play in its bore lies along the bar, until it touches the bore: then it bears a moment
    tilt = min(max(slope_y, -data.tilt), data.tilt)
    points = seat_points(gap, (slope_y - tilt, slope_z), data)
    moment_x = moment_y = moment_z = 0.0
    law, friction = data.law, data.friction
    if law.load_exponent != 1.0:
        friction *= by_load(_whole_load(points, q, (axis_x, axis_y, axis_z), tilt, data), law)
    if law.kind == BRISTLE:
        clear(law.place, law)
    for i in range(points.shape[0]):
        ny, nz = points[i, 0], points[i, 1]
        # the point of the bar's axis that stands at this station of the housing
        along = (points[i, 2] - q[0]) / axis_x
        ay, az = along * axis_y, along * axis_z
        depth = (q[1] + ay - points[i, 2] * tilt - q[6] + data.rest_gap) * ny + (q[2] + az) * nz
        if depth <= 0:
            continue
        load = points[i, 3] * depth
        # across the tilted bar, so that sliding along it does no work against the load
        nx = -(slope_y * ny + slope_z * nz)
        lx, ly, lz = along * axis_x, ay + data.bar_radius * ny, az + data.bar_radius * nz
        # slip of the bar's surface over the seat: its velocity less the part along the normal
        vx = v[0] + omega[1] * lz - omega[2] * ly
        vy = v[1] - v[6] + omega[2] * lx - omega[0] * lz
        vz = v[2] + omega[0] * ly - omega[1] * lx
        parting = (vx * nx + vy * ny + vz * nz) / (1 + nx * nx)
        vx, vy, vz = vx - parting * nx, vy - parting * ny, vz - parting * nz
        speed = np.sqrt(vx * vx + vy * vy + vz * vz)
        if law.kind == BRISTLE:
            # along the bar's surface and around it
            size = np.sqrt(1 + nx * nx)
            drag, turning, lost = bristle(
                load, (vx - nx * (vy * ny + vz * nz)) / size, vz * ny - vy * nz, law.place, friction, law
            )
            fx, fy, fz = (
                -drag / size,
                drag * nx * ny / size + turning * nz,
                drag * nx * nz / size - turning * ny,
            )
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
        out[7] += 0.5 * load * depth
        out[8] += lost
        out[10] += load
        out[11] += load * ny
    if law.kind == BRISTLE:
        out[7] += stored(law.place, friction, law)
    out[3], out[4], out[5] = on_angles(turn, (moment_x, moment_y, moment_z))
    out[6] = -out[1]
    return out


def seat(
    gear: SteeringGear, *, friction_zone: float, rest_gap: float, memory: Memory | None = None
) -> ForceElement:
    """Contact of the plunger's cylindrical seat with the back of the rack.

    Its pressure per depth is such that the whole seat has `yoke.seat_stiffness` along the yoke axis.
    """
    yoke = gear.yoke
    x, wx = gauss_legendre(ARC_POINTS)
    piece, piece_weight = gauss_legendre(PIECE_POINTS)
    s, ws = gauss_legendre(LENGTH_POINTS)
    arc, arc_weight = yoke.seat_angle * x, yoke.seat_angle * wx
    fraction = arc_weight / np.sum(arc_weight * np.cos(arc) ** 2)
    stiffness = yoke.seat_stiffness * np.outer(fraction, ws / 2).ravel()
    normals = np.repeat(np.cos(arc), s.size), np.repeat(np.sin(arc), s.size)
    data = SeatData(
        bar_radius=gear.rack.bar_diameter / 2,
        friction=yoke.friction,
        zone=friction_zone,
        rest_gap=rest_gap,
        half_angle=yoke.seat_angle,
        edge_y=np.cos(yoke.seat_angle),
        edge_z=np.sin(yoke.seat_angle),
        half_length=yoke.seat_length / 2,
        density=yoke.seat_stiffness / np.sum(arc_weight * np.cos(arc) ** 2) / yoke.seat_length,
        arc=piece,
        arc_weight=piece_weight,
        length=s,
        length_weight=ws,
        points=np.column_stack([*normals, np.tile(yoke.seat_length / 2 * s, arc.size), stiffness]),
        law=law_of(yoke, memory or Memory(), usual_load=yoke.preload * seat_wedge_factor(yoke.seat_angle)),
        tilt=yoke.bore_clearance / yoke.plunger_length,
    )
    return ForceElement("seat", ("rack", "plunger"), seat_force, data, ("seat_normal_force", "seat_force"))


class SpringData(NamedTuple):
    """Constants of the yoke spring."""

    rate: float  # [N/m]
    preload: float  # [N]


@kernel
def spring_force(q, v, data):  # type: ignore[no-untyped-def]
    """Preloaded spring between yokenut and plunger; q = plunger (1)."""
    force = data.preload + data.rate * q[0]
    stored = data.preload * q[0] + 0.5 * data.rate * q[0] ** 2
    return np.array([-force, stored, 0.0, 0.0, force])


def spring(gear: SteeringGear) -> ForceElement:
    """The yoke spring, without a damper."""
    data = SpringData(gear.yoke.spring_rate, gear.yoke.preload)
    return ForceElement("yoke_spring", ("plunger",), spring_force, data, ("spring_force",))


class NutData(NamedTuple):
    """Constants of the yokenut's contact."""

    stiffness: float  # [N/m]
    clearance: float  # [m]


@kernel
def nut_force(q, v, data):  # type: ignore[no-untyped-def]
    """Contact of plunger and yokenut once the clearance is used up; q = plunger (1)."""
    depth = max(q[0] - data.clearance, 0.0)
    force = data.stiffness * depth
    return np.array([-force, 0.5 * force * depth, 0.0, 0.0, force])


def nut_contact(gear: SteeringGear) -> ForceElement:
    """The yokenut as a one-sided stop behind the plunger."""
    data = NutData(gear.yoke.nut_stiffness, gear.yoke.clearance)
    return ForceElement("yokenut", ("plunger",), nut_force, data, ("yokenut_force",))


def seat_wedge_factor(half_angle: float) -> float:
    """kappa: sum of the seat's normal forces over the force along the yoke axis.

    A cylinder pressed by a displacement has the pressure p ~ cos(theta) over |theta| <= half_angle, thus
    kappa = int cos / int cos^2 = 2 sin(phi) / (phi + sin(phi) cos(phi)); 1 for a flat seat.
    """
    return float(2 * np.sin(half_angle) / (half_angle + np.sin(half_angle) * np.cos(half_angle)))
