"""A benchmark topic: a run that leaves data and pictures in a folder, and tables written from the data."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rps_exudyn.base.files import write_json
from rps_exudyn.results.provenance import provenance

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results"

Table = Callable[[Path], str]
"""Folder of a topic's data -> Markdown."""


@dataclass(frozen=True)
class Topic:
    """One subject that is measured and published."""

    shows: str
    takes: str  # CPU time of a full run, for a reader
    folder: str  # below the results' folder
    run: Callable[..., None]  # run(folder, **sizes) writes data and pictures; its defaults are published
    toy: Mapping[str, Any] = field(default_factory=dict)  # sizes of a run in seconds
    tables: Mapping[str, Table] = field(default_factory=dict)  # name of a marked region -> its content


def markdown(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def digits(value: float, count: int = 2) -> str:
    """A number to `count` significant digits, without exponent: 152 -> "150"."""
    return f"{float(f'{value:.{count}g}'):.12g}"


def save_data(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON data file with the provenance of this run.

    Raises:
        InputError: the file cannot be written.
    """
    write_json(path, {"origin": provenance(), **content})


def load_data(path: Path) -> Any:
    """Return the content of a JSON data file."""
    return json.loads(path.read_text(encoding="utf-8"))
