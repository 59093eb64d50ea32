"""All force elements of a gear, as modelled: what `statics` balances and `model` integrates."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import Handle
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces import bearing, external_load, sliding_fit, yoke
from rps_exudyn.forces.bush import Chain, adams_chain, bush_chain
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import PLAIN
from rps_exudyn.forces.memory import Memory
from rps_exudyn.forces.yoke_without_plunger import yoke_as_force
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_inertia, rack_masses
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.mesh_contact.flank_data import FlankData
from rps_exudyn.mesh_contact.flank_element import flank_element, flank_force_and_tangent, generator_element
from rps_exudyn.mesh_contact.ratio import ratio_element
from rps_exudyn.mesh_contact.sampled_contact import sampled_element
from rps_exudyn.mesh_contact.spheres import contact_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.bent_bar import ALONG_BAR, ON_BAR, BentBar, bent_bar
from rps_exudyn.solvers.closed_form import closed_form
from rps_exudyn.solvers.flexible_kernel import FlexibleData, flexible_gear_force, flexible_tangent
from rps_exudyn.solvers.gear_kernel import (
    COORDINATE_BLOCKS,
    GearData,
    Kernel,
    chain_gear_force,
    gear_force,
    gear_tangent,
)
from rps_exudyn.solvers.linear_spheres import standing_out
from rps_exudyn.solvers.newton_follower import newton_follower
from rps_exudyn.solvers.newton_path import NewtonLaw
from rps_exudyn.solvers.newton_tangent import outputs_along
from rps_exudyn.solvers.settling import static_approach
from rps_exudyn.solvers.sphere_groups import by_touching_angle

RACK = COORDINATE_BLOCKS["rack"].start
PLUNGER = COORDINATE_BLOCKS["plunger"].start
GUIDED = tuple(range(RACK + 2, RACK + 6))  # what a guided rack lacks: sideways motion, roll, yaw, pitch

# Data of parts that a gear does not have
NOTHING: dict[str, Any] = {
    "spring": yoke.SpringData(0.0, 0.0),
    "nut": yoke.NutData(0.0, 0.0),
    "load": external_load.NO_FORCE,
    "weight": external_load.NO_FORCE,
}


@dataclass(frozen=True)
class GearForces:
    """The force elements of a gear, by part."""

    mesh: ForceElement
    seat: ForceElement  # of the plunger on the rack; or the whole yoke as a force
    spring: ForceElement | None
    nut: ForceElement | None
    bearing: ForceElement
    fit: ForceElement  # of the rack in the bush, as modelled
    load: ForceElement | None  # at the rack's end
    weight: ForceElement | None  # of the rack
    condensed_fit: ForceElement  # the fit in a bush whose static stiffness is condensed into it
    chain: Chain
    friction_zone: float  # [m/s]
    locked: tuple[int, ...]  # coordinates of the stack that are held at zero
    bar: BentBar | None  # of the rack, where it bends or is not straight
    approach: float  # of the rack under the preload at rest [m]
    ideal: ForceElement  # the mesh without friction and runout, by which the yoke is adjusted
    memory: Memory = field(default_factory=Memory)  # of friction that remembers

    @property
    def elements(self) -> list[ForceElement]:
        """Force elements that the gear has, in the order of their parts."""
        parts = (self.mesh, self.seat, self.spring, self.nut, self.bearing, self.fit, self.load, self.weight)
        return [part for part in parts if part is not None]

    @property
    def statics(self) -> Balance:
        """Compiled sum of all forces on pinion, rack and plunger, with the bush condensed."""
        total = gear_force if self.bar is None else flexible_gear_force
        kernel = total(self.mesh.kernel, self.seat.kernel)
        modes = 0 if self.bar is None else self.bar.modes
        return Balance(
            kernel,
            self._data(self.condensed_fit),
            self.locked,
            modes=modes,
            memory=self.memory.array,
            newton=self._newton,
        )

    @property
    def _newton(self) -> NewtonLaw | None:
        """The forces with their tangent, of a rigid rack under a plunger where no friction remembers."""
        known = self.mesh.tangent is not None and self.seat.kernel is yoke.seat_force
        if not known or self.bar is not None or self.memory.needed:
            return None
        return NewtonLaw(newton_follower(self.mesh.tangent, self.seat.kernel), self.approach)

    def outputs(self, coordinates: np.ndarray, rates: np.ndarray) -> np.ndarray | None:
        """Return all elements' outputs (n, 73) at states of `dynamics` (n, 8) each, see
        `newton_tangent.OUTPUTS`; None of gears that Newton's method does not know, and of a chain."""
        if self._newton is None or "segment" in self.fit.bodies:
            return None
        each = outputs_along(self.mesh.tangent, self.seat.kernel)
        return np.asarray(each(coordinates, rates, self._data(self.fit)))

    @property
    def dynamics(self) -> tuple[Kernel, Handle]:
        """Compiled sum of all forces, with the bush as modelled."""
        if self.bar is not None:
            total = flexible_gear_force
        else:
            total = chain_gear_force if "segment" in self.fit.bodies else gear_force
        return total(self.mesh.kernel, self.seat.kernel), self._data(self.fit)

    @property
    def without_mesh(self) -> tuple[Kernel, Handle]:
        """The same without the teeth, where these are spheres: none of them is near the mesh."""
        out_of_mesh = replace(self.mesh, data=self.mesh.data._replace(gate=-1.0))
        return self.dynamics[0], replace(self, mesh=out_of_mesh)._data(self.fit)

    @property
    def dynamics_tangent(self) -> Kernel:
        """Compiled tangent of `dynamics`, a function as `gear_kernel.tangent` returns."""
        if self.bar is not None:
            return flexible_tangent(self.mesh.kernel, self.seat.kernel)
        return gear_tangent(self.dynamics[0])

    def packed(self, fit: ForceElement) -> GearData:
        """Return the constants of all force laws, with the rack in a fit."""
        parts = {name: getattr(self, name) for name in GearData._fields if name != "memory"} | {"fit": fit}
        data = {name: part.data if part else NOTHING[name] for name, part in parts.items()}
        return GearData(**data, memory=self.memory.array)

    def _data(self, fit: ForceElement) -> Handle:
        gear = self.packed(fit)
        return Handle(gear if self.bar is None else FlexibleData(gear, self.bar.data))


def gear_forces(gear: SteeringGear, fidelity: Fidelity, rack_load: float = 0.0) -> GearForces:
    """Set up the force laws; a load [N] pulls the rack's end towards -X.

    The yoke is adjusted so that the preload acts at rest on a gear without runout.
    """
    pair = GearPair.of(gear)
    zone, memory = fidelity.zone_ratio * pair.least_sliding * gear.test.speed, Memory()
    check_friction_laws(gear, fidelity)
    mesh = mesh_element(gear, fidelity, zone, memory)
    ideal = ideal_mesh(gear, fidelity, mesh, zone)
    approach = static_approach(gear.yoke.preload, ideal.kernel, ideal.data, pair.axis_offset, ideal.tangent)
    chain = adams_chain(gear) if fidelity.bush == "adams-chain" else bush_chain(gear)
    condensed = sliding_fit.condensed_fit(gear, chain, friction_zone=zone, memory=memory)
    fits = {
        "chain": lambda: sliding_fit.chain_fit(gear, chain, friction_zone=zone, memory=memory),
        "adams-chain": lambda: sliding_fit.chain_fit(gear, chain, friction_zone=zone, memory=memory),
        "condensed": lambda: condensed,
        "rigid": lambda: sliding_fit.rigid_fit(gear, friction_zone=zone, memory=memory),
    }
    fit = (
        sliding_fit.loose_fit(gear, friction_zone=zone, memory=memory)
        if fidelity.rack == "guided"
        else fits[fidelity.bush]()
    )
    with_plunger = fidelity.yoke == "body"
    if with_plunger:
        rest_gap = approach + gear.yoke.preload / gear.yoke.seat_stiffness
        seat = yoke.seat(gear, friction_zone=zone, rest_gap=rest_gap, memory=memory)
    else:
        seat = yoke_as_force(gear, friction_zone=zone, approach=approach, memory=memory)
    load = load_at_end(gear, rack_load) if rack_load or gear.rack.side_force else None
    places = {"mesh": (0.0, ALONG_BAR), "seat": (0.0, ALONG_BAR), "bush": (fit.data.station, ALONG_BAR)}
    if load is not None:
        places["load"] = (load.data.place, ON_BAR)
    return GearForces(
        mesh=mesh,
        seat=seat,
        spring=yoke.spring(gear) if with_plunger else None,
        nut=yoke.nut_contact(gear) if with_plunger else None,
        bearing=bearing.bearing(gear, friction_zone=fidelity.zone_ratio * gear.test.speed, memory=memory),
        fit=fit,
        load=load,
        weight=rack_weight(gear) if gear.installation.gravity else None,
        condensed_fit=condensed if "segment" in fit.bodies else fit,
        chain=chain,
        friction_zone=zone,
        locked=(*(GUIDED if fidelity.rack == "guided" else ()), *(() if with_plunger else (PLUNGER,))),
        bar=bent_bar(gear, fidelity, places),
        approach=approach,
        ideal=ideal,
        memory=memory,
    )


def check_friction_laws(gear: SteeringGear, fidelity: Fidelity) -> None:
    """Check that the model knows the gear's friction laws.

    Raises:
        InputError: it does not.
    """
    laws = {part: getattr(gear, part).friction_law for part in RUBBING_PARTS}
    for part, law in laws.items():
        if law == "bristle" and fidelity.mesh == "general-contact":
            raise InputError(
                f"{part}.friction_law is bristle, but fidelity.mesh = general-contact remembers nothing: "
                "choose fidelity.mesh = flank."
            )
    if laws["mesh"] != "coulomb" and not fidelity.mesh.startswith("flank"):
        raise InputError(
            f"mesh.friction_law is {laws['mesh']}, but fidelity.mesh = {fidelity.mesh} knows only coulomb: "
            "choose fidelity.mesh = flank."
        )


def following_inertia(gear: SteeringGear) -> tuple[float, float]:
    """Return what follows the drive: the pinion's moment of inertia [kg m^2] and the rack's mass [kg]."""
    return pinion_inertia(gear), rack_masses(gear).mass


def load_at_end(gear: SteeringGear, rack_load: float) -> ForceElement:
    """Return the load [N] along -X and the side force at the rack's end beside the pinion."""
    rack = gear.rack
    across = rack.side_force * np.cos(rack.side_angle), rack.side_force * np.sin(rack.side_angle)
    return external_load.end_load(rack_load, (float(across[0]), float(across[1])), RackBar.of(gear).x_min)


def rack_weight(gear: SteeringGear) -> ForceElement:
    """Return the rack's weight, which acts at its mass centre."""
    bar = rack_masses(gear)
    return external_load.weight(bar.mass, gear.installation.gravity, float(bar.centre_of_mass[0]))


def mesh_element(
    gear: SteeringGear, fidelity: Fidelity, zone: float, memory: Memory | None = None
) -> ForceElement:
    """Return the contact of the teeth as the fidelity models it; of general contact its compiled samples."""
    if fidelity.mesh == "flank":
        along, across = fidelity.strip_stations, fidelity.strip_points
        return flank_element(gear, friction_zone=zone, along=along, across=across, memory=memory)
    if fidelity.mesh == "flank-generators":
        return generator_element(gear, friction_zone=zone, generators=fidelity.generators, memory=memory)
    if fidelity.mesh == "ratio":
        return ratio_element(gear)
    if fidelity.mesh == "ratio-with-loss":
        return ratio_element(gear, closed_form(gear).towards(gear.test.direction).mesh_loss)
    grid = {"profile": fidelity.profile_samples, "axial": fidelity.axial_samples}
    spheres = standing_out(contact_data(gear, **grid, friction_zone=zone), gear, **grid)
    return sampled_element(by_touching_angle(spheres, GearPair.of(gear)))


def ideal_mesh(gear: SteeringGear, fidelity: Fidelity, mesh: ForceElement, zone: float) -> ForceElement:
    """Return the gear's mesh without friction and runout."""
    if isinstance(mesh.data, FlankData):
        data = mesh.data._replace(friction=0.0, law=PLAIN, eccentric_e=0.0, eccentric_y=0.0)
        return replace(mesh, data=data, tangent=flank_force_and_tangent)
    ideal = gear.replace({"pinion.runout": 0.0, "mesh.friction": 0.0, "mesh.friction_law": "coulomb"})
    return mesh_element(ideal, fidelity, zone)
