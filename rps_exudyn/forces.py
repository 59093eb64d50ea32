"""All force elements of a gear, as modelled: what `statics` balances and `model` integrates."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.fidelity import Fidelity
from rps_exudyn.gear_kernel import GearData, Kernel, chain_gear_force, gear_force
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_element import flank_element
from rps_exudyn.mesh_contact.general_contact import contact_data
from rps_exudyn.mesh_contact.ratio import ratio_element, ratio_element_with_loss
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
    fit: ForceElement  # of the rack in the bush, as modelled
    condensed_fit: ForceElement  # the same in a bush whose static stiffness is condensed into it
    chain: Chain
    friction_zone: float  # [m/s]

    @property
    def elements(self) -> list[ForceElement]:
        """The whole gear."""
        return [self.mesh, self.seat, self.spring, self.nut, self.bearing, self.fit]

    @property
    def statics(self) -> tuple[Kernel, GearData]:
        """Compiled sum of all forces on pinion, rack and plunger, with the bush condensed."""
        return gear_force(self.mesh.kernel), self._data(self.condensed_fit)

    @property
    def dynamics(self) -> tuple[Kernel, GearData]:
        """Compiled sum of all forces, with the bush as modelled."""
        total = chain_gear_force if "segment" in self.fit.bodies else gear_force
        return total(self.mesh.kernel), self._data(self.fit)

    def _data(self, fit: ForceElement) -> GearData:
        parts = (self.mesh, self.seat, self.spring, self.nut, self.bearing, fit)
        return GearData(*(part.data for part in parts))


def gear_forces(gear: SteeringGear, fidelity: Fidelity) -> GearForces:
    """Set up the force laws.

    The yoke is adjusted so that the preload acts at rest on a gear without runout.
    """
    pair = GearPair.of(gear)
    zone = fidelity.zone_ratio * least_sliding(pair) * gear.test.speed
    mesh = mesh_element(gear, fidelity, zone)
    approach = approach_under(gear.yoke.preload, *ideal_mesh(gear, fidelity, zone), pair.axis_offset)
    rest_gap = approach + gear.yoke.preload / gear.yoke.seat_stiffness

    chain = adams_chain(gear) if fidelity.bush == "adams-chain" else bush_chain(gear)
    condensed = sliding_fit.condensed_fit(gear, chain, friction_zone=zone)
    fits = {
        "chain": lambda: sliding_fit.chain_fit(gear, chain, friction_zone=zone),
        "adams-chain": lambda: sliding_fit.chain_fit(gear, chain, friction_zone=zone),
        "condensed": lambda: condensed,
        "rigid": lambda: sliding_fit.rigid_fit(gear, friction_zone=zone),
    }
    fit = fits[fidelity.bush]()
    return GearForces(
        mesh=mesh,
        seat=plunger.seat(gear, friction_zone=zone, rest_gap=rest_gap),
        spring=plunger.spring(gear),
        nut=plunger.nut_contact(gear),
        bearing=pinion.bearing(gear, friction_zone=fidelity.zone_ratio * gear.test.speed),
        fit=fit,
        condensed_fit=fit if fidelity.bush == "rigid" else condensed,
        chain=chain,
        friction_zone=zone,
    )


def mesh_element(gear: SteeringGear, fidelity: Fidelity, zone: float) -> ForceElement:
    """The contact of the teeth; for general contact its compiled samples."""
    if fidelity.mesh == "flank":
        return flank_element(gear, friction_zone=zone)
    if fidelity.mesh == "ratio":
        return ratio_element(gear)
    if fidelity.mesh == "ratio-with-loss":
        return ratio_element_with_loss(gear)
    return sampled_element(
        contact_data(gear, profile=fidelity.profile_samples, axial=fidelity.axial_samples, friction_zone=zone)
    )


def ideal_mesh(gear: SteeringGear, fidelity: Fidelity, zone: float) -> tuple[Kernel, Any]:
    """Kernel and data of the mesh without friction and runout."""
    ideal = gear.replace({"pinion.runout": 0.0, "mesh.friction": 0.0})
    element = mesh_element(ideal, fidelity, zone)
    return element.kernel, element.data


def least_sliding(pair: GearPair) -> float:
    """Smallest sliding speed of the teeth in mesh over the pinion's speed [m]."""
    levers = pair.friction_lever(np.linspace(*pair.field, 201))
    return float(max(levers.min(), LEAST_LEVER_SHARE * levers.mean()))
