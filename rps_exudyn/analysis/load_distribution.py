"""How the teeth share their load over a record: line by line, tooth by tooth, point by point.

    loads = load_distribution(gear, signals)
    loads.force_of(side=-1, rack_tooth=0)     normal force of one line at every instant [N]

The loads are those of the gear's contact law at the recorded poses. "teeth" has the load along a line as
finite elements have it; "line" has it in proportion to the depth, right in sum but not in its course.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.passes import Signals
from rps_exudyn.analysis.rack_motion import rack_poses
from rps_exudyn.base.compiled import called
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.rigid_motion import rotation_matrix
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.line_loads import LineLoads, line_loads, loads_data

Line = tuple[int, int]  # side (-1 drives the rack towards +X), number of the rack's tooth


@dataclass(frozen=True, eq=False)
class LoadDistribution:
    """The loads of a record; arrays of shape (k,) over all stations of all instants."""

    angle: np.ndarray  # pinion angle of each instant, shape (n,) [rad]
    instant: np.ndarray  # number of the instant of each station
    side: np.ndarray
    tooth: np.ndarray
    rack_tooth: np.ndarray
    face: np.ndarray  # [m]
    roll: np.ndarray  # [m]
    length: np.ndarray  # [m]
    load: np.ndarray  # per length [N/m]
    pressure: np.ndarray  # Hertz's [Pa]

    @property
    def lines(self) -> list[Line]:
        """Lines that carry a load at some instant: side and number of the rack's tooth."""
        loaded = self.load > 0
        return sorted(
            {(int(s), int(j)) for s, j in zip(self.side[loaded], self.rack_tooth[loaded], strict=True)}
        )

    def force_of(self, side: int, rack_tooth: int) -> np.ndarray:
        """Return the normal force of one line at every instant, shape (n,) [N]."""
        return self._sum((self.side == side) & (self.rack_tooth == rack_tooth))

    def force_on(self, side: int) -> np.ndarray:
        """Return the normal force of all lines of one side at every instant, shape (n,) [N]."""
        return self._sum(self.side == side)

    def _sum(self, chosen: np.ndarray) -> np.ndarray:
        forces = self.load[chosen] * self.length[chosen]
        return np.bincount(self.instant[chosen], forces, minlength=self.angle.size)

    def largest_share(self, side: int) -> np.ndarray:
        """Return the largest part of one side's load on a single tooth, shape (n,); nan where none is."""
        whole = self.force_on(side)
        parts = [np.zeros_like(whole), *(self.force_of(*line) for line in self.lines if line[0] == side)]
        return np.asarray(np.max(parts, axis=0) / np.where(whole > 0, whole, np.nan))


def load_distribution(gear: SteeringGear, signals: Signals) -> LoadDistribution:
    """Return the loads at every instant of a record.

    Raises:
        InputError: the record lacks the rack's motions, or the gear's contact law has no load per length.
    """
    if gear.mesh.contact_law == "area":
        raise InputError(
            'mesh.law is "area", which has no load per length of line: choose "line" or "teeth".'
        )
    pair = GearPair.of(gear)
    points, tilts, _ = rack_poses(pair, signals)
    handle, angle = loads_data(gear), np.asarray(signals["pinion_angle"])
    poses = [
        called(line_loads, -a, point, tilt, handle)
        for a, point, tilt in zip(angle, points, tilts, strict=True)
    ]
    instant = np.repeat(np.arange(angle.size), [pose.load.size for pose in poses])
    all_of = {name: np.concatenate([getattr(pose, name) for pose in poses]) for name in LineLoads._fields}
    all_of["load"] *= _scale(all_of, instant, signals)
    per_radius = np.cos(pair.beta_b) / all_of["roll"]
    pressure = np.sqrt(all_of["load"] * EFFECTIVE_MODULUS / np.pi * per_radius)
    return LoadDistribution(angle, instant, **all_of, pressure=pressure)


def _scale(stations: dict[str, np.ndarray], instant: np.ndarray, signals: Signals) -> np.ndarray:
    """Factors that give each side its recorded normal force, shape (k,).

    The run had fewer stations on a line, with which teeth are up to 4 % stiffer; its forces are right.
    """
    factors, forces = np.ones(instant.size), stations["load"] * stations["length"]
    for side, name in ((-1, "mesh_normal_force_drive"), (+1, "mesh_normal_force_coast")):
        if name not in signals:
            continue
        chosen = stations["side"] == side
        sums = np.bincount(instant[chosen], forces[chosen], minlength=len(signals[name]))
        ratio = np.divide(signals[name], sums, out=np.ones(len(sums)), where=sums > 0)
        factors[chosen] = ratio[instant[chosen]]
    return factors


# --- Stiffness of the mesh at each instant of a record: force on the rack per displacement of the rack
#
# By central differences of the contact without friction, at the recorded poses. The standard's stiffness
# (`gears.tooth_stiffness`) is one number for a pair of teeth; this is what the law makes of all of them.

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
    data = loads_data(
        gear if gear.mesh.contact_law != "area" else gear.replace({"mesh.law": "line"}), STATIONS
    )
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
