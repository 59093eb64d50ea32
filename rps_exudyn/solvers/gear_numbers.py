"""A gear's packed data as one row of numbers, and back: what a compiled loop over many gears reads.

What gears of a loop have in common, integration rules and friction laws without memory, stays in the data of
one of them; a row has the rest of what `gear_forces` packs.
"""

from typing import Any

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.forces.bearing import BearingData
from rps_exudyn.forces.external_load import DeadForceData
from rps_exudyn.forces.sliding_fit import FitData
from rps_exudyn.forces.yoke import NutData, SeatData, SpringData
from rps_exudyn.mesh_contact.flank_data import FlankData

# Parts of `GearData` and their numbers in the order of a row; arrays are laid out one element after the other
NUMBERS: dict[str, tuple[str, ...]] = {
    "mesh": (
        *("teeth", "base_radius", "twist", "cos_base_helix", "theta", "theta_coast_to_drive"),
        *("q_form", "q_tip", "half_face", "eccentric_e", "eccentric_y", "slope", "relief_start", "relief"),
        *("crowning", "pitch_error", "cos_delta", "sin_delta", "axis_offset", "normal_x", "normal_y"),
        *("normal_z", "flank_offset", "normal_base_pitch", "gain", "tip_depth", "bar_radius", "stiffness"),
        *("damping", "friction", "zone", "line_stiffness"),
    ),
    "seat": (
        *("bar_radius", "friction", "zone", "rest_gap", "half_angle", "edge_y", "edge_z", "half_length"),
        *("density", "tilt"),
    ),
    "spring": ("rate", "preload"),
    "nut": ("stiffness", "clearance"),
    "bearing": ("torque", "zone", "radius"),
    "fit": ("drag", "zone", "radius", "station", "lever"),
}
ARRAYS = {"mesh": "rack_reference", "seat": "points", "fit": "stiffness"}
FIRST = {"mesh": 0, "seat": 32, "spring": 42, "nut": 44, "bearing": 46, "fit": 49}
LOAD, LOAD_PLACE = 54, 55  # of what pulls the rack's end along X [N], [m]
COUNT = 56
REST_GAP, PRELOAD, AXIS_OFFSET = 35, 43, 18  # columns that the yoke's adjustment needs
IDEAL = (9, 10, 29)  # columns of runout and friction, which it does without

COLUMN = {(part, name): FIRST[part] + i for part, names in NUMBERS.items() for i, name in enumerate(names)}
"""(part, number) -> its column in a row."""


def numbers_of(data: Any) -> np.ndarray:
    """Return the row of a gear's data, shape (`COUNT`,)."""
    parts = [float(getattr(getattr(data, part), name)) for part, name in COLUMN]
    return np.array([*parts, data.load.force[0], data.load.place])


def arrays_of(data: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the arrays that differ between gears: the rack's reference point (3,), the seat's points (n, 4),
    the fit's stiffness (4, 4)."""
    reference, points, stiffness = (getattr(getattr(data, part), name) for part, name in ARRAYS.items())
    return reference, points, stiffness


@kernel
def flank_of(row, reference, data):  # type: ignore[no-untyped-def]
    """Return the flanks' data with the numbers of a row."""
    return FlankData(
        int(row[0]),
        row[1],
        row[2],
        row[3],
        row[4],
        row[5],
        row[6],
        row[7],
        row[8],
        row[9],
        row[10],
        row[11],
        row[12],
        row[13],
        row[14],
        row[15],
        row[16],
        row[17],
        row[18],
        reference,
        row[19],
        row[20],
        row[21],
        row[22],
        row[23],
        row[24],
        row[25],
        row[26],
        row[27],
        row[28],
        row[29],
        row[30],
        data.law,
        row[31],
        data.along,
        data.across,
        data.ease_along,
        data.ease_across,
        data.generators,
    )


@kernel
def seat_of(row, points, data):  # type: ignore[no-untyped-def]
    """Return the seat's data with the numbers of a row."""
    return SeatData(
        row[32],
        row[33],
        row[34],
        row[35],
        row[36],
        row[37],
        row[38],
        row[39],
        row[40],
        data.arc,
        data.arc_weight,
        data.length,
        data.length_weight,
        points,
        data.law,
        row[41],
    )


@kernel
def guides_of(row, stiffness, bearing, fit):  # type: ignore[no-untyped-def]
    """Return the data of spring, yokenut, bearing and fit with the numbers of a row."""
    return (
        SpringData(row[42], row[43]),
        NutData(row[44], row[45]),
        BearingData(row[46], row[47], row[48], bearing.law),
        FitData(stiffness, row[49], row[50], row[51], row[52], row[53], fit.law),
    )


@kernel
def load_of(row, load):  # type: ignore[no-untyped-def]
    """Return the load with the numbers of a row."""
    return DeadForceData((row[54], load.force[1], load.force[2]), row[55])
