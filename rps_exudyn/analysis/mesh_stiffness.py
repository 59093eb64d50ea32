"""Stiffness of the mesh at each instant of a record: force on the rack per displacement of the rack.

By central differences of the contact without friction, at the recorded poses. The standard's stiffness
(`gears.tooth_stiffness`) is one number for a pair of teeth; this is what the law makes of all of them.
"""

import numpy as np

from rps_exudyn.analysis.passes import Signals
from rps_exudyn.analysis.rack_pose import rack_poses
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_element import flank_element
from rps_exudyn.parameters.gear import SteeringGear

STEP = 1e-8  # of the rack [m]
STATIONS = 6  # along each line
X, Y = 1, 2  # of the coordinates pinion (1), rack (6)


def mesh_stiffness(gear: SteeringGear, signals: Signals) -> np.ndarray:
    """Return the stiffness against displacements of the rack along X and along Y, shape (n, 2) [N/m].

    Raises:
        InputError: the record lacks the rack's motions.
    """
    pair = GearPair.of(gear)
    points, tilts, _ = rack_poses(pair, signals)
    ideal = gear.replace({"mesh.friction": 0.0})
    element = flank_element(ideal, friction_zone=1e-5, along=STATIONS, across=2)
    moved = points - [0.0, pair.bar_axis_height, 0.0]
    poses = np.column_stack([-np.asarray(signals["pinion_angle"]), moved, tilts])
    return np.array([[_stiffness(element.kernel, q, axis, element.data) for axis in (X, Y)] for q in poses])


def _stiffness(kernel, q: np.ndarray, axis: int, data) -> float:  # type: ignore[no-untyped-def]
    step = np.zeros(q.size)
    step[axis] = STEP
    still = np.zeros(q.size)
    return float(kernel(q - step, still, data)[axis] - kernel(q + step, still, data)[axis]) / (2 * STEP)
