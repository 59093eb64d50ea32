"""Stiffness of the mesh at each instant of a record: force on the rack per displacement of the rack.

By central differences of the contact without friction, at the recorded poses. The standard's stiffness
(`gears.tooth_stiffness`) is one number for a pair of teeth; this is what the law makes of all of them.
"""

import numpy as np

from rps_exudyn.analysis.passes import Signals
from rps_exudyn.analysis.rack_pose import rack_poses
from rps_exudyn.base.compiled import called
from rps_exudyn.forces.rigid_motion import rotation_matrix
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.line_loads import line_loads, loads_data
from rps_exudyn.parameters.gear import SteeringGear

STEP = 1e-8  # of the rack [m]
STATIONS = 6  # along each line
X, Y = 0, 1  # in the housing


def mesh_stiffness(gear: SteeringGear, signals: Signals) -> np.ndarray:
    """Return the stiffness against displacements of the rack along X and along Y, shape (n, 2) [N/m].

    Raises:
        InputError: the record lacks the rack's motions.
    """
    pair = GearPair.of(gear)
    points, tilts, _ = rack_poses(pair, signals)
    data = loads_data(gear if gear.mesh.law != "area" else gear.replace({"mesh.law": "line"}), STATIONS)
    normals = {side: pair.rack_flank_normal(side) for side in (-1, +1)}

    def force(angle: float, point: np.ndarray, tilt: np.ndarray) -> np.ndarray:
        """Normal forces on the rack, shape (3,)."""
        loads = called(line_loads, angle, point, tilt, data)
        pressed = loads.load * loads.length
        outward = sum(normals[side] * pressed[loads.side == side].sum() for side in normals)
        return np.asarray(-rotation_matrix(tilt) @ outward)

    def slope(angle: float, point: np.ndarray, tilt: np.ndarray, axis: int) -> float:
        step = np.zeros(3)
        step[axis] = STEP
        there, beyond = force(angle, point - step, tilt), force(angle, point + step, tilt)
        return float(there[axis] - beyond[axis]) / (2 * STEP)

    poses = zip(-np.asarray(signals["pinion_angle"]), points, tilts, strict=True)
    return np.array([[slope(*pose, axis) for axis in (X, Y)] for pose in poses])
