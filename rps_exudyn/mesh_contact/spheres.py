"""Spheres on the pinion's flanks that stand for the teeth in general contact, and the planes they meet.

Each sphere has the stiffness of the area it stands for and lies just inside its flank.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.mesh_contact.sampled_contact import SampledContactData
from rps_exudyn.mesh_contact.samples import FlankSamples, onto_mesh, sample_flank
from rps_exudyn.parameters.gear import SteeringGear

CHORD_ERROR = 0.1e-6  # of the pinion's mesh [m]
SIDES = (-1, +1)  # drive, coast
# With the radius grow the torque's bias (-0.1 % per 0.1 mm) and the deepest contact allowed
SPHERE_RADIUS = 0.1e-3  # [m]
FLANK_MARGIN = 1e-3  # by which a triangle is larger than its flank [m]
GATE_MARGIN = np.deg2rad(25.0)  # beyond the angle at which a tooth space's flanks leave the rack


def contact_data(gear: SteeringGear, *, profile: int, axial: int, friction_zone: float) -> SampledContactData:
    """Spheres on the triangulated flanks of all tooth spaces, and the planes they meet.

    The mesh is that of the perfect flanks, ruled from end to end of their generators; relief, crowning and
    errors, which bend within a generator, move the spheres by as much as they move the flank.
    """
    pair, bar = GearPair.of(gear), RackBar.of(gear)
    centres, areas = _spheres(replace(pair, runout=0.0), FlankForm.of(gear), profile, axial)
    rack_flanks = [bar.flank(0, side) for side in SIDES]
    return SampledContactData(
        centres=centres + pair.eccentricity,
        stiffness=gear.mesh.stiffness * areas,
        radius=SPHERE_RADIUS,
        damping=gear.mesh.damping,
        friction=gear.mesh.friction,
        zone=friction_zone,
        gate=gate_angle(pair),
        pinion_origin=pair.pinion_origin,
        pinion_frame=pair.pinion_frame,
        normals=np.array([flank.normal for flank in rack_flanks]),
        offset=np.array([flank.normal @ flank.point for flank in rack_flanks]),
        base_pitch=pair.normal_base_pitch,
        lowest=lowest_height(pair),
        rack_reference=np.array([0.0, pair.bar_axis_height, 0.0]),
    )


@lru_cache(maxsize=2)  # they may be many
def _spheres(pair: GearPair, form: FlankForm, profile: int, axial: int) -> tuple[np.ndarray, np.ndarray]:
    """Centres (z, 2, n, 3) [m] and areas (z, 2, n) [m^2] by tooth space, drive and coast flank."""
    mesh = pinion_mesh(pair, CHORD_ERROR)

    def samples_of(tooth: int, side: int) -> FlankSamples:
        perfect = sample_flank(Flank(pair, tooth, side), profile, axial)
        formed = sample_flank(Flank(pair, tooth, side, form), profile, axial)
        on_mesh = onto_mesh(perfect, mesh.vertices[mesh.flanks[tooth % pair.teeth, side].faces])
        return formed._replace(points=on_mesh.points + formed.points - perfect.points)

    samples = [[samples_of(*flank) for flank in borders(space)] for space in range(pair.teeth)]
    centres = np.array([[s.points - SPHERE_RADIUS * s.normals for s in row] for row in samples])
    return centres, np.array([[s.areas for s in row] for row in samples])


def borders(space: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Tooth and side of the two flanks that border a tooth space: drive, coast."""
    return (space, -1), (space - 1, +1)


def lowest_height(pair: GearPair) -> float:
    """y in the rack frame where the triangles end, a little beyond the tooth tips [m]."""
    return -(pair.reference_height + pair.rack_addendum + FLANK_MARGIN)


def gate_angle(pair: GearPair) -> float:
    """Largest angle from the mesh at which a tooth space can touch the rack, with a margin [rad]."""
    q0, qa = pair.active_path
    roll = max(abs(q0), abs(qa)) / pair.base_radius
    return float(roll + abs(pair.twist) * pair.face_width / 2 + GATE_MARGIN)
