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

from rps_exudyn.base.compiled import kernel
from rps_exudyn.base.quadrature import gauss_legendre
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import coulomb
from rps_exudyn.forces.rigid_motion import on_angles, spin_of, turn_of
from rps_exudyn.parameters.gear import SteeringGear

ARC_POINTS, LENGTH_POINTS = 6, 2  # Gauss points: a seat that touches everywhere is integrated to 1e-9


class SeatData(NamedTuple):
    """A cylindrical seat fixed to the plunger, sampled by Gauss points."""

    bar_radius: float
    friction: float
    zone: float  # friction zone [m/s]
    rest_gap: float  # Y of the plunger's zero above that of the rack, so that both rest at the preload [m]
    arc_y: np.ndarray  # outward normal of the bar at each point: along the yoke axis ...
    arc_z: np.ndarray  # ... and across
    station: np.ndarray  # its position along the rack [m]
    stiffness: np.ndarray  # and its part of the seat's stiffness [N/m]


@kernel
def seat_force(q, v, data):  # type: ignore[no-untyped-def]
    """Penalty contact of the seat with the back of the bar; q = rack (6), plunger (1)."""
    out = np.zeros(7 + 3 + 2)
    turn = turn_of(q[3:6])
    omega = spin_of(turn, v[3:6])
    axis_x, axis_y, axis_z = turn.axis
    slope_y, slope_z = axis_y / axis_x, axis_z / axis_x
    moment_x = moment_y = moment_z = 0.0
    for i in range(data.arc_y.size):
        ny, nz = data.arc_y[i], data.arc_z[i]
        # the point of the bar's axis that stands at this station of the housing
        along = (data.station[i] - q[0]) / axis_x
        ay, az = along * axis_y, along * axis_z
        depth = (q[1] + ay - q[6] + data.rest_gap) * ny + (q[2] + az) * nz
        if depth <= 0:
            continue
        load = data.stiffness[i] * depth
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
        drag = coulomb(load, data.friction, speed, data.zone)
        fx, fy, fz = -drag * vx, -drag * vy, -drag * vz
        px, py, pz = -load * nx, -load * ny, -load * nz
        out[0] += fx + px
        out[1] += fy + py
        out[2] += fz + pz
        # friction acts on the surface, the load passes through the axis
        moment_x += ly * fz - lz * fy + ay * pz - az * py
        moment_y += lz * fx - lx * fz + az * px - lx * pz
        moment_z += lx * fy - ly * fx + lx * py - ay * px
        out[7] += 0.5 * load * depth
        out[8] += drag * speed**2
        out[10] += load
        out[11] += load * ny
    out[3], out[4], out[5] = on_angles(turn, (moment_x, moment_y, moment_z))
    out[6] = -out[1]
    return out


def seat(gear: SteeringGear, *, friction_zone: float, rest_gap: float) -> ForceElement:
    """Contact of the plunger's cylindrical seat with the back of the rack."""
    yoke = gear.yoke
    x, wx = gauss_legendre(ARC_POINTS)
    s, ws = gauss_legendre(LENGTH_POINTS)
    arc, arc_weight = yoke.seat_angle * x, yoke.seat_angle * wx
    # pressure per depth such that the whole seat has `seat_stiffness` along the yoke axis
    fraction = arc_weight / np.sum(arc_weight * np.cos(arc) ** 2)
    data = SeatData(
        bar_radius=gear.rack.bar_diameter / 2,
        friction=yoke.friction,
        zone=friction_zone,
        rest_gap=rest_gap,
        arc_y=np.cos(np.repeat(arc, s.size)),
        arc_z=np.sin(np.repeat(arc, s.size)),
        station=np.tile(yoke.seat_length / 2 * s, arc.size),
        stiffness=yoke.seat_stiffness * np.outer(fraction, ws / 2).ravel(),
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
