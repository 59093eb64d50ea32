"""Where spheres sit on the pinion's flanks, and how much area each stands for.

A regular grid of midpoints over the part of a flank that meets the rack: the tangent length q between the
limits of contact, the axial Z between the face's or the round bar's ends at that height. Every sample
carries the area of its cell, so that no edge sample counts too much. The line of contact crosses the grid
slantwise, which is why a few rows sample it evenly.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank


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
    q_start = max(pair.field[0] + at_pitch_point, flank.form_tangent_length)
    q_step = (flank.tip_tangent_length - q_start) / profile
    q = (q_start + q_step * (np.arange(profile) + 0.5))[:, None]

    low, high = axial_reach(pair, flank.side, q - at_pitch_point)
    Z = low + (high - low) * (np.arange(axial) + 0.5) / axial
    psi = flank.generator(q, Z)
    step_psi = q_step / pair.base_radius
    areas = flank.area_element(psi, Z) * step_psi * np.broadcast_to((high - low) / axial, Z.shape)
    return FlankSamples(flank.point(psi, Z).reshape(-1, 3), flank.normal(psi).reshape(-1, 3), areas.ravel())


def axial_reach(pair: GearPair, side: int, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Z between which the flank meets the rack, at q from the pitch point along the line of action [m].

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
