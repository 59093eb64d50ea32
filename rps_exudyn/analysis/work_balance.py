"""Balance of work: what drive and load put in, what is lost at each place, and what is missing."""

from collections.abc import Mapping
from typing import Any

import numpy as np

NO_LOSS = ("work_drive", "work_load")
"""Signals of the work put in: by the drive, and by the forces on the rack's end or the input shaft."""

STORED_ENERGY = "stored_energy"
PLACES = {
    "mesh": ("work_mesh_friction", "work_mesh_damping", "work_mesh_edges"),
    "seat": ("work_seat_friction", "work_seat_damping"),
    "yokenut": ("work_yokenut_damping",),
    "bore": ("work_bore_friction", "work_bore_damping"),
    "bush": ("work_bush_friction",),
    "bearing": ("work_bearing_friction",),
    "support": ("work_support_friction",),
    "rack": ("work_rack_damping",),
    "column": ("work_column_damping",),
}
"""Place where work is lost -> its signals."""


def losses(signals: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Work lost over the whole record [J]; the names are those of the signals."""
    return {name: each for name, each in _changes(signals).items() if name not in (*NO_LOSS, STORED_ENERGY)}


def describe_losses(signals: Mapping[str, np.ndarray]) -> dict[str, float]:
    """The summary's loss fractions of all work lost; {} if none was, nan of such a gear among many."""
    lost = losses(signals)
    whole = np.asarray(sum(lost.values()))
    if not np.any(whole > 0):
        return {}
    whole, shares = np.where(whole > 0, whole, np.nan)[()], {}
    for place, names in PLACES.items():
        if present := [lost[name] for name in names if name in lost]:
            taken: Any = sum(present)
            if np.ndim(taken) and all(name.endswith("_damping") for name in names):
                # a gear among many that damps nothing: alone it has no such signal
                taken = np.where(np.equal(taken, 0.0), np.nan, taken)
            shares[f"loss_share_{place}"] = taken / whole
    return shares


def describe_balance(signals: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """The energy residual, (work of drive and load - work lost - change of stored energy) / `largest_work`:
    nan without work; {} of models that do not state what they store."""
    if STORED_ENERGY not in signals:
        return {}
    larger = np.asarray(largest_work(signals))
    return {"energy_residual": (missing_work(signals) / np.where(larger > 0, larger, np.nan))[()]}


def largest_work(signals: Mapping[str, np.ndarray]) -> Any:
    """The wider range of the drive's and the load's work [J]; 0 without any.

    A range, because what a load puts in and takes out again is work too.
    """
    ranges = [np.ptp(signals[name], axis=-1) for name in NO_LOSS if name in signals and signals[name].size]
    return np.max(ranges, axis=0) if ranges else 0.0


def missing_work(signals: Mapping[str, np.ndarray]) -> Any:
    """Work of drive and load that was neither lost nor stored [J]; 0 in a record without error."""
    changes = _changes(signals)
    given, stored = sum(changes.pop(name, 0.0) for name in NO_LOSS), changes.pop(STORED_ENERGY, 0.0)
    return given - sum(changes.values()) - stored


def _changes(signals: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Changes of works and of the stored energy (..., n) over the whole record, by their names."""
    counts = {
        name: each for name, each in signals.items() if name.startswith("work_") or name == STORED_ENERGY
    }
    return {name: each[..., -1] - each[..., 0] for name, each in counts.items() if each.size}


def integral_from_start(values: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Integrate values (..., n) from the first of some places (n,) to each by the trapezoidal rule."""
    whole = np.zeros(values.shape)
    np.cumsum(np.diff(place) * (values[..., 1:] + values[..., :-1]) / 2.0, axis=-1, out=whole[..., 1:])
    return whole
