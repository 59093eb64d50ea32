"""The truth set: formulas against limits that anyone can check, files as they are made, scores of entries."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.truth import score
from benchmarks.truth.by_exudyn import Exudyn
from benchmarks.truth.problem_files import FOLDER, write
from benchmarks.truth.problems import PROBLEMS


@pytest.mark.parametrize("name", PROBLEMS)
def test_files_are_those_of_the_problem(name: str, tmp_path: Path) -> None:
    write(PROBLEMS[name], tmp_path)
    for file in tmp_path.iterdir():
        assert file.read_bytes() == (FOLDER / name / file.name).read_bytes(), file.name


def test_answers_are_those_of_the_work() -> None:
    """Power of the drive is friction's and the load's: a wedge and a screw, forth and back, lift nothing."""
    wedge, screw = PROBLEMS["wedge"].truths, PROBLEMS["screw"].truths
    mu, weight, own = 0.15, 10 * 9.81, 9.81
    beta, phi = np.deg2rad(10), np.arctan(mu)
    faces = [weight / np.cos(beta + sign * phi) * np.cos(phi) for sign in (1, -1)]  # normal forces
    lost = [mu * (each / np.cos(beta) + weight + own) for each in faces]  # per travel of the wedge
    assert wedge["force_in"].value == pytest.approx(weight * np.tan(beta) + lost[0])
    assert wedge["force_out"].value == pytest.approx(weight * np.tan(beta) - lost[1])
    on_thread = weight / (np.cos(phi) - mu * np.sin(phi))  # lead = phi
    raising = 10e-3 * (weight * np.tan(phi) + mu * on_thread / np.cos(phi))
    assert screw["torque_raise"].value == pytest.approx(raising)


def test_a_zone_of_friction_creeps_by_its_formula() -> None:
    """0.03 %: general contact of Exudyn on the incline."""
    problem, zone = PROBLEMS["incline"], 0.01
    found = problem.answers({scene.name: Exudyn(zone).run(scene)[0] for scene in problem.scenes})
    assert found["acceleration"] == pytest.approx(problem.truths["acceleration"].value, rel=1e-4)
    assert found["creep"] == pytest.approx(zone * np.tan(np.deg2rad(8)) / 0.2, rel=3e-4)


def test_score_is_printed_without_the_package(tmp_path: Path) -> None:
    entry = {"problem": "screw", "answers": {"torque_raise": 0.3, "torque_lower": 0.0}}
    file = tmp_path / "entry.json"
    file.write_text(json.dumps([entry]))
    command = [sys.executable, "-I", str(FOLDER / "score.py"), str(file)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert "torque_raise -0.357 %" in printed
    assert printed.count("within") == 1
    file.write_text(json.dumps({"problem": "nut", "answers": {}}))
    assert subprocess.run(command, capture_output=True, check=False).returncode == 1
    assert score.main([]) == 2
