"""Latin hypercubes: random points that are even along every axis."""

import numpy as np


def latin_hypercube(rng: np.random.Generator, samples: int, axes: int) -> np.ndarray:
    """Points in the unit cube, one in each of `samples` slices of every axis, shape (samples, axes).

    They are those of scipy's `qmc.LatinHypercube`, which takes a second to load.
    """
    (rng,) = rng.spawn(1)
    within = rng.uniform(size=(samples, axes))
    slices = np.tile(np.arange(1, samples + 1), (axes, 1))
    for row in slices:
        rng.shuffle(row)
    return np.asarray((slices.T - within) / samples)
