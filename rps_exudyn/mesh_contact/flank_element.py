"""The analytic flank contact as a force element: plane against helicoid on the coordinates of the bodies."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import borrowing, kernel
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.memory import Memory
from rps_exudyn.forces.rigid_motion import fill_rotation, spin_of, turn_of
from rps_exudyn.mesh_contact.contact_tangent import add_on_coordinates
from rps_exudyn.mesh_contact.elastic_teeth import teeth_contact, teeth_contact_tangent
from rps_exudyn.mesh_contact.flank_contact import flank_contact, flank_contact_tangent
from rps_exudyn.mesh_contact.flank_data import FlankData, pack
from rps_exudyn.mesh_contact.teeth_data import TeethData, teeth_data
from rps_exudyn.mesh_contact.wrench import MESH_OUTPUTS, on_coordinates
from rps_exudyn.parameters.gear import SteeringGear

Kernel = Callable[..., Any]

DEEPEST = 0.055  # penetration over the module: the strip's half width is a sixth of the curvature's radius


@borrowing
def _posed(q, v, reference, pose):  # type: ignore[no-untyped-def]
    """Fill the rack's rotation, position and angular velocity, the rows of `pose` (5, 3); return its turn."""
    turn = turn_of(q[4:7])
    fill_rotation(q[4:7], pose)
    spin = spin_of(turn, v[4:7])
    for i in range(3):
        pose[3, i], pose[4, i] = reference[i] + q[1 + i], spin[i]
    return turn


@kernel
def flank_force(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of the teeth on q = pinion (1), rack (6)."""
    pose = np.empty((5, 3))
    turn = _posed(q, v, data.rack_reference, pose)
    wrench = flank_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], data)
    return on_coordinates(wrench, turn)


@kernel
def teeth_force(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of teeth that bend together on q = pinion (1), rack (6)."""
    pose = np.empty((5, 3))
    turn = _posed(q, v, data.flank.rack_reference, pose)
    wrench = teeth_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], data)
    return on_coordinates(wrench, turn)


@kernel
def flank_force_and_tangent(q, v, data, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """The same output; adds factor_q dF/dq + factor_v dF/dv to the tangent (7, 7)."""
    pose, stiffness = np.empty((5, 3)), np.zeros((6, 6))
    turn = _posed(q, v, data.rack_reference, pose)
    at = q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4]
    wrench = flank_contact_tangent(*at, data, stiffness, factor_q, factor_v)
    if factor_q != 0 or factor_v != 0:
        add_on_coordinates(wrench, q, turn, pose[3], stiffness, factor_q, data, tangent)
    return on_coordinates(wrench, turn)


@kernel
def teeth_force_and_tangent(q, v, data, factor_q, factor_v, tangent):  # type: ignore[no-untyped-def]
    """The same of teeth that bend together."""
    pose, stiffness = np.empty((5, 3)), np.zeros((6, 6))
    turn = _posed(q, v, data.flank.rack_reference, pose)
    at = q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4]
    wrench = teeth_contact_tangent(*at, data, stiffness, factor_q, factor_v)
    if factor_q != 0 or factor_v != 0:
        add_on_coordinates(wrench, q, turn, pose[3], stiffness, factor_q, data.flank, tangent)
    return on_coordinates(wrench, turn)


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
