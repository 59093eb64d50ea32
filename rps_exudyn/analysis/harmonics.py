"""Orders of a curve over the pinion angle: amplitudes of its harmonics, in periods per revolution.

The curve is interpolated linearly to even angles over whole periods, so that sums are integrals and nothing
leaks from one order into the next.
"""

from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import over_instants

LEAST_PER_PERIOD = 6  # recorded points that a period needs to be resolved
EVEN_PER_PERIOD = 128  # even angles in a period, at least
ROUNDING = 1e-6  # of a period that may be missing: a free pinion turns on by what its rack does


def order_amplitude(angle: np.ndarray, values: np.ndarray, order: int) -> Any:
    """Amplitude of the harmonic `order` times per revolution; None if no whole period was recorded.

    `values` are of shape (..., n); angles that differ from gear to gear too, and the amplitude is nan where
    a gear turned less than a period.
    `order` = number of teeth gives the tooth order, for which a tooth pitch is enough; 1 the first order.
    """
    if angle.ndim > 1:
        each = [order_amplitude(*pair, order) for pair in zip(angle, values, strict=True)]
        return np.array([np.nan if amplitude is None else amplitude for amplitude in each])
    found = harmonics(angle, values, 2 * np.pi / order, 1)
    return None if found is None else abs(found[1])


def harmonics(angle: np.ndarray, values: np.ndarray, period: float, highest: int) -> np.ndarray | None:
    """Complex c_k with values ~ Re sum c_k exp(2 pi i k angle / period), k = 0 .. highest; (highest + 1, ...)
    of values (..., n); None without a whole period. Angles [rad] rise or fall, shape (n,)."""
    whole = int(abs(angle[-1] - angle[0]) / period * (1 + ROUNDING)) if len(angle) > 1 else 0
    if whole == 0:
        return None
    recorded = int(len(angle) * period / abs(angle[-1] - angle[0]))
    per_period = max(EVEN_PER_PERIOD, 16 * highest, 2 * recorded)
    sense = np.sign(angle[-1] - angle[0])
    even = angle[0] + sense * period / per_period * np.arange(per_period * whole)
    rising = slice(None) if sense > 0 else slice(None, None, -1)
    at_even = over_instants(even, angle[rising], values[..., rising])
    mean_period = at_even.reshape(*values.shape[:-1], whole, per_period).mean(axis=-2)
    k = np.arange(highest + 1)
    turned = np.exp(-2j * np.pi / period * np.outer(k, even[:per_period]))
    summed = (mean_period[..., None, :] * turned).sum(axis=-1)  # rounded alike for one gear and for many
    found = np.where(k == 0, 1, 2) * summed / per_period
    return np.asarray(np.moveaxis(found, -1, 0))
