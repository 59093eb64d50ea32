"""The basic rack (ISO 53) that generates the pinion, and what it allows.

    y ^     u_tip                 normal section, from the reference line and from the
      |   .______                 middle of a tooth; the tooth's tip is at y = h_aP
      |  /       \\
    --|-/---------\\------- reference line, tooth and space are pi m_n / 2 wide
      |/           \\
      .  C1         \\        C1: the straight flank ends here, the fillet begins
     (               )
    _/                \\__   y = -h_fP

The pinion's cutter has the shape of the *spaces* of this rack: its tip is the rack's root.
"""

from functools import lru_cache
from math import atan, hypot, ulp

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair


def involute(alpha: float | np.ndarray) -> float | np.ndarray:
    """The involute function inv(alpha) = tan(alpha) - alpha [rad]."""
    return np.tan(alpha) - alpha


# --- the profile -------------------------------------------------------------------------------
def straight_depth(pair: GearPair) -> float:
    """Depth of C1 below the reference line, h_fP - rho_fP (1 - sin alpha_n) [m]."""
    return pair.rack_dedendum - pair.fillet_radius * (1 - np.sin(pair.alpha_n))


def cutter_tip_centre(pair: GearPair) -> tuple[float, float]:
    """Centre (u, y) of the cutter's rounded tip, from the middle of the cutter's tooth [m].

    A negative u means that the two roundings overlap: such a cutter does not exist.
    """
    depth = pair.rack_dedendum - pair.fillet_radius
    half_width = np.pi * pair.module / 4
    return half_width - depth * np.tan(pair.alpha_n) - pair.fillet_radius / np.cos(pair.alpha_n), -depth


def cutter_tip(pair: GearPair, chord_error: float) -> np.ndarray:
    """Right half of the cutter's tip from C1 down to the flat, polygon (u, y) [m], shape (n, 2).

    The chords of the rounding stay within `chord_error` [m].
    """
    u, y = cutter_tip_centre(pair)
    arc = np.pi / 2 - pair.alpha_n
    eta = pair.alpha_n + arc * np.linspace(0, 1, 1 + arc_segments(pair.fillet_radius, arc, chord_error))
    return np.stack([u + pair.fillet_radius * np.cos(eta), y - pair.fillet_radius * np.sin(eta)], axis=-1)


def rack_tooth(pair: GearPair, chord_error: float) -> np.ndarray:
    """One tooth of the rack, root middle to root middle: polygon (u, y) [m], shape (n, 2), u ascending."""
    tip = np.array(
        [[np.pi * pair.module / 4 - pair.rack_addendum * np.tan(pair.alpha_n), pair.rack_addendum]]
    )
    pitch = np.pi * pair.module
    root = cutter_tip(pair, chord_error) * [-1, 1] + [pitch / 2, 0]
    right = np.concatenate([tip, root, [[pitch / 2, -pair.rack_dedendum]]])
    right = right[np.concatenate([[True], np.any(np.diff(right, axis=0) != 0, axis=1)])]
    return np.concatenate([right[::-1] * [-1, 1], right])


def arc_segments(radius: float, angle: float, chord_error: float) -> int:
    """Number of chords of an arc whose sagitta r (1 - cos(step / 2)) stays within `chord_error` [m]."""
    step = 2 * np.arccos(max(1 - chord_error / radius, 0.5)) if radius > 0 else np.inf
    return max(int(np.ceil(abs(angle) / step - 1e-9)), 1)


def sagitta(points: np.ndarray, axis: int) -> float:
    """Largest distance of every second point along an axis from the chord beside it [m]."""
    points = np.moveaxis(points, axis, 0)
    chord, offset = points[2::2] - points[:-2:2], points[1::2] - points[:-2:2]
    share = (offset * chord).sum(axis=-1) / (chord * chord).sum(axis=-1)
    return float(np.linalg.norm(offset - share[..., None] * chord, axis=-1).max())


# --- what the teeth become ---------------------------------------------------------------------
def undercut_limit(pair: GearPair) -> float:
    """Smallest profile shift coefficient without undercut (ISO 21771).

    x_min = h* - z sin^2(alpha_t) / (2 cos beta), with h* m_n the depth of C1.
    """
    straight = straight_depth(pair) / pair.module
    return straight - pair.teeth * np.sin(pair.alpha_t) ** 2 / (2 * np.cos(pair.beta_p))


def half_angle(pair: GearPair, radius: float | np.ndarray) -> np.ndarray:
    """Half the angle that a tooth fills at `radius` [m], at least the base radius [rad] (ISO 21771).

    psi + inv alpha_t - inv alpha_R with psi = (pi / 2 + 2 x tan alpha_n) / z and cos alpha_R = r_b / R.
    """
    at_reference = (np.pi / 2 + 2 * pair.profile_shift * np.tan(pair.alpha_n)) / pair.teeth
    alpha = np.arctan2(np.sqrt(np.maximum(np.square(radius) - pair.base_radius**2, 0)), pair.base_radius)
    return np.asarray(at_reference + involute(pair.alpha_t) - involute(alpha))


def crest_width(pair: GearPair, radius: float) -> float:
    """Normal tooth thickness at `radius` [m], s_n = 2 R half_angle cos(beta_R); negative above the point."""
    beta = np.arctan(pair.twist * radius)
    return float(2 * radius * half_angle(pair, radius) * np.cos(beta))


def pointed_radius(pair: GearPair) -> float:
    """Radius at which the two flanks of a tooth meet [m].

    There inv(alpha) is half the angle of the tooth at the base circle: t - arctan(t) with t = tan(alpha), to
    which Newton's method falls from above.

    Raises:
        ValueError: the tooth has no width at its base circle.
    """
    return _pointed_radius(pair.design)


@lru_cache(maxsize=64)
def _pointed_radius(pair: GearPair) -> float:
    half = float(half_angle(pair, pair.base_radius))
    if half <= 0:
        raise ValueError("the tooth has no width at its base circle")
    t, step = half + np.pi / 2, np.inf
    while step > ulp(t):
        step = (t - atan(t) - half) * (1 + t**2) / t**2
        t -= step
    return float(pair.base_radius * hypot(1.0, t))


def tip_radius_for_crest(pair: GearPair, width: float) -> float:
    """Topping: the tip radius at which the crest is `width` wide, measured in the normal section [m].

    Raises:
        ValueError: the tooth is nowhere as wide as that outside its base circle.
    """
    widest = crest_width(pair, pair.base_radius)
    if width >= widest:
        raise ValueError(
            f"the tooth is {widest * 1e3:g} mm wide at its base circle, less than {width * 1e3:g} mm"
        )
    outside = pair.base_radius
    while crest_width(pair, outside) > width:
        outside *= 1.2

    def wider(radius: float) -> float:
        return crest_width(pair, radius) - width

    from scipy.optimize import brentq  # loads in a third of a second

    return float(brentq(wider, pair.base_radius, outside, xtol=1e-15))
