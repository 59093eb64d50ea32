"""Sheets in JSON files, so that `report` makes their pages again.

The key "sheet" holds what the page shows. The gear's picture is drawn again from its parameters. Charts are
kept as SVG and shown as images, in which a browser runs no scripts and loads nothing: files of others are
hostile.
"""

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, write_json
from rps_exudyn.pages.report.html import write_page
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results import page_blocks
from rps_exudyn.results.page_blocks import CodeText, Columns, Facts, Fold, Judged, Picture, Pictures, Shares
from rps_exudyn.results.sheet import Block, Grid, Row, Section, Sheet, Text

KEY = "sheet"
FOLDER_SHEET = "optimisation.json"  # of a folder that is more than a study
DEEPEST = 4  # folds in folds
_ADAPTERS: dict[str, TypeAdapter[Any]] = {
    each.__name__.lower(): TypeAdapter(each)
    for each in (Text, page_blocks.Warning, CodeText, Facts, Grid, Judged, Shares, Pictures, Fold, Columns)
}
_ROWS = TypeAdapter(list[Row])
_PLACES = ("", "wide-only", "narrow")
WIDEST = 20.0  # of a picture [in]


def sheet_as_dict(sheet: Sheet) -> dict[str, Any]:
    """Return a sheet as a table for JSON; the gear stands for its picture."""
    kept = {name: _plain(getattr(sheet, name)) for name in ("title", "lead", "rows", "sections")}
    return kept | {"gear": sheet.gear.model_dump() if sheet.gear else None}


def _plain(value: Any) -> Any:
    """Blocks and what they hold as tables and lists."""
    if is_dataclass(value):
        kind = {"kind": value.kind} if isinstance(value, Block) else {}
        return kind | {each.name: _plain(getattr(value, each.name)) for each in fields(value)}
    return [_plain(each) for each in value] if isinstance(value, list | tuple) else value


def read_sheet(path: Path) -> Sheet:
    """Return the sheet that a command has written to a JSON file.

    Raises:
        InputError: no such file, no JSON, or no sheet in it.
    """
    try:
        content = json.loads(content_of(path))[KEY]
        return Sheet(
            title=str(content["title"]),
            lead=str(content["lead"]),
            rows=_ROWS.validate_python(content["rows"]),
            sections=_sections(content["sections"], 0),
            gear=SteeringGear.from_tables(content["gear"], where=str(path)) if content["gear"] else None,
        )
    except (ValueError, KeyError, TypeError, RecursionError, ValidationError):
        raise InputError(
            f"{path} holds no sheet; check, validate, fit, optimise and run --band write files that do."
        ) from None


def _sections(stored: Sequence[Mapping[str, Any]], depth: int) -> list[Section]:
    found = []
    for each in stored:
        inner = [_block(block, depth) for block in each["blocks"]]
        found.append(Section(str(each["title"]), inner, each.get("is_folded", False) is True))
    return found


def _block(stored: Mapping[str, Any], depth: int) -> Block:
    if depth > DEEPEST:
        raise ValueError
    inner: dict[str, Any] = {}
    if stored["kind"] == "fold":
        inner = {"blocks": [_block(each, depth + 1) for each in stored["blocks"]]}
    elif stored["kind"] == "columns":
        inner = {"sections": _sections(stored["sections"], depth + 1)}
    block: Block = _ADAPTERS[stored["kind"]].validate_python({**stored, **inner})
    return Pictures([_as_image(each) for each in block.pictures]) if isinstance(block, Pictures) else block


def _as_image(stored: Picture) -> Picture:
    """The picture as an image; text of a file never becomes a part of the page."""
    if stored.place not in _PLACES or not 0 < stored.width <= WIDEST:
        raise ValueError
    content = base64.b64encode(stored.svg.encode(errors="replace")).decode("ascii")
    return replace(stored, svg=f'<img src="data:image/svg+xml;base64,{content}" alt="">', axes="")


def write_sheet(sheet: Sheet, out: Path) -> None:
    """Write a sheet as a page, or its data (.json), of which `report` makes the page.

    Raises:
        InputError: `out` cannot be written.
    """
    if out.suffix == ".json":
        write_json(out, {**sheet.data(), KEY: sheet_as_dict(sheet)})
    else:
        write_page([sheet], out)
