"""All force elements of a gear, for one way of modelling it: what `statics` balances and `model` integrates."""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.fidelity import Fidelity
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.general_contact import contact_data
from rps_exudyn.mesh_contact.sampled_contact import sampled_element
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.parts import pinion, plunger, sliding_fit
from rps_exudyn.parts.bush import Chain, adams_chain, bush_chain
from rps_exudyn.parts.force_element import ForceElement
from rps_exudyn.statics import approach_under

LEAST_LEVER_SHARE = 0.1  # of the mean friction lever: parallel axes have no sliding at the pitch point


@dataclass(frozen=True)
class GearForces:
    """The force elements of a gear, by part."""

    mesh: ForceElement
    seat: ForceElement
    spring: ForceElement
    nut: ForceElement
    bearing: ForceElement
    chain: Chain
    chain_fit: ForceElement
    condensed_fit: ForceElement
    friction_zone: float  # [m/s]

    @property
    def condensed(self) -> list[ForceElement]:
        """The whole gear, with the bush condensed into the fit."""
        return [self.mesh, self.seat, self.spring, self.nut, self.bearing, self.condensed_fit]


def gear_forces(gear: SteeringGear, fidelity: Fidelity) -> GearForces:
    """Set up the force laws; the yoke is adjusted so that the preload acts at rest on a gear without runout."""
    pair = GearPair.of(gear)
    zone = fidelity.zone_ratio * least_sliding(pair) * gear.test.speed

    samples = contact_data(
        gear, profile=fidelity.profile_samples, axial=fidelity.axial_samples, friction_zone=zone
    )
    ideal = samples._replace(friction=0.0, centres=samples.centres - pair.eccentricity)
    approach = approach_under(gear.yoke.preload, sampled_element(ideal))
    chain = adams_chain(gear) if fidelity.bush == "adams-chain" else bush_chain(gear)
    return GearForces(
        mesh=sampled_element(samples),
        seat=plunger.seat(
            gear, friction_zone=zone, rest_gap=approach + gear.yoke.preload / gear.yoke.seat_stiffness
        ),
        spring=plunger.spring(gear),
        nut=plunger.nut_contact(gear),
        bearing=pinion.bearing(gear, friction_zone=fidelity.zone_ratio * gear.test.speed),
        chain=chain,
        chain_fit=sliding_fit.chain_fit(gear, chain, friction_zone=zone),
        condensed_fit=sliding_fit.condensed_fit(gear, chain, friction_zone=zone),
        friction_zone=zone,
    )


def least_sliding(pair: GearPair) -> float:
    """Smallest sliding speed of the teeth in mesh over the pinion's speed [m]."""
    levers = pair.friction_lever(np.linspace(*pair.field, 201))
    return float(max(levers.min(), LEAST_LEVER_SHARE * levers.mean()))
