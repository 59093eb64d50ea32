"""Which column of a file holds which quantity, and in which unit; a unit is never guessed."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short
from rps_exudyn.inference.measured.bench_units import BESIDE, is_unit_beside, unit_size
from rps_exudyn.inference.measured.numbers import parsed
from rps_exudyn.results.quantities import SIGNALS

Row = tuple[int, list[str]]  # number of a line, and its cells

NAMES = {
    "pinion_angle": r"angle|phi|φ|theta|winkel|\w*winkel|verdrehung|drehung|rotation",
    "pinion_torque": r"torque|trq|moment|\w*moment|md|tq|m_d",
    "rack_displacement": r"displacement|travel|stroke|weg|\w+weg|hub|\w*verschiebung",
    "rack_force": r"force|\w*kraft",
}
"""Quantity -> words that name it in the header of a file, as a regular expression."""

_SPEED = r"(?:\w+ )?(?:speed|velocity|rate)|drehzahl|(?:winkel|dreh)?geschwindigkeit|n|omega|v"
NAMES_BESIDE = {
    "clock": r"time|zeit|t|messzeit|elapsed(?: time)?|timestamp",
    "speed": _SPEED,
    "rack_speed": _SPEED,
}
"""Likewise of what stands beside the curve, or instead of an angle; of the whole name."""

GERMAN = re.compile(r"winkel|moment\b|drehung|weg\b|hub\b|kraft|verschiebung", re.I)
EXAMPLES = {
    "pinion_angle": "[deg]",
    "pinion_torque": "[N m]",
    "rack_displacement": "[mm]",
    "rack_force": "[N]",
}
MOST_SHOWN = 30  # columns in a message
_BRACKETS = re.compile(r"(?P<name>.*?)\s*[\[({<]\s*(?P<unit>[^\])}>]*?)\s*[\])}>]\s*")
_BETWEEN = re.compile(r"\s*/\s*|\s*,\s*|\s+in\s+|_|\s*:\s*|\s+|(?<=[a-zäöü])(?=[A-Z°])")
_CHOSEN = re.compile(r"\s*(?P<title>.*?)\s*(?:\[\s*(?P<unit>[^\]]+?)\s*\])?\s*")
_OTHER_PARTS = re.compile(r"yoke|plunger|joch|druckst|bush|buchse|housing|gehäuse|tie|wheel|probe|dial", re.I)


@dataclass(frozen=True)
class Title:
    """A cell of a header divided into name and unit."""

    index: int
    text: str
    name: str
    unit: str  # "" without one

    def is_named(self, quantity: str) -> bool:
        """Return whether the name is that of a quantity."""
        name = self.name.strip().lower()
        if quantity in NAMES_BESIDE:
            return bool(re.fullmatch(NAMES_BESIDE[quantity], name))
        words = re.split(r"[\s_.\-/]+", name)
        return any(re.fullmatch(NAMES[quantity], word) for word in (*words, name))

    def size(self, quantity: str) -> float | None:
        """Return the size of the unit in SI; None if it is none of the quantity."""
        if quantity in NAMES_BESIDE:
            return BESIDE[quantity].get(self.unit.strip().lower())
        return unit_size(self.unit, SIGNALS[quantity].unit, bool(GERMAN.search(self.name)))


@dataclass(frozen=True)
class Table:
    """A text divided into cells."""

    separator: str
    header: Row | None  # the line that names the columns
    units: Row | None  # the line below it that holds nothing but units
    rows: list[Row]  # from the first one of numbers on; text among them is left

    @property
    def width(self) -> int:
        return most_frequent([len(cells) for _, cells in self.rows])

    @cached_property
    def titles(self) -> list[Title]:
        return _titles(self.header[1], self.units[1] if self.units else []) if self.header else []

    def column(self, index: int) -> list[str]:
        return [cells[index] if index < len(cells) else "" for _, cells in self.rows]

    def names_quantity(self, quantity: str) -> bool:
        """Return whether a title has a name of the quantity, and not of another part's."""
        return any(each.is_named(quantity) and not _OTHER_PARTS.search(each.text) for each in self.titles)

    @cached_property
    def beside(self) -> dict[str, tuple[int, float]]:
        """Index and size of the unit in SI of `clock`, `speed` and `rack_speed`, as far as one title each
        names them with a unit that is certain."""
        found = {}
        for quantity in NAMES_BESIDE:
            fitting = [
                (each.index, size)
                for each in self.titles
                if each.is_named(quantity) and (size := each.size(quantity))
            ]
            if len(fitting) == 1:
                found[quantity] = fitting[0]
        return found


def most_frequent(counts: Iterable[int]) -> int:
    """Return the count that is there most often, of several the first one."""
    return Counter(counts).most_common(1)[0][0]


def known_columns(header: Sequence[str]) -> int:
    """Return how many quantities the cells of a header name, or have a unit of."""
    titles = _titles(header, [])
    return sum(any(t.is_named(name) or t.size(name) is not None for t in titles) for name in NAMES)


def _titles(header: Sequence[str], below: Sequence[str]) -> list[Title]:
    titles = []
    for index, cell in enumerate(header):
        text = cell.strip().strip("\"'").strip()
        brackets = _BRACKETS.fullmatch(text)
        name, unit = (brackets["name"], brackets["unit"]) if brackets else _divided(text)
        if index < len(below) and not (brackets and unit):
            unit = below[index].strip().strip("[](){}<> ") or unit
        titles.append(Title(index, text, name, unit))
    return titles


def _divided(text: str) -> tuple[str, str]:
    """Name and unit of a title without brackets, where a unit follows a word: torque_Nm, Moment/Nm."""
    for between in _BETWEEN.finditer(text):
        title = Title(0, text, text[: between.start()], text[between.end() :])
        for quantity in (*NAMES, *NAMES_BESIDE):
            if title.unit and title.is_named(quantity) and title.size(quantity) is not None:
                return title.name, title.unit
    return text, ""


@dataclass(frozen=True)
class MeasuredColumn:
    quantity: str
    index: int
    title: str
    unit: str
    size: float  # of the unit in SI
    assumed: str = ""  # what was taken for granted

    @property
    def words(self) -> str:
        """What was read, and in which unit."""
        why = f" ({self.assumed})" if self.assumed else ""
        return f"{self.quantity} from column {self.title!r} in {self.unit} = {self.size:.6g} in SI{why}"


def find_columns(
    path: object, table: Table, wanted: Iterable[str], chosen: Mapping[str, str]
) -> list[MeasuredColumn]:
    """Return the columns of the wanted quantities; `chosen` is quantity -> "TITLE [unit]" or "NUMBER [unit]".

    Raises:
        InputError: a column or its unit is missing, or several may be meant; one sentence for each.
    """
    wanted = tuple(wanted)
    if table.header is None and not chosen:
        example = ", ".join(f"{name} {EXAMPLES[name]}" for name in wanted)
        raise InputError(
            f"{path} has no line that names its columns; write for instance {example} over the numbers, or "
            f'choose them by number: --column {wanted[0]}="1 {EXAMPLES[wanted[0]]}".'
        )
    where = f"{path}, line {table.header[0]}" if table.header and table.header[0] else str(path)
    problems, found = [], []
    for quantity in wanted:
        try:
            if quantity in chosen:
                title = _chosen(where, table, quantity, chosen[quantity])
            else:
                title = _found(where, table.titles, quantity)
            found.append(_with_unit(where, table, title, quantity))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return found


def _found(where: str, titles: list[Title], quantity: str) -> Title:
    """The one column that may be meant."""
    exact = [each for each in titles if each.name.strip().lower() == quantity]
    named = exact or [each for each in titles if each.is_named(quantity)]
    if len(named) > 1:  # angle [deg] beside angle speed [deg/s]
        named = [each for each in named if not is_unit_beside(each.unit)] or named
    fitting = named or [each for each in titles if each.unit and each.size(quantity) is not None]
    choice = f'--column {quantity}="{{}} {EXAMPLES[quantity]}"'
    if not fitting:
        raise InputError(
            f"{where} has no column {quantity} with its unit, only {_shown(titles)}; name one {quantity} "
            f"{EXAMPLES[quantity]}, or choose one: {choice.format('TITLE')}."
        )
    if len(fitting) > 1:
        is_driven = quantity in ("pinion_angle", "rack_displacement")
        below = "" if is_driven else "; if they are two directions, write one below the other"
        raise InputError(
            f"{where} has {len(fitting)} columns that may be {quantity}: {_shown(fitting, ' and ')}; choose "
            f"one: {choice.format(fitting[0].name or fitting[0].index + 1)}{below}."
        )
    return fitting[0]


def _shown(titles: Sequence[Title], between: str = ", ") -> str:
    """The titles as a list, of a very wide table the first ones."""
    more = [f"{len(titles) - MOST_SHOWN} more"] if len(titles) > MOST_SHOWN else []
    return between.join([*(short(each.text, 30) for each in titles[:MOST_SHOWN]), *more])


def _chosen(where: str, table: Table, quantity: str, choice: str) -> Title:
    """The column of a title, or of a number from 1 on; with the unit that was stated."""
    parts = _CHOSEN.fullmatch(choice)
    title, unit = (parts["title"], parts["unit"] or "") if parts else (choice, "")
    titles = table.titles
    alike = [each for each in titles if title in (each.text, each.name) or choice.strip() == each.text]
    if not alike and title.isdigit() and int(title) > 0:
        index = int(title) - 1
        alike = titles[index : index + 1] or [Title(index, title, title, "") for _ in table.rows[:1]]
    if len(alike) != 1:
        count = len(alike) or "no"
        there_are = _shown(titles) or "no names"
        raise InputError(
            f"{where} has {count} columns {short(title, 30)!r} for {quantity}; it has {there_are}."
        )
    found = alike[0]
    return Title(found.index, found.text, found.name, unit or found.unit)


def _with_unit(where: str, table: Table, title: Title, quantity: str) -> MeasuredColumn:
    """The column, with the unit of its title, or of its cells."""
    unit, from_cells = title.unit, ""
    if not unit:
        tails = {tail for digits, _, tail in parsed(table.column(title.index)) if digits}
        if len(tails) == 1 and "" not in tails:
            unit = from_cells = tails.pop()
    example = f'--column {quantity}="{title.name} {EXAMPLES[quantity]}"'
    if not unit:
        raise InputError(
            f"{where} gives no unit of {quantity} in column {short(title.text, 40)!r}; write it behind the "
            f"name, {title.name} {EXAMPLES[quantity]}, or state it: {example}."
        )
    size = Title(title.index, title.text, title.name, unit).size(quantity)
    if size is None:
        raise InputError(
            f"{where}: [{short(unit, 30)}] is no unit of {quantity} that is unambiguous; write for instance "
            f"{EXAMPLES[quantity]}, or state it: {example}."
        )
    by_unit = not title.is_named(quantity) and title.name != quantity and not from_cells
    assumed = "chosen by its unit" if by_unit else "unit from its cells" if from_cells else ""
    return MeasuredColumn(quantity, title.index, title.text, unit, size, assumed)
