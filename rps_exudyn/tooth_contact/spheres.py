"""Spheres on the pinion's flanks that stand for the teeth in general contact, and the planes they meet.

Spheres just inside the flank, of radius r, touch a plane as the flank does but with the radius of curvature
rho - r. A strip of contact is wider by sqrt(rho / (rho - r)) for it, and their stiffness is less by as much.
With the stiffness k dA of the area that a sphere stands for, the load per length of a line at the depth d is

    F' = 4/3 k d sqrt(2 rho d).

`mesh.law` chooses k: "area" takes it as given, the same everywhere. "line" takes
k = 3/4 c' / sqrt(2 rho d_0), so that F' = c' d sqrt(d / d_0) does not depend on the radius of curvature, and
is the line law's c' d at the mean depth d_0 under the preload.

Samples of a flank make a regular grid of midpoints over the part that meets the rack: the tangent length q
between the limits of contact, the axial Z between the face's or the round bar's ends at that height. Every
sample carries the area of its cell, so that no edge sample counts too much. The line of contact crosses the
grid slantwise, which is why a few rows sample it evenly.
"""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import flank_patch
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.mean_depth import axial_reach, contact_ends, mean_depth, rack_approach
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData

EDGE = 1e-9  # barycentric tolerance: a ray through a common edge belongs to both triangles


class FlankSamples(NamedTuple):
    """Samples of one flank in the pinion frame."""

    points: np.ndarray  # (n, 3) [m]
    normals: np.ndarray  # (n, 3) out of the tooth
    areas: np.ndarray  # (n,) [m^2]
    curvature_radii: np.ndarray  # (n,) across the generators [m]


def sample_flank(flank: Flank, profile: int, axial: int, approach: float) -> FlankSamples:
    """`profile` x `axial` samples on the part of the flank that meets a rack pressed in by `approach` [m].

    A point of the flank meets the rack once per turn, at a height and a lateral place that do not depend
    on the travel; what lies beyond the rack's tips or its round bar is left out here, so the rack's flanks
    need no edges of their own. Half a tenth of a millimetre of approach moves the tips' limit by 3 % of the
    path of contact: it must be known here.
    """
    pair = flank.pair
    q_start, q_tip = contact_ends(pair, approach)
    q_step = (q_tip - q_start) / profile
    q = (q_start + q_step * (np.arange(profile) + 0.5))[:, None]

    low, high = axial_reach(pair, flank.side, q, approach)
    Z = low + (high - low) * (np.arange(axial) + 0.5) / axial
    psi = flank.generator(q, Z)
    step_psi = q_step / pair.base_radius
    radii = np.broadcast_to(flank.area_element(psi, Z), Z.shape)
    areas = radii * step_psi * np.broadcast_to((high - low) / axial, Z.shape)
    return FlankSamples(
        flank.point(psi, Z).reshape(-1, 3), flank.normal(psi).reshape(-1, 3), areas.ravel(), radii.ravel()
    )


def mesh_distance(samples: FlankSamples, triangles: np.ndarray) -> np.ndarray:
    """Distances of samples from a triangulated flank along their normals, shape (n,) [m].

    `triangles` (m, 3, 3) [m] are those of the flank, and may be more; of several crossings the nearest
    counts. It is 0 where no triangle lies under the sample.
    """
    a, edge1, edge2 = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(edge1, edge2)
    p, d = samples.points, samples.normals
    moment = np.cross(p, d)
    # Moeller and Trumbore for all pairs: p + t d = a + u edge1 + v edge2
    with np.errstate(divide="ignore", invalid="ignore"):
        det = d @ normal.T
        t = (np.einsum("ij,ij->i", normal, a) - p @ normal.T) / det
        u = (d @ np.cross(edge2, a).T - moment @ edge2.T) / det
        v = -(d @ np.cross(edge1, a).T - moment @ edge1.T) / det
        inside = (u >= -EDGE) & (v >= -EDGE) & (u + v <= 1 + EDGE)
    t = np.where(inside, t, np.inf)
    nearest = np.take_along_axis(t, np.argmin(np.abs(t), axis=1)[:, None], axis=1)
    return np.where(np.isfinite(nearest), nearest, 0.0)[:, 0]


CHORD_ERROR = 0.1e-6  # of the pinion's mesh [m]
SIDES = (-1, +1)  # drive, coast
RADIUS = 0.1 / 1.75  # of a sphere, in modules: 0.1 mm on the paper's gear
# By which a triangle is larger than its flank, in modules. Beyond the rack's tips it must not reach the teeth
# that are out of mesh: from one module on it does.
FLANK_MARGIN = 0.25
GATE_MARGIN = np.deg2rad(25.0)  # beyond the angle at which a tooth space's flanks leave the rack
SHALLOWEST = 0.1e-6  # depth for which spheres of the law "line" are made, at least [m]


def contact_data(gear: SteeringGear, *, profile: int, axial: int, friction_zone: float) -> SampledContactData:
    """Spheres on the triangulated flanks of all tooth spaces, and the planes they meet.

    The mesh is that of the perfect flanks, ruled from end to end of their generators; relief, crowning and
    errors, which bend within a generator, move the spheres by as much as they move the flank.
    """
    pair, bar = GearPair.of(gear), RackBar.of(gear)
    depth = mean_depth(gear)
    perfect, approach = replace(pair, runout=0.0), rack_approach(pair, depth)
    centres, areas, radii = _spheres(perfect, FlankForm.of(gear), profile, axial, approach)
    rack_flanks = [bar.flank(0, side) for side in SIDES]
    return SampledContactData(
        centres=centres + pair.eccentricity,
        stiffness=areas * stiffness_per_area(gear, depth, radii),
        radius=sphere_radius(pair),
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


def sphere_radius(pair: GearPair) -> float:
    """Radius of the spheres [m]. It bounds the depth of a contact, and is small against the flank's."""
    return RADIUS * pair.module


def stiffness_per_area(gear: SteeringGear, depth: float, rho: np.ndarray) -> np.ndarray:
    """Return a sphere's stiffness over its area by the gear's `mesh.law` [N/m^3].

    A sphere that is larger than the flank's radii of curvature `rho` [m] does not fit in, and bears nothing.

    Raises:
        InputError: a gear with a law that spheres cannot have.
    """
    law = gear.mesh.contact_law
    if law not in ("area", "line"):
        raise InputError(
            f"mesh.law is {law}, but fidelity.mesh = general-contact has only line: set mesh.law = line."
        )
    fits = np.sqrt(np.maximum(1 - sphere_radius(GearPair.of(gear)) / rho, 0.0))
    if law == "area":
        return gear.mesh.stiffness * fits
    return 3 / 4 * line_stiffness(gear) / np.sqrt(2 * rho * max(depth, SHALLOWEST)) * fits


@lru_cache(maxsize=2)  # they may be many
def _spheres(
    pair: GearPair, form: FlankForm, profile: int, axial: int, approach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres in the pinion frame without runout (z, 2, n, 3) [m], areas [m^2] and the flank's radii of
    curvature [m], (z, 2, n) each, by tooth space, drive and coast flank; of a rack pressed in."""

    def off_mesh(side: int) -> np.ndarray:
        """How far the triangles lie off the perfect flank; the same on each tooth."""
        flank = Flank(pair, 0, side)
        patch = flank_patch(flank, CHORD_ERROR)
        return mesh_distance(sample_flank(flank, profile, axial, approach), patch.points[patch.faces])

    off = {side: off_mesh(side) for side in SIDES}

    def samples_of(tooth: int, side: int) -> FlankSamples:
        perfect = sample_flank(Flank(pair, tooth, side), profile, axial, approach)
        formed = sample_flank(Flank(pair, tooth, side, form), profile, axial, approach)
        return formed._replace(points=formed.points + off[side][:, None] * perfect.normals)

    samples = [[samples_of(*flank) for flank in borders(space)] for space in range(pair.teeth)]
    radius = sphere_radius(pair)
    return (
        np.array([[s.points - radius * s.normals for s in row] for row in samples]),
        np.array([[s.areas for s in row] for row in samples]),
        np.array([[s.curvature_radii for s in row] for row in samples]),
    )


def borders(space: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Tooth and side of the two flanks that border a tooth space: drive, coast."""
    return (space, -1), (space - 1, +1)


def lowest_height(pair: GearPair) -> float:
    """y in the rack frame where the triangles end, a little beyond the tooth tips [m]."""
    return -(pair.reference_height + pair.rack_addendum + FLANK_MARGIN * pair.module)


def gate_angle(pair: GearPair) -> float:
    """Largest angle from the mesh at which a tooth space can touch the rack, with a margin [rad]."""
    q0, qa = pair.active_path
    roll = max(abs(q0), abs(qa)) / pair.base_radius
    return float(roll + abs(pair.twist) * pair.face_width / 2 + GATE_MARGIN)
