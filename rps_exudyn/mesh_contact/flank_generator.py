"""The flank contact on single generators, exact: its limits and the loads between them.

On a generator xi = const of the pinion's flank the point runs along a straight line and the depth is a
polynomial of degree 2 in Z (1 without modifications of the flank), so that its part in contact is an
interval with exact ends; that holds for strips of any width.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, kernel
from rps_exudyn.mesh_contact.contact_tangent import press
from rps_exudyn.mesh_contact.flank_line import surplus

REACH = 0.35  # contact is sought within this angle of a line's crest [rad]


@kernel
def press_area(coarse, generators, band, line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add the loads of one line's area within a band of the flank: midpoint rule across the generators.

    Corners of the area make kinks, so that the error falls with the square of the number of generators.
    The area is found on `coarse` of them. Returns the greatest depth.
    """
    step = 2 * REACH / coarse
    low, high = REACH, -REACH
    for i in range(coarse + 1):
        xi = -REACH + i * step
        z_0, z_1 = interval(xi, band, line, side, data)
        if z_0 < z_1:
            low, high = min(low, xi), max(high, xi)
    if low > high:  # narrower than a step: it is at the crest or nowhere
        low = high = 0.0
    low, high = _last(low, -step, band, line, side, data), _last(high, step, band, line, side, data)
    width, deepest = (high - low) / generators, 0.0
    for i in range(generators):
        depth = _press_generator(low + (i + 0.5) * width, width, band, line, side, data, work, slopes)
        deepest = max(deepest, depth)
    return deepest


@inline
def _last(xi, step, band, line, side, data):  # type: ignore[no-untyped-def]
    """The last generator in contact between xi and xi + step, by bisection."""
    for _ in range(24):
        step /= 2
        z_0, z_1 = interval(xi + step, band, line, side, data)
        if z_0 < z_1:
            xi += step
    return xi


@inline
def _on_generator(xi, line, side, data):  # type: ignore[no-untyped-def]
    """(P_r, P_t, q) at Z = 0 and their slopes, of the perfect flank."""
    s, rb = side.sign, data.base_radius
    cos, sin = np.cos(xi), np.sin(xi)
    q = line.q_0 - s * rb * xi
    dq = line.q_1
    return rb * cos - s * q * sin, rb * sin + s * q * cos, q, -s * dq * sin, s * dq * cos, dq


@inline
def _depth(xi, band, line, side, data):  # type: ignore[no-untyped-def]
    """Coefficients of 1, Z, Z^2."""
    s, rb, n_p = side.sign, data.base_radius, side.n_p
    _, _, q, _, _, dq = _on_generator(xi, line, side, data)
    cos = np.cos(xi)
    # d_0 = c + N_p q*(0), so that c + N_p (s r_b (sin xi - xi cos xi) + q* cos xi) is
    at_middle = line.d_0 + n_p * (s * rb * (np.sin(xi) - xi * cos) - line.q_0 * 2 * np.sin(xi / 2) ** 2)
    slope = line.d_1 - n_p * line.q_1 * 2 * np.sin(xi / 2) ** 2
    u = q - band.relief_from
    at_middle += n_p * cos * (data.slope * (q - data.q_form) - band.relief * u * u)
    slope += n_p * cos * (data.slope * dq - 2 * band.relief * u * dq)
    return at_middle, slope, -n_p * cos * (data.crowning + band.relief * dq * dq)


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
def _on_axis(coefficients, p_r, p_t, d_r, d_t):  # type: ignore[no-untyped-def]
    """One of the rack's coordinates on a generator, at Z = 0, and its slope."""
    c, c_r, c_t, c_z = coefficients
    return c + c_r * p_r + c_t * p_t, c_r * d_r + c_t * d_t + c_z


@inline
def interval(xi, band, line, side, data):  # type: ignore[no-untyped-def]
    """The Z between which a generator is in contact."""
    p_r, p_t, q, d_r, d_t, dq = _on_generator(xi, line, side, data)
    low, high = clip(-data.half_face, data.half_face, band.high - q, -dq, 0.0)
    low, high = clip(low, high, q - band.low, dq, 0.0)
    y, dy = _on_axis(side.y, p_r, p_t, d_r, d_t)
    z, dz = _on_axis(side.z, p_r, p_t, d_r, d_t)
    # the surplus of the flank moves points along e_t: at the tips that of where they end the perfect flank,
    y_t, z_t = side.sign * side.y[2], side.sign * side.z[2]
    at_tips = min(max(-(y + data.tip_depth) / dy, -data.half_face), data.half_face)
    at_tips_grown = surplus(q + dq * at_tips, at_tips * at_tips, band, data)
    low, high = clip(low, high, y + data.tip_depth + y_t * at_tips_grown, dy, 0.0)
    # at the bar's ends crowning is that of their Z, relief that of the band's middle
    middle, bar = (band.high - band.low) / 2, data.bar_radius**2
    grown = data.slope * (q - data.q_form) - band.relief * middle * middle
    grown -= data.crowning * min(data.half_face**2, bar - y * y)
    y, dy, z, dz = (
        y + y_t * grown,
        dy + y_t * data.slope * dq,
        z + z_t * grown,
        dz + z_t * data.slope * dq,
    )
    low, high = clip(low, high, bar - y * y - z * z, -2 * (y * dy + z * dz), -dy * dy - dz * dz)
    c_0, c_1, c_2 = _depth(xi, band, line, side, data)
    low, high = clip(low, high, c_0, c_1, c_2)
    if data.damping > 0:
        r_0 = _approach(p_r, p_t, 0.0, side)
        r_1 = _approach(p_r + d_r, p_t + d_t, 1.0, side) - r_0
        low, high = clip(low, high, c_0 + data.damping * r_0, c_1 + data.damping * r_1, c_2)
    return low, high


@inline
def _approach(p_r, p_t, z, side):  # type: ignore[no-untyped-def]
    """Rate of the depth at a point."""
    w_r, w_t, w_z = side.spin
    v_t = side.velocity[1] + w_z * p_r - w_r * z
    v_z = side.velocity[2] + w_r * p_t - w_t * p_r
    return -side.sign * side.n_p * v_t + side.n_z * v_z


@inline
def _press_generator(xi, width, band, line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add the loads on a generator that stands for a strip of the given width [rad]; the greatest depth."""
    low, high = interval(xi, band, line, side, data)
    if not low < high:
        return 0.0
    p_r, p_t, q, d_r, d_t, dq = _on_generator(xi, line, side, data)
    c_0, c_1, c_2 = _depth(xi, band, line, side, data)
    cos, sin = np.cos(xi), np.sin(xi)
    for k in range(data.stations):
        z = low + (high - low) * data.along[0, 0, k]
        depth = c_0 + z * (c_1 + z * c_2)
        area = (q + z * dq) * width * (high - low) * data.along[0, 1, k] / data.cos_base_helix
        along = side.sign * surplus(q + z * dq, z * z, band, data)
        at_r, at_t = p_r + z * d_r - along * sin, p_t + z * d_t + along * cos
        press(depth, data.stiffness * area, 1.0, at_r, at_t, z, side, data, work, slopes)
    deepest = max(c_0 + low * (c_1 + low * c_2), c_0 + high * (c_1 + high * c_2))
    crest = -c_1 / (2 * c_2) if c_2 < 0 else low
    return max(deepest, c_0 + crest * (c_1 + crest * c_2)) if low < crest < high else deepest
