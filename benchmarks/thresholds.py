"""Thresholds of scenes and runs: each constant that decides on a number, with its value and its meaning.

Constants that set steps and starts, or the time and memory of a run, decide on no number: what they cost of
accuracy is in the error bars. They are named here; every other number of these folders counts as a threshold.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.topic import ROOT, Columns, Topic, load_data, save_data, table_of

DATA = "thresholds.json"
FOLDERS = "scenes", "simulate"
STEPS = """
    STEPS PER_PERIOD CYCLES MOST_CYCLES MOST_STEPS LEAST_CYCLES PER_CYCLE PER_RAMP ZONE STEPS_PER_SWING
    STEPS_PER_BAND KEPT STEPS_PER_SWING_OF_A_BENDING_RACK SUBSTEPS STARTS REPAIRED_STEPS_PER_PITCH
    LEAST_PER_CYCLE YIELDING STEPS_OF_YIELDING LEAST_BEFORE PER_PITCH_BEFORE PAUSE LEAST_MODES PER_PITCH LOADS
    TURN SHORTEST_STEP SHORTEST_AT_TURNS LEAST_FORCE UNDER_TORQUE SHAKEN LEAD LEVEL FINEST HALVED
"""
RESOURCES = """
    FINE_SHARE GROWTH LEAST_SECONDS BYTES_PER_STEP BYTES_PER_SPHERE SMALL SHARE FEWEST AT_ONCE CONNECTING
    AHEAD GROUP_SECONDS LATER GRACE START_LIMIT FAILED_STARTS FIRST_PAUSE LONGEST_PAUSE ATTEMPTS BATCH_SECONDS
    LARGEST_BATCH HANDING_OVER STARTING MOST_JOBS ROOM
"""
OTHERS = "PITCH_DIAMETER MOST_POWER ROUNDING"  # of a standard; of a sentence; of floating point
ELSEWHERE = {*STEPS.split(), *RESOURCES.split(), *OTHERS.split()}
MOST = 40  # thresholds: a new one needs an old one to go


def constants() -> Iterator[dict[str, Any]]:
    """Yield name, value, meaning and file of each number that a module of these folders names."""
    package = ROOT / "rps_exudyn"
    for file in sorted(path for folder in FOLDERS for path in (package / folder).rglob("*.py")):
        lines = file.read_text(encoding="utf-8").splitlines()
        body = ast.parse("\n".join(lines)).body
        for node, after in zip(body, [*body[1:], None], strict=True):
            if not isinstance(node, ast.Assign):
                continue
            names, values = (_parts(each) for each in (node.targets[0], node.value))
            for name, value in zip(names, values, strict=False):
                if isinstance(name, ast.Name) and name.id.isupper() and _is_number(value):
                    meaning = lines[node.lineno - 1].partition("  # ")[2] or _text_of(after)
                    place = file.relative_to(package).as_posix()
                    yield {"name": name.id, "value": ast.unparse(value), "meaning": meaning, "file": place}


def _parts(node: ast.expr) -> list[ast.expr]:
    return node.elts if isinstance(node, ast.Tuple) else [node]


def _is_number(node: ast.expr) -> bool:
    """Whether an expression has numbers alone, no text and no name."""
    parts = [each for each in ast.walk(node) if isinstance(each, ast.expr)]
    allowed = ast.Constant, ast.BinOp, ast.UnaryOp
    return all(isinstance(each, allowed) for each in parts) and any(
        isinstance(each, ast.Constant) and isinstance(each.value, int | float) for each in parts
    )


def _text_of(node: ast.stmt | None) -> str:
    """Return the string below an assignment, in one line."""
    value = node.value if isinstance(node, ast.Expr) else None
    return re.sub(r"\s+", " ", str(value.value)) if isinstance(value, ast.Constant) else ""


def thresholds() -> list[dict[str, Any]]:
    """Return the constants that decide on numbers."""
    return [each for each in constants() if each["name"] not in ELSEWHERE]


def run(folder: Path) -> None:
    """Keep the list."""
    save_data(folder / DATA, {"rows": thresholds()})


COLUMNS: Columns = {
    "threshold": "`{name}`",
    "value": "{value}",
    "meaning": lambda row: row["meaning"].strip(" ."),
    "file": "{file}",
}


def table(folder: Path) -> str:
    """Return them all."""
    return table_of(load_data(folder / DATA)["rows"], COLUMNS)


TOPIC = Topic("1 s", "stability", run, {}, {"thresholds": table})
