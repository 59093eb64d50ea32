"""Whether equilibria must be closer together than asked for: their own record shows it.

A yoke that stops at its nut, or a tooth that takes over with a jerk, is over in a few degrees. Equilibria
cost so little that such a record is made again in half the steps instead of being refused. After each turn of
a swing the rack rolls over to its other side, and backward differences have its rate half a step late. Where
the yoke is at its nut, the force follows from how far teeth and nut yield, and teeth that bend need finer
strips.
"""

from collections.abc import Sequence

import numpy as np

from rps_exudyn.analysis.curve import every_second, missed
from rps_exudyn.analysis.work_balance import losses
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.after_run import driven_along, missed_mean, rolling_lag

MEAN = 0.01  # of the mean that may hide between the steps ...
ROLLING = 0.01  # ... or be moved by a late rate of rolling
ROLLING_OVER = 0.004  # ... in a swing, over its travel: its work is then right to a percent
SHRINKS = 0.8  # of what the steps miss there, half of them miss less, unless the rack vibrates
PEAK = 0.025  # of the mean by which a step may leave the curve through its neighbours: peaks are right to 4 %
FINEST = 16  # stations of a strip; more show nothing
FEW_STATIONS = 4  # of teeth that bend; three leave means up to 3 % off
STRIPS_AGREE = 0.005  # of the mean, between a record and that by strips of twice the stations


def rolls_over_late(signals: dict[str, np.ndarray], gear: SteeringGear) -> bool:
    """Return whether the steps of a swing are too long for how the rack rolls over in it."""
    roll = signals.get("rack_roll", np.zeros(1))
    return bool(np.isfinite(roll).all()) and rolls_late_by(signals, gear) > ROLLING_OVER


def rolls_late_by(signals: dict[str, np.ndarray], gear: SteeringGear) -> float:
    """Return by how much the steps of a swing miss the rate of the rack's rolling, over its travel."""
    return rolling_lag(signals, gear)[0]


def vibrates(late: Sequence[float]) -> bool:
    """Return whether the rack vibrates in a swing, which longer steps damp: half the steps miss no less of
    its rolling; of one run after the other what `rolls_late_by` gives."""
    return len(late) > 1 and late[-1] > max(ROLLING_OVER, SHRINKS * late[-2])


def needs_finer(signals: dict[str, np.ndarray], gear: SteeringGear) -> bool:
    """Return whether the steps of a steady motion's record are too long for its mean or its peaks."""
    if not np.isfinite(np.concatenate(list(signals.values()))).all():
        return False
    force, path = driven_along(signals)
    size = force_size(signals, np.mean(force), path)
    return bool(
        missed_mean(signals) > MEAN
        or rolling_lag(signals, gear)[1] > ROLLING
        or (size > 0 and missed(path, force).max(initial=0.0) > PEAK * size)
    )


def force_size(signals: dict[str, np.ndarray], mean: np.ndarray, path: np.ndarray) -> np.ndarray:
    """Return the size (...) of a drive's torque or force: its mean (...), or that of friction over the path
    (..., n), of which a weight may leave little to the drive."""
    return np.maximum(np.abs(mean), sum(losses(signals).values()) / np.ptp(path, axis=-1))


def yoke_stops(signals: dict[str, np.ndarray]) -> bool:
    """Return whether the yoke meets its nut: forces then depend on the rack's place to a few micrometres,
    and so on how it rolled before the record."""
    return bool((signals.get("yokenut_force", np.zeros(1)) > 0).any())


def finer_strips(fidelity: Fidelity, gear: SteeringGear) -> Fidelity | None:
    """Return the model with strips of twice the stations; None where nothing finer is known, or the law loads
    each place of a strip by itself, which few stations integrate."""
    if gear.mesh.contact_law != "teeth" or fidelity.mesh != "flank" or fidelity.strip_stations >= FINEST:
        return None
    return doubled_stations(fidelity)


def coarse_strips(signals: dict[str, np.ndarray], fidelity: Fidelity, gear: SteeringGear) -> bool:
    """Return whether strips of twice the stations may move the mean of a record by a percent: where they are
    few, or where the yoke is at its nut."""
    return finer_strips(fidelity, gear) is not None and (
        fidelity.strip_stations < FEW_STATIONS or yoke_stops(signals)
    )


def doubled_stations(fidelity: Fidelity, times: int = 1) -> Fidelity:
    """Return the model with stations of a strip doubled so many times, up to the finest."""
    return fidelity.replace({"strip_stations": min(FINEST, fidelity.strip_stations * 2**times)})


def strips_change(coarse: dict[str, np.ndarray], fine: dict[str, np.ndarray]) -> float:
    """Return by which share finer strips move the mean of the drive's torque or force over a record."""
    (work, _), (right, _) = (every_second(*driven_along(each)[::-1]) for each in (coarse, fine))
    return float(abs(work - right) / abs(right)) if right else float(work != 0) * np.inf
