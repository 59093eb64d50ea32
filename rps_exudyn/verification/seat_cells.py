"""The yoke's seat as a sum over many small cells: no clipping, no Gauss points, no symmetry.

The law is that of `forces.yoke`: pressure proportional to depth, Coulomb friction of the bar's surface. Its
integral is made otherwise, by cells that touch or do not, as a reference that shares no quadrature with what
it judges. The error falls with the square of the cells' size; 160 by 16 cells keep
the torque to 1e-4, to 4e-3 where a thirtieth of the arc touches.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import coulomb
from rps_exudyn.forces.rigid_motion import (
    cross,
    dot,
    minus,
    plus,
    rotation_matrix,
    scaled,
    spin_map,
    times,
    times_transposed,
    vector,
)
from rps_exudyn.parameters.gear import SteeringGear

ARC_CELLS, LENGTH_CELLS = 160, 16


class CellData(NamedTuple):
    """Cells of a seat fixed to the plunger."""

    normals: np.ndarray  # (n, 2) of the cells, Y and Z
    stations: np.ndarray  # along the rack [m]
    stiffness: float  # of a cell [N/m]
    bar_radius: float
    friction: float
    zone: float  # friction zone [m/s]
    rest_gap: float  # see `SeatData`
    tilt: float  # likewise


@kernel
def seat_by_cells(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of the seat on q = rack (6), plunger (1), energy terms, and the outputs of `seat_force`."""
    out = np.zeros(7 + 3 + 2)
    map_ = spin_map(q[3:6])
    axis, omega = vector(rotation_matrix(q[3:6])[:, 0]), vector(times(map_, v[3:6]))
    travels = (v[0], v[1] - v[6], v[2])  # of the bar's reference point against the plunger
    tilt = min(max(axis[1] / axis[0], -data.tilt), data.tilt)  # of the plunger in its bore, with the bar
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for station in data.stations:
        # where the bar's axis passes the cells' plane
        arm = scaled((station - q[0]) / axis[0], axis)
        place_y, place_z = q[1] + arm[1] - station * tilt - q[6] + data.rest_gap, q[2] + arm[2]
        for i in range(data.normals.shape[0]):
            cos, sin = data.normals[i, 0], data.normals[i, 1]
            depth = place_y * cos + place_z * sin
            if depth <= 0:
                continue
            normal = (-(axis[1] * cos + axis[2] * sin) / axis[0], cos, sin)
            surface = plus(arm, (0.0, data.bar_radius * cos, data.bar_radius * sin))
            slip = plus(travels, cross(omega, surface))
            slip = minus(slip, scaled(dot(slip, normal) / dot(normal, normal), normal))
            load, speed = data.stiffness * depth, np.sqrt(dot(slip, slip))
            drag = scaled(-coulomb(load, data.friction, speed, data.zone), slip)
            push = scaled(-load, normal)
            force = plus(force, plus(drag, push))
            moment = plus(moment, plus(cross(surface, drag), cross(arm, push)))
            out[7] += 0.5 * load * depth
            out[8] -= dot(drag, slip)
            out[10] += load
            out[11] += load * cos
    out[0], out[1], out[2] = force
    out[3:6] = times_transposed(map_, moment)
    out[6] = -out[1]
    return out


def cell_seat(gear: SteeringGear, *, friction_zone: float, rest_gap: float) -> ForceElement:
    """The seat of `forces.yoke` with its whole stiffness spread evenly over cells."""
    yoke = gear.yoke
    angles = yoke.seat_angle * _middles(ARC_CELLS)
    cells = LENGTH_CELLS * float(np.sum(np.cos(angles) ** 2))
    data = CellData(
        np.column_stack([np.cos(angles), np.sin(angles)]),
        yoke.seat_length / 2 * _middles(LENGTH_CELLS),
        yoke.seat_stiffness / cells,
        gear.rack.bar_diameter / 2,
        yoke.friction,
        friction_zone,
        rest_gap,
        yoke.bore_clearance / yoke.plunger_length,
    )
    outputs = ("seat_normal_force", "seat_force")
    return ForceElement("seat", ("rack", "plunger"), seat_by_cells, data, outputs)


def _middles(cells: int) -> np.ndarray:
    """Middles of equal cells of -1 .. 1."""
    return (np.arange(cells) + 0.5) / cells * 2 - 1
