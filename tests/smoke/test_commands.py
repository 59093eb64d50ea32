"""Each command once, on a made-up result where a simulation would take time."""

import dataclasses
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

import rps_exudyn.cli.run_band  # noqa: F401, what takes `simulate` at its import takes it before it is replaced
from rps_exudyn import load
from rps_exudyn.parameters.fidelity import PRESETS, Fidelity
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import GEOMETRY, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import rounded
from rps_exudyn.scenes import SCENE_NAMES
from shell import Command


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch, made_up_result: Result) -> Result:
    """What `run` gets instead of a simulation."""
    monkeypatch.setattr("rps_exudyn.simulate.run.simulate", lambda *_, **__: made_up_result)
    return made_up_result


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch, failed_result: Result) -> Result:
    """The same, of a simulation that failed."""
    monkeypatch.setattr("rps_exudyn.simulate.run.simulate", lambda *_, **__: failed_result)
    return failed_result


def test_run_prints_a_summary_and_writes_both_files(command: Command, simulated: Result) -> None:
    answer = command(["run", "--all"])
    assert answer.status == 0
    assert "torque_mean" in answer.out
    assert "0.600 ± 0.001 N m" in answer.out
    assert "35 mm" in answer.out
    assert load("free-pinion-torque.h5").status is Status.OK
    assert Path("free-pinion-torque.png").read_bytes().startswith(b"\x89PNG")
    assert answer.err == ""


def test_run_prints_a_sheet_of_eight_lines(command: Command, simulated: Result) -> None:
    answer = command(["run", "--no-plot"])
    assert len(answer.out.splitlines()) <= 8
    assert len(answer.out.split()) <= 100
    assert re.search(r"\n  0\.600 ± 0\.001 N m  mean torque; contact law line ± 0\.007 N m\n", answer.out)
    assert "written: free-pinion-torque.h5  (--all: " in answer.out
    assert os.listdir() == ["free-pinion-torque.h5"]


def test_overwritten_files_leave_no_others_and_quiet_runs_no_words(
    command: Command, simulated: Result
) -> None:
    for _ in range(2):
        answer = command(["run", "--overwrite", "--quiet"])
        assert (answer.status, answer.out, answer.err) == (0, "", "")
    assert sorted(os.listdir()) == ["free-pinion-torque.h5", "free-pinion-torque.png"]
    answer = command(["run", "--fidelity", "quasi-static", "--overwrite", "--quiet", "--band", "8"])
    assert (answer.status, answer.out, answer.err) == (0, "", "")
    assert "leave out --all" in command(["run", "--quiet", "--all"]).err
    assert "leave out --plot" in command(["run", "--no-plot", "--plot", "a.png"]).err


@pytest.mark.parametrize(
    ("name", "value", "error", "text"),
    [
        ("torque_mean", 0.6196, 0.0068, "0.620 ± 0.007 N m"),
        ("torque_mean", -14.03, 0.14, "−14.0 ± 0.1 N m"),
        ("torque_mean", 2480.0, 31.0, "2480 ± 30 N m"),
        ("torque_mean", 0.62, 0.0096, "0.62 ± 0.01 N m"),
        ("torque_mean", 0.62, float("nan"), "0.62 ± ? N m"),
        ("torque_peak_to_peak", 0.0, 0.031, "0.00 ± 0.03 N m"),
        ("torque_peak_to_peak", -0.0004, 2.4, "0 ± 2 N m"),
        ("torque_peak_to_peak", 1e-16, 3e-19, "0 N m"),
        ("torque_peak_to_peak", 0.02983, None, "0.030 N m"),
        ("torque_peak_to_peak", 1.4e-7, None, "0 N m"),
        ("torque_peak_to_peak", 1.5e-3, None, "1.5 N mm"),
        ("yoke_force_max", 312.4, None, "312 N"),
        ("yoke_force_max", float("nan"), None, "undetermined"),
    ],
)
def test_digits_are_those_of_the_error(name: str, value: float, error: float | None, text: str) -> None:
    assert rounded(SUMMARY[name], value, error) == text


def test_interrupt_while_the_picture_is_drawn_names_the_file_that_is_there(
    command: Command, simulated: Result, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C by its signal, as it comes, and as an extension wraps it."""

    def wrapped() -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt as interrupt:
            raise SystemError("returned a result with an exception set") from interrupt

    for comes in (lambda: signal.raise_signal(signal.SIGINT), wrapped):
        monkeypatch.setattr("rps_exudyn.pages.charts.scene_figures.draw", lambda *_, comes=comes: comes())
        answer = command(["run", "--out", "a.h5"])
        assert answer.status == 130
        assert answer.err.endswith("rps-exudyn: interrupted; a.h5 is written, the rest is not.\n")
        assert load("a.h5").summary == simulated.summary
        assert not Path("a.png").exists()


def test_run_hands_over_scene_gear_and_fidelity(
    command: Command, monkeypatch: pytest.MonkeyPatch, simulated: Result
) -> None:
    seen: list[tuple[str, SteeringGear, Fidelity]] = []

    def record(scene: str, gear: SteeringGear, fidelity: Fidelity, **_: object) -> Result:
        seen.append((scene, gear, fidelity))
        return simulated

    monkeypatch.setattr("rps_exudyn.simulate.run.simulate", record)
    settings = ["yoke.preload=0.4 kN", "test.direction=-1", "fidelity.step_angle=0.5 deg"]
    chosen = ["--fidelity", "full", "--bush", "rigid", *(f"--set={each}" for each in settings)]
    for more in ([], chosen):
        assert command(["run", *more, "--overwrite", "--out", "a.h5", "--plot", "b.svg"]).status == 0
    (_, _, usual), (scene, gear, fidelity) = seen
    assert (scene, usual) == ("free-pinion-torque", Fidelity.preset("flank"))
    assert gear == SteeringGear().replace({"yoke.preload": 400, "test.direction": -1})
    assert fidelity == Fidelity.preset("full").replace({"step_angle": "0.5 deg", "bush": "rigid"})
    assert fidelity.name == "full with bush rigid, step_angle 0.5 deg"
    assert sorted(path.name for path in Path().iterdir()) == ["a.h5", "b.svg"]


def test_json_is_printed_undisturbed_by_what_libraries_print(
    command: Command, monkeypatch: pytest.MonkeyPatch, made_up_result: Result
) -> None:
    def talkative(*_: object, **__: object) -> Result:
        print("NOTE: solver has something to say")
        return made_up_result

    monkeypatch.setattr("rps_exudyn.simulate.run.simulate", talkative)
    answer = command(["run", "--json", "--out", "a.h5"])
    assert (answer.json["status"], answer.json["summary"]["torque_mean"]) == ("ok", 0.6)
    assert answer.json["files"] == ["a.h5", "a.png"]
    assert "NOTE" in answer.err


def test_failed_run_says_how_in_its_file_and_exits_1(command: Command, failing: Result) -> None:
    answer = command(["run", "--out", "a.h5"])
    assert answer.status == 1
    assert (
        answer.err
        == f"rps-exudyn: the simulation failed (diverged): NaN at t = 0.1 s. {Status.DIVERGED.remedy}\n"
    )
    assert load("a.h5").status is Status.DIVERGED


def test_failed_run_does_not_replace_existing_files(
    command: Command, failing: Result, made_up_result: Result
) -> None:
    made_up_result.save("a.h5")
    answer = command(["run", "--out", "a.h5"])
    assert "written: a.failed.h5" in answer.out
    assert load("a.h5").status is Status.OK
    assert load("a.failed.h5").status is Status.DIVERGED
    assert sorted(os.listdir()) == ["a.failed.h5", "a.failed.png", "a.h5"]


def test_second_run_keeps_the_files_of_the_first(command: Command, simulated: Result) -> None:
    assert command(["run", "--out", "a.h5"]).err == ""
    assert "previous files renamed to a.1.h5, a.1.png" in command(["run", "--out", "a.h5"]).err
    assert "a.2.h5" in command(["run", "--out", "a.h5"]).err
    assert sorted(os.listdir()) == ["a.1.h5", "a.1.png", "a.2.h5", "a.2.png", "a.h5", "a.png"]
    assert load("a.1.h5").summary == simulated.summary


def test_show_prints_what_run_printed(command: Command, simulated: Result) -> None:
    printed_by_run = command(["run", "--all", "--out", "a.h5"]).out
    shown = command(["show", "a.h5"])
    assert shown.status == 0
    assert printed_by_run.startswith(shown.out)
    assert command(["show", "a.h5", "--json"]).json["summary"] == simulated.summary


def test_help_of_run_names_every_scene_preset_and_choice(command: Command) -> None:
    shown = command(["run", "--help"]).out
    choices = [str(choice) for item in Fidelity.declared() for choice in get_args(item.field.annotation)]
    for name in [*SCENE_NAMES, *PRESETS, *choices]:
        assert re.search(rf"\b{name}\b", shown), name


def test_diff_prints_what_differs(command: Command, made_up_result: Result) -> None:
    made_up_result.save("a.h5")
    torque = made_up_result["pinion_torque"] + 0.006
    other = dataclasses.replace(
        made_up_result,
        gear=made_up_result.gear.replace({"yoke.preload": 310}),
        signals=made_up_result.signals | {"pinion_torque": torque},
        summary=made_up_result.summary | {"torque_mean": 0.606, "torque_peak_to_peak": 0.0215},
    )
    other.save("b.h5")
    answer = command(["diff", "a.h5", "b.h5", "--plot", "c.png"])
    assert answer.status == 0
    assert re.search(r"yoke.preload +300 N +310 N", answer.out)
    assert re.search(r"torque_mean +0.600 ± 0.001 N m +0.606 ± 0.001 N m +0.006 ± 0.002 N m", answer.out)
    assert "1 of 2 differences exceeds the sum of both error bars: torque_mean.\n" in answer.out
    assert re.search(r"pinion_torque +1 % +1 %", answer.out)
    assert Path("c.png").read_bytes().startswith(b"\x89PNG")
    assert "pinion.teeth" not in answer.out


def test_diff_prints_json(command: Command, made_up_result: Result, failed_result: Result) -> None:
    made_up_result.save("a.h5")
    failed_result.save("b.h5")
    compared = command(["diff", "a.h5", "b.h5", "--json"]).json
    assert compared["status"] == ["ok", "diverged"]
    assert compared["settings"] == {}
    assert compared["summary"]["torque_mean"] == [0.6, 0.6]
    assert (compared["joint_bars"]["torque_mean"], compared["exceeding"]) == (0.0024, [])
    assert compared["signals"]["pinion_torque"]["rms"] == 0
    assert compared["signals"]["pinion_torque"]["unit"] == "N*m"


def test_geometry_prints_every_number_and_the_masses(command: Command) -> None:
    answer = command(["geometry"])
    assert answer.status == 0
    assert all(name in answer.out and item.long_name in answer.out for name, item in GEOMETRY.items())
    assert "mass of rack" in answer.out
    assert os.listdir() == []


@pytest.mark.parametrize(("name", "beginning"), [("a.glb", b"glTF"), ("a.png", b"\x89PNG"), ("a.STL", b"")])
def test_geometry_writes_solids_or_drawing(name: str, beginning: bytes, command: Command) -> None:
    answer = command(["geometry", "--out", name, "--json"])
    assert answer.status == 0
    assert answer.json["files"] == [name]
    assert answer.json["travel_per_turn"] == pytest.approx(0.035, rel=1e-2)  # pi z m_n / cos(beta_r)
    assert Path(name).read_bytes().startswith(beginning)
    assert os.listdir() == [name]


def test_geometry_builds_an_undercut_gear_only_by_force(command: Command) -> None:
    settings = ["pinion.profile_shift=0.5", "pinion.tip_diameter=17 mm", "pinion.shaft_diameter=10 mm"]
    undercut = ["geometry", *(word for setting in settings for word in ("--set", setting))]
    refused, forced = command(undercut), command([*undercut, "--force"])
    assert refused.status == 2
    assert "undercut" in refused.err
    assert forced.status == 0
    assert "undercut" in forced.out


def test_describe_names_every_parameter(command: Command) -> None:
    answer = command(["describe"])
    assert answer.status == 0
    assert all(item.path in answer.out and item.meaning in answer.out for item in Setup.declared())


def test_describe_one_says_what_is_allowed(command: Command) -> None:
    answer = command(["describe", "yoke.preload", "--set", "yoke.preload=350 N"])
    assert "350 N" in answer.out
    assert "at least 0 N" in answer.out


def test_describe_the_fidelity_of_a_preset(command: Command) -> None:
    described = command(["describe", "fidelity", "--fidelity", "full", "--json"]).json
    assert described["fidelity.mesh"]["value"] == "general-contact"
    assert "fidelity.name" not in described
    assert all(path.startswith("fidelity.") for path in described)
    length = command(["describe", "bush", "--json"]).json["bush.length"]
    assert (length["value"], length["unit"]) == (0.03, "m")
    assert list(command(["describe", "--json"]).json)[-len(described) :] == list(described)


def test_describe_says_what_the_gear_has_for_a_value_that_is_not_given(command: Command) -> None:
    """The stiffness at rest, 20.74 N/(mm um); and that a choice of the model is no estimate of a property."""
    derived = command(["describe", "mesh.line_stiffness"])
    assert "from the gear" in derived.out
    assert "20.7434 N/mm/um for this gear" in derived.out
    given = command(["describe", "mesh.line_stiffness", "--set", "mesh.line_stiffness=12 N/mm/um"])
    assert "for this gear" not in given.out
    choices = command(["describe", "fidelity", "--json"]).json
    assert {choice["source"] for choice in choices.values()} == {"choice"}


def test_module_is_the_command() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "rps_exudyn", "describe", "nothing"], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr.startswith("rps-exudyn: nothing is no parameter")
