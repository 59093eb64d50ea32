"""The summaries' figures that several scenes share."""

from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.rack_motion import describe_rack
from rps_exudyn.analysis.torque import describe_directions, describe_on_centre, describe_torque
from rps_exudyn.analysis.work_balance import describe_losses, energy_residual
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.scene_run import Signals


def figures_of_turning(signals: Signals, gear: SteeringGear, rack_gain: Any = None) -> dict[str, float]:
    """Return the figures of a pinion turned steadily: its torque, and what any gear in motion shows."""
    return {**figures_of_torque(signals, gear), **figures_of_motion(signals, gear, rack_gain)}


def figures_of_torque(signals: Signals, gear: SteeringGear) -> dict[str, float]:
    """Return the figures of the torque of a pinion turned steadily, the first way and both ways."""
    teeth, runs = gear.pinion.teeth, passes(signals)
    first = runs[0].signals
    return {
        **describe_torque(first["pinion_angle"], first["pinion_torque"], teeth),
        **describe_directions(runs),
        **describe_on_centre(runs, teeth, gear.test.centre_window),
    }


def figures_of_motion(signals: Signals, gear: SteeringGear, rack_gain: Any = None) -> dict[str, float]:
    """Return the figures of any gear in motion: its gain, how the rack moves in its guides, where the work
    goes; `rack_gain` as of `figures_of_rack`, by default the gear's."""
    return {
        **figures_of_rack(signals, float(GearPair.of(gear).gain) if rack_gain is None else rack_gain),
        **describe_losses(signals),
        **balance(signals),
    }


def figures_of_rack(signals: Signals, rack_gain: float | np.ndarray) -> dict[str, float]:
    """Return how the rack follows the pinion and moves in its guides; `rack_gain` is its travel per radian
    [m], a number or one for each of many gears."""
    runs = passes(signals)
    return {"rack_gain": gain(runs[0].signals), **describe_rack(signals, runs, rack_gain)}


def gain(signals: Signals) -> Any:
    """Return the displacement of the rack per revolution of the pinion over a record in one direction [m]."""
    angle, place = signals["pinion_angle"], signals["rack_displacement"]
    turned = angle[..., -1] - angle[..., 0]
    return (place[..., -1] - place[..., 0]) / turned * 2 * np.pi


def balance(signals: Signals) -> dict[str, float]:
    """Return the energy residual, of models that state what they store."""
    return {"energy_residual": energy_residual(signals)} if "stored_energy" in signals else {}
