"""What sections of a page have beside text and tables: facts, judged numbers, shares, pictures, folds."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from rps_exudyn.results.sheet import Block, Section, Text


class Warning(Text):
    """A paragraph that must not be missed."""


class CodeText(Text):
    """Commands, or the text of a file."""


@dataclass(frozen=True)
class Facts(Block):
    """Pairs of a term and its value."""

    items: Sequence[tuple[str, str]]


class Mark(StrEnum):
    """Mark of a judged row: its shape differs, too."""

    KEPT = "kept"
    NOT_KEPT = "not-kept"
    OPEN = "open"


@dataclass(frozen=True)
class Judgement:
    """A judged number: words, and places on a scale from 0 to 100."""

    mark: Mark
    name: str
    note: str  # below the name
    value: str
    interval: str
    verdict: str
    remark: str
    part: str = ""  # key of the colour of its band
    at: float | None = None  # of the value
    band: tuple[float, float] | None = None
    limits: Sequence[float] = ()
    beyond: Sequence[tuple[float, float]] = ()  # ranges in grey


@dataclass(frozen=True)
class Judged(Block):
    """Judged rows, each with its scale."""

    heads: Sequence[str]  # over name, scale, value and verdict
    rows: Sequence[Judgement]


@dataclass(frozen=True)
class Share:
    """Part of a whole, by the key of its colour."""

    part: str
    name: str
    percent: float
    text: str


@dataclass(frozen=True)
class Shares(Block):
    """One bar of shares, or a bar each."""

    shares: Sequence[Share]
    apart: bool = False


@dataclass(frozen=True)
class Picture:
    """An SVG drawn by this package, with a caption that describes it."""

    svg: str
    caption: str
    width: float  # at most [in]
    place: str = ""  # "wide-only" or "narrow": the screens on which it is shown; on all without
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
class Columns(Block):
    """Sections side by side as far as there is room."""

    sections: Sequence[Section]
