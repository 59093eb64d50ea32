"""Compliance of the teeth of pinion and rack between places on their flanks.

A tooth is a cantilever on an elastic foundation (Weber and Banaschek, VDI-Forschungsheft 1953), whose yield
spreads along the tooth. For loads normal to the flank at two stations of one tooth

    C_ij = sigma s kappa_ij / (2 l) [exp(-|s_i - s_j| / l) + r exp(-(a_i + a_j) / l)
                                     + r exp(-(b_i + b_j) / l)]
    kappa_ij = cos(alpha_i) cos(alpha_j) (1 - nu^2) / E [18 / pi y_i y_j / s_f^2
               + (1 - 2 nu) / (1 - nu) (y_i + y_j) / s_f
               + 4.8 / pi (1 + (1 - nu) / 2.4 tan(alpha_i) tan(alpha_j))]

with the place s along the tooth, its distances a and b to the tooth's ends, the lever y from the root's
section, that section's width s_f, and the load's angle alpha against the normal of the tooth's middle plane.
sigma is 1 on one flank, -c between the two flanks of one tooth, which bend it against each other, and 0
between teeth.

The four constants s, l, r, c of each body are those with which finite elements of the whole mesh (all teeth
on their core, a rack bar with seven teeth) are met. They are effective constants: of one rack tooth alone
they miss the yield by 10 to 24 %, see `docs/contact-law.md`.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.gears.basic_rack import cutter_tip_centre
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.gears.trochoid import root_section


class Spread(NamedTuple):
    """How a body's teeth spread the yield along them; fitted to finite elements."""

    strength: float  # s
    length: float  # l over the normal module
    ends: float  # r: how the tooth's ends reflect
    coupling: float  # c: of drive and coast flank of one tooth


PINION = Spread(2.239, 0.743, -0.335, 0.469)
RACK = Spread(1.312, 1.782, 1.430, 1.300)


TOOTH = record_type(
    [
        ("scale", "f8"),  # s (1 - nu^2) / (2 E l) [1/(N/m) per m]
        ("length", "f8"),  # l [m]
        ("ends", "f8"),
        ("coupling", "f8"),
        ("bending", "f8"),  # 18 / (pi s_f^2) [1/m^2]
        ("shear", "f8"),  # (1 - 2 nu) / ((1 - nu) s_f) [1/m]
        ("root", "f8"),  # pinion: radius of the root's section; rack: its height below the reference line [m]
    ]
)
"""Record of a body's teeth for `add_line` and `add_block`; SI units."""


def tooth_data(spread: Spread, module: float, root: float, root_width: float) -> np.record:
    """Return the data of a body's teeth from their root's section [m]."""
    nu, length = POISSON_RATIO, spread.length * module
    return record(
        TOOTH,
        scale=spread.strength * (1 - nu**2) / YOUNGS_MODULUS / (2 * length),
        length=length,
        ends=spread.ends,
        coupling=spread.coupling,
        bending=18 / np.pi / root_width**2,
        shear=(1 - 2 * nu) / (1 - nu) / root_width,
        root=root,
    )


def pinion_tooth(pair: GearPair) -> np.record:
    """Return the pinion's teeth: the root's section is where the fillet leans 30 degrees (ISO 6336-3)."""
    radius, half_width = root_section(pair)
    width = 2 * half_width * np.cos(np.arctan(pair.twist * np.hypot(radius, half_width)))
    return tooth_data(PINION, pair.module, radius, width)


def rack_tooth(pair: GearPair) -> np.record:
    """Return the rack's teeth: the root's section is 60 degrees down the fillet."""
    u, y = cutter_tip_centre(pair)  # the cutter's tooth is the rack's space
    width = 2 * (np.pi * pair.module / 2 - u - pair.fillet_radius * np.cos(np.radians(60)))
    return tooth_data(RACK, pair.module, -y + pair.fillet_radius * np.sin(np.radians(60)), width)


FOUNDATION = 4.8 / np.pi
FOUNDATION_ANGLE = (1 - POISSON_RATIO) / 2.4

# What a body's places are, one row per property, one column per station
COS, COS_Y, COS_TAN = 0, 1, 2  # cos(alpha), and times y, times tan(alpha)
RISE, FALL = 3, 4  # exp(+-s / l)
END_A, END_B = 5, 6  # exp(-a / l), exp(-b / l)
PLACE = 7  # s [m]
PLACE_SIZE = 8


@inline
def fill_place(places, i, cos, cos_y, cos_tan, s, half_length, data):  # type: ignore[no-untyped-def]
    """Fill the column of a station at s [m] from the middle of a tooth of some half length [m]."""
    fill_between_ends(places, i, cos, cos_y, cos_tan, s, np.exp(-half_length / data.length), data)


@inline
def fill_between_ends(places, i, cos, cos_y, cos_tan, s, end, data):  # type: ignore[no-untyped-def]
    """Fill the same from `end`, exp(-half length / l)."""
    places[COS, i], places[COS_Y, i], places[COS_TAN, i] = cos, cos_y, cos_tan
    places[PLACE, i] = s
    rise = np.exp(s / data.length)
    places[RISE, i], places[FALL, i] = rise, 1 / rise
    places[END_A, i], places[END_B, i] = end / rise, end * rise


class Row(NamedTuple):
    """What a station's row of the compliance shares: kappa as a form in another place, and s and the ends."""

    per_y: float
    per_cos: float
    per_tan: float
    rise: float
    fall: float
    end_a: float
    end_b: float


@inline
def row_of(places, i, scale, data):  # type: ignore[no-untyped-def]
    """The row of a station, times a factor."""
    cos, cos_y = places[COS, i], places[COS_Y, i]
    return Row(
        scale * (data.bending * cos_y + data.shear * cos),
        scale * (data.shear * cos_y + FOUNDATION * cos),
        scale * FOUNDATION * FOUNDATION_ANGLE * places[COS_TAN, i],
        places[RISE, i],
        places[FALL, i],
        data.ends * places[END_A, i],
        data.ends * places[END_B, i],
    )


@inline
def kappa_of(row, places, j):  # type: ignore[no-untyped-def]
    """kappa_ij of a row and another station, with the row's factor."""
    return row.per_y * places[COS_Y, j] + row.per_cos * places[COS, j] + row.per_tan * places[COS_TAN, j]


@inline
def direct(row, places, j):  # type: ignore[no-untyped-def]
    """exp(-|s_i - s_j| / l)."""
    return min(row.rise * places[FALL, j], row.fall * places[RISE, j])


@inline
def by_ends(row, places, j):  # type: ignore[no-untyped-def]
    """What the tooth's ends add to that."""
    return row.end_a * places[END_A, j] + row.end_b * places[END_B, j]


@inline
def add_block(matrix, places, rows, columns, count, sigma, data):  # type: ignore[no-untyped-def]
    """Add the compliance between `count` stations from `rows` on and as many from `columns` on [m/N].

    sigma is 1 for stations of one flank, -c for those of the two flanks of one tooth.
    """
    for i in range(rows, rows + count):
        row = row_of(places, i, sigma * data.scale, data)
        for j in range(columns, columns + count):
            matrix[i, j] += kappa_of(row, places, j) * (direct(row, places, j) + by_ends(row, places, j))


@inline
def add_line(matrix, places, start, nodes, weights, data):  # type: ignore[no-untyped-def]
    """Add the compliance between the stations of one line to the lower triangle [m/N].

    The kink of exp(-|s_i - s_j| / l) is integrated exactly for an even load: what the stations' sum misses of
    the integral over the line goes to the diagonal. `nodes` and `weights` are the line's rule on [0, 1].
    """
    count, end = nodes.size, start + nodes.size - 1
    per_node = (places[PLACE, end] - places[PLACE, start]) / (nodes[count - 1] - nodes[0])
    first = places[PLACE, start] - nodes[0] * per_node
    low, high = min(first, first + per_node), max(first, first + per_node)
    from_low, to_high = np.exp(low / data.length), np.exp(-high / data.length)
    per_length = data.length / (high - low)
    for i in range(start, end + 1):
        row = row_of(places, i, data.scale, data)
        missing = per_length * (2 - from_low * row.fall - to_high * row.rise)
        for j in range(start, end + 1):
            along = direct(row, places, j)
            missing -= weights[j - start] * along
            if j <= i:
                matrix[i, j] += kappa_of(row, places, j) * (along + by_ends(row, places, j))
        matrix[i, i] += kappa_of(row, places, i) * missing / weights[i - start]
