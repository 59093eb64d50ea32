"""What a study promises: which cases, under which names, in which files."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from made_up_study import description
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.gear import Setup
from rps_exudyn.results.block import CaseRecord, CaseRow, Keep
from rps_exudyn.results.result import Result
from rps_exudyn.study.case_progress import case_line
from rps_exudyn.study.cases import case_hash, describe, setup_of
from rps_exudyn.study.definition import Axis, Case, Description, Study
from rps_exudyn.study.designs import points
from rps_exudyn.study.study_file import read_study

LINKED = """
scene = "free-pinion-torque"
fidelity = "quasi-static"
[set]
test.turns = 2
fidelity.step_angle = "2 deg"
[[axis]]
path = "yoke.preload"
unit = "kN"
values = [0.1, "200 N"]
[[axis]]
name = "friction"
paths = ["mesh.friction", "yoke.friction"]
linspace = [0.1, 0.3, 3]
along.bearing.friction_torque = ["10 N*mm", "20 N*mm", "30 N*mm"]
"""
SAMPLED = """
scene = "free-pinion-torque"
fidelity = "quasi-static"
design = "{design}"
samples = 8
seed = {seed}
[[axis]]
path = "yoke.preload"
uniform = ["100 N", "200 N"]
[[axis]]
path = "mesh.friction"
loguniform = [0.01, 0.1]
[[axis]]
path = "pinion.pitch_error"
normal = ["0 um", "2 um"]
[[axis]]
path = "test.direction"
values = [-1, 1]
"""


def study_of(folder: Path, text: str) -> Study:
    (folder / "s.toml").write_text(text)
    return read_study(folder / "s.toml")


def test_line_of_the_log_has_units(made_up_result: Result) -> None:
    """A step in radians would be a number without meaning to a reader."""
    step = Axis("step", ("fidelity.step_angle",), "", None, "sampled")
    case = Case("0" * 16, {"step": np.deg2rad(2.0)})
    described = description([], axes=(step,), cases=(case,))
    row = dataclasses.replace(
        CaseRow.of(CaseRecord.of(case.hash, made_up_result)), message="fine", wall_s=0.5
    )
    assert case_line(described, case, row) == f"{case.hash} ok 0.500 s step=2 ° fine"


def test_grid_counts_its_last_axis_fastest_and_moves_linked_paths(tmp_path: Path) -> None:
    study = study_of(tmp_path, LINKED)
    description = describe(study, {})
    assert [tuple(case.values.values()) for case in description.cases] == [
        (100.0, 0.1), (100.0, 0.2), (100.0, 0.3), (200.0, 0.1), (200.0, 0.2), (200.0, 0.3),
    ]  # fmt: skip
    setup = setup_of(study, description.cases[4])
    assert setup.yoke.preload == 200
    assert setup.mesh.friction == setup.yoke.friction == 0.2
    assert setup.bearing.friction_torque == pytest.approx(0.02)
    assert setup.test.turns == 2
    assert setup.fidelity.step_angle == pytest.approx(np.deg2rad(2))
    assert description.base == {"test.turns": 2.0, "mesh.law": "line"}


def test_case_is_what_run_would_take(tmp_path: Path) -> None:
    """Study and command line mean the same by the same settings, the hash too."""
    study = study_of(tmp_path, LINKED)
    (case, *_) = describe(study, {}).cases
    by_hand = Setup.from_tables(
        {"fidelity": {"solver": "equilibrium"}},
        {
            "yoke.preload": "100 N",
            "bearing.friction_torque": "10 N*mm",
            "test.turns": 2,
            "mesh.law": "line",  # which the scene needs
            "fidelity.step_angle": "2 deg",
        },
    )
    assert setup_of(study, case).steering_gear == by_hand.steering_gear
    assert case.hash == case_hash("free-pinion-torque", by_hand.steering_gear, by_hand.fidelity)


def test_hash_knows_all_that_numbers_depend_on_and_not_the_name() -> None:
    setup = Setup()
    base = case_hash("free-pinion-torque", setup, setup.fidelity)
    assert len(base) == 16
    changed = setup.replace({"yoke.preload": 300.0000001})
    finer = setup.fidelity.replace({"step_angle": 0.01})
    renamed = setup.fidelity.replace({"name": "mine"})
    others = {
        case_hash("free-pinion-torque", changed, setup.fidelity),
        case_hash("load-test", setup, setup.fidelity),
        case_hash("free-pinion-torque", setup, finer),
    }
    assert len(others | {base}) == 4
    assert case_hash("free-pinion-torque", setup, renamed) == base


def test_axis_may_choose_the_model(tmp_path: Path) -> None:
    text = 'fidelity = "flank"\n[[axis]]\npath = "fidelity.bush"\nvalues = ["condensed", "chain"]\n'
    study = study_of(tmp_path, text)
    condensed, chain = (setup_of(study, case).fidelity for case in describe(study, {}).cases)
    assert (condensed.bush, chain.bush) == ("condensed", "chain")
    assert chain.name == "flank with bush chain"


@pytest.mark.parametrize("design", ["latin-hypercube", "sobol", "random", "morris", "saltelli"])
def test_sampled_designs_repeat_with_their_seed_and_stay_in_their_limits(tmp_path: Path, design: str) -> None:
    if design in ("morris", "saltelli"):
        pytest.importorskip("SALib")
    first, again, other = (
        describe(study_of(tmp_path, SAMPLED.format(design=design, seed=seed)), {}) for seed in (1, 1, 2)
    )
    assert first.cases == again.cases
    assert first.cases != other.cases
    assert len(first.cases) == 8 * {"morris": 5, "saltelli": 6}.get(design, 1)
    columns = {name: np.array([case.values[name] for case in first.cases]) for name in first.cases[0].values}
    for name, least, most in (
        ("yoke.preload", 100, 200),
        ("mesh.friction", 0.01, 0.1),
        ("pinion.pitch_error", -6e-6, 6e-6),
    ):
        assert least <= columns[name].min() < columns[name].max() <= most * (1 + 1e-12)
    assert set(columns["test.direction"]) == {-1, 1}


def test_drawn_values_have_their_distribution() -> None:
    axes = (
        Axis("u", ("yoke.preload",), "N", None, "sampled", {}, {"kind": "uniform", "numbers": [1.0, 3.0]}),
        Axis(
            "l", ("yoke.preload",), "N", None, "sampled", {}, {"kind": "loguniform", "numbers": [1.0, 100.0]}
        ),
        Axis("n", ("yoke.preload",), "N", None, "sampled", {}, {"kind": "normal", "numbers": [5.0, 2.0]}),
    )
    drawn = np.array([list(point.values()) for point in points(axes, "latin-hypercube", 2000, 3)])
    assert np.allclose(np.median(drawn, axis=0), [2, 10, 5], rtol=0.01)
    assert np.isclose(drawn[:, 2].std(), 2 * 0.9866, rtol=0.01)  # cut off at three deviations
    assert np.abs(drawn[:, 2] - 5).max() <= 6


@pytest.mark.parametrize("kind", ["uniform", "loguniform", "normal", "lognormal"])
def test_column_of_drawn_values_is_what_each_is_alone(kind: str) -> None:
    """To the bit, without any tolerance: the values name the cases, by which a study is taken up again."""
    fractions = np.concatenate([[0.0, 0.5, 1.0], np.random.default_rng(1).random(5000)])
    distribution = Distribution(kind, 1.3e-4, 2.7)
    assert distribution.quantiles(fractions) == [float(distribution.quantile(u)) for u in fractions.tolist()]


def test_description_is_read_as_it_was_written(tmp_path: Path) -> None:
    for text in (LINKED, SAMPLED.format(design="sobol", seed=1)):
        description = describe(study_of(tmp_path, text), {"command": "study"})
        (tmp_path / "study.json").write_text(description.to_json())
        assert Description.read(tmp_path / "study.json") == description


def test_toy_has_two_values_of_each_axis(tmp_path: Path) -> None:
    assert len(describe(study_of(tmp_path, LINKED).toy(), {}).cases) == 4
    assert len(describe(study_of(tmp_path, SAMPLED.format(design="random", seed=1)).toy(), {}).cases) == 4


def test_kept_signals_are_thinned_evenly_with_both_ends(made_up_result: Result) -> None:
    thin = Keep(("time", "pinion_torque"), 11).of(made_up_result)
    assert list(thin.signals) == ["time", "pinion_torque"]
    assert np.array_equal(thin["time"], made_up_result["time"][::12])
    assert not Keep(()).of(made_up_result).signals
    assert Keep().of(made_up_result).signals.keys() == made_up_result.signals.keys()
