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

from rps_exudyn.compiled import kernel
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.parts.force_element import ForceElement
from rps_exudyn.parts.motion import coulomb, cross, dot, rotation_matrix, spin_map

ARC_POINTS, LENGTH_POINTS = 6, 2  # Gauss points: a seat that touches everywhere is integrated to 1e-9


class SeatData(NamedTuple):
    """A cylindrical seat fixed to the plunger, sampled by Gauss points."""

    bar_radius: float
    friction: float
    zone: float  # friction zone [m/s]
    rest_gap: float  # Y of the plunger's zero above that of the rack, so that both rest at the preload [m]
    arc: np.ndarray  # angle of each point from the yoke axis [rad]
    station: np.ndarray  # its position along the rack [m]
    stiffness: np.ndarray  # its share [N/m]


@kernel
def seat_force(q, v, data):  # type: ignore[no-untyped-def]
    """Penalty contact of the seat with the back of the bar; q = rack (6), plunger (1)."""
    out = np.zeros(7 + 3 + 2)
    turn, spin = rotation_matrix(q[3:6]), spin_map(q[3:6])
    omega = spin @ v[3:6]
    axis = turn[:, 0]
    moment = np.zeros(3)
    for i in range(data.arc.size):
        # the point of the bar's axis that stands at this station of the housing
        along = (data.station[i] - q[0]) / axis[0]
        ny, nz = np.cos(data.arc[i]), np.sin(data.arc[i])
        lift_y = q[1] + along * axis[1] - q[6] + data.rest_gap
        lift_z = q[2] + along * axis[2]
        depth = lift_y * ny + lift_z * nz
        if depth <= 0:
            continue
        normal_force = data.stiffness[i] * depth
        lever = along * axis
        lever[1] += data.bar_radius * ny
        lever[2] += data.bar_radius * nz
        slip = v[0:3] + cross(omega, lever)
        slip[1] -= v[6]
        slip_normal = slip[1] * ny + slip[2] * nz
        slip[1] -= slip_normal * ny
        slip[2] -= slip_normal * nz
        speed = np.sqrt(dot(slip, slip))
        drag = coulomb(normal_force, data.friction, speed, data.zone)
        force = -drag * slip
        force[1] -= normal_force * ny
        force[2] -= normal_force * nz
        out[0:3] += force
        out[6] -= force[1]
        moment += cross(lever, force)
        out[7] += 0.5 * normal_force * depth
        out[8] += drag * speed**2
        out[10] += normal_force
        out[11] += normal_force * ny
    out[3:6] = spin.T @ moment
    return out


def seat(gear: SteeringGear, *, friction_zone: float, rest_gap: float) -> ForceElement:
    """Contact of the plunger's cylindrical seat with the back of the rack."""
    yoke = gear.yoke
    x, wx = np.polynomial.legendre.leggauss(ARC_POINTS)
    s, ws = np.polynomial.legendre.leggauss(LENGTH_POINTS)
    arc, arc_weight = yoke.seat_angle * x, yoke.seat_angle * wx
    # pressure per depth such that the whole seat has `seat_stiffness` along the yoke axis
    share = arc_weight / np.sum(arc_weight * np.cos(arc) ** 2)
    data = SeatData(
        bar_radius=gear.rack.bar_diameter / 2,
        friction=yoke.friction,
        zone=friction_zone,
        rest_gap=rest_gap,
        arc=np.repeat(arc, s.size),
        station=np.tile(yoke.seat_length / 2 * s, arc.size),
        stiffness=yoke.seat_stiffness * np.outer(share, ws / 2).ravel(),
    )
    return ForceElement("seat", ("rack", "plunger"), seat_force, data, ("seat_normal_force", "seat_force"))


class SpringData(NamedTuple):
    rate: float
    preload: float


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
    stiffness: float
    clearance: float


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
