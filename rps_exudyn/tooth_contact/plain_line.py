"""Lines of contact of flanks without modifications, whose depth and limits are known in closed form.

Without relief, crowning and slope the crest of the strip stands on xi = 0. There the depth, the distances to
the limits of the flank and to the rack's tips are linear in Z, and the bar's surface is a parabola: the laws
that take loads at the crest need no strip.
"""

import numpy as np

from rps_exudyn.base.compiled import inline
from rps_exudyn.tooth_contact.flank_line import affine


@inline
def clip(low, high, c_0, c_1, c_2):  # type: ignore[no-untyped-def]
    """The part of an interval where c_0 + c_1 Z + c_2 Z^2 > 0, c_2 <= 0."""
    square = c_1 * c_1 - 4 * c_2 * c_0
    if not square > 0:
        return (low, high) if c_1 == 0 and c_2 == 0 and c_0 > 0 else (1.0, -1.0)
    q = -(c_1 + np.copysign(np.sqrt(square), c_1)) / 2
    for root in (c_0 / q, q / c_2):
        rise = c_1 + 2 * c_2 * root
        if rise > 0:
            low = max(low, root)
        elif rise < 0:
            high = min(high, root)
    return low, high


@inline
def is_plain(data):  # type: ignore[no-untyped-def]
    """Return whether the flanks are unmodified."""
    return data.relief == 0 and data.crowning == 0 and data.slope == 0


@inline
def plain_point(z, line, side, data):  # type: ignore[no-untyped-def]
    """P_r, P_t, the tangent length q and the depth at Z."""
    q = line.q_0 + line.q_1 * z
    return data.base_radius, side.sign * q, q, line.d_0 + line.d_1 * z


@inline
def on_plain_line(coefficients, line, side, data):  # type: ignore[no-untyped-def]
    """An affine function of the point along the line: at Z = 0, and its slope."""
    at_middle = affine(coefficients, data.base_radius, side.sign * line.q_0, 0.0)
    return at_middle, coefficients[2] * side.sign * line.q_1 + coefficients[3]


@inline
def slowest_place(line, side, data):  # type: ignore[no-untyped-def]
    """Z where the flanks slide slowest along a line: with parallel axes, where sliding turns about.

    Both components of the slip, along e_r and along B, are linear in Z; nan where nothing slides.
    """
    r, r_z = side.velocity[0] - side.spin[2] * side.sign * line.q_0, side.spin[1]
    r_z -= side.spin[2] * side.sign * line.q_1
    b, b_z = on_plain_line(side.slip, line, side, data)
    square = r_z * r_z + b_z * b_z
    return -(r * r_z + b * b_z) / square if square > 0 else np.nan


@inline
def plain_ends(line, margin, side, data):  # type: ignore[no-untyped-def]
    """Return between which Z the flanks are pressed, `margin` deeper than they are; low > high if nowhere."""
    pressing, per_z = line.d_0 + margin, line.d_1
    if data.damping > 0:
        rate, rate_per_z = on_plain_line(side.part, line, side, data)
        pressing, per_z = pressing + data.damping * rate, per_z + data.damping * rate_per_z
    low, high = _above(-data.half_face, data.half_face, pressing, per_z)
    low, high = _above(low, high, line.q_0 - data.q_form, line.q_1)
    low, high = _above(low, high, data.q_tip - line.q_0, -line.q_1)
    y, y_z = on_plain_line(side.y, line, side, data)
    low, high = _above(low, high, y + data.tip_depth, y_z)
    z, z_z = on_plain_line(side.z, line, side, data)
    bar = data.bar_radius * data.bar_radius - y * y - z * z
    return clip(low, high, bar, -2 * (y * y_z + z * z_z), -(y_z * y_z + z_z * z_z))


@inline
def _above(low, high, value, per_z):  # type: ignore[no-untyped-def]
    """The part of an interval where a linear function is positive."""
    zero = -value / per_z
    if per_z > 0:
        return max(low, zero), high
    if per_z < 0:
        return low, min(high, zero)
    return (low, high) if value > 0 else (high, low)
