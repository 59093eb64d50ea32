"""Contact of plane rack flanks with involute helicoids, integrated along the lines of contact.

    strip of one line                        stations: Gauss points along the line between breakpoints
      xi ^     ____________________             nodes: Gauss points in xi between the strip's edges
         |    /    /    |     \\    \\        ends: face, a limit (tip, form circle, rack's tips, the bar's
         |   /    /     |      \\    \\             surface), or where the depth falls to zero; stations
       --+--/----/------|-------\\----\\-- Z      lean as the ends do
         | /    /       |        \\  |       breakpoints: where another limit cuts a corner off
         |/____/________|_________\\_|             and, where axes are nearly parallel, where sliding turns

No search is needed for the teeth of both sides: psi* gives q*(Z) of every tooth, and the flank is where
q_form <= q <= q_tip. The law "line": load per length of line = line_stiffness * (depth + damping * its rate)
at the strip's crest, which is what ISO 6336 assumes of teeth.

Friction is Coulomb's with the local sliding velocity, linear in it below the zone speed (as in Exudyn's
GeneralContact). Loads act normal to the rack's plane, at points of the pinion's flank.
"""

from rps_exudyn.base.compiled import inline, kernel
from rps_exudyn.tooth_contact.contact_tangent import (
    add_moved,
    add_patch_tangent,
    add_rubbing,
    add_turn_of_loads,
    clear_patches,
    press,
    slopes_of,
)
from rps_exudyn.tooth_contact.flank_line import (
    DEEPEST,
    LINES,
    LOAD,
    add_side,
    band_of,
    band_on_flank,
    bands,
    begin_side,
    first_tooth,
    formed_point,
    is_measured,
    is_plain,
    line_of,
    note_line_load,
    plain_ends,
    plain_point,
    side_of,
    turning_end,
    turning_of,
)
from rps_exudyn.tooth_contact.flank_strip import (
    crest_of,
    deepest_crest,
    describe_strip,
    touching,
    within_band,
)
from rps_exudyn.tooth_contact.measured_flank import add_deviation, deviation_across, measured_band
from rps_exudyn.tooth_contact.strip_limits import (
    ends_of,
    ends_with_margin,
    insert_break,
    raise_strip,
    watch_limits,
)
from rps_exudyn.tooth_contact.wrench import WRENCH_SIZE


@inline
def begin_contact(law, work):  # type: ignore[no-untyped-def]
    """Empty the sums of an evaluation with a law of friction."""
    if law.has_state:
        clear_patches(work)
    for i in range(WRENCH_SIZE):
        work.wrench[i] = 0.0
    for i in range(6):
        for j in range(6):
            work.stiffness[i, j] = 0.0


@kernel
def line_contact(  # type: ignore[no-untyped-def]
    angle, rate, position, rotation, velocity, spin, data, pool, work, factor_q, factor_v
):
    """Fill the wrench of law "line", see `wrench`, and its stiffness unless both factors are 0, see
    `contact_tangent.Slopes`; `data` is a record `FLANK`, `work` a `SCRATCH`."""
    begin_contact(data.law, work)
    plain = is_plain(data)
    for sign in (-1.0, 1.0):
        side = side_of(sign, angle, rate, position, rotation, velocity, spin, data)
        first, last, turn = first_tooth(angle, side, data)
        begin_side(side, data, work)
        slopes = slopes_of(work, factor_q, factor_v, side, angle, position, data)
        for tooth in range(first, last + 1):
            line = line_of(tooth, turn, side, data)
            before, depth = work.sums[LOAD], 0.0
            if plain:
                depth = _plain_line(line, side, data, work, slopes)
            else:
                for part in range(bands(data)):
                    band = band_on_flank(line, band_of(part, data), data)
                    if is_measured(data):
                        deep = _measured_line(band, tooth, line, side, data, pool, work, slopes)
                    else:
                        deep = _line_in_band(band, line, side, data, work, slopes)
                    depth = max(depth, deep)
            note_line(before, depth, work)
        end_side(angle, position, side, data, work, slopes)


@inline
def note_line(before, depth, work):  # type: ignore[no-untyped-def]
    """Count a line that bears more than the load before it."""
    if work.sums[LOAD] > before:
        work.sums[LINES] += 1
        work.sums[DEEPEST] = max(work.sums[DEEPEST], depth)


@inline
def end_side(angle, position, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add what one side's loads sum up to."""
    add_side(work, angle, position, side, data, work.wrench)
    if slopes.wanted:
        add_turn_of_loads(work, side, slopes)
        if data.law.has_state:
            add_patch_tangent(side, data, work, slopes)
        else:
            add_rubbing(side, data, work, slopes)


@inline
def _plain_line(line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Law "line": add the loads on one line of unmodified flanks; the greatest depth."""
    low, high = plain_ends(line, 0.0, side, data)
    if not low < high:
        return 0.0
    turning, middle = turning_of(line, side, data), low
    if low < turning.z < high:
        middle = turning.z
    for from_, to in ((low, middle), (middle, high)):
        if not from_ < to:
            continue
        end = turning_end(from_, to, turning)
        for k in range(data.stations):
            z = from_ + (to - from_) * data.along[0, 0, k]
            length = (to - from_) * data.along[0, 1, k] / data.cos_base_helix
            p_r, p_t, q, depth = plain_point(z, line, side, data)
            load = _press_line(depth, length, p_r, p_t, q, z, side, data, work, slopes)
            if slopes.wanted and end != 0 and load > 0 and not data.law.has_state:
                add_moved(load, line.d_1 / depth, k, end, p_r, p_t, z, turning, side, data, slopes)
    return max(line.d_0 + line.d_1 * low, line.d_0 + line.d_1 * high)


@inline
def _line_in_band(band, line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Law "line": add the loads on one line within a band of the flank; the greatest depth."""
    low, high = within_band(line, band, data)
    if not low < high:
        return 0.0
    describe_strip(work.strip, line, band, side, data)
    count = _break_within_limits(work.strip, low, high, work)
    return _press_strip(work.strip, count, line, side, data, work, slopes)


@inline
def _measured_line(band, tooth, line, side, data, pool, work, slopes):  # type: ignore[no-untyped-def]
    """The same of measured flanks, piece by piece of the line; the greatest depth.

    The pieces share what the limits leave of the line without the deviations. The outermost reach on to where
    it could be pressed, for the deviations move the limits, by less than a piece.
    """
    strip, piece, deepest = work.strip, work.piece, 0.0
    band = measured_band(band, tooth, line, side, data, pool)
    low, high, from_, to = ends_with_margin(strip, band, line, side, data.highest, data)
    width = (to - from_) / data.pieces
    if not width > 0:
        return 0.0
    raise_strip(strip, -data.highest)
    at_begin = deviation_across(from_, tooth, line, side, data, pool)
    for i in range(data.pieces):
        begin, end = from_ + i * width, from_ + (i + 1) * width
        middle = deviation_across(begin + width / 2, tooth, line, side, data, pool)
        at_end = deviation_across(end, tooth, line, side, data, pool)
        add_deviation(piece, strip, begin, end, at_begin, middle, at_end, line, side, data)
        at_begin = at_end
        if 0 < i < data.pieces - 1:
            count = _break_where_pressed(piece, begin, end, work)
        else:
            begin, end = low if i == 0 else begin, high if i == data.pieces - 1 else end
            count = _break_within_limits(piece, begin, end, work)
        deepest = max(deepest, _press_strip(piece, count, line, side, data, work, slopes))
    return deepest


@inline
def _break_where_pressed(strip, low, high, work):  # type: ignore[no-untyped-def]
    """Fill the breaks with the ends of what is pressed between two Z that no limit cuts; how many."""
    breaks = work.breaks
    breaks[0], breaks[1], _, _ = touching(strip, low, high)
    return 2 if breaks[0] < breaks[1] else 0


@inline
def _break_within_limits(strip, low, high, work):  # type: ignore[no-untyped-def]
    """Fill the breaks where to integrate a strip in parts, between two Z; how many, 0 if nothing is left."""
    low, high, low_ends, high_ends = touching(strip, low, high)
    if not low < high:
        return 0
    ends = ends_of(strip, low, high, 0.0)
    low_ends, high_ends = low_ends and ends.limit_low < 0, high_ends and ends.limit_high < 0
    _, count, _, _ = watch_limits(strip, ends, 0.0, low_ends, high_ends, work.cuts, work.breaks)
    return count


@kernel
def _press_strip(strip, count, line, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Law "line": add the loads on a strip between its breaks; the greatest depth."""
    if count == 0:
        return 0.0
    breaks, turning = work.breaks, turning_of(line, side, data)
    count = insert_break(turning.z, breaks, count)
    for i in range(count - 1):
        z_0, length = breaks[i], breaks[i + 1] - breaks[i]
        end = turning_end(z_0, breaks[i + 1], turning)
        for k in range(data.stations):  # the load fades out linearly, which the plain rule integrates exactly
            z = z_0 + length * data.along[0, 0, k]
            weight = length * data.along[0, 1, k] / data.cos_base_helix
            xi, depth = crest_of(strip, z)
            p_r, p_t, q = formed_point(xi, z, strip, line, side, data)
            load = _press_line(depth, weight, p_r, p_t, q, z, side, data, work, slopes)
            if slopes.wanted and end != 0 and load > 0 and not data.law.has_state:
                growth = (crest_of(strip, turning.z)[1] / depth - 1.0) / (turning.z - z)
                add_moved(load, growth, k, end, p_r, p_t, z, turning, side, data, slopes)
    return deepest_crest(strip, breaks[0], breaks[count - 1])


@inline
def _press_line(depth, length, p_r, p_t, q, z, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Law "line": add the load on a part of the line about a point; return it."""
    if not depth > 0:  # the end of what is pressed is found to a few digits; damping presses nothing apart
        return 0.0
    before = work.sums[LOAD]
    press(depth, data.line_stiffness * length, 1.0, p_r, p_t, z, side, data, work, slopes)
    load = work.sums[LOAD] - before
    note_line_load(load / length, q * (1.0 - side.sign * q * side.bend), work)  # the relative radius
    return load
