"""The torque of a pinion of flat facets, as it is cut or as it is meshed, by contact of triangles.

    run = faceted_run(gear, FACETED, shaped(100))

A pinion shaped in n cuts per turn is bounded by planes that touch the helicoid along generators from
outside, a mesh by chords from inside. Pressure per depth is the same everywhere, as law "area" has it, so
that analytic flanks by that law are an independent reference.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from rps_exudyn.forces.yoke import seat_under
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.settling import static_approach
from rps_exudyn.tooth_contact.mesh_search import mesh_data
from rps_exudyn.tooth_contact.spheres import mesh_distance, sample_flank
from rps_exudyn.tooth_contact.triangles import convex_faces, own_corners, own_polygons, triangles_of
from verification.equilibria import equilibria
from verification.law_area import by_law
from verification.shaping import shaped_pinion

Surface = Callable[[SteeringGear], np.ndarray]
"""Facets of a gear's pinion, (m, 3, 3) [m]."""

FACETED = Fidelity.preset("quasi-static").replace({"mesh": "triangles", "step_angle": "0.5 deg"})


def shaped(cuts: int) -> Surface:
    """The pinion as it is cut, `cuts` times per turn."""

    def facets(gear: SteeringGear) -> np.ndarray:
        vertices, faces = shaped_pinion(GearPair.of(gear), cuts)
        return vertices[faces]

    return cache(facets)


def meshed(chord_error: float) -> Surface:
    """The closed pinion as `gears.pinion_mesh` makes it, within a chord error [m]."""

    def facets(gear: SteeringGear) -> np.ndarray:
        mesh = pinion_mesh(GearPair.of(gear), chord_error)
        return mesh.vertices[mesh.faces]

    return cache(facets)


def flanks(chord_error: float) -> Surface:
    """The open flanks that the model has, within a chord error [m]."""
    return lambda gear: own_corners(gear, chord_error)


def cut_rack(gear: SteeringGear, chord_error: float = 40e-6) -> list[np.ndarray]:
    """Faces of the rack as a Boolean cut leaves it."""
    solid = RackBar.of(gear).solid(chord_error).to_mesh64()
    return convex_faces(np.array(solid.vert_properties[:, :3])[np.array(solid.tri_verts, dtype=np.int64)])


def faceted_run(
    gear: SteeringGear, fidelity: Fidelity, surface: Surface, rack: list[np.ndarray] | None = None
) -> SceneRun:
    """The free pinion torque of a gear; the rack's own flanks unless other faces are given."""
    maneuver = maneuvers_of_test(gear, "pinion", fidelity.step_angle)[0]
    return equilibria(gear, faceted_forces(gear, fidelity, surface, rack), maneuver)


def faceted_forces(
    gear: SteeringGear, fidelity: Fidelity, surface: Surface, rack: list[np.ndarray] | None = None
) -> GearForces:
    """The gear's forces with these surfaces, the yoke adjusted to them without friction and runout."""
    gear = by_law(gear, "line")
    corners, polygons = surface(gear), rack or own_polygons(gear, fidelity.chord_error)
    forces = gear_forces(gear, fidelity)
    gears, smooth, meshes = forces.gears.copy(), forces.ideal.copy(), mesh_data(corners, polygons)
    record, numbers = triangles_of(gear, fidelity, forces.friction_zone, forces.pool.size, meshes)
    record["least_rho"], record["by_curvature"] = 1.0, gear.mesh.stiffness  # the same whatever rho is
    record["standing_out"] = 0.0
    gears["mesh"]["triangles"], pool = record, np.concatenate([forces.pool, numbers])
    record["friction"] = record["middle"] = 0.0
    smooth["mesh"]["triangles"] = record
    offset = GearPair.of(gear).axis_offset
    approach = static_approach(gear.yoke.preload, forces.law, smooth, pool, offset)
    gears["seat"]["rest_gap"] = approach + seat_under(gear).depth
    return replace(forces, gears=gears, pool=pool, approach=approach, ideal=smooth)


def largest_deviation(gear: SteeringGear, surface: Surface) -> float:
    """Largest distance of the facets from a flank where it meets the rack [m]."""
    flank = Flank(GearPair.of(gear), 0, -1)
    triangles = surface(gear)
    near = (np.abs(flank.distance(triangles)) < 0.1e-3).all(axis=1)
    return float(np.abs(mesh_distance(sample_flank(flank, 400, 3, 0.0), triangles[near])).max())
