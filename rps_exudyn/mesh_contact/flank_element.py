"""The analytic flank contact as a force element: plane against helicoid on the coordinates of the bodies."""

from typing import NamedTuple

import numpy as np

from rps_exudyn.compiled import kernel
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_contact import flank_contact
from rps_exudyn.mesh_contact.flank_data import pack
from rps_exudyn.mesh_contact.wrench import MESH_OUTPUTS, on_coordinates
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.parts.force_element import ForceElement
from rps_exudyn.parts.motion import rotation_matrix, spin_map, times

DEEPEST = 0.1e-3  # penetration [m]: the strip's half width is then a sixth of the radius of curvature


class FlankContactData(NamedTuple):
    """A gear as the flank contact kernel knows it."""

    table: np.ndarray  # from `flank_data.pack`
    rack_reference: np.ndarray  # rack's reference point at displacement 0, shape (3,) [m]


@kernel
def flank_force(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of the teeth; q = pinion (1), rack (6)."""
    map_ = spin_map(q[4:7])
    position = data.rack_reference + q[1:4]
    wrench = flank_contact(
        q[0], v[0], position, rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7]), data.table
    )
    return on_coordinates(wrench, map_)


def flank_element(gear: SteeringGear, *, friction_zone: float) -> ForceElement:
    """Contact of the pinion's helicoids with the rack's planes."""
    reference = np.array([0.0, GearPair.of(gear).bar_axis_height, 0.0])
    data = FlankContactData(pack(gear, zone=friction_zone), reference)
    return ForceElement(
        "mesh", ("pinion", "rack"), flank_force, data, MESH_OUTPUTS, {"mesh_penetration": DEEPEST}
    )
