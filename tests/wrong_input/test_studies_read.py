"""What is no study, no table or no result is refused in a sentence; nothing is written."""

import sys
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from edited import edited, rewrite_study
from rps_exudyn.base.errors import InputError
from rps_exudyn.results.result import Result
from rps_exudyn.study.collected import read_table
from shell import Command, refusal_of


@pytest.mark.parametrize("subcommand", ["collect", "report"])
@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"version": [2, 0]}, "has format version 2.0, and this rps-exudyn reads 1.x"),
        ({"filetype": "another"}, "is not the description of a study of rps-exudyn"),
        ({"cases": [{"hash": "../../etc/passwd", "values": {}}]}, "is damaged"),
    ],
)
def test_foreign_newer_and_damaged_studies(
    subcommand: str, changes: dict[str, object], sentence: str, study: Path, command: Command
) -> None:
    rewrite_study(study, **changes)
    before = sorted(study.iterdir())
    said = refusal_of(command([subcommand, "s"]))
    assert said.count("\n") == 1
    assert sentence in said
    assert sorted(study.iterdir()) == before


@pytest.mark.parametrize("read", [rps.open_study, rps.study_frame])
def test_folder_without_a_study(read: object, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no study's folder"):
        read(tmp_path)  # type: ignore[operator]


def test_report_names_all_wrong_paths(study: Path, tmp_path: Path, command: Command) -> None:
    (tmp_path / "foreign.h5").write_bytes(b"no HDF5")
    said = refusal_of(command(["report", "s", "foreign.h5", "missing.h5", "--out", "r.html"]))
    assert [line.split(" ")[1] for line in said.splitlines()] == ["foreign.h5", "missing.h5"]
    assert not (tmp_path / "r.html").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["report"], "report needs at least one"),
        (["report", "s", "--out", "r.pdf"], "its name must end in .html"),
        (["report", "s", "--out", "nowhere/r.html"], "there is no folder"),
        (["collect", "s", "--out", "t.xlsx"], "its name must end in .h5"),
        (["collect", "missing"], "there is no such folder"),
    ],
)
def test_wrong_arguments(arguments: list[str], sentence: str, study: Path, command: Command) -> None:
    said = refusal_of(command(arguments))
    assert sentence in said
    assert said.count("\n") == 1


def test_tables_are_checked_for_type_and_version(
    study: Path, made_up_result: Result, tmp_path: Path, command: Command
) -> None:
    made_up_result.save(tmp_path / "result.h5")
    with pytest.raises(InputError, match=r"is an HDF5 file, but not a table of rps-exudyn"):
        read_table(tmp_path / "result.h5")
    command(["collect", "s", "--out", "t.h5"])
    with edited(tmp_path / "t.h5") as file:
        file["summary/torque_mean"][...] = 1
        del file["axes/preload"]
        file["axes/preload"] = np.void(b"\x80\x04.")  # a pickle, for all we know: never read as one
    with pytest.raises(InputError, match=r"is damaged: .*no column"):
        read_table(tmp_path / "t.h5")
    with edited(tmp_path / "t.h5") as file:
        file.attrs["version"] = [2, 0]
    with pytest.raises(InputError, match=r"has format version 2.0, and this rps-exudyn reads 1.x"):
        read_table(tmp_path / "t.h5")
    with pytest.raises(InputError, match="is an HDF5 file, but not a result"):
        rps.load(tmp_path / "t.h5")


def test_sensitivity_without_salib_says_what_to_install(
    study: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    for module in ("SALib", "SALib.analyze.morris"):
        monkeypatch.setitem(sys.modules, module, None)
    rewrite_study(study, design="morris")
    assert command(["report", "s"]).status == 0
    assert "install rps-exudyn with its extra [sensitivity]" in (study / "report.html").read_text("utf-8")
