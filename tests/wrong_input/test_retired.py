"""Choices of earlier versions: their results are read, and one sentence says what replaces them."""

import dataclasses
from pathlib import Path

import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.retired import CHOICES, PARAMETERS, STORED, gone
from rps_exudyn.results.result import Result
from rps_exudyn.study.case_blocks import load
from shell import Command, refusal_of
from verification.law_area import by_law

RETIRED = [(path, value, instead) for path, values in CHOICES.items() for value, instead in values.items()]


@pytest.mark.parametrize(("path", "value", "instead"), RETIRED)
def test_choice_is_answered_with_what_replaces_it(
    path: str, value: str, instead: str, command: Command
) -> None:
    said = refusal_of(command(["run", "--set", f"{path}={value}"]))
    assert said.count("\n") == 1
    assert f"{path} is '{value}', which only earlier versions have: {instead}." in said


@pytest.mark.parametrize("option", ["--mesh=ratio", "--bush=adams-chain"])
def test_option_is_answered_too(option: str, command: Command) -> None:
    assert "which only earlier versions have" in refusal_of(command(["run", option]))


def test_yoke_is_a_body(command: Command) -> None:
    assert PARAMETERS["fidelity.yoke"] in refusal_of(command(["run", "--yoke", "force"]))


@pytest.mark.parametrize("path", PARAMETERS)
def test_parameter_is_answered_with_what_replaces_it(path: str, command: Command) -> None:
    assert PARAMETERS[path] in refusal_of(command(["run", "--set", f"{path}=7"]))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("fidelity.mesh", '"ratio"'),
        ("fidelity.yoke", '"force"'),
        ("fidelity.generators", "20"),
        ("fidelity.torque_tolerance", "0.001"),
        ("mesh.law", '"area"'),
    ],
)
def test_axis_of_a_study_is_answered_too(path: str, value: str, command: Command) -> None:
    Path("study.toml").write_text(
        f'title = "Old"\nscene = "free-pinion-torque"\n[[axis]]\npath = "{path}"\nvalues = [{value}]\n'
    )
    answer = command(["study", "study.toml", "--dry-run"])
    assert answer.status == 2, answer.out
    assert "which only earlier versions have" in answer.err or PARAMETERS.get(path, "-") in answer.err


def test_what_remains_of_a_choice_is_read() -> None:
    """Models stored by earlier versions hold all their choices; studies may set the one that remains."""
    stored = Fidelity().model_dump() | {"yoke": "body", "generators": 160, "torque_tolerance": 0.0}
    assert Fidelity.from_tables(stored) == Fidelity() == Fidelity.from_tables({"yoke": "body"})


@pytest.fixture(params=["ratio", "area"])
def old(made_up_result: Result, tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    """A result of an earlier version, by its kinematic ratio or its contact law."""
    stored = {**Fidelity().model_dump(), "yoke": "body", "generators": 160}
    if request.param == "ratio":
        stored |= {"name": "flank with mesh ratio", "mesh": "ratio", "yoke": "force"}
        made = dataclasses.replace(made_up_result, fidelity=stored)
    else:
        made = dataclasses.replace(
            made_up_result, fidelity=stored, gear=by_law(made_up_result.gear, request.param)
        )
    file = tmp_path / f"{request.param}.h5"
    made.save(file)
    return file


def test_result_of_a_retired_choice_is_read_and_not_run_again(old: Path, command: Command) -> None:
    read = load(old)
    assert old.stem in (read.fidelity["mesh"], read.gear.mesh.contact_law)
    for words in (["show", str(old)], ["diff", str(old), str(old)], ["report", str(old), "--out", "r.html"]):
        assert command(words).status == 0, words
    assert f" is '{old.stem}', which only earlier versions have" in refusal_of(command(["rerun", str(old)]))


def test_what_a_result_asked_for_and_has_gone_is_named() -> None:
    stored = Fidelity().model_dump() | {"yoke": "body", "torque_tolerance": 1e-3}
    (sentence,) = gone(stored, "fidelity")
    assert sentence.startswith("fidelity.torque_tolerance was 0.001 and has gone: accuracy")
    assert not gone(stored | {"torque_tolerance": 0.0}, "fidelity")


def test_stored_nonsense_is_no_choice_of_an_earlier_version() -> None:
    with pytest.raises(InputError, match=r"mesh\.law is 'gear'; it must be by-scene or line or teeth"):
        SteeringGear.from_tables({"mesh": {"law": "gear"}}, context=STORED)
