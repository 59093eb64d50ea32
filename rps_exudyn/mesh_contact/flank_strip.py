"""The strip of contact along one line: its depth and its limits, all polynomials in (Z, xi).

      xi ^   edges: the depth falls to zero
         |       ________________________
         |      /   /    |    |   \\   \\  |
       --+-----/---/-----|----|----\\---\\-|---> Z     crest: xi of the greatest depth, ~ 0
         |    /___/______|____|_____\\___\\|
          end: a limit                   end: another, and a corner cut off by a third

A strip is an array of shape (8, 10): a row for each polynomial, in it the coefficients of 1, Z, Z^2,
xi, xi Z, xi Z^2, xi^2, xi^2 Z, xi^2 Z^2, xi^3. The limits are positive on the permitted side.

Lines across the strip, Z = zeta + g(zeta) xi, lean as the limits at its ends do, and between them lean in
proportion; so most strips are a plain rectangle in (zeta, xi), to be integrated in one piece.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inlined

DEPTH = 0
PRESSING = 1  # depth + damping * its rate
HIGH_END, LOW_END = 2, 3  # of the band of tangent lengths: tip and form circle, or where relief begins
RACK_TIP, FACE_LOW, FACE_HIGH, BAR = 4, 5, 6, 7  # the rack's tips, pinion's faces, bar's round surface
STRIP_SHAPE = (8, 10)

MARGIN = 0.15  # half width of a strip at most [rad]
WIDE = 0.25  # share of the cubic term at the edges beyond which the expansions are too crude
LIMITS = 7  # one for each of the six rows, but two for the bar, which ends the line on both sides
BREAKS = 2 + 2 * LIMITS + LIMITS * (LIMITS - 1) // 2
SHORT = 0.006  # share of the strip's length that is no segment of its own
CRUDE = 0.3  # share of a nonlinear term at a cut, beyond which its breaks are only hints
LEANING = 0.5  # change of the lean between the ends, over the length: at most (the strip must not fold)
EDGE_STEPS = 2  # Halley steps from the parabola to the edges of the strip
FAR = 1.0  # a limit that crosses the line farther away is parallel to it [m]


@inlined
def describe_strip(strip, line, band, side, data):  # type: ignore[no-untyped-def]
    """Fill the polynomials of one line within a band of the flank."""
    s, rb, n_p, n_z = side.sign, data.base_radius, side.n_p, side.n_z
    q_0, q_1, relief = line.q_0, line.q_1, band.relief
    strip[:] = 0.0

    # N_p (s r_b xi^3 / 3 - q* xi^2 / 2) on the crest's depth; the surplus of the flank at q = q* - s r_b xi
    u = q_0 - band.relief_from
    surplus_0 = n_p * (data.slope * (q_0 - data.q_form) - relief * u * u)
    surplus_1 = n_p * q_1 * (data.slope - 2 * relief * u)
    surplus_2 = -n_p * (data.crowning + relief * q_1 * q_1)
    depth = strip[DEPTH]
    depth[0], depth[1], depth[2] = line.d_0 + surplus_0, line.d_1 + surplus_1, surplus_2
    depth[3] = n_p * s * rb * (2 * relief * u - data.slope)
    depth[4] = n_p * s * rb * 2 * relief * q_1
    depth[6] = -n_p * (q_0 / 2 + relief * rb * rb) - surplus_0 / 2
    depth[7] = -n_p * q_1 / 2 - surplus_1 / 2
    depth[8] = -surplus_2 / 2
    depth[9] = n_p * s * rb / 3

    # its rate is N . v with v = v_centre + w x P, P = P* - w xi e_r + (r_b e_r - w e_t) xi^2 / 2, w = s q*
    pressing, d, n_t = strip[PRESSING], data.damping, -s * n_p
    w_r, w_t, w_z = side.spin
    on_r, on_t = n_t * w_z - n_z * w_t, n_z * w_r
    pressing[:] = depth
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
    bar[0] = data.bar_radius**2 - y_0 * y_0 - z_0 * z_0
    bar[1] = -2 * (y_0 * y_1 + z_0 * z_1)
    bar[2] = -(y_1 * y_1 + z_1 * z_1)
    bar[3] = -2 * (y_0 * y_3 + z_0 * z_3)
    bar[4] = -2 * (y_0 * y_4 + y_1 * y_3 + z_0 * z_4 + z_1 * z_3)
    bar[5] = -2 * (y_1 * y_4 + z_1 * z_4)
    bar[6] = -(y_3 * y_3 + z_3 * z_3) - 2 * (y_0 * y_6 + z_0 * z_6)
    bar[7] = -2 * (y_3 * y_4 + z_3 * z_4 + y_0 * y_7 + y_1 * y_6 + z_0 * z_7 + z_1 * z_6)
    bar[8] = -(y_4 * y_4 + z_4 * z_4) - 2 * (y_1 * y_7 + z_1 * z_7)


@inlined
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


@inlined
def across(strip, row, z):  # type: ignore[no-untyped-def]
    """Coefficients of 1, xi, xi^2 at Z in one of the polynomials."""
    return (
        strip[row, 0] + z * (strip[row, 1] + z * strip[row, 2]),
        strip[row, 3] + z * (strip[row, 4] + z * strip[row, 5]),
        strip[row, 6] + z * (strip[row, 7] + z * strip[row, 8]),
    )


@inlined
def at(strip, row, z):  # type: ignore[no-untyped-def]
    """One of the polynomials on the line xi = 0."""
    return strip[row, 0] + z * (strip[row, 1] + z * strip[row, 2])


@inlined
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
@inlined
def crest(strip, z):  # type: ignore[no-untyped-def]
    """Greatest pressing at Z."""
    c_0, c_1, c_2 = across(strip, PRESSING, z)
    return c_0 - c_1 * c_1 / (4 * c_2) if c_2 < 0 else c_0


@inlined
def is_wide(strip, from_, to):  # type: ignore[no-untyped-def]
    """Does the strip grow so wide, near the form circle, that the expansions do not hold?

    The half width over the tangent length is largest where the latter is least, at an end.
    """
    c_3 = abs(strip[DEPTH, 9])
    half_n_p = 1.5 * c_3 / abs(strip[LOW_END, 3])
    wide = False
    for z in (from_, to):
        d_0, _, d_2 = across(strip, DEPTH, z)
        d_2 += half_n_p * min(across(strip, LOW_END, z)[0], 0.0)  # q is not less than at the band's low end
        wide = wide or c_3 * c_3 * d_0 > -WIDE * WIDE * d_2 * d_2 * d_2
    return wide


@inlined
def within_band(line, band, data):  # type: ignore[no-untyped-def]
    """The Z of the face where a strip can reach the band."""
    reach = MARGIN * data.base_radius
    z_0 = (band.low - reach - line.q_0) / line.q_1
    z_1 = (band.high + reach - line.q_0) / line.q_1
    b = data.half_face
    return max(min(z_0, z_1), -b), min(max(z_0, z_1), b)


@inlined
def touching(strip, from_, to):  # type: ignore[no-untyped-def]
    """Where between two Z the crest is pressed: (low, high, low ends by itself, high does so).

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
    return centre + low * b, centre + high * b, low > -1.0, high < 1.0


@inlined
def greatest_width(strip, from_, to):  # type: ignore[no-untyped-def]
    """Half width of the strip at its ends or in its middle, whichever is greatest, with some margin."""
    _, at_low, _ = width(strip, from_)
    _, middle, _ = width(strip, (from_ + to) / 2)
    _, at_high, _ = width(strip, to)
    return min(1.2 * np.sqrt(max(at_low, middle, at_high, 0.0)), MARGIN)


@inlined
def width(strip, z):  # type: ignore[no-untyped-def]
    """xi of the crest, square of the half width and its slope along Z; without the term in xi^3."""
    c_0, c_1, c_2 = across(strip, PRESSING, z)
    d_0 = strip[PRESSING, 1] + 2 * z * strip[PRESSING, 2]
    middle, square = -c_1 / (2 * c_2), -c_0 / c_2
    return middle, square + middle * middle, -(d_0 + square * strip[PRESSING, 7]) / c_2


class Ends(NamedTuple):
    """Where a strip begins and ends on its line xi = 0, how it leans there, and which limits do it."""

    low: float
    high: float
    lean: float  # dZ/dxi at the low end
    turn: float  # change of the lean per length
    limit_low: int  # -1: none, the face or the depth ends the strip
    limit_high: int


@inlined
def ends_of(strip, from_, to, half):  # type: ignore[no-untyped-def]
    """The limits that cut the line, as far as stations can lean like them; `half` width of the strip.

    A limit cuts at Z = Z_c + g xi + k xi^2; the load, a parabola across, sees the mean of xi^2, a fifth of
    the half width's square.
    Where the ends lean too differently for their distance, stations stand upright and all limits are watched.
    """
    low, high, lean_low, lean_high, limit_low, limit_high = from_, to, 0.0, 0.0, -1, -1
    for i in range(LIMITS):
        row = min(HIGH_END + i, BAR)
        if min(at(strip, row, from_), at(strip, row, to)) >= 0:  # linear or, the bar's, concave
            continue
        z_c = _root(strip, row, i)
        if not abs(z_c) < FAR:
            continue
        rise, g, k = crossing(strip, row, z_c)
        if k != 0 and half > 0:
            z_c += k * max(width(strip, z_c)[1], 0.0) / 5
        if rise > 0 and z_c > low:
            low, lean_low, limit_low = z_c, g, i
        elif rise < 0 and z_c < high:
            high, lean_high, limit_high = z_c, g, i
    if half == 0:
        lean_low = lean_high = 0.0
    elif not abs(lean_high - lean_low) * half < LEANING * (high - low):
        return Ends(from_, to, 0.0, 0.0, -1, -1)
    return Ends(low, high, lean_low, (lean_high - lean_low) / (high - low), limit_low, limit_high)


@inlined
def watch_limits(strip, ends, half, low_ends, high_ends, cuts, breaks):  # type: ignore[no-untyped-def]
    """Between which zeta other limits cut the strip, and where to break the integration along it.

    A limit crosses the crest at Z_c with the slope g = d zeta/dxi against the stations, and the edges are
    xi^2 = a + b (zeta - Z_c); so they meet about where (zeta - Z_c)^2 - g^2 b (zeta - Z_c) - g^2 a = 0. The
    load per length has a continuous slope there: the breaks need not be exact. Where a linear picture of
    the strip would be too crude, they are only hints, and the limit is watched everywhere.

    Fills `cuts`, a row each: zeta between which to watch a limit, those two zeta, first that of the lower
    edge, and the limit's row in the strip; and `breaks`: the ends and, ascending between them, where a cut
    begins or is over, or two meet. Returns how many cuts and breaks there are, and which ends are the
    strip's own.
    """
    low, high = ends.low, ends.high
    lean_high = ends.lean + ends.turn * (high - low)
    watched = 0
    for i in range(LIMITS):
        row = min(HIGH_END + i, BAR)
        if i == ends.limit_low or i == ends.limit_high:
            continue
        at_low, slope_low, _, _ = slanted(strip, row, ends.low, ends.lean)
        at_high, slope_high, _, _ = slanted(strip, row, ends.high, lean_high)
        if min(at_low, at_high) >= half * max(abs(slope_low), abs(slope_high)):
            continue
        z_c = _root(strip, row, i)
        crosses = abs(z_c) < FAR
        rise, g, bend = crossing(strip, row, z_c)
        nearest = min(max(z_c, ends.low), ends.high)
        g -= ends.lean + ends.turn * (nearest - ends.low)
        inward = np.copysign(1.0, rise)
        reach = inward * z_c + half * (abs(g) + half * max(inward * bend, 0.0))
        if crosses and reach <= (ends.low if rise > 0 else -ends.high):
            continue  # beyond the end
        cut = cuts[watched]
        third = (ends.high - ends.low) / 3  # of use where it only grazes the strip somewhere
        cut[0], cut[1], cut[2], cut[3], cut[4] = ends.low, ends.high, ends.low + third, ends.high - third, row
        watched += 1
        if not crosses:
            continue
        crest_at, a, b = width(strip, nearest)
        z_c += g * crest_at
        a += b * (z_c - nearest)
        square = g * g * (g * g * b * b / 4 + a)
        if not square > 0:
            continue
        middle, half_cut = z_c + g * g * b / 2 + bend * a, np.sqrt(square)
        cut[2], cut[3] = middle - np.copysign(half_cut, g), middle + np.copysign(half_cut, g)
        half_xi = half_cut / abs(g)
        tapered = abs(b) * half_cut / a if a > 0 else np.inf
        bent = abs(bend) * half_xi / abs(g)
        lopsided = abs(strip[PRESSING, 9] / (strip[PRESSING, 6] + z_c * strip[PRESSING, 7])) * half_xi
        if not max(tapered, bent, lopsided) < CRUDE:
            continue
        reach = half_cut + abs(bend) * a
        cut[0], cut[1] = middle - 1.3 * reach, middle + 1.3 * reach
        if rise > 0 and middle - 1.05 * reach > low:
            low, low_ends = middle - 1.05 * reach, False
        elif rise < 0 and middle + 1.05 * reach < high:
            high, high_ends = middle + 1.05 * reach, False
    if not low < high:
        return 0, 0, False, False
    breaks[0], breaks[1] = low, high
    count = 2
    for i in range(watched):
        count = _insert(cuts[i, 2], breaks, count)
        count = _insert(cuts[i, 3], breaks, count)
        for j in range(i):
            count = _insert(_corner(cuts, i, j), breaks, count)
    return watched, count, low_ends, high_ends


@inlined
def crossing(strip, row, z):  # type: ignore[no-untyped-def]
    """Of a limit that is zero on the line at Z: its slope along the line, and g, k of Z + g xi + k xi^2."""
    rise, mixed = strip[row, 1] + 2 * z * strip[row, 2], strip[row, 4] + 2 * z * strip[row, 5]
    _, per_xi, per_xi_2 = across(strip, row, z)
    g = -per_xi / rise
    return rise, g, -(per_xi_2 + g * (mixed + g * strip[row, 2])) / rise


@inlined
def _insert(z, breaks, count):  # type: ignore[no-untyped-def]
    """Sort z into `breaks` if it lies between the ends and not too close to another; the new count."""
    near = SHORT * (breaks[count - 1] - breaks[0])
    if not breaks[0] + near < z < breaks[count - 1] - near:
        return count
    k = count - 1
    while breaks[k - 1] > z:
        k -= 1
    if min(z - breaks[k - 1], breaks[k] - z) < near:
        return count
    for i in range(count, k, -1):
        breaks[i] = breaks[i - 1]
    breaks[k] = z
    return count + 1


@inlined
def _corner(cuts, i, j):  # type: ignore[no-untyped-def]
    """Z where two limits meet within the strip, both taken as straight there; nan if they do not."""
    step_i, step_j = cuts[i, 3] - cuts[i, 2], cuts[j, 3] - cuts[j, 2]
    up = (cuts[i, 2] - cuts[j, 2]) / (step_j - step_i)
    return cuts[i, 2] + up * step_i if 0 < up < 1 else np.nan


@inlined
def _root(strip, row, limit):  # type: ignore[no-untyped-def]
    """Z where a limit crosses the line xi = 0."""
    if strip[row, 2] == 0:
        return -strip[row, 0] / strip[row, 1]
    half = strip[row, 1] / 2
    root = np.sqrt(half * half - strip[row, 2] * strip[row, 0])
    return (-half - root if limit == LIMITS - 1 else -half + root) / strip[row, 2]


# --- across the strip ------------------------------------------------------------------------------
@inlined
def edges(c_0, c_1, c_2, c_3):  # type: ignore[no-untyped-def]
    """Where c_0 + c_1 xi + c_2 xi^2 + c_3 xi^3 > 0, about its crest: (low, high), low > high if nowhere."""
    per_c_2 = 1 / c_2
    middle = -c_1 * per_c_2 / 2
    square = middle * middle - c_0 * per_c_2
    if not (c_2 < 0 and square > 0):
        return 1.0, -1.0
    half, cubic = np.sqrt(square), c_3 * per_c_2
    return _edge(middle - half, middle, cubic, square), _edge(middle + half, middle, cubic, square)


@inlined
def _edge(xi, middle, cubic, square):  # type: ignore[no-untyped-def]
    """A root of (xi - middle)^2 + cubic xi^3 = square from the parabola's.

    The cubic is a tenth of it: a step by Halley's rule leaves 1e-4 of the width, another 1e-9.
    """
    for _ in range(EDGE_STEPS):
        from_middle, bend = xi - middle, cubic * xi
        value = from_middle * from_middle - square + bend * xi * xi
        slope, half_curve = 2 * from_middle + 3 * bend * xi, 1 + 3 * bend
        xi -= value * slope / (slope * slope - value * half_curve)
    return xi


@inlined
def bound(strip, row, z, g):  # type: ignore[no-untyped-def]
    """xi where a limit cuts across a station, and its slope there: positive, then the strip remains above.

    Followed from the crest or, where that is not in the band, from the band's low end.
    """
    l_0, l_1, l_2, _ = slanted(strip, row, z, g)
    inside, per_xi, _, _ = slanted(strip, LOW_END, z, g)
    start = -inside / per_xi if inside < 0 else 0.0
    l_0 += start * (l_1 + start * l_2)
    l_1 += 2 * start * l_2
    square = l_1 * l_1 - 4 * l_0 * l_2
    if square < 0:  # nowhere
        return np.copysign(np.inf, -l_0 * l_1), l_1
    return start - 2 * l_0 / (l_1 + np.copysign(np.sqrt(square), l_1)), l_1
