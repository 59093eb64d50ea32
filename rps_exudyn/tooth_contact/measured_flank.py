"""Flanks as measured: a grid of deviations normal to the analytic flank, as a surface of cubic B-splines.

On the pinion's flank a place is (q, Z), tangent length and axial place, on the rack's (y, z) in its frame.
Beyond the grid a deviation stays what it is at the edge. Where a line of contact crosses a wave of the grid
the flanks' depth is no parabola along it: the line is taken in pieces (`flank_contact`), in each of which a
quadratic in Z and xi stands for the deviation (`add_deviation`), through the ends and the middle.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, kernel, record_type
from rps_exudyn.gears.flank_grid import MeasuredFlanks
from rps_exudyn.tooth_contact.flank_line import FlankZone, affine
from rps_exudyn.tooth_contact.flank_strip import BAR, DEPTH, PRESSING, RACK_TIP, SURPLUS

GRID = record_type(
    [
        ("is_given", "i8"),
        ("first", "i8"),  # place of the first coefficient in the pool
        ("per_tooth", "i8"),  # numbers from tooth to tooth; 0: all teeth are alike ...
        ("teeth", "i8"),  # ... and how many teeth there are
        ("middle", "i8"),  # place of tooth 0 among them
        ("per_side", "i8"),  # numbers from the drive to the coast flank
        ("columns", "i8"),  # coefficients along the second coordinate
        ("low", "f8", (2,)),  # of both coordinates [m]
        ("per_length", "f8", (2,)),  # intervals over length [1/m]
        ("intervals", "f8", (2,)),
    ]
)
"""Record of the grid of one part: splines of (intervals + 3) coefficients along each coordinate."""


def pooled_grids(flanks: MeasuredFlanks) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the records (1,) of the pinion's and the rack's grid, and their coefficients: a pool."""
    records, numbers = (np.zeros(1, GRID), np.zeros(1, GRID)), [np.zeros(0)]
    for made, grid in zip(records, (flanks.pinion, flanks.rack), strict=True):
        if grid is None:
            continue
        teeth, sides, rows, columns = grid.coefficients.shape
        made["is_given"], made["first"] = 1, sum(map(len, numbers))
        made["per_tooth"], made["per_side"] = grid.is_of_each_tooth * sides * rows * columns, rows * columns
        made["teeth"], made["middle"], made["columns"] = teeth, -grid.first_tooth, columns
        made["low"], made["intervals"] = grid.low, grid.intervals
        made["per_length"] = 1 / np.array(grid.steps)
        numbers.append(grid.coefficients.ravel())
    return *records, np.concatenate(numbers)


ROUNDED = 1e-9  # of an interval: a place on the grid's edge is not beyond it


@inline
def _place(u, i, grid):  # type: ignore[no-untyped-def]
    """Interval of a coordinate, how far in it the place lies, and the intervals per length; none beyond."""
    at, per_length, last = (u - grid.low[i]) * grid.per_length[i], grid.per_length[i], grid.intervals[i]
    if not -ROUNDED < at < last + ROUNDED:
        per_length = 0.0
    at = min(max(at, 0.0), last)
    number = min(np.floor(at), last - 1)
    return int(number), at - number, per_length


@inline
def _basis(t):  # type: ignore[no-untyped-def]
    """The four cubic B-splines of an interval, their first and their second derivatives."""
    r = 1 - t
    value = (r * r * r / 6, (4 - t * t * (6 - 3 * t)) / 6, (4 - r * r * (6 - 3 * r)) / 6, t * t * t / 6)
    slope = (-r * r / 2, t * (1.5 * t - 2), -r * (1.5 * r - 2), t * t / 2)
    return value, slope, (r, 3 * t - 2, 3 * r - 2, t)


@inline
def grid_at(u, w, tooth, sign, grid, pool):  # type: ignore[no-untyped-def]
    """Deviation of one flank at (u, w), and its derivatives by u, w, uu, uw, ww."""
    i, t, per_u = _place(u, 0, grid)
    j, s, per_w = _place(w, 1, grid)
    along, along_1, along_2 = _basis(t)
    beside, beside_1, beside_2 = _basis(s)
    number = min(max(tooth + grid.middle, 0), grid.teeth - 1)
    first = grid.first + number * grid.per_tooth + (grid.per_side if sign > 0 else 0)
    first += i * grid.columns + j
    d = d_u = d_w = d_uu = d_uw = d_ww = 0.0
    for k in range(4):
        row = first + k * grid.columns
        c_0, c_1, c_2, c_3 = pool[row], pool[row + 1], pool[row + 2], pool[row + 3]
        at = c_0 * beside[0] + c_1 * beside[1] + c_2 * beside[2] + c_3 * beside[3]
        rise = c_0 * beside_1[0] + c_1 * beside_1[1] + c_2 * beside_1[2] + c_3 * beside_1[3]
        d += along[k] * at
        d_u += along_1[k] * at
        d_uu += along_2[k] * at
        d_w += along[k] * rise
        d_uw += along_1[k] * rise
        d_ww += along[k] * (c_0 * beside_2[0] + c_1 * beside_2[1] + c_2 * beside_2[2] + c_3 * beside_2[3])
    return d, d_u * per_u, d_w * per_w, d_uu * per_u * per_u, d_uw * per_u * per_w, d_ww * per_w * per_w


@kernel
def deviation_across(z, tooth, line, side, data, pool):  # type: ignore[no-untyped-def]
    """Coefficients of 1, xi, xi^2 at Z in the surplus of the pinion's flank along the transverse tangent, and
    in what both flanks' deviations add to the depth."""
    s, rb, n_p = side.sign, data.base_radius, side.n_p
    p_0 = p_1 = p_2 = r_0 = r_1 = r_2 = 0.0
    q = line.q_0 + line.q_1 * z
    if data.pinion_grid.is_given:
        d, d_q, _, d_qq, _, _ = grid_at(q, z, tooth % data.teeth, s, data.pinion_grid, pool)
        per_tangent = 1 / data.cos_base_helix
        p_0, p_1, p_2 = d * per_tangent, -s * rb * d_q * per_tangent, rb * rb * d_qq * per_tangent / 2
    if data.rack_grid.is_given:  # (y, z) = c + c_r P_r + c_t P_t + c_z Z, P_r = r_b + s q xi, P_t = s q
        y, place = affine(side.y, rb, s * q, z), affine(side.z, rb, s * q, z)
        y_1, z_1 = -side.y[1] * s * q, -side.z[1] * s * q
        r_0, d_y, d_z, d_yy, d_yz, d_zz = grid_at(y, place, int(line.rack_tooth), s, data.rack_grid, pool)
        r_1 = d_y * y_1 + d_z * z_1
        r_2 = (d_yy * y_1 * y_1 + 2 * d_yz * y_1 * z_1 + d_zz * z_1 * z_1) / 2
    return p_0, p_1, p_2, n_p * p_0 + r_0, n_p * p_1 + r_1, n_p * (p_2 - p_0 / 2) + r_2


@inline
def add_deviation(piece, strip, low, high, at_low, middle, at_high, line, side, data):  # type: ignore[no-untyped-def]
    """Fill the polynomials of a piece of a strip between two Z, from `deviation_across` at both and in the
    middle."""
    for row in range(strip.shape[0]):
        for k in range(strip.shape[1]):
            piece[row, k] = strip[row, k]
    z, b = (low + high) / 2, (high - low) / 2
    p_low, _, _, d_low, e_low, _ = at_low
    p_z, lean, bend, d_z, _, e_2 = middle
    p_high, _, _, d_high, e_high, _ = at_high
    level, rise, turn = _parabola(p_low, p_z, p_high, z, b)
    surplus, tip, bar = piece[SURPLUS], piece[RACK_TIP], piece[BAR]
    surplus[0] += level
    surplus[1] += rise
    surplus[2] += turn
    surplus[3] += lean
    surplus[6] += bend
    # the points move along e_t by the pinion's surplus
    y_t, z_t, q = side.sign * side.y[2], side.sign * side.z[2], side.sign * (line.q_0 + line.q_1 * z)
    tip[0] += y_t * level
    tip[1] += y_t * rise
    tip[2] += y_t * turn
    tip[3] += y_t * lean
    outwards = affine(side.y, data.base_radius, q, z) * y_t + affine(side.z, data.base_radius, q, z) * z_t
    bar[0] -= 2 * outwards * level
    bar[1] -= 2 * outwards * rise
    bar[2] -= 2 * outwards * turn
    level, rise, turn = _parabola(d_low, d_z, d_high, z, b)
    twist = (e_high - e_low) / (2 * b)
    lean = (e_high + e_low) / 2 - twist * z
    for row in (DEPTH, PRESSING):
        piece[row, 0] += level
        piece[row, 1] += rise
        piece[row, 2] += turn
        piece[row, 3] += lean
        piece[row, 4] += twist
        piece[row, 6] += e_2


@inline
def _parabola(at_low, middle, at_high, z, b):  # type: ignore[no-untyped-def]
    """Coefficients of 1, Z, Z^2 of the parabola through values at z - b, z, z + b."""
    turn = ((at_low + at_high) / 2 - middle) / (b * b)
    rise = (at_high - at_low) / (2 * b) - 2 * turn * z
    return middle - (rise + turn * z) * z, rise, turn


@inline
def measured_band(band, tooth, line, side, data, pool):  # type: ignore[no-untyped-def]
    """The band with its ends where the measured flank meets form and tip circle, as `band_on_flank` has
    them."""
    low, high = band.low, band.high
    if data.pinion_grid.is_given:
        if low <= data.q_form:
            low -= _surplus_at(low, tooth, line, side, data, pool)
        if high >= data.q_tip:
            high -= _surplus_at(high, tooth, line, side, data, pool)
    return FlankZone(low, high, band.relief, band.relief_from)


@inline
def _surplus_at(q, tooth, line, side, data, pool):  # type: ignore[no-untyped-def]
    """Surplus along the transverse tangent where a line has the tangent length q, within the face."""
    z = min(max((q - line.q_0) / line.q_1, -data.half_face), data.half_face)
    return deviation_across(z, tooth, line, side, data, pool)[0]
