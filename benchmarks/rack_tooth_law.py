"""What the law "teeth" and closed forms say for the patches of `rack_tooth_elements`.

An *even load* presses on all patches of one height. What finite elements give for it contains the
flattening near the load, which the law counts apart; it is taken off as that of a half-plane under the same
strip, from its surface down to the middle of the tooth at the depth h:

    K [(1 - 2 nu) / (1 - nu) h / (2 a) atan(a / h) + ln(1 + h^2 / a^2) / 2 - ln 2 + 1 / 2]

per load per length, as a mean over the strip of half width a, K = 2 (1 - nu^2) / (pi E). It follows from
the stresses below an evenly pressed strip in plane strain (Timoshenko and Goodier, section 37).

In plane strain an even load has a closed form (Weber and Banaschek 1953), for a load whose direction meets
the middle of the tooth y above the root's section, where the tooth is d thick at x above it:

    cos^2 alpha (1 - nu^2) / E [12 B + (2.4 / (1 - nu) + tan^2 alpha) S] + kappa

B is the integral of (y - x)^2 / d^3 over x from 0 to y, S that of 1 / d; kappa is that of
`rps_exudyn.tooth_contact.tooth_compliance`.
"""

from typing import NamedTuple

import numpy as np

from benchmarks.rack_tooth_elements import POISSON_RATIO, ROWS, YOUNGS_MODULUS, Section
from rps_exudyn.base.compiled import changed, kernel
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.tooth_contact.tooth_compliance import (
    FOUNDATION,
    FOUNDATION_ANGLE,
    PLACE_SIZE,
    add_block,
    fill_place,
    rack_tooth,
)

ACROSS, ALONG = 3, 4  # points of the law in a patch
NODES, WEIGHTS = np.polynomial.legendre.leggauss(30)
PER_MM = 1e12  # from m/(N/m) to nm/(N/mm)


def even_load(section: Section, patches: int, compliance: np.ndarray, row: int) -> np.ndarray:
    """Return the yield of one height's patches under 1 N/m on all of them, shape (patches,) [m/(N/m)]."""
    strip = slice(row * patches, (row + 1) * patches)
    length = 2 * section.half_length(section.row_height(row + 0.5)) / patches
    return np.asarray(length * compliance[strip, strip].sum(axis=0))


class Points(NamedTuple):
    """Points of the law in all patches, by row, point across, patch, point along."""

    height: np.ndarray  # above the reference line [m]
    lever: np.ndarray  # y [m]
    places: np.ndarray  # of `tooth_compliance`


def law_compliance(section: Section, patches: int, tooth: np.record) -> np.ndarray:
    """Return the law's compliance between the patches of one flank, without flattening [m/N]."""
    return means(matrix_of(law_points(section, patches, tooth), tooth), patches)


def bending_compliance(section: Section, patches: int, tooth: np.record) -> np.ndarray:
    """Return the compliance by the law's form with bending and shear of the tooth itself in kappa [m/N].

    Between a load y_i and a yield y_j above the root, up to the lower of them:
    12 B_ij + (2.4 / (1 - nu) + tan^2 alpha) S, B_ij the integral of (y_i - x) (y_j - x) / d^3.
    """
    points = law_points(section, patches, tooth)
    spread = matrix_of(points, changed(tooth, bending=0.0, shear=0.0))
    tan = np.tan(section.pair.alpha_n)
    foundation = FOUNDATION * (1 + FOUNDATION_ANGLE * tan**2)
    levers, which = np.unique(np.round(points.lever, 12), return_inverse=True)
    beams = np.array([[beam(section, tooth, y_i, y_j) for y_j in levers] for y_i in levers])
    matrix = matrix_of(points, tooth) + spread / foundation * beams[np.ix_(which, which)]
    return means(matrix, patches)


def law_points(section: Section, patches: int, tooth: np.record) -> Points:
    """Return the law's points in all patches."""
    pair, tan = section.pair, np.tan(section.pair.alpha_n)
    rows = (np.arange(ROWS * ACROSS) + 0.5) / ACROSS
    along = (np.arange(patches * ALONG) + 0.5) / (patches * ALONG) * 2 - 1
    height, zeta = (each.ravel() for each in np.meshgrid(section.row_height(rows), along, indexing="ij"))
    lever = height - half_thickness(pair, height) * tan + tooth.root
    half = section.half_length(height)
    cos, sin = np.cos(pair.alpha_n), np.sin(pair.alpha_n)
    flat = np.ones(height.size)
    stations = np.column_stack([cos * flat, cos * lever, sin * flat, zeta * half])
    return Points(height, lever, places_of(stations, half, tooth))


@kernel
def places_of(stations, half_lengths, tooth):  # type: ignore[no-untyped-def]
    """Return what the law keeps of stations (n, 4): cos(alpha), and times y, times tan(alpha), and s, on
    teeth of these half lengths (n,) [m]."""
    places = np.empty((PLACE_SIZE, stations.shape[0]))
    for i in range(stations.shape[0]):
        cos, cos_y, cos_tan, s = stations[i, 0], stations[i, 1], stations[i, 2], stations[i, 3]
        fill_place(places, i, cos, cos_y, cos_tan, s, half_lengths[i], tooth)
    return places


@kernel
def add_compliance(matrix, places, rows, columns, count, sigma, tooth):  # type: ignore[no-untyped-def]
    """Do what `add_block` does, for Python."""
    add_block(matrix, places, rows, columns, count, sigma, tooth)


def matrix_of(points: Points, tooth: np.record) -> np.ndarray:
    """Return the law's compliance between points of one flank [m/N]."""
    matrix = np.zeros((points.height.size,) * 2)
    add_compliance(matrix, points.places, 0, 0, points.height.size, 1.0, tooth)
    return matrix


def means(matrix: np.ndarray, patches: int) -> np.ndarray:
    """Average a compliance between points over patches."""
    shape = (ROWS, ACROSS, patches, ALONG)
    return matrix.reshape(shape + shape).mean(axis=(1, 3, 5, 7)).reshape((ROWS * patches,) * 2)


def beam(section: Section, tooth: np.record, y_i: float, y_j: float) -> float:
    """Return 12 B_ij + (2.4 / (1 - nu) + tan^2 alpha) S for the levers of a load and a yield [m]."""
    top = max(min(y_i, y_j), 0.0)
    x = top * (NODES + 1) / 2
    thickness = 2 * section.half_width(x - tooth.root)
    bending = WEIGHTS @ ((y_i - x) * (y_j - x) / thickness**3)
    shear = WEIGHTS @ (1 / thickness)
    tan = np.tan(section.pair.alpha_n)
    return float(top / 2 * (12 * bending + (2.4 / (1 - POISSON_RATIO) + tan**2) * shear))


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
    pair, tooth, nu = section.pair, rack_tooth(section.pair), POISSON_RATIO
    tan = np.tan(pair.alpha_n)
    lever = height - half_thickness(pair, height) * tan + tooth.root
    kappa = tooth.bending * lever**2 + 2 * tooth.shear * lever + FOUNDATION * (1 + FOUNDATION_ANGLE * tan**2)
    whole = beam(section, tooth, lever, lever) + kappa
    return float(np.cos(pair.alpha_n) ** 2 * (1 - nu**2) / YOUNGS_MODULUS * whole)
