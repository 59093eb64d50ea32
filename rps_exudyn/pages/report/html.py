"""From articles to one HTML page without fonts or requests; its policy names the scripts that run."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from rps_exudyn.base.units import words
from rps_exudyn.pages.report.sheet import Row, Sheet
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.parameters.names import GEAR_FACTS


@dataclass(frozen=True)
class PageBlock:
    """A part of a section; page.html sets it by its kind."""

    @property
    def kind(self) -> str:
        """The class' name in lower case."""
        return type(self).__name__.lower()


@dataclass(frozen=True)
class Text(PageBlock):
    """A paragraph."""

    text: str


class Warning(Text):
    """A paragraph that must not be missed."""


class CodeText(Text):
    """Commands, or the text of a file."""


@dataclass(frozen=True)
class Facts(PageBlock):
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
class Grid(PageBlock):
    """A table; every row has as many cells as there are columns."""

    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    caption: str = ""
    ids: Sequence[str] = ()  # of the rows, each on one row of the page; () without
    vague: Sequence[int] = ()  # places of the rows in grey


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
class Judged(PageBlock):
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
class Shares(PageBlock):
    """One bar of shares, or a bar each."""

    shares: Sequence[Share]
    apart: bool = False


@dataclass(frozen=True)
class Label:
    """A label of a part in the gear's picture, at a place [%]."""

    name: str
    value: str
    part: str
    side: str
    left: float
    top: float


@dataclass(frozen=True)
class ForceArrow:
    """An arrow over the gear's picture: points of its line and of its head "x,y x,y" [pixels]."""

    part: str
    line: str
    head: str


@dataclass(frozen=True)
class GearPicture:
    """The gear as a still with labels and arrows of forces; in three dimensions a page (gzip in base 64)."""

    image: str
    size: tuple[int, int]  # [pixels]
    alt: str
    labels: Sequence[Label]
    arrows: Sequence[ForceArrow]
    page: str


@dataclass(frozen=True)
class Picture:
    """An SVG drawn by this package, with a caption that describes it."""

    svg: str
    caption: str
    width: float  # at most [in]
    place: str = ""  # "wide-only" or "narrow": the screens on which it is shown; on all without
    axes: str = ""  # JSON of places and scales of the axes with curves, see `axes_of`; page.js reads it


@dataclass(frozen=True)
class Pictures(PageBlock):
    """Pictures side by side as far as there is room."""

    pictures: Sequence[Picture]


@dataclass(frozen=True)
class Fold(PageBlock):
    """Blocks under a line that opens and closes them; in print they are open."""

    title: str
    blocks: Sequence[PageBlock]
    is_open: bool = False


@dataclass(frozen=True)
class Section:
    """A heading with blocks, folded or not; without a title the blocks alone."""

    title: str
    blocks: Sequence[PageBlock]
    is_folded: bool = False


@dataclass(frozen=True)
class Columns(PageBlock):
    """Sections side by side as far as there is room."""

    sections: Sequence[Section]


@dataclass(frozen=True)
class Article:
    """The sheet of one result, study, check, fit or validation.

    Attributes:
        title, lead: what was done; with which gear, how and when.
        sections: curves, parts, rows, tables.
        rows: the numbers at the head, the first one large.
        gear: its picture beside them.
    """

    title: str
    lead: str
    sections: Sequence[Section]
    rows: Sequence[Row] = ()
    gear: GearPicture | None = None

    @property
    def sheet(self) -> Sheet:
        """What the terminal prints of it."""
        return Sheet(f"{self.title}: {self.lead}", tuple(self.rows))


_FOLDER = Path(__file__).parent


def page(title: str, articles: Sequence[Article]) -> str:
    """The page as HTML; all text is escaped except the SVG of pictures, which this package draws."""
    # a second, which the sheet of an article does without
    from rps_exudyn.pages.animation.animation_page import admitted, hash_of
    from rps_exudyn.pages.charts.style import PART_COLOURS

    environment = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    css = (_FOLDER / "page.css").read_text(encoding="utf-8")
    script = (_FOLDER / "page.js").read_text(encoding="utf-8")
    hashes = [hash_of(script), *([admitted()[1]] if any(article.gear for article in articles) else [])]
    return environment.get_template("page.html").render(
        title=title,
        articles=articles,
        css=css,
        script=script,
        part_colours=PART_COLOURS,
        script_hashes=" ".join(f"'sha256-{each}'" for each in hashes),
    )


# --- Blocks that pages about studies and about results have in common

PROVENANCE_NAMES = {
    "package_version": "rps-exudyn",
    "git_hash": "commit",
    "date": "made",
    "machine": "machine",
    "library_versions": "libraries",
}


def provenance_facts(provenance: Mapping[str, Any]) -> Facts:
    """Versions, commit, date, machine; other entries under their own names."""
    items = [(PROVENANCE_NAMES.get(name, words(name)), as_text(value)) for name, value in provenance.items()]
    return Facts([(name, text) for name, text in items if text])


def as_text(value: Any) -> str:
    """The value as text; a table, or JSON of one, as "name value, name value"."""
    if isinstance(value, str) and value.startswith("{"):
        try:
            return as_text(json.loads(value))
        except (ValueError, RecursionError):  # no JSON, or nested too deep
            return value
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {as_text(item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(as_text, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def gear_facts(values: Mapping[str, Any]) -> Facts:
    """What distinguishes gears; `values` are path -> value, and those of `GEAR_FACTS` are shown."""
    rows = {
        path: text for path, text, *_ in parameter_rows({p: values[p] for p in GEAR_FACTS if p in values})
    }
    return Facts([(GEAR_FACTS[path], text) for path, text in rows.items()])


def parameter_rows(values: Mapping[str, Any]) -> Iterable[tuple[str, str, str, str]]:
    """Path, value, meaning and source of parameters; `values` are path -> value."""
    known = {item.path: item for item in Setup.declared()}
    for path, value in values.items():
        if (item := known.get(path)) is None:
            yield path, as_text(value), "", ""
        else:
            text = item.show(value) if isinstance(value, int | float) else str(value)
            yield path, text, item.meaning, item.source


def parameter_grid(values: Mapping[str, Any], caption: str = "") -> Grid:
    """A table of parameters; `values` are path -> value."""
    return Grid(("parameter", "value", "meaning", "source"), list(parameter_rows(values)), caption)


def fidelity_facts(fidelity: Mapping[str, Any]) -> Fold:
    """Every choice of the model, folded under the fidelity's name."""
    choices = {
        f"fidelity.{name}": value for name, value in fidelity.items() if name not in ("name", "based_on")
    }
    return Fold(f"Model: fidelity {fidelity.get('name', '')}", [parameter_grid(choices)])


PART_OF_TABLE = {"mesh": "mesh", "pinion": "mesh", "yoke": "seat", "bush": "bush", "bearing": "bearing"}
"""Table of parameters -> its part, by the key of its colour."""


def part_of(paths: Iterable[str]) -> str:
    """The part to which parameters belong, "" if several."""
    parts = {PART_OF_TABLE.get(path.partition(".")[0], "") for path in paths}
    return parts.pop() if len(parts) == 1 else ""
