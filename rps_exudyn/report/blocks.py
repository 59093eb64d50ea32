"""The parts of a page: articles of sections of blocks. All text is plain; html.py escapes it."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Block:
    """A part of a section; page.html sets it by its kind."""

    @property
    def kind(self) -> str:
        """The class' name in lower case."""
        return type(self).__name__.lower()


@dataclass(frozen=True)
class Text(Block):
    """A paragraph."""

    text: str


class Warning(Text):
    """A paragraph that must not be missed."""


class Code(Text):
    """Commands, or the text of a file."""


@dataclass(frozen=True)
class Facts(Block):
    """Pairs of a term and its value."""

    items: Sequence[tuple[str, str]]


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


@dataclass(frozen=True)
class Picture:
    """An SVG drawn by this package, with a caption that describes it."""

    svg: str
    caption: str
    width: float  # at most [in]
    axes: str = ""  # JSON of places and scales of the axes with curves, see `axes_of`; page.js reads it


@dataclass(frozen=True)
class Pictures(Block):
    """Pictures side by side as far as there is room."""

    pictures: Sequence[Picture]


@dataclass(frozen=True)
class Fold(Block):
    """Blocks under a line that opens and closes them; in print they are open."""

    title: str
    blocks: Sequence[Block]
    is_open: bool = False


@dataclass(frozen=True)
class Section:
    """A heading with blocks."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Article:
    """One study or one result."""

    title: str
    lead: str
    sections: Sequence[Section]
