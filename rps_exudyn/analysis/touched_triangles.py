"""Where two triangulated surfaces touch over a record: the pinion's triangles, and their largest loads.

The poses are those of one tooth pitch, in which each pair of flanks that carries is seen.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.contact_pattern import one_pitch
from rps_exudyn.analysis.passes import Signals
from rps_exudyn.analysis.rack_motion import rack_poses
from rps_exudyn.gears.export import turned
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.mesh_loads import mesh_loads
from rps_exudyn.tooth_contact.triangles import own_meshes, triangles_of

POSES = 24  # in a tooth pitch


@dataclass(frozen=True, eq=False)
class TouchedTriangles:
    """Triangles that carry a load in at least one pose."""

    on_pinion: np.ndarray  # corners in the pinion's frame, runout included, shape (n, 3, 3) [m]
    load: np.ndarray  # largest normal force of each, shape (n,) [N]
    # corners in the rack's frame, of each pose in which a triangle carries, shape (m, 3, 3) [m]
    on_rack: np.ndarray
    load_on_rack: np.ndarray  # normal force there, shape (m,) [N]
    turn: np.ndarray  # rotation of the pinion's frame into the housing in the middle pose, shape (3, 3)


def touched_triangles(gear: SteeringGear, fidelity: Fidelity, signals: Signals) -> TouchedTriangles:
    """Return the triangles that touch over the middle tooth pitch of a record in one direction.

    Raises:
        InputError: a record without the rack's motions, or surfaces that cannot be used.
    """
    pair, pitch = GearPair.of(gear), one_pitch(signals, gear.pinion.teeth)
    chosen = np.unique(np.linspace(0, len(pitch["pinion_angle"]) - 1, POSES).astype(int))
    some = {name: each[chosen] for name, each in pitch.items()}
    points, _, turns = rack_poses(pair, some)
    meshes = own_meshes(gear, fidelity.chord_error)
    record, pool = triangles_of(gear, fidelity, 1.0, 0, meshes)
    load = mesh_loads(-some["pinion_angle"], points, turns, record, pool)
    corners = meshes.triangles[:, :9].reshape(-1, 3, 3) + pair.eccentricity
    pose, number = np.nonzero(load)
    frames = np.array([pair.pinion_frame @ turned(angle) for angle in some["pinion_angle"]])
    in_housing = np.einsum("nij,nkj->nki", frames[pose], corners[number]) + pair.pinion_origin
    on_rack = np.einsum("nji,nkj->nki", turns[pose], in_housing - points[pose, None])
    carries = load.any(axis=0)
    largest, middle = load[:, carries].max(axis=0), frames[len(frames) // 2]
    return TouchedTriangles(corners[carries], largest, on_rack, load[pose, number], middle)
