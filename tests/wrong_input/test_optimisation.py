"""Mistakes in the file of an optimisation: one sentence each, before the search begins."""

import sys
from pathlib import Path

import pytest

import rps_exudyn as rps
from rps_exudyn.optimisation.definition import read_problem

RIGHT = """
fidelity = "closed-form"
errors = "none"
designs = 8
population = 4
[variables]
pinion.helix_angle = ["20 deg", "30 deg"]
[objectives.torque_mean]
[constraints."pinion.helix_angle"]
most = "28 deg"
"""


def test_right_file_is_read(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(RIGHT)
    problem = read_problem(file)
    assert [each.words for each in problem.numbers] == ["torque_mean (nominal)", "pinion.helix_angle"]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'pinion.helix_angle = ["20 deg", "30 deg"]',
            "pinion.profile_shift = [-0.8, 0.2]",
            "profile_shift from -0.8 to 0.2 allows no gear; the nearest admissible value is 0.54",
        ),
        ('["20 deg", "30 deg"]', '["20 deg", "70 deg"]', "it must be more than -60 deg"),
        ('["20 deg", "30 deg"]', '["30 deg", "20 deg"]', "least below most"),
        ('["20 deg", "30 deg"]', '"20 deg"', r"it must be \[least, most\]"),
        ("pinion.helix_angle = [", "pinion.helix = [", "pinion.helix is no parameter; the nearest"),
        ("pinion.helix_angle = [", "mesh.law = [", "only numbers of the gear can vary"),
        ("torque_mean", "torque_meen", r"'torque_meen' is unknown; the nearest ones are torque_mean"),
        ("torque_mean", "rack_lift", "a run of free-pinion-torque gives no rack_lift"),
        ("[objectives.torque_mean]", "[objectives.torque_mean]\nquantile = '120 %'", "the nearest is 100 %"),
        ("[objectives.torque_mean]", "[objectives.torque_mean]\nquantile = '-3 %'", "the nearest is 0 %"),
        ("[objectives.torque_mean]", "[objectives.torque_mean]\nquantile = '90 %'", "errors is none"),
        ("[objectives.torque_mean]", "[objectives.torque_mean]\nwhat = 1", "has what, which is no key"),
        ("[objectives.torque_mean]\n", "", "must have at least one table"),
        ('most = "28 deg"', 'most = "15 deg"', "contradicts its bounds; the nearest that can be kept is 20"),
        (
            'most = "28 deg"\n',
            'most = "28 deg"\n[constraints.low]\nmetric = "torque_mean"\nleast = "0.8 N*m"\n'
            '[constraints.high]\nmetric = "torque_mean"\nmost = "0.7 N*m"\n',
            "high: most is 0.7 N m, which contradicts low .nominal., least 0.8 N m; the nearest that can be",
        ),
        ('most = "28 deg"', 'most = "28 deg"\nleast = "29 deg"', "least must be below most"),
        ('most = "28 deg"', "metric = 'pinion.helix_angle'", "must have most, least or both"),
        ("designs = 8", "designs = 8\nrequirements = ['rated_flonk']", "the nearest one is rated_flank"),
        ("designs = 8", "designs = 2", "designs is 2; it must be a whole number"),
        ("designs = 8", "designs = 8\nconfirm = [1]", "confirm is"),
        ("[objectives", "[tolerances]\n[objectives", "tolerances is a table for rps.tolerances, not for"),
        ("designs = 8", "designs = 8\nbudget = 5", "budget is no key of an optimisation"),
        ("[objectives", "[keep]\ngain = 'pinion.helix_angle'\n[objectives", "by a distribution or by keep"),
        ("[objectives", "[keep]\nstrength = 'yoke.preload'\n[objectives", "keep has strength"),
    ],
)  # fmt: skip
def test_mistake_is_one_sentence(tmp_path: Path, old: str, new: str, said: str) -> None:
    file = tmp_path / "a.toml"
    assert old in RIGHT
    file.write_text(RIGHT.replace(old, new, 1))
    with pytest.raises(rps.InputError, match=said) as caught:
        read_problem(file)
    assert all(problem.startswith(str(file)) for problem in caught.value.problems)


def test_missing_pymoo_names_its_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pymoo", None)
    monkeypatch.setitem(sys.modules, "pymoo.config", None)
    file = tmp_path / "a.toml"
    file.write_text(RIGHT)
    with pytest.raises(rps.InputError, match=r"install rps-exudyn with its extra \[optimise\]"):
        rps.optimise(file, tmp_path / "out", jobs=1)
