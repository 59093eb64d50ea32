"""Error bars: the numerical error of each metric, from the runs of two neighbouring levels of the ladder.

    bar = max(2 hypot(change, scatter), 0.2 % of the size, halved with each level above 1)

    change = max(|fine - coarse|,                           the metric's own
                 max over time |y_fine - y_coarse|,         of its signal, where one instant gives the metric
                 |metric(2 y_fine - y_coarse) - fine|,      of the record extrapolated to steps of no length
                 size * median of |fine - coarse| / size    over all metrics, halved)

The median, because two levels may agree by chance. The factor is fixed, no observed order: changes of two
pairs of levels have ratios from 1 to 6, a quarter of them below 1. Causes that both levels share, and so do
not show, are terms of `bar_terms`. Of many gears numbers are arrays (n,) and signals (n, t).
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from rps_exudyn.analysis.curve import pieces_of
from rps_exudyn.analysis.passes import signals_over_instants
from rps_exudyn.analysis.rack_motion import transmission_error
from rps_exudyn.results.quantities import INSTANTS, SCATTERS, SUMMARY, metric_sizes
from rps_exudyn.scenes.scene_run import Signals

FACTOR = 2.0  # times the change between two levels: covers 98 % where 1 covers 95 and 3 covers 99
FLOOR = 0.002  # of a metric's size at level 1: levels of smooth curves agree better than their models'
# tolerances, which halve with each level, and the floor with them
CHANCE = 0.5  # of the median change, by which every metric changes at least

Metrics = Callable[[Signals], Mapping[str, Any]]


def error_bars(
    metrics: Metrics,
    fine: Signals,
    values: Mapping[str, Any],
    coarse: Signals,
    coarse_values: Mapping[str, Any],
    *,
    curves: bool = True,
    floor: float = FLOOR,
) -> dict[str, Any]:
    """Return the half widths of the metrics' bars; inf of one that the coarser level lacks.

    Without `curves` signals are not compared instant by instant: where pulses shift in time, and where loads
    stand one after the other. The bar is at least `floor` of the metric's size.
    """
    size = metric_sizes(values, sizes(fine, values))
    own = {name: np.abs(values[name] - coarse_values.get(name, np.inf)) for name in size}
    change = dict(own)
    if curves and (moved := difference(fine, coarse)):
        # what lies between the coarse instants changes as they do
        extrapolated = metrics({**fine, **{name: fine[name] + each for name, each in moved.items()}})
        for name in size:
            largest = _largest_change(name, moved, values)
            shifted = np.abs(extrapolated.get(name, values[name]) - values[name])
            change[name] = np.fmax(change[name], np.fmax(largest, shifted))
    known = [each / size[name] for name, each in own.items() if np.all(np.isfinite(each))]
    usual = np.median(np.broadcast_arrays(*known), axis=0) if known else 0.0
    bars = {}
    for name in size:
        scatter = values.get(SCATTERS.get(name, ""), 0.0)
        each = np.fmax(change[name], CHANCE * usual * size[name])
        bars[name] = np.fmax(FACTOR * np.hypot(each, scatter), floor * size[name])
    return bars


def difference(fine: Signals, coarse: Signals) -> dict[str, np.ndarray]:
    """Return fine minus coarse signals at the instants of the fine record, (..., t). The coarse ones are
    interpolated on straight lines; {} of records that do not cover the same time."""
    pieces = [list(pieces_of(each["time"])) for each in (fine, coarse)]
    if len(pieces[0]) != len(pieces[1]):
        return {}
    both = [name for name in fine.keys() & coarse.keys() - {"time"} if fine[name].ndim == coarse[name].ndim]
    found: dict[str, list[np.ndarray]] = {name: [] for name in both}
    for own, other in zip(*pieces, strict=True):
        there, at = fine["time"][own], coarse["time"][other]
        if max(abs(there[0] - at[0]), abs(there[-1] - at[-1])) > np.diff(at).max(initial=0.0):
            return {}
        values = signals_over_instants(at, there, {name: fine[name][..., own] for name in both})
        moved = {name: each - coarse[name][..., other] for name, each in values.items()}
        for name, each in signals_over_instants(there, at, moved).items():
            found[name].append(each)
    return {name: np.concatenate(each, axis=-1) for name, each in found.items()}


def _largest_change(name: str, moved: Mapping[str, np.ndarray], values: Mapping[str, Any]) -> Any:
    """Return how far the signal of a metric that one instant gives changes at most; 0 of any other."""
    signal = INSTANTS.get(name, "")
    if signal == "transmission_error" and {"rack_displacement", "pinion_angle"} <= moved.keys():
        return np.abs(transmission_error(moved, values["rack_gain"] / (2 * np.pi))).max(axis=-1)
    return np.abs(moved[signal]).max(axis=-1) if signal in moved else 0.0


# --- Sizes of metrics: beside what a small number is judged

TORQUES = "torque_mean", "feel_running_torque", "torque_forward", "torque_jump", "breakaway_torque"
"""Metrics, the first of which that a run has is the size of its torque, unless rubbing teeth take more."""
RUBBING = 0.1  # coefficient of friction by which the force on the teeth gives a run its sizes


def sizes(signals: Signals, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the sizes of force, torque, work and stiffness in a record, by unit; of many gears (n,).

    They are what teeth with the coefficient of friction `RUBBING` would take under their mean normal force.
    A gear without friction has them too, while its mean torque is zero but for rounding.
    """
    size: dict[str, Any] = {}
    if {"mesh_normal_force", "rack_displacement", "pinion_angle"} <= {*signals}:
        force = RUBBING * np.abs(signals["mesh_normal_force"]).mean(axis=-1)
        travel, turned = (np.ptp(signals[name], axis=-1) for name in ("rack_displacement", "pinion_angle"))
        torque = force * travel / np.where(turned > 0, turned, np.inf)
        stiffness = torque / np.where(turned > 0, turned, np.inf)
        size = {"N": force, "N*m": torque, "J": force * travel, "N*m/rad": stiffness}
    torque = np.abs(next((values[name] for name in TORQUES if name in values), 0.0))
    return size | {"N*m": np.maximum(size.get("N*m", 0.0), torque)}


def size_of(name: str, value: Any, of_run: Mapping[str, Any]) -> Any:
    """Return the size of a metric: its value, or what is of interest beside the run's sizes."""
    item = SUMMARY[name]
    return item.size(value, of_run.get(item.unit, 0.0))
