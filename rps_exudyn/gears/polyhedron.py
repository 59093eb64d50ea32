"""Closed triangle meshes: volume integrals, booleans in double precision, and the guard against bad ones.

Faces are triples of vertex indices, counter-clockwise seen from outside. Booleans go through
manifold3d's `Mesh64`: penetrations here are micrometres, and single precision is not enough.
"""

from dataclasses import dataclass
from functools import cached_property

import manifold3d
import numpy as np

from rps_exudyn.base.errors import InputError

LEAST_HEIGHT = 1e-12  # of a face [m], else a sliver: rounding is 1e-18, so that other normals keep six digits


@dataclass(frozen=True)
class MassProperties:
    """Integrals over a solid, in its own frame."""

    volume: float  # [m^3]
    mass: float  # [kg]
    centre_of_mass: np.ndarray  # [m], shape (3,)
    inertia: np.ndarray  # about the centre of mass [kg m^2], shape (3, 3)


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed mesh of one material."""

    vertices: np.ndarray  # [m], shape (n, 3)
    faces: np.ndarray  # shape (m, 3)
    density: float  # [kg/m^3]

    @cached_property
    def mass_properties(self) -> MassProperties:
        """Exact integrals over the polyhedron (divergence theorem, one tetrahedron per face)."""
        origin = self.vertices.mean(axis=0)  # near the solid: no cancellation for a body far from the origin
        a, b, c = np.moveaxis((self.vertices - origin)[self.faces], 1, 0)
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
        volume = volumes.sum()
        centre = volumes @ (a + b + c) / (4 * volume)
        total = a + b + c
        second = sum(np.einsum("i,ij,ik->jk", volumes, p, p) for p in (a, b, c, total)) / 20
        second = second - volume * np.outer(centre, centre)
        inertia = self.density * (np.trace(second) * np.eye(3) - second)
        centre = origin + centre
        centre.flags.writeable = inertia.flags.writeable = False  # solids are shared
        return MassProperties(float(volume), float(self.density * volume), centre, inertia)


def refuse_defects(name: str, vertices: np.ndarray, faces: np.ndarray) -> None:
    """Refuse a mesh that no contact search or integral can use.

    Raises:
        InputError: open or doubled edges, inverted normals, or faces without area.
    """
    problem = defect(vertices, faces)
    if problem:
        raise InputError(f"The mesh of the {name} is not usable: {problem}.")


def defect(vertices: np.ndarray, faces: np.ndarray) -> str | None:
    """The first defect of a closed mesh, in words; None for a sound one."""
    if not np.isfinite(vertices).all():
        return f"{np.count_nonzero(~np.isfinite(vertices).all(axis=1))} vertices are not finite"
    start, end = (corners.astype(np.int64).ravel() for corners in (faces, np.roll(faces, -1, axis=1)))
    n = len(vertices)
    forward, backward = np.sort(start * n + end), np.sort(end * n + start)
    if not np.array_equal(forward, backward) or (np.diff(forward) == 0).any():
        doubled = np.unique(forward[1:][np.diff(forward) == 0]).size
        if doubled:
            return f"{doubled} edges are used twice in the same sense (inverted normals)"
        return f"{np.setdiff1d(forward, backward).size} edges are open"
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    double_area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    longest = np.linalg.norm([b - a, c - b, a - c], axis=2).max(axis=0)
    slivers = np.count_nonzero(double_area < LEAST_HEIGHT * longest)
    if slivers:
        return f"{slivers} faces are slivers with a height below {LEAST_HEIGHT:g} m"
    if np.einsum("ij,ij->i", a, np.cross(b, c)).sum() <= 0:
        return "its faces point inwards"
    return None


def to_manifold(vertices: np.ndarray, faces: np.ndarray) -> manifold3d.Manifold:
    """A closed mesh ready for booleans.

    Raises:
        ValueError: the mesh is not closed and consistently oriented.
    """
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(
            np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(faces, dtype=np.uint64)
        )
    )
    if solid.status() != manifold3d.Error.NoError:
        raise ValueError(f"no closed mesh: {solid.status()}")
    return solid


def from_manifold(solid: manifold3d.Manifold) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and faces (m, 3) of a boolean's result."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.int64)


def prism(outline: np.ndarray, start: np.ndarray, end: np.ndarray) -> manifold3d.Manifold:
    """Make the body that an outline sweeps: a plane polygon, counter-clockwise, shape (n, 2) [m].

    `start` and `end` are affine maps (3, 3) of (1, x, y) -> point of the first and of the last outline [m].
    """
    flat = np.concatenate([np.ones((len(outline), 1)), outline], axis=1)
    return lofted(np.stack([flat @ np.asarray(start).T, flat @ np.asarray(end).T]), outline, outline)


def lofted(sections: np.ndarray, first: np.ndarray, last: np.ndarray) -> manifold3d.Manifold:
    """Make the body between closed polygons (k, n, 3) [m], whose first and last one are plane caps.

    `first` and `last` (n, 2) are these two in their planes, counter-clockwise.
    """
    k, n = sections.shape[:2]
    caps = (
        np.asarray(manifold3d.triangulate([np.ascontiguousarray(each, dtype=np.float64)]))
        for each in (first, last)
    )
    bottom, top = caps
    i = np.arange(n)
    j = (i + 1) % n
    walls = np.concatenate([np.stack([i, j, j + n], axis=1), np.stack([i, j + n, i + n], axis=1)])
    walls = (walls + n * np.arange(k - 1)[:, None, None]).reshape(-1, 3)
    faces = np.concatenate([bottom[:, ::-1], top + n * (k - 1), walls])
    vertices = sections.reshape(-1, 3)
    a, b, c = np.moveaxis((vertices - vertices.mean(axis=0))[faces], 1, 0)
    if np.einsum("ij,ij->i", a, np.cross(b, c)).sum() < 0:  # swept against the outline's own normal
        faces = faces[:, ::-1]
    return to_manifold(vertices, faces)


def cylinder(radius: float, start: np.ndarray, end: np.ndarray, segments: int) -> manifold3d.Manifold:
    """A round bar from one point to another, as a regular prism inscribed in it."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    axis = (end - start) / np.linalg.norm(end - start)
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(axis, across)], axis=1)
    angle = 2 * np.pi * np.arange(segments) / segments
    circle = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return prism(circle, np.column_stack([start, frame]), np.column_stack([end, frame]))
