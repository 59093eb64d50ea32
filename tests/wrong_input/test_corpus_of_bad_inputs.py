"""The published corpus of bad inputs: those that need no process of their own, in this one."""

from pathlib import Path

import pytest

from benchmarks.bad_inputs.bad_inputs import COLUMNS, inputs_table, precious_file, tried
from benchmarks.bad_inputs.inputs import BadInput, corpus

TOPICS = (
    "settings",
    "distributions",
    "words",
    "gear files",
    "study files",
    "measured curves",
    "result files",
    "endless files",
    "hostile files",
    "explorer",
)


def test_there_are_600_of_every_kind() -> None:
    inputs = corpus(precious_file())
    assert len(inputs) >= 600
    against_files = ("result files", "endless files", "hostile files", "explorer")
    assert sum(bad.topic in against_files for bad in inputs) >= 200
    assert {bad.topic for bad in inputs if not bad.is_alone} == set(TOPICS)
    alone = {"disk", "signals", "cache", "environment", "time limits"}
    assert {bad.topic for bad in inputs if bad.is_alone} == alone


@pytest.mark.parametrize("topic", TOPICS)
def test_no_traceback_and_nothing_lost(topic: str) -> None:
    """Every fourth, for time's sake; the benchmark does them all. Some few are sound after all."""
    precious = precious_file()
    rows = [tried(bad, precious) for bad in [bad for bad in corpus(precious) if bad.topic == topic][::4]]
    named = [dict(zip(COLUMNS, row, strict=True)) for row in rows]
    assert [row for row in named if row["traceback"] or row["lost"] or row["outside"]] == []
    assert sum(row["status"] == 2 for row in named) >= 0.7 * len(named)


def test_long_cell_of_a_measured_curve_is_refused() -> None:
    """It was a traceback of csv."""
    bad = BadInput("x", ("run", "--measured", "m.csv", "--out", "precious.h5"), {"m.csv": b"x" * 200000})
    row = dict(zip(COLUMNS, tried(bad, precious_file()), strict=True))
    assert (row["status"], row["traceback"]) == (2, False)
    assert "m.csv has no column pinion_angle" in str(row["said"])


def test_table_counts_what_went_wrong(tmp_path: Path) -> None:
    lines = [
        COLUMNS,
        ("disk", "run", 2, True, False, 0, 0, False, ""),
        ("limits", "run", 1, False, True, 2.5, 1, True, ""),
    ]
    (tmp_path / "bad_inputs.csv").write_text("\n".join(",".join(map(str, line)) for line in lines))
    assert inputs_table(tmp_path).splitlines()[-1] == "| **all** | 2 | 1 | 1 | 1 | 1 | 1 |"
