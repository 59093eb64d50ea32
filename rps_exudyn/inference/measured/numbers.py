"""Numbers as people and spreadsheets write them: decimal commas, thousands, missing values.

Cells of one pattern differ in their digits alone. The pattern decides how a cell is read, so that a column is
parsed once for each of its patterns.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

_BLANKS = " \u00a0\u202f\u2009"
_SIGNS = str.maketrans({"−": "-", "–": "-", "’": "'"})
_NUMBER = re.compile(
    rf"(?P<digits>[+-]?\s?(?:\d[\d.,'{_BLANKS}]*|[.,]\d+))(?P<power>[eEdD][+-]?\d+)?(?P<tail>\s*[^\d\s.,'+-].*)?"
)
_GROUPED = re.compile(rf"[+-]?\s?\d{{1,3}}(?:['{_BLANKS}]\d{{3}})+(?:[.,]\d*)?")
_TEXT_OF_A_CELL = re.compile(r'="(.*)"')  # ="0.63" of a spreadsheet that keeps numbers as texts
_PATTERN = str.maketrans("123456789", "000000000")
_PLACEHOLDER = re.compile(r"[+-]?9[90]*(?:[.,][90]*)?")
_MISSING = re.compile(
    r"[-–—*.?_#]*|nan|[+-]?inf|n\s*[/.]\s*a\.?|na|#n/?a!?|#nv|null|none|nil|void|fehlt|missing|over|overflow|ovld|ovfl?|ol|o\.l\.?|"
    r"#div/0!?|#wert!?|#value!?|[+-]?1\.#\w+",
    re.I,
)


@dataclass(frozen=True)
class Cell:
    """What a cell may be: a number's digits, power of ten and what follows it, for instance a unit."""

    digits: str
    power: str
    tail: str

    @property
    def tail_has_digits(self) -> bool:
        """Whether the tail may be another one in a cell of the same pattern."""
        return any(sign.isdigit() for sign in self.tail)


def is_missing(cell: str) -> bool:
    """Return whether a cell stands for a value that is not there: empty, dashes, NaN, n/a."""
    return bool(_MISSING.fullmatch(cell.strip()))


def as_number(cell: str) -> Cell | None:
    """Return the parts of a cell that begins as a number does; None of any other."""
    found = _NUMBER.fullmatch(_TEXT_OF_A_CELL.sub(r"\1", cell.strip()).translate(_SIGNS))
    if not found:
        return None
    digits = found["digits"].strip()
    if re.search(rf"['{_BLANKS}]", digits[1:].strip()) and not _GROUPED.fullmatch(digits):
        return None
    return Cell(digits, found["power"] or "", (found["tail"] or "").strip())


def is_placeholder(cell: str) -> bool:
    """Return whether a number may stand for a missing value or an overload: -9999, 9.9E37."""
    found = as_number(cell)
    return found is not None and bool(_PLACEHOLDER.fullmatch(found.digits))


def pattern(text: str) -> str:
    """Return the text with 0 for each digit from 1 to 9."""
    return text.translate(_PATTERN)


def patterns(texts: Sequence[str]) -> list[str]:
    """Return the pattern of each text, by one translation of all of them."""
    return pattern("\n".join(texts)).split("\n") if texts else []


def one_of_each(cells: Iterable[str]) -> Iterator[Cell]:
    """Parse the numbers among the cells, of each pattern the first with a leading zero and the first without.

    All numbers of a pattern are parsed where digits follow them, for instance in a unit.
    """
    alike: dict[str, list[str]] = {}
    cells = list(cells)
    for cell, of_cell in zip(cells, patterns(cells), strict=True):
        alike.setdefault(of_cell, []).append(cell)
    for of_cell, group in alike.items():
        first = as_number(group[0])
        if first is None:
            continue
        yield first
        if first.tail_has_digits:
            yield from (number for cell in group[1:] if (number := as_number(cell)) is not None)
        elif (digit := of_cell.find("0")) >= 0:
            leads = group[0][digit] == "0"
            other = next((cell for cell in group if (cell[digit] == "0") != leads), None)
            if other is not None and (number := as_number(other)) is not None:
                yield number


@dataclass(frozen=True)
class Format:
    """How a file writes numbers."""

    decimal: str  # "." or ","
    thousands: bool  # whether its other sign stands between thousands
    undecided: str = ""  # a number with a point that is taken for a decimal one, where none shows it

    def value(self, cell: Cell) -> float:
        """Return the number.

        Raises:
            ValueError: it is none in this format.
        """
        digits = re.sub(rf"['{_BLANKS}]", "", cell.digits)
        other = "," if self.decimal == "." else "."
        whole, sign, fraction = digits.partition(self.decimal)
        grouped = other not in whole or re.fullmatch(rf"[+-]?\d{{1,3}}(\{other}\d{{3}})+", whole)
        if other in fraction or not grouped:
            raise ValueError(cell.digits)
        power = cell.power.replace("d", "e").replace("D", "e")  # of Fortran
        return float(whole.replace(other, "") + sign.replace(",", ".") + fraction + power)

    def column(self, cells: Sequence[str], units: Sequence[str] | None = None) -> np.ndarray:
        """Return the numbers of a column's cells, shape (n,); NaN for each cell that is none in this format.

        `units` are what may follow a number; None: anything.
        """
        of_cells = patterns(cells)
        of_pattern = dict(zip(of_cells, cells, strict=True))
        readers = {of_cell: self._reader(cell, units) for of_cell, cell in of_pattern.items()}
        if cells and all(reader is None for reader in readers.values()):
            return np.array([float(cell) for cell in "\n".join(cells).replace(",", ".").split("\n")])
        values = []
        for cell, of_cell in zip(cells, of_cells, strict=True):
            reader = readers[of_cell]
            values.append(reader(cell) if reader else float(cell.replace(",", ".")))
        return np.array(values, dtype=float)

    def _reader(self, cell: str, units: Sequence[str] | None) -> Callable[[str], float] | None:
        """The function that reads all cells of this one's pattern; None where `float` does, commas aside."""

        def number_of(text: str) -> float:
            found = as_number(text)
            if found is None or (units is not None and found.tail not in units):
                return np.nan
            try:
                return self.value(found)
            except ValueError:
                return np.nan

        found = as_number(cell)
        if found is None:
            return lambda text: np.nan
        number = found.digits + found.power
        plain = re.fullmatch(rf"[+-]?[0-9]*\{self.decimal}?[0-9]*(?:[eE][+-]?[0-9]+)?", number)
        if not plain or not cell.startswith(number) or found.tail_has_digits:
            return number_of
        if units is not None and found.tail not in units:
            return lambda text: np.nan
        return None if cell == number else lambda text: float(text[: len(number)].replace(",", "."))

    @property
    def words(self) -> str:
        """The format in words."""
        sign, other = ("point", "comma") if self.decimal == "." else ("comma", "point")
        if self.thousands:
            return f"decimal {sign}, {other} between thousands"
        return f"decimal {sign}" + (f" ({self.undecided} is no thousands)" if self.undecided else "")


class AmbiguousNumbersError(ValueError):
    """Raised where a comma may be decimal or stand between thousands; its text is an example."""


def format_of(cells: Iterable[Cell]) -> Format:
    """Return the one format in which all these numbers make sense.

    Raises:
        AmbiguousNumbersError: 1,234 and nothing else shows whether that is 1.234 or 1234.
    """
    decimal, grouped, either, pointed = set(), set(), "", ""
    for digits in {cell.digits for cell in cells}:
        point, comma = digits.count("."), digits.count(",")
        if point and comma:
            last = max(".,", key=digits.rfind)
            decimal.add(last)
            grouped.add("," if last == "." else ".")
        elif comma > 1 or point > 1:
            grouped.add("," if comma else ".")
        elif comma and re.fullmatch(r"[+-]?[1-9]\d{0,2},\d{3}", digits):
            either = either or digits
        elif comma:
            decimal.add(",")
        elif point and re.fullmatch(r"[+-]?[1-9]\d{0,2}\.\d{3}", digits):
            pointed = pointed or digits
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
