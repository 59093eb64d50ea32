"""From sheets to one HTML page without fonts or requests; its policy names the scripts that run."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rps_exudyn.base.files import replacing
from rps_exudyn.base.units import words
from rps_exudyn.parameters.display_names import GEAR_FACTS
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.results.page_blocks import CodeText, Facts, Fold
from rps_exudyn.results.sheet import Grid, Sheet

_FOLDER = Path(__file__).parent


def write_page(sheets: Iterable[Sheet], out: str | Path) -> None:
    """Write the page of these sheets.

    Raises:
        InputError: `out` cannot be written.
    """
    text = page(sheets)
    with replacing(out) as partial:
        partial.write_text(text, encoding="utf-8", errors="replace")


def page(sheets: Iterable[Sheet]) -> str:
    """The page as HTML; all text is escaped except the SVG of pictures, which this package draws."""
    from rps_exudyn.pages.animation.animation_page import admitted, environment, hash_of
    from rps_exudyn.pages.charts.style import PART_COLOURS, theme
    from rps_exudyn.pages.report.gear_picture import gear_picture

    drawn = [(sheet, gear_picture(sheet.gear, sheet.result) if sheet.gear else None) for sheet in sheets]
    css = theme() + (_FOLDER / "page.css").read_text(encoding="utf-8")
    script = (_FOLDER / "page.js").read_text(encoding="utf-8")
    hashes = [hash_of(script), *([admitted()[1]] if any(gear for _, gear in drawn) else [])]
    return (
        environment(_FOLDER)
        .get_template("page.html")
        .render(
            title=" · ".join(sheet.title for sheet, _ in drawn),
            sheets=drawn,
            css=css,
            script=script,
            part_colours=PART_COLOURS,
            script_hashes=" ".join(f"'sha256-{each}'" for each in hashes),
        )
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
    rows = parameter_rows({path: values[path] for path in GEAR_FACTS if path in values})
    return Facts([(GEAR_FACTS[path], text) for path, text, *_ in rows])


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


def make_again(facts: Mapping[str, Any], commands: str) -> Fold:
    """Origin and the commands that make the sheet again, folded."""
    return Fold("Make it again", [provenance_facts(facts), CodeText(commands)])


def fidelity_facts(fidelity: Mapping[str, Any]) -> Fold:
    """Every choice of the model, folded under the fidelity's name."""
    names = [name for name in fidelity if name not in ("name", "based_on")]
    choices = parameter_grid({f"fidelity.{name}": fidelity[name] for name in names})
    return Fold(f"Model: fidelity {fidelity.get('name', '')}", [choices])


PART_OF_TABLE = {"mesh": "mesh", "pinion": "mesh", "yoke": "seat", "bush": "bush", "bearing": "bearing"}
"""Table of parameters -> its part, by the key of its colour."""


def part_of(paths: Iterable[str]) -> str:
    """The part to which parameters belong, "" if several."""
    parts = {PART_OF_TABLE.get(path.partition(".")[0], "") for path in paths}
    return parts.pop() if len(parts) == 1 else ""
