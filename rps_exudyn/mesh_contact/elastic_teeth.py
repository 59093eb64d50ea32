"""Contact of flanks whose teeth bend together: law "teeth".

All lines of contact of both sides stand under one system of equations (`unilateral`): a station yields by
the loads on all stations of its two teeth (`tooth_compliance`), by its own line's Hertzian flattening, and
by the torsion of the pinion's core. Drive and coast flank bend the same tooth against each other; most of
that bending cancels, which laws without it miss.

    stations: Gauss points along each line, between the ends that form and tip circle, the rack's tips, the
    bar's surface and the faces give it, where the flanks are apart by at most BEYOND of the deepest overlap
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inlined, kernel
from rps_exudyn.gears.basic_rack import half_angle
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_data import FlankData
from rps_exudyn.mesh_contact.flank_line import (
    DAMPING_LOSS,
    DEEPEST,
    ENERGY,
    LINES,
    SUMS,
    Band,
    add_load,
    add_side,
    affine,
    first_tooth,
    line_of,
    note_line_load,
    point,
    side_of,
)
from rps_exudyn.mesh_contact.flank_strip import (
    DEPTH,
    MARGIN,
    PRESSING,
    STRIP_SHAPE,
    across,
    describe_strip,
    touching,
    within_band,
)
from rps_exudyn.mesh_contact.steel import EFFECTIVE_MODULUS, POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.mesh_contact.strip_limits import ends_of
from rps_exudyn.mesh_contact.tooth_compliance import (
    PLACE_SIZE,
    ToothData,
    add_block,
    add_line,
    fill_place,
    pinion_tooth,
    rack_tooth,
)
from rps_exudyn.mesh_contact.unilateral import local_energy, local_yield, press_stations
from rps_exudyn.mesh_contact.wrench import WRENCH_SIZE
from rps_exudyn.parameters.gear import SteeringGear

DEGREE = 7  # of the polynomials: 1e-6 of the values
THINNEST = 1e-3  # of the module: a pointed tooth has no thickness left
GUESS = 20e9  # load per length and depth with which the solution begins [N/m^2]
BEYOND = 0.5  # of the deepest overlap: flanks apart by less may meet as their teeth bend

# What the stations are, one row per property, one column per station
DEPTH_THERE, RATE, LENGTH, TOP, P_R, P_T, P_Z, ROLL = 0, 1, 2, 3, 4, 5, 6, 7  # roll: the tangent length q
STATION_SIZE = 8
FORM_SIZE = 4  # polynomials of `TeethData.form`: cos(alpha), times y, times tan(alpha); h over tangent length


class Lines(NamedTuple):
    """Lines of contact and their stations, `count` on each of them."""

    n: int  # lines
    side: np.ndarray  # -1 drive, +1 coast; shape (n,)
    tooth: np.ndarray  # of the pinion
    rack_tooth: np.ndarray
    stations: np.ndarray  # (STATION_SIZE, stations)
    on_pinion: np.ndarray  # (PLACE_SIZE, stations)
    on_rack: np.ndarray  # (PLACE_SIZE, stations)


class TeethData(NamedTuple):
    """A gear for law "teeth"; SI units."""

    flank: FlankData
    pinion: ToothData
    rack: ToothData
    form: np.ndarray  # polynomials in the tangent length between form and tip circle, (FORM_SIZE, DEGREE + 1)
    middle: float  # of these tangent lengths [m]
    per_half: float  # 1 over half their range [1/m]
    sin_alpha: float  # of the normal pressure angle
    cos_alpha: float
    rack_half_thickness: float  # of its tooth at the reference line, normal section
    reference_depth: float  # the rack's reference line stands at y = -reference_depth
    cos_rack: float  # of the rack's tooth angle
    hertz: float  # K = 2 (1 - nu^2) / (pi E) [m^2/N]
    per_width: float  # pi E* cos(beta_b), E* = E / (2 (1 - nu^2)) [Pa]
    thinnest: float  # thickness of both teeth, squared over the tangent length, taken at least [m]
    poisson_term: float  # nu / (1 - nu)
    torsion: float  # normal yield of a flank by the pinion's torsion under a unit load [m/N]
    guess: float  # load per length and depth to begin with [N/m^2]


@kernel
def teeth_contact(angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """The mesh contact kernel of law "teeth", see `wrench`; `data` from `teeth_data`."""
    out, flank = np.zeros(WRENCH_SIZE), data.flank
    drive = side_of(-1.0, angle, rate, position, rotation, velocity, spin, flank)
    coast = side_of(1.0, angle, rate, position, rotation, velocity, spin, flank)
    lines = find_lines(angle, drive, coast, data)
    count = flank.along.shape[2]
    force, elastic = np.empty(lines.n * count), np.empty(lines.n * count)
    if not solve_loads(lines, data, force, elastic):
        out[:] = np.nan
        return out
    sums, energy = np.empty(SUMS), stored_energy(lines, elastic, data)
    for side in (drive, coast):
        sums[:] = 0.0
        for line in range(lines.n):
            if lines.side[line] == side.sign:
                _add_loads(
                    lines.stations, line * count, (line + 1) * count, force, elastic, side, flank, sums
                )
        sums[ENERGY], energy = energy, 0.0
        add_side(sums, angle, position, side, flank, out)
    return out


@inlined
def _add_loads(stations, start, end, force, elastic, side, flank, sums):  # type: ignore[no-untyped-def]
    """Add the loads of one line."""
    touching_ = False
    for i in range(start, end):
        if force[i] > 0:
            touching_ = True
            add_load(force[i], stations[P_R, i], stations[P_T, i], stations[P_Z, i], side, flank, sums)
            sums[DAMPING_LOSS] += (force[i] - elastic[i]) * stations[RATE, i]
            sums[DEEPEST] = max(sums[DEEPEST], stations[DEPTH_THERE, i])
            note_line_load(force[i] / stations[LENGTH, i], stations[ROLL, i], sums)
    sums[LINES] += touching_


# --- stations --------------------------------------------------------------------------------------
@inlined
def find_lines(angle, drive, coast, data):  # type: ignore[no-untyped-def]
    """Return the lines along which flanks may meet, with their stations."""
    flank = data.flank
    deepest, most, n = 0.0, 0, 0
    for side in (drive, coast):
        first, last, turn = first_tooth(angle, side, flank)
        for tooth in range(first, last + 1):
            line = line_of(tooth, turn, side, flank)
            low, high = within_band(line, Band(flank.q_form, flank.q_tip, 0.0, 0.0), flank)
            if low < high:
                most += 2 if flank.relief > 0 else 1
                deepest = max(deepest, line.d_0 + max(line.d_1 * low, line.d_1 * high))
    if not deepest > 0:
        most = 0
    total = most * flank.along.shape[2]
    signs, teeth, rack_teeth = np.empty(most), np.empty(most), np.empty(most)
    stations = np.empty((STATION_SIZE, total))
    on_pinion, on_rack = np.empty((PLACE_SIZE, total)), np.empty((PLACE_SIZE, total))
    strip = np.empty(STRIP_SHAPE)
    if most > 0:
        for side in (drive, coast):
            first, last, turn = first_tooth(angle, side, flank)
            for tooth in range(first, last + 1):
                line = line_of(tooth, turn, side, flank)
                for part in range(2 if flank.relief > 0 else 1):
                    band = _band(part, flank)
                    low, high = _describe_line(strip, band, line, side, BEYOND * deepest, flank)
                    if low < high:
                        signs[n], teeth[n], rack_teeth[n] = side.sign, tooth % flank.teeth, line.rack_tooth
                        start = n * flank.along.shape[2]
                        _fill_line(
                            strip,
                            low,
                            high,
                            start,
                            BEYOND * deepest,
                            line,
                            side,
                            stations,
                            on_pinion,
                            on_rack,
                            data,
                        )
                        n += 1
    return Lines(n, signs, teeth, rack_teeth, stations, on_pinion, on_rack)


@inlined
def _band(part, flank):  # type: ignore[no-untyped-def]
    """The part of the flank below the tip relief, or that with it."""
    if part == 0:
        return Band(flank.q_form, min(flank.q_tip, flank.relief_start), 0.0, 0.0)
    return Band(flank.relief_start, flank.q_tip, flank.relief, flank.relief_start)


@inlined
def _describe_line(strip, band, line, side, margin, flank):  # type: ignore[no-untyped-def]
    """Describe a line's strip, `margin` deeper than it is, and return between which Z it lies."""
    low, high = within_band(line, band, flank)
    if not low < high:
        return low, high
    describe_strip(strip, line, band, side, flank)
    strip[DEPTH, 0] += margin
    strip[PRESSING, 0] += margin
    low, high, _, _ = touching(strip, low, high)
    if not low < high:
        return low, high
    ends = ends_of(strip, low, high, 0.0)
    return ends.low, ends.high


@inlined
def _fill_line(strip, low, high, start, margin, line, side, stations, on_pinion, on_rack, data):  # type: ignore[no-untyped-def]
    """Fill the stations of one line: their points, and their places on both teeth."""
    flank = data.flank
    tan = data.sin_alpha / data.cos_alpha
    half_face = flank.half_face / flank.cos_base_helix
    for k in range(flank.along.shape[2]):
        i = start + k
        z = low + (high - low) * flank.along[0, 0, k]
        c_0, c_1, c_2 = across(strip, DEPTH, z)
        xi = min(max(-c_1 / (2 * c_2), -MARGIN), MARGIN) if c_2 < 0 else 0.0
        p_r, p_t, q = point(xi, z, line, side, flank)
        stations[DEPTH_THERE, i] = c_0 + xi * (c_1 + xi * c_2) - margin
        stations[RATE, i] = affine(side.part, p_r, p_t, z)
        stations[LENGTH, i] = (high - low) * flank.along[0, 1, k] / flank.cos_base_helix
        stations[P_R, i], stations[P_T, i], stations[P_Z, i], stations[ROLL, i] = p_r, p_t, z, q

        x = min(max((q - data.middle) * data.per_half, -1.0), 1.0)
        cos, cos_y, cos_tan = (
            polynomial(data.form, 0, x),
            polynomial(data.form, 1, x),
            polynomial(data.form, 2, x),
        )
        fill_place(on_pinion, i, cos, cos_y, cos_tan, z / flank.cos_base_helix, half_face, data.pinion)

        y_rack, z_rack = affine(side.y, p_r, p_t, z), affine(side.z, p_r, p_t, z)
        height = -y_rack - data.reference_depth  # above the rack's reference line, towards the tips
        half_width = data.rack_half_thickness - height * tan
        cos_y = data.cos_alpha * (height - half_width * tan + data.rack.root)
        chord = np.sqrt(max(flank.bar_radius * flank.bar_radius - y_rack * y_rack, 0.0)) / data.cos_rack
        fill_place(
            on_rack, i, data.cos_alpha, cos_y, data.sin_alpha, z_rack / data.cos_rack, chord, data.rack
        )

        # ln(4 h_P h_R / (a^2 / f)) - nu / (1 - nu) with a^2 / f = 4 rho / (pi E*), rho = q / cos(beta_b)
        thickness = max(polynomial(data.form, 3, x) * half_width, data.thinnest)
        stations[TOP, i] = np.log(thickness * data.per_width) - data.poisson_term


@inlined
def polynomial(coefficients, row, x):  # type: ignore[no-untyped-def]
    """Return the value of a polynomial, the highest power first."""
    value = coefficients[row, 0]
    for k in range(1, coefficients.shape[1]):
        value = value * x + coefficients[row, k]
    return value


# --- loads -----------------------------------------------------------------------------------------
@inlined
def compliance_matrix(lines, data):  # type: ignore[no-untyped-def]
    """Return the compliance of all stations without the Hertzian part, lower triangle, shape (n, n) [m/N]."""
    nodes, weights = data.flank.along[0, 0], data.flank.along[0, 1]
    count = nodes.size
    matrix = np.empty((lines.n * count, lines.n * count))
    for a in range(lines.n):
        for b in range(a + 1):
            torsion = data.torsion * lines.side[a] * lines.side[b]
            for i in range(a * count, (a + 1) * count):
                for j in range(b * count, (b + 1) * count):
                    matrix[i, j] = torsion
            same_side = lines.side[a] == lines.side[b]
            if a == b:
                add_line(matrix, lines.on_pinion, a * count, nodes, weights, data.pinion)
                add_line(matrix, lines.on_rack, a * count, nodes, weights, data.rack)
                continue
            if lines.tooth[a] == lines.tooth[b]:
                sigma = 1.0 if same_side else -data.pinion.coupling
                add_block(matrix, lines.on_pinion, a * count, b * count, count, sigma, data.pinion)
            if lines.rack_tooth[a] == lines.rack_tooth[b]:
                sigma = 1.0 if same_side else -data.rack.coupling
                add_block(matrix, lines.on_rack, a * count, b * count, count, sigma, data.rack)
    return matrix


@inlined
def solve_loads(lines, data, force, elastic):  # type: ignore[no-untyped-def]
    """Fill the forces of all stations, and those without damping; returns whether they were found."""
    n = force.size
    matrix, damping = compliance_matrix(lines, data), data.flank.damping
    depth, length, top = lines.stations[DEPTH_THERE], lines.stations[LENGTH], lines.stations[TOP]
    found = press_stations(n, matrix, depth, length, top, data.hertz, data.guess, elastic)
    for i in range(n):
        force[i] = elastic[i]
    if found and damping > 0:
        pressing = np.empty(n)
        for i in range(n):
            pressing[i] = depth[i] + damping * lines.stations[RATE, i]
        found = press_stations(n, matrix, pressing, length, top, data.hertz, data.guess, force)
    return found


@inlined
def stored_energy(lines, elastic, data):  # type: ignore[no-untyped-def]
    """Elastic energy of teeth and contact [J]: half of force times bending, and the integral of the rest."""
    energy = 0.0
    for i in range(elastic.size):
        if elastic[i] > 0:
            length, top = lines.stations[LENGTH, i], lines.stations[TOP, i]
            f = elastic[i] / length
            energy += length * local_energy(f, top, data.hertz)
            bending = lines.stations[DEPTH_THERE, i] - local_yield(f, top, data.hertz)[0]
            energy += elastic[i] * bending / 2
    return energy


# --- a gear's data ---------------------------------------------------------------------------------
def teeth_data(gear: SteeringGear, flank: FlankData) -> TeethData:
    """Return the data of law "teeth" for a gear.

    The pinion's core twists as a shaft of its root circle that takes the torque up evenly over the face and
    is held at one end.
    """
    pair = GearPair.of(gear)
    nu, pinion = POISSON_RATIO, pinion_tooth(pair)
    core = np.pi / 2 * pair.root_radius**4 * YOUNGS_MODULUS / (2 * (1 + nu)) / (pair.face_width / 2)
    arm = pair.base_radius * np.cos(pair.beta_b)  # of a normal force about the axis
    middle, half = (flank.q_tip + flank.q_form) / 2, (flank.q_tip - flank.q_form) / 2
    return TeethData(
        flank=flank,
        pinion=pinion,
        rack=rack_tooth(pair),
        form=_form_polynomials(pair, pinion.root, middle, half),
        middle=middle,
        per_half=1 / half,
        sin_alpha=np.sin(pair.alpha_n),
        cos_alpha=np.cos(pair.alpha_n),
        rack_half_thickness=np.pi * pair.module / 4,
        reference_depth=pair.reference_height,
        cos_rack=np.cos(pair.beta_r),
        hertz=2 * (1 - nu**2) / (np.pi * YOUNGS_MODULUS),
        per_width=np.pi * EFFECTIVE_MODULUS * np.cos(pair.beta_b),
        thinnest=THINNEST * pair.module,
        poisson_term=nu / (1 - nu),
        torsion=arm**2 / core,
        guess=GUESS,
    )


def _form_polynomials(pair: GearPair, root: float, middle: float, half: float) -> np.ndarray:
    """Polynomials in the tangent length for `TeethData.form`, through Chebyshev points."""
    x = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    q = middle + half * x
    radius = np.hypot(q, pair.base_radius)
    thick = half_angle(pair, radius)
    tan_x = np.tan(np.arctan(q / pair.base_radius) - thick)  # of the load against the tooth's middle
    tan = tan_x * np.cos(pair.beta_p)
    cos = 1 / np.sqrt(1 + tan**2)
    y = pair.base_radius * np.sqrt(1 + tan_x**2) - root
    h = radius * thick / np.sqrt(1 + (pair.twist * radius) ** 2) / np.cos(pair.alpha_n)
    rows = np.array([cos, cos * y, cos * tan, h / q / np.cos(pair.alpha_n)])
    return np.ascontiguousarray(np.polynomial.polynomial.polyfit(x, rows.T, DEGREE).T[:, ::-1])
