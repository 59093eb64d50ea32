"""The yoke's seat as a sum over many small cells: no clipping, no Gauss points, no symmetry.

    by_cells(forces)        the same gear with such a seat

The law is that of `forces.yoke`: pressure proportional to depth, Coulomb friction of the bar's surface. Its
integral is made otherwise, by cells that touch or do not, as a reference that shares no quadrature with what
it judges. The error falls with the square of the cells' size; 160 by 16 cells keep
the torque to 1e-4, to 4e-3 where a thirtieth of the arc touches.
"""

from dataclasses import replace

import numpy as np

from rps_exudyn.base.compiled import entry, kernel
from rps_exudyn.forces.friction import COULOMB, coulomb
from rps_exudyn.forces.rigid_motion import cross, dot, minus, on_angles, plus, scaled, spin_of, turn_of
from rps_exudyn.solvers.bent_rack import add_to_bar, bar_sections, fill_pose
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.gear_model import COLUMNS, LAW, gear_law
from verification.law_area import area_gear

ARC_CELLS, LENGTH_CELLS = 160, 16
SEAT_SIZE = 12  # outputs of the seat
_SEAT = COLUMNS["seat"].start


def by_cells(forces: GearForces) -> GearForces:
    """Return the forces with the seat of the plunger as a sum over cells; its tangent stays as it is.

    Raises:
        ValueError: the friction of the yoke is not Coulomb's.
    """
    if forces.gear.seat.law.kind != COULOMB:
        raise ValueError("cells need Coulomb's friction of the yoke")
    return replace(forces, law=area_by_cells if forces.law is area_gear else gear_by_cells)


@kernel
def seat_by_cells(q, v, seat, out):  # type: ignore[no-untyped-def]
    """Fill the forces of the seat on q = rack (6), plunger (1), energy terms, and the outputs of
    `seat_force`; `seat` is a record `SEAT`."""
    for i in range(SEAT_SIZE):
        out[i] = 0.0
    phi, weight = seat.half_angle, 0.0
    for i in range(ARC_CELLS):
        weight += np.cos(phi * ((2 * i + 1) / ARC_CELLS - 1)) ** 2
    # of the whole seat along the yoke, spread evenly over the cells
    stiffness = seat.density * (phi + np.sin(phi) * np.cos(phi)) * 2 * seat.half_length
    stiffness /= LENGTH_CELLS * weight
    turn = turn_of(q[3:6])
    axis, omega = turn.axis, spin_of(turn, v[3:6])
    travels = (v[0], v[1] - v[6], v[2])  # of the bar's reference point against the plunger
    tilt = min(max(axis[1] / axis[0], -seat.tilt), seat.tilt)  # of the plunger in its bore, with the bar
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in range(ARC_CELLS):
        angle = phi * ((2 * i + 1) / ARC_CELLS - 1)
        cos, sin = np.cos(angle), np.sin(angle)
        for j in range(LENGTH_CELLS):
            station = seat.half_length * ((2 * j + 1) / LENGTH_CELLS - 1)
            # where the bar's axis passes the cells' plane
            arm = scaled((station - q[0]) / axis[0], axis)
            place_y, place_z = q[1] + arm[1] - station * tilt - q[6] + seat.rest_gap, q[2] + arm[2]
            depth = place_y * cos + place_z * sin
            depth += seat.over_y * cos + seat.over_z * abs(sin) - seat.clearance
            if depth <= 0:
                continue
            normal = (-(axis[1] * cos + axis[2] * sin) / axis[0], cos, sin)
            surface = plus(arm, (0.0, seat.bar_radius * cos, seat.bar_radius * sin))
            slip = plus(travels, cross(omega, surface))
            slip = minus(slip, scaled(dot(slip, normal) / dot(normal, normal), normal))
            load, speed = stiffness * depth, np.sqrt(dot(slip, slip))
            drag = scaled(-coulomb(load, seat.friction, speed, seat.zone), slip)
            push = scaled(-load, normal)
            force = plus(force, plus(drag, push))
            moment = plus(moment, plus(cross(surface, drag), cross(arm, push)))
            out[7] += 0.5 * load * depth
            out[8] -= dot(drag, slip)
            out[10] += load
            out[11] += load * cos
    out[0], out[1], out[2] = force
    out[3], out[4], out[5] = on_angles(turn, moment)
    out[6] = -out[1]


@kernel
def exchange_seat(q, gear, pool, work, total):  # type: ignore[no-untyped-def]
    """Put the cells in the place of the seat of a gear, whose forces are known."""
    own, more = np.empty(SEAT_SIZE), np.empty(7)
    seat_by_cells(work.place[1:8], work.rate[1:8], gear.seat, own)
    for i in range(7):
        more[i] = own[i] - work.out[_SEAT + i]
    for i in range(SEAT_SIZE):
        work.out[_SEAT + i] = own[i]
    if gear.is_bent:
        bar = gear.bar
        pose, sections = np.empty((3, 6)), np.empty((4, bar.modes + 2))
        bar_sections(-q[1], bar, pool, sections)
        fill_pose(q, work.slip, sections, -1.0, bar, pose)
        add_to_bar(total, more, pose, sections, -1.0, bar)
    else:
        for i in range(6):
            total[1 + i] += more[i]
    total[7] += more[6]


@entry(*LAW)
def gear_by_cells(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent):  # type: ignore[no-untyped-def]
    """A gear with the contact laws of the package."""
    gear_law(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent)
    exchange_seat(q, gears[g], pool, works[0], total)


@entry(*LAW)
def area_by_cells(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent):  # type: ignore[no-untyped-def]
    """A gear with the contact law "area"."""
    area_gear(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent)
    exchange_seat(q, gears[g], pool, works[0], total)
