"""Optimisation: known optima are found, a design's numbers are those of a batch, no kill changes the end."""

import json
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.optimisation import evaluation
from rps_exudyn.optimisation.definition import Problem, read_problem
from rps_exudyn.optimisation.evaluation import evaluate, number_in, table_of
from rps_exudyn.optimisation.goals import Number
from rps_exudyn.optimisation.optimisation_page import Optimisation
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.gear_table import table_of_metrics
from rps_exudyn.solvers.closed_form import mean_state
from study_files import TOLERANCES

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

CLOSED = """
fidelity = "closed-form"
errors = "none"
designs = 96
population = 12
confirm = [0, 0]
"""
PRELOAD = """
[variables]
yoke.preload = ["100 N", "600 N"]
"""
MANY = TOLERANCES.replace("samples = 64", "samples = 4096").replace("[64, 0]", "[1024, 0]")
KILLED = (
    CLOSED
    + PRELOAD
    + "pinion.teeth = [5, 8]\n"
    + """
[objectives.torque_mean]
[objectives.stiffness]
metric = "pinion.teeth"
goal = "most"
"""
)


def written(folder: Path, text: str) -> Path:
    """Return the file of an optimisation."""
    file = folder / "wanted.toml"
    file.write_text(text)
    return file


def found_in(folder: Path, text: str) -> Optimisation:
    pytest.importorskip("pymoo")
    return rps.optimise(written(folder, text), folder / "out", jobs=1)


def closed_form(settings: dict[str, object]) -> float:
    """Return the mean free torque by the closed form [N m]."""
    gear = rps.SteeringGear().replace(settings)
    return float(mean_state(gear, gear.test.direction, 0.0).torque)


def preload_of(torque: float, settings: dict[str, object]) -> float:
    """Return the preload at which the closed form, linear in it, has a torque [N]."""
    low, high = (closed_form({**settings, "yoke.preload": force}) for force in (100.0, 600.0))
    return 100.0 + 500.0 * (torque - low) / (high - low)


def test_least_preload_of_a_torque(tmp_path: Path) -> None:
    """The closed form is linear in the preload, so that the least one with 0.5 N m is known."""
    limits = '[objectives."yoke.preload"]\n[constraints.torque_mean]\nleast = "0.5 N*m"\n'
    best = found_in(tmp_path, CLOSED + PRELOAD + limits).front[0]
    assert best.gear.yoke.preload == pytest.approx(preload_of(0.5, {}), rel=0.01)


def test_most_preload_that_nine_tenths_of_a_series_allow(tmp_path: Path) -> None:
    """Torque is linear in preload and drag: the quantile is at that of the drag."""
    drag = '[set]\nbush.drag = "20 N +- 5 N"\n'
    limits = '[objectives."yoke.preload"]\ngoal = "most"\n[constraints.torque_mean]\nmost = "0.7 N*m"\n'
    limits += 'share = "90 %"\n'
    text = CLOSED.replace("96", "160").replace('"none"', '"own"\nsamples = 16') + drag + PRELOAD + limits
    found = found_in(tmp_path, text)
    problem, best = found.search.problem, found.front[0]
    drags = table_of(best.gear, problem.inputs_of(best.gear), 16, problem.study.seed)["bush.drag"][:-1]
    at = {"bush.drag": float(np.quantile(drags, 0.9, method="higher"))}
    assert best.gear.yoke.preload == pytest.approx(preload_of(0.7, at), rel=0.01)


def test_search_needs_no_series_of_designs_that_miss_nominal_limits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the series of all designs it asks for the same ones, and has the same front."""
    series = CLOSED.replace("96", "48").replace('"none"', '"own"\nsamples = 8')
    text = series + '[set]\nbush.drag = "20 N +- 5 N"\n' + PRELOAD
    text += '[objectives.torque_mean]\nquantile = "90 %"\n'
    text += '[constraints.nominal]\nmetric = "torque_mean"\nleast = "0.5 N*m"\n'
    quick = found_in(tmp_path, text).search
    needed = partial(evaluation._all_numbers, complete=True)
    monkeypatch.setattr(evaluation, "_all_numbers", lambda *given, complete: needed(*given))
    whole = rps.optimise(tmp_path / "wanted.toml", tmp_path / "whole", jobs=1).search
    assert [each.case for each in quick.designs] == [each.case for each in whole.designs]
    assert [each.numbers for each in quick.front] == [each.numbers for each in whole.front]
    left_out = [each for each in quick.designs if np.isnan(each.numbers[0])]
    assert left_out
    assert not any(each.is_feasible for each in left_out)
    assert np.isfinite([each.numbers for each in whole.designs]).all()


def test_optimum_of_two_variables_by_brute_force(tmp_path: Path) -> None:
    """The least root stress of the pinion, on a grid of profile shift and addendum with the gain kept."""
    text = (
        CLOSED
        + """
[variables]
pinion.profile_shift = [0.8, 1.1]
basic_rack.addendum = [0.8, 1.05]
[keep]
gain = "pinion.normal_module"
[objectives.rated_root_pinion]
"""
    )
    found = found_in(tmp_path, text)
    problem, best = found.search.problem, found.front[0]
    numbers = []
    for shift in np.linspace(0.8, 1.1, 31):
        for addendum in np.linspace(0.8, 1.05, 26):
            values = {"pinion.profile_shift": float(shift), "basic_rack.addendum": float(addendum)}
            result = evaluate(problem, values)
            numbers += result.findings.get("numbers", [])
    assert best.numbers[0] == pytest.approx(min(numbers), rel=0.01)
    given = rps.SteeringGear()
    assert GearPair.of(best.gear).gain == pytest.approx(GearPair.of(given).gain, rel=1e-7)


def test_numbers_of_a_design_are_those_of_a_batch(tmp_path: Path) -> None:
    """At level 1 without bars, the same gears give the same metrics; those learned from give guesses."""
    gear = rps.SteeringGear().replace({"mesh.law": "line", "pinion.helix_angle": "28 deg"})
    fidelity = Fidelity.preset("quasi-static").replace({"step_angle": "5 deg"})
    errors = {"yoke.preload": [280.0, 300.0, 320.0], "pinion.runout": [0.0, 1e-5, 5e-6]}
    table = {path: np.array(values) for path, values in errors.items()}
    found = table_of_metrics("free-pinion-torque", gear, fidelity, table)
    assert found is not None
    singly = rps.batch("free-pinion-torque", gear, table, fidelity=fidelity)
    assert found.ended.all()
    assert not found.errors
    for name in ("torque_mean", "torque_peak_to_peak"):
        np.testing.assert_allclose(found.summary[name], singly.summary[name], rtol=1e-3)


def test_failed_gears_are_worse_than_all_others(made_up_result: rps.Result) -> None:
    lost = replace(made_up_result, status=Status.CONTACT_LOST, message="the rack left the mesh")
    ended = [replace(made_up_result, summary={"torque_mean": torque}) for torque in (0.5, 0.7, 0.6, 0.6)]
    series = rps.Batch((ended[0], lost, *ended[1:]))  # the last one is the gear without errors
    asked = Number("torque", "torque_mean", "free-pinion-torque", (), 0.6)
    assert number_in(series, asked) == 0.7
    assert number_in(series, replace(asked, quantile=None)) == 0.6
    with pytest.raises(rps.InputError, match="1 of 4 gears of the series fail: the rack left the mesh"):
        number_in(series, replace(asked, quantile=0.9))


def test_refused_design_has_its_cause(tmp_path: Path) -> None:
    text = CLOSED + "[variables]\npinion.profile_shift = [-0.5, 1.0]\n[objectives.torque_mean]\n"
    problem: Problem = read_problem(written(tmp_path, text))
    result = evaluate(problem, {"pinion.profile_shift": -0.5})
    assert result.status is Status.INVALID
    assert "cutter" in result.message or "undercut" in result.message


def _command(folder: Path, out: str) -> list[str]:
    options = ["--out", out, "--jobs", "1", "--json"]
    return [sys.executable, "-m", "rps_exudyn", "optimise", str(folder / "wanted.toml"), *options]


@pytest.mark.long
@pytest.mark.parametrize(("text", "kills"), [(KILLED, 5), (MANY, 3)], ids=["search", "tolerances"])
def test_killed_search_ends_as_one_that_was_not(tmp_path: Path, text: str, kills: int) -> None:
    """SIGKILL while gears are computed: cases in the folder stay, and the end is the same to the bit."""
    pytest.importorskip("pymoo")
    written(tmp_path, text)
    cases, stored = tmp_path / "killed" / "cases", set[str]()
    for number in range(kills):
        process = subprocess.Popen(_command(tmp_path, "killed"), cwd=tmp_path, stderr=subprocess.DEVNULL)
        while len(found := {path.name for path in cases.glob("[!.]*.h5")}) <= len(stored) + 2 * number:
            assert process.poll() is None, "it ended before it was killed"
            time.sleep(0.01)
        process.kill()
        process.wait()
        assert stored <= found
        stored = found
    whole, again = (
        json.loads(subprocess.run(_command(tmp_path, out), cwd=tmp_path, capture_output=True).stdout)
        for out in ("whole", "killed")
    )
    assert whole.keys() == again.keys()
    assert {key for key in whole if whole[key] != again[key]} == {"folder", "files"}
