"""How deep the teeth stand in each other under the yoke's preload, as a mean over the tooth pitch.

The plunger presses both sides of the teeth alike, each with P / (2 sin alpha_n), friction left out. A line
of contact passes over the field of contact once per pitch, so that the mean of what all lines of one side
carry at the depth d is an integral over that field,

    N(d) = 1 / (p_et cos beta_b) int int F'(d, q) dq dZ,      p_et = 2 pi r_b / z,

with the load per length F' = 4/3 k d sqrt(2 rho d), rho = q / cos beta_b, of pressure proportional to
depth, or F' = c' d. Pressed in, the rack's tips end the contact further down, and the round bar is wider.
"""

from collections.abc import Callable

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear

DEEPEST = 1e-2  # depth beyond all depths that a tooth can have [m]
ACCURACY = 1e-13  # of the depth [m]
POINTS = 64  # midpoints along the path of contact: 1e-3 of the depth


def mean_depth(gear: SteeringGear) -> float:
    """Return the mean depth of the contact under the preload, by the gear's `mesh.law` [m]."""
    pair, mesh = GearPair.of(gear), gear.mesh
    load, per_depth = gear.yoke.preload / (2 * np.sin(pair.alpha_n)), line_stiffness(gear)
    if load == 0:
        return 0.0

    def by_area(depth: float, rho: np.ndarray) -> np.ndarray:
        return 4 / 3 * mesh.stiffness * depth * np.sqrt(2 * rho * depth)

    def by_line(depth: float, rho: np.ndarray) -> np.ndarray:
        return np.full_like(rho, per_depth * depth)

    law = by_area if mesh.contact_law == "area" else by_line

    if load > mean_load(pair, DEEPEST, law):
        return DEEPEST
    low, high = 0.0, DEEPEST
    while high - low > ACCURACY:
        middle = (low + high) / 2
        low, high = (low, middle) if mean_load(pair, middle, law) > load else (middle, high)
    return high


def mean_load(pair: GearPair, depth: float, law: Callable[[float, np.ndarray], np.ndarray]) -> float:
    """Return the mean normal force of one side [N] at a depth [m]; `law` gives F' from depth and rho."""
    approach = rack_approach(pair, depth)
    start, stop = contact_ends(pair, approach)
    step = (stop - start) / POINTS
    q = start + step * (np.arange(POINTS) + 0.5)
    low, high = axial_reach(pair, 1, q, approach)
    per_length = law(depth, q / np.cos(pair.beta_b))
    pitch = 2 * np.pi * pair.base_radius / pair.teeth
    return float(np.sum(per_length * (high - low)) * step / (pitch * np.cos(pair.beta_b)))


def rack_approach(pair: GearPair, depth: float) -> float:
    """Return how far the rack is pressed in where both sides' contacts are `depth` deep [m].

    Beyond an eighth of a module, where no contact law holds any more, it counts as that.
    """
    return float(min(depth / np.sin(pair.alpha_n), pair.module / 8))


def contact_ends(pair: GearPair, approach: float) -> tuple[float, float]:
    """Tangent lengths between which the flank meets a rack pressed in by `approach` along -Y [m].

    The rack's tips or the form circle end it below, the pinion's tips above.
    """
    at_pitch_point = pair.reference_radius * np.sin(pair.alpha_t)
    tips = pair.active_path[0] + at_pitch_point - approach / np.sin(pair.alpha_t)
    return max(tips, form_point(pair).tangent_length), pair.active_path[1] + at_pitch_point


def axial_reach(pair: GearPair, side: int, q: np.ndarray, approach: float) -> tuple[np.ndarray, np.ndarray]:
    """Z between which the flank meets the rack, at tangent lengths q, the rack pressed in by `approach` [m].

    The contact point is P + (q - r_p sin alpha_t) t + Z k, t = -side cos(alpha_t) e + sin(alpha_t) Y; it must
    lie within the face and within the round bar, (y - y_bar)^2 + z^2 <= R^2.
    """
    e, k = pair.pinion_frame[:, 0], pair.pinion_frame[:, 2]
    from_pitch_point = q - pair.reference_radius * np.sin(pair.alpha_t)
    height = pair.reference_radius + from_pitch_point * np.sin(pair.alpha_t)
    below_axis = pair.bar_axis_height - approach - height
    half_chord = np.sqrt(np.maximum(pair.bar_radius**2 - below_axis**2, 0))
    z_at_0 = -side * from_pitch_point * np.cos(pair.alpha_t) * e[2]
    ends = (-half_chord - z_at_0) / k[2], (half_chord - z_at_0) / k[2]
    b = pair.face_width / 2
    return np.clip(ends[0], -b, b), np.clip(ends[1], -b, b)
