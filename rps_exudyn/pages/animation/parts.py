"""The bodies that a picture shows: coarse meshes with normals that are smooth on curved faces.

The plunger is bored for its spring, and the spring has a wire: the model has neither, it has the
plunger's mass and the spring's rate. Nothing else of the pictures is not in the model.
"""

from dataclasses import dataclass

import numpy as np
from manifold3d import Manifold

from rps_exudyn.gears.basic_rack import arc_segments
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.polyhedron import Solid, cylinder, from_manifold, to_manifold
from rps_exudyn.gears.solids import bush_segment_solid, gear_solids, plunger_ends
from rps_exudyn.gears.surface_report import placed_surfaces
from rps_exudyn.parameters.gear import SteeringGear

CHORD_ERROR = 20e-6  # finer meshes look the same [m]
CREASE = np.cos(np.radians(35))  # faces that meet at a larger angle have an edge
COLOURS = {
    "pinion": (0.902, 0.624, 0.0),
    "rack": (0.682, 0.714, 0.749),
    "plunger": (0.184, 0.561, 0.796),
    "spring": (0.549, 0.769, 0.910),
    "yokenut": (0.043, 0.373, 0.580),
    "bush": (0.0, 0.620, 0.451),
    "bearings": (0.8, 0.475, 0.655),
}
"""PicturePart -> red, green, blue in 0..1: as in `pages.charts.style`, the yoke in three blues."""
MOST_DRAWN = 200_000  # triangles of a surface: a page of some 10 MB
BORE = 0.52  # of the plunger, over its diameter
BORE_DEPTH = 0.62  # over the plunger's length
RING, RING_WIDTH = 1.5, 0.5  # outer radius and width of a bearing, over the shaft's radius and diameter
COILS, ALONG_COIL, AROUND_WIRE = 5, 20, 8


@dataclass(frozen=True, eq=False)
class PicturePart:
    """One body of a picture, in its own frame (see `gears.solids`)."""

    name: str
    vertices: np.ndarray  # [m], shape (n, 3)
    normals: np.ndarray  # unit, out of the body, shape (n, 3)
    faces: np.ndarray  # counter-clockwise from outside, shape (m, 3)


def picture_parts(gear: SteeringGear) -> list[PicturePart]:
    """All bodies; the spring stands in the plunger's frame, the bush in one piece around its own centre.

    Surfaces of up to `MOST_DRAWN` triangles stand in place of the drawing's parts.

    Raises:
        InputError: a gear that cannot be built.
    """
    solids = gear_solids(gear, CHORD_ERROR)
    solids["bush"] = bush_segment_solid(gear.replace({"bush.segments": 1}), CHORD_ERROR)
    meshes = {name: (solid.vertices, solid.faces) for name, solid in solids.items()}
    meshes |= {"plunger": bored(solids["plunger"], gear), "spring": coil(gear)}
    for name, (surface, placement) in placed_surfaces(gear).items():
        if len(surface.areas) <= MOST_DRAWN:
            place = GearPair.of(gear).eccentricity if name == "pinion" else np.zeros(3)
            corners = placement.place(surface.corners) + place
            _, first, number = np.unique(surface.vertices, return_index=True, return_inverse=True)
            meshes[name] = corners.reshape(-1, 3)[first], number.reshape(-1, 3)
    bodies = [name for name in COLOURS if name != "bearings"]
    return [PicturePart(name, *with_normals(*meshes[name])) for name in bodies]


def bearing_rings(gear: SteeringGear) -> PicturePart:
    """Rings in the pinion's frame where its bearings stand; the model has stiffness and friction there, no
    body."""
    radius = gear.pinion.shaft_diameter / 2
    segments = arc_segments(RING * radius, 2 * np.pi, CHORD_ERROR)
    rings = Manifold()
    for place in (gear.bearing.lower_position, gear.bearing.upper_position):
        half = np.array([0, 0, RING_WIDTH * radius])
        middle = np.array([0, 0, place])
        bore = cylinder(radius, middle - 2 * half, middle + 2 * half, segments)
        rings += cylinder(RING * radius, middle - half, middle + half, segments) - bore
    return PicturePart("bearings", *with_normals(*from_manifold(rings)))


def bored(plunger: Solid, gear: SteeringGear) -> tuple[np.ndarray, np.ndarray]:
    """The plunger with a blind hole from behind, in which a spring can be shown."""
    back, radius = plunger_ends(gear)[1], BORE * gear.yoke.plunger_diameter / 2
    bottom = back - BORE_DEPTH * gear.yoke.plunger_length
    segments = arc_segments(radius, 2 * np.pi, CHORD_ERROR)
    hole = cylinder(radius, np.array([0, bottom, 0]), np.array([0, 1.5 * back, 0]), segments)
    body: Manifold = to_manifold(plunger.vertices.copy(), plunger.faces.copy()) - hole
    return from_manifold(body)


def coil(gear: SteeringGear) -> tuple[np.ndarray, np.ndarray]:
    """A helical spring between the bore's bottom and the yokenut."""
    back, yoke = plunger_ends(gear)[1], gear.yoke
    bottom, top = back - BORE_DEPTH * yoke.plunger_length, back + yoke.clearance
    wire = min(0.05 * yoke.plunger_diameter, 0.3 * (top - bottom) / COILS)
    mean = 0.9 * BORE * yoke.plunger_diameter / 2 - wire
    turn = 2 * np.pi * COILS * np.linspace(0, 1, COILS * ALONG_COIL + 1)
    height = np.linspace(bottom + wire, top - wire, turn.size)
    out = np.stack([np.cos(turn), np.zeros_like(turn), np.sin(turn)], axis=-1)
    up = np.array([0.0, 1.0, 0.0])
    around = 2 * np.pi * np.arange(AROUND_WIRE)[:, None] / AROUND_WIRE
    ring = np.cos(around)[None] * out[:, None] + np.sin(around)[None] * up
    centre = mean * out + height[:, None] * up
    vertices = (centre[:, None] + wire * ring).reshape(-1, 3)
    return vertices, _tube(turn.size)


def _tube(rings: int) -> np.ndarray:
    """Triangles between rings of `AROUND_WIRE` vertices, and fans over both ends."""
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(AROUND_WIRE), indexing="ij")
    a, b = (i * AROUND_WIRE + j).ravel(), (i * AROUND_WIRE + (j + 1) % AROUND_WIRE).ravel()
    walls = [np.stack([a, b, a + AROUND_WIRE], 1), np.stack([b, b + AROUND_WIRE, a + AROUND_WIRE], 1)]
    fan = np.stack([np.zeros(AROUND_WIRE - 2, int), *(np.arange(AROUND_WIRE - 2) + k for k in (2, 1))], 1)
    return np.concatenate([*walls, fan, fan[:, ::-1] + (rings - 1) * AROUND_WIRE])


def with_normals(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, their unit normals, and faces: a vertex on an edge of the body becomes one for each side.

    The normal at a corner is the mean of the faces around the vertex, by area, that meet the corner's own
    face at an angle below that of `CREASE`.
    """
    corners = faces.ravel()
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    areas = np.cross(b - a, c - a)
    unit = areas / np.maximum(np.linalg.norm(areas, axis=1, keepdims=True), 1e-300)
    order = np.argsort(corners, kind="stable")
    count = np.bincount(corners, minlength=len(vertices))
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    mine = np.repeat(np.arange(corners.size), count[corners])  # every pair of corners at one vertex
    nth = np.arange(mine.size) - np.repeat(np.cumsum(count[corners]) - count[corners], count[corners])
    other = order[first[corners[mine]] + nth]
    alike = np.einsum("ij,ij->i", unit[mine // 3], unit[other // 3]) > CREASE
    sums = np.zeros((corners.size, 3))
    np.add.at(sums, mine[alike], areas[other[alike] // 3])
    normals = sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-300)
    keys = np.column_stack([corners, np.round(normals * 200).astype(int)])
    _, chosen, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return vertices[corners[chosen]], normals[chosen], number.reshape(-1, 3)
