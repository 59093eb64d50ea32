"""Loads along the lines of contact at one pose, by stations, as the laws "line" and "teeth" have them."""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.forces.rigid_motion import fill_rotation
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.elastic_teeth import compliance_matrix, solve_loads
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.flank_line import side_of
from rps_exudyn.tooth_contact.laws import MESH
from rps_exudyn.tooth_contact.teeth_data import teeth_data
from rps_exudyn.tooth_contact.teeth_stations import DEPTH, LENGTH, P_Z, ROLL, find_lines

STATIONS = 12  # on each line: loads vary along it


class LineLoads(NamedTuple):
    """The stations of one pose, arrays of shape (n,)."""

    side: np.ndarray  # -1 drives the rack towards +X, +1 towards -X
    tooth: np.ndarray  # of the pinion
    rack_tooth: np.ndarray  # numbers fall to either side of the rack's middle
    face: np.ndarray  # Z on the pinion's face [m]
    roll: np.ndarray  # tangent length q on the pinion's flank [m]
    length: np.ndarray  # of line that the station stands for [m]
    load: np.ndarray  # per length [N/m]


def loads_data(gear: SteeringGear, stations: int = STATIONS) -> np.ndarray:
    """Return the record of `line_loads` for a gear, by its law and so many stations on a segment of a line,
    in an array (1,)."""
    flank = pack(gear, along=stations, across=1)
    made = np.zeros(1, MESH)
    made["flank"], made["teeth"] = flank, teeth_data(gear, flank)
    return made


@kernel
def line_loads(angle, position, tilt, records):  # type: ignore[no-untyped-def]
    """Return `LineLoads` at rest; pinion's turn [rad], rack's reference point (3,) [m], angles (3,) [rad],
    the record of `loads_data`."""
    data = records[0]
    still, flank, rotation = np.zeros(3), data.flank, np.empty((3, 3))
    fill_rotation(tilt, rotation)
    drive = side_of(-1.0, angle, 0.0, position, rotation, still, still, flank)
    coast = side_of(1.0, angle, 0.0, position, rotation, still, still, flank)
    lines, found = find_lines(angle, drive, coast, data)
    count = flank.stations
    n = found * count
    side, tooth, rack_tooth = np.empty(n), np.empty(n), np.empty(n)
    face, roll, length, load = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    force, elastic = np.empty(n), np.empty(n)
    by_line = flank.line_stiffness > 0
    if not by_line and not solve_loads(compliance_matrix(lines, found, data), lines, data, force, elastic):
        elastic[:] = np.nan
    for i in range(n):
        line = i // count
        side[i], tooth[i], rack_tooth[i] = lines.side[line], lines.tooth[line], lines.rack_tooth[line]
        face[i], roll[i] = lines.stations[P_Z, i], lines.stations[ROLL, i]
        length[i] = lines.stations[LENGTH, i]
        if by_line:
            load[i] = flank.line_stiffness * max(lines.stations[DEPTH, i], 0.0)
        else:
            load[i] = elastic[i] / length[i]
    return LineLoads(side, tooth, rack_tooth, face, roll, length, load)
