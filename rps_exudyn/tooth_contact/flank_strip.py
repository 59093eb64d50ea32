"""The strip of contact along one line: its depth and its limits, all polynomials in (Z, xi).

      xi ^   edges: the depth falls to zero
         |       ________________________
         |      /   /    |    |   \\   \\  |
       --+-----/---/-----|----|----\\---\\-|---> Z     crest: xi of the greatest depth, ~ 0
         |    /___/______|____|_____\\___\\|
          end: a limit                   end: another, and a corner cut off by a third

A strip is an array of shape (9, 10): a row for each polynomial, in it the coefficients of 1, Z, Z^2,
xi, xi Z, xi Z^2, xi^2, xi^2 Z, xi^2 Z^2, xi^3. The limits are positive on the permitted side.
"""

import numpy as np

from rps_exudyn.base.compiled import inline

DEPTH = 0
PRESSING = 1  # depth + damping * its rate
HIGH_END, LOW_END = 2, 3  # of the band of tangent lengths: tip and form circle, or where relief begins
RACK_TIP, FACE_LOW, FACE_HIGH, BAR = 4, 5, 6, 7  # the rack's tips, pinion's faces, bar's round surface
SURPLUS = 8  # of the pinion's flank along the transverse tangent
STRIP_SHAPE = (9, 10)

MARGIN = 0.15  # half width of a strip at most [rad]


@inline
def describe_strip(strip, line, band, side, data):  # type: ignore[no-untyped-def]
    """Fill the polynomials of one line within a band of the flank."""
    s, rb, n_p, n_z = side.sign, data.base_radius, side.n_p, side.n_z
    q_0, q_1, relief = line.q_0, line.q_1, band.relief
    strip[:] = 0.0

    # N_p (s r_b xi^3 / 3 - q* xi^2 / 2) on the crest's depth; the surplus of the flank at q = q* - s r_b xi
    u = q_0 - band.relief_from
    surplus_0 = data.slope * (q_0 - data.q_form) - relief * u * u
    surplus_1 = q_1 * (data.slope - 2 * relief * u)
    surplus_2 = -data.crowning - relief * q_1 * q_1
    surplus_3 = s * rb * (2 * relief * u - data.slope)
    surplus_4 = s * rb * 2 * relief * q_1
    depth = strip[DEPTH]
    depth[0], depth[1], depth[2] = line.d_0 + n_p * surplus_0, line.d_1 + n_p * surplus_1, n_p * surplus_2
    depth[3] = n_p * surplus_3
    depth[4] = n_p * surplus_4
    depth[6] = -n_p * (q_0 / 2 + relief * rb * rb + surplus_0 / 2)
    depth[7] = -n_p * (q_1 / 2 + surplus_1 / 2)
    depth[8] = -n_p * surplus_2 / 2
    depth[9] = n_p * s * rb / 3
    if side.bend != 0.0:  # the rack's curvature, that of the band's middle
        sharper = 1.0 / (1.0 - s * side.bend * (band.low + band.high) / 2)
        for i in range(6, 10):
            depth[i] *= sharper
    surplus = strip[SURPLUS]
    surplus[0], surplus[1], surplus[2], surplus[3] = surplus_0, surplus_1, surplus_2, surplus_3
    surplus[4], surplus[6] = surplus_4, -relief * rb * rb

    # its rate is N . v with v = v_centre + w x P, P = P* - w xi e_r + (r_b e_r - w e_t) xi^2 / 2, w = s q*
    pressing, d, n_t = strip[PRESSING], data.damping, -s * n_p
    w_r, w_t, w_z = side.spin
    on_r, on_t = n_t * w_z - n_z * w_t, n_z * w_r
    for i in range(depth.size):
        pressing[i] = depth[i]
    pressing[0] += d * (n_t * side.velocity[1] + n_z * side.velocity[2] + on_r * rb + on_t * s * q_0)
    pressing[1] += d * (on_t * s * q_1 - n_t * w_r)
    pressing[3] -= d * on_r * s * q_0
    pressing[4] -= d * on_r * s * q_1
    pressing[6] += d * (on_r * rb - on_t * s * q_0) / 2
    pressing[7] -= d * on_t * s * q_1 / 2

    high, low, tip, bar = strip[HIGH_END], strip[LOW_END], strip[RACK_TIP], strip[BAR]
    high[0], high[1], high[3] = band.high - q_0, -q_1, s * rb
    low[0], low[1], low[3] = q_0 - band.low, q_1, -s * rb

    face_low, face_high = strip[FACE_LOW], strip[FACE_HIGH]
    face_low[0], face_low[1], face_high[0], face_high[1] = data.half_face, 1.0, data.half_face, -1.0

    # the rack's own y and z: the same expansion of P
    y_0, y_1, y_3, y_4, y_6, y_7 = _along_strip(side.y, q_0, q_1, s, rb)
    z_0, z_1, z_3, z_4, z_6, z_7 = _along_strip(side.z, q_0, q_1, s, rb)
    tip[0], tip[1], tip[3], tip[4], tip[6], tip[7] = y_0 + data.tip_depth, y_1, y_3, y_4, y_6, y_7
    if data.crowning > 0 or data.slope != 0 or relief > 0:  # P moves along e_t by the flank's surplus
        y_t, z_t = s * side.y[2], s * side.z[2]
        # relief by its chord: the parabola, far below the band, would put the tips anywhere
        chord = relief * (band.high - band.low)
        tip[0] += y_t * (data.slope * (q_0 - data.q_form) - chord * u)
        tip[1] += y_t * (data.slope - chord) * q_1
        tip[2] = -y_t * data.crowning
        tip[3] -= y_t * (data.slope - chord) * s * rb
        # at the bar's ends crowning is that of their Z, relief that of the band's middle
        middle = (band.high - band.low) / 2
        surplus_0 = data.slope * (q_0 - data.q_form) - relief * middle * middle
        surplus_0 -= data.crowning * min(data.half_face**2, data.bar_radius**2 - y_0 * y_0)
        y_0, y_1, y_3 = y_0 + y_t * surplus_0, y_1 + y_t * data.slope * q_1, y_3 - y_t * data.slope * s * rb
        z_0, z_1, z_3 = z_0 + z_t * surplus_0, z_1 + z_t * data.slope * q_1, z_3 - z_t * data.slope * s * rb
    bar[0] = data.bar_radius**2 - y_0 * y_0 - z_0 * z_0
    bar[1] = -2 * (y_0 * y_1 + z_0 * z_1)
    bar[2] = -(y_1 * y_1 + z_1 * z_1)
    bar[3] = -2 * (y_0 * y_3 + z_0 * z_3)
    bar[4] = -2 * (y_0 * y_4 + y_1 * y_3 + z_0 * z_4 + z_1 * z_3)
    bar[5] = -2 * (y_1 * y_4 + z_1 * z_4)
    bar[6] = -(y_3 * y_3 + z_3 * z_3) - 2 * (y_0 * y_6 + z_0 * z_6)
    bar[7] = -2 * (y_3 * y_4 + z_3 * z_4 + y_0 * y_7 + y_1 * y_6 + z_0 * z_7 + z_1 * z_6)
    bar[8] = -(y_4 * y_4 + z_4 * z_4) - 2 * (y_1 * y_7 + z_1 * z_7)


@inline
def _along_strip(coefficients, q_0, q_1, s, rb):  # type: ignore[no-untyped-def]
    """Coefficients of 1, Z, xi, xi Z, xi^2, xi^2 Z in one of the rack's coordinates."""
    c, c_r, c_t, c_z = coefficients
    return (
        c + c_r * rb + c_t * s * q_0,
        c_z + c_t * s * q_1,
        -c_r * s * q_0,
        -c_r * s * q_1,
        (c_r * rb - c_t * s * q_0) / 2,
        -c_t * s * q_1 / 2,
    )


@inline
def across(strip, row, z):  # type: ignore[no-untyped-def]
    """Coefficients of 1, xi, xi^2 at Z in one of the polynomials."""
    return (
        strip[row, 0] + z * (strip[row, 1] + z * strip[row, 2]),
        strip[row, 3] + z * (strip[row, 4] + z * strip[row, 5]),
        strip[row, 6] + z * (strip[row, 7] + z * strip[row, 8]),
    )


@inline
def at(strip, row, z):  # type: ignore[no-untyped-def]
    """One of the polynomials on the line xi = 0."""
    return strip[row, 0] + z * (strip[row, 1] + z * strip[row, 2])


@inline
def slanted(strip, row, z, g):  # type: ignore[no-untyped-def]
    """Coefficients of 1, xi, xi^2, xi^3 on the leaning station Z + g xi."""
    c_0, c_1, c_2 = across(strip, row, z)
    d_1, d_2 = strip[row, 4] + 2 * z * strip[row, 5], strip[row, 7] + 2 * z * strip[row, 8]
    return (
        c_0,
        c_1 + g * (strip[row, 1] + 2 * z * strip[row, 2]),
        c_2 + g * (d_1 + g * strip[row, 2]),
        strip[row, 9] + g * (d_2 + g * strip[row, 5]),
    )


# --- along the line --------------------------------------------------------------------------------
@inline
def crest(strip, z):  # type: ignore[no-untyped-def]
    """Greatest pressing at Z.

    Beyond the band's low end q is taken to stay what it is there: near the base circle the strip has no
    crest, and what a sloping flank adds to its depth, over q, would have no bound.
    """
    c_0, c_1, c_2 = across(strip, PRESSING, z)
    c_2 += per_roll(strip) * min(at(strip, LOW_END, z), 0.0)
    return c_0 - c_1 * c_1 / (4 * c_2) if c_2 < 0 else c_0


@inline
def per_roll(strip):  # type: ignore[no-untyped-def]
    """Half of N_p, by which the depth's curvature across the strip falls with q."""
    return 1.5 * abs(strip[DEPTH, 9]) / abs(strip[LOW_END, 3])


@inline
def within_band(line, band, data):  # type: ignore[no-untyped-def]
    """The Z of the face where a strip can reach the band."""
    reach = MARGIN * data.base_radius
    z_0 = (band.low - reach - line.q_0) / line.q_1
    z_1 = (band.high + reach - line.q_0) / line.q_1
    b = data.half_face
    return max(min(z_0, z_1), -b), min(max(z_0, z_1), b)


@inline
def touching(strip, from_, to):  # type: ignore[no-untyped-def]
    """Return where between two Z the crest is pressed: (low, high, low ends by itself, high does so).

    The crest's depth is linear in Z without modifications of the flank, else very nearly quadratic.
    """
    centre, b = (to + from_) / 2, (to - from_) / 2
    at_low, middle, at_high = crest(strip, from_), crest(strip, centre), crest(strip, to)
    slope, bend = (at_high - at_low) / 2, (at_high + at_low) / 2 - middle
    square = slope * slope - 4 * bend * middle
    if square < 0:
        return (from_, to, False, False) if middle > 0 else (to, from_, False, False)
    q = -(slope + np.copysign(np.sqrt(square), slope)) / 2
    low, high = -1.0, 1.0
    for root in (middle / q, q / bend if bend < 0 else np.nan):  # the crest never bends up but by rounding
        rise = slope + 2 * bend * root
        if rise > 0:
            low = max(low, root)
        elif rise < 0:
            high = min(high, root)
    if low < high and not middle + (slope + bend * (low + high) / 2) * (low + high) / 2 > 0:
        return to, from_, False, False  # pressed nowhere, as where the crest is level below zero
    return centre + low * b, centre + high * b, low > -1.0, high < 1.0


@inline
def width(strip, z):  # type: ignore[no-untyped-def]
    """xi of the crest, square of the half width and its slope along Z; without the term in xi^3."""
    c_0, c_1, c_2 = across(strip, PRESSING, z)
    d_0 = strip[PRESSING, 1] + 2 * z * strip[PRESSING, 2]
    middle, square = -c_1 / (2 * c_2), -c_0 / c_2
    return middle, square + middle * middle, -(d_0 + square * strip[PRESSING, 7]) / c_2


# --- across the strip ------------------------------------------------------------------------------
@inline
def crest_of(strip, z):  # type: ignore[no-untyped-def]
    """xi of the strip's crest at Z, and the depth there."""
    return crest_with(strip, z, 0.0, 0.0, 0.0)


@inline
def crest_with(strip, z, d_0, d_1, d_2):  # type: ignore[no-untyped-def]
    """The same where d_0 + d_1 xi + d_2 xi^2 adds to the depth."""
    c_0, c_1, c_2 = across(strip, DEPTH, z)
    c_0, c_1, c_2 = c_0 + d_0, c_1 + d_1, c_2 + d_2
    xi = min(max(-c_1 / (2 * c_2), -MARGIN), MARGIN) if c_2 < 0 else 0.0
    return xi, c_0 + xi * (c_1 + xi * c_2)


@inline
def deepest_crest(strip, low, high):  # type: ignore[no-untyped-def]
    """The greatest depth of the crest, which is linear along Z, or with modifications nearly a parabola."""
    deepest = max(crest_of(strip, low)[1], crest_of(strip, high)[1])
    if strip[DEPTH, 2] < 0:
        z = min(max(-strip[DEPTH, 1] / (2 * strip[DEPTH, 2]), low), high)
        deepest = max(deepest, crest_of(strip, z)[1])
    return deepest
