"""The flank contact by law "area", over strips along the lines of contact or over generators of the flank.

    pressure = stiffness * (depth + damping * its rate), never pulling: a bed of springs

as spheres of many samples on planes have it; the line load grows as sqrt(rho) depth^1.5. Strips are those of
`tooth_contact.flank_strip`, of which stations lean as the ends do. On a generator xi = const of the pinion's
flank the point runs along a straight line and the depth is a polynomial of degree 2 in Z (1 without
modifications of the flank), so that its part in contact is an interval with exact ends, whatever the strip's
width: so are integrated the few strips that are too wide for an expansion, and all where generators are asked
for.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, kernel
from rps_exudyn.tooth_contact.contact_tangent import press, slopes_of
from rps_exudyn.tooth_contact.flank_contact import begin_contact, end_side, note_line
from rps_exudyn.tooth_contact.flank_line import (
    DEEPEST,
    LOAD,
    band_of,
    band_on_flank,
    bands,
    begin_side,
    clip,
    first_tooth,
    formed_point,
    line_of,
    note_line_load,
    side_of,
    surplus,
)
from rps_exudyn.tooth_contact.flank_strip import (
    DEPTH,
    LOW_END,
    MARGIN,
    PRESSING,
    across,
    at,
    deepest_crest,
    describe_strip,
    per_roll,
    slanted,
    touching,
    width,
    within_band,
)
from rps_exudyn.tooth_contact.strip_limits import ends_of, watch_limits

COARSE, GENERATORS = 28, 32  # for the few strips that are too wide for an expansion
SHALLOW = 0.9  # a crest less deep than this share of another holds no deeper place
FINE = 200  # where all is integrated along generators
WIDE = 0.25  # relative size of the cubic term at the edges beyond which the expansions are too crude
EDGE_STEPS = 2  # Halley steps from the parabola to the edges of the strip
REACH = 0.35  # contact is sought within this angle of a line's crest [rad]


@kernel
def area_contact(angle, rate, position, rotation, velocity, spin, data, work, factor_q, factor_v):  # type: ignore[no-untyped-def]
    """Fill the wrench of law "area" and its stiffness, as `line_contact` of `flank_contact` does."""
    begin_contact(data.law, work)
    for sign in (-1.0, 1.0):
        side = side_of(sign, angle, rate, position, rotation, velocity, spin, data)
        first, last, turn = first_tooth(angle, side, data)
        begin_side(side, data, work)
        slopes = slopes_of(work, factor_q, factor_v, side, angle, position, data)
        for tooth in range(first, last + 1):
            line = line_of(tooth, turn, side, data)
            before, depth = work.sums[LOAD], 0.0
            for part in range(bands(data)):
                depth = max(depth, _area_in_band(band_of(part, data), line, side, data, work, slopes))
            note_line(before, depth, work)
        end_side(angle, position, side, data, work, slopes)


# --- over strips ------------------------------------------------------------------------------------
@inline
def _area_in_band(band, line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Law "area": add the loads on one line within a band of the flank; the greatest depth."""
    strip, cuts, breaks, band = work.strip, work.cuts, work.breaks, band_on_flank(line, band, data)
    if data.generators > 0:
        return press_area(FINE, data.generators, band, line, side, data, work, slopes)
    low, high = within_band(line, band, data)
    if not low < high:
        return 0.0
    describe_strip(strip, line, band, side, data)
    if is_wide(strip, low, high):
        return press_area(COARSE, GENERATORS, band, line, side, data, work, slopes)
    low, high, low_ends, high_ends = touching(strip, low, high)
    if not low < high:
        return 0.0
    half = greatest_width(strip, low, high)
    ends = ends_of(strip, low, high, half)
    low_ends, high_ends = low_ends and ends.limit_low < 0, high_ends and ends.limit_high < 0
    watched, count, low_ends, high_ends = watch_limits(strip, ends, half, low_ends, high_ends, cuts, breaks)
    if count == 0:
        return 0.0
    for i in range(count - 1):
        z_0, length = breaks[i], breaks[i + 1] - breaks[i]
        rule = int(low_ends and i == 0) + 2 * int(high_ends and i == count - 2)  # where the load fades out
        for k in range(data.stations):
            z = z_0 + length * data.along[rule, 0, k]
            weight = length * data.along[rule, 1, k] / data.cos_base_helix
            eased = data.ease_along[rule]
            _area_station(strip, z, ends, weight, eased, cuts, watched, line, side, data, work, slopes)
    if deepest_crest(strip, breaks[0], breaks[count - 1]) < SHALLOW * work.sums[DEEPEST]:
        return 0.0
    return _deepest_place(strip, ends, cuts, watched, breaks, count, data)


@inline
def _deepest_place(strip, ends, cuts, watched, breaks, count, data):  # type: ignore[no-untyped-def]
    """The greatest depth of a strip: where its crest is highest, or at an end, or where a limit cuts it."""
    low, high, deepest = breaks[0], breaks[count - 1], 0.0
    for i in range(count + watched + 1):
        if i < count:
            z = breaks[i]
        elif i < count + watched:  # it crosses the crest about half-way between the edges
            z = (cuts[i - count, 2] + cuts[i - count, 3]) / 2
        elif strip[DEPTH, 2] < 0:
            z = -strip[DEPTH, 1] / (2 * strip[DEPTH, 2])
        else:
            break
        if low <= z <= high:
            from_, to, _, c_0, c_1, c_2, _ = _across_station(strip, z, ends, cuts, watched, data)
            xi = min(max(-c_1 / (2 * c_2), from_), to)
            if from_ < to:
                deepest = max(deepest, c_0 + xi * (c_1 + xi * c_2))
    return deepest


@inline
def _across_station(strip, z, ends, cuts, watched, data):  # type: ignore[no-untyped-def]
    """Where the leaning station at Z is pressed, the rule across it, and its depth's coefficients in xi."""
    lean = ends.lean + ends.turn * (z - ends.low)
    c_0, c_1, c_2, c_3 = slanted(strip, PRESSING, z, lean)
    low, high = edges(c_0, c_1, c_2, c_3)
    rule = 3  # the pressure vanishes at both ends
    if data.damping > 0:  # but not where it is the flanks that part
        c_0, c_1, c_2, c_3 = slanted(strip, DEPTH, z, lean)
        from_, to = edges(c_0, c_1, c_2, c_3)
        if from_ > low:
            low, rule = from_, rule & 2
        if to < high:
            high, rule = to, rule & 1
    for i in range(watched):
        if cuts[i, 0] <= z <= cuts[i, 1]:
            xi, rise = bound(strip, int(cuts[i, 4]), z, lean)
            if rise > 0 and xi > low:
                low, rule = xi, rule & 2
            elif rise < 0 and xi < high:
                high, rule = xi, rule & 1
    return low, high, rule, c_0, c_1, c_2, c_3


@inline
def _area_station(strip, z, ends, length, eased, cuts, watched, line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Law "area": add the pressure on the leaning station at Z."""
    low, high, rule, c_0, c_1, c_2, c_3 = _across_station(strip, z, ends, cuts, watched, data)
    if not low < high:
        return
    lean = ends.lean + ends.turn * (z - ends.low)
    scale, before = data.stiffness * length * (high - low), work.sums[LOAD]
    eased *= data.ease_across[rule]
    for k in range(data.points):  # numbers one by one: a view of a rule costs more than its use
        xi = low + (high - low) * data.across[rule, 0, k]
        place = z + lean * xi
        p_r, p_t, q = formed_point(xi, place, strip, line, side, data)
        depth = c_0 + xi * (c_1 + xi * (c_2 * (1 - xi * xi / 12) + xi * c_3))
        area = scale * data.across[rule, 1, k] * q * (1 + ends.turn * xi)
        press(depth, area, eased, p_r, p_t, place, side, data, work, slopes)
    note_line_load((work.sums[LOAD] - before) / length, line.q_0 + line.q_1 * z, work)


@inline
def is_wide(strip, from_, to):  # type: ignore[no-untyped-def]
    """Return whether the strip grows so wide, near the form circle, that the expansions do not hold.

    The half width over the tangent length is largest where the latter is least, at an end.
    """
    c_3, wide = abs(strip[DEPTH, 9]), False
    for z in (from_, to):
        d_0, _, d_2 = across(strip, DEPTH, z)
        d_2 += per_roll(strip) * min(at(strip, LOW_END, z), 0.0)  # q is not less than at the band's low end
        wide = wide or c_3 * c_3 * d_0 > -WIDE * WIDE * d_2 * d_2 * d_2
    return wide


@inline
def greatest_width(strip, from_, to):  # type: ignore[no-untyped-def]
    """How far the strip reaches from xi = 0 at its ends or in its middle, whichever is farthest, with some
    margin: relief and slope move its crest away from there."""
    reach = 0.0
    for z in (from_, (from_ + to) / 2, to):
        middle, square, _ = width(strip, z)
        if square > 0:
            reach = max(reach, abs(middle) + np.sqrt(square))
    return min(1.2 * reach, MARGIN)


@inline
def edges(c_0, c_1, c_2, c_3):  # type: ignore[no-untyped-def]
    """Return where c_0 + c_1 xi + c_2 xi^2 + c_3 xi^3 > 0, about its crest: (low, high), low > high if
    nowhere."""
    per_c_2 = 1 / c_2
    middle = -c_1 * per_c_2 / 2
    square = middle * middle - c_0 * per_c_2
    if not (c_2 < 0 and square > 0):
        return 1.0, -1.0
    half, cubic = np.sqrt(square), c_3 * per_c_2
    return _edge(middle - half, middle, cubic, square), _edge(middle + half, middle, cubic, square)


@inline
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


@inline
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


# --- over generators --------------------------------------------------------------------------------
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
