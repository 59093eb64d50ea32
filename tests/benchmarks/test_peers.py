"""The scene of the peers: its published files, the measure, and pages made from stored rows."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from benchmarks.peers import score
from benchmarks.peers.reference import GUIDED, SCENE
from benchmarks.peers.scene import GEAR, PAIR
from benchmarks.topic import RESULTS
from rps_exudyn.parameters.fidelity import Fidelity
from verification.runs import run_scene

FOLDER = RESULTS / "peers" / "benchmark"
ANGLE, TORQUE = score.read_curve(FOLDER / score.REFERENCE)
Curve = tuple[np.ndarray, np.ndarray]


@pytest.fixture(scope="module")
def own_curve() -> Curve:
    """Angle [deg] and torque [N m] by the package's equilibria, in steps of one degree."""
    run = run_scene(SCENE, GEAR, Fidelity.preset("quasi-static").replace(GUIDED))
    assert run.ok
    return np.rad2deg(run.signals["pinion_angle"]), run.signals["pinion_torque"]


def written(path: Path, curve: Curve) -> Path:
    """Write a curve as users would."""
    rows = [f"{angle:.6f},{torque:.8f}" for angle, torque in zip(*curve, strict=True)]
    path.write_text("\n".join(["angle,torque", *rows]), encoding="utf-8")
    return path


def test_own_curve_passes_the_published_script_run_alone(own_curve: Curve, tmp_path: Path) -> None:
    """0.02 %: ten times what the reference's methods differ by, above the 0.007 % of steps of one degree."""
    file = written(tmp_path / "own.csv", own_curve)
    script = [sys.executable, str(FOLDER / "score.py"), str(file), "--limit", "0.02"]
    done = subprocess.run(script, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "passes" in done.stdout


@pytest.mark.parametrize(
    ("change", "error"),
    [
        (lambda angle, torque: (angle, torque * 1.011), 1.1),  # 1.1 % too much: the mean
        (lambda angle, torque: (angle, torque + 0.02 * np.sin(angle)), 100 * 0.02 / 0.695 / np.sqrt(2)),
    ],
    ids=["mean", "ripple"],
)
def test_curve_that_is_off_by_more_than_a_percent_fails(
    change: Callable[[np.ndarray, np.ndarray], Curve], error: float, own_curve: Curve, tmp_path: Path
) -> None:
    """Errors as put in, but for the 0.01 % that the curve had before, and a tenth for the sampled sine."""
    curve = change(*own_curve)
    found = score.score(*curve, ANGLE, TORQUE)
    assert found.error == pytest.approx(error, rel=0.1)
    assert score.main([str(written(tmp_path / "off.csv", curve)), "--reference", str(FOLDER / "torque.csv")])


def test_curve_shifted_by_half_a_pitch_has_the_right_mean_and_the_wrong_shape(own_curve: Curve) -> None:
    angle, torque = own_curve
    found = score.score(angle, np.append(np.roll(torque[:-1], 30), torque[30]), ANGLE, TORQUE)
    ripple = 100 * np.std(TORQUE[:-1]) / np.mean(TORQUE)
    assert abs(found.mean) < 0.01  # the mean does not know of the shift
    assert found.shape > ripple  # two curves out of step differ by more than a flat one does


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("angle,torque\n", "no rows"),
        ("0,0.7\n90,0.7\n360,0.7\n", "from row to row"),
        ("\n".join(f"{a},0.7" for a in range(0, 300, 5)), "must cover"),
        ("\n".join(f"{a},nan" for a in range(0, 361, 5)), "finite"),
        ("0,0.7\n5,0.7\nend,of file\n", "no pair"),
    ],
)
def test_file_that_is_no_curve_of_a_turn_fails_with_a_sentence(
    text: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bad.csv"
    file.write_text(text, encoding="utf-8")
    assert score.main([str(file), "--reference", str(FOLDER / "torque.csv")]) == 1
    assert sentence in capsys.readouterr().err


def test_ringing_within_a_degree_is_not_held_against_a_curve() -> None:
    """A torque that rings by 10 % in steps of 0.05 degrees: its mean over a degree is the reference's."""
    angle = np.arange(-1, 361, 0.05)
    torque = np.interp(angle, ANGLE, TORQUE, period=360) * (1 + 0.1 * (-1.0) ** np.arange(angle.size))
    assert score.score(angle, torque, ANGLE, TORQUE).error < 0.6  # one value of 20 or 21 stays: 10 % / 20


def test_published_files_belong_together() -> None:
    assert (FOLDER / "score.py").read_text() == Path(score.__file__).read_text()
    stored = json.loads((FOLDER / "parameters.json").read_text())
    assert stored["scene"]["preload"] == GEAR.yoke.preload
    assert stored["scene"]["rack_travel_per_radian"] == pytest.approx(PAIR.gain)
    assert stored["reference"]["mean"] == pytest.approx(np.mean(TORQUE[:-1]), rel=1e-6)  # seven digits
    for file in ("pinion.stl", "rack.stl"):
        assert (FOLDER / file).stat().st_size < 120_000
