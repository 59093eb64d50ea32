"""Code in the pages does what it says: Python runs, commands exist with their options, TOML is a study."""

import ast
import dataclasses
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
from cyclopts import CycloptsError

from made_up_study import make_study
from rps_exudyn.cli import commands
from rps_exudyn.results.result import Result

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
ELSEWHERE = ("dask_jobqueue",)  # libraries of a cluster


def blocks(language: str) -> Iterator[tuple[str, str]]:
    """Page and text of every block of a language."""
    for page in PAGES:
        for text in re.findall(rf"```{language}\n(.+?)```", page.read_text(encoding="utf-8"), re.S):
            yield page.name, text


def named(found: Iterator[tuple[str, str]]) -> list[object]:
    return [pytest.param(text, id=f"{page}-{number}") for number, (page, text) in enumerate(found)]


@pytest.mark.parametrize("text", named(blocks("python")))
def test_python_runs(
    text: str, made_up_result: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """On a made-up result and study."""
    if any(name in text for name in ELSEWHERE):
        ast.parse(text)
        return
    with_accuracy = dataclasses.replace(made_up_result, findings={"accuracy": "quasi-static"})
    monkeypatch.setattr("rps_exudyn.run", lambda *_, **__: with_accuracy, raising=False)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    make_study(tmp_path / "preload", made_up_result)
    names: dict[str, object] = {}
    exec("import rps_exudyn as rps\ngear = rps.SteeringGear()", names)
    exec(text, names)


def written_commands() -> list[str]:
    lines = [line for _, text in blocks("sh") for line in text.splitlines()]
    parts = [part.strip() for line in lines for part in re.split(r"&&|#", line)[:2]]
    return sorted({part for part in parts if part.startswith("rps-exudyn ")})


@pytest.mark.parametrize("line", written_commands())
def test_command_exists_with_its_options(line: str) -> None:
    try:
        commands.app.parse_args(shlex.split(line)[1:], exit_on_error=False, print_error=False)
    except CycloptsError as error:
        pytest.fail(f"{line}: {error}")


def test_pages_name_commands() -> None:
    assert len(written_commands()) > 8
