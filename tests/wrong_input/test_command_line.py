"""A user's mistake on the command line: status 2, one sentence on standard error, no file touched."""

import dataclasses
import os
import shlex
from pathlib import Path

import h5py
import pytest

from rps_exudyn.results.result import Result
from rps_exudyn.scenes import free_pinion_torque
from shell import Command, refusal_of


@pytest.fixture(autouse=True)
def no_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wrong input must be found before anything is simulated."""

    def simulated(*_: object) -> None:
        pytest.fail("simulated in spite of wrong input")

    monkeypatch.setattr(
        free_pinion_torque, "SCENE", dataclasses.replace(free_pinion_torque.SCENE, run=simulated)
    )


OTHER_FILE = "report takes folders of studies, results (.h5), sheets (.json) and gears (.toml)"
MISTAKES = {
    "runn": 'Unknown command "runn".',
    "run free-pinion-torque again": "again is not an argument of this command",
    "run somewhere": "SCENE is 'somewhere'; it must be one of free-pinion-torque",
    "run --speed 3": "Unknown option",
    "run --out": "requires an argument",
    "run --fidelity perfect": "perfect",
    "run --mesh glue": "glue",
    "run --gear missing.toml": "missing.toml cannot be read: there is no such file.",
    "run --set yoke.preload": "--set yoke.preload is no setting; write PATH=VALUE",
    "run --set yoke.preload=3kg": "yoke.preload is '3kg', which is no quantity in N",
    "run --set pinion.tip_diameter=20mm": "pinion.tip_diameter is 20 mm, the nearest",
    "run --out missing/a.h5": "missing/a.h5 cannot be written: there is no folder",
    "explore --port 70000": "--port is 70000; it must be from 0 to 65535",
    "explore --host=": "--host is empty; give an address, for instance 127.0.0.1",
    f"explore --host {'ä' * 70}": "äää --port 0 cannot be used: it is not a host name.",
    "explore --host nowhere.invalid": "--host nowhere.invalid --port 0 cannot be used:",
    "animate missing.h5": "missing.h5",
    "animate r.h5 --view below": "--view is 'below'; it must be one of gear, mesh",
    "animate r.h5 --out a.avi": "a.avi cannot be written: its name must end in .html",
    "run --out .": ". cannot be written: its name must end in .h5 or .hdf5.",
    "run --out a.txt": "a.txt cannot be written: its name must end in .h5 or .hdf5.",
    "run --plot a.doc": "a.doc cannot be written: its name must end in .png or .svg or .pdf.",
    "run --mesh general-contact --solver closed-form": "fidelity.mesh is general-contact, but",
    "export gear.xyz": "gear.xyz cannot be written: its name must end in .stl or .glb or .step or .fmu",
    "export nowhere/gear.fmu": "nowhere/gear.fmu cannot be written: there is no folder",
    "export gear.fmu --load -3": "load is -3.0 N; it must be greater than 0",
    "export gear.fmu --fmi 4": "fmi is 4; it must be 3 or 2",
    "run --fidelity closed-form --bush chain": "fidelity.bush is chain, but fidelity.solver is closed-form",
    "run --fidelity full --solver equilibrium": "fidelity.bush is chain, but fidelity.solver is equilibrium",
    "run yoke-impact --set fidelity.swing_steps=3": "fidelity.swing_steps is 3; it must be 0",
    "run --set fidelity.step_angle=1mm": "fidelity.step_angle is '1mm', which is no quantity in rad",
    "run --set fidelity.step_angel=1": "fidelity.step_angel is no parameter; the nearest ones are",
    "run --set fidelity.name=mine": "fidelity.name cannot be set",
    "run --set fidelity.step_angle=1e-9deg": "must be at least 0.001 deg",
    "run --accuracy 1% --fidelity closed-form": "fidelity is closed-form, which has no ladder to climb",
    "run --accuracy 1% --level 2": "accuracy chooses the level itself; leave out level",
    "run --accuracy 1% --bush chain": "--accuracy chooses the model itself; leave out --bush",
    "run --accuracy 1% --set fidelity.step_angle=0.1": "leave out --set fidelity.step_angle",
    "run --accuracy 1% --metrics torque": "metrics has torque, which is no metric with an error bar; take",
    "run --accuracy 1% --band 9": "--band makes many runs; leave out --accuracy",
    "run --inputs series": "add --band",
    "run --band 16 --robust": "leave out --robust",
    "run --band 16 17": "takes one",
    "run --band 16 --set 'yoke.preload=300 N +- -1 N'": "a deviation above 0",
    "run --band 16 --inputs own": "no parameter carries a distribution",
    "run --band x": "unable to convert",
    "report r.png": OTHER_FILE,
    "report batch.csv": OTHER_FILE,
    "report r-animation.html": OTHER_FILE,
    "validate --only undercut-limit --out page.txt": "page.txt cannot be written: its name must end in",
    "geometry --set fidelity.mesh=flank": "fidelity is no table of parameters",
    "diff a.h5": "requires an argument",
    "diff missing.h5 other.h5": "missing.h5 cannot be read: there is no such file.",
    "diff a.h5 b.h5 --plot a.doc": "a.doc cannot be written: its name must end in .png",
    "show": "requires an argument",
    f"run --out {'a' * 300}.h5": ".h5 cannot be written: File name too long.",
    f"run --out {'a' * 252}.h5": ".h5 cannot be written: File name too long.",  # no room beside it
    f"run --set x={'9' * 5000}": "x is no parameter; there are",
    f"run --set yoke.preload={'9' * 5000}": "99999'; it must be finite.",
    f"run --set pinion.teeth={'9' * 5000}": "99999'; it must be a whole number",
    f"run --set yoke.preload={'9' * 400}": "yoke.preload is too large a number.",
    f"run --set x={'[' * 5000}": "x is no parameter; there are",
    "run --set ..=3": "--set ..=3 is no setting; write PATH=VALUE",
    "run --set yoke.=3": "--set yoke.=3 is no setting; write PATH=VALUE",
    f"show {'a' * 300}.h5": ".h5 cannot be read: File name too long.",
    "show missing.h5": "missing.h5 cannot be read: there is no such file.",
    "show .": ". cannot be read: it is a folder.",
    "geometry --out a.obj": "a.obj cannot be written: its name must end in .stl or .glb or .step",
    "export a.obj": "a.obj cannot be written: its name must end in .stl or .glb or .step",
    "export a.stl --part lid": "lid is no part of the gear; these are pinion, rack, plunger, yokenut, bush.",
    "geometry --out missing/a.stl": "missing/a.stl cannot be written: there is no folder",
    "geometry --set pinion.tip_diameter=20mm": "pinion.tip_diameter is 20 mm, the nearest",
    "describe yoke.preloda": "yoke.preloda is no parameter; the nearest one is yoke.preload.",
}


@pytest.mark.parametrize(("arguments", "sentence"), MISTAKES.items(), ids=lambda text: text[:60])
def test_mistake_ends_in_one_sentence(arguments: str, sentence: str, command: Command) -> None:
    answer = command(shlex.split(arguments))
    assert answer.status == 2
    assert answer.out == ""
    assert answer.err.count("\n") == 1
    assert answer.err.startswith("rps-exudyn: ")
    assert sentence in answer.err
    assert len(answer.err) < 400
    assert os.listdir() == []


def test_all_mistakes_of_the_settings_at_once(command: Command) -> None:
    said = refusal_of(
        command(["describe", "--set", "yoke.preload", "--set", "bush.drag=-1", "--set", "foo=2"])
    )
    assert [line.split()[1] for line in said.splitlines()] == ["--set", "bush.drag", "foo"]


def test_mistakes_of_gear_and_fidelity_at_once(command: Command) -> None:
    wrong = ["yoke.preload=-1", "bush.inner_diameter=40mm", "fidelity.zone_ratio=0"]
    settings = [word for setting in wrong for word in ("--set", setting)]
    said = refusal_of(command(["run", *settings, "--fidelity", "closed-form", "--mesh", "general-contact"]))
    assert [line.split()[1] for line in said.splitlines()] == [
        "yoke.preload", "fidelity.zone_ratio", "fidelity.mesh", "bush.inner_diameter",
    ]  # fmt: skip


def test_fidelity_is_no_matter_of_the_gears_file(command: Command) -> None:
    Path("gear.toml").write_text('[fidelity]\nmesh = "ratio"\n')
    assert "gear.toml: fidelity is no table of a gear" in refusal_of(command(["run", "--gear", "gear.toml"]))


def test_unknown_table_of_a_file_is_not_pointed_to_fidelity(command: Command) -> None:
    """No file may have it; a setting may."""
    Path("gear.toml").write_text("[brake]\nforce = 3\n[fidelty]\nmesh = 3\n")
    answer = command(["run", "--gear", "gear.toml", "--set", "clutch.force=3"])
    assert [(line.split(" is no ")[0], "fidelity" in line) for line in answer.err.splitlines()] == [
        ("rps-exudyn: gear.toml: brake", False),
        ("rps-exudyn: gear.toml: fidelty", False),
        ("rps-exudyn: clutch", True),
    ]


def test_show_refuses_what_is_no_result(command: Command) -> None:
    Path("text.h5").write_text("no HDF5")
    assert "text.h5 is no HDF5 file, or it is damaged." in command(["show", "text.h5"]).err
    with h5py.File("foreign.h5", "w"):
        pass
    assert "foreign.h5 is an HDF5 file, but not a result" in command(["show", "foreign.h5"]).err


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_read_only_folder_is_refused(command: Command, tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    assert "locked/a.h5 cannot be written: Permission denied." in command(["run", "--out", "locked/a.h5"]).err


def test_diff_draws_no_picture_without_common_angles(command: Command, made_up_result: Result) -> None:
    made_up_result.save("a.h5")
    dataclasses.replace(made_up_result, signals={}).save("b.h5")
    assert "c.png is not drawn: the two results share no range of the pinion angle." in refusal_of(
        command(["diff", "a.h5", "b.h5", "--plot", "c.png"])
    )
    assert sorted(os.listdir()) == ["a.h5", "b.h5"]


def test_wrong_input_leaves_an_existing_result(command: Command, made_up_result: Result) -> None:
    made_up_result.save("free-pinion-torque.h5")
    before = Path("free-pinion-torque.h5").read_bytes()
    assert command(["run", "--set", "bush.drag=-1"]).status == 2
    assert Path("free-pinion-torque.h5").read_bytes() == before
