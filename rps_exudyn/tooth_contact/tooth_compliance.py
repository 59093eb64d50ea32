"""Compliance of the teeth of pinion and rack between places on their flanks.

A tooth yields in two modes k, each separable: bending, and foundation with squeezing. For loads normal to the
flank at two stations of one tooth

    C_ij = sum_k sigma_k phi_k,i phi_k,j / (2 l_k) [exp(-|s_i - s_j| / l_k) + A_k,i A_k,j + B_k,i B_k,j]
    A_k,i = (r0_k + r1_k zeta_i + side_i t_k tan(beta)) exp(-a_i / l_k)
    B_k,i = (r0_k + r1_k zeta_i - side_i t_k tan(beta)) exp(-b_i / l_k)

with the place s along the tooth, its distances a and b to the tooth's ends at the station's own height, the
relative height zeta = y / s_f of the load's direction above the root's section, which is s_f wide, and side
-1 on drive flanks, +1 on coast flanks. sigma_k is 1 on one flank, -c_k between the two flanks of one tooth,
which bend it against each other, and 0 between teeth. Along a helical tooth the two flanks are offset by the
tooth's thickness times the sine of its lead, and of its ends one corner is acute, which is soft:

    pinion  s = z / cos(beta_R) - side R half(R) sin(beta_R), tan(beta_R) = R tan(beta_p) / r_p, beta = beta_b
            phi_k = sqrt(kappa) (v0_k + v1_k zeta + v2_k zeta^2)
    rack    s = Z / cos(beta_r) + side w tan(beta_r), w half the thickness, beta = beta_r
            phi_k = cos(alpha_n) (v0_k + v1_k zeta + v2_k zeta^2) sqrt(nm / (N/mm))

kappa is the yield of a long tooth in plane strain (Weber and Banaschek, VDI-Forschungsheft 1953). The
constants of each mode, `Mode`, were fitted to the fields of finite elements, see `docs/contact-law.md`.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.gears.basic_rack import cutter_tip_centre
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.gears.trochoid import root_section


class Mode(NamedTuple):
    """One of the modes in which a body's teeth yield; fitted to finite elements."""

    terms: tuple[float, float, float]  # v0, v1, v2
    length: float  # l over the normal module
    ends: tuple[float, float]  # r0, r1: how the tooth's ends reflect
    lean: float  # t: by how much acute corners are softer than obtuse ones
    coupling: float  # c: of drive and coast flank of one tooth


PINION = (
    Mode((0.4761, 1.6925, -1.4561), 1.3427, (0.8788, 0.1084), 0.6480, 0.9079),
    Mode((0.8014, -2.0485, 0.6230), 0.7095, (0.6039, 1.1785), 2.3501, 0.5093),
)
RACK = (
    Mode((1.2132, 5.3799, 4.4281), 1.6218, (0.4164, 0.0711), -0.2421, 0.9114),
    Mode((2.7157, 2.8529, -8.3841), 1.9284, (0.7780, 0.2714), -0.7809, 0.6080),
)
MODES = 2
FITTED_MODULUS = 206e9  # of the steel that the constants were fitted with [Pa]
RACK_YIELD = 1e-6 * np.sqrt(FITTED_MODULUS / YOUNGS_MODULUS)  # sqrt(nm / (N/mm)) [sqrt(m^2/N)]


TOOTH = record_type(
    [
        ("terms", "f8", (MODES, 3)),  # v over sqrt(2 l)
        ("length", "f8", (MODES,)),  # l [m]
        ("ends", "f8", (MODES, 2)),  # r0, r1
        ("lean", "f8", (MODES,)),  # t tan(beta)
        ("coupling", "f8", (MODES,)),
        ("root", "f8"),  # pinion: radius of the root's section; rack: its height below the reference line [m]
        ("root_width", "f8"),  # s_f [m]
    ]
)
"""Record of a body's teeth for `add_line` and `add_block`; SI units."""


def tooth_data(
    modes: tuple[Mode, ...], module: float, tan_beta: float, root: float, root_width: float
) -> np.record:
    """Return the data of a body's teeth from their root's section [m] and the tangent of their lead."""
    return record(
        TOOTH,
        terms=np.array([np.array(mode.terms) / np.sqrt(2 * mode.length * module) for mode in modes]),
        length=np.array([mode.length * module for mode in modes]),
        ends=np.array([mode.ends for mode in modes]),
        lean=np.array([mode.lean * tan_beta for mode in modes]),
        coupling=np.array([mode.coupling for mode in modes]),
        root=root,
        root_width=root_width,
    )


def pinion_tooth(pair: GearPair) -> np.record:
    """Return the pinion's teeth: the root's section is where the fillet leans 30 degrees (ISO 6336-3)."""
    radius, half_width = root_section(pair)
    width = 2 * half_width * np.cos(np.arctan(pair.twist * np.hypot(radius, half_width)))
    return tooth_data(PINION, pair.module, float(np.tan(pair.beta_b)), radius, width)


def rack_tooth(pair: GearPair) -> np.record:
    """Return the rack's teeth: the root's section is 60 degrees down the fillet."""
    u, y = cutter_tip_centre(pair)  # the cutter's tooth is the rack's space
    width = 2 * (np.pi * pair.module / 2 - u - pair.fillet_radius * np.cos(np.radians(60)))
    root = -y + pair.fillet_radius * np.sin(np.radians(60))
    return tooth_data(RACK, pair.module, float(np.tan(pair.beta_r)), root, width)


# --- a long tooth in plane strain ------------------------------------------------------------------
def plane_yield(
    lever: np.ndarray, tan: np.ndarray, root_width: float, heights: np.ndarray, thickness: np.ndarray
) -> np.ndarray:
    """Return kappa, the yield of a long tooth under a load per length, without flattening [m^2/N].

        cos^2(alpha) (1 - nu^2) / E [12 B + (2.4 / (1 - nu) + tan^2(alpha)) S + 18 / pi (y / s_f)^2
            + 2 (1 - 2 nu) / (1 - nu) y / s_f + 4.8 / pi (1 + (1 - nu) / 2.4 tan^2(alpha))]

    B is the integral of (y - u)^2 / s(u)^3 over u from 0 to y, S that of 1 / s(u) (Weber and Banaschek).

    Args:
        lever: y, where the load's direction meets the tooth's middle above the root's section, (n,) [m].
        tan: tan(alpha) of the load against the normal of the tooth's middle plane, (n,).
        root_width: s_f [m].
        heights: u above the root's section, ascending, (m,) [m].
        thickness: s(u) in the normal section, (m,) [m].
    """
    nu, zeta = POISSON_RATIO, lever / root_width
    nodes, weights = np.polynomial.legendre.leggauss(24)
    top = np.maximum(lever, 0.0)[:, None]
    u, du = top * (nodes + 1) / 2, top * weights / 2
    s = np.interp(u, heights, thickness)
    bending = np.sum(du * (lever[:, None] - u) ** 2 / s**3, axis=1)
    shear = np.sum(du / s, axis=1)
    foundation = 18 / np.pi * zeta**2 + 2 * (1 - 2 * nu) / (1 - nu) * zeta
    foundation += 4.8 / np.pi * (1 + (1 - nu) / 2.4 * tan**2)
    whole = 12 * bending + (2.4 / (1 - nu) + tan**2) * shear + foundation
    return np.asarray((1 - nu**2) / YOUNGS_MODULUS / (1 + tan**2) * whole)


# --- stations ----------------------------------------------------------------------------------------
# What a body's places are, one row per property, one column per station; those of each mode one after the
# other: phi over sqrt(2 l), exp(+-s / l), A and B
PHI, RISE, FALL, END_A, END_B = 0, 1, 2, 3, 4
PER_MODE = 5
PLACE, SPAN = MODES * PER_MODE, MODES * PER_MODE + 1  # s [m]; share of the line per s from the station before
PLACE_SIZE = SPAN + 1


@inline
def fill_mode(places, i, mode, phi, along, offset, end, zeta, side, tooth):  # type: ignore[no-untyped-def]
    """Fill a station's column for one mode.

    `phi` is over sqrt(2 l); the rest are exponentials over l: of the place along the tooth's middle, of the
    flank's offset against it, towards s on coast flanks, and of half the tooth's length, negative.
    """
    first = mode * PER_MODE
    reflects = tooth.ends[mode, 0] + tooth.ends[mode, 1] * zeta
    lean = side * tooth.lean[mode]
    rise = along * offset if side > 0 else along / offset
    places[first + PHI, i] = phi
    places[first + RISE, i], places[first + FALL, i] = rise, 1 / rise
    places[first + END_A, i] = (reflects + lean) * end / along
    places[first + END_B, i] = (reflects - lean) * end * along


@inline
def fill_rack_place(places, i, zeta, along, offset, half_length, scale, side, tooth):  # type: ignore[no-untyped-def]
    """Fill the column of a station on a rack's tooth: the place along the tooth's middle, the flank's offset
    towards s on coast flanks and half the tooth's length there [m]; `scale` is cos(alpha_n) `RACK_YIELD`."""
    places[PLACE, i] = along + side * offset
    for mode in range(MODES):
        terms, length = tooth.terms[mode], tooth.length[mode]
        phi = scale * (terms[0] + zeta * (terms[1] + zeta * terms[2]))
        fill_mode(
            places,
            i,
            mode,
            phi,
            np.exp(along / length),
            np.exp(offset / length),
            np.exp(-half_length / length),
            zeta,
            side,
            tooth,
        )


@inline
def add_block(matrix, places, rows, columns, count, same_flank, tooth):  # type: ignore[no-untyped-def]
    """Add the compliance between `count` stations from `rows` on and as many from `columns` on [m/N], which
    stand on one flank or on the two flanks of one tooth."""
    for mode in range(MODES):
        first = mode * PER_MODE
        sigma = 1.0 if same_flank else -tooth.coupling[mode]
        for i in range(rows, rows + count):
            phi, rise, fall = sigma * places[first + PHI, i], places[first + RISE, i], places[first + FALL, i]
            end_a, end_b = places[first + END_A, i], places[first + END_B, i]
            for j in range(columns, columns + count):
                direct = min(rise * places[first + FALL, j], fall * places[first + RISE, j])
                by_ends = end_a * places[first + END_A, j] + end_b * places[first + END_B, j]
                matrix[i, j] += phi * places[first + PHI, j] * (direct + by_ends)


@inline
def _to_end(distance):  # type: ignore[no-untyped-def]
    """Integral of exp(-x) over x from 0 to a distance, over that distance."""
    return -np.expm1(-distance) / distance if distance > 0 else 1.0


@inline
def add_line(matrix, places, start, nodes, weights, tooth):  # type: ignore[no-untyped-def]
    """Add the compliance between the stations of one line to the lower triangle [m/N].

    The kink of exp(-|s_i - s_j| / l) is integrated exactly for an even load: what the stations' sum misses of
    the integral over the line, s linear between the stations, goes to the diagonal. `nodes` and `weights` are
    the line's rule on [0, 1].
    """
    count, end = nodes.size, start + nodes.size - 1
    for j in range(start + 1, end + 1):
        step = abs(places[PLACE, j] - places[PLACE, j - 1])
        places[SPAN, j] = (nodes[j - start] - nodes[j - 1 - start]) / step
    slope = abs(places[PLACE, end] - places[PLACE, start]) / (nodes[count - 1] - nodes[0])
    for mode in range(MODES):
        first, length = mode * PER_MODE, tooth.length[mode]
        low = nodes[0] * _to_end(nodes[0] * slope / length)
        high = (1 - nodes[count - 1]) * _to_end((1 - nodes[count - 1]) * slope / length)
        for i in range(start, end + 1):
            phi, rise, fall = places[first + PHI, i], places[first + RISE, i], places[first + FALL, i]
            end_a, end_b = places[first + END_A, i], places[first + END_B, i]
            before = min(rise * places[first + FALL, start], fall * places[first + RISE, start])
            missing, jumps = (low - weights[0]) * before, 0.0
            by_ends = end_a * places[first + END_A, start] + end_b * places[first + END_B, start]
            matrix[i, start] += phi * places[first + PHI, start] * (before + by_ends)
            for j in range(start + 1, end + 1):
                direct = min(rise * places[first + FALL, j], fall * places[first + RISE, j])
                missing -= weights[j - start] * direct
                jumps += places[SPAN, j] * abs(direct - before)
                before = direct
                if j <= i:
                    by_ends = end_a * places[first + END_A, j] + end_b * places[first + END_B, j]
                    matrix[i, j] += phi * places[first + PHI, j] * (direct + by_ends)
            missing += high * before + length * jumps
            matrix[i, i] += phi * phi * missing / weights[i - start]
