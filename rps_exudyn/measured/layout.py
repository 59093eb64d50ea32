"""The layout of a table in a text: what separates its cells, where its names, units and numbers stand."""

import csv
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from rps_exudyn.measured.bench_units import is_unit
from rps_exudyn.measured.numbers import as_number, is_missing

Line = tuple[int, str]
Row = tuple[int, list[str]]

SEPARATORS = {
    ";": "semicolons",
    "\t": "tabs",
    "|": "bars",
    ",": "commas",
    "  ": "two blanks or more",
    " ": "blanks",
}
_COMMENT = re.compile(r"\s*(?:#|%|//|!|\*)+")
_OPEN_QUOTE = re.compile(r'^(?:[^"]*"[^"]*")*(?:[^"]*[;,\t|])?\s*"[^"]*$')
_HEAD_LINES = 4  # that a quoted name and its unit may take beside the first
_AHEAD = 4  # rows that follow the first one of numbers, of which most must be numbers too


@dataclass(frozen=True)
class Layout:
    """A text divided into cells."""

    separator: str
    header: Row | None  # the line that names the columns
    units: Row | None  # the line below it that holds nothing but units
    rows: list[Row]  # from the first one of numbers on; text among them is left

    @property
    def width(self) -> int:
        """Number of cells that most rows have."""
        return Counter(len(cells) for _, cells in self.rows).most_common(1)[0][0]

    @property
    def is_numeric(self) -> int:
        """Return the number of rows with two numbers or more."""
        return sum(count_numbers(cells) > 1 for _, cells in self.rows)


def count_numbers(cells: Sequence[str]) -> int:
    """Return how many cells are numbers, with a unit behind them or without."""
    found = (as_number(cell) for cell in cells)
    return sum(cell is not None and (not cell.tail or is_unit(cell.tail)) for cell in found)


def layout_of(text: str, knows: Callable[[list[str]], int]) -> Layout | None:
    """Return the layout in which most columns are known and most rows are numbers; None of a text without.

    `knows` counts the cells of a header whose meaning is known.
    """
    lines = [line for line in _lines(text) if line[1].strip()]
    stated = None
    if lines and (found := re.fullmatch(r"\s*\"?sep=(.)\"?\s*", lines[0][1], re.I)):
        stated, lines = found[1], lines[1:]  # a mark of spreadsheets
    comments = [(number, _COMMENT.sub("", line, count=1)) for number, line in lines if _COMMENT.match(line)]
    lines = [line for line in lines if not _COMMENT.match(line[1])]
    separators = [stated] if stated else list(SEPARATORS)
    found_layouts = [each for sign in separators if (each := _divided(lines, comments, sign, knows))]

    def merit(layout: Layout) -> tuple[int, int]:
        known = min(knows(layout.header[1]), 2) if layout.header else 0
        return known, layout.is_numeric

    return max(found_layouts, key=merit, default=None)


def _lines(text: str) -> Iterator[Line]:
    """Lines with their numbers; a quoted cell of a header that holds line ends stays in one line."""
    lines, i = text.splitlines(), 0
    while i < len(lines):
        whole, last = lines[i], i
        while _OPEN_QUOTE.search(whole) and last < min(i + _HEAD_LINES, len(lines) - 1):
            last += 1
            whole = f"{whole} {lines[last]}"
        if _OPEN_QUOTE.search(whole):  # no quote, but a sign for inches
            whole, last = lines[i], i
        yield last + 1, whole
        i = last + 1


def _divided(
    lines: list[Line], comments: list[Line], separator: str, knows: Callable[[list[str]], int]
) -> Layout | None:
    rows = [(number, _cells(line, separator)) for number, line in lines]
    begin = _first_of_numbers(rows)
    if begin is None:
        return None
    width = Counter(len(cells) for _, cells in rows[begin:]).most_common(1)[0][0]
    header, below = _header_above(lines[:begin], separator, width, knows)
    if header:
        return Layout(separator, header, below, rows[begin:])
    for number, line in reversed([each for each in comments if not lines or each[0] < rows[begin][0]]):
        cells = _header_cells(line, separator, width)
        if below is None and len(cells) > 1 and _are_units(cells):
            below = number, cells
        elif knows(cells) > 1:
            return Layout(separator, (number, cells), below, rows[begin:])
    return Layout(separator, None, below, rows[begin:])


def _header_above(
    lines: list[Line], separator: str, width: int, knows: Callable[[list[str]], int]
) -> tuple[Row | None, Row | None]:
    """The line that names the columns, and that of their units.

    It is the lowest line of which two quantities are known, else the lowest of several words.
    """
    header: Row | None = None
    below: Row | None = None
    for number, line in reversed(lines):
        cells = _header_cells(line, separator, width)
        if len(cells) < 2 or not re.search(r"[^\W\d_]|[°%]", line):
            continue
        if below is None and _are_units(cells):
            below = number, cells
        elif knows(cells) > 1:
            return (number, cells), below
        else:
            header = header or (number, cells)
    return header, below


def _are_units(cells: Sequence[str]) -> bool:
    """Tell whether cells hold nothing but units, behind a word that says so or not."""
    own = cells[1:] if re.fullmatch(r"(units?|einheit(en)?|unité|unidad)\W*", cells[0], re.I) else cells
    return all(is_unit(cell) or is_missing(cell) for cell in own) and any(is_unit(cell) for cell in own)


def _first_of_numbers(rows: list[Row]) -> int | None:
    """Index of the first row of numbers that is followed by others like it."""
    counts = [count_numbers(cells) for _, cells in rows]
    most = Counter(count for count in counts if count > 1).most_common(1)
    numeric = [count > 1 for count in counts]
    for i, is_one in enumerate(numeric):
        if is_one and counts[i] < most[0][0] and _is_word(rows[i][1][0]):
            continue  # numbers of channels behind a word
        ahead = numeric[i : i + _AHEAD + 1]
        if is_one and sum(ahead) > len(ahead) / 2:
            return i
    return None


def _is_word(cell: str) -> bool:
    return as_number(cell) is None and bool(re.match(r"[^\W\d_]", cell))


def _header_cells(line: str, separator: str, width: int) -> list[str]:
    """The cells of a header; names of several words with a unit each are told apart by the units."""
    cells = _cells(line, separator)
    if separator == " " and len(cells) != width:
        named = [name.strip() for name in re.findall(r"[^\[\]()]+[\[(][^\])]*[\])]", line)]
        if len(named) == width:
            return named
    return cells


def _cells(line: str, separator: str) -> list[str]:
    if separator.isspace() and separator != "\t":
        held = re.sub(r"[\[(][^\])]*[\])]", lambda unit: unit[0].replace(" ", "\0"), line.strip())
        held = re.sub(r"(?<=\S) (?=[\[(])", "\0", held)
        pattern = r"\s{2,}|\t" if separator == "  " else r"\s+"
        return [cell.replace("\0", " ") for cell in re.split(pattern, held)]
    try:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except (csv.Error, StopIteration):
        cells = line.split(separator)
    cells = [cell.strip() for cell in cells]
    while len(cells) > 1 and not cells[-1]:  # a separator at the end of a line
        cells.pop()
    return cells
