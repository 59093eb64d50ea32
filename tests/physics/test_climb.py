"""`--accuracy` climbs the ladder: each level once, cheapest preset first, until the bars are within it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Outcome, Status
from rps_exudyn.scenes import free_pinion_torque
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.simulate.by_accuracy import AccuracyGoal, climb
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.study.dataset import open_study
from shell import Command

SCENE = "free-pinion-torque"
GEAR = SteeringGear().replace({"test.turns": 0.2})
Made = list[tuple[str, int | None]]
Instead = Callable[[str, int | None], SceneRun | None]


def noted(monkeypatch: pytest.MonkeyPatch, instead: Instead = lambda solver, level: None) -> Made:
    """Return the runs that the scene makes, by solver and level; some may be replaced."""
    scene, made = free_pinion_torque.SCENE, Made()

    def run(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
        made.append((fidelity.solver, options.level))
        return instead(*made[-1]) or scene.run(gear, fidelity, options)

    monkeypatch.setattr(free_pinion_torque, "SCENE", replace(scene, run=run))
    return made


def failing(*at: tuple[str, int]) -> Instead:
    lost = SceneRun(Outcome(Status.NO_CONVERGENCE, "lost", codes=(Code.NO_EQUILIBRIUM,)))
    return lambda solver, level: lost if (solver, level) in at else None


@pytest.mark.parametrize(
    ("wanted", "names", "level"),
    [(1.0, ["torque_mean", "torque_peak_to_peak"], 1), (0.1, ["torque_mean"], 3)],
)
def test_what_is_asked_for_is_reached_and_each_level_runs_once(
    wanted: float, names: list[str], level: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Judged by level 6, whose steps are an eighth of these at most."""
    made = noted(monkeypatch)
    result = rps.run(SCENE, GEAR, accuracy=f"{wanted}%", metrics=names)
    assert made == [("equilibrium", each) for each in (1, 0, *range(2, result.findings["level"] + 1))]
    assert result.findings["level"] >= level
    assert f"level {result.findings['level'] + 1} would take about" in result.findings["accuracy"]
    right = rps.run(SCENE, GEAR, fidelity="quasi-static", level=6)
    for name in names:
        off = abs(result.summary[name] - right.summary[name])
        assert 1.5 * result.errors[name] <= wanted / 100 * abs(right.summary[name]), name
        assert off <= wanted / 100 * abs(right.summary[name]), name


def test_bars_of_a_climb_are_those_of_its_level() -> None:
    climbed = rps.run(SCENE, GEAR, accuracy="0.1%")
    plain = rps.run(SCENE, GEAR, fidelity="quasi-static", level=climbed.findings["level"])
    assert climbed.summary == plain.summary
    assert climbed.errors == plain.errors


def test_a_lost_companion_costs_a_level(monkeypatch: pytest.MonkeyPatch) -> None:
    made = noted(monkeypatch, failing(("equilibrium", 0)))
    result = rps.run(SCENE, GEAR, accuracy="1%")
    assert made == [("equilibrium", level) for level in (1, 0, 2)]
    assert (result.status, result.findings["level"]) == (Status.OK, 2)


def test_the_next_preset_serves_where_one_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    made = noted(monkeypatch, failing(("equilibrium", 1)))
    result = climb(SCENE, GEAR, AccuracyGoal.of("1%"), TimeLimit(600.0))
    assert made == [("equilibrium", 1), ("generalized-alpha", 1), ("generalized-alpha", 0)]
    assert result.fidelity["name"] == "flank"
    assert Code.PRESET_LEFT in result.codes
    assert "quasi-static: level 1 ends no-convergence, lost" in result.message
    assert rps.run(SCENE, GEAR, accuracy="1%", fidelity="quasi-static").status is Status.NO_CONVERGENCE


def test_the_best_level_is_kept_where_the_next_one_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    noted(monkeypatch, failing(("equilibrium", 2)))
    result = rps.run(SCENE, GEAR, accuracy="0.1%", fidelity="quasi-static")
    assert (result.status, result.codes[0]) == (Status.OK, Code.ACCURACY_NOT_REACHED)
    assert "accuracy 0.1 % is not reached, quasi-static, level 1: 1.5 bars of torque_mean" in result.message


def test_inertia_that_equilibria_leave_out_ends_their_climb() -> None:
    """No level shows it: dynamics serve."""
    gear = SteeringGear().replace({"pinion.runout": "20 um", "test.speed": "600 rpm"})
    wanted = AccuracyGoal.of("2%", ["torque_first_order"], "quasi-static")
    result = climb(SCENE, gear, wanted)
    assert Code.ACCURACY_NOT_REACHED in result.codes
    assert result.findings["level"] == 2
    assert "is not of the steps, and lasts on finer levels" in result.message


def test_no_level_is_begun_that_takes_longer_than_is_left() -> None:
    past = TimeLimit(1.0, begun=-1e9)
    result = climb(SCENE, GEAR, AccuracyGoal.of("0.001%"), past)
    assert (result.status, result.findings["level"]) == (Status.OK, 1)
    assert "level 2 would take longer than is left of the time limit" in result.message


def test_an_interrupted_climb_carries_its_best_run(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(solver: str, level: int | None) -> None:
        if level == 2:
            raise KeyboardInterrupt

    noted(monkeypatch, interrupted)
    with pytest.raises(Interrupted) as interrupt:
        rps.run(SCENE, GEAR, accuracy="0.1%")
    best = interrupt.value.recorded
    assert (best.status, best.findings["level"]) == (Status.OK, 1)
    assert np.isfinite(best.errors["torque_mean"])
    assert Code.ACCURACY_NOT_REACHED in best.codes


def test_cases_of_a_study_climb(command: Command) -> None:
    Path("study.toml").write_text(
        f'scene = "{SCENE}"\naccuracy = "0.1%"\nmetrics = ["torque_mean"]\n[set]\ntest.turns = 0.2\n'
        '[[axis]]\npath = "yoke.preload"\nvalues = ["250 N", "350 N"]\n'
    )
    answer: Any = command(["study", "study.toml", "--jobs", "1"])
    assert answer.status == 0, answer.err
    found = open_study(Path("study"))
    share = found["torque_mean_error"] / found["torque_mean"]
    assert (1.5 * share <= 1e-3).all()


SLOW_LEVEL = """
import time
from dataclasses import replace
from rps_exudyn.scenes import free_pinion_torque

own = free_pinion_torque.SCENE

def run(gear, fidelity, options):
    while options.level == 2:
        try:
            time.sleep(1000)
        except KeyboardInterrupt:  # as compiled code, which hears no alarm
            pass
    return own.run(gear, fidelity, options)

free_pinion_torque.SCENE = replace(own, run=run)
"""


def test_the_best_level_is_kept_where_the_process_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sitecustomize.py").write_text(SLOW_LEVEL)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    result = rps.run(SCENE, GEAR, accuracy="0.1%", time_limit=30.0)
    assert (result.status, result.findings["level"]) == (Status.OK, 1)
    assert Code.ACCURACY_NOT_REACHED in result.codes
    assert "the run took longer than its time limit of 30 s (accuracy 0.1 % is not reached" in result.message
