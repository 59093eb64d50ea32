"""All forces of a gear, as modelled: what equilibria balance and the multibody model integrates."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.forces import external_load, pinion_support, sliding_fit, yoke
from rps_exudyn.forces.bearing import bearing_record
from rps_exudyn.forces.bush import Chain, bush_chain
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, RACK, Part
from rps_exudyn.forces.friction import PLAIN, TIME, Patches
from rps_exudyn.forces.rigid_motion import rotation_matrix, spin_map
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_inertia, pinion_on_supports, rack_masses
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import PLAIN_LAW, RUBBING_PARTS, check_friction_laws
from rps_exudyn.parameters.gear import SteeringGear, surfaces_of
from rps_exudyn.parameters.retired import choice_instead
from rps_exudyn.solvers.balance import SIZE, Balance
from rps_exudyn.solvers.bent_rack import ALONG_BAR, ON_BAR, BentBar, bent_bar
from rps_exudyn.solvers.gear_model import GEAR, LAWS, OUTPUTS, PARTS, fill_outputs
from rps_exudyn.solvers.settling import static_approach
from rps_exudyn.solvers.sphere_groups import by_touching_angle, standing_out
from rps_exudyn.tooth_contact.elastic_teeth import room_of_teeth
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.laws import DEEPEST, KINDS
from rps_exudyn.tooth_contact.measured_flank import pooled_grids
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData, pooled
from rps_exudyn.tooth_contact.spheres import contact_data
from rps_exudyn.tooth_contact.teeth_data import teeth_data
from rps_exudyn.tooth_contact.teeth_stations import most_lines
from rps_exudyn.tooth_contact.triangles import triangles_of

MESH_LAWS = {"general-contact": "spheres", "triangles": "triangles"}
GUIDED = tuple(range(RACK + 2, RACK + 6))  # what a guided rack lacks: sideways motion, roll, yaw, pitch


@dataclass(frozen=True, eq=False, kw_only=True)
class GearForces(Balance):
    """The forces of a gear with its bush as modelled: the last segment of a chain follows in the stack."""

    pair: GearPair
    condensed: np.record  # record of the fit in a bush whose static stiffness is condensed into it
    chain: Chain  # the bush
    friction_zone: float  # [m/s]
    bar: BentBar | None  # of the rack, where it bends or is not straight
    # record of the gear without friction and runout in the mesh, by which the yoke is adjusted
    ideal: np.ndarray
    valid_to: dict[str, float]  # outputs above which the contact law does not hold any more, and their bounds
    spheres: SampledContactData | None = None  # of general contact

    @property
    def gear(self) -> np.record:
        """Return the record of the gear."""
        first: np.record = self.gears.view(np.recarray)[0]
        return first

    @cached_property
    def parts(self) -> list[Part]:
        """Return the parts that exert forces, in the order of their outputs."""
        having = {"load": "has_load", "weight": "has_weight", "support": "is_supported", "bore": "has_bore"}
        return [each for each in PARTS if each.name not in having or self.gear[having[each.name]]]

    @property
    def with_bristles(self) -> set[str]:
        """Return the names of the parts whose friction has a state."""
        gear = self.gear
        of_parts = {"mesh": gear.mesh.flank, "seat": gear.seat, "bush": gear.fit, "bearing": gear.bearing}
        of_parts |= {"support": gear.support, "bore": gear.bore}
        return {name for name, part in of_parts.items() if part.law.has_state}

    @property
    def has_chain(self) -> bool:
        """Return whether the rack slides in a segment of a chain."""
        return bool(self.gear.is_carried)

    @property
    def statics(self) -> Balance:
        """Return the forces on pinion, rack, plunger, modes and supports, with the bush condensed."""
        return replace(self, gears=self._condensed)

    @property
    def without_mesh(self) -> Balance:
        """Return the same without the teeth, where these are spheres: none of them is near the mesh."""
        gears = self.gears.copy()
        gears["mesh"]["spheres"]["gate"] = -1.0
        return replace(self, gears=gears)

    @cached_property
    def _condensed(self) -> np.ndarray:
        """The gear with the rack in the housing."""
        if not self.has_chain:
            return self.gears
        gears = self.gears.copy()
        gears["fit"], gears["is_carried"] = self.condensed, 0
        return gears

    def outputs(
        self, coordinates: np.ndarray, rates: np.ndarray, time: np.ndarray, begun: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the outputs of all parts at states (t, n), shape (t, `gear_model.OUTPUTS`).

        Coordinates have those of the last segment where the bush is a chain. `begun` is the bristles' state
        at the start of the steps that end at the times [s].
        """
        gears = self.gears if coordinates.shape[1] > self.size else self._condensed
        outputs = np.zeros((len(coordinates), OUTPUTS))
        state = np.zeros((len(coordinates), 0)) if begun is None else begun
        rows = (np.ascontiguousarray(each, dtype=float) for each in (coordinates, rates, time, state))
        if state.shape[1] == 0:
            self.memory[:, TIME] = 0.0
        fill_outputs(self.law, *rows, gears, self.pool, self.works, outputs)
        return outputs


Exchange = Callable[[GearForces, SteeringGear, Fidelity], GearForces]
"""The forces of a gear, the gear and its model -> the forces in their place."""

_exchange: ContextVar[Exchange | None] = ContextVar("exchange", default=None)


@contextmanager
def exchanged(by: Exchange) -> Iterator[None]:
    """Within the block put other forces in the place of those of every gear: laws that no model chooses."""
    token = _exchange.set(by)
    try:
        yield
    finally:
        _exchange.reset(token)


def gear_forces(gear: SteeringGear, fidelity: Fidelity, rack_load: float = 0.0) -> GearForces:
    """Set up the force laws; a load [N] pulls the rack's end towards -X.

    The yoke is adjusted so that the preload acts at rest on a gear without runout. Of general contact the
    laws are those of its compiled samples.

    Raises:
        InputError: a law of contact or friction that the model does not have.
    """
    pair, patches = GearPair.of(gear), Patches(fidelity.friction_elements)
    zone = fidelity.zone_ratio * pair.least_sliding * gear.test.speed
    check_friction_laws({part: getattr(gear, part) for part in RUBBING_PARTS}, fidelity.mesh)
    law = MESH_LAWS.get(fidelity.mesh, gear.mesh.contact_law)
    if law != "triangles" and (given := surfaces_of(gear)):
        raise InputError(f"{given[0]} is given, but fidelity.mesh is {fidelity.mesh}; it must be triangles.")
    if law not in LAWS:
        instead = choice_instead("mesh.law", law)
        raise InputError(f"mesh.law is {law!r}, which only earlier versions have: {instead}.")
    gears, ideal, pool, chain = np.zeros(1, GEAR), np.zeros(1, GEAR), np.zeros(1), bush_chain(gear)
    mesh, spheres, deepest = gears["mesh"], None, DEEPEST * gear.pinion.normal_module
    mesh["kind"] = KINDS.get(law, 0)
    if law == "spheres":  # one deeper than its radius passes through GeneralContact's triangles unnoticed
        spheres = spheres_of(gear, fidelity, zone)
        deepest = spheres.radius / 2
    elif law != "triangles":
        along, across = fidelity.strip_stations + (law == "teeth"), fidelity.strip_points
        mesh["flank"] = flank = pack(gear, zone=zone, along=along, across=across, patches=patches)
        if law == "teeth":
            mesh["teeth"], mesh["most_lines"] = teeth_data(gear, flank), most_lines(flank)
        ideal["mesh"] = mesh
        of_ideal = ideal["mesh"]["flank"]
        of_ideal["friction"], of_ideal["law"] = 0.0, PLAIN
        of_ideal["eccentric_e"] = of_ideal["eccentric_y"] = 0.0
    ideal["mesh"]["kind"] = mesh["kind"]
    fit, condensed = sliding_fit.fits(gear, fidelity, chain, friction_zone=zone, patches=patches)
    load = external_load.end_load(gear, rack_load) if rack_load or gear.rack.side_force else None
    places = {"mesh": (0.0, ALONG_BAR), "seat": (0.0, ALONG_BAR), "bush": (float(fit.station), ALONG_BAR)}
    if load is not None:
        places["load"] = (float(load.place), ON_BAR)
    bar = bent_bar(gear, fidelity, places)
    gears["fit"], gears["is_carried"] = fit, fit is not condensed
    gears["bearing"] = bearing_record(
        gear, friction_zone=fidelity.zone_ratio * gear.test.speed, patches=patches
    )
    if load is not None:
        gears["load"], gears["has_load"] = load, 1
    if gear.installation.gravity:
        gears["weight"], gears["has_weight"] = external_load.weight(gear), 1
    if bar is not None:
        pool, gears["bar"], gears["is_bent"] = bar.pool, bar.record, 1
    if (measured := measured_flanks(gear)).are_given and law not in MESH_LAWS.values():
        for each, part in product((gears, ideal), ("pinion_grid", "rack_grid")):
            each["mesh"]["flank"][part]["first"] += len(pool)
        pool = np.concatenate([pool, pooled_grids(measured)[2]])
    if law == "triangles":
        mesh["triangles"], numbers = triangles_of(gear, fidelity, zone, len(pool))
        ideal["mesh"], pool = mesh, np.concatenate([pool, numbers])
        ideal["mesh"]["triangles"]["friction"] = ideal["mesh"]["triangles"]["middle"] = 0.0
    if spheres is not None:
        perfect = {"pinion.runout": 0.0, "mesh.friction": 0.0, "mesh.friction_law": PLAIN_LAW}
        of_perfect = spheres_of(gear.replace(perfect), fidelity, zone)
        for each, of_gear in ((gears, spheres), (ideal, of_perfect)):
            each["mesh"]["spheres"], numbers = pooled(of_gear, len(pool))
            pool = np.concatenate([pool, numbers])
    if law == "teeth":
        mesh["room"] = ideal["mesh"]["room"] = len(pool)
        pool = np.concatenate([pool, np.zeros(room_of_teeth(flank))])
    approach = static_approach(gear.yoke.preload, LAWS[law], ideal, pool, pair.axis_offset)
    supported = np.zeros(0)
    if fidelity.pinion == "supported":
        gears["support"], gears["is_supported"] = pinion_support.support_record(gear, patches), 1
        supported, sunk = pinion_support.at_rest(gears["support"][0], gear.yoke.preload)
        approach += float(sunk)
    for name, of_part in yoke.records(gear, zone, approach, patches).items():
        gears[name] = of_part
    gears["has_bore"] = bool(gear.yoke.bore_friction or gear.yoke.bore_damping)
    gears["has_bristles"] = patches.needed
    made = GearForces(
        law=LAWS[law],
        gears=gears,
        pool=pool,
        pair=pair,
        condensed=condensed,
        chain=chain,
        friction_zone=zone,
        locked=GUIDED if fidelity.rack == "guided" else (),
        bar=bar,
        approach=approach,
        ideal=ideal,
        valid_to={"mesh_penetration": deepest},
        spheres=spheres,
        supported=supported,
    )
    exchange = _exchange.get()
    return exchange(made, gear, fidelity) if exchange else made


def mass_matrix(gear: SteeringGear, forces: GearForces, place: np.ndarray) -> np.ndarray:
    """Return the mass matrix of pinion, rack, plunger, modes and supports at a place (n,), shape (n, n)."""
    mass = np.eye(place.size)
    mass[0, 0], bar = pinion_inertia(gear), rack_masses(gear)
    angles = place[COORDINATE_BLOCKS["rack"]][3:]
    turn, spin = rotation_matrix(angles), spin_map(angles)
    x, y, z = turn @ bar.centre_of_mass
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    about_point = turn @ bar.inertia @ turn.T - bar.mass * cross @ cross
    beside = -bar.mass * cross @ spin
    rack = COORDINATE_BLOCKS["rack"]
    mass[rack, rack] = np.block([[bar.mass * np.eye(3), beside], [beside.T, spin.T @ about_point @ spin]])
    mass[SIZE - 1, SIZE - 1] = gear.yoke.plunger_mass
    if held := len(forces.supported):
        mass[-held:, -held:] = pinion_on_supports(gear)
    return mass


def accelerated(gear: SteeringGear, forces: GearForces) -> Balance:
    """Return the balance of forces in which all masses are accelerated, as at the middle of the travel."""
    return replace(forces.statics, masses=mass_matrix(gear, forces, np.zeros(forces.statics.size)))


def spheres_of(gear: SteeringGear, fidelity: Fidelity, zone: float) -> SampledContactData:
    """Return the spheres of general contact."""
    grid = {"profile": fidelity.profile_samples, "axial": fidelity.axial_samples}
    spheres = standing_out(contact_data(gear, **grid, friction_zone=zone), gear, **grid)
    return by_touching_angle(spheres, GearPair.of(gear))
