"""What a page is made of: articles of sections of blocks. All text is plain; html.py escapes it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    kind: ClassVar[str] = "text"
    text: str


@dataclass(frozen=True)
class Warning:
    """A paragraph that must not be missed."""

    kind: ClassVar[str] = "warning"
    text: str


@dataclass(frozen=True)
class Code:
    """Commands or a file's text."""

    kind: ClassVar[str] = "code"
    text: str


@dataclass(frozen=True)
class Facts:
    """Terms with what is said of them."""

    kind: ClassVar[str] = "facts"
    items: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Grid:
    """A table; every row has as many cells as there are columns."""

    kind: ClassVar[str] = "grid"
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""


@dataclass(frozen=True)
class Picture:
    """An SVG drawn by this package, with words for who does not see it."""

    svg: str
    caption: str
    width: float  # at most so wide [in]


@dataclass(frozen=True)
class Pictures:
    """Pictures side by side as far as there is room."""

    kind: ClassVar[str] = "pictures"
    pictures: Sequence[Picture]


@dataclass(frozen=True)
class Fold:
    """Blocks under a line that opens and closes them; in print they are open."""

    kind: ClassVar[str] = "fold"
    title: str
    blocks: Sequence["Block"]
    is_open: bool = False


Block = Text | Warning | Code | Facts | Grid | Pictures | Fold


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
