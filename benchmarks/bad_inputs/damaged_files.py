"""Files of a study, damaged at random, and whether every reader notices and names them.

A made-up study of six cases is written and collected; then one of its files is damaged and read by everything
that reads it. Right is: no exception but `InputError`, the file's name in the sentence, and the numbers of
all other cases as before.
"""

import shutil
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import ROOT, Topic, load_rows, markdown, save_rows
from rps_exudyn.base.errors import InputError
from rps_exudyn.cli.main import main
from rps_exudyn.cli.output import WRONG_INPUT
from rps_exudyn.results.result import Result
from rps_exudyn.study.collected import read_table, write_table
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import CaseTable

DATA = "damaged_files.csv"
COLUMNS = ("number", "file", "damage", "noticed", "traceback")
OVERWRITTEN = 40  # bytes

Damage = Callable[[bytes, np.random.Generator], bytes]


def _overwritten(content: bytes, rng: np.random.Generator) -> bytes:
    at = int(rng.integers(len(content)))
    return content[:at] + rng.bytes(OVERWRITTEN)[: len(content) - at] + content[at + OVERWRITTEN :]


def _bit_flipped(content: bytes, rng: np.random.Generator) -> bytes:
    at, bit = int(rng.integers(len(content))), int(rng.integers(8))
    return content[:at] + bytes([content[at] ^ (1 << bit)]) + content[at + 1 :]


def _part_zeroed(content: bytes, rng: np.random.Generator) -> bytes:
    first = int(rng.integers(len(content))) // 512 * 512
    last = min(first + 4096, len(content))
    return content[:first] + bytes(last - first) + content[last:]


DAMAGES: dict[str, Damage] = {
    "40 bytes overwritten": _overwritten,
    "one bit flipped": _bit_flipped,
    "truncated": lambda content, rng: content[: int(rng.integers(len(content)))],
    "a page zeroed": _part_zeroed,
    "all zeroed": lambda content, rng: bytes(len(content)),
    "40 bytes appended": lambda content, rng: content + rng.bytes(OVERWRITTEN),
}
WEIGHTS = (0.5, 0.15, 0.15, 0.1, 0.02, 0.08)


def run(folder: Path, count: int = 300) -> None:
    """Damage files `count` times and write what was noticed."""
    rng = np.random.default_rng(20)
    with tempfile.TemporaryDirectory() as temporary:
        study = _study(Path(temporary) / "study")
        save_rows(folder / DATA, COLUMNS, [(number, *trial(study, rng)) for number in range(count)])


def _study(folder: Path) -> Path:
    sys.path.insert(0, str(ROOT / "tests"))
    from made_up_study import make_study

    angle = np.linspace(0, 2 * np.pi, 121)
    signals = {"time": angle, "pinion_angle": angle, "pinion_torque": 0.6 + 0.01 * np.cos(6 * angle)}
    made = rps.run("free-pinion-torque", fidelity="closed-form")
    fields = {name: value for name, value in vars(made).items() if name not in ("signals", "summary")}
    make_study(folder, Result(**fields, signals=signals))
    write_table(CaseTable.of(Store.open(folder)), folder / "table.h5")
    return folder


def trial(study: Path, rng: np.random.Generator) -> tuple[str, str, bool, str]:
    """File and kind of damage, whether all readers noticed it, and the exception that it led to, if any."""
    with tempfile.TemporaryDirectory() as temporary:
        copy = Path(shutil.copytree(study, Path(temporary) / "study"))
        cases = sorted((copy / "cases").glob("*.h5"))
        candidates = [cases[int(rng.integers(len(cases)))]] * 4 + [copy / "study.json", copy / "table.h5"]
        path = candidates[int(rng.integers(len(candidates)))]
        kind = str(rng.choice(list(DAMAGES), p=WEIGHTS))
        before, content = CaseTable.of(Store.open(copy)), path.read_bytes()
        while (damaged := DAMAGES[kind](content, rng)) == content:
            pass
        path.write_bytes(damaged)
        name = path.name if path.parent == copy else "case file"
        try:
            return name, kind, all(_noticed(path, copy, before)), ""
        except Exception as error:
            return name, kind, False, f"{type(error).__name__}: {error}"


def _noticed(path: Path, study: Path, before: CaseTable) -> Iterator[bool]:
    """Reader by reader, whether it noticed the damaged file and kept everything else."""
    if path.name == "study.json":
        for command in ("collect", "report"):
            yield _refused([command, str(study)], path)
        yield _raises(rps.open_study, study, path)
    elif path.name == "table.h5":
        yield _raises(read_table, path, path)
    else:
        yield from _case_noticed(path, study, before)


def _case_noticed(path: Path, study: Path, before: CaseTable) -> Iterator[bool]:
    for command in (["show"], ["rerun"], ["diff", str(path)], ["report"]):
        yield _refused([*command, str(path)], path)
    status, said = _command(["collect", str(study)])
    yield status == 0 and str(path) in said
    table = CaseTable.of(Store.open(study))
    yield [name for name, _ in table.skipped] == [path]
    yield _same(table, before, but=path.stem)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        rps.open_study(study).pinion_torque.load()
    yield any(str(path) in str(warning.message) for warning in warned)


def _same(table: CaseTable, before: CaseTable, but: str = "") -> bool:
    pairs = zip(table.rows, before.rows, strict=True)
    return all(row == old for row, old in pairs if old is not None and old.hash != but)


def _raises(read: Callable[[Path], Any], argument: Path, path: Path) -> bool:
    try:
        read(argument)
    except InputError as error:
        return path.name in str(error)
    return False


def _refused(arguments: list[str], path: Path) -> bool:
    status, said = _command(arguments)
    return status == WRONG_INPUT and path.name in said


def _command(arguments: list[str]) -> tuple[int, str]:
    said = StringIO()
    with redirect_stdout(StringIO()), redirect_stderr(said):
        status = main(arguments)
    return status, said.getvalue()


def damaged_table(folder: Path) -> str:
    """How many damaged files of each kind were noticed."""
    rows = load_rows(folder / DATA)

    def counts(rows: list[dict[str, str]]) -> tuple[int, int, int]:
        return (
            len(rows),
            sum(row["noticed"] == "True" for row in rows),
            sum(bool(row["traceback"]) for row in rows),
        )

    files = sorted({row["file"] for row in rows})
    lines = [(name, *counts([row for row in rows if row["file"] == name])) for name in files]
    total = ("**all**", *(f"**{number}**" for number in counts(rows)))
    return markdown(("file", "damaged", "noticed and named", "tracebacks"), [*lines, total])


TOPIC = Topic("2 min", "bad_inputs", run, {"count": 6}, {"damaged_files": damaged_table})
