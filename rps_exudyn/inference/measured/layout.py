"""The layout of a table in a text: what separates its cells, where its names, units and numbers stand."""

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.measured.bench_units import is_unit
from rps_exudyn.inference.measured.columns import Row, Table, known_columns, most_frequent
from rps_exudyn.inference.measured.numbers import is_missing, is_number, parsed

Line = tuple[int, str]

SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars", ",": "commas"}
SEPARATORS |= {"  ": "two blanks or more", " ": "blanks"}
_COMMENT = re.compile(r"\s*(?:#|%|//|!|\*)+")
_OPEN_QUOTE = re.compile(r'^(?:[^"]*"[^"]*")*(?:[^"]*[;,\t|])?\s*"[^"]*$')
_HEAD_LINES = 4  # that a quoted name and its unit may take beside the first
_AHEAD = 4  # rows that follow the first one of numbers, of which most must be numbers too
_PATTERN = str.maketrans("123456789", "000000000")


class _Division(NamedTuple):
    separator: str
    header: Row | None
    units: Row | None
    begin: int  # index of the line with the first row of numbers
    numeric: int  # number of rows with two numbers or more


def table_in(text: str) -> Table | None:
    """Return the table in which most columns are known and most rows are numbers; None of a text without."""
    lines = [line for line in _lines(text) if line[1].strip()]
    separators = list(SEPARATORS)
    if lines and (stated := re.fullmatch(r"\s*\"?sep=(\D)\"?\s*", lines[0][1], re.I)):
        separators, lines = [stated[1]], lines[1:]  # a mark of spreadsheets
    marked = [(line, _COMMENT.match(line[1])) for line in lines]
    comments = [(number, line[mark.end() :]) for (number, line), mark in marked if mark]
    lines = [line for line, mark in marked if not mark]
    divisions = [each for sign in separators if (each := _divided(lines, comments, sign))]
    best = max(
        divisions,
        key=lambda each: (min(known_columns(each.header[1]), 2) if each.header else 0, each.numeric),
        default=None,
    )
    if best is None:
        return None
    numbers, texts = zip(*lines[best.begin :], strict=True)
    if best.separator in ("  ", " ") or '"' in text:
        cells = [_cells(line, best.separator) for line in texts]
    else:
        cells = _plain_cells("\n".join(texts), best.separator)
    rows = list(zip(numbers, cells, strict=True))
    return Table(best.separator, best.header, best.units, rows)


def _lines(text: str) -> list[Line]:
    """Lines with their numbers; a quoted cell of a header that holds line ends stays in one line."""
    lines, found, i = text.splitlines(), list[Line](), 0
    if '"' not in text:
        return list(enumerate(lines, 1))
    while i < len(lines):
        whole, last = lines[i], i
        while _OPEN_QUOTE.search(whole) and last < min(i + _HEAD_LINES, len(lines) - 1):
            last += 1
            whole = f"{whole} {lines[last]}"
        if _OPEN_QUOTE.search(whole):  # no quote, but a sign for inches
            whole, last = lines[i], i
        found.append((last + 1, whole))
        i = last + 1
    return found


def _divided(lines: list[Line], comments: list[Line], separator: str) -> _Division | None:
    """How a separator divides the lines; None where no row of numbers follows."""
    counted = _counted([line for _, line in lines], separator)
    begin = _first_of_numbers(lines, [count for count, _ in counted], separator)
    if begin is None:
        return None
    width = most_frequent([cells for _, cells in counted[begin:]])
    header, below = _names_in(lines[:begin], separator, width, None)
    if not header:
        above = [each for each in comments if each[0] < lines[begin][0]]
        header, below = _names_in(above, separator, width, below)
        header = header if header and known_columns(header[1]) > 1 else None
    return _Division(separator, header, below, begin, sum([count > 1 for count, _ in counted[begin:]]))


def _counted(lines: list[str], separator: str) -> list[tuple[int, int]]:
    """Numbers and cells of each line; lines that differ in digits alone have as many."""
    patterns = "\n".join(lines).translate(_PATTERN).split("\n")
    counted = {}
    for pattern, line in dict(zip(patterns, lines, strict=False)).items():
        cells = _cells(line, separator)
        numbers = [bool(digits) and (not tail or is_unit(tail)) for digits, _, tail in parsed(cells)]
        counted[pattern] = sum(numbers), len(cells)
    return [counted[pattern] for pattern in patterns] if lines else []


def _names_in(
    lines: list[Line], separator: str, width: int, below: Row | None
) -> tuple[Row | None, Row | None]:
    """The line that names the columns, and that of their units, if it is not known to be `below`.

    It is the lowest line of which two quantities are known, else the lowest of several words.
    """
    header: Row | None = None
    for number, line in reversed(lines):
        cells = _header_cells(line, separator, width)
        if len(cells) < 2 or not re.search(r"[^\W\d_]|[°%]", line):
            continue
        if below is None and _are_units(cells):
            below = number, cells
        elif known_columns(cells) > 1:
            return (number, cells), below
        else:
            header = header or (number, cells)
    return header, below


def _are_units(cells: Sequence[str]) -> bool:
    """Return whether cells hold nothing but units, behind a word for unit or not."""
    units = cells[1:] if re.fullmatch(r"(units?|einheit(en)?|unité|unidad)\W*", cells[0], re.I) else cells
    return all(is_unit(cell) or is_missing(cell) for cell in units) and any(is_unit(cell) for cell in units)


def _first_of_numbers(lines: list[Line], counts: list[int], separator: str) -> int | None:
    """Index of the first row of numbers that others follow; `counts` are the numbers of each line."""
    numeric = [count > 1 for count in counts]
    if not any(numeric):
        return None
    most = most_frequent([count for count in counts if count > 1])
    for i, is_one in enumerate(numeric):
        if is_one and counts[i] < most:
            cell = _cells(lines[i][1], separator)[0]
            if not is_number(cell) and re.match(r"[^\W\d_]", cell):
                continue  # numbers of channels behind a word
        ahead = numeric[i : i + _AHEAD + 1]
        if is_one and sum(ahead) > len(ahead) / 2:
            return i
    return None


def _header_cells(line: str, separator: str, width: int) -> list[str]:
    """The cells of a header; names of several words with a unit each are separated by the units."""
    cells = _cells(line, separator)
    if separator == " " and len(cells) != width:
        named = [name.strip() for name in re.findall(r"[^\[\]()]+[\[(][^\])]*[\])]", line)]
        if len(named) == width:
            return named
    return cells


def _cells(line: str, separator: str) -> list[str]:
    """The cells of a line, of which some may stand in quotes and hold the separator."""
    if separator.isspace() and separator != "\t":
        if separator == " " and not re.search(r"[\[(\0]", line):
            return line.split()
        held = re.sub(r"[\[(][^\])]*[\])]", lambda unit: unit[0].replace(" ", "\0"), line.strip())
        held = re.sub(r"(?<=\S) (?=[\[(])", "\0", held)
        between = r"\s{2,}|\t" if separator == "  " else r"\s+"
        return [cell.replace("\0", " ") for cell in re.split(between, held)]
    if '"' not in line:
        return _plain_cells(line, separator)[0]
    cells = line.split(separator)
    with suppress(csv.Error, StopIteration):
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    cells = [cell.strip() for cell in cells]
    while len(cells) > 1 and not cells[-1]:  # a separator at the end of a line
        cells.pop()
    return cells


def _plain_cells(text: str, separator: str) -> list[list[str]]:
    """The cells of each line of a text without quotes, all at once."""
    sign, blank = re.escape(separator), r"[^\S\n\t]" if separator == "\t" else r"[^\S\n]"
    text = re.sub(rf"^{blank}+|{blank}+$|{blank}*(?={sign})|(?<={sign}){blank}+", "", text, flags=re.M)
    text = re.sub(rf"(?:{sign})+$", "", text, flags=re.M)  # a separator at the end of a line
    return [line.split(separator) for line in text.split("\n")]


# --- The text of a file whose encoding nobody states

_OTHER_FILES = {
    b"PK\x03\x04": "a spreadsheet or an archive; save its table as CSV",
    b"\xd0\xcf\x11\xe0": "a spreadsheet; save its table as CSV",
    b"\x89HDF": "an HDF5 file; write its curve as CSV",
    b"%PDF": "a PDF; write its curve as CSV",
}
_MARKS = {
    b"\xef\xbb\xbf": "utf-8-sig",
    b"\xff\xfe\x00\x00": "utf-32",
    b"\xff\xfe": "utf-16",
    b"\xfe\xff": "utf-16",
}


def text_of(path: str | Path, content: bytes) -> tuple[str, str]:
    """Return a file's text and its encoding: by its mark, else UTF-8, UTF-16 without a mark, or Windows-1252.

    Raises:
        InputError: it is no text.
    """
    for begin, what in _OTHER_FILES.items():
        if content.startswith(begin):
            raise InputError(f"{path} is {what}.")
    if 0 not in content[:2000]:
        content = content.rstrip(b"\0")  # of a logger that was switched off
    head = content[:2000]
    encodings = ["utf-8", "cp1252"]
    if head.count(0) > len(head) // 4:  # every other byte of Latin letters in UTF-16
        encodings = ["utf-16-le" if head[1::2].count(0) > head[::2].count(0) else "utf-16-be"]
    encodings = [encoding for mark, encoding in _MARKS.items() if content.startswith(mark)][:1] or encodings
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if not re.search(r"[\0-\x08\x0e-\x1b]", text[:20000]):
            return text, encoding
    raise InputError(
        f"{path} cannot be read: it is no text in UTF-8, UTF-16 or Windows-1252; save it as UTF-8."
    )
