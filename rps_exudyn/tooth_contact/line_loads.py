"""Loads along the lines of contact, by stations, as the laws "line" and "teeth" have them."""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import (
    MATRIX,
    NUMBERS,
    VECTOR,
    Array,
    entry,
    inline,
    placed,
    stacked,
    stacked_zeros,
)
from rps_exudyn.forces.rigid_motion import fill_rotation
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.tooth_stiffness import HERTZ
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.elastic_teeth import GUESS, fill_compliance, room_of_teeth
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.flank_line import side_of
from rps_exudyn.tooth_contact.laws import MESH
from rps_exudyn.tooth_contact.measured_flank import pooled_grids
from rps_exudyn.tooth_contact.teeth_data import teeth_data
from rps_exudyn.tooth_contact.teeth_stations import (
    COLUMN,
    DEPTH,
    LENGTH,
    LINE_SIZE,
    P_Z,
    ROLL,
    TOP,
    find_lines,
    most_lines,
)
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


class LoadsData(NamedTuple):
    """Constants of a gear for `line_loads`."""

    records: np.ndarray  # of its mesh, (1,)
    pool: np.ndarray  # of its measured flanks


def loads_data(gear: SteeringGear, stations: int = STATIONS) -> LoadsData:
    """Return the constants of a gear for `line_loads`, with so many stations on a segment of a line."""
    flank = pack(gear, along=stations, across=1)
    made = np.zeros(1, MESH)
    made["flank"], made["teeth"], made["most_lines"] = flank, teeth_data(gear, flank), most_lines(flank)
    return LoadsData(made, pooled_grids(measured_flanks(gear))[2])


AT_ONCE = 256  # poses, whose rows have room for the most stations


def line_loads(angles: np.ndarray, positions: np.ndarray, tilts: np.ndarray, data: LoadsData) -> LineLoads:
    """Return the loads of n poses at rest.

    By the pinion's turns (n,) [rad], the rack's reference points (n, 3) [m] and angles (n, 3) [rad].
    """
    records, pool = data
    flank, counts, filled = records[0]["flank"], np.zeros(len(angles), np.int64), [np.zeros((ROWS, 0))]
    room = np.zeros(room_of_teeth(flank))
    rows = np.zeros((ROWS, AT_ONCE * int(records[0]["most_lines"]) * int(flank["stations"])))
    poses = [np.ascontiguousarray(each, dtype=float) for each in (angles, positions, tilts)]
    for i in range(0, len(angles), AT_ONCE):
        part = slice(i, i + AT_ONCE)
        fill_line_loads(*(each[part] for each in poses), records, pool, rows, counts[part], room)
        filled.append(rows[:, : counts[part].sum()].copy())
    return LineLoads(np.repeat(np.arange(len(angles)), counts), *np.concatenate(filled, axis=1))


@entry(VECTOR, MATRIX, MATRIX, Array(MESH, 1), VECTOR, MATRIX, NUMBERS, VECTOR)
def fill_line_loads(angles, positions, tilts, records, pool, rows, counts, room):  # type: ignore[no-untyped-def]
    """Fill the rows of all fields but the pose, station after station, and how many stations each pose has;
    `room` has `room_of_teeth`."""
    data = records[0]
    still, flank, rotation, end = stacked_zeros(3), data.flank, stacked((3, 3)), 0
    for i in range(angles.size):
        angle, position = angles[i], positions[i]
        fill_rotation(tilts[i], rotation)
        drive = side_of(-1.0, angle, 0.0, position, rotation, still, still, flank)
        coast = side_of(1.0, angle, 0.0, position, rotation, still, still, flank)
        lines, found = find_lines(angle, drive, coast, data, pool, room)
        counts[i] = found * flank.stations
        left = room[lines.side.size * LINE_SIZE + lines.stations.shape[1] * COLUMN :]
        _fill_loads(lines, counts[i], data, rows[:, end : end + counts[i]], left)
        end += counts[i]


@inline
def _fill_loads(lines, n, data, rows, room):  # type: ignore[no-untyped-def]
    """Fill the rows of one pose, of its n stations."""
    flank, stations = data.flank, lines.stations
    for i in range(n):
        line = i // flank.stations
        rows[0, i], rows[1, i], rows[2, i] = lines.side[line], lines.tooth[line], lines.rack_tooth[line]
        rows[3, i], rows[4, i], rows[5, i] = stations[P_Z, i], stations[ROLL, i], stations[LENGTH, i]
        rows[6, i] = flank.line_stiffness * max(stations[DEPTH, i], 0.0)
    if flank.line_stiffness > 0:
        return
    matrix, force, left = placed(room, 0, (n, n)), placed(room, n * n, n), room[n * n + n :]
    fill_compliance(matrix, lines, n // flank.stations, data)
    depth, length, top = stations[DEPTH], stations[LENGTH], stations[TOP]
    solved = press_stations(n, matrix, depth, length, top, HERTZ, GUESS, force, left)
    for i in range(n):
        rows[6, i] = force[i] / length[i] if solved else np.nan
