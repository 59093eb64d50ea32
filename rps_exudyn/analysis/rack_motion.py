"""Motion of the rack besides its travel: transmission error, lift, roll, yaw; and the yoke's force on it."""

from collections.abc import Callable, Sequence

import numpy as np

from rps_exudyn.analysis.harmonics import order_amplitude
from rps_exudyn.analysis.passes import Pass, Signals
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.rigid_motion import fill_rotation
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.results.quantities import INSTANTS

RANGES = {name: signal for name, signal in INSTANTS.items() if name.endswith("_range")}
"""Metric -> the motion of which it is the range."""


Gain = float | np.ndarray | Callable[[np.ndarray], np.ndarray]
"""Rack travel per radian [m]: a number, one for each gear; or the travel as a function of the angle."""


def transmission_error(signals: Signals, gain: Gain) -> np.ndarray:
    """Rack displacement minus its travel by `gain`, from the mean, shape (..., n) [m]."""
    angle = signals["pinion_angle"]
    travel = gain(angle) if callable(gain) else np.asarray(gain)[..., None] * angle
    error = signals["rack_displacement"] - travel
    return np.asarray(error - error.mean(axis=-1, keepdims=True) if error.size else error)


def describe_rack(signals: Signals, runs: Sequence[Pass], gain: Gain) -> dict[str, float]:
    """Metrics of the motions of a record with these passes; `gain` is rack travel per radian [m].

    The transmission error is the larger of those in the two directions: the difference between directions is
    lost motion, see `hysteresis`.
    """
    metrics, ranges, orders = {}, [], []
    for each in runs:
        motion = each.signals
        error = transmission_error(motion, gain)
        ranges.append(np.ptp(error, axis=-1))
        orders.append(order_amplitude(motion["pinion_angle"], error, 1))
    if ranges:
        metrics["transmission_error_peak_to_peak"] = np.max(ranges, axis=0)
    if known := [amplitude for amplitude in orders if amplitude is not None]:
        metrics["transmission_error_first_order"] = np.max(known, axis=0)
    metrics |= {name: np.ptp(signals[of], axis=-1) for name, of in RANGES.items() if of in signals}
    if "seat_force" in signals:
        metrics["yoke_force_min"] = signals["seat_force"].min(axis=-1)
        metrics["yoke_force_max"] = signals["seat_force"].max(axis=-1)
    return metrics


# --- Where the rack was at each instant of a record: its reference point and its rotation

NEEDED = ("rack_displacement", "rack_y", "rack_z", "rack_roll", "rack_yaw", "rack_pitch")


def rack_poses(pair: GearPair, signals: Signals) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return reference points (n, 3) [m], angles (n, 3) [rad], rotation matrices rack -> housing (n, 3, 3).

    Raises:
        InputError: the record lacks the rack's motions.
    """
    if missing := [name for name in NEEDED if name not in signals]:
        raise InputError(f"The result has no {missing[0]}: not computed by this model.")
    x = signals["rack_displacement"]
    angles = np.column_stack([signals[f"rack_{name}"] for name in ("roll", "yaw", "pitch")])
    turns = np.empty((3, 3, x.size))
    fill_rotation.py_func(angles.T, turns)
    turns = np.ascontiguousarray(np.moveaxis(turns, -1, 0))
    along, rise, swing = turns[:, :, 0].T  # of the bar's axis, on which the reference point travels
    height = pair.bar_axis_height + signals["rack_y"] + x * rise / along
    return np.column_stack([x, height, signals["rack_z"] + x * swing / along]), angles, turns
