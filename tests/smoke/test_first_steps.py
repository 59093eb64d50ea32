"""What a newcomer does first: a folder to begin with, the doctor, an Exudyn system taken over."""

import re
import shlex
from pathlib import Path

import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.passes import passes
from rps_exudyn.cli import doctor
from rps_exudyn.study.study_file import read_study
from shell import Command, in_fresh_process, refusal_of

ROOT = Path(__file__).parents[2]


def test_init_writes_what_the_package_ships_and_keeps_what_is_there(command: Command) -> None:
    Path("preload.toml").write_text("mine")
    answer = command(["init"])
    assert answer.status == 0
    assert "kept as they were: 1\n" in answer.out
    assert "  measured.csv, " in answer.out
    assert len(answer.out.splitlines()) <= 8
    assert Path("preload.toml").read_text() == "mine"
    shipped = {path.relative_to(ROOT / "studies") for path in (ROOT / "studies").rglob("*.toml")}
    assert set(Path().rglob("*.toml")) == shipped
    assert rps.SteeringGear.from_toml("gears/paper.toml") == rps.SteeringGear()
    read_study("friction.toml")
    assert command(["init"]).out.startswith("files written in .: 0;")


def test_the_measured_file_that_init_writes_runs_and_says_that_it_is_made_up(command: Command) -> None:
    """As README prints it, right after `init`: rows in both directions, each of them marked."""
    command(["init"])
    text = Path("measured.csv").read_text(encoding="utf-8")
    assert text.startswith("# EXAMPLE, MADE UP, NOT MEASURED")
    rows = [line for line in text.splitlines() if re.match(r"-?\d", line)]
    assert len(rows) > 50
    assert all(row.endswith("; made up") for row in rows)
    answer = command(["run", "--all", "--measured", "measured.csv", "--fidelity", "closed-form"])
    assert answer.status == 0
    assert "Torque towards +X, pinion angles of -180 ° to 180 °" in answer.out
    result = rps.load("free-pinion-torque.h5")
    measured = result.measured
    assert measured is not None
    assert [each.direction for each in passes(measured.signals)] == [1, -1]
    assert result.gear.test.path == "there-and-back"
    own = ["run", "--measured", "measured.csv", "--fidelity", "closed-form", "--set", "test.path=one-way"]
    assert command(own).status == 0
    assert rps.load("free-pinion-torque.h5").gear.test.path == "one-way"
    for line in re.findall(r"^# rps-exudyn (.+?)(?:  .*)?$", text, re.M):
        assert (
            command([*shlex.split(line), "--out", "x.toml" if line.startswith("fit") else "x.h5"]).status == 0
        )


def test_doctor_runs_a_reference(command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    answer = command(["doctor"])
    assert answer.status == 0
    assert re.search(r"ok  reference run +0\.6199\d N m, published 0\.6199 N m", answer.out)
    assert f"ok  folder is writable {tmp_path}" in answer.out
    monkeypatch.setattr(doctor, "PUBLISHED", 0.63)
    wrong = command(["doctor"])
    assert (wrong.status, "NO  reference run" in wrong.out) == (1, True)


def test_doctor_finds_the_code_in_a_fresh_process(tmp_path: Path) -> None:
    """The current folder is another one. The reference makes machine code; a second process loads it."""
    kernels, here = tmp_path / "kernels", tmp_path / "here"
    here.mkdir()

    def made_before(options: str) -> int:
        done = in_fresh_process(f"rps-exudyn doctor{options}", here, RPS_EXUDYN_CACHE=str(kernels))
        assert done.returncode == 0, done.stderr
        assert re.search(r"^ok  force laws +\S", done.stdout, re.M)
        (count,) = re.findall(
            rf"machine code +{kernels}/\w+/kernels-\w+, (\d+) of \d+ parts made", done.stdout
        )
        return int(count)

    assert made_before("") == 0
    files = {file: file.stat().st_mtime_ns for file in kernels.rglob("*.o")}
    assert made_before("") == len(files) > 0
    assert {file: file.stat().st_mtime_ns for file in kernels.rglob("*.o")} == files
    assert made_before(" --clear-cache") == 0


def test_viewer_needs_a_display(
    command: Command, monkeypatch: pytest.MonkeyPatch, made_up_result: rps.Result
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    made_up_result.save("r.h5")
    assert "rps-exudyn animate r.h5 makes a page for any browser" in refusal_of(command(["view", "r.h5"]))
