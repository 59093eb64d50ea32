"""A sheet: what a command has found, for the terminal, as JSON and for a page; its text and tables."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rps_exudyn.parameters.gear import SteeringGear
    from rps_exudyn.results.result import Result

INDENT = 2  # blanks before a row


@dataclass(frozen=True)
class Row:
    """A row of a sheet: a value or a heading, words about it, and whether its error bar is wide."""

    value: str
    words: str
    is_vague: bool = False


@dataclass(frozen=True)
class Block:
    """A part of a section; page.html sets it by its kind, and the terminal shows some kinds."""

    @property
    def kind(self) -> str:
        """The class' name in lower case."""
        return type(self).__name__.lower()


@dataclass(frozen=True)
class Text(Block):
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Line(Text):
    """A line of the terminal, in bold or not; what follows a break is indented by so many letters."""

    is_bold: bool = False
    indent: int = 0


@dataclass(frozen=True)
class Link:
    """Words that lead to a row of a table by its id; without one they are words only."""

    text: str
    to: str


@dataclass(frozen=True)
class Links:
    """A cell of several links."""

    items: Sequence[Link]


Cell = str | Links


@dataclass(frozen=True)
class Grid(Block):
    """A table; every row has as many cells as there are columns."""

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    caption: str = ""
    ids: Sequence[str] = ()  # of the rows, each on one row of the page; () without
    vague: Sequence[int] = ()  # places of the rows in grey


@dataclass(frozen=True)
class Section:
    """A heading with blocks, folded or not; without a title the blocks alone."""

    title: str
    blocks: Sequence[Block]
    is_folded: bool = False


@dataclass(frozen=True)
class Sheet:
    """What was found.

    Attributes:
        title, lead: what was done; with which gear, how and when.
        rows: the numbers at the head, the first one large.
        text: everything, for --all.
        more: what `text` has beside the rows.
        data: for JSON, made when asked for.
        sections: of its page.
        gear: whose picture stands beside the rows of the page.
        result: whose motion that picture plays.
    """

    title: str = ""
    lead: str = ""
    rows: Sequence[Row] = ()
    text: Iterable[Block] = ()
    more: str = ""
    data: Callable[[], Mapping[str, Any]] = dict
    sections: Sequence[Section] = ()
    gear: "SteeringGear | None" = None
    result: "Result | None" = None

    @property
    def heading(self) -> str:
        """Title and lead in one line."""
        return f"{self.title}: {self.lead}"

    @property
    def width(self) -> int:
        """Letters of the first column."""
        return max((len(row.value) for row in self.rows), default=0)

    def lines(self) -> list[str]:
        """The head of the sheet as lines of text."""
        rows = (f"{'':{INDENT}}{row.value:{self.width}}  {row.words}" for row in self.rows)
        return [self.heading, *rows]
