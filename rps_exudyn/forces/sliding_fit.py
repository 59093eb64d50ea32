"""The sliding fit between rack and bush: a cylindrical joint with elasticity, Coulomb and viscous drag.

The rack slides, rolls and swivels with what carries it: the last segment of the chain, or the housing with
the whole chain's stiffness condensed into the fit.

With a clearance the bar has room at both ends of the bush: of the displacement e of its axis there the part
e (1 - g/|e|)+ counts, g the radial clearance. Elastic forces follow from the energy of what counts; where
nothing touches, a centring of both ends holds the bar.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import changed, inline, kernel, record, record_type, stacked, stacked_zeros
from rps_exudyn.forces.bush import RIGID_END, Chain, housing_station
from rps_exudyn.forces.force_element import FRICTION_STATE, Part
from rps_exudyn.forces.friction import (
    LAW,
    LOST,
    Patches,
    coulomb,
    duration,
    law_of,
    rubbing,
    slide,
    slide_slopes,
    stribeck,
    stribeck_slope,
)
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
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

FIT = record_type(
    [
        ("stiffness", "f8", (4, 4)),  # of y, z, about y, about z at the station
        ("clearance", "f8"),  # radial [m]
        ("centring", "f8"),  # at each end [N/m]
        ("length", "f8"),  # from the station to the bush's other end along X [m]
        ("drag", "f8"),  # Coulomb friction [N]
        ("viscous", "f8"),  # drag over speed [N s/m]
        ("zone", "f8"),  # friction zone [m/s]
        ("radius", "f8"),  # at which rolling rubs [m]
        ("station", "f8"),  # X of the fit in the housing [m]
        ("lever", "f8"),  # from the carrier's reference point to the fit along X [m]
        ("law", LAW),
    ]
)
"""Record of the sliding fit between the rack and what carries it."""

PART = Part("bush", ("rack",), ("bush_force", "bush_drag", *FRICTION_STATE))
STILL = (0.0, 0.0, 0.0)
CENTRING = 1e-6  # over Young's modulus times length of the bush: 2 mN at 20 um of the default one


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
    power: float  # that friction takes
    lateral: float
    drag: float
    friction_lost: float
    friction_stored: float


@kernel
def fill_slack(u, data, loads, slope):  # type: ignore[no-untyped-def]
    """Fill the elastic loads (4,) of a fit with clearance on u = (y, z, about y, about z) at its station, and
    their derivative (4, 4); return the stored energy."""
    x, g, k, c = data.length, data.clearance, data.stiffness, data.centring
    ends, counts, by_end = stacked_zeros((2, 2)), stacked_zeros((2, 2)), stacked_zeros((2, 2, 2))
    for e in range(2):
        ends[e, 0], ends[e, 1] = u[0] + e * x * u[3], u[1] - e * x * u[2]
        r = np.sqrt(ends[e, 0] ** 2 + ends[e, 1] ** 2)
        if r > g:
            n = (ends[e, 0] / r, ends[e, 1] / r)
            for i in range(2):
                counts[e, i] = (r - g) * n[i]
                for j in range(2):
                    by_end[e, i, j] = g / r * n[i] * n[j]
                by_end[e, i, i] += 1 - g / r
    # what counts, as displacements and tilts of the station, and its derivatives by those in truth
    kept, by = stacked_zeros(4), stacked_zeros((4, 4))
    kept[0], kept[1] = counts[0, 0], counts[0, 1]
    kept[2], kept[3] = (counts[0, 1] - counts[1, 1]) / x, (counts[1, 0] - counts[0, 0]) / x
    for i in range(2):
        first, second, sign = by_end[0, i], by_end[1, i], -1.0 if i == 1 else 1.0
        by[i, 0], by[i, 1] = first[0], first[1]
        tilt = by[2 if i == 1 else 3]
        tilt[0], tilt[1] = sign * (second[0] - first[0]) / x, sign * (second[1] - first[1]) / x
        tilt[2], tilt[3] = -sign * second[1], sign * second[0]
    force, energy = stacked_zeros(4), 0.0
    for i in range(4):
        for j in range(4):
            force[i] += k[i, j] * kept[j]
        energy += 0.5 * force[i] * kept[i]
    half = stacked_zeros((4, 4))
    for i in range(4):
        loads[i] = 0.0
        for j in range(4):
            loads[i] += by[j, i] * force[j]
            for m in range(4):
                half[i, j] += k[i, m] * by[m, j]
    for i in range(4):
        for j in range(4):
            slope[i, j] = 0.0
            for m in range(4):
                slope[i, j] += by[m, i] * half[m, j]
    # forces at the ends: that they turn with what touches, and the centring
    at_end, bent = stacked_zeros((2, 2)), stacked_zeros((2, 2))
    at_end[0, 0], at_end[0, 1] = force[0] - force[3] / x, force[1] + force[2] / x
    at_end[1, 0], at_end[1, 1] = force[3] / x, -force[2] / x
    for e in range(2):
        r = np.sqrt(ends[e, 0] ** 2 + ends[e, 1] ** 2)
        for i in range(2):
            for j in range(2):
                bent[i, j] = 0.0
        if r > g:
            n, f = (ends[e, 0] / r, ends[e, 1] / r), at_end[e]
            along = n[0] * f[0] + n[1] * f[1]
            for i in range(2):
                for j in range(2):
                    bent[i, j] = g / (r * r) * (f[i] * n[j] + n[i] * f[j] - 3 * along * n[i] * n[j])
                bent[i, i] += g / (r * r) * along
        energy += 0.5 * c * r * r
        for i in range(2):
            bent[i, i] += c
        y, z, t = c * ends[e, 0], c * ends[e, 1], e * x
        loads[0], loads[1], loads[2], loads[3] = (
            loads[0] + y,
            loads[1] + z,
            loads[2] - t * z,
            loads[3] + t * y,
        )
        of_y, of_z = (1.0, 0.0, 0.0, t), (0.0, 1.0, -t, 0.0)
        for i in range(4):
            for j in range(4):
                slope[i, j] += of_y[i] * (bent[0, 0] * of_y[j] + bent[0, 1] * of_z[j])
                slope[i, j] += of_z[i] * (bent[1, 0] * of_y[j] + bent[1, 1] * of_z[j])
    return energy


@inline
def fit_loads(carrier, rack, data, memory, slope):  # type: ignore[no-untyped-def]
    """Loads between rack and carrier: the rack slides and rolls in its carrier and swivels with it; fills
    `slope` (5, 4), the elastic stiffness at the station and in its last row the elastic loads.

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
    along = dot(minus(of_rack, of_carrier), rack.axis)
    roll = data.radius * dot(minus(rack.spin, carrier.spin), rack.axis)
    speed = np.sqrt(along**2 + roll**2)
    law, held, lost = data.law, 0.0, 0.0
    if law.has_state:
        limit = data.drag * stribeck(speed, law)
        drag, turning, held, lost = slide(limit, along, roll, law.place, law, memory)
        power = drag * along + turning * roll
    else:
        rub = coulomb(1.0, data.drag, speed, data.zone) * stribeck(speed, law)
        drag, turning, power = rub * along, rub * roll, rub * speed**2
    if law.has_state:  # the work is summed up with that of the bristles
        lost += data.viscous * along**2 * duration(memory)
        memory[1, law.place + LOST] = lost
    drag, power = drag + data.viscous * along, power + data.viscous * along**2

    k = data.stiffness
    y, z, b, c = offset[1], offset[2], tilt[1], tilt[2]
    if data.clearance > 0:
        elastic = stacked(4)
        stored = fill_slack((y, z, b, c), data, elastic, slope)
        p_y, p_z, m_y, m_z = elastic[0], elastic[1], elastic[2], elastic[3]
    else:
        for i in range(4):
            for j in range(4):
                slope[i, j] = k[i, j]
        p_y = k[0, 0] * y + k[0, 1] * z + k[0, 2] * b + k[0, 3] * c
        p_z = k[1, 0] * y + k[1, 1] * z + k[1, 2] * b + k[1, 3] * c
        m_y = k[2, 0] * y + k[2, 1] * z + k[2, 2] * b + k[2, 3] * c
        m_z = k[3, 0] * y + k[3, 1] * z + k[3, 2] * b + k[3, 3] * c
        stored = 0.5 * (y * p_y + z * p_z + b * m_y + c * m_z)
    slope[4, 0], slope[4, 1], slope[4, 2], slope[4, 3] = p_y, p_z, m_y, m_z
    # across the tilted bar, so that sliding along it does no work against the load
    p_x = -(p_y * rack.axis[1] + p_z * rack.axis[2]) / rack.axis[0]
    return FitLoads(
        minus((-p_x, -p_y, -p_z), scaled(drag, rack.axis)),
        minus((0.0, -m_y, -m_z), scaled(turning * data.radius, rack.axis)),
        plus(lever_carrier, offset),
        lever_rack,
        stored + held,
        power,
        np.sqrt(p_y**2 + p_z**2),
        drag,
        lost,
        held,
    )


@inline
def _held(q, v):  # type: ignore[no-untyped-def]
    turn = turn_of(q[3:6])
    return Held(vector(q), vector(v), turn.axis, spin_of(turn, v[3:6])), turn


@inline
def _fill(out, loads, turn):  # type: ignore[no-untyped-def]
    """Fill the forces on the rack, the energy terms, and the outputs."""
    moment = plus(loads.moment, cross(loads.lever_rack, loads.force))
    out[0], out[1], out[2] = loads.force
    out[3], out[4], out[5] = on_angles(turn, moment)
    out[6], out[7], out[8] = loads.stored, loads.power, 0.0
    out[9], out[10] = loads.lateral, loads.drag
    out[11], out[12] = loads.friction_lost, loads.friction_stored


@inline
def held_fit_force(q, v, data, memory, out, slope):  # type: ignore[no-untyped-def]
    """The fit in a carrier that is part of the housing; q = rack (6), fills out (13,), and elastic stiffness
    and loads (5, 4)."""
    rack, turn = _held(q, v)
    _fill(out, fit_loads(Held(STILL, STILL, (1.0, 0.0, 0.0), STILL), rack, data, memory, slope), turn)


@inline
def carried_fit_force(q, v, carrier_q, carrier_v, data, memory, out, slope, on_carrier):  # type: ignore[no-untyped-def]
    """The fit in a moving carrier, a segment (6); fills out (13,), elastic stiffness and loads (5, 4), and
    the forces on the carrier (6,)."""
    (carrier, turn_carrier), (rack, turn_rack) = _held(carrier_q, carrier_v), _held(q, v)
    loads = fit_loads(carrier, rack, data, memory, slope)
    moment = plus(loads.moment, cross(loads.lever_carrier, loads.force))
    on_carrier[0], on_carrier[1], on_carrier[2] = scaled(-1.0, loads.force)
    on_carrier[3], on_carrier[4], on_carrier[5] = on_angles(turn_carrier, scaled(-1.0, moment))
    _fill(out, loads, turn_rack)


@inline
def add_fit_tangent(q, v, data, memory, k, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """Add factor_q dF/dq + factor_v dF/dv of the held fit to a tangent (6, 6) of the rack: its stiffness and
    elastic loads k (5, 4) at its place, and its drag as it slides and rolls.

    The first angle turns what the others tilt: a roll swings the axis of a tilted bar about X. Far from the
    mesh that moves the fit by more than the mesh resists a roll.
    """
    lever, roll = data.station - q[0], q[3]
    a_y, a_z = q[5] + roll * q[4], roll * q[5] - q[4]  # of the bar's axis
    p_y, p_z = k[4, 0], k[4, 1]
    on_y, on_z = lever * p_y + k[4, 3], lever * p_z - k[4, 2]  # by slopes of the axis
    for j in range(6):
        y, z, s_y, s_z = 0.0, 0.0, 0.0, 0.0  # of the place of the fit and of the axis, by coordinate j
        if j == 0:
            y, z = -a_y, -a_z
        elif j == 1:
            y = 1.0
        elif j == 2:
            z = 1.0
        elif j == 3:
            s_y, s_z = -a_z, a_y
        elif j == 4:
            s_y, s_z = roll, -1.0
        else:
            s_y, s_z = 1.0, roll
        y, z = y + lever * s_y, z + lever * s_z
        by_y = k[0, 0] * y + k[0, 1] * z - k[0, 2] * s_z + k[0, 3] * s_y
        by_z = k[1, 0] * y + k[1, 1] * z - k[1, 2] * s_z + k[1, 3] * s_y
        tilt_y = lever * by_y + k[3, 0] * y + k[3, 1] * z - k[3, 2] * s_z + k[3, 3] * s_y
        tilt_z = lever * by_z - k[2, 0] * y - k[2, 1] * z + k[2, 2] * s_z - k[2, 3] * s_y
        about_b, about_c = roll * tilt_y - tilt_z, tilt_y + roll * tilt_z
        if j == 0:
            about_b, about_c = about_b + p_z, about_c - p_y
        elif j == 3:
            about_b, about_c = about_b + on_y, about_c + on_z
        tangent[0, j] += factor_q * (a_y * by_y + a_z * by_z + p_y * s_y + p_z * s_z)
        tangent[1, j] -= factor_q * by_y
        tangent[2, j] -= factor_q * by_z
        tangent[3, j] -= factor_q * lever * (a_y * by_z - a_z * by_y + p_z * s_y - p_y * s_z)
        tangent[4, j] -= factor_q * about_b
        tangent[5, j] -= factor_q * about_c
    # it slides along the bar's axis and rolls about it
    turn, law = turn_of(q[3:6]), data.law
    axis, angles = turn.axis, scaled(data.radius, on_angles(turn, turn.axis))
    along, roll = dot(axis, vector(v[0:3])), dot(angles, vector(v[3:6]))
    if law.has_state:
        speed = np.sqrt(along**2 + roll**2)
        limit, fall = data.drag * stribeck(speed, law), data.drag * stribeck_slope(speed, law)
        slopes = slide_slopes(limit, along, roll, fall, law.place, law, memory)
        in_line, mixed, turned, across = (
            factor_v * (slopes[0] + data.viscous),
            factor_v * slopes[1],
            factor_v * slopes[2],
            factor_v * slopes[3],
        )
    else:
        _, _, ahead, aside, d_a, d_b = rubbing(along, roll, data.drag, data.zone, law)
        in_line = factor_v * (ahead * d_a * d_a + aside * d_b * d_b + data.viscous)
        mixed = turned = factor_v * (ahead - aside) * d_a * d_b
        across = factor_v * (ahead * d_b * d_b + aside * d_a * d_a)
    for i in range(3):
        for j in range(3):
            tangent[i, j] -= in_line * axis[i] * axis[j]
            tangent[i, 3 + j] -= mixed * axis[i] * angles[j]
            tangent[3 + i, j] -= turned * angles[i] * axis[j]
            tangent[3 + i, 3 + j] -= across * angles[i] * angles[j]


LATERAL = [1, 2, 4, 5]  # of x y z, about x y z


def fits(
    gear: SteeringGear, fidelity: Fidelity, chain: Chain, *, friction_zone: float, patches: Patches
) -> tuple[np.record, np.record]:
    """Return the record of the fit as modelled, and that with the bush condensed into it.

    chain      the rack in the last segment: the last half piece is the fit's elasticity
    condensed  the whole chain's exact static stiffness at the place of the fit; axial stretch and twist,
               which only the drag loads, are left out
    rigid      stiff in place of rigid, at the bush's free end
    guided     a fit that drags but does not hold, for a rack that is guided otherwise
    """
    bush, stiffness, station = gear.bush, chain.lateral_stiffness, chain.end_station
    if fidelity.rack == "guided" or fidelity.bush == "rigid":
        held = 0.0 if fidelity.rack == "guided" else 1.0
        stiffness, station = held * np.diag(RIGID_END[LATERAL]), bush.length
    condensed = record(
        FIT,
        stiffness=stiffness,
        clearance=bush.clearance / 2,
        centring=CENTRING * bush.youngs_modulus * bush.length,
        length=bush.length,
        drag=bush.drag,
        viscous=bush.viscous_drag,
        zone=friction_zone,
        radius=gear.rack.bar_diameter / 2,
        station=housing_station(gear, station),
        lever=0.0,
        law=law_of(bush, patches, bush.drag),
    )
    if fidelity.rack == "guided" or fidelity.bush != "chain":
        return condensed, condensed
    of_end, lever = np.diag(chain.end[LATERAL]), chain.centres[-1] - chain.end_station
    return changed(condensed, stiffness=of_end, lever=lever), condensed
