"""The analytic flank contact as a force element: plane against helicoid on the coordinates of the bodies."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.memory import Memory
from rps_exudyn.forces.rigid_motion import rotation_matrix, spin_map, times
from rps_exudyn.mesh_contact.contact_tangent import add_on_coordinates, motions_of
from rps_exudyn.mesh_contact.elastic_teeth import teeth_contact, teeth_contact_tangent
from rps_exudyn.mesh_contact.flank_contact import flank_contact, flank_contact_tangent
from rps_exudyn.mesh_contact.flank_data import FlankData, pack
from rps_exudyn.mesh_contact.teeth_data import TeethData, teeth_data
from rps_exudyn.mesh_contact.wrench import MESH_OUTPUTS, on_coordinates
from rps_exudyn.parameters.gear import SteeringGear

Kernel = Callable[..., Any]

DEEPEST = 0.055  # penetration over the module: the strip's half width is a sixth of the curvature's radius


@kernel
def flank_force(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of the teeth on q = pinion (1), rack (6)."""
    map_ = spin_map(q[4:7])
    position = data.rack_reference + q[1:4]
    wrench = flank_contact(q[0], v[0], position, rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7]), data)
    return on_coordinates(wrench, map_)


@kernel
def teeth_force(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of teeth that bend together on q = pinion (1), rack (6)."""
    map_ = spin_map(q[4:7])
    position = data.flank.rack_reference + q[1:4]
    wrench = teeth_contact(q[0], v[0], position, rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7]), data)
    return on_coordinates(wrench, map_)


@kernel
def flank_force_and_tangent(q, v, data, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """The same output; adds factor_q dF/dq + factor_v dF/dv to the tangent (7, 7)."""
    map_, stiffness = spin_map(q[4:7]), np.zeros((6, 6))
    position = data.rack_reference + q[1:4]
    motion = rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7])
    wrench = flank_contact_tangent(q[0], v[0], position, *motion, data, stiffness, factor_q, factor_v)
    if factor_q == 0 and factor_v == 0:
        return on_coordinates(wrench, map_)
    motions = motions_of(q[0], position, map_, data)
    add_on_coordinates(wrench, q, motions, stiffness, factor_q, data, tangent)
    return on_coordinates(wrench, map_)


@kernel
def teeth_force_and_tangent(q, v, data, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """The same of teeth that bend together."""
    map_, stiffness, flank = spin_map(q[4:7]), np.zeros((6, 6)), data.flank
    position = flank.rack_reference + q[1:4]
    motion = rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7])
    wrench = teeth_contact_tangent(q[0], v[0], position, *motion, data, stiffness, factor_q, factor_v)
    if factor_q == 0 and factor_v == 0:
        return on_coordinates(wrench, map_)
    motions = motions_of(q[0], position, map_, flank)
    add_on_coordinates(wrench, q, motions, stiffness, factor_q, flank, tangent)
    return on_coordinates(wrench, map_)


def flank_element(
    gear: SteeringGear, *, friction_zone: float, along: int, across: int, memory: Memory | None = None
) -> ForceElement:
    """Contact of the pinion's helicoids with the rack's planes by the gear's law, integrated along lines."""
    flank = pack(gear, zone=friction_zone, along=along, across=across, memory=memory)
    if gear.mesh.law == "teeth":
        return _element(gear, teeth_force, teeth_force_and_tangent, teeth_data(gear, flank))
    return _element(gear, flank_force, flank_force_and_tangent, flank)


def generator_element(
    gear: SteeringGear, *, friction_zone: float, generators: int, memory: Memory | None = None
) -> ForceElement:
    """The same, integrated generator by generator: slower, with no expansion in it.

    Raises:
        InputError: a gear with another contact law than pressure per depth.
    """
    if gear.mesh.law != "area":
        raise InputError(
            f"mesh.law is {gear.mesh.law}, but fidelity.mesh = flank-generators knows only area: "
            "set mesh.law = area."
        )
    data = pack(gear, zone=friction_zone, generators=generators, memory=memory)
    return _element(gear, flank_force, flank_force_and_tangent, data)


def _element(gear: SteeringGear, force: Kernel, tangent: Kernel, data: FlankData | TeethData) -> ForceElement:
    limits = {"mesh_penetration": DEEPEST * gear.pinion.normal_module}
    known = tangent if gear.mesh.friction_law == "coulomb" else None
    return ForceElement("mesh", ("pinion", "rack"), force, data, MESH_OUTPUTS, limits, known)
