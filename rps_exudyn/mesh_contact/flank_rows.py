"""The single lines of contact of one state of the mesh, for plots and reports."""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.compiled import inlined
from rps_exudyn.mesh_contact.flank_data import (
    AXIS_OFFSET,
    BASE_RADIUS,
    COS_DELTA,
    ECCENTRIC_E,
    ECCENTRIC_Y,
    SIN_DELTA,
)

ROW = 11  # side, tooth, rack tooth, start (3), end (3), normal force, depth


@dataclass(frozen=True)
class ContactLine:
    """One line of contact, in the housing frame."""

    side: int  # -1 drives the rack towards +X, +1 towards -X
    tooth: int  # of the pinion; counts on beyond `teeth`, so that one line keeps its number while it lasts
    rack_tooth: int  # 0 is centred at the rack's origin
    start: tuple[float, float, float]  # [m]
    end: tuple[float, float, float]  # [m]
    normal_force: float  # [N]
    depth: float  # deepest penetration [m]

    @classmethod
    def of(cls, row: np.ndarray) -> "ContactLine":
        side, tooth, rack_tooth, *numbers = row.tolist()
        start, end = tuple(numbers[:3]), tuple(numbers[3:6])
        return cls(int(side), int(tooth), int(rack_tooth), start, end, numbers[6], numbers[7])

    @property
    def length(self) -> float:
        """Length of the line [m]."""
        return float(np.linalg.norm(np.subtract(self.end, self.start)))

    def peak_pressure(self, stiffness: float) -> float:
        """Law "area": the highest pressure [Pa] with the contact's `stiffness` [N/m^3]."""
        return stiffness * self.depth


@inlined
def fill(row, angle, tooth, rack_tooth, start, end, depth, load, line, side, data):  # type: ignore[no-untyped-def]
    """Write one line, from Z = `start` to `end`, into a row."""
    row[0], row[1], row[2] = side.sign, tooth, rack_tooth
    _to_housing(row[3:6], start, angle, line, side, data)
    _to_housing(row[6:9], end, angle, line, side, data)
    row[9], row[10] = load, depth


@inlined
def _to_housing(place, z, angle, line, side, data):  # type: ignore[no-untyped-def]
    along = side.sign * (line.q_0 + line.q_1 * z)
    ca, sa = np.cos(angle), np.sin(angle)
    e = side.cos * data[BASE_RADIUS] - side.sin * along + ca * data[ECCENTRIC_E] - sa * data[ECCENTRIC_Y]
    y = side.sin * data[BASE_RADIUS] + side.cos * along + sa * data[ECCENTRIC_E] + ca * data[ECCENTRIC_Y]
    place[0] = data[COS_DELTA] * e + data[SIN_DELTA] * z
    place[1] = y + data[AXIS_OFFSET]
    place[2] = data[COS_DELTA] * z - data[SIN_DELTA] * e
