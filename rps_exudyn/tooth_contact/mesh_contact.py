"""Contact of two oriented triangle meshes: integrals over the polygons in which they overlap.

A triangle of the pinion overlaps a plane face of the rack, a convex polygon with the outward normal n, where
it lies below the face's plane and within the prism over its edges:

    depth d(x) = o - n . x,      pressure k d on the area projected along n

On the polygon that the clipping leaves d is linear. With a constant k force, moment, energy and tangent are
polynomials of degree two, which the middles of the edges of each triangle of a fan integrate exactly. No
distance is searched, and neither mesh need be closed.

k follows the radius of curvature rho that the involute has at a point's radius r from the pinion's middle,

    k = c / sqrt(rho),     rho = sqrt(r^2 - r_b^2) / cos beta_b,

as the spheres' does (`spheres`), so that a line's load per length does not depend on rho. Where the ratio
varies rho is the relative radius, q (1 - s q / Q) / cos beta_b (`gears.course`).

Only faces that oppose the triangle's normal count: the prism reaches through the tooth, and a flank would
press on the land beside it.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, kernel, record_type, stacked
from rps_exudyn.forces.rigid_motion import cross, dot, minus, plus, scaled, vector
from rps_exudyn.tooth_contact.sampled_contact import begin_points, press_point, times

OPPOSED = -0.9  # cosine of the normals, at most; true pairs oppose within 10 degrees
MOST_CORNERS = 64  # of a clipped polygon: a cut adds one to those of the triangle
MOST_EDGES = MOST_CORNERS - 4  # of a face
BLOCK = 16  # triangles of the pinion that one sphere encloses
LEAF = 4  # faces of the rack in a leaf of the tree
TRIANGLE = 12  # numbers of a pinion's triangle: corners (9), normal (3)
FACE = 7  # of a rack's face: normal (3), offset, first edge, edges, s / Q
EDGE = 4  # of an edge: normal within the face (3), offset
MOVED = TRIANGLE + 6  # of a triangle in the rack frame, with its lowest and highest corner
BALL = 4  # of a sphere: centre (3), radius
BOX = 6  # of a box along the rack's axes: lowest (3) and highest (3) corner


class MeshData(NamedTuple):
    """Both meshes, as the kernel takes them; neighbours in space stand beside each other."""

    triangles: np.ndarray  # (n, TRIANGLE), pinion frame at angle 0, without runout
    balls: np.ndarray  # (blocks, BALL) round each block of triangles
    faces: np.ndarray  # (m, FACE), rack frame
    edges: np.ndarray  # (e, EDGE)
    boxes: np.ndarray  # (2 leaves - 1, BOX), binary tree over leaves of faces; below i: 2 i + 1, 2 i + 2


TRIANGLES = record_type(
    [
        ("triangles", "i8"),  # places in the pool ...
        ("balls", "i8"),
        ("faces", "i8"),
        ("edges", "i8"),
        ("boxes", "i8"),
        ("triangle_count", "i8"),  # ... and how many there are
        ("face_count", "i8"),
        ("leaves", "i8"),
        ("by_curvature", "f8"),  # pressure per depth times the root of rho [N/m^2.5]
        ("least_rho", "f8"),  # [m]
        ("square", "f8"),  # of the base radius [m^2]
        ("cos_beta_b", "f8"),
        ("middle", "f8", (3,)),  # of the teeth from the axis, pinion frame at angle 0 [m]
        ("standing_out", "f8"),  # by which faces stand out of the rack [m]
        ("deepest", "f8"),  # what is deeper lies in another tooth [m]
        ("damping", "f8"),
        ("friction", "f8"),
        ("zone", "f8"),
        ("pinion_origin", "f8", (3,)),
        ("pinion_frame", "f8", (3, 3)),
        ("rack_reference", "f8", (3,)),
    ]
)
"""Record of two meshes; their numbers stand in the pool."""


def pooled_meshes(data: MeshData, first: int, **values: object) -> tuple[np.ndarray, np.ndarray]:
    """Return the record (1,) of meshes whose numbers begin at a place of the pool, and these numbers."""
    made, numbers = np.zeros(1, TRIANGLES), list[np.ndarray]()
    for name, each in data._asdict().items():
        made[name] = first + sum(each.size for each in numbers)
        numbers.append(each.ravel().astype(float))
    made["triangle_count"], made["face_count"] = len(data.triangles), len(data.faces)
    made["leaves"] = (len(data.boxes) + 1) // 2
    for name, value in values.items():
        made[name] = value
    return made, np.concatenate(numbers)


@kernel
def mesh_contact(  # type: ignore[no-untyped-def]
    angle, rate, position, rotation, velocity, spin, data, pool, work, factor_q, factor_v
):
    """Fill the wrench of all overlaps, see `wrench`, and its stiffness unless both factors are 0; `data` is a
    record `TRIANGLES`, `work` a `SCRATCH`."""
    begin_points(work)
    frame, polygon, other = data.pinion_frame, stacked((MOST_CORNERS, 3)), stacked((MOST_CORNERS, 3))
    axis = (frame[0, 2], frame[1, 2], frame[2, 2])
    to_axis = minus(vector(data.pinion_origin), vector(position))
    moving, turning = vector(velocity), vector(spin)
    cos, sin = np.cos(angle), np.sin(angle)
    turn, shift = _to_rack(cos, sin, frame, rotation, to_axis)
    shift = plus(shift, _turned(turn, vector(data.middle)))
    middle = times(rotation, shift)
    moved = stacked((BLOCK, MOVED))
    for block in range((data.triangle_count + BLOCK - 1) // BLOCK):
        ball, first = data.balls + BALL * block, BLOCK * block
        count = min(BLOCK, data.triangle_count - first)
        centre, radius = _moved(pool, ball, turn, shift), pool[ball + 3]
        reach = (radius, radius, radius)
        low, high = minus(centre, reach), plus(centre, reach)
        is_moved, node = False, 0
        while node >= 0:
            box = data.boxes + BOX * node
            meets = _meets(pool, box, low, high)
            if meets and node < data.leaves - 1:
                node = 2 * node + 1
                continue
            leaf = LEAF * (node - data.leaves + 1)
            for number in range(leaf, min(leaf + LEAF, data.face_count) if meets else leaf):
                face = data.faces + FACE * number
                normal = pool[face], pool[face + 1], pool[face + 2]
                offset = pool[face + 3] + data.standing_out
                depth = offset - dot(normal, centre)
                if depth < -radius or depth > data.deepest + radius:
                    continue
                if not is_moved:
                    _move_block(pool, data.triangles + TRIANGLE * first, count, turn, shift, moved)
                    is_moved = True
                for i in range(count):
                    if not _meets(pool, box, vector(moved[i, 12:15]), vector(moved[i, 15:18])):
                        continue
                    if dot(normal, vector(moved[i, 9:12])) > OPPOSED:
                        continue
                    a, b, c = vector(moved[i, 0:3]), vector(moved[i, 3:6]), vector(moved[i, 6:9])
                    d_a, d_b, d_c = offset - dot(normal, a), offset - dot(normal, b), offset - dot(normal, c)
                    if max(d_a, d_b, d_c) <= 0 or min(d_a, d_b, d_c) > data.deepest:
                        continue
                    corners = _overlap(a, b, c, normal, offset, face, data, pool, polygon, other)
                    if corners >= 3:
                        _press_polygon(
                            polygon, corners, normal, offset, pool[face + 6], middle, rotation, axis, to_axis,
                            rate, moving, turning, data, work, factor_q, factor_v,
                        )  # fmt: skip
            node = _after(node)


@kernel
def _move_block(pool, place, count, turn, shift, moved):  # type: ignore[no-untyped-def]
    """Fill rows of triangles in the rack frame: corners (9), normal (3), lowest and highest corner (6)."""
    for i in range(count):
        at = place + TRIANGLE * i
        a = _moved(pool, at, turn, shift)
        b = _moved(pool, at + 3, turn, shift)
        c = _moved(pool, at + 6, turn, shift)
        normal = _turned(turn, (pool[at + 9], pool[at + 10], pool[at + 11]))
        for k in range(3):
            moved[i, k], moved[i, 3 + k], moved[i, 6 + k], moved[i, 9 + k] = a[k], b[k], c[k], normal[k]
            moved[i, 12 + k] = min(a[k], b[k], c[k])
            moved[i, 15 + k] = max(a[k], b[k], c[k])


@inline
def _meets(pool, box, low, high):  # type: ignore[no-untyped-def]
    """Whether a box of the pool and the one between two corners have a point in common."""
    return (
        pool[box] <= high[0]
        and pool[box + 1] <= high[1]
        and pool[box + 2] <= high[2]
        and low[0] <= pool[box + 3]
        and low[1] <= pool[box + 4]
        and low[2] <= pool[box + 5]
    )


@inline
def _after(node):  # type: ignore[no-untyped-def]
    """Return the node of a binary tree that follows all below this one; -1 at the end."""
    while node > 0 and node % 2 == 0:  # a right child
        node = (node - 1) // 2
    return node + 1 if node > 0 else -1


@inline
def _to_rack(cos, sin, frame, rotation, to_axis):  # type: ignore[no-untyped-def]
    """Rotation (rows) and shift that take points of the pinion at angle 0 into the frame of the rack."""
    # columns of the turned pinion frame in the housing
    e = plus(scaled(cos, vector(frame[:, 0])), scaled(sin, vector(frame[:, 1])))
    y = minus(scaled(cos, vector(frame[:, 1])), scaled(sin, vector(frame[:, 0])))
    k = vector(frame[:, 2])
    rows = (
        (_along(rotation, 0, e), _along(rotation, 0, y), _along(rotation, 0, k)),
        (_along(rotation, 1, e), _along(rotation, 1, y), _along(rotation, 1, k)),
        (_along(rotation, 2, e), _along(rotation, 2, y), _along(rotation, 2, k)),
    )
    shift = _along(rotation, 0, to_axis), _along(rotation, 1, to_axis), _along(rotation, 2, to_axis)
    return rows, shift


@inline
def _along(rotation, i, x):  # type: ignore[no-untyped-def]
    """Component of a housing vector along the rack's axis i."""
    return rotation[0, i] * x[0] + rotation[1, i] * x[1] + rotation[2, i] * x[2]


@inline
def _turned(rows, x):  # type: ignore[no-untyped-def]
    """The product of a matrix, its rows tuples, and a vector."""
    return dot(rows[0], x), dot(rows[1], x), dot(rows[2], x)


@inline
def _moved(pool, place, rows, shift):  # type: ignore[no-untyped-def]
    """A corner of the pinion in the rack frame."""
    return plus(shift, _turned(rows, (pool[place], pool[place + 1], pool[place + 2])))


@kernel
def _overlap(a, b, c, normal, offset, face, data, pool, polygon, other):  # type: ignore[no-untyped-def]
    """Fill `polygon` with the part of a triangle below a face's plane and within its prism; how many corners.

    I. E. Sutherland, G. W. Hodgman, Communications of the ACM 17 (1974) 32.
    """
    for k in range(3):
        polygon[0, k], polygon[1, k], polygon[2, k] = a[k], b[k], c[k]
    count = _clip(polygon, 3, normal, offset, other)
    first = data.edges + EDGE * int(pool[face + 4])
    for edge in range(int(pool[face + 5])):
        place = first + EDGE * edge
        outwards, limit = (pool[place], pool[place + 1], pool[place + 2]), pool[place + 3]
        count = _clip(polygon, count, outwards, limit, other)
        if count < 3:
            return 0
    return count


@inline
def _clip(polygon, count, outwards, limit, other):  # type: ignore[no-untyped-def]
    """Keep the part of a polygon where outwards . x <= limit; how many corners it has."""
    inside = 0
    for i in range(count):
        inside += int(
            outwards[0] * polygon[i, 0] + outwards[1] * polygon[i, 1] + outwards[2] * polygon[i, 2] <= limit
        )
    if inside == count or inside == 0:
        return inside
    kept = 0
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        here = limit - dot(outwards, vector(polygon[i]))
        there = limit - dot(outwards, vector(polygon[j]))
        if here >= 0:
            for k in range(3):
                other[kept, k] = polygon[i, k]
            kept += 1
        if (here >= 0) != (there >= 0):
            share = here / (here - there)
            for k in range(3):
                other[kept, k] = polygon[i, k] + share * (polygon[j, k] - polygon[i, k])
            kept += 1
    for i in range(kept):
        for k in range(3):
            polygon[i, k] = other[i, k]
    return kept


@kernel
def _press_polygon(  # type: ignore[no-untyped-def]
    polygon, corners, normal, offset, bend, middle, rotation, axis, to_axis, rate, moving, turning, data,
    work, factor_q, factor_v,
):  # fmt: skip
    """Add the pressure on a polygon of the rack frame."""
    in_housing = times(rotation, normal)
    side = 0 if normal[0] < 0 else 1  # the drive flank faces -X
    for i in range(1, corners - 1):
        a, b, c = vector(polygon[0]), vector(polygon[i]), vector(polygon[i + 1])
        area = abs(dot(normal, cross(minus(b, a), minus(c, a)))) / 2
        for pair in ((a, b), (b, c), (c, a)):
            place = scaled(0.5, plus(pair[0], pair[1]))
            point = times(rotation, place)
            out = minus(point, middle)
            height = dot(axis, out)
            q = np.sqrt(max(dot(out, out) - height * height - data.square, 0.0))
            rho = max(q * (1.0 - bend * q) / data.cos_beta_b, data.least_rho)
            press_point(
                offset - dot(normal, place), data.by_curvature / np.sqrt(rho) * area / 3, in_housing, point,
                minus(point, to_axis), axis, rate, moving, turning, side, data, work, factor_q, factor_v,
            )  # fmt: skip
