"""Stations on the lines of contact where teeth that bend together may press on each other.

All lines of both sides are taken as far as their flanks overlap by more than -BEYOND of the deepest overlap.
On each stand as many stations, at Gauss points between the ends that form and tip circle, the rack's tips,
the bar's surface and the faces give the line. A line on which sliding turns about is taken in two pieces.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, kernel, placed, stacked
from rps_exudyn.gears.tooth_stiffness import FLATTENED
from rps_exudyn.tooth_contact.flank_line import (
    FlankZone,
    affine,
    band_of,
    band_on_flank,
    bands,
    first_tooth,
    formed_point,
    is_measured,
    is_plain,
    line_of,
    plain_ends,
    plain_point,
    turning_end,
    turning_of,
)
from rps_exudyn.tooth_contact.flank_strip import (
    MARGIN,
    STRIP_SHAPE,
    crest_of,
    crest_with,
    deepest_crest,
    within_band,
)
from rps_exudyn.tooth_contact.measured_flank import deviation_across, measured_band
from rps_exudyn.tooth_contact.strip_limits import ends_with_margin, raise_strip
from rps_exudyn.tooth_contact.teeth_data import BY_HALF, BY_OFFSET, OFFSET, PER_COS, PHI, THICK, ZETA
from rps_exudyn.tooth_contact.tooth_compliance import MODES, PLACE, PLACE_SIZE, fill_mode, fill_rack_place

BEYOND = 0.5  # of the deepest overlap: flanks apart by less may meet as their teeth bend

# What the stations are, one row per property, one column per station. ROLL: the tangent length q
DEPTH, RATE, LENGTH, TOP, P_R, P_T, P_Z, ROLL = 0, 1, 2, 3, 4, 5, 6, 7
STATION_SIZE = 8


class Lines(NamedTuple):
    """Lines of contact and their stations, as many on each; room for more lines than there are."""

    side: np.ndarray  # -1 drive, +1 coast; shape (lines,)
    tooth: np.ndarray  # of the pinion
    rack_tooth: np.ndarray
    deepest: np.ndarray  # greatest overlap [m]
    length: np.ndarray  # [m]
    end: np.ndarray  # whether a piece ends or begins where sliding turns about, see `turning_end`
    turning: np.ndarray  # (5, lines), the numbers of that place, see `flank_line.Turning`
    stations: np.ndarray  # (STATION_SIZE, stations)
    on_pinion: np.ndarray  # (PLACE_SIZE, stations)
    on_rack: np.ndarray  # (PLACE_SIZE, stations)


LINE_SIZE = 11  # numbers of a line
COLUMN = STATION_SIZE + 2 * PLACE_SIZE  # numbers of a station


def most_lines(flank: np.void) -> int:
    """Return how many lines `find_lines` may find on a gear, by its record of flanks."""
    reach = flank["base_radius"] * (flank["half_face"] * abs(flank["twist"]) + MARGIN)
    along = (flank["q_tip"] - flank["q_form"] + 2 * reach) / flank["base_radius"]
    of_side = int(along / (2 * np.pi / flank["teeth"])) + 1
    pieces = (2 if flank["relief"] > 0 else 1) * (2 if flank["breaks_sliding"] else 1)
    return 2 * of_side * pieces


def room_of_lines(lines: int, stations: int) -> int:
    """Return how much room `find_lines` takes for that many lines, in numbers."""
    return lines * (LINE_SIZE + COLUMN * stations)


@kernel
def find_lines(angle, drive, coast, data, pool, room):  # type: ignore[no-untyped-def]
    """Return the lines along which flanks may meet, with their stations, in a room for them (n,), and how
    many there are; -1 if there may be more than there is room for."""
    flank, n = data.flank, 0
    most, deepest = _overlap(angle, drive, coast, flank)
    if most > data.most_lines:
        most, n = 0, -1
    total = most * flank.stations
    numbers, columns = placed(room, 0, (LINE_SIZE, most)), placed(room, LINE_SIZE * most, (COLUMN, total))
    lines = Lines(
        numbers[0],
        numbers[1],
        numbers[2],
        numbers[3],
        numbers[4],
        numbers[5],
        numbers[6:],
        columns[:STATION_SIZE],
        columns[STATION_SIZE : STATION_SIZE + PLACE_SIZE],
        columns[STATION_SIZE + PLACE_SIZE :],
    )
    if most == 0:
        return lines, n
    strip, margin, plain = stacked(STRIP_SHAPE), BEYOND * deepest, is_plain(flank)
    for side in (drive, coast):
        first, last, turn = first_tooth(angle, side, flank)
        for tooth in range(first, last + 1):
            line = line_of(tooth, turn, side, flank)
            if plain:
                n += _fill_plain_line(lines, n, margin, tooth, line, side, data)
                continue
            for part in range(bands(flank)):
                band = band_on_flank(line, band_of(part, flank), flank)
                band = measured_band(band, tooth, line, side, flank, pool)
                n += _fill_line(lines, n, strip, margin, band, tooth, line, side, data, pool)
    return lines, n


@inline
def _overlap(angle, drive, coast, flank):  # type: ignore[no-untyped-def]
    """How many lines there may be, none if no flanks overlap, and the deepest overlap."""
    deepest, most = 0.0, 0
    whole = FlankZone(flank.q_form, flank.q_tip, 0.0, 0.0)
    for side in (drive, coast):
        first, last, turn = first_tooth(angle, side, flank)
        for tooth in range(first, last + 1):
            line = line_of(tooth, turn, side, flank)
            low, high = within_band(line, whole, flank)
            if low < high:
                most += bands(flank) * (2 if flank.breaks_sliding else 1)
                deepest = max(deepest, line.d_0 + max(line.d_1 * low, line.d_1 * high))
    # a surplus of the flank reaches deeper than that
    deepest += max(flank.slope * (flank.q_tip - flank.q_form), 0.0) + flank.highest
    return (most if deepest > 0 else 0), deepest


@inline
def _fill_plain_line(lines, n, margin, tooth, line, side, data):  # type: ignore[no-untyped-def]
    """Fill one line of unmodified flanks; how many pieces, 0 where the flanks are apart."""
    flank = data.flank
    low, high = plain_ends(line, margin, side, flank)
    if not low < high:
        return 0
    turning = turning_of(line, side, flank)
    middle, count = _broken_at(low, high, turning), 0
    for from_, to in ((low, middle), (middle, high)):
        if not from_ < to:
            continue
        _note_turning(lines, n + count, from_, to, turning)
        deepest = line.d_0 + max(line.d_1 * from_, line.d_1 * to)
        _name_line(lines, n + count, tooth, line, side, deepest, to - from_, flank)
        for k in range(flank.stations):
            i, z = (n + count) * flank.stations + k, from_ + (to - from_) * flank.along[0, 0, k]
            lines.stations[LENGTH, i] = (to - from_) * flank.along[0, 1, k] / flank.cos_base_helix
            p_r, p_t, q, lines.stations[DEPTH, i] = plain_point(z, line, side, flank)
            _fill_station(lines, i, p_r, p_t, q, z, side, data)
        count += 1
    return count


@inline
def _broken_at(low, high, turning):  # type: ignore[no-untyped-def]
    """Z where sliding turns about between the ends of a line that is to be broken there, else its low end."""
    return turning.z if low < turning.z < high else low


@inline
def _note_turning(lines, n, from_, to, turning):  # type: ignore[no-untyped-def]
    """Fill which end of a piece is the place where sliding turns about, if any."""
    lines.end[n] = turning_end(from_, to, turning)
    for i in range(5):
        lines.turning[i, n] = turning[i]


@inline
def _name_line(lines, n, tooth, line, side, deepest, width, flank):  # type: ignore[no-untyped-def]
    """Fill what all stations of a line, as wide along Z, have in common."""
    lines.side[n], lines.tooth[n] = side.sign, tooth % flank.teeth
    lines.rack_tooth[n], lines.deepest[n] = line.rack_tooth, deepest
    lines.length[n] = width / flank.cos_base_helix


@inline
def _fill_line(lines, n, strip, margin, band, tooth, line, side, data, pool):  # type: ignore[no-untyped-def]
    """Fill one line within a band of modified flanks; how many pieces, 0 where the flanks are apart."""
    flank = data.flank
    margin += flank.highest
    _, _, low, high = ends_with_margin(strip, band, line, side, margin, flank)
    if not low < high:
        return 0
    raise_strip(strip, -margin)
    turning = turning_of(line, side, flank)
    middle, count, measured = _broken_at(low, high, turning), 0, is_measured(flank)
    for from_, to in ((low, middle), (middle, high)):
        if not from_ < to:
            continue
        _note_turning(lines, n + count, from_, to, turning)
        deepest = deepest_crest(strip, from_, to)
        for k in range(flank.stations):
            i, z = (n + count) * flank.stations + k, from_ + (to - from_) * flank.along[0, 0, k]
            xi, depth = crest_of(strip, z)
            along = 0.0
            if measured:
                at = deviation_across(z, tooth, line, side, flank, pool)
                xi, depth = crest_with(strip, z, at[3], at[4], at[5])
                along, deepest = side.sign * (at[0] + xi * (at[1] + xi * at[2])), max(deepest, depth)
            p_r, p_t, q = formed_point(xi, z, strip, line, side, flank)
            p_r, p_t = p_r - along * xi, p_t + along
            lines.stations[LENGTH, i] = (to - from_) * flank.along[0, 1, k] / flank.cos_base_helix
            lines.stations[DEPTH, i] = depth
            _fill_station(lines, i, p_r, p_t, q, z, side, data)
        _name_line(lines, n + count, tooth, line, side, deepest, to - from_, flank)
        count += 1
    return count


@inline
def _fill_station(lines, i, p_r, p_t, q, z, side, data):  # type: ignore[no-untyped-def]
    """Fill what follows from a station's point: its motion, and its places on both teeth."""
    flank, teeth, stations = data.flank, data.teeth, lines.stations
    stations[RATE, i] = affine(side.part, p_r, p_t, z)
    stations[P_R, i], stations[P_T, i], stations[P_Z, i], stations[ROLL, i] = p_r, p_t, z, q

    x, form, pinion = min(max((q - teeth.middle) * teeth.per_half, -1.0), 1.0), teeth.form, teeth.pinion
    zeta, along = polynomial(form, ZETA, x), z * polynomial(form, PER_COS, x)
    for mode in range(MODES):
        phi, offset = polynomial(form, PHI + mode, x), polynomial(form, BY_OFFSET + mode, x)
        at, end = np.exp(along / pinion.length[mode]), polynomial(form, BY_HALF + mode, x)
        fill_mode(lines.on_pinion, i, mode, phi, at, offset, end, zeta, side.sign, pinion)
    lines.on_pinion[PLACE, i] = along + side.sign * polynomial(form, OFFSET, x)

    y_rack, z_rack = affine(side.y, p_r, p_t, z), affine(side.z, p_r, p_t, z)
    height = -y_rack - teeth.reference_depth  # above the rack's reference line, towards the tips
    half_width = teeth.rack_half_thickness - height * teeth.tan_alpha
    zeta = (height - half_width * teeth.tan_alpha + teeth.rack.root) / teeth.rack.root_width
    chord = np.sqrt(max(flank.bar_radius * flank.bar_radius - y_rack * y_rack, 0.0)) / teeth.cos_rack
    along, offset = z_rack / teeth.cos_rack, half_width * teeth.tan_rack
    fill_rack_place(lines.on_rack, i, zeta, along, offset, chord, teeth.rack_scale, side.sign, teeth.rack)

    # ln(4 h_P h_R / (a^2 / f)) - nu / (1 - nu) with a^2 / f = 4 rho / (pi E*), rho = q / cos(beta_b)
    thickness = max(polynomial(form, THICK, x) * half_width, teeth.thinnest)
    stations[TOP, i] = np.log(thickness * teeth.per_width) - FLATTENED


@inline
def polynomial(coefficients, row, x):  # type: ignore[no-untyped-def]
    """Return the value of a polynomial, the highest power first."""
    value = coefficients[row, 0]
    for k in range(1, coefficients.shape[1]):
        value = value * x + coefficients[row, k]
    return value
