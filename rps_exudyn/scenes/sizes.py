"""Sizes of metrics: beside what a small number is judged."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.scenes.scene_run import Signals

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
