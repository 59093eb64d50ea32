"""A measured torque curve from a CSV file, compared with a simulated one.

The first line names the columns with their units, others may be there; lines that begin with # are skipped:

    pinion_angle [deg], pinion_torque [N m]
    -719.5, 0.612
    ...

Both directions may follow each other in one file. Signs are those of the result files: the angle counts
positive and the torque drives positive where the rack moves along +X.
"""

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rps_exudyn.analysis.comparison import SignalPair, signal_pair
from rps_exudyn.analysis.passes import Signals, common_angles, longest_pass, passes
from rps_exudyn.analysis.torque import describe_torque
from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.spelling import respelled
from rps_exudyn.results.quantities import SIGNALS

COLUMNS = ("pinion_angle", "pinion_torque")
HEADER = "pinion_angle [deg], pinion_torque [N m]"
FEWEST = 3  # rows that make a curve


@dataclass(frozen=True, eq=False)
class MeasuredTorque:
    """A measured curve in SI units, in the order of its file."""

    name: str
    signals: dict[str, np.ndarray]  # pinion_angle [rad], pinion_torque [N m], shape (n,)


@dataclass(frozen=True, eq=False)
class AgainstMeasured:
    """A simulated and a measured torque in one direction, over the angles that both cover."""

    direction: int  # +1 moves the rack along +X
    angle_range: tuple[float, float]  # [rad]
    torque: SignalPair  # first measured, second simulated
    measured: dict[str, float]  # figures of `describe_torque` over these angles
    simulated: dict[str, float]


def read_measured_torque(path: str | Path) -> MeasuredTorque:
    """The curve in a CSV file.

    Raises:
        InputError: the file cannot be read, lacks a column or its unit, or holds no numbers or no curve.
    """
    rows = _rows(path)
    number, header = next(rows, (0, []))
    where = [_column(path, number, header, name) for name in COLUMNS]
    values = [
        [_value(path, line, row, index) for index, _ in where]
        for line, row in rows
        if any(map(str.strip, row))
    ]
    if len(values) < FEWEST:
        raise InputError(f"{path} holds {len(values)} points; a torque curve needs at least {FEWEST}.")
    columns = np.array(values).T * np.array([factor for _, factor in where])[:, None]
    signals = dict(zip(COLUMNS, columns, strict=True))
    if not passes(signals):
        raise InputError(f"{path} holds one pinion angle only; a torque curve covers a range of angles.")
    return MeasuredTorque(Path(path).stem, signals)


def compare_with_measured(measured: MeasuredTorque, signals: Signals, teeth: int) -> list[AgainstMeasured]:
    """Compare the torques in each direction in which both were recorded at common angles, +X first."""
    compared: list[AgainstMeasured] = []
    for direction in (+1, -1) if "pinion_torque" in signals else ():
        ours, theirs = (longest_pass(each, direction) for each in (signals, measured.signals))
        if ours is None or theirs is None:
            continue
        angle = common_angles(theirs.angle, ours.angle)
        if angle.size < FEWEST:
            continue
        curves = [each.over(angle, "pinion_torque") for each in (theirs, ours)]
        figures = [describe_torque(angle, torque, teeth) for torque in curves]
        pair = signal_pair("pinion_torque", angle, *curves)
        compared.append(AgainstMeasured(direction, (float(angle[0]), float(angle[-1])), pair, *figures))
    return compared


# --- reading ---------------------------------------------------------------------------------------
def _rows(path: str | Path) -> Iterator[tuple[int, list[str]]]:
    """Line numbers and cells, without comments; cells are separated by comma, semicolon or tab."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} cannot be read: it is no text in UTF-8.") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{units.short(str(path))} cannot be read: {reason}.") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    lines = [(number, line) for number, line in lines if not line.lstrip().startswith("#")]
    first = lines[0][1] if lines else ""
    delimiter = next((mark for mark in ";\t" if mark in first), ",")
    try:
        cells = list(csv.reader((line for _, line in lines), delimiter=delimiter))
    except csv.Error as error:
        raise InputError(f"{path} is no table: {error}.") from None
    return zip((number for number, _ in lines), cells, strict=False)


def _column(path: str | Path, line: int, header: list[str], name: str) -> tuple[int, float]:
    """Index of the column, and its unit in SI."""
    for index, cell in enumerate(header):
        found = re.fullmatch(rf"\s*{name}\s*\[([^\]]+)\]\s*", cell)
        if found:
            try:
                return index, units.to_si(f"1 {found[1].strip()}", SIGNALS[name].unit)
            except ValueError:
                raise InputError(
                    f"{path}, line {line}: [{found[1]}] is no unit of {name}; write for instance {HEADER}."
                ) from None
    raise InputError(
        f"{path} has no column {name} with its unit in its first line; write for instance {HEADER}."
    )


def _value(path: str | Path, line: int, row: list[str], index: int) -> float:
    cell = row[index].strip() if index < len(row) else ""
    try:
        value = float(respelled(cell))
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(f"{path}, line {line}: {units.short(cell)!r} is no number.")
    return value
