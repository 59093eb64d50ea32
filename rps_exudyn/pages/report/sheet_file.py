"""Sheets in JSON files, so that `report` makes their pages again.

The key "sheet" holds what the page shows. The gear's picture is drawn again from its parameters. Charts are
kept as SVG and shown as images, in which a browser runs no scripts and loads nothing: files of others are
hostile.
"""

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of
from rps_exudyn.pages.report.html import (
    Article,
    CodeText,
    Columns,
    Facts,
    Fold,
    Grid,
    Judged,
    PageBlock,
    Picture,
    Pictures,
    Section,
    Shares,
    Text,
    Warning,
)
from rps_exudyn.pages.report.sheet import Row
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result

KEY = "sheet"
DEEPEST = 4  # folds in folds
_ADAPTERS: dict[str, TypeAdapter[Any]] = {
    each.__name__.lower(): TypeAdapter(each)
    for each in (Text, Warning, CodeText, Facts, Grid, Judged, Shares)
}
_ROWS, _PICTURES = TypeAdapter(list[Row]), TypeAdapter(list[Picture])
_PLACES = ("", "wide-only", "narrow")
WIDEST = 20.0  # of a picture [in]


def sheet_as_dict(article: Article, gear: SteeringGear | None = None) -> dict[str, Any]:
    """Return an article as a table for JSON; the gear stands for its picture."""
    return {
        "title": article.title,
        "lead": article.lead,
        "rows": [asdict(row) for row in article.rows],
        "gear": gear.model_dump() if gear else None,
        "sections": [_section_as_dict(each) for each in article.sections],
    }


def _section_as_dict(section: Section) -> dict[str, Any]:
    return {"title": section.title, "blocks": _blocks_as_dicts(section.blocks)}


def _blocks_as_dicts(blocks: Sequence[PageBlock]) -> list[dict[str, Any]]:
    found = []
    for block in blocks:
        if isinstance(block, Columns):
            sections = [_section_as_dict(each) for each in block.sections]
            found.append({"kind": block.kind, "sections": sections})
        elif isinstance(block, Fold):
            inner = _blocks_as_dicts(block.blocks)
            found.append({"kind": block.kind, "title": block.title, "blocks": inner})
        elif isinstance(block, Pictures):
            found.append({"kind": block.kind, "pictures": [asdict(each) for each in block.pictures]})
        elif block.kind in _ADAPTERS:
            found.append({"kind": block.kind, **asdict(block)})
    return found


def read_sheet(path: Path) -> Article:
    """Return the sheet that a command has written to a JSON file.

    Raises:
        InputError: no such file, no JSON, or no sheet in it.
    """
    try:
        content = json.loads(content_of(path))[KEY]
        gear = SteeringGear.from_tables(content["gear"], where=str(path)) if content["gear"] else None
        article = Article(
            title=str(content["title"]),
            lead=str(content["lead"]),
            rows=_ROWS.validate_python(content["rows"]),
            sections=_sections(content["sections"], 0),
        )
    except (ValueError, KeyError, TypeError, RecursionError, ValidationError):
        raise InputError(
            f"{path} holds no sheet; check --out, validate, fit --report and run --band write files that do."
        ) from None
    return article if gear is None else with_gear(article, gear)


def _sections(stored: Sequence[Mapping[str, Any]], depth: int) -> list[Section]:
    return [Section(str(each["title"]), _blocks(each["blocks"], depth)) for each in stored]


def _blocks(stored: Sequence[Mapping[str, Any]], depth: int) -> list[PageBlock]:
    if depth > DEEPEST:
        raise ValueError
    found: list[PageBlock] = []
    for each in stored:
        content = {name: value for name, value in each.items() if name != "kind"}
        if each["kind"] == "columns":
            found.append(Columns(_sections(each["sections"], depth + 1)))
        elif each["kind"] == "fold":
            found.append(Fold(str(each["title"]), _blocks(each["blocks"], depth + 1)))
        elif each["kind"] == "pictures":
            found.append(Pictures([_as_image(one) for one in _PICTURES.validate_python(each["pictures"])]))
        else:
            found.append(_ADAPTERS[each["kind"]].validate_python(content))
    return found


def _as_image(stored: Picture) -> Picture:
    """The picture as an image; text of a file never becomes a part of the page."""
    if stored.place not in _PLACES or not 0 < stored.width <= WIDEST:
        raise ValueError
    content = base64.b64encode(stored.svg.encode(errors="replace")).decode("ascii")
    return replace(stored, svg=f'<img src="data:image/svg+xml;base64,{content}" alt="">', axes="")


def with_gear(article: Article, gear: SteeringGear, result: Result | None = None) -> Article:
    """Return the article with the gear's picture, which plays the motion of a result on a click."""
    from rps_exudyn.pages.report.gear_picture import gear_picture  # a second, for pages alone

    return replace(article, gear=gear_picture(gear, result))
