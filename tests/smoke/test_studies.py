"""Every shipped study at toy size, simulated for real."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from edited import edited
from rps_exudyn.optimisation.file_kinds import kind_of
from rps_exudyn.results.outcome import Status
from rps_exudyn.study.designs import points
from rps_exudyn.study.runner import StudyWork, run_study
from rps_exudyn.study.store import Store
from rps_exudyn.study.study_file import read_study
from shell import Command
from study_files import Here

FILES = sorted((Path(__file__).parents[2] / "studies").glob("*.toml"))
STUDIES = [file for file in FILES if kind_of(tomllib.loads(file.read_text())) == "study"]
SHIPPED = (
    "preload friction runout installation_angle preload_friction_runout yoke_clearance load_map tolerance "
    "bent_rack radial_play rattle_threshold steering_column uncertain_gear"
)


def test_all_studies_are_shipped() -> None:
    assert {file.stem for file in STUDIES} >= set(SHIPPED.split())


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.stem)
def test_study_runs_at_toy_size(file: Path, tmp_path: Path) -> None:
    work = StudyWork.of(read_study(file).toy(), tmp_path / file.stem)
    tally = run_study(work, Here())
    assert tally.statuses[Status.OK] >= len(work.missing) / 2
    store = Store.open(tmp_path / file.stem)
    expected = {
        "load-test": "efficiency_forward",
        "rack-push": "push_force_mean",
        "radial-play": "radial_play_y",
        "rattle": "rattle_threshold_force",
        "steering-feel": "feel_area",
    }.get(store.description.scene, "torque_mean")
    for _, row in store.rows():
        assert row.status is not Status.OK or expected in row.summary
    assert not store.skipped


def test_uncertain_study_varies_what_carries_a_distribution() -> None:
    """And nothing else; its points keep to the distributions' ends."""
    file = next(file for file in STUDIES if file.stem == "uncertain_gear")
    study, settings = read_study(file), tomllib.loads(file.read_text())["set"]
    given = {f"{table}.{name}" for table, names in settings.items() for name in names}
    assert {axis.name for axis in study.axes} == given
    drawn = list(points(study.axes, study.design, study.samples, study.seed))
    for path, low, high in (("pinion.runout", 0.0, 20e-6), ("yoke.preload", 210.0, 390.0)):
        values = [point[path] for point in drawn]
        assert low <= min(values) < low + 0.05 * (high - low)
        assert high >= max(values) > high - 0.05 * (high - low)


def test_study_from_the_command_line_and_one_case_again(command: Command) -> None:
    """With worker processes; `rerun` finds bit for bit what a worker stored."""
    file = next(file for file in STUDIES if file.stem == "preload")
    answer = command(["study", str(file), "--toy", "--jobs", "1"])
    assert answer.status == 0
    assert "2 cases in preload-toy (2 ok), 2 of them done now" in answer.out
    store = Store.open("preload-toy")
    stored = store.path_of(store.description.cases[0].hash)
    again = fresh("rerun", str(stored), "--out", "again.h5")
    assert f"Every number equals that of {stored}, bit for bit." in " ".join(again.split())
    assert json.loads(fresh("rerun", "again.h5", "--json"))["differing"] == {}


def fresh(*arguments: str) -> str:
    """What a command prints in a process of its own."""
    command = [sys.executable, "-m", "rps_exudyn", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_rerun_lists_what_differs(command: Command) -> None:

    assert command(["run", "--fidelity", "closed-form", "--out", "a.h5"]).status == 0
    with edited(Path("a.h5")) as file:
        file["summary/torque_mean"][()] *= 2
    answer = command(["rerun", "a.h5", "--json"])
    assert list(answer.json["differing"]) == ["torque_mean"]
    assert answer.json["largest"] == ["torque_mean", pytest.approx(0.5)]
    assert "largest relative difference is 0.5, of torque_mean" in command(["rerun", "a.h5"]).out
