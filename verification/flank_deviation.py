"""Deviation of a pinion's mesh from the analytic flanks."""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank

ROUNDING = 1e-12  # of a vertex on the form circle [m]


@dataclass(frozen=True)
class Deviation:
    """Signed distance of the mesh from the helicoid over all flanks, positive for material left over [m]."""

    maximum: float
    minimum: float
    rms: float  # weighted with area


def flank_deviation(pair: GearPair, vertices: np.ndarray, faces: np.ndarray, divisions: int = 8) -> Deviation:
    """Deviation of a closed mesh of the toothed pinion, sampled on a grid over each of its flank faces.

    A face belongs to a flank if it lies outside the form circle and is parallel to the flank within
    20 degrees; the grid has `divisions` steps along each edge, so that it holds corners and edges.
    """
    i, j = np.indices((divisions + 1, divisions + 1)).reshape(2, -1)
    inside = i + j <= divisions
    weights = np.stack([i, j, divisions - i - j], axis=1)[inside] / divisions
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    radius = np.hypot(corners[..., 0], corners[..., 1])
    distances, areas = [], []
    for side in (-1, 1):
        flank = Flank(pair, 0, side)
        outside = (radius > np.hypot(pair.base_radius, flank.form_tangent_length) - ROUNDING).all(axis=1)
        centre = corners.mean(axis=1)
        q = np.sqrt(np.maximum(np.hypot(centre[:, 0], centre[:, 1]) ** 2 - pair.base_radius**2, 0))
        psi = np.arctan2(centre[:, 1], centre[:, 0]) - side * np.arctan2(q, pair.base_radius)
        parallel = np.einsum("ij,ij->i", flank.normal(psi), cross) > np.cos(np.radians(20)) * area
        chosen = outside & parallel
        points = np.einsum("kc,fcx->fkx", weights, corners[chosen])
        distances.append(_to_any_tooth(flank, points))
        areas.append(np.broadcast_to(area[chosen, None], points.shape[:2]))
    d, a = np.concatenate(distances), np.concatenate(areas)
    return Deviation(float(d.max()), float(d.min()), float(np.sqrt(np.average(d**2, weights=a))))


def _to_any_tooth(flank: Flank, points: np.ndarray) -> np.ndarray:
    """Signed distance from the flank, or from the same flank of the tooth next to the point [m]."""
    pair = flank.pair
    pitch = 2 * np.pi / pair.teeth * pair.base_radius * np.cos(pair.beta_b)  # along the normal
    return np.remainder(flank.distance(points) + pitch / 2, pitch) - pitch / 2
