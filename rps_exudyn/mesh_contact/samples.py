"""Samples of the pinion's flanks: their places, and the area that each stands for.

A regular grid of midpoints over the part of a flank that meets the rack: the tangent length q between the
limits of contact, the axial Z between the face's or the round bar's ends at that height. Every sample
carries the area of its cell, so that no edge sample counts too much. The line of contact crosses the grid
slantwise, which is why a few rows sample it evenly.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank

EDGE = 1e-9  # barycentric tolerance: a ray through a common edge belongs to both triangles


class FlankSamples(NamedTuple):
    """Samples of one flank in the pinion frame."""

    points: np.ndarray  # (n, 3) [m]
    normals: np.ndarray  # (n, 3) out of the tooth
    areas: np.ndarray  # (n,) [m^2]


def sample_flank(flank: Flank, profile: int, axial: int) -> FlankSamples:
    """`profile` x `axial` samples on the part of the flank that meets the rack.

    A point of the flank meets the rack once per turn, at a height and a lateral place that do not depend
    on the travel; what lies beyond the rack's tips or its round bar is left out here, so the rack's flanks
    need no edges of their own.
    """
    pair = flank.pair
    at_pitch_point = pair.reference_radius * np.sin(pair.alpha_t)
    q_start = max(pair.active_path[0] + at_pitch_point, flank.form_tangent_length)
    q_step = (flank.tip_tangent_length - q_start) / profile
    q = (q_start + q_step * (np.arange(profile) + 0.5))[:, None]

    low, high = axial_reach(pair, flank.side, q - at_pitch_point)
    Z = low + (high - low) * (np.arange(axial) + 0.5) / axial
    psi = flank.generator(q, Z)
    step_psi = q_step / pair.base_radius
    areas = flank.area_element(psi, Z) * step_psi * np.broadcast_to((high - low) / axial, Z.shape)
    return FlankSamples(flank.point(psi, Z).reshape(-1, 3), flank.normal(psi).reshape(-1, 3), areas.ravel())


def onto_mesh(samples: FlankSamples, triangles: np.ndarray) -> FlankSamples:
    """Samples moved along their normals onto a triangulated flank.

    `triangles` (m, 3, 3) [m] are those of the flank, and may be more; of several crossings the nearest
    counts. A sample keeps its place where no triangle lies under it.
    """
    a, edge1, edge2 = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(edge1, edge2)
    p, d = samples.points, samples.normals
    moment = np.cross(p, d)
    # Moeller and Trumbore for all pairs: p + t d = a + u edge1 + v edge2
    with np.errstate(divide="ignore", invalid="ignore"):
        det = d @ normal.T
        t = (np.einsum("ij,ij->i", normal, a) - p @ normal.T) / det
        u = (d @ np.cross(edge2, a).T - moment @ edge2.T) / det
        v = -(d @ np.cross(edge1, a).T - moment @ edge1.T) / det
        inside = (u >= -EDGE) & (v >= -EDGE) & (u + v <= 1 + EDGE)
    t = np.where(inside, t, np.inf)
    nearest = np.take_along_axis(t, np.argmin(np.abs(t), axis=1)[:, None], axis=1)
    return samples._replace(points=p + np.where(np.isfinite(nearest), nearest, 0.0) * d)


def axial_reach(pair: GearPair, side: int, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Z between which the flank meets the rack, at q from the pitch point on the path of contact [m].

    The contact point is P + q t + Z k, t = -side cos(alpha_t) e + sin(alpha_t) Y; it must lie within the
    face and within the round bar, (y - y_bar)^2 + z^2 <= R^2.
    """
    e, k = pair.pinion_frame[:, 0], pair.pinion_frame[:, 2]
    height = pair.reference_radius + q * np.sin(pair.alpha_t) - pair.bar_axis_height
    half_chord = np.sqrt(np.maximum(pair.bar_radius**2 - height**2, 0))
    z_at_0 = -side * q * np.cos(pair.alpha_t) * e[2]
    ends = (-half_chord - z_at_0) / k[2], (half_chord - z_at_0) / k[2]
    b = pair.face_width / 2
    return np.clip(ends[0], -b, b), np.clip(ends[1], -b, b)
