"""Loads along the lines of contact, by stations, as the laws "line" and "teeth" have them."""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, kernel
from rps_exudyn.forces.rigid_motion import fill_rotation
from rps_exudyn.gears.tooth_stiffness import HERTZ
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.elastic_teeth import GUESS, compliance_matrix
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.flank_line import side_of
from rps_exudyn.tooth_contact.laws import MESH
from rps_exudyn.tooth_contact.teeth_data import teeth_data
from rps_exudyn.tooth_contact.teeth_stations import DEPTH, LENGTH, P_Z, ROLL, TOP, find_lines
from rps_exudyn.tooth_contact.unilateral import press_stations

STATIONS = 12  # on each line: loads vary along it


class LineLoads(NamedTuple):
    """The stations of all poses, arrays of shape (k,)."""

    pose: np.ndarray  # its number
    side: np.ndarray  # -1 drives the rack towards +X, +1 towards -X
    tooth: np.ndarray  # of the pinion
    rack_tooth: np.ndarray  # numbers fall to either side of the rack's middle
    face: np.ndarray  # Z on the pinion's face [m]
    roll: np.ndarray  # tangent length q on the pinion's flank [m]
    length: np.ndarray  # of line that the station stands for [m]
    load: np.ndarray  # per length [N/m]


ROWS = len(LineLoads._fields) - 1  # in which the kernel keeps all fields but the pose, in their order


def loads_data(gear: SteeringGear, stations: int = STATIONS) -> np.ndarray:
    """Return the record of `line_loads` for a gear, by its law and so many stations on a segment of a line,
    in an array (1,)."""
    flank = pack(gear, along=stations, across=1)
    made = np.zeros(1, MESH)
    made["flank"], made["teeth"] = flank, teeth_data(gear, flank)
    return made


@kernel
def line_loads(angles, positions, tilts, records):  # type: ignore[no-untyped-def]
    """Return `LineLoads` of n poses at rest; pinion's turns (n,) [rad], rack's reference points (n, 3) [m],
    angles (n, 3) [rad], the record of `loads_data`."""
    data = records[0]
    still, flank, rotation = np.zeros(3), data.flank, np.empty((3, 3))
    counts, end = np.zeros(angles.size, np.int64), 0
    rows = np.empty((ROWS, 0))  # with room for more stations
    for i in range(angles.size):
        angle, position = angles[i], positions[i]
        fill_rotation(tilts[i], rotation)
        drive = side_of(-1.0, angle, 0.0, position, rotation, still, still, flank)
        coast = side_of(1.0, angle, 0.0, position, rotation, still, still, flank)
        lines, found = find_lines(angle, drive, coast, data)
        start, counts[i] = end, found * flank.stations
        end = start + counts[i]
        if end > rows.shape[1]:
            filled, rows = rows[:, :start], np.empty((ROWS, 2 * end))
            rows[:, :start] = filled
        _fill_loads(lines, found, data, rows[:, start:end])
    side, tooth, rack_tooth, face = rows[0, :end], rows[1, :end], rows[2, :end], rows[3, :end]
    pose = np.repeat(np.arange(angles.size), counts)
    return LineLoads(pose, side, tooth, rack_tooth, face, rows[4, :end], rows[5, :end], rows[6, :end])


@inline
def _fill_loads(lines, found, data, rows):  # type: ignore[no-untyped-def]
    """Fill the rows of one pose, on whose `found` lines all its stations stand."""
    flank, stations, n = data.flank, lines.stations, rows.shape[1]
    for i in range(n):
        line = i // flank.stations
        rows[0, i], rows[1, i], rows[2, i] = lines.side[line], lines.tooth[line], lines.rack_tooth[line]
        rows[3, i], rows[4, i], rows[5, i] = stations[P_Z, i], stations[ROLL, i], stations[LENGTH, i]
        rows[6, i] = flank.line_stiffness * max(stations[DEPTH, i], 0.0)
    if flank.line_stiffness > 0:
        return
    matrix, force = compliance_matrix(lines, found, data), np.empty(n)
    depth, length, top = stations[DEPTH], stations[LENGTH], stations[TOP]
    solved = press_stations(n, matrix, depth, length, top, HERTZ, GUESS, force)
    for i in range(n):
        rows[6, i] = force[i] / length[i] if solved else np.nan
