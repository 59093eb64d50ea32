"""Which column of a file holds which quantity, and in which unit; a unit is never guessed."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import short
from rps_exudyn.inference.measured.bench_units import is_unit_beside, unit_size
from rps_exudyn.inference.measured.layout import Layout
from rps_exudyn.inference.measured.numbers import one_of_each
from rps_exudyn.results.quantities import SIGNALS

NAMES = {
    "pinion_angle": r"angle|phi|φ|theta|winkel|\w*winkel|verdrehung|drehung|rotation",
    "pinion_torque": r"torque|trq|moment|\w*moment|md|tq|m_d",
    "rack_displacement": r"displacement|travel|stroke|weg|\w+weg|hub|\w*verschiebung",
    "rack_force": r"force|\w*kraft",
}
"""Quantity -> words that name it in the header of a file, as a regular expression."""

GERMAN = re.compile(r"winkel|moment\b|drehung|weg\b|hub\b|kraft|verschiebung", re.I)
_DRIVEN = ("pinion_angle", "rack_displacement")
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


@dataclass(frozen=True)
class MeasuredColumn:
    """A column of a file."""

    quantity: str
    index: int
    title: str
    unit: str
    size: float  # of the unit in SI
    assumed: str = ""  # what was taken for granted


@dataclass(frozen=True)
class _Title:
    """A cell of a header divided into name and unit."""

    index: int
    text: str
    name: str
    unit: str  # "" without one

    def is_named(self, quantity: str) -> bool:
        words = re.split(r"[\s_.\-/]+", self.name.strip().lower())
        return any(re.fullmatch(NAMES[quantity], word) for word in (*words, self.name.strip().lower()))

    def size(self, quantity: str) -> float | None:
        return unit_size(self.unit, SIGNALS[quantity].unit, bool(GERMAN.search(self.name)))


def known_columns(header: Sequence[str]) -> int:
    """Return how many quantities the cells of a header name, or have a unit of."""
    titles = _titles(header, None)
    return sum(
        any(each.is_named(quantity) or each.size(quantity) is not None for each in titles)
        for quantity in NAMES
    )


_OTHERS = re.compile(r"yoke|plunger|joch|druckst|bush|buchse|housing|gehäuse|tie|wheel|probe|dial", re.I)


def names_quantity(layout: Layout, quantity: str) -> bool:
    """Return whether a header names a quantity of pinion or rack, with or without a unit."""
    titles = _titles(layout.header[1] if layout.header else [], layout.units[1] if layout.units else None)
    return any(each.is_named(quantity) and not _OTHERS.search(each.text) for each in titles)


def find_columns(
    path: object, layout: Layout, wanted: Iterable[str], chosen: Mapping[str, str]
) -> list[MeasuredColumn]:
    """Return the columns of the wanted quantities; `chosen` is quantity -> "TITLE [unit]" or "NUMBER [unit]".

    Raises:
        InputError: a column or its unit is missing, or several may be meant; one sentence for each.
    """
    wanted = tuple(wanted)
    if layout.header is None and not chosen:
        example = ", ".join(f"{name} {EXAMPLES[name]}" for name in wanted)
        raise InputError(
            f"{path} has no line that names its columns; write for instance {example} over the numbers, or "
            f'choose them by number: --column {wanted[0]}="1 {EXAMPLES[wanted[0]]}".'
        )
    header = layout.header[1] if layout.header else []
    titles = _titles(header, layout.units[1] if layout.units else None)
    where = f"{path}, line {layout.header[0]}" if layout.header and layout.header[0] else str(path)
    problems, found = [], []
    for quantity in wanted:
        try:
            title = _chosen(where, titles, quantity, chosen[quantity]) if quantity in chosen else None
            title = title or _found(where, titles, quantity)
            found.append(_with_unit(where, layout, title, quantity))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return found


def _titles(header: Sequence[str], below: Sequence[str] | None) -> list[_Title]:
    titles = []
    for index, cell in enumerate(header):
        text = cell.strip().strip("\"'").strip()
        brackets = _BRACKETS.fullmatch(text)
        name, unit = (brackets["name"], brackets["unit"]) if brackets else _divided(text)
        if below is not None and index < len(below) and not (brackets and unit):
            unit = below[index].strip().strip("[](){}<> ") or unit
        titles.append(_Title(index, text, name, unit))
    return titles


def _divided(text: str) -> tuple[str, str]:
    """Name and unit of a title without brackets, where a unit follows a word: torque_Nm, Moment/Nm."""
    for between in _BETWEEN.finditer(text):
        name, unit = text[: between.start()], text[between.end() :]
        title = _Title(0, text, name, unit)
        for quantity in NAMES:
            if name and unit and title.is_named(quantity) and title.size(quantity) is not None:
                return name, unit
    return text, ""


def _found(where: str, titles: list[_Title], quantity: str) -> _Title:
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
        below = "" if quantity in _DRIVEN else "; if they are two directions, write one below the other"
        raise InputError(
            f"{where} has {len(fitting)} columns that may be {quantity}: {_shown(fitting, ' and ')}; choose "
            f"one: {choice.format(fitting[0].name or fitting[0].index + 1)}{below}."
        )
    return fitting[0]


def _shown(titles: Sequence[_Title], between: str = ", ") -> str:
    """The titles as a list, of a very wide table the first ones."""
    more = [f"{len(titles) - MOST_SHOWN} more"] if len(titles) > MOST_SHOWN else []
    return between.join([*(short(each.text, 30) for each in titles[:MOST_SHOWN]), *more])


def _chosen(where: str, titles: list[_Title], quantity: str, choice: str) -> _Title:
    """The column of a title, or of a number from 1 on; with the unit that was stated."""
    parts = _CHOSEN.fullmatch(choice)
    title, unit = (parts["title"], parts["unit"] or "") if parts else (choice, "")
    alike = [each for each in titles if title in (each.text, each.name) or choice.strip() == each.text]
    if not alike and title.isdigit() and int(title) > 0:
        index = int(title) - 1
        alike = [each for each in titles if each.index == index] or [_Title(index, title, title, "")]
    if len(alike) != 1:
        count = len(alike) or "no"
        raise InputError(
            f"{where} has {count} columns {short(title, 30)!r} for {quantity}; it has "
            f"{_shown(titles) or 'no names'}."
        )
    found = alike[0]
    return _Title(found.index, found.text, found.name, unit or found.unit)


def _with_unit(where: str, layout: Layout, title: _Title, quantity: str) -> MeasuredColumn:
    """The column, with the unit of its title, or of its cells."""
    unit, from_cells = title.unit, ""
    if not unit:
        cells = (cells[title.index] for _, cells in layout.rows if title.index < len(cells))
        tails = {number.tail for number in one_of_each(cells)}
        if len(tails) == 1 and "" not in tails:
            unit = from_cells = tails.pop()
    example = f'--column {quantity}="{title.name} {EXAMPLES[quantity]}"'
    if not unit:
        raise InputError(
            f"{where} gives no unit of {quantity} in column {short(title.text, 40)!r}; write it behind the "
            f"name, {title.name} {EXAMPLES[quantity]}, or state it: {example}."
        )
    size = _Title(title.index, title.text, title.name, unit).size(quantity)
    if size is None:
        raise InputError(
            f"{where}: [{short(unit, 30)}] is no unit of {quantity} that is unambiguous; write for instance "
            f"{EXAMPLES[quantity]}, or state it: {example}."
        )
    by_unit = not title.is_named(quantity) and title.name != quantity and not from_cells
    assumed = "chosen by its unit" if by_unit else "unit from its cells" if from_cells else ""
    return MeasuredColumn(quantity, title.index, title.text, unit, size, assumed)
