"""The README's two commands: one line each, and `.ci/run` runs the second as it is printed."""

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def command(name: str) -> str:
    """The one line of the block marked with this name."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    return re.findall(rf"<!-- {name} command -->\n```sh\n(.+)\n```\n", readme)[0]


@pytest.mark.parametrize("name", ["run", "test"])
def test_command_needs_only_python_and_pip(name: str) -> None:
    assert command(name).startswith("python3 -m venv .venv && .venv/bin/pip install -q -e ")


def test_ci_runs_the_printed_command_and_hands_on_its_status(tmp_path: Path) -> None:
    """With a stand-in for python3, which is the first word of the command."""
    python3 = tmp_path / "python3"
    python3.write_text('#!/bin/sh\necho "called with $*"\nexit 3\n')
    python3.chmod(0o755)
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run([ROOT / ".ci" / "run"], env={"PATH": path}, capture_output=True, text=True)
    assert done.stdout.splitlines() == [f"+ {command('test')}", "called with -m venv .venv"]
    assert done.returncode == 3


def test_readme_says_what_is_left_out() -> None:
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    said = text[text.index("**What is left out**") : text.index("## How to choose a fidelity")]
    for word in ("gravity", "bending of the teeth", "temperature", "lubrication", "mesh.damping", "pulls"):
        assert word in said
