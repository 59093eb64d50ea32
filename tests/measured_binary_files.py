"""Made-up files of MDF 4, TDMS and MAT with the curve of `measured_files`, as benches write them."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from measured_files import ANGLE, TORQUE

STEP = 0.5  # [s] between two rows
TIME = STEP * np.arange(ANGLE.size)
BETWEEN = np.sort(np.concatenate([TIME, TIME[:-1] + STEP / 2]))  # instants of a channel of twice the rate


def mdf(path: Path, *groups: list[tuple[str, str, np.ndarray, np.ndarray]], version: str = "4.10") -> None:
    """Write groups of channels: name, unit, values, times."""
    from asammdf import MDF, Signal

    with MDF(version=version) as file:
        for group in groups:
            file.append([Signal(values, times, name=name, unit=unit) for name, unit, values, times in group])
        written = file.save(path, overwrite=True)
    Path(written).replace(path)


def tdms(path: Path, *channels: tuple[str, str, np.ndarray, Mapping[str, Any]]) -> None:
    """Write channels: "group/name", unit, values, further properties."""
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as file:
        for name, unit, values, more in channels:
            stated = {"unit_string": unit} if unit else {}
            file.write_segment([ChannelObject(*name.split("/"), values, properties={**stated, **more})])


def mat(path: Path, variables: Mapping[str, Any], compressed: bool = False) -> None:
    """Write variables."""
    from scipy.io import savemat

    savemat(path, dict(variables), do_compression=compressed, appendmat=False)


READABLE: dict[str, Callable[[Path], None]] = {
    "MDF": lambda path: mdf(path, [("Winkel", "°", ANGLE, TIME), ("Moment", "Nm", TORQUE, TIME)]),
    "MDF, two rates": lambda path: mdf(
        path,
        [("SteeringAngle", "deg", ANGLE, TIME), ("pinion angle", "deg", ANGLE, TIME)][1:],
        [("Torque", "N cm", np.interp(BETWEEN, TIME, 100 * TORQUE), BETWEEN)],
    ),
    "MDF, integers and a temperature": lambda path: mdf(
        path,
        [
            ("angle", "mrad", np.radians(ANGLE) * 1e3, TIME),
            ("torque", "mNm", np.round(TORQUE * 1e6).astype(np.int32) / 1e3, TIME),
            ("oil temperature", "°C", 20 + 0 * TIME, TIME),
        ],
    ),
    "TDMS": lambda path: tdms(path, ("M/angle", "deg", ANGLE, {}), ("M/torque", "N m", TORQUE, {})),
    "TDMS, NI unit and waveform": lambda path: tdms(
        path,
        ("raw/Angle", "", ANGLE, {"NI_UnitDescription": "deg", "wf_increment": STEP}),
        ("raw/Torque", "", TORQUE, {"NI_UnitDescription": "Nm", "wf_increment": STEP}),
    ),
    "TDMS, torque of twice the rate": lambda path: tdms(
        path,
        ("slow/angle", "deg", ANGLE, {"wf_increment": STEP}),
        ("fast/torque", "Nm", np.interp(BETWEEN, TIME, TORQUE), {"wf_increment": STEP / 2}),
    ),
    "MAT, units in the names": lambda path: mat(path, {"angle_deg": ANGLE, "torque_Nm": TORQUE, "n": 3}),
    "MAT, compressed, columns": lambda path: mat(
        path, {"angle_rad": np.radians(ANGLE)[:, None], "torque_Nm": TORQUE[:, None]}, compressed=True
    ),
    "MAT, a structure with units": lambda path: mat(
        path,
        {"rec": {"angle": {"data": ANGLE, "unit": "deg"}, "torque": {"data": 1e3 * TORQUE, "unit": "N mm"}}},
    ),
    "MAT, a table of units": lambda path: mat(
        path, {"angle": ANGLE, "torque": TORQUE, "units": {"angle": "deg", "torque": "Nm"}}
    ),
}
"""Kind -> what writes it."""

REFUSED: dict[str, tuple[Callable[[Path], object], str]] = {
    "MDF 3": (
        lambda path: mdf(path, [("angle", "deg", ANGLE, TIME)], version="3.30"),
        r"MDF file of version 3.* save it as MDF 4",
    ),
    "MDF without unit": (
        lambda path: mdf(path, [("angle", "", ANGLE, TIME), ("torque", "Nm", TORQUE, TIME)]),
        r"no unit of pinion_angle in column 'angle'.*--column",
    ),
    "TDMS, two torques": (
        lambda path: tdms(
            path,
            ("a/angle", "deg", ANGLE, {}),
            ("a/torque", "Nm", TORQUE, {}),
            ("b/torque", "Nm", TORQUE, {}),
        ),
        r"2 columns that may be pinion_torque: a/torque and b/torque; choose one",
    ),
    "TDMS, lengths without time": (
        lambda path: tdms(path, ("a/angle", "deg", ANGLE, {}), ("a/torque", "Nm", TORQUE[:-7], {})),
        "no common time; export them at one rate",
    ),
    "TDMS of texts": (
        lambda path: tdms(path, ("a/names", "", np.array(["forth", "back"]), {})),
        "a file of TDMS without a channel of numbers",
    ),
    "MAT with a matrix": (
        lambda path: mat(path, {"data": np.column_stack([ANGLE, TORQUE])}),
        "a file of MAT without a channel of numbers",
    ),
    "MAT of version 7.3": (
        lambda path: path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512)),
        r"version 7.3; save it by save\(..., '-v7'\)",
    ),
}
"""Kind -> what writes it, and the sentence that refuses it."""
