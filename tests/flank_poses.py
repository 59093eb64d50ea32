"""Poses of the default gear near the aligned one, and how much two evaluators of a contact differ.

Pressed by 10 um, with the rack turned by up to 1 mrad: what the teeth see in use.
"""

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.wrench import NORMAL_COAST, NORMAL_DRIVE
from verification.law_area import by_law

PAPER = by_law(SteeringGear(), "area")
ZONE = 1e-5  # [m/s], far below all sliding here
PRESS = 10e-6  # of the rack into the mesh [m]
FINE = 640  # generators of the reference integral
ANGLES = np.linspace(0, 1.0, 9)  # one tooth pitch is 2 pi / 6
POSES: dict[str, dict[str, Any]] = {
    "aligned": {},
    "rolled": {"turn": (1e-3, 0, 0)},
    "skewed": {"turn": (2e-4, 3e-4, -2e-4), "press": 12e-6},
}


def state(gear: SteeringGear, angle: float, press: float = PRESS, turn: tuple[float, ...] = (0, 0, 0)) -> Any:
    """A kernel's arguments at steering angle `angle`: the rack where it belongs, pressed and turned."""
    pair = GearPair.of(gear)
    rotation = Rotation.from_rotvec(turn).as_matrix()
    to_mesh = np.array([0, pair.reference_radius - pair.bar_axis_height, 0])
    position = np.array([pair.gain * angle, pair.bar_axis_height - press, 0]) + to_mesh - rotation @ to_mesh
    return -angle, -1.0, position, rotation, np.array([pair.gain, 0, 0]), np.zeros(3)


def changed(**settings: object) -> SteeringGear:
    return PAPER.replace({path.replace("__", "."): value for path, value in settings.items()})


def difference(a: np.ndarray, b: np.ndarray, gear: SteeringGear) -> float:
    """Largest difference of torque, force and moment over the sum of normal forces (and base radius)."""
    normal = b[NORMAL_DRIVE] + b[NORMAL_COAST]
    lengths = np.array([1, 0, 0, 0, 1, 1, 1]) * GearPair.of(gear).base_radius
    return float(np.max(np.abs(a - b)[:7] / (normal * np.where(lengths > 0, lengths, 1.0))))
