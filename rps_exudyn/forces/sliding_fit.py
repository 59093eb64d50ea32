"""The sliding fit between rack and bush: a cylindrical joint with elasticity and Coulomb drag.

The rack slides, rolls and swivels with what carries it: the last segment of the chain, or the housing with
the whole chain's stiffness condensed into the fit.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import borrowing, kernel
from rps_exudyn.forces.bush import RIGID_END, Chain, housing_station, lateral_stiffness
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import BRISTLE, Law, bristle, clear, coulomb, law_of, stored, stribeck
from rps_exudyn.forces.memory import Memory
from rps_exudyn.forces.rigid_motion import (
    Vector,
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


class FitData(NamedTuple):
    """Sliding fit between the rack and what carries it."""

    stiffness: np.ndarray  # of y, z, about y, about z at the station, shape (4, 4)
    drag: float  # Coulomb friction [N]
    zone: float  # friction zone [m/s]
    radius: float  # at which rolling rubs [m]
    station: float  # X of the fit in the housing [m]
    lever: float  # from the carrier's reference point to the fit along X [m]
    law: Law


class Held(NamedTuple):
    """A body of the fit: reference point in the housing, its velocity, the x axis, angular velocity."""

    place: Vector
    velocity: Vector
    axis: Vector
    spin: Vector


class FitLoads(NamedTuple):
    """Loads of the fit on the rack; the opposite act at the same place on the carrier."""

    force: Vector
    moment: Vector  # about the place of the fit
    lever_carrier: Vector  # from each body's reference point to that place
    lever_rack: Vector
    stored: float
    lost: float
    lateral: float
    drag: float


@borrowing
def fit_loads(carrier, rack, data):  # type: ignore[no-untyped-def]
    """Loads between rack and carrier: the rack slides and rolls in its carrier and swivels with it.

    The elastic connection sits at one place: on the carrier a fixed point, on the rack the point of its
    axis that passes there. Force and moment act at that place on both bodies.
    """
    lever_carrier = scaled(data.lever, carrier.axis)
    fit = plus(plus(carrier.place, lever_carrier), (data.station - data.lever, 0.0, 0.0))
    lever_rack = scaled(dot(minus(fit, rack.place), rack.axis), rack.axis)
    offset = minus(plus(rack.place, lever_rack), fit)
    tilt = cross(carrier.axis, rack.axis)

    of_rack = plus(rack.velocity, cross(rack.spin, lever_rack))
    of_carrier = plus(carrier.velocity, cross(carrier.spin, lever_carrier))
    slide = dot(minus(of_rack, of_carrier), rack.axis)
    roll = data.radius * dot(minus(rack.spin, carrier.spin), rack.axis)
    speed = np.sqrt(slide**2 + roll**2)
    law, held = data.law, 0.0
    if law.kind == BRISTLE:
        clear(law.place, law)
        drag, turning, lost = bristle(1.0, slide, roll, law.place, data.drag, law)
        held = stored(law.place, data.drag, law)
    else:
        rub = coulomb(1.0, data.drag, speed, data.zone) * stribeck(speed, law)
        drag, turning, lost = rub * slide, rub * roll, rub * speed**2

    k = data.stiffness
    y, z, b, c = offset[1], offset[2], tilt[1], tilt[2]
    p_y = k[0, 0] * y + k[0, 1] * z + k[0, 2] * b + k[0, 3] * c
    p_z = k[1, 0] * y + k[1, 1] * z + k[1, 2] * b + k[1, 3] * c
    m_y = k[2, 0] * y + k[2, 1] * z + k[2, 2] * b + k[2, 3] * c
    m_z = k[3, 0] * y + k[3, 1] * z + k[3, 2] * b + k[3, 3] * c
    # across the tilted bar, so that sliding along it does no work against the load
    p_x = -(p_y * rack.axis[1] + p_z * rack.axis[2]) / rack.axis[0]
    return FitLoads(
        minus((-p_x, -p_y, -p_z), scaled(drag, rack.axis)),
        minus((0.0, -m_y, -m_z), scaled(turning * data.radius, rack.axis)),
        plus(lever_carrier, offset),
        lever_rack,
        0.5 * (y * p_y + z * p_z + b * m_y + c * m_z) + held,
        lost,
        np.sqrt(p_y**2 + p_z**2),
        drag,
    )


@borrowing
def _held(q, v):  # type: ignore[no-untyped-def]
    turn = turn_of(q[3:6])
    return Held(vector(q), vector(v), turn.axis, spin_of(turn, v[3:6])), turn


@borrowing
def _fill(out, loads, turn):  # type: ignore[no-untyped-def]
    """Fill the forces on the rack, the energy terms, and the outputs."""
    moment = plus(loads.moment, cross(loads.lever_rack, loads.force))
    out[0], out[1], out[2] = loads.force
    out[3], out[4], out[5] = on_angles(turn, moment)
    out[6], out[7], out[8] = loads.stored, loads.lost, 0.0
    out[9], out[10] = loads.lateral, loads.drag


@kernel
def fit_force(q, v, data):  # type: ignore[no-untyped-def]
    """The fit in a moving carrier; q = segment (6), rack (6)."""
    out = np.empty(12 + 3 + 2)
    (carrier, turn_carrier), (rack, turn_rack) = _held(q[0:6], v[0:6]), _held(q[6:12], v[6:12])
    loads = fit_loads(carrier, rack, data)
    moment = plus(loads.moment, cross(loads.lever_carrier, loads.force))
    out[0], out[1], out[2] = scaled(-1.0, loads.force)
    out[3], out[4], out[5] = on_angles(turn_carrier, scaled(-1.0, moment))
    _fill(out[6:], loads, turn_rack)
    return out


@kernel
def held_fit_force(q, v, data):  # type: ignore[no-untyped-def]
    """The fit in a carrier that is part of the housing; q = rack (6)."""
    out = np.empty(6 + 3 + 2)
    still = (0.0, 0.0, 0.0)
    rack, turn = _held(q, v)
    _fill(out, fit_loads(Held(still, still, (1.0, 0.0, 0.0), still), rack, data), turn)
    return out


FIT_OUTPUTS = ("bush_lateral_force", "bush_drag")
LATERAL = [1, 2, 4, 5]  # of x y z, about x y z


def chain_fit(gear: SteeringGear, chain: Chain, *, friction_zone: float, memory: Memory) -> ForceElement:
    """The rack in the last segment of a chain: the last half piece is the fit's elasticity."""
    stiffness, lever = np.diag(chain.end[LATERAL]), -(chain.end_station - chain.centres[-1])
    data = _data(gear, stiffness, chain.end_station, friction_zone, memory)._replace(lever=lever)
    return ForceElement("bush", ("segment", "rack"), fit_force, data, FIT_OUTPUTS)


def condensed_fit(gear: SteeringGear, chain: Chain, *, friction_zone: float, memory: Memory) -> ForceElement:
    """The rack in the chain's exact static stiffness, seen at the place of the fit.

    Axial stretch and twist of the bush are left out: only the drag loads them.
    """
    return _held_fit(_data(gear, lateral_stiffness(chain), chain.end_station, friction_zone, memory))


def rigid_fit(gear: SteeringGear, *, friction_zone: float, memory: Memory) -> ForceElement:
    """The rack in a bush that does not yield: stiff in place of rigid, at the bush's free end."""
    return _held_fit(_data(gear, np.diag(RIGID_END[LATERAL]), gear.bush.length, friction_zone, memory))


def loose_fit(gear: SteeringGear, *, friction_zone: float, memory: Memory) -> ForceElement:
    """A fit that drags but does not hold, for a rack that is guided otherwise."""
    return _held_fit(_data(gear, np.zeros((4, 4)), gear.bush.length, friction_zone, memory))


def _data(
    gear: SteeringGear, stiffness: np.ndarray, station: float, friction_zone: float, memory: Memory
) -> FitData:
    """The fit at a station of the chain [m]."""
    radius, at = gear.rack.bar_diameter / 2, housing_station(gear, station)
    return FitData(
        stiffness, gear.bush.drag, friction_zone, radius, at, lever=0.0, law=law_of(gear.bush, memory)
    )


def _held_fit(data: FitData) -> ForceElement:
    return ForceElement("bush", ("rack",), held_fit_force, data, FIT_OUTPUTS)
