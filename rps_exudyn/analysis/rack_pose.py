"""Where the rack was at each instant of a record: its reference point and its rotation."""

import numpy as np

from rps_exudyn.analysis.passes import Signals
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.rigid_motion import rotation_matrix
from rps_exudyn.gears.gear_pair import GearPair

NEEDED = ("rack_displacement", "rack_y", "rack_z", "rack_roll", "rack_yaw", "rack_pitch")


def rack_poses(pair: GearPair, signals: Signals) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return reference points (n, 3) [m], angles (n, 3) [rad], rotation matrices rack -> housing (n, 3, 3).

    Raises:
        InputError: the record lacks the rack's motions.
    """
    if missing := [name for name in NEEDED if name not in signals]:
        raise InputError(f"The result has no {missing[0]}; its fidelity leaves it out.")
    x = signals["rack_displacement"]
    angles = np.column_stack([signals[f"rack_{name}"] for name in ("roll", "yaw", "pitch")])
    turns = np.stack([rotation_matrix(each) for each in angles])
    along, rise, swing = turns[:, :, 0].T  # of the bar's axis, on which the reference point travels
    height = pair.bar_axis_height + signals["rack_y"] + x * rise / along
    return np.column_stack([x, height, signals["rack_z"] + x * swing / along]), angles, turns
