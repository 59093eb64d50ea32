"""The sliding fit between rack and bush: a cylindrical joint with elasticity and Coulomb drag.

The rack slides, rolls and swivels with what carries it: the last segment of the chain, or the housing with
the whole chain's stiffness condensed into the fit.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.compiled import kernel
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.parts.bush import RIGID_END, Chain, housing_station
from rps_exudyn.parts.force_element import ForceElement
from rps_exudyn.parts.motion import coulomb, cross, dot, rotation_matrix, spin_map, times, times_transposed


class FitData(NamedTuple):
    """Sliding fit between the rack and what carries it."""

    stiffness: np.ndarray  # of y, z, about y, about z at the station, shape (4, 4)
    drag: float  # Coulomb friction [N]
    zone: float  # friction zone [m/s]
    radius: float  # at which rolling rubs [m]
    station: float  # X of the fit in the housing [m]
    lever: float  # from the carrier's reference point to the fit along X [m]


@kernel
def fit_force(q, v, data):  # type: ignore[no-untyped-def]
    """The rack slides and rolls in its carrier and swivels with it; q = segment (6), rack (6).

    The elastic connection sits at one place: on the carrier a fixed point, on the rack the point of its
    axis that passes there. Force and moment act at that place on both bodies.
    """
    out = np.zeros(12 + 3 + 2)
    turn_s, spin_s = rotation_matrix(q[3:6]), spin_map(q[3:6])
    turn_r, spin_r = rotation_matrix(q[9:12]), spin_map(q[9:12])
    omega_s, omega_r = times(spin_s, v[3:6]), times(spin_r, v[9:12])
    axis_s, axis_r = turn_s[:, 0], turn_r[:, 0]

    lever_s = data.lever * axis_s
    fit = q[0:3] + lever_s
    fit[0] += data.station - data.lever
    lever_r = dot(fit - q[6:9], axis_r) * axis_r
    offset = q[6:9] + lever_r - fit
    tilt = cross(axis_s, axis_r)

    slide = dot(v[6:9] + cross(omega_r, lever_r) - v[0:3] - cross(omega_s, lever_s), axis_r)
    roll = data.radius * dot(omega_r - omega_s, axis_r)
    speed = np.sqrt(slide**2 + roll**2)
    rub = coulomb(1.0, data.drag, speed, data.zone)

    strain = (offset[1], offset[2], tilt[1], tilt[2])
    stress = np.zeros(4)
    for i in range(4):
        for j in range(4):
            stress[i] += data.stiffness[i, j] * strain[j]
    force = np.array([0.0, -stress[0], -stress[1]]) - rub * slide * axis_r
    moment = np.array([0.0, -stress[2], -stress[3]]) - rub * roll * data.radius * axis_r
    out[0:3] = -force
    out[3:6] = -times_transposed(spin_s, moment + cross(lever_s + offset, force))
    out[6:9] = force
    out[9:12] = times_transposed(spin_r, moment + cross(lever_r, force))
    for i in range(4):
        out[12] += 0.5 * strain[i] * stress[i]
    out[13] = rub * speed**2
    out[15] = np.sqrt(stress[0] ** 2 + stress[1] ** 2)
    out[16] = rub * slide
    return out


@kernel
def held_fit_force(q, v, data):  # type: ignore[no-untyped-def]
    """The same fit in a carrier that is part of the housing; q = rack (6)."""
    still = np.zeros(6)
    out = fit_force(np.concatenate((still, q)), np.concatenate((still, v)), data)
    return out[6:]


FIT_OUTPUTS = ("bush_lateral_force", "bush_drag")


def chain_fit(gear: SteeringGear, chain: Chain, *, friction_zone: float) -> ForceElement:
    """The rack in the last segment of a chain: the last half piece is the fit's elasticity."""
    data = FitData(
        stiffness=np.diag(chain.end[[1, 2, 4, 5]]),
        drag=gear.bush.drag,
        zone=friction_zone,
        radius=gear.rack.bar_diameter / 2,
        station=housing_station(gear, chain.end_station),
        lever=-(chain.end_station - chain.centres[-1]),
    )
    return ForceElement("bush", ("segment", "rack"), fit_force, data, FIT_OUTPUTS)


def condensed_fit(gear: SteeringGear, chain: Chain, *, friction_zone: float) -> ForceElement:
    """The rack in the chain's exact static stiffness, seen at the place of the fit.

    Axial stretch and twist of the bush are left out: only the drag loads them.
    """
    compliance = chain.compliance_at(chain.end_station) + np.diag(1 / chain.end)
    # the chain's stations run against X: lateral motion about y and z changes sign with the lever
    mirror = np.diag([1.0, 1.0, -1.0, -1.0])
    lateral = mirror @ compliance[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] @ mirror
    data = FitData(
        stiffness=np.linalg.inv(lateral),
        drag=gear.bush.drag,
        zone=friction_zone,
        radius=gear.rack.bar_diameter / 2,
        station=housing_station(gear, chain.end_station),
        lever=0.0,
    )
    return ForceElement("bush", ("rack",), held_fit_force, data, FIT_OUTPUTS)


def rigid_fit(gear: SteeringGear, *, friction_zone: float) -> ForceElement:
    """The rack in a bush that does not give: stiff in place of rigid, at the bush's free end."""
    data = FitData(
        stiffness=np.diag(RIGID_END[[1, 2, 4, 5]]),
        drag=gear.bush.drag,
        zone=friction_zone,
        radius=gear.rack.bar_diameter / 2,
        station=housing_station(gear, gear.bush.length),
        lever=0.0,
    )
    return ForceElement("bush", ("rack",), held_fit_force, data, FIT_OUTPUTS)
