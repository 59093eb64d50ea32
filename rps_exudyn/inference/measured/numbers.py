"""Numbers as people and spreadsheets write them: decimal commas, thousands, missing values.

All cells of a column are read at once, as one text with a line for each.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_BLANKS = " \u00a0\u202f\u2009"
_SIGNS = str.maketrans({"−": "-", "–": "-", "’": "'"})
_NUMBER = re.compile(
    rf"^(?:(?P<digits>[+-]?[^\S\n]?(?:\d{{1,3}}(?:['{_BLANKS}]\d{{3}})+(?:[.,]\d*)?|\d[\d.,]*|[.,]\d+))"
    rf"[{_BLANKS}]*(?P<power>[eEdD][+-]?\d+)?[^\S\n]*(?P<tail>[^\d\s.,'+-].*)?|.*)$",
    re.M,
)
_PLAIN = re.compile(r"(?:[+-]?\d+(?:\.\d*)?(?:[eE][+-]?\d+)?\n)*")  # a column as programs write it
_TEXT_OF_A_CELL = re.compile(r'="(.*)"')  # ="0.63" of a spreadsheet that keeps numbers as texts
_PLACEHOLDER = re.compile(r"[+-]?9[90]*(?:[.,][90]*)?")
_MISSING = re.compile(
    r"[-–—*.?_#]*|nan|[+-]?inf|n\s*[/.]\s*a\.?|na|#n/?a!?|#nv|null|none|nil|void|fehlt|missing|over|overflow|ovld|ovfl?|ol|o\.l\.?|"
    r"#div/0!?|#wert!?|#value!?|[+-]?1\.#\w+",
    re.I,
)


def parsed(cells: Sequence[str]) -> list[tuple[str, str, str]]:
    """Return of each cell a number's digits, power of ten and what follows it, for instance a unit.

    A cell that does not begin as a number does has no digits.
    """
    text = _TEXT_OF_A_CELL.sub(r"\1", "\n".join([cell.strip() for cell in cells])).translate(_SIGNS)
    return _NUMBER.findall(text) if cells else []


def is_missing(cell: str) -> bool:
    """Return whether a cell stands for a value that is not there: empty, dashes, NaN, n/a."""
    return bool(_MISSING.fullmatch(cell.strip()))


def is_number(cell: str) -> bool:
    return bool(parsed([cell])[0][0])


def is_placeholder(cell: str) -> bool:
    """Return whether a number may stand for a missing value or an overload: -9999, 9.9E37."""
    return bool(_PLACEHOLDER.fullmatch(parsed([cell])[0][0]))


@dataclass(frozen=True)
class Format:
    decimal: str  # "." or ","
    thousands: bool  # whether its other sign stands between thousands
    undecided: str = ""  # a number with a point that is taken for a decimal one, where none shows it

    def column(self, cells: Sequence[str], units: Sequence[str] | None = None) -> np.ndarray:
        """Return the numbers of a column's cells, shape (n,); NaN for each cell that is none in this format.

        `units` are what may follow a number; None: anything.
        """
        plain = self.decimal == "." and (units is None or "" in units)
        if plain and _PLAIN.fullmatch("".join([f"{cell}\n" for cell in cells])):
            return np.array(list(map(float, cells)), dtype=float)
        other = "," if self.decimal == "." else "."
        written = [
            digits + power if units is None or tail in units else "" for digits, power, tail in parsed(cells)
        ]
        text = re.sub(rf"['{_BLANKS}]", "", "\n".join(written))
        whole, fraction = rf"\d{{1,3}}(?:\{other}\d{{3}})+|\d+", rf"\{self.decimal}\d*"
        number = rf"[+-]?(?:(?:{whole})(?:{fraction})?|\{self.decimal}\d+)(?:[eEdD][+-]?\d+)?"
        numbers = re.findall(rf"^(?:({number})|.*)$", text, re.M) if cells else []
        text = "\n".join([each or "nan" for each in numbers]).replace(other, "").replace(",", ".")
        return np.array(list(map(float, text.replace("d", "e").replace("D", "e").split())), dtype=float)

    @property
    def words(self) -> str:
        sign, other = ("point", "comma") if self.decimal == "." else ("comma", "point")
        if self.thousands:
            return f"decimal {sign}, {other} between thousands"
        return f"decimal {sign}" + (f" ({self.undecided} is no thousands)" if self.undecided else "")


class AmbiguousNumbersError(ValueError):
    """Raised where a comma may be decimal or stand between thousands; its text is an example."""


_LEADING = re.compile(r"(?<![^\n+-])[1-9]")
_SHAPE = str.maketrans("123456789", "000000000")


def format_of(numbers: Sequence[str]) -> Format:
    """Return the one format in which the digits of all these numbers make sense.

    Raises:
        AmbiguousNumbersError: 1,234 and nothing else shows whether that is 1.234 or 1234.
    """
    shapes = _LEADING.sub("x", "\n".join(numbers)).translate(_SHAPE).split("\n")
    decimal, grouped, either, pointed = set(), set(), "", ""
    for shape, digits in dict(zip(reversed(shapes), reversed(numbers), strict=True)).items():
        point, comma = digits.count("."), digits.count(",")
        if point and comma:
            last = max(".,", key=digits.rfind)
            decimal.add(last)
            grouped.add("," if last == "." else ".")
        elif comma > 1 or point > 1:
            grouped.add("," if comma else ".")
        elif comma and re.fullmatch(r"[+-]?x0{0,2},000", shape):
            either = digits
        elif comma:
            decimal.add(",")
        elif point and re.fullmatch(r"[+-]?x0{0,2}\.000", shape):
            pointed = digits
        elif point:
            decimal.add(".")
    if len(decimal) > 1:
        return Format(".", False)  # the cells that do not fit are named when they are read
    if decimal or grouped:
        sign = next(iter(decimal)) if decimal else ("." if "," in grouped else ",")
        return Format(sign, bool(grouped) or (bool(either) and sign == "."))
    if either:
        raise AmbiguousNumbersError(either)
    return Format(".", False, pointed)
