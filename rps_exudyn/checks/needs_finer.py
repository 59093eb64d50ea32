"""Whether equilibria must be closer together than asked for: their own record tells it.

A yoke that stops at its nut, or a tooth that takes over with a jerk, is over in a few degrees. Equilibria
cost so little that such a record is made again in half the steps instead of being refused. After each turn of
a swing the rack rolls over to its other side, and knows the rate of that half a step late.
"""

import numpy as np

from rps_exudyn.analysis.resolution import unresolved
from rps_exudyn.checks.after_run import driven_along, missed_mean, rolling_lag
from rps_exudyn.parameters.gear import SteeringGear

MEAN = 0.01  # of the mean that may hide between the steps ...
ROLLING = 0.01  # ... or be moved by a late rate of rolling
ROLLING_OVER = 0.004  # ... in a swing, over its travel: its work is then right to a percent
PEAK = 0.05  # of the mean by which a step may leave the curve through its neighbours: peaks are right to 5 %


def rolls_over_late(signals: dict[str, np.ndarray], gear: SteeringGear) -> bool:
    """Tell whether the steps of a swing are too long for how the rack rolls over in it."""
    roll = signals.get("rack_roll", np.zeros(1))
    return bool(np.isfinite(roll).all()) and rolling_lag(signals, gear)[0] > ROLLING_OVER


def needs_finer(signals: dict[str, np.ndarray], gear: SteeringGear) -> bool:
    """Tell whether the steps of a steady motion's record are too long for its mean or its peaks."""
    if not np.isfinite(np.concatenate(list(signals.values()))).all():
        return False
    force, path = driven_along(signals)
    return bool(
        missed_mean(signals) > MEAN
        or rolling_lag(signals, gear)[1] > ROLLING
        or unresolved(path, force) > PEAK
    )
