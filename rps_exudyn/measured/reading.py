"""A measured curve from a text file, with what was assumed on the way.

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
from pathlib import Path

import numpy as np

from rps_exudyn.analysis.measured import FEWEST, MeasuredTorque
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short
from rps_exudyn.measured.clock import recorded
from rps_exudyn.measured.columns import Column, find_columns, known_columns
from rps_exudyn.measured.layout import SEPARATORS, Layout, Row, layout_of
from rps_exudyn.measured.numbers import AmbiguousNumbersError, Format, as_number, format_of, is_missing
from rps_exudyn.measured.text import read_text

TORQUE = ("pinion_angle", "pinion_torque")
PUSH = ("rack_displacement", "rack_force")
_ENCODINGS = {"utf-8": "", "utf-8-sig": "", "cp1252": "Windows-1252"}
_SHOWN = 5  # line numbers in a sentence


def read_measured_torque(path: str | Path, columns: Mapping[str, str] | None = None) -> MeasuredTorque:
    """The torque over the pinion angle in a file; `columns` is quantity -> "TITLE [unit]", where its header
    does not tell.

    Raises:
        InputError: the file cannot be read, lacks a column or its unit, or holds no numbers or no curve.
    """
    return read_curve(path, TORQUE, columns)


def read_curve(
    path: str | Path, wanted: Sequence[str], columns: Mapping[str, str] | None = None
) -> MeasuredTorque:
    """The curve of the wanted quantities, the driven coordinate first: `TORQUE` or `PUSH`.

    Raises:
        InputError: as of `read_measured_torque`.
    """
    chosen = dict(columns or {})
    if unknown := [name for name in chosen if name not in (*TORQUE, *PUSH)]:
        raise InputError(f"--column {unknown[0]} is no quantity; there are {', '.join((*TORQUE, *PUSH))}.")
    text, encoding = read_text(path)
    layout = layout_of(text, known_columns)
    if layout is None:
        raise InputError(
            f"{path} has no column {wanted[0]} with its unit: it holds no rows of two numbers or more."
        )
    if layout.separator == "," and layout.header and layout.width > len(layout.header[1]):
        raise InputError(
            f"{path} has {layout.width} cells in a row where line {layout.header[0]} names "
            f"{len(layout.header[1])}: its commas may separate cells or decimals; write decimal points, or "
            "semicolons between cells."
        )
    found = find_columns(path, layout, wanted, {name: chosen[name] for name in wanted if name in chosen})
    numbers = _format(path, layout, found)
    values, notes, lines = _values(path, layout, found, numbers)
    if len(values) < FEWEST:
        raise InputError(f"{path} holds {len(values)} points; a torque curve needs at least {FEWEST}.")
    table = values.T * np.array([column.size for column in found])[:, None]
    signals = dict(zip(wanted, table, strict=True))
    if not np.ptp(table[0]) > 0 or not passes({"pinion_angle": table[0]}):
        raise InputError(
            f"{path} holds one {wanted[0].replace('_', ' ')} only; a curve covers a range of them."
        )
    first = f"cells separated by {SEPARATORS.get(layout.separator, layout.separator)}, {numbers.words}"
    if named := _ENCODINGS.get(encoding, encoding.upper()):
        first = f"text in {named}, {first}"
    taken = [_taken(column) for column in found]
    beside = recorded(layout, lines, numbers)
    return MeasuredTorque(Path(path).stem, signals, (first, *taken, *notes), beside)


def _taken(column: Column) -> str:
    why = f" ({column.assumed})" if column.assumed else ""
    return f"{column.quantity} from column {column.title!r} in {column.unit} = {column.size:.6g} in SI{why}"


def _format(path: str | Path, layout: Layout, columns: list[Column]) -> Format:
    cells = [row[column.index] for _, row in layout.rows for column in columns if column.index < len(row)]
    numbers = [number for cell in cells if (number := as_number(cell)) is not None]
    try:
        return format_of(numbers)
    except AmbiguousNumbersError as either:
        example = str(either)
        raise InputError(
            f"{path} has commas that may be decimal or divide thousands: {example} may be "
            f"{example.replace(',', '.')} or {example.replace(',', '')}; write decimal points."
        ) from None


def _values(
    path: str | Path, layout: Layout, columns: list[Column], numbers: Format
) -> tuple[np.ndarray, list[str], list[int]]:
    """The numbers, shape (n, columns), what was left out, and the numbers of their lines."""
    kept, text, missing = [], [], []
    for row in layout.rows:
        cells = [row[1][column.index] if column.index < len(row[1]) else "" for column in columns]
        values = [_value(cell, numbers, column) for cell, column in zip(cells, columns, strict=True)]
        if all(value is not None for value in values):
            kept.append((row[0], values))
        elif all(value is not None or is_missing(cell) for value, cell in zip(values, cells, strict=True)):
            missing.append(row[0])
        else:
            text.append((row, cells, values))
    last = kept[-1][0] if kept else 0
    for row, cells, values in text:
        if row[0] < last and any(value is not None for value in values) and not _is_label(row):
            wrong = next(cell for cell, value in zip(cells, values, strict=True) if value is None)
            raise InputError(f"{path}, line {row[0]}: {short(wrong)!r} is no number.")
    notes = []
    if missing:
        notes.append(f"{len(missing)} rows without a value are left out: {_lines(missing)}")
    if text:
        notes.append(
            f"{len(text)} lines that are no numbers are left out: {_lines([row[0] for row, *_ in text])}"
        )
    table = np.array([values for _, values in kept], dtype=float).reshape(-1, len(columns))
    return table, notes, [line for line, _ in kept]


def _is_label(row: Row) -> bool:
    """Tell whether a row begins with a word, as those of mean values and of further passes do."""
    return bool(re.match(r"[^\W\d_]{2}", row[1][0]))


def _value(cell: str, numbers: Format, column: Column) -> float | None:
    number = as_number(cell)
    if number is None or number.tail not in ("", column.unit):
        return None
    try:
        return numbers.value(number)
    except ValueError:
        return None


def _lines(numbers: list[int]) -> str:
    shown = ", ".join(map(str, numbers[:_SHOWN]))
    return f"line {shown}" + (" ..." if len(numbers) > _SHOWN else "")
