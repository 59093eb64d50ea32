"""How the teeth share their load over a record: line by line, tooth by tooth, point by point.

    loads = load_distribution(gear, signals)
    loads.force_of(side=-1, rack_tooth=0)     normal force of one line at every instant [N]

The loads are those of the gear's contact law at the recorded poses. "teeth" has the load along a line as
finite elements have it; "line" has it in proportion to the depth, right in sum but not in its course.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.curve import durations
from rps_exudyn.analysis.passes import Signals
from rps_exudyn.analysis.rack_motion import NEEDED, rack_poses
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS
from rps_exudyn.parameters.gear import SteeringGear, surfaces_of
from rps_exudyn.parameters.retired import has_lines, with_lines
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
        InputError: the record lacks the rack's motions, or the gear's contact has no load per length.
    """
    if given := surfaces_of(gear):
        raise InputError(f"{given[0]} is given: loads along lines of contact need flanks by parameters.")
    if not has_lines(law := gear.mesh.contact_law):
        raise InputError(
            f'mesh.law is "{law}", which has no load per length of line: choose "line" or "teeth".'
        )
    pair = GearPair.of(gear)
    points, tilts, _ = rack_poses(pair, signals)
    angle = np.asarray(signals["pinion_angle"])
    found = line_loads(-angle, points, tilts, loads_data(gear))
    load = found.load * _scale(found, signals)
    per_radius = np.cos(pair.beta_b) / found.roll
    pressure = np.sqrt(np.maximum(load, 0) * EFFECTIVE_MODULUS / np.pi * per_radius)
    return LoadDistribution(angle, *found._replace(load=load), pressure)


def _scale(stations: LineLoads, signals: Signals) -> np.ndarray:
    """Factors that give each side its recorded normal force, shape (k,).

    The run had fewer stations on a line, with which teeth are up to 4 % stiffer; its forces are right.
    """
    factors, forces = np.ones(stations.pose.size), stations.load * stations.length
    for side, name in ((-1, "mesh_normal_force_drive"), (+1, "mesh_normal_force_coast")):
        if name not in signals:
            continue
        chosen = stations.side == side
        instant = stations.pose[chosen]
        sums = np.bincount(instant, forces[chosen], minlength=len(signals[name]))
        ratio = np.divide(signals[name], sums, out=np.ones(len(sums)), where=sums > 0)
        factors[chosen] = ratio[instant]
    return factors


# --- What the teeth bear over a record, in three numbers

FACE_CELLS = 14  # in which the load along the face is counted
"""Cells of the face width: 1 mm each on the default gear, as short as two contacts are wide."""


def face_loading(gear: SteeringGear, signals: Signals) -> dict[str, float]:
    """Return how the more loaded flanks bear their load along the face, from the contact forces; {} where the
    record lacks the rack's motions or carries no load, or where the contact has no lines.

    face_load_factor       largest over mean load per face width, averaged over the record's time, which has
                           whole tooth pitches: K_H-beta of ISO 6336-1
    load_centre            Z of the mean load, from the middle of the face [m]
    contact_pressure_max   largest Hertzian pressure away from the lines' ends [Pa]
    """
    has_motions = {*NEEDED, "pinion_angle"} <= {*signals}
    if not has_motions or surfaces_of(gear) or not has_lines(gear.mesh.contact_law):
        return {}
    loads, pair = load_distribution(gear, signals), GearPair.of(gear)
    load = loads.load * loads.length * durations(signals["time"])[loads.instant]
    side = max((-1, +1), key=lambda each: float(load[loads.side == each].sum()))
    chosen = (loads.side == side) & (loads.load > 0)
    force, face = load[chosen], loads.face[chosen]
    if not force.size:
        return {}
    width = loads.length[chosen] * np.cos(pair.beta_b)  # of a station, along the face
    low = face - width / 2
    ends = np.linspace(-pair.face_width / 2, pair.face_width / 2, FACE_CELLS + 1)
    cells = np.diff([np.sum(force * np.clip((end - low) / width, 0.0, 1.0)) for end in ends])
    return {
        "face_load_factor": float(cells.max() / cells.mean()),
        "load_centre": float(np.sum(force * face) / force.sum()),
        "contact_pressure_max": float(np.max(loads.pressure, where=~at_ends(loads), initial=0.0)),
    }


def at_ends(loads: LoadDistribution) -> np.ndarray:
    """Return which stations stand within a contact's width of an end of their line, shape (k,).

    An edge presses there, and all along a line shorter than two widths: the plane strain of Hertz's line
    contact does not hold. So a line that is born at a tooth's corner, a tenth of a millimetre long, has no
    pressure.
    """
    line = np.stack([loads.instant, loads.side, loads.tooth])
    begins = np.flatnonzero(np.concatenate([[True], np.any(line[:, 1:] != line[:, :-1], axis=0)]))
    counts = np.diff(np.append(begins, line.shape[1]))
    reached = np.cumsum(loads.length)
    whole = np.repeat(np.add.reduceat(loads.length, begins), counts)
    place = reached - loads.length / 2 - np.repeat(reached[begins] - loads.length[begins], counts)
    width = np.divide(  # 2a, from p = 2 F' / (pi a)
        4 * loads.load, np.pi * loads.pressure, out=np.zeros(loads.load.size), where=loads.pressure > 0
    )
    return np.asarray(np.minimum(place, whole - place) <= width)


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
    points, tilts, turns = rack_poses(pair, signals)
    data = loads_data(with_lines(gear), STATIONS)
    angles = -np.asarray(signals["pinion_angle"])
    normals = {side: pair.rack_flank_normal(side) for side in (-1, +1)}
    if pair.course is not None:
        normals = {side: GeneratedRack.of(pair).plane(side, -angles).normal for side in (-1, +1)}

    def force(points: np.ndarray) -> np.ndarray:
        """Normal forces on the rack at every instant, shape (n, 3)."""
        loads = line_loads(angles, points, tilts, data)
        pressed = {side: loads.load * loads.length * (loads.side == side) for side in normals}
        sums = {side: np.bincount(loads.pose, pressed[side], angles.size) for side in normals}
        outward = sum(sums[side][:, None] * normals[side] for side in normals)
        return np.asarray(-np.einsum("nij,nj->ni", turns, outward))

    def slope(axis: int) -> np.ndarray:
        step = STEP * np.eye(3)[axis]
        return (force(points - step) - force(points + step))[:, axis] / (2 * STEP)

    return np.stack([slope(axis) for axis in (X, Y)], axis=-1)
