"""`--accuracy`: what cannot be promised is refused in a sentence; what can be says why."""

import pytest

from rps_exudyn.accuracy.choice import percent, scene_table
from rps_exudyn.errors import InputError
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
    floor = scene_table("free-pinion-torque").floor
    assert f"{floor:.2g} %, which is the strictest" in refused(command, "--accuracy", "0.0001%")


def test_stricter_than_any_setting_of_the_preset(command: Command) -> None:
    best = min(each.promised for each in scene_table("rack-push").settings)
    said = refused(command, "rack-push", "--accuracy", f"{(best + scene_table('rack-push').floor) / 2}%")
    assert f"promises {best:.2g} %" in said


def test_scene_or_preset_that_was_not_measured(command: Command) -> None:
    assert "nothing was measured for yoke-impact" in refused(command, "yoke-impact", "--accuracy", "1%")
    assert "accuracies are known of flank, quasi-static" in refused(
        command, "--fidelity", "closed-form", "--accuracy", "1%"
    )


def test_with_choices_of_ones_own(command: Command) -> None:
    said = refused(command, "--accuracy", "1%", "--bush", "chain", "--set", "fidelity.step_angle=0.1")
    assert "leave out --bush, --set fidelity.step_angle" in said


def test_chosen_and_told(command: Command) -> None:
    answer = command(["run", "--accuracy", "1%", "--json"])
    assert answer.status == 0
    assert answer.json["fidelity"]["solver"] == "equilibrium"
    for word in ("quasi-static", "angles per tooth pitch", "promises", "ms of processor time"):
        assert word in answer.err
