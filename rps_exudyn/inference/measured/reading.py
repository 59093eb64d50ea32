"""A measured curve from a file, with what was assumed on the way.

    measured = read_measured_torque("bench.csv")
    measured.assumed  # ("cells separated by semicolons, decimal comma", ...)

Cells may be separated by semicolons, tabs, commas, bars or blanks, with decimal points or commas; titles,
comments, footers and missing values are left out. A column is found by its name, or by its unit where that
is enough; its unit must be stated: in the header, in a row below it, behind each number, or by `columns`.
Signs are those of the result files: the angle counts positive and the torque drives positive where the rack
moves along +X.
"""

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rps_exudyn.analysis.measured import FEWEST
from rps_exudyn.analysis.passes import is_in_random_order, passes
from rps_exudyn.base.errors import InputError, are, check_kind, lines_in_words
from rps_exudyn.base.files import content_of
from rps_exudyn.base.units import short
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.measured import turning
from rps_exudyn.inference.measured.binary_files import Channels, channels_of
from rps_exudyn.inference.measured.columns import MeasuredColumn, Row, Table, find_columns, known_columns
from rps_exudyn.inference.measured.layout import SEPARATORS, table_in, text_of
from rps_exudyn.inference.measured.numbers import (
    AmbiguousNumbersError,
    Format,
    format_of,
    is_missing,
    is_number,
    is_placeholder,
    parsed,
)
from rps_exudyn.parameters.gear import SteeringGear, check_gear
from rps_exudyn.results.result import MeasuredTorque

TORQUE = ("pinion_angle", "pinion_torque")
PUSH = ("rack_displacement", "rack_force")
_ENCODINGS = {"utf-8": "", "utf-8-sig": "", "cp1252": "Windows-1252"}
_LIKE_NUMBER = re.compile(r"\(\d+([.,]\d*)?\)|\d+([.,]\d*)?[-+]")  # of bookkeepers: (0.6), 0.6-
FAR = 20.0  # times the usual size of a value: a number of nines beyond stands for none


def read_measured_torque(
    path: str | Path, columns: Mapping[str, str] | None = None, gear: SteeringGear | None = None
) -> MeasuredTorque:
    """Read the torque over the pinion angle from a file.

    `signals` of the result holds `pinion_angle` [rad] and `pinion_torque` [N m], shape (n,), in the order
    of the file; `assumed` states what the file leaves open.

    Args:
        path: a text, or an MDF 4, TDMS or MAT file.
        columns: quantity -> "TITLE [unit]", where its header has none.
        gear: whose constant travel per turn gives the angle where a file has the rack's travel instead.

    Raises:
        InputError: the file cannot be read, lacks a column or its unit, or holds no numbers or no curve.

    Examples:
        >>> table = [(angle, 0.6) for angle in range(361)]
        >>> np.savetxt("bench.csv", table, header="angle [deg];torque [N m]", delimiter=";", comments="")
        >>> rps.read_measured_torque("bench.csv").signals["pinion_torque"].size
        361
    """
    if gear is not None:
        check_gear(gear)
    plain = gear if gear is not None and gear.rack.ratio.is_constant else None
    return read_curve(path, TORQUE, columns, None if plain is None else float(GearPair.of(plain).gain))


def read_curve(
    path: str | Path,
    wanted: Sequence[str],
    columns: Mapping[str, str] | None = None,
    gain: float | None = None,
) -> MeasuredTorque:
    """The curve of the wanted quantities, the driven coordinate first: `TORQUE` or `PUSH`.

    The angle of a torque may follow from the rack's travel, or from times and speeds; `gain` is the travel
    per angle [m/rad], None where no gear is known.

    Raises:
        InputError: as of `read_measured_torque`.
    """
    check_kind("columns", columns, Mapping | None, 'quantity -> "TITLE [unit]"')
    chosen = dict(columns or {})
    for name, title in chosen.items():
        check_kind(f"the column of {name}", title, str, 'text such as "TITLE [unit]"')
    if unknown := [name for name in chosen if name not in (*TORQUE, *PUSH)]:
        raise InputError(f"--column {unknown[0]} is no quantity; there are {', '.join((*TORQUE, *PUSH))}.")
    content = content_of(path)
    channels = channels_of(path, content)
    table, encoding = _table(path, content, wanted) if channels is None else (channels.table, "")
    recording, instead = _columns_instead(table, wanted, chosen)
    chosen = {each: chosen[each] for each in recording if each in chosen}
    picked = find_columns(path, table, recording, chosen)
    values, first, notes, lines, beside = (
        _of_text(path, table, encoding, picked) if channels is None else _of_channels(path, channels, picked)
    )
    if len(lines) < FEWEST:
        raise InputError(f"{path} holds {len(lines)} points; a torque curve needs at least {FEWEST}.")
    curve = values * np.array([column.size for column in picked])[:, None]
    left_out = tuple(notes)
    rack_speed = beside.pop("rack_speed", None)
    if rack_speed is not None and (wanted[0] in PUSH or gain is not None):
        beside.setdefault("speed", rack_speed if wanted[0] in PUSH else rack_speed / gain)
    if instead == "rack_displacement":
        if gain is None:
            raise InputError(f"{path} holds the rack's travel {turning.NO_ANGLE}")
        curve[0] /= gain
        turn = f"{2e3 * np.pi * gain:.4g} mm per turn of the gear given"
        notes.append(f"the pinion angle follows from the rack's travel, {turn}")
    elif instead == "speed":
        curve = np.array([turning.angle_by_speed(path, beside, curve[0]), curve[0]])
        notes.append("the pinion angle is the sum of speed times time, from 0 on")
        if all((each >= 0).all() or (each <= 0).all() for each in (beside["speed"], curve[1])):
            notes.append(ONE_WAY)
    driven = wanted[0].replace("_", " ")
    if is_in_random_order(curve[0]):
        raise InputError(
            f"{path} holds its {driven}s in random order: write the rows in the order in which they were "
            "recorded."
        )
    if wanted[0] in TORQUE and not instead:
        curve[0], turns = turning.counted_on(curve[0])
        notes += [f"the angle restarts {turns} times and is continued from turn to turn"] if turns else []
    if not np.ptp(curve[0]) > 0 or not passes({"pinion_angle": curve[0]}):
        raise InputError(f"{path} holds one {driven} only; a curve covers a range of them.")
    if turning.is_interleaved(curve[1]):
        raise InputError(
            f"{path} has both directions of the motion in rows that alternate; write all rows of one way, "
            f"then those back, with a falling {driven}."
        )
    words = turning.directions(table)
    if words and len({each.direction for each in passes({"pinion_angle": curve[0]})}) == 1:
        raise InputError(
            f"{path} has several directions ({', '.join(short(word, 20) for word in words)}), but its "
            "angle moves one way in all of them; it must decrease where the motion goes back."
        )
    moves = turning.in_motion(curve[0], beside.get("clock"))
    if not moves.all():
        resting = np.array(lines)[~moves].tolist()
        notes.append(f"{are(len(resting), 'row')} left out, {lines_in_words(resting)}, where the angle rests")
        left_out += (notes[-1],)
    curve, beside = curve[:, moves], {name: values[moves] for name, values in beside.items()}
    curve[0], rows_of_step = turning.spread_evenly(*curve)
    if rows_of_step > 1:
        notes.append(f"{rows_of_step:.2g} rows of one {driven} are spread evenly to the next")
    signals = dict(zip(wanted, curve, strict=True))
    beside["line"] = np.array(lines, dtype=float)[moves]
    return MeasuredTorque(
        Path(path).stem, signals, (first, *[column.words for column in picked], *notes), beside, left_out
    )


ONE_WAY = "speed and torque have one sign: read as one direction, which is wrong if the motion turned back"


def _columns_instead(
    table: Table, wanted: Sequence[str], chosen: Mapping[str, str]
) -> tuple[tuple[str, ...], str]:
    """The quantities that are read, and what stands instead of a pinion angle: "" where it is there."""
    angle, travel = "pinion_angle", "rack_displacement"
    if wanted[0] == angle and angle not in chosen and (travel in chosen or not table.names_quantity(angle)):
        if travel in chosen or table.names_quantity(travel):
            return (travel, *wanted[1:]), travel
        if {"speed", "rack_speed"} & set(table.beside):
            return tuple(wanted[1:]), "speed"
    return tuple(wanted), ""


class _Read(NamedTuple):
    values: np.ndarray  # in the columns' units, shape (columns, n)
    first: str  # what was assumed of the file
    notes: list[str]  # which rows were left out
    lines: list[int]  # numbers of the rows
    beside: dict[str, np.ndarray]  # clock and speeds, shape (n,)


def _of_channels(path: str | Path, channels: Channels, picked: list[MeasuredColumn]) -> _Read:
    """The numbers of channels, at the instants of the first one."""
    driven = picked[0].index
    values = np.array([channels.column(column.index, driven) for column in picked])
    known = np.isfinite(values).all(axis=0)
    rows, missing = ((np.flatnonzero(which) + 1).tolist() for which in (known, ~known))
    notes = []
    if missing:
        where = lines_in_words(missing).replace("line", "row")
        notes.append(f"{are(len(missing), 'row', ' without a value')} left out: {where}")
    others = channels.table.beside.items()
    beside = {name: size * channels.column(index, driven)[known] for name, (index, size) in others}
    clock = channels.channels[driven].clock
    if clock is not None:
        beside.setdefault("clock", clock[known])
    return _Read(values[:, known], channels.what, notes, rows, beside)


def _table(path: str | Path, content: bytes, wanted: Sequence[str]) -> tuple[Table, str]:
    """The table in a text, and the text's encoding.

    Raises:
        InputError: it is no text, or holds no table.
    """
    text, encoding = text_of(path, content)
    table = table_in(text)
    if table is None:
        raise InputError(
            f"{path} has no column {wanted[0]} with its unit: it holds no rows of two numbers or more; "
            "write a row of numbers for each point, below a line of names with units."
        )
    if table.separator == "," and table.header and table.width > len(table.header[1]):
        raise InputError(
            f"{path} has {table.width} cells in a row where line {table.header[0]} names "
            f"{len(table.header[1])}: its commas may separate cells or decimals; write decimal points, "
            "or semicolons between cells."
        )
    return table, encoding


def _of_text(path: str | Path, table: Table, encoding: str, picked: list[MeasuredColumn]) -> _Read:
    """The numbers of a text's columns.

    Raises:
        InputError: a cell that should be a number is none, or the columns change on the way.
    """
    cells = [table.column(column.index) for column in picked]
    form = _format(path, table, picked, cells)
    units = [("", column.unit) for column in picked]
    values = np.array([form.column(*each) for each in zip(cells, units, strict=True)])
    known = ~np.isnan(values)
    absent = np.array([_absent(*each) for each in zip(cells, values, strict=True)])
    is_kept = (known & ~absent).all(axis=0)
    is_missing_row = (known | absent).all(axis=0) & ~is_kept
    lines = np.array([number for number, _ in table.rows])
    kept, missing = lines[is_kept].tolist(), lines[is_missing_row].tolist()
    text = np.flatnonzero(~is_kept & ~is_missing_row).tolist()
    last = kept[-1] if kept else table.rows[-1][0]
    for i in text:
        _check_text(path, table, table.rows[i], [each[i] for each in cells], known[:, i], last)
    left = {("row", " without a value"): missing, ("line", " without numbers"): lines[text].tolist()}
    notes = [
        f"{are(len(which), *words)} left out: {lines_in_words(which)}"
        for words, which in left.items()
        if which
    ]
    first = f"cells separated by {SEPARATORS.get(table.separator, table.separator)}, {form.words}"
    if named := _ENCODINGS.get(encoding, encoding.upper()):
        first = f"text in {named}, {first}"
    others = table.beside.items()
    beside = {name: size * form.column(table.column(index))[is_kept] for name, (index, size) in others}
    return _Read(values[:, is_kept], first, notes, kept, beside)


def _format(
    path: str | Path, table: Table, columns: list[MeasuredColumn], cells: Sequence[Sequence[str]]
) -> Format:
    units = {"", *(column.unit for column in columns)}
    numbers = [digits for column in cells for digits, _, tail in parsed(column) if digits and tail in units]
    try:
        return format_of(numbers)
    except AmbiguousNumbersError as either:
        with suppress(AmbiguousNumbersError):  # numbers beside the curve may show it; dates and times do not
            beside = [cell for _, row in table.rows for cell in row if cell.count(".") < 2]
            return format_of([digits for digits, _, tail in parsed(beside) if digits and not tail])
        example = str(either)
        raise InputError(
            f"{path} has commas that may be decimal or divide thousands: {example} may be "
            f"{example.replace(',', '.')} or {example.replace(',', '')}; write decimal points."
        ) from None


def _absent(cells: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Which cells of a column hold no value, shape (n,): by a word or a mark for it.

    A mark is a number of nothing but nines, far beyond all others. `values` are NaN where a cell is no
    number.
    """
    sizes = np.abs(values)
    usual = np.median(sizes[~np.isnan(sizes)]) if not np.isnan(sizes).all() else 0.0
    absent = np.zeros(values.size, dtype=bool)
    for i in np.flatnonzero(np.isnan(sizes) | (sizes > FAR * usual)).tolist():
        absent[i] = is_missing(cells[i]) or (sizes[i] > FAR * usual and is_placeholder(cells[i]))
    return absent


def _check_text(
    path: str | Path, table: Table, row: Row, cells: list[str], known: np.ndarray, last: int
) -> None:
    """Refuse a row that is no numbers where the curve would be another one: before the `last` line of the
    curve, or numbers that are written otherwise at its end. `known` marks the numbers, shape (columns,).

    Raises:
        InputError: it does.
    """
    within, named = row[0] < last, table.header[1] if table.header else row[1]
    names = known_columns(row[1]) or sum(cell.endswith((")", "]")) for cell in row[1]) > 1
    if within and names and row[1] != named:
        raise InputError(
            f"{path}, line {row[0]} names its columns again: {short(', '.join(row[1]), 60)}; save each table "
            "in a file of its own."
        )
    wrong = [cell for cell, is_known in zip(cells, known, strict=True) if not is_known]
    numeric = all(is_number(cell) or _LIKE_NUMBER.fullmatch(cell.strip()) for cell in cells)
    is_label = re.match(r"[^\W\d_]{2}", row[1][0])  # a word, as of mean values and of further passes
    if not is_label and (numeric or (within and len(wrong) < len(cells))):
        raise InputError(
            f"{path}, line {row[0]}: {short(wrong[0])!r} is no number; write one as -0.6, or leave its cell "
            "empty."
        )
