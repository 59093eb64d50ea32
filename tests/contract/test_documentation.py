"""Commands in the pages exist with their options; tests/smoke/test_pages.py runs the code of all blocks."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest
from cyclopts import CycloptsError

import rps_exudyn as rps
from rps_exudyn.cli import commands

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(language: str) -> Iterator[tuple[str, str]]:
    """Page and text of every block of a language."""
    for page in PAGES:
        for text in re.findall(rf"```{language}\n(.+?)```", page.read_text(encoding="utf-8"), re.S):
            yield page.name, text


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


def test_reference_has_every_public_name() -> None:
    """At the place where it is defined: the site cannot be built otherwise."""
    page = (ROOT / "docs" / "reference.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^::: (.+)$", page, re.M))
    homes = {name: f"{getattr(rps, name).__module__}.{name}" for name in rps.__all__}
    assert {name for name, home in homes.items() if home not in listed} == set()
