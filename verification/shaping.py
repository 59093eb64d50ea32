"""The pinion as it is cut: a blank from which the basic-rack cutter takes material away, step by step.

After each step the pinion turns by one step and the cutter moves on by r_p times it. What remains is
bounded by planes that touch the helicoid along generators; between two of them material is left over, up
to rho (step cos beta_b)^2 / 8. All tooth spaces being alike, one is cut and copied; and a tooth space being
alike when it is turned by half a turn about its middle, only the cutter's way out of it is computed.
"""

import numpy as np
from manifold3d import Manifold, OpType

from rps_exudyn.gears.basic_rack import arc_segments, cutter_tip
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.polyhedron import cylinder, from_manifold, prism

PAPER_STEPS = 100  # 3.6 degrees each


def shaped_pinion(
    pair: GearPair, steps: int = PAPER_STEPS, chord_error: float = 1e-6
) -> tuple[np.ndarray, np.ndarray]:
    """The toothed pinion as cut in `steps` steps per turn: vertices (n, 3) [m], faces (m, 3).

    `chord_error` [m] is that of the round blank and of the cutter's rounded tip.
    """
    half = pair.face_width / 2
    blank = cylinder(
        pair.tip_radius,
        np.array([0, 0, -half]),
        np.array([0, 0, half]),
        arc_segments(pair.tip_radius, 2 * np.pi, chord_error),
    )
    space = _swept_space(pair, 2 * np.pi / steps, chord_error) ^ blank
    copies = [space.rotate((0, 0, 360 * m / pair.teeth)) for m in range(pair.teeth)]
    return from_manifold(Manifold.batch_boolean([blank, *copies], OpType.Subtract))


def cutter_tooth(pair: GearPair, chord_error: float) -> Manifold:
    """One tooth of the cutter in the tooth space on +Y, pinion frame; it covers the blank's width."""
    tip = cutter_tip(pair, chord_error)
    height = pair.reference_line_height
    back = 1.01 * pair.tip_radius - height
    flank_end = np.pi * pair.module / 4 + back * np.tan(pair.alpha_n)
    right = np.concatenate([[[flank_end, back]], tip])
    outline = np.concatenate([right * [-1, 1], right[::-1]])
    outline[:, 1] += height
    cos_p, sin_p = np.cos(pair.beta_p), np.sin(pair.beta_p)
    across, outwards, trace = np.array([cos_p, 0, -sin_p]), np.array([0, 1.0, 0]), np.array([sin_p, 0, cos_p])
    middle = np.column_stack([np.zeros(3), across, outwards])
    reach = (1.01 * pair.face_width / 2 + flank_end * abs(sin_p)) / cos_p
    along = np.column_stack([reach * trace, np.zeros((3, 2))])
    return prism(outline, middle - along, middle + along)


def _swept_space(pair: GearPair, step: float, chord_error: float) -> Manifold:
    """Union of all positions of one cutter tooth, seen from the pinion."""
    tooth = cutter_tooth(pair, chord_error)
    (x0, y0, _, x1, _, _) = tooth.bounding_box()
    # the tooth misses the blank's cylinder once it stands beyond the chord at the height of its tip
    reach = np.sqrt(pair.tip_radius**2 - y0**2) + (x1 - x0) / 2
    way_out = []
    for phi in np.arange(0, reach / pair.reference_radius, step):
        c, s, shift = np.cos(phi), np.sin(phi), pair.reference_radius * phi
        way_out.append(tooth.transform(np.array([[c, -s, 0, c * shift], [s, c, 0, s * shift], [0, 0, 1, 0]])))
    half = Manifold.batch_boolean(way_out, OpType.Add)
    return half + half.rotate((0, 180, 0))
