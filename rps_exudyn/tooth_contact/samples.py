"""Samples of the pinion's flanks: their places, and the area that each stands for.

A regular grid of midpoints over the part of a flank that meets the rack: the tangent length q between the
limits of contact, the axial Z between the face's or the round bar's ends at that height. Every sample
carries the area of its cell, so that no edge sample counts too much. The line of contact crosses the grid
slantwise, which is why a few rows sample it evenly.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.tooth_contact.mean_depth import axial_reach, contact_ends

EDGE = 1e-9  # barycentric tolerance: a ray through a common edge belongs to both triangles


class FlankSamples(NamedTuple):
    """Samples of one flank in the pinion frame."""

    points: np.ndarray  # (n, 3) [m]
    normals: np.ndarray  # (n, 3) out of the tooth
    areas: np.ndarray  # (n,) [m^2]
    curvature_radii: np.ndarray  # (n,) across the generators [m]


def sample_flank(flank: Flank, profile: int, axial: int, approach: float) -> FlankSamples:
    """`profile` x `axial` samples on the part of the flank that meets a rack pressed in by `approach` [m].

    A point of the flank meets the rack once per turn, at a height and a lateral place that do not depend
    on the travel; what lies beyond the rack's tips or its round bar is left out here, so the rack's flanks
    need no edges of their own. Half a tenth of a millimetre of approach moves the tips' limit by 3 % of the
    path of contact: it must be known here.
    """
    pair = flank.pair
    q_start, q_tip = contact_ends(pair, approach)
    q_step = (q_tip - q_start) / profile
    q = (q_start + q_step * (np.arange(profile) + 0.5))[:, None]

    low, high = axial_reach(pair, flank.side, q, approach)
    Z = low + (high - low) * (np.arange(axial) + 0.5) / axial
    psi = flank.generator(q, Z)
    step_psi = q_step / pair.base_radius
    radii = np.broadcast_to(flank.area_element(psi, Z), Z.shape)
    areas = radii * step_psi * np.broadcast_to((high - low) / axial, Z.shape)
    return FlankSamples(
        flank.point(psi, Z).reshape(-1, 3), flank.normal(psi).reshape(-1, 3), areas.ravel(), radii.ravel()
    )


def mesh_distance(samples: FlankSamples, triangles: np.ndarray) -> np.ndarray:
    """Distances of samples from a triangulated flank along their normals, shape (n,) [m].

    `triangles` (m, 3, 3) [m] are those of the flank, and may be more; of several crossings the nearest
    counts. It is 0 where no triangle lies under the sample.
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
    return np.where(np.isfinite(nearest), nearest, 0.0)[:, 0]
