"""Rows of data from outside against the package: the page on verification and validation."""

import re
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.assessment.validation.compared_rows import compare_rows
from rps_exudyn.assessment.validation.row import SHIPPED, read_rows
from rps_exudyn.assessment.validation.validation_page import COLUMNS, row_cells, validation_figure
from rps_exudyn.inference.uncertainty.input_sets import SETS, Input
from rps_exudyn.pages.charts import style

DATA = "validation.json"
UNJUDGED = {"not comparable", "calibrated"}
DOUBTED = ("consistent, weak", "disagrees")
DECIDED = ("agrees", *DOUBTED)
UNASSISTED = re.compile("unassisted|manual (gear|steering)|without assistance")  # in titles
ERROR = "E / u_val, or gears that keep a limit"


def run(folder: Path, only: Sequence[str] = ()) -> None:
    """Run all rows, or those named, and draw their picture."""
    rows = [row for row in read_rows(SHIPPED) if not only or row.name in only]
    comparisons = list(compare_rows(rows, partial(print, flush=True)))
    content = [each.as_dict() | {"cells": row_cells(each)} for each in comparisons]
    save_data(folder / DATA, {"rows": content})
    style.save(validation_figure(comparisons), folder / "validation.png")


def rows_table(folder: Path) -> str:
    """The rows of each kind by their verdicts, each with its error over the standard uncertainty; of verdicts
    that judge nothing, or agree, the number of rows."""
    named: dict[tuple[str, str], list[str]] = {}
    for row in load_data(folder / DATA)["rows"]:
        shown = dict(zip(COLUMNS, row["cells"], strict=True))
        size = f" ({shown[ERROR]})" if shown[ERROR] else ""
        named.setdefault((row["kind"], shown["verdict"]), []).append(shown["row"].replace("|", "/") + size)
    lines = [
        (kind, verdict, len(rows), "; ".join(rows) if verdict in DOUBTED else "")
        for (kind, verdict), rows in sorted(named.items())
    ]
    return markdown(("rows of", "verdict", "number", "these (E / u_val or share)"), lines)


def conclusions_table(folder: Path) -> str:
    """Rows of gears that agree, disagree or are weak evidence, and how many rows show nothing."""
    rows = [row for row in load_data(folder / DATA)["rows"] if row["kind"] == "validation"]
    shown = [row for row in rows if row["verdict"] in DECIDED]
    cells = [[row["title"].replace("|", "/"), *row["cells"][1:3], row["verdict"]] for row in shown]
    counts = Counter(row["verdict"] for row in rows if row not in shown)
    others = ", ".join(f"{number} {verdict}" for verdict, number in counts.items())
    table = markdown(("row", "data", "simulated (5 to 95 %)", "verdict"), cells)
    text = f"{table}\n\nOther rows: {others}."
    ranges = [row for row in rows if row["range"] and row["band"] and row["verdict"] not in UNJUDGED]
    for what, some in {
        "predictions of a range": ranges,
        "of unassisted gears": [row for row in ranges if UNASSISTED.search(row["title"])],
    }.items():
        held = sum(row["band"][0] <= row["D"] <= row["band"][1] for row in some)
        text += f" The 90 % band holds the middle of {held} of {len(some)} {what}."
    for row in [row for row in rows if row["quantity"] == "torque_mean" and row["u_input"]][:1]:
        half = (row["band"][1] - row["band"][0]) / 2 / row["S"]
        text += f" Half of the 90 % band of the mean torque is {100 * half:.0f} % of its median."
    return text


def pedigree_table(folder: Path) -> str:
    """Distributions of the inputs, from the declarations."""
    series = {each.path: each for each in SETS["series"]}
    rows = [[f"`{each.path}`", _written(each), _written(series[each.path])] for each in SETS["unknown"]]
    return markdown(("parameter", "unknown", "series"), rows)


def _written(each: Input) -> str:
    return each.text if each.about in ("value", "error") else f"{each.text} ({each.about})"


TOY = ["undercut-limit", "iso-single-stiffness", "bush-stiffness", "bar-frequency-y", "paper-point-contact"]
TOPIC = Topic(
    "40 s",
    "validation",
    run,
    {"only": TOY},
    {
        "validation_rows": rows_table,
        "validation_pedigree": pedigree_table,
        "validation_conclusions": conclusions_table,
    },
)
