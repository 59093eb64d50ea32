"""Surfaces of gears from files of others: STL, PLY, OBJ, GLB by trimesh, STEP by cascadio (extra `step`).

A file is read in a process of its own with bounded memory and time (`base.child_process`). The surface comes
back as triangles, in the numbers of the file; their unit is that in which the gear has the size of a steering
gear (`unit_of`).

Surfaces may be open. Their normals point out of the material: an edge that two triangles pass in the same
sense states that one of them is inverted.
"""

import io
import sys
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rps_exudyn.base.child_process import MOST_MEMORY, answer, read_within_bounds
from rps_exudyn.base.errors import InputError

MOST_TRIANGLES = 2_000_000
MOST_TIME = 60  # of the reading process [s of CPU time]
READERS = ("stl", "ply", "obj", "glb", "step", "stp")
STEP_CHORD = 1e-3  # of curved faces [mm]; 1e-4 takes minutes on splines
SIZES = (2e-3, 60e-3)  # of a tip radius, and of a rack's pitch [m]
UNITS = {"mm": 1e-3, "m": 1.0}
SMOOTH = 0.9  # cosine between neighbours, less of which is an edge of the body
ODD = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of one part."""

    corners: np.ndarray  # in the unit of the file, counter-clockwise seen from outside, shape (m, 3, 3)

    @cached_property
    def area_vectors(self) -> np.ndarray:
        """Area times outward unit normal, shape (m, 3)."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return np.cross(b - a, c - a) / 2

    @cached_property
    def areas(self) -> np.ndarray:
        """Areas, shape (m,)."""
        return np.linalg.norm(self.area_vectors, axis=1)

    @cached_property
    def normals(self) -> np.ndarray:
        """Outward unit normals, shape (m, 3)."""
        return self.area_vectors / self.areas[:, None]

    @cached_property
    def vertices(self) -> np.ndarray:
        """A number for each corner, shape (m, 3), the same where corners are one point: a hash of its bits,
        by which six million are compared in a second."""
        bits = (self.corners + 0.0).view(np.uint64)
        bits ^= bits >> np.uint64(29)
        vertex = (bits * ODD).sum(axis=2, dtype=np.uint64)
        return np.asarray(vertex ^ vertex >> np.uint64(31))

    @cached_property
    def _edges(self) -> tuple[np.ndarray, np.ndarray]:
        """Keys of all edges in their triangle's sense, and of the same in the other one, (3 m,) each."""
        start, end = self.vertices, np.roll(self.vertices, -1, axis=1)
        return (start * ODD[0] + end * ODD[1]).ravel(), (end * ODD[0] + start * ODD[1]).ravel()

    @cached_property
    def neighbours(self) -> np.ndarray:
        """Numbers of two triangles that share an edge, shape (k, 2): each pair once."""
        forward, backward = self._edges
        order = np.argsort(forward)
        at = np.minimum(np.searchsorted(forward, backward, sorter=order), len(order) - 1)
        pairs = np.stack([np.arange(len(order)), order[at]], axis=1)
        return pairs[(forward[order[at]] == backward) & (pairs[:, 0] < pairs[:, 1])] // 3

    @cached_property
    def heights(self) -> np.ndarray:
        """Mean heights of a smooth surface through the corners over each triangle, shape (m,); below 0 where
        it is hollow.

        A surface of curvature kappa along an edge of length l lies sum(kappa l^2) / 24 over the plane, and a
        twelfth of the sum by which the far corners of the three neighbours lie under it.
        """
        over = np.concatenate([self.neighbours, self.neighbours[:, ::-1]])
        over = over[np.einsum("ij,ij->i", *self.normals[over.T]) > SMOOTH]
        below = np.einsum(
            "ij,ikj->ik", self.normals[over[:, 0]], self.corners[over[:, 0], :1] - self.corners[over[:, 1]]
        )
        far = np.take_along_axis(below, np.abs(below).argmax(axis=1)[:, None], axis=1)[:, 0]
        return np.bincount(over[:, 0], far, minlength=len(self.areas)) / 12

    @property
    def is_closed(self) -> bool:
        """Whether each edge is passed in both senses."""
        forward, backward = self._edges
        return np.array_equal(np.sort(forward), np.sort(backward))

    @property
    def volume(self) -> float:
        """Volume that a closed surface encloses, below 0 with inverted normals."""
        middle = self.corners.mean(axis=(0, 1))
        return float(np.einsum("ij,ij->", self.corners[:, 0] - middle, self.area_vectors) / 3)

    def check_normals(self) -> None:
        """Refuse inverted triangles.

        Raises:
            InputError: some, or all of a closed surface, are inverted.
        """
        forward, backward = self._edges
        keys, counts = np.unique(forward, return_counts=True)
        twice = keys[counts == 2]
        if mixed := np.count_nonzero(~np.isin(twice, backward)):
            raise InputError(
                f"has mixed normals: {mixed} edges are passed in the same sense by both their triangles"
            )
        if self.is_closed and self.volume < 0:
            raise InputError("has inverted normals: they point into the material")


def surface_in(content: bytes, suffix: str, part: str = "") -> Surface:
    """Return the surface in the bytes of a file; of files with several named parts that of `part`.

    Raises:
        InputError: what is wrong with them, to follow the file's name.
    """
    kind = suffix.lower().removeprefix(".")
    if kind not in READERS:
        raise InputError(f"is no surface; its suffix must be one of .{', .'.join(READERS)}")
    read = read_within_bounds("rps_exudyn.gears.mesh_file", content, kind, part)
    if read is None:
        raise InputError(
            f"is no {kind.upper()}, or takes more than {MOST_TIME} s or {MOST_MEMORY / 2**30:.0f} GB to read"
        )
    return Surface(np.frombuffer(read).reshape(-1, 3, 3))


def unit_of(length: float, what: str) -> tuple[str, float]:
    """Return name and size [m] of the unit in which a length is that of a steering gear.

    Raises:
        InputError: it is in none.
    """
    for name, size in UNITS.items():
        if SIZES[0] <= length * size <= SIZES[1]:
            return name, size
    low, high = (f"{1e3 * each:g}" for each in SIZES)
    raise InputError(
        f"has a {what} of {length:.4g} in its own unit; in mm or m it must be from {low} to {high} mm"
    )


# --- The process that reads: kind and part as arguments, bytes in, array out


def _triangles(content: bytes, kind: str, part: str) -> bytes:
    import trimesh

    options: dict[str, float] = {}
    if kind in ("step", "stp"):
        if kind not in trimesh.available_formats():
            raise InputError('needs the extra step: pip install "rps-exudyn[step]"')
        options = {"tol_linear": STEP_CHORD}
    scene = trimesh.load_scene(io.BytesIO(content), file_type=kind, process=False, **options)
    places = [scene.graph[node] for node in scene.graph.nodes_geometry]
    named = [place for place in places if place[1] == part] or places
    blocks: list[np.ndarray] = []
    count = 0
    for matrix, name in named:
        mesh = scene.geometry[name]
        faces = np.asarray(getattr(mesh, "faces", np.empty((0, 3), dtype=int)))
        count += len(faces)
        if count > MOST_TRIANGLES:
            raise InputError(f"has more than {MOST_TRIANGLES} triangles")
        if faces.size and not 0 <= faces.min() <= faces.max() < len(mesh.vertices):
            raise InputError("names vertices that it does not have")
        blocks.append(trimesh.transform_points(np.asarray(mesh.vertices, dtype=float), matrix)[faces])
    corners = blocks[0] if len(blocks) == 1 else np.concatenate([np.empty((0, 3, 3)), *blocks])
    areas = Surface(corners).areas
    if not np.isfinite(areas).all():
        raise InputError("has vertices that are no finite numbers")
    if not areas.any():
        raise InputError("holds no triangles")
    return (corners if areas.all() else corners[areas > 0]).tobytes()


if __name__ == "__main__":
    sys.exit(answer(_triangles, MOST_TIME))
