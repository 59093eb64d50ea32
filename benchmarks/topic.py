"""A benchmark topic: a run that leaves data and pictures in a folder, and tables written from the data."""

import csv
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from rps_exudyn.base.files import replacing, write_json
from rps_exudyn.results.provenance import provenance

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "results"

Row = TypeVar("Row")

Table = Callable[[Path], str]
"""Folder of a topic's data -> Markdown."""


@dataclass(frozen=True)
class Topic:
    """One subject that is measured and published."""

    takes: str  # CPU time of a full run, for a reader
    folder: str  # below the results' folder
    run: Callable[..., None]  # run(folder, **sizes) writes data and pictures; its defaults are published
    toy: Mapping[str, Any] = field(default_factory=dict)  # sizes of a run in seconds
    tables: Mapping[str, Table] = field(default_factory=dict)  # name of a marked region -> its content
    about: str = ""

    @property
    def shows(self) -> str:
        """What it shows: `about`, or what its module says first."""
        return self.about or (sys.modules[self.run.__module__].__doc__ or "").partition("\n")[0]


def markdown(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


Columns = Mapping[str, str | Callable[[Any], object]]
"""Head of a column -> what makes its cell of a row: a format of the row's fields, or a function."""


def table_of(rows: Iterable[Any], columns: Columns) -> str:
    """A table in Markdown with a line for each of these rows."""
    makers = [each.format_map if isinstance(each, str) else each for each in columns.values()]
    return markdown(list(columns), [[make(row) for make in makers] for row in rows])


def rows_table(file: str, key: str, columns: Columns) -> Table:
    """The table of the rows that stand under a key of a data file."""
    return lambda folder: table_of(load_data(folder / file)[key], columns)


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


def begun(path: Path) -> Any:
    """Return what a run before this one left in a JSON file; {} if there is none."""
    return load_data(path) if path.exists() else {}


def save_rows(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write rows as a table of comma-separated values, whole or not at all."""
    with (
        replacing(path) as partial,
        partial.open("w", newline="", encoding="utf-8", errors="replace") as file,
    ):
        csv.writer(file, lineterminator="\n").writerows([columns, *rows])


def load_rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of such a table; none if there is no file."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def shown(rows: Iterable[Row]) -> list[Row]:
    """All rows, each printed as it comes."""
    found = []
    for row in rows:
        print(row, flush=True)
        found.append(row)
    return found
