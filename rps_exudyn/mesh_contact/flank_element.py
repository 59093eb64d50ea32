"""The analytic flank contact as a force element: plane against helicoid on the coordinates of the bodies."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel_over
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.rigid_motion import rotation_matrix, spin_map, times
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_contact import flank_contact
from rps_exudyn.mesh_contact.flank_data import pack, pack_generators
from rps_exudyn.mesh_contact.flank_quadrature import flank_quadrature
from rps_exudyn.mesh_contact.wrench import MESH_OUTPUTS, on_coordinates
from rps_exudyn.parameters.gear import SteeringGear

Kernel = Callable[..., Any]

DEEPEST = 0.1e-3  # penetration [m]: the strip's half width is then a sixth of the radius of curvature


class FlankContactData(NamedTuple):
    """A gear as the flank contact kernel knows it."""

    table: np.ndarray  # from `flank_data`
    rack_reference: np.ndarray  # rack's reference point at displacement 0, shape (3,) [m]


@cache
def on_bodies(contact: Kernel) -> Kernel:
    """Forces of the teeth on q = pinion (1), rack (6), by a mesh contact kernel (see `wrench`)."""

    def flank_force(q, v, data):  # type: ignore[no-untyped-def]
        map_ = spin_map(q[4:7])
        position = data.rack_reference + q[1:4]
        wrench = contact(
            q[0], v[0], position, rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7]), data.table
        )
        return on_coordinates(wrench, map_)

    return kernel_over(flank_force, contact)


def flank_element(gear: SteeringGear, *, friction_zone: float, along: int, across: int) -> ForceElement:
    """Contact of the pinion's helicoids with the rack's planes, integrated over strips."""
    return _element(gear, flank_contact, pack(gear, zone=friction_zone, along=along, across=across))


def generator_element(gear: SteeringGear, *, friction_zone: float, generators: int) -> ForceElement:
    """The same, integrated generator by generator: slower, with no expansion in it.

    Raises:
        InputError: a gear with another contact law than pressure per depth.
    """
    if gear.mesh.law != "area":
        raise InputError(f"mesh.law is {gear.mesh.law}; fidelity.mesh = flank-generators knows only area.")
    return _element(gear, flank_quadrature, pack_generators(gear, zone=friction_zone, generators=generators))


def _element(gear: SteeringGear, contact: Kernel, table: np.ndarray) -> ForceElement:
    reference = np.array([0.0, GearPair.of(gear).bar_axis_height, 0.0])
    data = FlankContactData(table, reference)
    return ForceElement(
        "mesh", ("pinion", "rack"), on_bodies(contact), data, MESH_OUTPUTS, {"mesh_penetration": DEEPEST}
    )
