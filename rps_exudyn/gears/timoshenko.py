"""Timoshenko beams of straight elements, one plane: stiffness, mass, modes.

An element has two nodes with deflection w and rotation theta of the section, in the order (w, theta) at its
first and second node. Between them w is a cubic and theta a quadratic, those of a beam without distributed
load: w' - theta is constant, so that there is no shear locking and static deflections under loads at nodes
are exact (Przemieniecki 1968; shape functions as in Friedman and Kosmatka 1993).
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

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
        return cls(
            *(np.stack([row * one for row in table], axis=1) / (1 + P[:, :, None]) for table in tables)
        )


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
        """Return w' and theta' of modes (m, nodes, 2) at the nodes, (m, nodes): the mean of both sides where
        the section changes."""
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
