"""The torque of a pinion of flat facets, as it is cut or as it is meshed, by spheres in equilibrium.

    run = faceted_run(gear, spheres(108, 36), shaped(100))

A pinion shaped in n cuts per turn is bounded by planes that touch the helicoid along generators from
outside, a mesh by chords from inside. Spheres on the analytic flank are moved along its normal onto these
facets; all else is the general contact's. Compared with the same spheres on the analytic flank, the
difference is that of the facets alone.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from rps_exudyn.forces.yoke import seat_under
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.gear_model import GEAR
from rps_exudyn.solvers.settling import static_approach
from rps_exudyn.tooth_contact.mean_depth import mean_depth, rack_approach
from rps_exudyn.tooth_contact.sampled_contact import pooled
from rps_exudyn.tooth_contact.spheres import (
    FlankSamples,
    borders,
    contact_data,
    mesh_distance,
    sample_flank,
    sphere_radius,
)
from verification.equilibria import equilibria
from verification.shaping import shaped_pinion

Surface = Callable[[GearPair], np.ndarray]
"""Facets of a pinion, (m, 3, 3) [m]."""

NEAR = 0.1e-3  # a flank's triangles have their corners within this of it [m]
CHUNK = 100  # samples projected together


def spheres(profile: int, axial: int, step: str = "0.5 deg") -> Fidelity:
    """Model of equilibria with the general contact's spheres."""
    settings = {"mesh": "general-contact", "profile_samples": profile, "axial_samples": axial}
    return Fidelity.preset("quasi-static").replace({**settings, "step_angle": step})


def shaped(cuts: int) -> Surface:
    """The pinion as it is cut, `cuts` times per turn."""

    def facets(pair: GearPair) -> np.ndarray:
        vertices, faces = shaped_pinion(pair, cuts)
        return vertices[faces]

    return cache(facets)


def meshed(chord_error: float) -> Surface:
    """The pinion as `gears.pinion_mesh` makes it, within a chord error [m]."""

    def facets(pair: GearPair) -> np.ndarray:
        mesh = pinion_mesh(pair, chord_error)
        return mesh.vertices[mesh.faces]

    return cache(facets)


def faceted_run(gear: SteeringGear, fidelity: Fidelity, surface: Surface | None) -> SceneRun:
    """The free pinion torque of a gear without errors; None for the analytic flank."""
    maneuver = maneuvers_of_test(gear, "pinion", fidelity.step_angle)[0]
    return equilibria(gear, faceted_forces(gear, fidelity, surface), maneuver)


def faceted_forces(gear: SteeringGear, fidelity: Fidelity, surface: Surface | None) -> GearForces:
    """The gear's forces with the spheres on its facets, the yoke adjusted to them."""
    forces = gear_forces(gear, fidelity)
    profile, axial, zone = fidelity.profile_samples, fidelity.axial_samples, forces.friction_zone
    mesh = contact_data(gear, profile=profile, axial=axial, friction_zone=zone)
    on_facets = mesh._replace(centres=_centres(gear, fidelity, surface))
    gears, smooth = forces.gears.copy(), np.zeros(1, GEAR)
    gears["mesh"]["spheres"], numbers = pooled(on_facets, forces.pool.size)
    pool, smooth["mesh"] = np.concatenate([forces.pool, numbers]), gears["mesh"]
    smooth["mesh"]["spheres"]["friction"] = 0.0
    offset = GearPair.of(gear).axis_offset
    approach = static_approach(gear.yoke.preload, forces.law, smooth, pool, offset)
    gears["seat"]["rest_gap"] = approach + seat_under(gear).depth
    return replace(forces, gears=gears, pool=pool, approach=approach, ideal=smooth, spheres=on_facets)


def _centres(gear: SteeringGear, fidelity: Fidelity, surface: Surface | None) -> np.ndarray:
    """Centres of the spheres, (z, 2, n, 3), by tooth space: every one is the first, turned."""
    pair, grid = GearPair.of(gear), (fidelity.profile_samples, fidelity.axial_samples)
    flanks = [Flank(pair, *border) for border in borders(0)]
    approach = rack_approach(pair, mean_depth(gear))
    samples = [sample_flank(flank, *grid, approach) for flank in flanks]
    inwards = [-sphere_radius(pair) * each.normals for each in samples]
    first = np.array([_on_facets(*each, surface) for each in zip(flanks, samples, strict=True)]) + inwards
    angles = 2 * np.pi * np.arange(pair.teeth) / pair.teeth
    c, s, o, i = np.cos(angles), np.sin(angles), np.zeros(pair.teeth), np.ones(pair.teeth)
    turns = np.array([[c, -s, o], [s, c, o], [o, o, i]]).transpose(2, 0, 1)
    return np.einsum("zij,fnj->zfni", turns, first) + pair.eccentricity


def _on_facets(flank: Flank, samples: FlankSamples, surface: Surface | None) -> np.ndarray:
    """Move samples of the flank onto the facets near it, (n, 3)."""
    if surface is None:
        return samples.points
    triangles = surface(flank.pair)
    triangles = triangles[(np.abs(flank.distance(triangles)) < NEAR).all(axis=1)]
    starts = range(0, len(samples.points), CHUNK)
    pieces = [FlankSamples(*(each[at : at + CHUNK] for each in samples)) for at in starts]
    distances = np.concatenate([mesh_distance(piece, triangles) for piece in pieces])
    return samples.points + distances[:, None] * samples.normals


def largest_deviation(gear: SteeringGear, surface: Surface) -> float:
    """Largest distance of the facets from a flank where it meets the rack [m]."""
    flank = Flank(GearPair.of(gear), *borders(0)[0])
    return float(np.abs(flank.distance(_on_facets(flank, sample_flank(flank, 400, 3, 0.0), surface))).max())
