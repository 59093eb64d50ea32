"""CONTRIBUTING.md is true of the code: its answers, its layers, and its recipe of a scene."""

import inspect
import json
import re
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import rps_exudyn as rps
import rps_exudyn.scenes as scenes
from conftest import LONG, QUICK, SLOW
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.scene import Scene
from rps_exudyn.scenes.scene_run import SceneRun

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
ANSWERS = re.findall(r"^\| (.+?) \| `(.+?)` \| `(.+?)` \|$", PAGE, re.M)


@pytest.mark.parametrize(("question", "file", "definition"), ANSWERS)
def test_answer_is_where_the_page_says(question: str, file: str, definition: str) -> None:
    assert definition in (ROOT / file).read_text(encoding="utf-8")


def test_page_is_short_and_its_layout_lists_every_folder() -> None:
    assert 10 <= len(ANSWERS) <= 15
    assert len(PAGE.split()) <= 1200
    folders = {init.parent.name for init in (ROOT / "rps_exudyn").glob("*/__init__.py")}
    assert set(re.findall(r"^ {6}(\w+)/ ", PAGE, re.M)) == folders


def test_files_that_answer_a_strangers_questions_exist() -> None:
    """Thirty questions, and the files guessed from the tree alone, 27 of them right."""
    answers = json.loads((ROOT / "tests" / "contract" / "where_is.json").read_text(encoding="utf-8"))
    assert [each for each in answers if not (ROOT / each["file"]).exists()] == []


def test_files_of_the_recipes_exist() -> None:
    named = re.findall(r"`((?:rps_exudyn|verification|tests|docs|studies|\.ci)/[^` ]+)`", PAGE)
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_layers_are_those_of_the_contract() -> None:
    listed = re.findall(r"^ {6}(\w+)/ ", PAGE, re.M)
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert listed == settings["tool"]["importlinter"]["contracts"][0]["layers"][::-1]


def test_a_scene_is_one_module_and_one_name(monkeypatch: pytest.MonkeyPatch) -> None:
    def still(*_: object) -> SceneRun:
        signals = {"time": np.arange(2.0), "pinion_torque": np.ones(2)}
        return SceneRun(Outcome(Status.OK), signals, {"torque_mean": 1.0})

    module = ModuleType("rps_exudyn.scenes.holding_still")
    module.SCENE = Scene(  # type: ignore[attr-defined]
        name="holding-still",
        title="",
        run=still,
        signal="pinion_torque",
        main_metric="torque_mean",
        chart="torque",
    )
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr(scenes, "SCENE_NAMES", (*scenes.SCENE_NAMES, "holding-still"))
    result = rps.run("holding-still")
    assert (result.scene, result.status) == ("holding-still", Status.OK)
    assert result.summary == {"torque_mean": 1.0}


@pytest.mark.parametrize("name", [*QUICK, *SLOW, *LONG])
def test_lists_of_tests_name_what_exists(name: str) -> None:
    file, _, test = name.partition("::")
    path = ROOT / "tests" / file
    assert path.exists()
    assert not test or f"def {test}(" in path.read_text(encoding="utf-8")


def test_few_frames_stand_between_a_run_and_its_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of them does something of its own: none only passes on."""
    seen: list[str] = []

    def noted(*_: object) -> None:
        stack = [frame for frame in inspect.stack()[1:] if "/rps_exudyn/" in frame.filename]
        seen.extend(frame.function for frame in stack)
        raise KeyboardInterrupt

    monkeypatch.setattr("rps_exudyn.solvers.equilibrium.follow", noted)
    with pytest.raises(KeyboardInterrupt):
        rps.run("free-pinion-torque", fidelity=Fidelity.preset("quasi-static"), turns=1)
    assert len(seen) <= 11, seen


def test_licence_of_every_dependency_is_listed() -> None:
    """Neither one that is missing nor one that the package no longer needs."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = {re.split(r"[<>=]", each)[0] for each in project["dependencies"]}
    rows = re.findall(
        r"^\| .+ \| (.+) \|$", PAGE.split("## Licences of dependencies")[1].split("##")[0], re.M
    )
    listed = {re.split(r" \(", name)[0] for row in rows[1:] for name in row.split(", ")}
    assert listed == needed
