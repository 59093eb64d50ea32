"""Sections of the bar that bend: the plain round one, and the toothed one in the mean over its teeth.

The toothed bar bends as its section at the tooth roots does, a circle cut by a chord, with a thin layer on
the chord that stands for the teeth: flanks are free of load, so that little of the bending stress finds its
way into a tooth, and less the wider the gaps between the teeth are. Thickness of the layer:

    t = 0.17 p exp(-6.2 b / p) (1 + 1.4 sin^2 beta_r)

with the normal pitch p and half the width b of a gap at a height of p / 20 above the roots. With 0.17 p there
would be cracks for gaps; askew to the bar, teeth are ribs that carry stress along themselves. The numbers are
fitted to elastic solid cells of one pitch under periodic bending (`tests/geometry/test_rack_beam.py`): tooth
angles of 0 to 40 degrees, pressure angles of 15 to 30 degrees, short and full teeth, modules and bars of
different size. Bending stiffness agrees with the cells within 1.5 % in plane X-Y. Sideways the layer counts
1.4 times: of the whole default rack by finite elements, the free modes ask for the layer as it is, as the
cells do, the deflection as a cantilever for twice of it; the stiffness lies within 2.5 % of both.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss

from rps_exudyn.gears.basic_rack import rack_tooth
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO

CRACKED, WIDTH, ASKEW = 0.17, 6.2, 1.4  # numbers of the layer's thickness
SIDEWAYS = 1.4  # what the layer counts in plane X-Z
GAP_HEIGHT = 0.05  # over the pitch: where a gap's width counts
CHORD_ERROR = 1e-6  # of the tooth's outline [m]
_RULE = leggauss(64)  # of integrals over heights


@dataclass(frozen=True)
class BarSection:
    """One section of the bar; second moments about the axes through its centroid."""

    area: float  # that shears [m^2]
    filled_area: float  # that weighs, the teeth's share included [m^2]
    second_moments: tuple[float, float]  # int y^2 (bending in X-Y), int z^2 (bending in X-Z) [m^4]

    @property
    def shear_area(self) -> float:
        """Area over the shear correction of a round bar, (7 + 6 nu) / (6 + 6 nu) [m^2] (Cowper 1966)."""
        return self.area * 6 * (1 + POISSON_RATIO) / (7 + 6 * POISSON_RATIO)


def plain_section(bar: RackBar) -> BarSection:
    """The round bar outside its teeth."""
    radius = bar.pair.bar_radius
    area, inertia = np.pi * radius**2, np.pi / 4 * radius**4
    return BarSection(area, area, (inertia, inertia))


def root_section(bar: RackBar) -> BarSection:
    """The section at the tooth roots: the circle above the chord at the roots' height."""
    radius, root = bar.pair.bar_radius, bar.root_height
    y, weight = _heights(root, radius)
    half_chord = np.sqrt(radius**2 - y**2)
    area = float(weight @ (2 * half_chord))
    centre = weight @ (2 * half_chord * y) / area
    across = float(weight @ (2 * half_chord * (y - centre) ** 2))
    return BarSection(area, area, (across, float(weight @ (2 / 3 * half_chord**3))))


def toothed_section(bar: RackBar) -> BarSection:
    """The section that stands for the toothed bar: at the roots, with the layer on its chord."""
    root = root_section(bar)
    half_chord = float(np.sqrt(max(bar.pair.bar_radius**2 - bar.root_height**2, 0)))
    thickness = tooth_layer(bar)
    layer = 2 * half_chord * thickness
    centre = 2 / 3 * half_chord**3 / root.area  # of the circle above the chord
    distance = centre - bar.root_height + thickness / 2
    across = layer * (distance**2 * root.area / (root.area + layer) + thickness**2 / 12)
    y, z = root.second_moments
    return BarSection(
        root.area,
        root.area + _area_of_teeth(bar),
        (y + across, z + SIDEWAYS * 2 / 3 * half_chord**3 * thickness),
    )


@lru_cache(maxsize=8)  # finer runs of a gear share them
def mass_and_moments(bar: RackBar, density: float) -> tuple[float, np.ndarray]:
    """Return the bar's mass [kg] and its moments of inertia about the rack frame's axes [kg m^2], shape (3,).

    A round bar, whose middle has the mean section of the teeth; what runs out at its ends is left out.
    """
    radius, half = bar.pair.bar_radius, bar.reach
    plain, roots = (_about_the_axis(bar, *_heights(low, radius)) for low in (-radius, bar.root_height))
    y, weight = _heights(bar.tip_height, bar.root_height)
    toothed = roots + _about_the_axis(bar, y, weight * _filled(bar, y))
    mass, moments = 0.0, np.zeros(3)
    parts = ((plain, bar.x_min, -half), (toothed, -half, half), (plain, half, bar.x_max))
    for (area, y, z), begin, end in parts:
        length, x = end - begin, area * (end**3 - begin**3) / 3
        mass += density * area * length
        moments += density * np.array([(y + z) * length, x + z * length, x + y * length])
    moments.flags.writeable = False
    return mass, moments


def tooth_layer(bar: RackBar) -> float:
    """Thickness of the layer of material by which the teeth stiffen the section at their roots [m]."""
    pair = bar.pair
    pitch = np.pi * pair.module
    gap = (1 - _filled(bar, bar.root_height - GAP_HEIGHT * pitch)) / 2
    askew = 1 + ASKEW * np.sin(pair.beta_r) ** 2
    return float(CRACKED * pitch * np.exp(-WIDTH * gap) * askew)


def _area_of_teeth(bar: RackBar) -> float:
    """Mean area that the teeth add to the section at their roots [m^2]."""
    y, weight = _heights(bar.tip_height, bar.root_height)
    chord = 2 * np.sqrt(np.maximum(bar.pair.bar_radius**2 - y**2, 0))
    return float(weight @ (_filled(bar, y) * chord))


def _about_the_axis(bar: RackBar, y: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Area, int y^2 and int z^2 about the bar's axis of its chords at heights Y with weights: shape (3,)."""
    half_chord = np.sqrt(np.maximum(bar.pair.bar_radius**2 - y**2, 0))
    return np.array(
        [weight @ (2 * half_chord), weight @ (2 * half_chord * y**2), weight @ half_chord**3 * 2 / 3]
    )


def _filled(bar: RackBar, y: float | np.ndarray) -> np.ndarray:
    """Share of the pitch that a tooth fills at heights Y [m]."""
    pair = bar.pair
    outline = rack_tooth(pair, CHORD_ERROR)
    right = outline[outline[:, 0] > 0]
    order = np.argsort(right[:, 1])
    height = -np.asarray(y) - pair.reference_height
    return 2 * np.interp(height, right[order, 1], right[order, 0]) / (np.pi * pair.module)


def _heights(low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Points of integration from `low` to `high` and their weights [m]."""
    x, weight = _RULE
    return (low + high) / 2 + (high - low) / 2 * x, (high - low) / 2 * weight
