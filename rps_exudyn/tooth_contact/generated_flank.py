"""The rack's tangent plane at the line of contact, where the ratio varies, see `gears.course`.

For a translation D of the rack against its place at the pinion angle chi the depth of the flanks is

    d(chi) = s r_b cos(beta_b) (chi - phi) + N(chi) . D   where   d' = 0:   F(chi) = e_r(chi) . D = 0,

for all teeth of a side at once. Two steps of Newton's method leave 1e-7 of F; with none the force is not the
energy's derivative. The line of contact then lies on the plane chi as on that of a constant ratio.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline

STEPS = 2  # of Newton's method


class TangentPlane(NamedTuple):
    """Normal and offset of one side, as in the record `FLANK`, and what belongs to the angle chi."""

    normal_x: float
    normal_y: float
    normal_z: float
    offset: float
    gain: float
    bend: float  # 1 / Q [1/m]


@inline
def course_at(angle, data):  # type: ignore[no-untyped-def]
    """X, g and g' of the rack at a pinion angle."""
    low, high = 0, data.course_pieces
    while high - low > 1:
        middle = (low + high) // 2
        if data.course_starts[middle] <= angle:
            low = middle
        else:
            high = middle
    u, piece = angle - data.course_starts[low], data.course[low]
    x, a, b, c, d = piece[0], piece[1], piece[2], piece[3], piece[4]
    travel = x + u * (a + u * (b / 2 + u * (c / 3 + u * d / 4)))
    return travel, a + u * (b + u * (c + u * d)), b + u * (2 * c + u * 3 * d)


@inline
def tangent_plane(s, angle, gx, gy, gz, rotation, data):  # type: ignore[no-untyped-def]
    """Return the plane of side s at a pose: the pinion's angle, the gear's centre from the rack's reference
    point in the housing, the rack's rotation."""
    x = -(rotation[0, 0] * gx + rotation[1, 0] * gy + rotation[2, 0] * gz)  # in the rack's own frame
    y = -(rotation[0, 1] * gx + rotation[1, 1] * gy + rotation[2, 1] * gz) - data.rack_reference[1]
    z = -(rotation[0, 2] * gx + rotation[1, 2] * gy + rotation[2, 2] * gz)
    chi, A = -angle, data.sine_per_gain
    travel, g, slope = course_at(chi, data)
    for _ in range(STEPS):
        S = A / g + data.sine_offset
        c = np.sqrt(1 - S * S)
        e = data.cos_design * (x - travel) - data.sin_design * z
        turn = -s * A * slope / (g * g * c)  # dpsi*/dchi, e_r = (s c, S), e_t = (-S, s c)
        rise = turn * (s * c * y - S * e) - g * data.cos_design * s * c
        chi -= (s * c * e + S * y) / rise
        travel, g, slope = course_at(chi, data)
    S = A / g + data.sine_offset
    c, base = np.sqrt(1 - S * S), data.normal_base_pitch * data.teeth / (2 * np.pi)
    n_x, n_y = base / g, base / data.base_radius * c
    level = base * (data.kappa - np.arccos(S) + s * (chi - travel / g))
    bend = data.base_radius * slope / (g * g * g * data.cos_design * data.cos_design * c * c)
    return TangentPlane(
        n_x, n_y, n_x * (data.trace + g * data.trace_per_gain), level + n_y * data.rack_reference[1], g, bend
    )
