"""Whether the steps of a record show how large its signal becomes between them.

Vibration that nothing damps, and peaks narrower than a few steps, leave a record whose mean is right and
whose largest and smallest values are not. It shows: values do not lie on a smooth curve through their
neighbours. Implicit time steps show vibration faster than themselves as a zigzag from step to step, so that
none hides as a slow one.
"""

import numpy as np

LEAST_FOR_PEAKS = 12  # points in a tooth pitch: 8 went past a dip over a seventh of it, 5 % of the mean
UNRESOLVED = 0.03  # of the mean; below that the ripples of random gears are right to 4 % of it


def missed(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance of each value from the cubic through its four neighbours; 0 at the two ends each way.

    x of shape (n,), strictly monotone, y of shape (..., n).
    """
    distance = np.zeros(y.shape)
    at = x[2:-2]
    nodes = [x[:-4], x[1:-3], x[3:-1], x[4:]]
    values = [y[..., :-4], y[..., 1:-3], y[..., 3:-1], y[..., 4:]]
    cubic = np.zeros(y[..., 2:-2].shape)
    for i, value in enumerate(values):
        weight = np.ones(len(at))
        for j, node in enumerate(nodes):
            if j != i:
                weight *= (at - node) / (nodes[i] - node)
        cubic += weight * value
    distance[..., 2:-2] = np.abs(y[..., 2:-2] - cubic)
    return distance


def every_second(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Integral of y (..., n) over x (n,), and by how much that over every second step differs, (...) each."""
    even = (x.size - 1) // 2 * 2 + 1
    whole = np.trapezoid(y[..., :even], x[:even])
    return whole, np.abs(whole - np.trapezoid(y[..., :even:2], x[:even:2]))


def lag(x: np.ndarray, values: np.ndarray) -> np.ndarray:
    """What backward differences, half a step late, miss of the way that values (..., n) make, (...).

    x (n,) is time or an angle turned steadily, strictly monotone, in steps of any length.
    """
    steps = np.diff(x)
    rates = np.diff(values) / steps
    return np.asarray(np.abs(np.diff(rates) * steps[1:]).sum(axis=-1) / 2)


def unresolved(x: np.ndarray, y: np.ndarray) -> float:
    """Return the largest distance from such cubics over the mean size of the values; 0 for values of 0."""
    size = abs(float(np.mean(y)))
    return float(missed(x, y).max(initial=0.0)) / size if size else 0.0
