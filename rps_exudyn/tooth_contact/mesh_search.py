"""Two meshes as the kernel of their contact takes them: neighbours together, under spheres and boxes.

    data = mesh_data(corners, [polygons, ...])

Triangles of the pinion and faces of the rack are put in an order that keeps neighbours together. Each block
of triangles lies within a sphere. The faces lie under a binary tree of boxes along the axes.
No candidate is lost: a sphere and a box contain what they stand for.
"""

from collections.abc import Sequence

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.tooth_contact.mesh_contact import BLOCK, LEAF, MOST_EDGES, MeshData


def mesh_data(
    corners: np.ndarray, polygons: Sequence[np.ndarray], bends: Sequence[np.ndarray] | None = None
) -> MeshData:
    """Return both meshes as the kernel takes them; arguments as of `pinion_mesh_data`, `rack_mesh_data`.

    Raises:
        InputError: a face with more corners than the kernel takes.
    """
    return MeshData(*pinion_mesh_data(corners), *rack_mesh_data(polygons, bends))


def pinion_mesh_data(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return triangles and balls of `MeshData`.

    Args:
        corners: of the pinion's triangles (n, 3, 3) [m], counter-clockwise seen from outside.
    """
    corners = corners[in_groups(corners.mean(axis=1), BLOCK)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.concatenate([corners.reshape(-1, 9), normals], axis=1), _spheres(corners)


def rack_mesh_data(
    polygons: Sequence[np.ndarray], bends: Sequence[np.ndarray] | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return faces, edges and boxes of `MeshData`.

    Args:
        polygons: the rack's faces, (m, c, 3) each of m polygons with c corners [m], plane, convex,
            counter-clockwise seen from outside.
        bends: s / Q of the faces, (m,) of each m [1/m]; 0 of plane flanks.

    Raises:
        InputError: a face with more corners than the kernel takes.
    """
    faces, edges, boxes = [np.zeros((0, 7))], [np.zeros((0, 4))], [np.zeros((0, 6))]
    for each, bend in zip(polygons, bends or [np.zeros(len(each)) for each in polygons], strict=True):
        count = each.shape[1]
        if count > MOST_EDGES:
            raise InputError(f"A face has {count} corners; contact of triangles takes {MOST_EDGES}.")
        after, middle = np.roll(each, -1, axis=1), each.mean(axis=1)
        normal = np.cross(each - middle[:, None], after - middle[:, None]).sum(axis=1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        outwards = np.cross(after - each, normal[:, None])
        outwards /= np.linalg.norm(outwards, axis=2, keepdims=True)
        first = sum(map(len, edges)) + count * np.arange(len(each))
        offset, limit = np.einsum("ij,ij->i", normal, middle), np.einsum("ijk,ijk->ij", outwards, each)
        faces.append(np.column_stack([normal, offset, first, np.full(len(each), count), bend]))
        edges.append(np.concatenate([outwards, limit[..., None]], axis=2).reshape(-1, 4))
        boxes.append(np.concatenate([each.min(axis=1), each.max(axis=1)], axis=1))
    box = np.concatenate(boxes)
    order = in_groups(box[:, :3] + box[:, 3:], LEAF)
    return np.concatenate(faces)[order], np.concatenate(edges), _tree(box[order])


def in_groups(points: np.ndarray, size: int) -> np.ndarray:
    """Return an order of points (n, 3) in which each run of `size` lies close together, each two runs, each
    four: all points are halved across their longest side, then both halves, and so on.

    J. L. Bentley, Communications of the ACM 18 (1975) 509.
    """
    groups = 1 << (-(-len(points) // size) - 1).bit_length()
    filled = np.concatenate([points, np.full((groups * size - len(points), 3), np.inf)])
    order = np.arange(len(filled))[None]
    while order.shape[1] > size:
        places = filled[order]
        sides = np.where(np.isinf(places), -np.inf, places).max(axis=1) - places.min(axis=1)
        across = np.take_along_axis(places, sides.argmax(axis=1)[:, None, None], axis=2)[..., 0]
        halves = np.argpartition(across, order.shape[1] // 2, axis=1)
        order = np.take_along_axis(order, halves, axis=1).reshape(-1, order.shape[1] // 2)
    return order[order < len(points)]


def _spheres(corners: np.ndarray) -> np.ndarray:
    """Centres and radii (blocks, 4) [m] round each block of triangles (n, 3, 3)."""
    filled = np.concatenate([corners, np.repeat(corners[-1:], -len(corners) % BLOCK, axis=0)])
    blocks = filled.reshape(-1, 3 * BLOCK, 3)
    centres = (blocks.min(axis=1) + blocks.max(axis=1)) / 2
    return np.column_stack([centres, np.linalg.norm(blocks - centres[:, None], axis=2).max(axis=1)])


def _tree(boxes: np.ndarray) -> np.ndarray:
    """The boxes of a binary tree over boxes (n, 6) [m]: the root first, the leaves last."""
    leaves = 1 << (-(-len(boxes) // LEAF) - 1).bit_length()
    empty = np.tile([np.inf] * 3 + [-np.inf] * 3, (leaves * LEAF - len(boxes), 1))
    groups, levels = np.concatenate([boxes, empty]).reshape(leaves, LEAF, 6), []
    while True:
        level = np.concatenate([groups[..., :3].min(axis=1), groups[..., 3:].max(axis=1)], axis=1)
        levels.append(level)
        if len(level) == 1:
            return np.concatenate(levels[::-1])
        groups = level.reshape(-1, 2, 6)
