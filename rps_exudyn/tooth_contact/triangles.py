"""The gear's own meshes for contact of triangles: ruled flanks of the pinion, flanks of the rack.

The load per length is that of the spheres of law "line" (`sphere_groups`): faces stand out of the rack by
half the mean depth d_0 under the preload, so that value and slope at d_0 are those of law "line",

    F' = 4/3 k (d + h) sqrt(2 rho (d + h)) = c' d_0 ((d + h) / (d_0 + h))^(3/2),      h = d_0 / 2.

A plane flank of the rack is one convex polygon. Triangles of a solid that lie in one plane and share edges
are one face where their outline is convex: a flank that a Boolean cut has left is sixty slivers.
"""

from collections import defaultdict
from functools import lru_cache
from itertools import product

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import sagitta
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.flank_grid import FlankGrid, measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.mesh_file import SMOOTH, Surface
from rps_exudyn.gears.mesh_frames import PinionPlacement, Placement, RackPlacement
from rps_exudyn.gears.pinion_mesh import flank_patch
from rps_exudyn.gears.pitch_errors import rack_errors
from rps_exudyn.gears.rack_bar import RackBar, RackFlank
from rps_exudyn.gears.surface_report import contradictions, placed_surfaces
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.mean_depth import mean_depth
from rps_exudyn.tooth_contact.mesh_contact import MOST_EDGES, MeshData, pooled_meshes
from rps_exudyn.tooth_contact.mesh_search import pinion_mesh_data, rack_mesh_data
from rps_exudyn.tooth_contact.spheres import SHALLOWEST, SIDES

RACK_CHORDS = 5e-6  # of the bar's round surface, which ends the flanks [m]
PIECES = 3  # of a generator at least: the sum over a polygon is Simpson's, 0.01 % off for 1 / sqrt(rho)
STANDING_OUT = 0.5  # height of the faces over the rack, in mean depths
MEAN_HEIGHT = 3 / 4  # of a curved surface over a triangle with corners on it, over that above the middle
KEPT = 4  # meshes of surfaces, as many as files
ROUNDING = 1e-8  # of corners in single precision at a rack's ends [m]: what is nearer to a plane lies in it
ONE_POINT = 9  # digits of a metre, to which corners are one
DEEPEST = 1 / 8  # of a module: what is deeper lies in another tooth


def triangles_of(
    gear: SteeringGear, fidelity: Fidelity, zone: float, first: int, meshes: MeshData | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the record (1,) of a gear's meshes, and their numbers, which begin at a place of the pool.

    `meshes` are others than the gear's own.

    Raises:
        InputError: a law of contact that triangles do not have.
    """
    pair, mesh, depth = GearPair.of(gear), gear.mesh, max(mean_depth(gear), SHALLOWEST)
    if mesh.contact_law != "line":
        raise InputError(
            f"mesh.law is {mesh.contact_law}, but fidelity.mesh = triangles has only line: "
            "set mesh.law = line."
        )
    return pooled_meshes(
        meshes or own_meshes(gear, fidelity.chord_error),
        first,
        by_curvature=0.75 * line_stiffness(gear) / np.sqrt(2 * depth) / (1 + STANDING_OUT) ** 1.5,
        standing_out=STANDING_OUT * depth,
        least_rho=depth,
        square=pair.base_radius**2,
        cos_beta_b=np.cos(pair.beta_b),
        middle=pair.eccentricity,
        deepest=DEEPEST * pair.module,
        damping=mesh.damping,
        friction=mesh.friction,
        zone=zone,
        pinion_origin=pair.pinion_origin,
        pinion_frame=pair.pinion_frame,
        rack_reference=np.array([0.0, pair.bar_axis_height, 0.0]),
    )


def own_meshes(gear: SteeringGear, chord_error: float) -> MeshData:
    """Return the surfaces of a gear's parts; flanks by parameters have chords within `chord_error` [m].

    Raises:
        InputError: a file that is no surface of such a gear, or parameters that contradict it.
    """
    for sentence in contradictions(gear):
        raise InputError(sentence)
    given, pair = placed_surfaces(gear), GearPair.of(gear)
    pinion_tip, rack_tip = pair.tip_radius, RackBar.of(gear).tip_height
    for _, placement in given.values():
        if isinstance(placement, PinionPlacement):
            pinion_tip = placement.tip_diameter / 2
        elif isinstance(placement, RackPlacement):
            rack_tip = -(placement.reference_height + placement.addendum)
    if "pinion" in given:
        pinion = _turning(*given["pinion"], pair.bar_axis_height + rack_tip, pair.module)
    else:
        pinion = _cut(pair, FlankForm.of(gear), chord_error)
    if "rack" in given:
        rack = _met(*given["rack"], pinion_tip - pair.bar_axis_height + DEEPEST * pair.module)
    else:
        polygons = own_polygons(gear, chord_error)
        rack = rack_mesh_data(polygons, own_bends(gear, polygons))
    if not len(pinion[0]) or not len(rack[0]):
        raise InputError(f"{next(iter(given))}.surface does not reach the other part's teeth.")
    return MeshData(*pinion, *rack)


def facet_height(gear: SteeringGear) -> float:
    """Return the mean height of smooth flanks over the facets of a gear's surfaces, the sum of both [m]; 0
    of flanks by parameters, which lie about theirs.

    Flanks of the pinion have normals that touch its base cylinder, those of the rack the normals of the pair.
    """
    pair, total = GearPair.of(gear), 0.0
    for part, (surface, placement) in placed_surfaces(gear).items():
        n, p = surface.normals @ placement.axes.T, placement.place(surface.corners.mean(axis=1))
        if part == "pinion":
            lever = np.abs(p[:, 0] * n[:, 1] - p[:, 1] * n[:, 0]) / (pair.base_radius * np.cos(pair.beta_b))
            flanks = np.abs(lever - 1) < 1 - SMOOTH
        else:
            flanks = (n @ np.transpose([pair.rack_flank_normal(side) for side in SIDES]) > SMOOTH).any(axis=1)
        weights = surface.areas * flanks
        total += placement.scale * float(np.abs(surface.heights) @ weights) / float(weights.sum())
    return total


def own_corners(gear: SteeringGear, chord_error: float) -> np.ndarray:
    """Return the triangles (n, 3, 3) [m] of all flanks of a pinion without runout, pinion frame."""
    return _flank_corners(GearPair.of(gear), FlankForm.of(gear), chord_error)


def _flank_corners(pair: GearPair, form: FlankForm, chord_error: float) -> np.ndarray:
    made = []
    for tooth, side in product(range(pair.teeth), SIDES):
        flank = Flank(pair, tooth, side, form)
        patch = flank_patch(flank, chord_error, PIECES)
        made.append(_balanced(flank, patch.points[patch.faces]))
    return np.concatenate(made)


def _balanced(flank: Flank, corners: np.ndarray) -> np.ndarray:
    """Triangles (n, 3, 3) with corners on a flank, moved along its normals until as much of it lies within
    them as outside: chords alone take off most where the flank is curved least."""
    middle = corners.mean(axis=1)
    radius, Z = np.linalg.norm(middle[:, :2], axis=1), middle[:, 2]
    psi = flank.generator(np.sqrt(np.maximum(radius**2 - flank.pair.base_radius**2, 0)), Z)
    normal = flank.normal(psi)
    height = np.einsum("ij,ij->i", flank.point(psi, Z) - middle, normal)
    return corners + (MEAN_HEIGHT * height[:, None] * normal)[:, None]


@lru_cache(maxsize=2 * KEPT)  # at two levels
def _cut(pair: GearPair, form: FlankForm, chord_error: float) -> tuple[np.ndarray, ...]:
    """The mesh of a pinion by its parameters, which the maneuvers of a run share."""
    return pinion_mesh_data(_flank_corners(pair, form, chord_error))


def own_polygons(gear: SteeringGear, chord_error: float) -> list[np.ndarray]:
    """Return the faces of all flanks of a rack, (m, c, 3) each of m with c corners [m], rack frame."""
    bar, errors, grid = RackBar.of(gear), rack_errors(gear), measured_flanks(gear).rack
    made = []
    for tooth, side in product(bar.teeth, SIDES):
        shift = np.array([errors[tooth - bar.teeth[0]] if len(errors) else 0.0, 0.0, 0.0])
        if bar.pair.course is not None:
            made.append(_generated(bar, tooth, side, chord_error) + shift)
            continue
        flank = bar.flank(tooth, side)
        made.append((outline(flank)[None] if grid is None else _measured(flank, grid, chord_error)) + shift)
    return made


def own_bends(gear: SteeringGear, polygons: list[np.ndarray]) -> list[np.ndarray] | None:
    """Return s / Q of the faces that `own_polygons` makes, (m,) [1/m]; None of a constant ratio."""
    bar = RackBar.of(gear)
    if (course := bar.pair.course) is None:
        return None
    rack, mesh, made = GeneratedRack.of(bar.pair), bar.pair.design_mesh, []
    flanks = product(bar.teeth, SIDES)
    for (tooth, side), faces in zip(flanks, polygons, strict=True):
        middle = faces.mean(axis=1)
        chi = rack.generator(side, tooth, middle[:, 1] + bar.pair.bar_axis_height, middle[:, 2])
        made.append(side * mesh.bend(course.gain(chi), course.slope(chi)))
    return made


def shortened(corners: np.ndarray, longest: float) -> np.ndarray:
    """Return triangles (n, 3, 3) [m], bisected until no edge is longer than a length [m].

    Blocks of short triangles lie in small spheres, which few faces of the rack meet.
    """
    done = []
    while len(corners):
        edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        is_long, first = edges.max(axis=1) > longest, edges.argmax(axis=1)
        done.append(corners[~is_long])
        rows = np.flatnonzero(is_long)
        a, b, c = (corners[rows, (first[rows] + k) % 3] for k in range(3))
        middle = (a + b) / 2
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)


@lru_cache(maxsize=KEPT)
def _turning(surface: Surface, placement: Placement, nearest: float, module: float) -> tuple[np.ndarray, ...]:
    """The mesh of a pinion that can reach the tips of a rack, nearest to the axis [m]; of short triangles."""
    corners = placement.place(surface.corners)
    radii = np.linalg.norm(corners[..., :2], axis=2).max(axis=1)
    return pinion_mesh_data(shortened(corners[radii > nearest - DEEPEST * module], module))


@lru_cache(maxsize=KEPT)
def _met(surface: Surface, placement: Placement, deepest: float) -> tuple[np.ndarray, ...]:
    """The mesh of a rack that the tips of a pinion can reach, which are deepest at y [m]."""
    corners = placement.place(surface.corners)
    return rack_mesh_data(convex_faces(corners[corners[..., 1].min(axis=1) < deepest]))


def convex_faces(corners: np.ndarray) -> list[np.ndarray]:
    """Return triangles (n, 3, 3) [m] as convex polygons, (m, c, 3) each of m with c corners."""
    surface = Surface(corners[Surface(corners).areas > 0])
    corners, normals, areas = surface.corners, surface.normals, surface.areas
    rounded = Surface(np.round(corners, ONE_POINT))
    pairs = np.sort(rounded.neighbours, axis=1)
    larger = areas[pairs].argmax(axis=1)[:, None]
    large, small = (np.take_along_axis(pairs, each, axis=1)[:, 0] for each in (larger, 1 - larger))
    above = np.einsum("ijk,ik->ij", corners[small] - corners[large, :1], normals[large])
    pairs = pairs[np.abs(above).max(axis=1) < ROUNDING]
    group = np.arange(len(corners))  # number of the first triangle of its plane
    while len(pairs) and (group[pairs[:, 0]] != group[pairs[:, 1]]).any():
        for one, other in (pairs.T, pairs.T[::-1]):
            np.minimum.at(group, group[one], group[other])
        group = group[group]
    by_corners, left = defaultdict(list), np.ones(len(corners), dtype=bool)
    order = np.argsort(group, kind="stable")
    for plane in np.split(order, np.flatnonzero(np.diff(group[order])) + 1):
        if len(plane) < 2:
            continue
        loop = _convex_outline(
            rounded.vertices[plane], corners[plane], surface.area_vectors[plane].sum(axis=0)
        )
        if loop is not None and len(loop) <= MOST_EDGES:
            by_corners[len(loop)].append(loop)
            left[plane] = False
    return [np.array(each) for each in by_corners.values()] + [corners[left]]


def _convex_outline(vertices: np.ndarray, corners: np.ndarray, normal: np.ndarray) -> np.ndarray | None:
    """Corners (c, 3) round triangles (n, 3, 3) with numbered vertices (n, 3) that share edges; None if they
    are not one plane convex polygon."""
    edges = set(zip(vertices.ravel().tolist(), np.roll(vertices, -1, axis=1).ravel().tolist(), strict=True))
    after = {a: b for a, b in edges if (b, a) not in edges}
    loop = [next(iter(after))]
    while (corner := after.get(loop[-1])) is not None and corner != loop[0] and len(loop) <= len(after):
        loop.append(corner)
    place = dict(zip(vertices.ravel().tolist(), corners.reshape(-1, 3), strict=True))
    points, normal = np.array([place[each] for each in loop]), normal / np.linalg.norm(normal)
    if len(loop) != len(after) or np.ptp(corners.reshape(-1, 3) @ normal) > ROUNDING:
        return None
    along = np.roll(points, -1, axis=0) - points
    before = np.roll(along, 1, axis=0)
    turns = np.cross(before, along) @ normal
    return points if (turns > -ROUNDING * np.linalg.norm(before + along, axis=1)).all() else None


# --- flanks of the rack ----------------------------------------------------------------------------
def outline(flank: RackFlank) -> np.ndarray:
    """Return the corners of a rack's plane flank (n, 3) [m], counter-clockwise seen from outside."""
    low, high, radius = flank.tip_height, flank.form_height, flank.bar_radius
    first, last = np.arcsin(np.clip(np.array([low, high]) / radius, -1, 1)).tolist()
    y = radius * np.sin(
        np.linspace(first, last, 2 + int(abs(last - first) / np.sqrt(8 * RACK_CHORDS / radius)))
    )
    z = flank.half_chord(y)
    return _outwards(
        np.concatenate([_on_plane(flank, y, z), _on_plane(flank, y, -z)[::-1]])[None], flank.normal
    )[0]


def _measured(flank: RackFlank, grid: FlankGrid, chord_error: float) -> np.ndarray:
    """Triangles (n, 3, 3) [m] of a flank with the deviations of a grid."""
    bends = [np.abs(each).max() for each in grid.second_derivatives()[::2]]
    steps = [np.sqrt(8 * chord_error / max(bend, 1e-9)) for bend in bends]
    rows = 1 + int(np.ceil((flank.form_height - flank.tip_height) / steps[0]))
    y = np.linspace(flank.tip_height, flank.form_height, rows + 1)[:, None]
    widest = flank.half_chord(y)
    z = widest * np.linspace(-1, 1, 2 + int(np.ceil(2 * widest.max() / steps[1])))
    y = np.broadcast_to(y, z.shape)
    dev = grid.at(y, z, flank.tooth, flank.side)
    points = _on_plane(flank, y.ravel(), z.ravel()).reshape(*z.shape, 3) + dev[..., None] * flank.normal
    return _outwards(_halves(points), flank.normal)


def _generated(bar: RackBar, tooth: int, side: int, chord_error: float) -> np.ndarray:
    """Triangles (n, 3, 3) [m] of a flank of variable ratio, as deep as the pinion's tips reach."""
    rack, axis = GeneratedRack.of(bar.pair), bar.pair.bar_axis_height
    across = bar.pair.bar_radius * np.linspace(-1, 1, 33)
    _, ends = rack.root_curve(tooth if side > 0 else tooth - 1, side * rack.root.end, across)
    low, high = rack.tip_height, float(ends.max())
    counts = [1, 1]
    for fine in (False, True):
        share = np.linspace(0, 1, counts[0] + 1 if fine else 17)[:, None]
        H = low + (high - low) * share
        Z = np.sqrt(bar.pair.bar_radius**2 - (H - axis) ** 2)
        Z = Z * np.linspace(-1, 1, counts[1] + 1 if fine else 17)
        H = np.broadcast_to(H, Z.shape)
        points = np.stack([rack.flank(side, tooth, H, Z), H - axis, Z], axis=-1)
        if not fine:
            heights = [sagitta(points, along) for along in (0, 1)]
            counts = [max(int(np.ceil(8 * np.sqrt(height / chord_error))), 1) for height in heights]
    normal = rack.plane(side, rack.generator(side, tooth, H[:1, :1], Z[:1, :1])).normal[0, 0]
    return _outwards(_halves(points), normal)


def _halves(points: np.ndarray) -> np.ndarray:
    """Triangles (n, 3, 3) of a grid of points."""
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    return np.concatenate([np.stack(each, axis=2).reshape(-1, 3, 3) for each in ((a, b, c), (a, c, d))])


def _on_plane(flank: RackFlank, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Points of a flank's plane at y and z (n, 3) [m]."""
    up = np.cross(flank.trace, flank.normal)
    rise = (y - flank.point[1]) / up[1]
    along = (z - flank.point[2] - rise * up[2]) / flank.trace[2]
    return flank.point + rise[:, None] * up + along[:, None] * flank.trace


def _outwards(polygons: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Polygons (m, c, 3), counter-clockwise seen from outside, whither the normal points."""
    after = np.roll(polygons, -1, axis=1)
    middle = polygons.mean(axis=1, keepdims=True)
    turned = np.cross(polygons - middle, after - middle).sum(axis=(0, 1)) @ normal
    return polygons if turned > 0 else polygons[:, ::-1]
