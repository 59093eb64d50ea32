"""The limits that end a strip of contact or cut its corners off, and where to break the integration there.

Lines across the strip, Z = zeta + g(zeta) xi, lean as the limits at its ends do, and between them lean in
proportion; so most strips are a plain rectangle in (zeta, xi), to be integrated in one piece.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline
from rps_exudyn.tooth_contact.flank_strip import (
    BAR,
    DEPTH,
    HIGH_END,
    PRESSING,
    across,
    at,
    describe_strip,
    slanted,
    touching,
    width,
    within_band,
)

LIMITS = 7  # one for each of the six rows, but two for the bar, which ends the line on both sides
BREAKS = 3 + 2 * LIMITS + LIMITS * (LIMITS - 1) // 2
SHORT = 0.006  # fraction of the strip's length that is no segment of its own
CRUDE = 0.3  # relative size of a nonlinear term at a cut, beyond which its breaks are only hints
LEANING = 0.5  # change of the lean between the ends, over the length: at most (the strip must not fold)
FAR = 1.0  # a limit that crosses the line farther away is parallel to it [m]


@inline
def _row_of(limit):  # type: ignore[no-untyped-def]
    """The row in the strip of one of the `LIMITS`."""
    return min(HIGH_END + limit, BAR)


class Ends(NamedTuple):
    """The ends of a strip on its line xi = 0, how it leans there, and the limits that end it."""

    low: float
    high: float
    lean: float  # dZ/dxi at the low end
    turn: float  # change of the lean per length
    limit_low: int  # -1: none, the face or the depth ends the strip
    limit_high: int


@inline
def raise_strip(strip, by):  # type: ignore[no-untyped-def]
    """Deepen a strip evenly [m]."""
    strip[DEPTH, 0] += by
    strip[PRESSING, 0] += by


@inline
def ends_with_margin(strip, band, line, side, margin, data):  # type: ignore[no-untyped-def]
    """Describe a line's strip, `margin` deeper than it is, and return between which Z it is pressed, and
    between which of these the limits leave it; all 0 if nowhere."""
    low, high = within_band(line, band, data)
    if not low < high:
        return 0.0, 0.0, 0.0, 0.0
    describe_strip(strip, line, band, side, data)
    raise_strip(strip, margin)
    low, high, _, _ = touching(strip, low, high)
    if not low < high:
        return 0.0, 0.0, 0.0, 0.0
    ends = ends_of(strip, low, high, 0.0)
    return low, high, ends.low, ends.high


@inline
def ends_of(strip, from_, to, half):  # type: ignore[no-untyped-def]
    """The limits that cut the line, as far as stations can lean like them; `half` width of the strip.

    A limit cuts at Z = Z_c + g xi + k xi^2; the load, a parabola across, sees the mean of xi^2, a fifth of
    the half width's square.
    Where the ends lean too differently for their distance, stations stand upright and all limits are watched.
    """
    low, high, lean_low, lean_high, limit_low, limit_high = from_, to, 0.0, 0.0, -1, -1
    for i in range(LIMITS):
        row = _row_of(i)
        if min(at(strip, row, from_), at(strip, row, to)) >= 0:  # nearly linear or, the bar's, concave
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


@inline
def watch_limits(strip, ends, half, low_ends, high_ends, cuts, breaks):  # type: ignore[no-untyped-def]
    """Find between which zeta other limits cut the strip, and where to break the integration along it.

    Fills `cuts`, a row each: zeta between which to watch a limit, the two zeta where it meets the edges,
    first that of the lower edge, and the limit's row in the strip; and `breaks`: the ends and, ascending
    between them, where a cut begins or is over, or two meet. Returns how many cuts and breaks there are, and
    which ends are the strip's own.
    """
    low, high, watched = ends.low, ends.high, 0
    for i in range(LIMITS):
        row = _row_of(i)
        if i == ends.limit_low or i == ends.limit_high or not _reaches(strip, row, ends, half):
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
        middle, reach = _narrow(cut, strip, z_c, nearest, g, bend)
        if rise > 0 and middle - 1.05 * reach > low:
            low, low_ends = middle - 1.05 * reach, False
        elif rise < 0 and middle + 1.05 * reach < high:
            high, high_ends = middle + 1.05 * reach, False
    if not low < high:
        return 0, 0, False, False
    return watched, _sort_breaks(cuts, watched, low, high, breaks), low_ends, high_ends


@inline
def _reaches(strip, row, ends, half):  # type: ignore[no-untyped-def]
    """Return whether a limit comes into the strip, as far as its values and slopes at the ends show."""
    at_low, slope_low, _, _ = slanted(strip, row, ends.low, ends.lean)
    lean_high = ends.lean + ends.turn * (ends.high - ends.low)
    at_high, slope_high, _, _ = slanted(strip, row, ends.high, lean_high)
    return not min(at_low, at_high) >= half * max(abs(slope_low), abs(slope_high))


@inline
def _narrow(cut, strip, z_c, nearest, g, bend):  # type: ignore[no-untyped-def]
    """Narrow a cut to where the limit crosses the strip; the cut's middle and half length.

    A limit crosses the crest at Z_c with the slope g = d zeta/dxi against the stations, and the edges are
    xi^2 = a + b (zeta - Z_c); so they meet about where (zeta - Z_c)^2 - g^2 b (zeta - Z_c) - g^2 a = 0. The
    load per length has a continuous slope there: the breaks need not be exact. Where a linear picture of
    the strip would be too crude, they are only hints, the limit is watched everywhere, and the length is nan.
    """
    crest_at, a, b = width(strip, nearest)
    z_c += g * crest_at
    a += b * (z_c - nearest)
    square = g * g * (g * g * b * b / 4 + a)
    if not square > 0:
        return z_c, np.nan
    middle, half_cut = z_c + g * g * b / 2 + bend * a, np.sqrt(square)
    cut[2], cut[3] = middle - np.copysign(half_cut, g), middle + np.copysign(half_cut, g)
    half_xi = half_cut / abs(g)
    tapered = abs(b) * half_cut / a if a > 0 else np.inf
    bent = abs(bend) * half_xi / abs(g)
    lopsided = abs(strip[PRESSING, 9] / (strip[PRESSING, 6] + z_c * strip[PRESSING, 7])) * half_xi
    if not max(tapered, bent, lopsided) < CRUDE:
        return middle, np.nan
    reach = half_cut + abs(bend) * a
    cut[0], cut[1] = middle - 1.3 * reach, middle + 1.3 * reach
    return middle, reach


@inline
def _sort_breaks(cuts, watched, low, high, breaks):  # type: ignore[no-untyped-def]
    """Fill `breaks` between the ends with where cuts begin, are over, or meet; how many there are."""
    breaks[0], breaks[1] = low, high
    count = 2
    for i in range(watched):
        count = insert_break(cuts[i, 2], breaks, count)
        count = insert_break(cuts[i, 3], breaks, count)
        for j in range(i):
            count = insert_break(_corner(cuts, i, j), breaks, count)
    return count


@inline
def crossing(strip, row, z):  # type: ignore[no-untyped-def]
    """Return, for a limit that is zero on the line at Z, its slope along the line, and g, k of Z + g xi + k
    xi^2."""
    rise, mixed = strip[row, 1] + 2 * z * strip[row, 2], strip[row, 4] + 2 * z * strip[row, 5]
    _, per_xi, per_xi_2 = across(strip, row, z)
    g = -per_xi / rise
    return rise, g, -(per_xi_2 + g * (mixed + g * strip[row, 2])) / rise


@inline
def insert_break(z, breaks, count):  # type: ignore[no-untyped-def]
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


@inline
def _corner(cuts, i, j):  # type: ignore[no-untyped-def]
    """Z where two limits meet within the strip, both taken as straight there; nan if they do not."""
    step_i, step_j = cuts[i, 3] - cuts[i, 2], cuts[j, 3] - cuts[j, 2]
    up = (cuts[i, 2] - cuts[j, 2]) / (step_j - step_i)
    return cuts[i, 2] + up * step_i if 0 < up < 1 else np.nan


@inline
def _root(strip, row, limit):  # type: ignore[no-untyped-def]
    """Z where a limit crosses the line xi = 0."""
    if strip[row, 2] == 0:
        return -strip[row, 0] / strip[row, 1]
    half = strip[row, 1] / 2
    root = np.sqrt(half * half - strip[row, 2] * strip[row, 0])
    if row != BAR:  # all but straight
        return -strip[row, 0] / (half + np.copysign(root, half))
    return (-half - root if limit == LIMITS - 1 else -half + root) / strip[row, 2]
