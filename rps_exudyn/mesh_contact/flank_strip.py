"""The strip of contact along one line: its depth and its limits, all polynomials in (Z, xi).

      xi ^   edges: the depth falls to zero
         |       ________________________
         |      /|                      |\\
       --+-----/-|----------------------|-\\---> Z     crest: xi of the greatest depth, ~ 0
         |    /__|______________________|__\\
          cut by a limit                 cut by another

A strip is an array of shape (6, 10): a row for each polynomial, in it the coefficients of 1, Z, Z^2,
xi, xi Z, xi Z^2, xi^2, xi^2 Z, xi^2 Z^2, xi^3. The limits are positive on the permitted side.
"""

import numpy as np

from rps_exudyn.compiled import inlined
from rps_exudyn.mesh_contact.flank_data import (
    BAR_RADIUS,
    BASE_RADIUS,
    CROWNING,
    DAMPING,
    HALF_FACE,
    Q_FORM,
    SLOPE,
    TIP_DEPTH,
)

DEPTH = 0
PRESSING = 1  # depth + damping * its rate
HIGH_END, LOW_END = 2, 3  # of the band of tangent lengths: tip and form circle, or where relief begins
RACK_TIP, BAR = 4, 5  # the rack's tips, the bar's round surface
STRIP_SHAPE = (6, 10)

MARGIN = 0.15  # half width of a strip at most [rad]
WIDE = 0.25  # share of the cubic term at the edges beyond which the expansions are too crude
LIMITS = 5  # one for each of the four rows, but two for the bar, which ends the line on both sides
BREAKS = 2 + 2 * LIMITS + LIMITS * (LIMITS - 1) // 2
NO_CUT = (1.0, -1.0, np.nan, np.nan)
SHORT = 0.006  # share of the strip's length that is no segment of its own
CRUDE = 0.3  # share of a nonlinear term at a cut, beyond which its breaks are only hints
FAR = 1.0  # a limit that crosses the line farther away is parallel to it [m]


@inlined
def describe_strip(strip, line, band, side, data):  # type: ignore[no-untyped-def]
    """Fill the six polynomials of one line within a band of the flank."""
    s, rb, n_p, n_z = side.sign, data[BASE_RADIUS], side.n_p, side.n_z
    q_0, q_1, relief = line.q_0, line.q_1, band.relief
    strip[:] = 0.0

    # N_p (s r_b xi^3 / 3 - q* xi^2 / 2) on the crest's depth; the surplus of the flank at q = q* - s r_b xi
    u = q_0 - band.relief_from
    surplus_0 = n_p * (data[SLOPE] * (q_0 - data[Q_FORM]) - relief * u * u)
    surplus_1 = n_p * q_1 * (data[SLOPE] - 2 * relief * u)
    surplus_2 = -n_p * (data[CROWNING] + relief * q_1 * q_1)
    depth = strip[DEPTH]
    depth[0], depth[1], depth[2] = line.d_0 + surplus_0, line.d_1 + surplus_1, surplus_2
    depth[3] = n_p * s * rb * (2 * relief * u - data[SLOPE])
    depth[4] = n_p * s * rb * 2 * relief * q_1
    depth[6] = -n_p * (q_0 / 2 + relief * rb * rb) - surplus_0 / 2
    depth[7] = -n_p * q_1 / 2 - surplus_1 / 2
    depth[8] = -surplus_2 / 2
    depth[9] = n_p * s * rb / 3

    # its rate is N . v with v = v_centre + w x P, P = P* - w xi e_r + (r_b e_r - w e_t) xi^2 / 2, w = s q*
    pressing, d, n_t = strip[PRESSING], data[DAMPING], -s * n_p
    on_r, on_t = n_t * side.w_z - n_z * side.w_t, n_z * side.w_r
    pressing[:] = depth
    pressing[0] += d * (n_t * side.v_t + n_z * side.v_z + on_r * rb + on_t * s * q_0)
    pressing[1] += d * (on_t * s * q_1 - n_t * side.w_r)
    pressing[3] -= d * on_r * s * q_0
    pressing[4] -= d * on_r * s * q_1
    pressing[6] += d * (on_r * rb - on_t * s * q_0) / 2
    pressing[7] -= d * on_t * s * q_1 / 2

    high, low, tip, bar = strip[HIGH_END], strip[LOW_END], strip[RACK_TIP], strip[BAR]
    high[0], high[1], high[3] = band.high - q_0, -q_1, s * rb
    low[0], low[1], low[3] = q_0 - band.low, q_1, -s * rb

    # the rack's own y and z: the same expansion of P
    y_0, y_1 = side.y_0 + side.y_r * rb + side.y_t * s * q_0, side.y_z + side.y_t * s * q_1
    y_3, y_4 = -side.y_r * s * q_0, -side.y_r * s * q_1
    y_6, y_7 = (side.y_r * rb - side.y_t * s * q_0) / 2, -side.y_t * s * q_1 / 2
    z_0, z_1 = side.z_0 + side.z_r * rb + side.z_t * s * q_0, side.z_z + side.z_t * s * q_1
    z_3, z_4 = -side.z_r * s * q_0, -side.z_r * s * q_1
    z_6, z_7 = (side.z_r * rb - side.z_t * s * q_0) / 2, -side.z_t * s * q_1 / 2
    tip[0], tip[1], tip[3], tip[4], tip[6], tip[7] = y_0 + data[TIP_DEPTH], y_1, y_3, y_4, y_6, y_7
    bar[0] = data[BAR_RADIUS] ** 2 - y_0 * y_0 - z_0 * z_0
    bar[1] = -2 * (y_0 * y_1 + z_0 * z_1)
    bar[2] = -(y_1 * y_1 + z_1 * z_1)
    bar[3] = -2 * (y_0 * y_3 + z_0 * z_3)
    bar[4] = -2 * (y_0 * y_4 + y_1 * y_3 + z_0 * z_4 + z_1 * z_3)
    bar[5] = -2 * (y_1 * y_4 + z_1 * z_4)
    bar[6] = -(y_3 * y_3 + z_3 * z_3) - 2 * (y_0 * y_6 + z_0 * z_6)
    bar[7] = -2 * (y_3 * y_4 + z_3 * z_4 + y_0 * y_7 + y_1 * y_6 + z_0 * z_7 + z_1 * z_6)
    bar[8] = -(y_4 * y_4 + z_4 * z_4) - 2 * (y_1 * y_7 + z_1 * z_7)


@inlined
def across(strip, row, z):  # type: ignore[no-untyped-def]
    """Coefficients of 1, xi, xi^2 at Z in one of the polynomials."""
    return (
        strip[row, 0] + z * (strip[row, 1] + z * strip[row, 2]),
        strip[row, 3] + z * (strip[row, 4] + z * strip[row, 5]),
        strip[row, 6] + z * (strip[row, 7] + z * strip[row, 8]),
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
    reach = MARGIN * data[BASE_RADIUS]
    z_0 = (band.low - reach - line.q_0) / line.q_1
    z_1 = (band.high + reach - line.q_0) / line.q_1
    b = data[HALF_FACE]
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
def width(strip, z):  # type: ignore[no-untyped-def]
    """xi of the crest, square of the half width and its slope along Z; without the term in xi^3."""
    c_0, c_1, c_2 = across(strip, PRESSING, z)
    d_0 = strip[PRESSING, 1] + 2 * z * strip[PRESSING, 2]
    middle, square = -c_1 / (2 * c_2), -c_0 / c_2
    return middle, square + middle * middle, -(d_0 + square * strip[PRESSING, 7]) / c_2


@inlined
def apply_limits(strip, low, high, low_ends, high_ends, by_line, cuts, breaks):  # type: ignore[no-untyped-def]
    """Between which Z each limit cuts the strip, and where to break the integration along Z.

    A limit crosses the crest at Z_c with the slope g = dZ/dxi, and the edges are xi^2 = a + b (Z - Z_c); so
    they meet about where (Z - Z_c)^2 - g^2 b (Z - Z_c) - g^2 a = 0. The load per length has a continuous
    slope there: the breaks need not be exact. Where a linear picture of the strip would be too crude, they
    are only hints, and the limit is watched everywhere.

    Fills `cuts`, shape (5, 4): Z between which to watch a limit, and those two Z, first that of the lower
    edge; and `breaks`: the ends and, ascending between them, where a cut begins or is over, or two meet. By
    line, the strip is its crest. Returns how many breaks there are, and which ends are the strip's own.
    """
    from_, to = low, high
    for i in range(LIMITS):
        row = min(HIGH_END + i, BAR)
        cuts[i] = NO_CUT
        at_low, slope_low, _ = across(strip, row, from_)
        at_high, slope_high, _ = across(strip, row, to)
        reach = 0.0 if by_line else MARGIN * max(abs(slope_low), abs(slope_high))
        if min(at_low, at_high) > reach:  # far inside: a limit is linear in Z or, the bar's, concave
            continue
        cuts[i, 0], cuts[i, 1] = from_, to
        z_c = _root(strip, row, i)
        if not abs(z_c) < FAR:
            continue
        rise = strip[row, 1] + 2 * z_c * strip[row, 2]
        g = -(strip[row, 3] + z_c * (strip[row, 4] + z_c * strip[row, 5])) / rise
        nearest = min(max(z_c, from_), to)
        crest_at, a, b = (0.0, 0.0, 0.0) if by_line else width(strip, nearest)
        z_c += g * crest_at
        a += b * (z_c - nearest)
        square = g * g * (g * g * b * b / 4 + a)
        if square < 0:
            continue
        middle, half = z_c + g * g * b / 2, np.sqrt(square)
        cuts[i, 2], cuts[i, 3] = middle - np.copysign(half, g), middle + np.copysign(half, g)
        half_xi = half / abs(g)
        tapered = abs(b) * half / a if a > 0 else np.inf
        bent = abs(strip[row, 6] + z_c * strip[row, 7]) * half_xi / abs(g * rise)
        lopsided = abs(strip[PRESSING, 9] / (strip[PRESSING, 6] + z_c * strip[PRESSING, 7])) * half_xi
        if not max(tapered, bent, lopsided) < CRUDE:
            continue
        cuts[i, 0], cuts[i, 1] = middle - 1.3 * half, middle + 1.3 * half
        if rise > 0 and middle - 1.05 * half > low:
            low, low_ends = middle - 1.05 * half, False
        elif rise < 0 and middle + 1.05 * half < high:
            high, high_ends = middle + 1.05 * half, False
    if not low < high:
        return 0, False, False
    breaks[0], breaks[1] = low, high
    count = 2
    for i in range(LIMITS):
        count = _insert(cuts[i, 2], breaks, count)
        count = _insert(cuts[i, 3], breaks, count)
        for j in range(i):
            count = _insert(_corner(cuts, i, j), breaks, count)
    return count, low_ends, high_ends


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
    middle = -c_1 / (2 * c_2)
    square = middle * middle - c_0 / c_2
    if not (c_2 < 0 and square > 0):
        return 1.0, -1.0
    half = np.sqrt(square)
    low, high = middle - half, middle + half
    for _ in range(2):  # the cubic is a tenth of it: one step leaves 1e-3, two 1e-6
        low -= (c_0 + low * (c_1 + low * (c_2 + low * c_3))) / (c_1 + low * (2 * c_2 + 3 * low * c_3))
        high -= (c_0 + high * (c_1 + high * (c_2 + high * c_3))) / (c_1 + high * (2 * c_2 + 3 * high * c_3))
    return low, high


@inlined
def bound(strip, row, z):  # type: ignore[no-untyped-def]
    """xi where a limit cuts across at Z, and its slope there: positive, then the strip remains above.

    Followed from the crest or, where that is not in the band, from the band's low end.
    """
    l_0, l_1, l_2 = across(strip, row, z)
    inside, per_xi, _ = across(strip, LOW_END, z)
    start = -inside / per_xi if inside < 0 else 0.0
    l_0 += start * (l_1 + start * l_2)
    l_1 += 2 * start * l_2
    square = l_1 * l_1 - 4 * l_0 * l_2
    if square < 0:  # nowhere
        return np.copysign(np.inf, -l_0 * l_1), l_1
    return start - 2 * l_0 / (l_1 + np.copysign(np.sqrt(square), l_1)), l_1
