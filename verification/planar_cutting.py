"""A rack cut by planar sections: at stations across the bar, a pinion's section swept through all angles.

No theory of gearing: the pinion is the set of points whose angle from a tooth's middle is at most the half
angle of its involutes; on a line of the rack along X, at a height and a station, each angle of the pinion
takes an interval away, and the union of these is the space between two teeth.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.gears.basic_rack import half_angle
from rps_exudyn.gears.gear_pair import GearPair

SAMPLES = 400  # of a line on which the pinion's section is sought


class Space(NamedTuple):
    """What is cut on lines (n,) along X: from `low` to `high` [m], where |low| = inf nothing is."""

    low: np.ndarray
    high: np.ndarray


def cut_space(
    pair: GearPair, tooth: int, heights: np.ndarray, stations: np.ndarray, angles: np.ndarray
) -> Space:
    """Return what a pinion's tooth cuts out of the rack.

    Args:
        pair: of a course.
        tooth: number of the pinion's tooth, over all turns.
        heights: of lines above the pinion's axis (n,) [m].
        stations: Z of these lines (n,) [m].
        angles: of the pinion, in small steps (k,) [rad].
    """
    c, s = np.cos(pair.design.delta), np.sin(pair.design.delta)
    middle = np.pi / 2 + np.pi / pair.teeth * (1 + 2 * tooth)
    low, high = np.full(len(heights), np.inf), np.full(len(heights), -np.inf)
    reach = pair.tip_radius + pair.bar_radius * abs(s / c) + 1e-3
    x = np.linspace(-1, 1, SAMPLES)[None] * reach
    for angle in angles:
        travel = float(pair.travel_at(angle))

        def outside(x: np.ndarray, angle: float = angle) -> np.ndarray:
            """Angle of points beyond the tooth's flanks, positive outside [rad]."""
            e, k = c * x - s * stations[:, None], s * x + c * stations[:, None]
            radius = np.hypot(e, heights[:, None])
            turned = np.arctan2(heights[:, None], e) - (middle - angle - pair.twist * k)
            turned = (turned + np.pi) % (2 * np.pi) - np.pi
            beyond = np.abs(turned) - half_angle(pair, np.maximum(radius, pair.base_radius))
            return np.where(radius <= pair.tip_radius, beyond, 1.0)

        turn = middle - angle - np.pi / 2  # of the tooth from the line pinion to rack, at Z = 0
        if abs(turn) > np.pi:
            continue
        values = outside(x)
        inside = values <= 0
        rows = np.flatnonzero(inside.any(axis=1))
        if not len(rows):
            continue
        for sign, best in ((1, low), (-1, high)):
            at = inside.argmax(axis=1) if sign > 0 else SAMPLES - 1 - inside[:, ::-1].argmax(axis=1)
            a, b = x[0, np.maximum(np.minimum(at - sign, SAMPLES - 1), 0)], x[0, at]  # outside, inside
            for _ in range(34):
                m = (a + b) / 2
                found = outside(m[:, None])[:, 0] <= 0
                a, b = np.where(found, a, m), np.where(found, m, b)
            end = (a + b) / 2 - travel
            best[rows] = (np.minimum if sign > 0 else np.maximum)(best[rows], end[rows])
    return Space(low, high)
