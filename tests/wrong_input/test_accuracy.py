"""`--accuracy`: what cannot be promised is refused in a sentence; what can be says why."""

import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.simulate.by_accuracy import choose, known_scenes, percent, scene_tables
from shell import Command


@pytest.mark.parametrize("text", ["1", "", "%", "-1%", "0%", "nan%", "1e999%", "one%"])
def test_no_percentage(text: str) -> None:
    with pytest.raises(InputError, match="for instance 1%"):
        percent(text)
    assert percent("0.1 %") == 0.1


def refused(command: Command, *arguments: str) -> str:
    answer = command(["run", *arguments])
    assert answer.status == 2
    return " ".join(answer.err.split())


def test_stricter_than_the_floor(command: Command) -> None:
    floor = scene_tables("free-pinion-torque")[0].floor
    assert f"{floor:.2g} %, and no stricter accuracy" in refused(command, "--accuracy", "0.0001%")


def test_stricter_than_any_setting_of_the_preset(command: Command) -> None:
    table = scene_tables("rack-push")[0]
    best = min(each.promised for each in table.settings)
    said = refused(command, "rack-push", "--accuracy", f"{(best + table.floor) / 2}%")
    assert f"promises {best:.2g} %" in said


def test_scene_or_preset_that_was_not_measured(command: Command) -> None:
    said = refused(command, "stick-slip", "--accuracy", "1%")
    assert (
        f"--accuracy has tables for {', '.join(known_scenes())}; for stick-slip nothing can be promised: it"
        in said
    )
    assert "accuracies are known of flank, quasi-static" in refused(
        command, "--fidelity", "closed-form", "--accuracy", "1%"
    )


def test_a_growing_force_which_finds_another_quantity(command: Command) -> None:
    said = refused(command, "rattle", "--set", "test.road_shape=growing-sine", "--accuracy", "1%")
    assert "test.road_shape is growing-sine, which serves to find a threshold" in said


def test_every_scene_has_a_table_or_a_reason_why_it_has_none() -> None:
    for name in SCENE_NAMES:
        assert (name in known_scenes()) is not bool(scene_named(name).unpromised(SteeringGear())), name


def test_settings_in_a_scenes_own_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    row = {"preset": "flank", "angles_per_pitch": None, "settings": {"tolerance": 1e-3}, "promised": 2.0}
    row |= {"median": 1.0, "cost": 2.0, "cost_of_turn": 2.0, "failed": 0.0}
    quantity = {"quantity": "impact_peak_force", "floor": 0.1, "gears": 12, "settings": [row]}
    table = {"scenes": {"yoke-impact": {"quantities": [quantity]}}, "laws": {}}
    monkeypatch.setattr("rps_exudyn.simulate.by_accuracy._tables", lambda: table)
    choice = choose("yoke-impact", SteeringGear(), 3.0)
    assert choice.fidelity.step_angle == Fidelity.preset("flank").step_angle
    assert choice.fidelity.tolerance == 1e-3
    assert "promises 2 % of impact_peak_force" in choice.why
    assert choice.why.endswith("ms of CPU time per run")


def test_with_choices_of_ones_own(command: Command) -> None:
    said = refused(command, "--accuracy", "1%", "--bush", "chain", "--set", "fidelity.step_angle=0.1")
    assert "leave out --bush, --set fidelity.step_angle" in said


def test_choice_and_its_reason_are_printed(command: Command) -> None:
    """In a line, with what finer steps change in the next; how the choice was made is on the full sheet.
    Before them may stand that force laws are compiled."""
    answer = command(["run", "--accuracy", "1%", "--json"])
    assert answer.status == 0
    assert answer.json["fidelity"]["solver"] == "equilibrium"
    choice, check = answer.err.splitlines()[-2:]
    for word in ("quasi-static", "angles per tooth pitch", "the cheapest of", "within 1 %"):
        assert word in choice
    assert "in half the steps" in check
