"""Closed triangle mesh of the toothed pinion, its flanks ruled along the generators.

A flank is a parallelogram in generators and axial position. Flat strips between generators touch the
helicoid along whole lines, so that a few hundred of them are within 0.1 um of it. Where modifications bend
the generators, the strips are cut into pieces:

    Z = b/2   .__________.              q = p - zeta tan|beta_b|, zeta = +-Z
              |\\  \\  \\  \\ |              p  names the generator: its tangent length at Z = 0
       form   | \\  \\  \\  \\|  tip
      circle  |\\ \\  \\  \\  |  circle
    Z = -b/2  .__________.
              q_form    q_tip

Generators through all four corners are among the strips' edges. Root and tip are swept along the helix
in rows, and sewn to the flanks' edges; the end faces are triangulated plane polygons.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import manifold3d
import numpy as np

from rps_exudyn.gears.basic_rack import arc_segments
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank, crest_profile, generator_step
from rps_exudyn.gears.polyhedron import refuse_defects
from rps_exudyn.gears.trochoid import root_profile

PERFECT = FlankForm()
MOST_PIECES = 64  # of a generator that modifications bend


@dataclass(frozen=True, eq=False)
class FlankPatch:
    """The triangles of one flank, and the vertices along its four edges."""

    points: np.ndarray  # pinion frame [m], shape (n, 3)
    faces: np.ndarray  # normals out of the tooth, shape (m, 3)
    form_edge: np.ndarray  # along the form circle, Z ascending
    tip_edge: np.ndarray  # along the tip circle, Z ascending
    lower_edge: np.ndarray  # at Z = -b/2, from form to tip
    upper_edge: np.ndarray  # at Z = +b/2, from form to tip

    def renumbered(self, first: int) -> "FlankPatch":
        """The same patch as part of a mesh in which its vertices begin at `first`."""
        numbers = ("faces", "form_edge", "tip_edge", "lower_edge", "upper_edge")
        return replace(self, **{name: getattr(self, name) + first for name in numbers})


@dataclass(frozen=True, eq=False)
class PinionMesh:
    """The toothed part of the pinion; its flanks can be addressed one by one."""

    vertices: np.ndarray  # pinion frame [m], shape (n, 3)
    faces: np.ndarray  # normals outwards, shape (m, 3)
    flanks: dict[tuple[int, int], FlankPatch]  # (tooth, side) -> patch, numbered as in the whole mesh


def flank_patch(flank: Flank, chord_error: float, least_pieces: int = 1) -> FlankPatch:
    """Ruled triangulation of a flank within `chord_error` [m]; generators have at least so many pieces."""
    pair, side = flank.pair, flank.side
    b, tan_b = pair.face_width, abs(np.tan(flank.beta_b))
    sign = -1 if side * flank.beta_b < 0 else 1
    q0, qa = flank.form_tangent_length, flank.tip_tangent_length
    corners = np.array([q0 - tan_b * b / 2, qa - tan_b * b / 2, q0 + tan_b * b / 2, qa + tan_b * b / 2])
    p, (form0, tip0, form1, tip1) = _generators(corners, pair.base_radius * generator_step(pair, chord_error))

    first, last, ends = _ends(len(p), pointed=tan_b > 0)  # vertices where generators begin and end
    roll, zeta = np.empty(ends), np.empty(ends)
    roll[first] = roll[last] = p
    zeta[first] = -b / 2 if tan_b == 0 else np.clip((p - qa) / tan_b, -b / 2, b / 2)
    zeta[last] = b / 2 if tan_b == 0 else np.clip((p - q0) / tan_b, -b / 2, b / 2)

    def on_flank(p: np.ndarray, zeta: np.ndarray) -> np.ndarray:
        return flank.point(flank.theta - side * p / pair.base_radius, sign * zeta)

    pieces = max(least_pieces, _pieces(on_flank, p, zeta[first], zeta[last], chord_error))
    inner = (zeta[first] + np.multiply.outer(np.arange(1, pieces) / pieces, zeta[last] - zeta[first])).T
    between = ends + np.arange(inner.size).reshape(inner.shape)
    between = np.where((first == last)[:, None], first[:, None], between)
    rows = np.concatenate([first[:, None], between, last[:, None]], axis=1)
    points = np.concatenate([on_flank(roll, zeta), on_flank(np.repeat(p, pieces - 1), inner.ravel())])
    h, i, j, k = rows[:-1, :-1], rows[1:, :-1], rows[:-1, 1:], rows[1:, 1:]
    faces = np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in ((h, i, j), (j, i, k))])
    faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
    form_edge = _distinct(np.concatenate([rows[form0], last[form0 : form1 + 1]]))
    tip_edge = _distinct(np.concatenate([first[tip0 : tip1 + 1], rows[tip1]]))
    lower_edge, upper_edge = first[form0 : tip0 + 1], last[form1 : tip1 + 1]
    if sign < 0:  # zeta = -Z
        form_edge, tip_edge, lower_edge, upper_edge = form_edge[::-1], tip_edge[::-1], upper_edge, lower_edge
    if sign * side > 0:
        faces = faces[:, ::-1]
    return FlankPatch(points, faces, form_edge, tip_edge, lower_edge, upper_edge)


def pinion_mesh(pair: GearPair, chord_error: float, form: FlankForm = PERFECT) -> PinionMesh:
    """Closed mesh of flanks, root, tips and end faces.

    Args:
        pair: the gears.
        chord_error: largest distance of flanks and root profile from the exact ones [m]. Crests, and the
            chords of root and crests along the helix, never touch the rack and are allowed ten times as much.
        form: modifications and errors of the flanks.
    """
    z, twist, land_error = pair.teeth, form.twist(pair), 10 * chord_error
    layers = arc_segments(pair.tip_radius, twist * pair.face_width, land_error)
    Z = pair.face_width * (np.linspace(0, 1, 1 + layers) - 0.5)
    root, tip = root_profile(pair, chord_error)[1:-1], crest_profile(pair, land_error)

    blocks: list[np.ndarray] = []

    def numbers(points: np.ndarray) -> np.ndarray:
        start = sum(map(len, blocks))
        blocks.append(points)
        return np.arange(start, start + len(points))

    flanks = {}
    for m in range(z):
        for side in (-1, 1):
            patch = flank_patch(Flank(pair, m, side, form), chord_error)
            flanks[m, side] = patch.renumbered(numbers(patch.points)[0])
    rows, rim = [], []  # strips to be sewn; outline of the end faces as pairs (lower, upper)
    for m in range(z):
        behind, rising, falling = flanks[(m - 1) % z, 1], flanks[m, -1], flanks[m, 1]
        angle = 2 * np.pi * m / z - twist * Z
        roots = numbers(swept(root, angle, Z)).reshape(-1, len(Z))
        tips = numbers(swept(tip, angle, Z)).reshape(-1, len(Z))
        rows += [[behind.form_edge, *roots, rising.form_edge], [rising.tip_edge, *tips, falling.tip_edge]]
        rim += [
            roots[:, [0, -1]],
            np.stack([rising.lower_edge, rising.upper_edge], axis=1),
            tips[:, [0, -1]],
            np.stack([falling.lower_edge, falling.upper_edge], axis=1)[::-1],
        ]

    vertices = np.concatenate(blocks)
    lower, upper = np.concatenate(rim).T
    faces = [patch.faces for patch in flanks.values()]
    faces += [_sewn(a, b, vertices[:, 2], twist) for strip in rows for a, b in pairwise(strip)]
    faces += [_cap(vertices, lower)[:, ::-1], _cap(vertices, upper)]
    whole = np.concatenate(faces)
    refuse_defects("pinion", vertices, whole)
    return PinionMesh(vertices, whole, flanks)


def _generators(corners: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Generators through all corners, at most `step` apart, and which of them the corners are.

    Corners within a millionth of a step share a generator: a strip between them would be a sliver.
    """
    order = np.argsort(corners, kind="stable")
    knots = corners[order]
    p, number = [knots[0]], [0]
    for start, stop in pairwise(knots):
        pieces = int(np.ceil((stop - start) / step - 1e-6))
        p += list(np.linspace(start, stop, pieces + 1)[1:])
        number.append(len(p) - 1)
    found = np.empty(len(corners), dtype=int)
    found[order] = number
    return np.array(p), found


def _pieces(
    on_flank: Callable[[np.ndarray, np.ndarray], np.ndarray],
    p: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    chord_error: float,
) -> int:
    """Into how many pieces generators are cut, which go from one Z to another, so that their chords are
    within an error [m]; 1 of the straight ones of a perfect flank."""
    t = np.linspace(0, 1, MOST_PIECES + 1)
    points = on_flank(p[:, None], low[:, None] + (high - low)[:, None] * t)
    bend = np.linalg.norm(np.diff(points, n=2, axis=1), axis=2).max()  # of a chord over two of the pieces
    whole = bend * MOST_PIECES**2 / 8
    return min(int(np.ceil(np.sqrt(whole / chord_error))), MOST_PIECES) if whole > chord_error else 1


def _ends(generators: int, *, pointed: bool) -> tuple[np.ndarray, np.ndarray, int]:
    """Numbers of the first and last vertex of each generator; a pointed patch begins and ends in a corner."""
    first = np.arange(generators)
    if not pointed:
        return first, first + generators, 2 * generators
    last = first + generators - 1
    last[[0, -1]] = first[[0, -1]]
    return first, last, 2 * generators - 2


def _distinct(numbers: np.ndarray) -> np.ndarray:
    """A row of vertices without immediate repeats."""
    return numbers[np.concatenate([[True], np.diff(numbers) != 0])]


def swept(profile: np.ndarray, angle: np.ndarray, Z: np.ndarray) -> np.ndarray:
    """Transverse points (n, 2) turned by the angles at the positions Z, shape (n * len(Z), 3) [m]."""
    x, y = profile[:, :1], profile[:, 1:]
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(Z, (len(profile), len(Z)))], -1).reshape(
        -1, 3
    )


def _sewn(a: np.ndarray, b: np.ndarray, Z: np.ndarray, twist: float) -> np.ndarray:
    """Triangles between two rows of vertices, Z ascending in both, `b` at the larger polar angle.

    The rows may have different stations: each edge of a row is joined to the vertex of the other row
    that is nearest to its middle; of two equally near ones, to that over the shorter diagonal.
    """
    middle_a, middle_b = (Z[a[1:]] + Z[a[:-1]]) / 2, (Z[b[1:]] + Z[b[:-1]]) / 2
    side_a: Literal["left", "right"] = "right" if twist > 0 else "left"
    side_b: Literal["left", "right"] = "left" if twist > 0 else "right"
    nearest_b = b[np.searchsorted(middle_b, middle_a, side=side_a)]
    nearest_a = a[np.searchsorted(middle_a, middle_b, side=side_b)]
    return np.concatenate(
        [np.stack([a[:-1], nearest_b, a[1:]], axis=1), np.stack([nearest_a, b[:-1], b[1:]], axis=1)]
    )


def _cap(vertices: np.ndarray, outline: np.ndarray) -> np.ndarray:
    """Triangles of a plane end face, its outline counter-clockwise."""
    polygon = np.ascontiguousarray(vertices[outline, :2])
    return outline[np.asarray(manifold3d.triangulate([polygon]))]
