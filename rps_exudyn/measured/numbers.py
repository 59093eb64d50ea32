"""Numbers as people and spreadsheets write them: decimal commas, thousands, missing values."""

import re
from collections.abc import Iterable
from dataclasses import dataclass

_BLANKS = " \u00a0\u202f\u2009"
_SIGNS = str.maketrans({"−": "-", "–": "-", "’": "'"})
_NUMBER = re.compile(
    rf"(?P<digits>[+-]?\s?(?:\d[\d.,'{_BLANKS}]*|[.,]\d+))(?P<power>[eEdD][+-]?\d+)?(?P<tail>\s*[^\d\s.,'+-].*)?"
)
_GROUPED = re.compile(rf"[+-]?\s?\d{{1,3}}(?:['{_BLANKS}]\d{{3}})+(?:[.,]\d*)?")
_TEXT_OF_A_CELL = re.compile(r'="(.*)"')  # ="0.63" of a spreadsheet that keeps numbers as texts
_PLACEHOLDER = re.compile(r"[+-]?9+[.,]?[90]*")
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


def is_missing(cell: str) -> bool:
    """Tell whether a cell stands for a value that is not there: empty, dashes, NaN, n/a."""
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
    """Tell whether a number may stand for a missing value or an overload: -9999, 9.9E37."""
    found = as_number(cell)
    return found is not None and bool(_PLACEHOLDER.fullmatch(found.digits))


@dataclass(frozen=True)
class Format:
    """How a file writes numbers."""

    decimal: str  # "." or ","
    thousands: bool  # whether its other sign stands between thousands
    undecided: str = ""  # a number with a point that is taken for a decimal one, where none tells

    def value(self, cell: Cell) -> float:
        """Return the number.

        Raises:
            ValueError: it is none in this format.
        """
        digits = re.sub(rf"['{_BLANKS}]", "", cell.digits)
        other = "," if self.decimal == "." else "."
        whole, sign, fraction = digits.partition(self.decimal)
        if other in fraction or (
            other in whole and not re.fullmatch(rf"[+-]?\d{{1,3}}(\{other}\d{{3}})+", whole)
        ):
            raise ValueError(cell.digits)
        power = cell.power.replace("d", "e").replace("D", "e")  # of Fortran
        return float(whole.replace(other, "") + sign.replace(",", ".") + fraction + power)

    @property
    def words(self) -> str:
        """The format in words."""
        sign = {".": "point", ",": "comma"}
        if not self.thousands:
            said = f" ({self.undecided} is no thousands)" if self.undecided else ""
            return f"decimal {sign[self.decimal]}{said}"
        return f"decimal {sign[self.decimal]}, {sign['.' if self.decimal == ',' else ',']} between thousands"


class AmbiguousNumbersError(ValueError):
    """Raised where a comma may be decimal or stand between thousands; its text is an example."""


def format_of(cells: Iterable[Cell]) -> Format:
    """Return the one format in which all these numbers make sense.

    Raises:
        AmbiguousNumbersError: 1,234 and nothing else tells whether that is 1.234 or 1234.
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
