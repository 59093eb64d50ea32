"""Integrals: Gauss rules, computed once per order, and over recorded instants."""

from functools import lru_cache
from math import gamma

import numpy as np


@lru_cache(maxsize=64)
def gauss_legendre(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes in [-1, 1] and weights of the Gauss-Legendre rule of n points, both (n,) and read-only."""
    x, w = np.polynomial.legendre.leggauss(n)
    x.flags.writeable = w.flags.writeable = False
    return x, w


@lru_cache(maxsize=64)
def gauss_jacobi(n: int, high: float, low: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes in [-1, 1] and weights of the rule for the weight function (1 - x)^high (1 + x)^low, both (n,).

    G. H. Golub, J. H. Welsch, Mathematics of Computation 23 (1969) 221: the nodes are the eigenvalues of the
    symmetric matrix of the polynomials' recurrence, the weights the squared first components of its vectors.
    """
    k = np.arange(n)
    j, total = k[1:], 2.0 * k[1:] + high + low
    mean = np.empty(n)
    mean[0] = (low - high) / (high + low + 2)
    mean[1:] = (low**2 - high**2) / (total * (total + 2))
    square = 4 * j * (j + high) * (j + low) * (j + high + low) / (total**2 * (total + 1) * (total - 1))
    beside = np.sqrt(square)
    x, vectors = np.linalg.eigh(np.diag(mean) + np.diag(beside, 1) + np.diag(beside, -1))
    whole = 2 ** (high + low + 1) * gamma(high + 1) * gamma(low + 1) / gamma(high + low + 2)
    w = whole * vectors[0] ** 2
    x.flags.writeable = w.flags.writeable = False
    return x, w


def integral_from_start(values: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Integrate values (..., n) from the first of some places (n,) to each of them by the trapezoidal
    rule."""
    whole = np.zeros(values.shape)
    np.cumsum(np.diff(place) * (values[..., 1:] + values[..., :-1]) / 2.0, axis=-1, out=whole[..., 1:])
    return whole
