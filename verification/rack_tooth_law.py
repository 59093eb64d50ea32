"""What the law "teeth" and closed forms say for the patches of `rack_tooth_elements`.

An *even load* presses on all patches of one height. What finite elements give for it contains the
flattening near the load, which the law counts apart; it is taken off as that of a half-plane under the same
strip, from its surface down to the middle of the tooth at the depth h:

    K [(1 - 2 nu) / (1 - nu) h / (2 a) atan(a / h) + ln(1 + h^2 / a^2) / 2 - ln 2 + 1 / 2]

per load per length, as a mean over the strip of half width a, K = 2 (1 - nu^2) / (pi E). It follows from
the stresses below an evenly pressed strip in plane strain (Timoshenko and Goodier, section 37).

In plane strain an even load has a closed form (Weber and Banaschek 1953), `tooth_compliance.plane_yield`.
"""

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.tooth_contact.tooth_compliance import (
    PLACE_SIZE,
    RACK,
    RACK_YIELD,
    add_block,
    fill_rack_place,
    plane_yield,
    rack_tooth,
    tooth_data,
)
from verification.rack_tooth_elements import POISSON_RATIO, ROWS, YOUNGS_MODULUS, Section

ACROSS, ALONG = 3, 4  # points of the law in a patch
PER_MM = 1e12  # from m/(N/m) to nm/(N/mm)


def even_load(section: Section, patches: int, compliance: np.ndarray, row: int) -> np.ndarray:
    """Return the yield of one height's patches under 1 N/m on all of them, shape (patches,) [m/(N/m)]."""
    strip = slice(row * patches, (row + 1) * patches)
    length = 2 * section.half_length(section.row_height(row + 0.5)) / patches
    return np.asarray(length * compliance[strip, strip].sum(axis=0))


def law_compliance(section: Section, patches: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the law's compliance between the patches of one flank, and between those of the two flanks of a
    tooth, without flattening [m/N]; the tooth's ends stand square to it, as those of the elements."""
    pair = section.pair
    given = rack_tooth(pair)
    tooth = tooth_data(RACK, pair.module, 0.0, given.root, given.root_width)
    rows = (np.arange(ROWS * ACROSS) + 0.5) / ACROSS
    along = (np.arange(patches * ALONG) + 0.5) / (patches * ALONG) * 2 - 1
    height, share = (each.ravel() for each in np.meshgrid(section.row_height(rows), along, indexing="ij"))
    half, scale = section.half_length(height), np.cos(pair.alpha_n) * RACK_YIELD
    stations = np.column_stack([lever_of(pair, height) / tooth.root_width, share * half, half])
    matrices = between(stations, scale, tooth, True), between(stations, scale, tooth, False)
    same, opposite = (means(each, patches) for each in matrices)
    return same, opposite


@kernel
def between(stations, scale, tooth, same_flank):  # type: ignore[no-untyped-def]
    """Return the compliance between stations (n, 3) of a rack's tooth, or with those opposite them: zeta, the
    place along the tooth and half the tooth's length there [m]; shape (n, n) [m/N]."""
    n = stations.shape[0]
    matrix, places = np.zeros((2 * n, 2 * n)), np.empty((PLACE_SIZE, 2 * n))
    for i in range(2 * n):
        zeta, along, half = stations[i % n, 0], stations[i % n, 1], stations[i % n, 2]
        fill_rack_place(places, i, zeta, along, 0.0, half, scale, -1.0 if i < n else 1.0, tooth)
    add_block(matrix, places, n, 0, n, same_flank, tooth)
    return matrix[n:, :n].copy()


def means(matrix: np.ndarray, patches: int) -> np.ndarray:
    """Average a compliance between points over patches."""
    shape = (ROWS, ACROSS, patches, ALONG)
    return matrix.reshape(shape + shape).mean(axis=(1, 3, 5, 7)).reshape((ROWS * patches,) * 2)


def lever_of(pair: GearPair, height: np.ndarray) -> np.ndarray:
    """Where the direction of a load at a height meets the tooth's middle, above the root's section [m]."""
    return np.asarray(height - half_thickness(pair, height) * np.tan(pair.alpha_n) + rack_tooth(pair).root)


def half_thickness(pair: GearPair, height: float | np.ndarray) -> float | np.ndarray:
    """Half the tooth's thickness at a height of its plane flanks [m]."""
    return np.pi * pair.module / 4 - height * np.tan(pair.alpha_n)


def flattening(section: Section, height: float) -> float:
    """Return the mean yield of an evenly pressed strip, relative to the tooth's middle [m/(N/m)]."""
    pair, nu = section.pair, POISSON_RATIO
    width = (section.row_height(1) - section.row_height(0)) / np.cos(pair.alpha_n)
    depth = half_thickness(pair, height) / np.cos(pair.alpha_n) / (width / 2)  # over the half width
    hertz = 2 * (1 - nu**2) / (np.pi * YOUNGS_MODULUS)
    straight = (1 - 2 * nu) / (1 - nu) * depth * np.arctan(1 / depth) / 2
    return float(hertz * (straight + np.log1p(depth**2) / 2 - np.log(2) + 0.5))


def plane_strain(section: Section, height: float) -> float:
    """Return the closed form for an even load on a long tooth, without flattening [m/(N/m)]."""
    pair, tooth = section.pair, rack_tooth(section.pair)
    lever = lever_of(pair, np.array([height]))
    up = np.linspace(0, tooth.root + pair.rack_addendum, 400)
    thickness = 2 * section.half_width(up - tooth.root)
    return float(plane_yield(lever, np.array([np.tan(pair.alpha_n)]), tooth.root_width, up, thickness)[0])
