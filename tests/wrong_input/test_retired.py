"""Choices of earlier versions: their results are read, and one sentence says what replaces them."""

import dataclasses
from pathlib import Path

import pytest

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.wrong_values import CHOICES, PARAMETERS
from rps_exudyn.results.result import Result
from rps_exudyn.study.blocks import load
from shell import Command

RETIRED = [(path, value, instead) for path, values in CHOICES.items() for value, instead in values.items()]


@pytest.mark.parametrize(("path", "value", "instead"), RETIRED)
def test_choice_is_answered_with_what_replaces_it(
    path: str, value: str, instead: str, command: Command
) -> None:
    answer = command(["run", "--set", f"{path}={value}"])
    assert answer.status == 2
    assert answer.err.count("\n") == 1
    assert f"{path} is '{value}', which earlier versions had: {instead}." in answer.err


@pytest.mark.parametrize("option", ["--mesh=ratio", "--bush=adams-chain"])
def test_option_is_answered_too(option: str, command: Command) -> None:
    answer = command(["run", option])
    assert answer.status == 2
    assert "which earlier versions had" in answer.err


def test_yoke_is_a_body(command: Command) -> None:
    answer = command(["run", "--yoke", "force"])
    assert (answer.status, PARAMETERS["fidelity.yoke"] in answer.err) == (2, True)


@pytest.mark.parametrize("path", PARAMETERS)
def test_parameter_is_answered_with_what_replaces_it(path: str, command: Command) -> None:
    answer = command(["run", "--set", f"{path}=7"])
    assert answer.status == 2
    assert PARAMETERS[path] in answer.err


def test_axis_of_a_study_is_answered_too(command: Command) -> None:
    for path, value in (
        ("fidelity.mesh", "ratio"),
        ("fidelity.yoke", "force"),
        ("fidelity.generators", "20"),
    ):
        text = value if value.isdigit() else f'"{value}"'
        Path("study.toml").write_text(
            f'title = "Old"\nscene = "free-pinion-torque"\n[[axis]]\npath = "{path}"\nvalues = [{text}]\n'
        )
        answer = command(["study", "study.toml", "--dry-run"])
        assert answer.status == 2, (path, answer.out, answer.err)
        assert "which earlier versions had" in answer.err or PARAMETERS.get(path, "-") in answer.err


def test_what_remains_of_a_choice_is_read() -> None:
    """Models stored by earlier versions hold all their choices; studies may set the one that remains."""
    stored = Fidelity().model_dump() | {"yoke": "body", "generators": 160}
    assert Fidelity.from_tables(stored) == Fidelity() == Fidelity.from_tables({"yoke": "body"})


@pytest.fixture
def old(made_up_result: Result, tmp_path: Path) -> Path:
    """A result of an earlier version."""
    fidelity = {
        **Fidelity().model_dump(),
        "name": "flank with mesh ratio",
        "mesh": "ratio",
        "yoke": "force",
        "generators": 160,
    }
    file = tmp_path / "old.h5"
    dataclasses.replace(made_up_result, fidelity=fidelity).save(file)
    return file


def test_result_of_a_retired_choice_is_read_and_not_run_again(old: Path, command: Command) -> None:
    assert load(old).fidelity["mesh"] == "ratio"
    for words in (["show", str(old)], ["diff", str(old), str(old)]):
        assert command(words).status == 0, words
    answer = command(["rerun", str(old)])
    assert answer.status == 2
    assert "mesh is 'ratio', which earlier versions had" in answer.err
