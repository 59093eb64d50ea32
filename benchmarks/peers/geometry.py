"""The gear's geometry in the forms in which other programs take it: spheres, convex pieces, meshes."""

from collections.abc import Iterator
from itertools import product

import numpy as np
from scipy.spatial import ConvexHull

from benchmarks.peers.scene import APPROACH, PAIR, STIFFNESS
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.mean_depth import axial_reach, contact_ends
from rps_exudyn.tooth_contact.spheres import FLANK_MARGIN, sample_flank

BAR = RackBar.of(SteeringGear())
SIDES = (-1, 1)
TEETH = range(-PAIR.teeth - 2, 3)
"""Rack teeth that come into mesh during one turn from the centre on, which takes the rack along +X."""

EDGE_POINTS = 25  # of a rack tooth's flank along the round bar's edge
PIECE_DEPTH = 0.1e-3  # of a convex piece of the pinion, below the flank [m]


FLANKS = tuple(product(range(PAIR.teeth), SIDES))
"""Tooth and side of each flank of the pinion."""

RADIUS = 0.1e-3  # of the spheres [m]


def springs(tooth: int, side: int, profile: int, axial: int) -> Iterator[tuple[np.ndarray, float]]:
    """Yield the centre of each sphere on a pinion flank, pinion frame [m], and the stiffness of its contact
    with a plane [N/m]: that of its area in the package."""
    found = sample_flank(Flank(PAIR, tooth, side), profile, axial, APPROACH)
    stiffness = STIFFNESS * found.areas * np.sqrt(1 - RADIUS / found.curvature_radii)
    yield from zip(found.points - RADIUS * found.normals, stiffness.tolist(), strict=True)


def pieces(tooth: int, side: int, profile: int, axial: int) -> list[tuple[np.ndarray, float]]:
    """Return convex pieces of one pinion flank: corners (8, 3) in the pinion frame and the area [m^2].

    A piece lies below one cell of the grid that `samples` takes the middles of.
    """
    flank = Flank(PAIR, tooth, side)
    q_start, q_tip = contact_ends(PAIR, APPROACH)
    q = np.linspace(q_start, q_tip, profile + 1)[:, None]
    low, high = axial_reach(PAIR, side, q, APPROACH)
    psi = flank.generator(q, low + (high - low) * np.linspace(0, 1, axial + 1))
    Z = low + (high - low) * np.linspace(0, 1, axial + 1)
    top = flank.point(psi, Z)
    below = top - PIECE_DEPTH * flank.normal(psi)
    areas = sample_flank(flank, profile, axial, APPROACH).areas.reshape(profile, axial)
    found = []
    for i, j in product(range(profile), range(axial)):
        cell = np.ix_((i, i + 1), (j, j + 1))
        corners = np.concatenate([top[cell].reshape(-1, 3), below[cell].reshape(-1, 3)])
        found.append((corners, float(areas[i, j])))
    return found


def flank_box(tooth: int, side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return centre (3,), half sizes (3,) [m] and axes (3, 3) of a box under a rack flank, rack frame.

    Its upper face is the flank's plane, larger than the flank: the samples end where contact ends.
    """
    flank = BAR.flank(tooth, side)
    rise = np.cross(flank.normal, flank.trace)
    rise *= np.sign(rise[1])
    margin = FLANK_MARGIN * PAIR.module
    low = (flank.tip_height - margin - flank.point[1]) / rise[1]
    high = (BAR.root_height + margin - flank.point[1]) / rise[1]
    thickness = 0.2 * PAIR.module
    half = np.array([(high - low) / 2, PAIR.bar_radius + margin, thickness / 2])
    axes = np.column_stack([rise, np.cross(flank.normal, rise), flank.normal])
    return flank.point + (low + high) / 2 * rise - thickness / 2 * flank.normal, half, axes


def rack_tooth(tooth: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the straight-flanked part of a rack tooth, cut by the round bar: a convex body, rack frame.

    Returns:
        vertices (n, 3) [m] and triangles (m, 3), outward.
    """
    points = []
    for side in SIDES:
        flank = BAR.flank(tooth, side)
        rise = np.cross(flank.normal, flank.trace)
        rise /= rise[1]
        for Y in np.linspace(flank.tip_height, BAR.root_height, EDGE_POINTS):
            on_line = flank.point + (Y - flank.point[1]) * rise
            along = (np.array([-1, 1]) * flank.half_chord(Y) - on_line[2]) / flank.trace[2]
            points += [on_line + s * flank.trace for s in along]
    vertices = np.array(points)
    faces = ConvexHull(vertices, qhull_options="Qt").simplices
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - vertices.mean(axis=0)) < 0
    faces[inward] = faces[inward][:, ::-1]
    return vertices, faces


def pinion_flanks(chord_error: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the flanks of the package's mesh within `chord_error` [m]: vertices (n, 3), triangles (m, 3)."""
    mesh = pinion_mesh(PAIR, chord_error)
    faces = np.concatenate([patch.faces for patch in mesh.flanks.values()])
    used, faces = np.unique(faces, return_inverse=True)
    return mesh.vertices[used], faces.reshape(-1, 3)
