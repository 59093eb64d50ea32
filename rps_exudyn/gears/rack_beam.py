"""The rack as a beam that bends: stiffness and mass along the bar, and its free modes.

The bar is a Timoshenko beam in each of two planes, X-Y (deflection w, rotation theta about Z) and X-Z
(deflection u, rotation psi with the sign of du/dX, which is a turn of -psi about Y). Its toothed part, from
the first to the last root in the middle of the teeth, has the section of `bar_section.toothed_section`.
Stations count along the bar in the rack frame. Left out are torsion and stretch (the first such modes lie ten
times above the first bending mode), and the centroid of the toothed part, which is not on the bar's axis.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss

from rps_exudyn.gears.bar_section import BarSection, plain_section, toothed_section
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO
from rps_exudyn.parameters.gear import SteeringGear

# --- Timoshenko beams of straight elements, one plane: stiffness, mass, modes.
# An element has two nodes with deflection w and rotation theta of the section, in the order (w, theta) at its
# first and second node. Between them w is a cubic and theta a quadratic, those of a beam without distributed
# load: w' - theta is constant, so that there is no shear locking and static deflections under loads at nodes
# are exact (Przemieniecki 1968; shape functions as in Friedman and Kosmatka 1993).

_RULE = leggauss(4)  # of integration over an element: exact for products of its cubics


@dataclass(frozen=True, eq=False)
class ShapeFunctions:
    """Shape functions of all elements at points s in [0, 1]; shapes (elements, 4, points)."""

    deflection: np.ndarray  # w
    gradient: np.ndarray  # w'
    rotation: np.ndarray  # theta
    curvature: np.ndarray  # theta'

    @classmethod
    def at(cls, s: np.ndarray, length: np.ndarray, shear: np.ndarray) -> "ShapeFunctions":
        """Of elements of a length and with shear numbers 12 EI / (kGA L^2), both (elements,)."""
        L, P = length[:, None], shear[:, None]
        one = np.ones_like(L)
        deflection = [
            1 - 3 * s**2 + 2 * s**3 + P * (1 - s),
            L * (s - 2 * s**2 + s**3 + P / 2 * (s - s**2)),
            3 * s**2 - 2 * s**3 + P * s,
            L * (s**3 - s**2 + P / 2 * (s**2 - s)),
        ]
        gradient = [
            (6 * s**2 - 6 * s - P) / L,
            1 - 4 * s + 3 * s**2 + P / 2 * (1 - 2 * s),
            (6 * s - 6 * s**2 + P) / L,
            3 * s**2 - 2 * s + P / 2 * (2 * s - 1),
        ]
        rotation = [
            6 / L * (s**2 - s),
            1 - 4 * s + 3 * s**2 + P * (1 - s),
            6 / L * (s - s**2),
            3 * s**2 - 2 * s + P * s,
        ]
        curvature = [
            6 / L**2 * (2 * s - 1),
            (6 * s - 4 - P) / L,
            6 / L**2 * (1 - 2 * s),
            (6 * s - 2 + P) / L,
        ]
        tables = (deflection, gradient, rotation, curvature)
        whole = 1 + P[:, :, None]
        return cls(*(np.stack([row * one for row in table], axis=1) / whole for table in tables))


@dataclass(frozen=True, eq=False)
class TimoshenkoBeam:
    """A beam along its nodes; properties by element, shape (elements,)."""

    nodes: np.ndarray  # (elements + 1,) [m]
    bending: np.ndarray  # E I [N m^2]
    shear: np.ndarray  # k G A [N]
    mass: np.ndarray  # per length [kg/m]
    rotary_inertia: np.ndarray  # rho I [kg m]

    @property
    def lengths(self) -> np.ndarray:
        """Of the elements [m]."""
        return np.diff(self.nodes)

    def shape_functions(self, s: np.ndarray) -> ShapeFunctions:
        """Of all elements at points s in [0, 1]."""
        return ShapeFunctions.at(s, self.lengths, 12 * self.bending / (self.shear * self.lengths**2))

    def matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """Return stiffness and consistent mass matrix over (w, theta) of all nodes in turn."""
        x, weight = _RULE
        shape = self.shape_functions((1 + x) / 2)
        weights = weight / 2 * self.lengths[:, None]
        sheared = shape.gradient - shape.rotation
        stiffness = _products(shape.curvature, weights * self.bending[:, None])
        stiffness += _products(sheared, weights * self.shear[:, None])
        mass = _products(shape.deflection, weights * self.mass[:, None])
        mass += _products(shape.rotation, weights * self.rotary_inertia[:, None])
        return _assembled(stiffness), _assembled(mass)

    def free_modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Return frequencies (m,) [rad/s] and mass-normalised modes (m, nodes, 2) that bend the free beam.

        Lowest first; w is above 0 at the first node.
        """
        if not count:
            return np.zeros(0), np.zeros((0, self.nodes.size, 2))
        rigid = 2
        stiffness, mass = self.matrices()
        from scipy.linalg import eigh  # a quarter of a second, which a rigid rack is spared

        squares, vectors = eigh(stiffness, mass, subset_by_index=[rigid, rigid + count - 1])
        modes = (vectors * np.sign(vectors[0])).T.reshape(count, -1, 2)
        return np.sqrt(squares), modes

    def derivatives(self, modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return w' and theta' of modes (m, nodes, 2) at the nodes (m, nodes), means of both sides."""
        shape = self.shape_functions(np.array([0.0, 1.0]))
        ends = np.concatenate([modes[:, :-1], modes[:, 1:]], axis=2)
        return (
            _joined(np.einsum("mea,eap->mep", ends, shape.gradient)),
            _joined(np.einsum("mea,eap->mep", ends, shape.curvature)),
        )


def _products(shape: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Integrals of the products of shape functions, (elements, 4, 4)."""
    return np.einsum("eap,ebp,ep->eab", shape, shape, weights)


def _assembled(matrices: np.ndarray) -> np.ndarray:
    """Sum of the elements' matrices over the coordinates of all nodes."""
    total = np.zeros((2 * len(matrices) + 2,) * 2)
    for i, matrix in enumerate(matrices):
        total[2 * i : 2 * i + 4, 2 * i : 2 * i + 4] += matrix
    return total


def _joined(ends: np.ndarray) -> np.ndarray:
    """Values at the nodes from those at the elements' ends (m, elements, 2): the mean of neighbours."""
    first, last = ends[:, :1, 0], ends[:, -1:, 1]
    return np.concatenate([first, (ends[:, :-1, 1] + ends[:, 1:, 0]) / 2, last], axis=1)


ELEMENTS = 64  # of equal length along the bar: frequencies of four modes per plane to 2e-4
PLANES = ("y", "z")


@dataclass(frozen=True)
class RackBeam:
    """Pieces of the bar between stations: plain, toothed, plain."""

    stations: tuple[float, ...]  # ends of the pieces [m], (pieces + 1)
    sections: tuple[BarSection, ...]  # of the pieces
    youngs_modulus: float  # [Pa]
    density: float  # [kg/m^3]

    @classmethod
    def of(cls, gear: SteeringGear) -> "RackBeam":
        bar = RackBar.of(gear)
        plain, toothed = plain_section(bar), toothed_section(bar)
        reach = bar.reach
        first, last = max(-reach, bar.x_min), min(reach, bar.x_max)
        stations = bar.x_min, first, last, bar.x_max
        return cls(stations, (plain, toothed, plain), gear.rack.youngs_modulus, gear.rack.density)

    @property
    def EI(self) -> np.ndarray:
        """Bending stiffness of the pieces in the planes y and z, shape (2, pieces) [N m^2]."""
        return self.youngs_modulus * np.array([section.second_moments for section in self.sections]).T

    @property
    def mass_per_length(self) -> np.ndarray:
        """Of the pieces, the teeth's included, shape (pieces,) [kg/m]."""
        return self.density * np.array([section.filled_area for section in self.sections])

    def elements(self, plane: int, count: int = ELEMENTS) -> TimoshenkoBeam:
        """The beam as equal elements in plane 0 (y) or 1 (z).

        An element that two pieces share has their mean compliance and their mean mass.
        """
        nodes = np.linspace(self.stations[0], self.stations[-1], count + 1)
        low = np.maximum(nodes[:-1, None], np.array(self.stations[:-1]))
        high = np.minimum(nodes[1:, None], np.array(self.stations[1:]))
        share = np.maximum(high - low, 0) / np.diff(nodes)[:, None]  # (elements, pieces)
        shear_modulus = self.youngs_modulus / (2 * (1 + POISSON_RATIO))
        shear_stiffness = shear_modulus * np.array([section.shear_area for section in self.sections])
        return TimoshenkoBeam(
            nodes,
            bending=1 / (share @ (1 / self.EI[plane])),
            shear=1 / (share @ (1 / shear_stiffness)),
            mass=share @ self.mass_per_length,
            rotary_inertia=share @ (self.density * self.EI[plane] / self.youngs_modulus),
        )

    def modes(self, per_plane: int) -> "RackModes":
        """The lowest free modes of each plane, those of plane y first; equal racks share them."""
        return _modes(self, per_plane)


@dataclass(frozen=True, eq=False)
class RackModes:
    """Mass-normalised free modes of the bar, sampled at equally spaced nodes for cubic Hermite interpolation.

    Deflection and rotation of the section are two functions: they differ by the shear angle. Each is given by
    its values and its derivatives at the nodes, shape (modes, nodes).
    """

    frequencies: np.ndarray  # (modes,) [rad/s]
    plane: np.ndarray  # (modes,) 0 = y, 1 = z
    nodes: np.ndarray  # (nodes,) stations along the bar [m]
    shape: np.ndarray  # deflection [1/sqrt(kg)]
    gradient: np.ndarray  # its derivative [1/(m sqrt(kg))]
    slope: np.ndarray  # rotation of the section
    curvature: np.ndarray  # its derivative

    @property
    def count(self) -> int:
        return len(self.frequencies)

    def at(self, station: float) -> np.ndarray:
        """Deflection, its derivative, rotation, its derivative of all modes at a station (4, modes)."""
        deflection = hermite(self.nodes, self.shape, self.gradient, station)
        return np.concatenate([deflection, hermite(self.nodes, self.slope, self.curvature, station)])


def hermite(nodes: np.ndarray, value: np.ndarray, derivative: np.ndarray, station: float) -> np.ndarray:
    """Interpolate rows of values (m, nodes) with their derivatives by cubics; value and derivative, (2, m).

    Beyond the first and the last node the line through the end goes on straight.
    """
    step = nodes[1] - nodes[0]
    inside = float(np.clip(station, nodes[0], nodes[-1]))
    i = min(int((inside - nodes[0]) / step), len(nodes) - 2)
    s = (inside - nodes[i]) / step
    values = np.array([1 - 3 * s**2 + 2 * s**3, 3 * s**2 - 2 * s**3])
    slopes = np.array([s - 2 * s**2 + s**3, s**3 - s**2]) * step
    rates = np.array([s**2 - s, s - s**2]) * 6 / step
    slope_rates = np.array([1 - 4 * s + 3 * s**2, 3 * s**2 - 2 * s])
    y, dy = value[:, i : i + 2], derivative[:, i : i + 2]
    rate = y @ rates + dy @ slope_rates
    return np.array([y @ values + dy @ slopes + rate * (station - inside), rate])


@lru_cache(maxsize=16)
def _modes(beam: RackBeam, per_plane: int) -> RackModes:
    planes = [beam.elements(plane) for plane in range(len(PLANES))]
    found = [elements.free_modes(per_plane) for elements in planes]
    derivatives = [elements.derivatives(modes) for elements, (_, modes) in zip(planes, found, strict=True)]
    return RackModes(
        frequencies=np.concatenate([frequencies for frequencies, _ in found]),
        plane=np.repeat(np.arange(len(PLANES)), per_plane),
        nodes=planes[0].nodes,
        shape=np.concatenate([modes[:, :, 0] for _, modes in found]),
        gradient=np.concatenate([gradient for gradient, _ in derivatives]),
        slope=np.concatenate([modes[:, :, 1] for _, modes in found]),
        curvature=np.concatenate([curvature for _, curvature in derivatives]),
    )
