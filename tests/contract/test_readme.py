"""The README's commands and example do what it says, and `.ci/run` runs the test command as it is printed."""

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from rps_exudyn.cli.main import app

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CHECKS = (
    "ruff check",
    "ruff format",
    "mypy ",
    "lint-imports --no-logo",
    "mkdocs build",
    "python -m",
)
TOOLS = ("pip", "python", "ruff", "mypy", "lint-imports", "mkdocs", "rps-exudyn")


def command_line(name: str) -> str:
    """The one line of the block marked with this name."""
    return re.findall(rf"<!-- {name} command -->\n```sh\n(.+)\n```\n", README)[0]


def printed_in_text(program: str) -> str:
    """The one command of a program that stands within a sentence, without what installs it."""
    (command,) = re.findall(rf"`pip install [^`]+ && ({program} [^`]+)`", README)
    return str(command)


@pytest.mark.parametrize("name", ["run", "test"])
def test_command_needs_only_python_and_pip(name: str) -> None:
    assert command_line(name).startswith("python3 -m venv .venv && .venv/bin/pip install -q -e ")


# --- .ci/run ---------------------------------------------------------------------------------------
@pytest.fixture
def bare(tmp_path: Path) -> Path:
    """A folder with `.ci/run` and the README, where every tool is a stand-in that prints its arguments.

    `python3 -m venv` makes those of the environment; one named in the file `broken` fails with status 3.
    """
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci")
    shutil.copy(ROOT / "README.md", tmp_path)
    (tmp_path / "broken").touch()
    stand_in = '#!/bin/sh\necho "${0##*/} $*"\nif grep -qx "${0##*/} $1" broken; then exit 3; fi\n'
    copies = f"mkdir -p $3/bin; for tool in {' '.join(TOOLS)}; do cp stand-in $3/bin/$tool; done"
    fill = f'if [ "$2" = venv ]; then {copies}; fi\n'
    for name, script in {"stand-in": stand_in, "python3": stand_in + fill, "chromium": stand_in}.items():
        (tmp_path / name).write_text(script)
        (tmp_path / name).chmod(0o755)
    return tmp_path


def ci_run(folder: Path) -> "subprocess.CompletedProcess[str]":
    path = f"{folder}:/usr/bin:/bin"
    return subprocess.run([folder / ".ci" / "run"], env={"PATH": path}, capture_output=True, text=True)


def test_ci_checks_everything_and_runs_the_printed_command_and_the_long_tests(bare: Path) -> None:
    done = ci_run(bare)
    assert done.returncode == 0, done.stderr
    ran = [line for line in done.stdout.splitlines() if not line.startswith("+")]
    assert ran == [
        "python3 -m venv .venv",
        "pip install -q -e .[dev]",
        "ruff check .",
        "ruff format --check .",
        "python3 .ci/versions lowest",
        "mypy ",
        "lint-imports --no-logo",
        printed_in_text("mkdocs"),
        "python3 .ci/versions newest",
        "python3 -m venv .venv",
        "pip install -q -e .[test]",
        "python -m pytest -q",
        "python -m pytest -q -m long",
    ]
    assert f"+ {command_line('test')}" in done.stdout.splitlines()


@pytest.mark.parametrize("broken", CHECKS)
def test_ci_fails_with_each_of_its_checks(bare: Path, broken: str) -> None:
    (bare / "broken").write_text(broken)
    done = ci_run(bare)
    assert done.returncode == 3
    assert done.stdout.splitlines()[-1].startswith(broken)


def test_ci_types_the_benchmarks_too(bare: Path) -> None:
    (bare / "benchmarks").mkdir()
    assert "mypy benchmarks" in ci_run(bare).stdout.splitlines()


# --- .ci/versions ----------------------------------------------------------------------------------
@pytest.mark.parametrize(("status", "outcome"), [(0, "passed"), (1, "FAILED with status 1")])
def test_other_pythons_are_tried_and_missing_ones_named(tmp_path: Path, status: int, outcome: str) -> None:
    """Also one of which there is only a command that says that it is missing."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = re.findall(r"Python :: (3\.\d+)\n", "\n".join(settings["project"]["classifiers"]) + "\n")
    there, missing, *absent = [each for each in listed if each != f"3.{sys.version_info.minor}"]
    ends = {there: f'if [ "$2" = tested ]; then exit {status}; fi', missing: "exit 127"}
    for version, end in ends.items():
        (stand_in := tmp_path / f"python{version}").write_text(f"#!/bin/sh\n{end}\n")
        stand_in.chmod(0o755)
    done = subprocess.run(
        [sys.executable, ROOT / ".ci" / "versions", "others"],
        env={"PATH": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == status
    lines = [f"python{version}: NOT TRIED: this machine does not have it" for version in (missing, *absent)]
    assert done.stdout.splitlines()[1:] == [f"python{there}: {outcome}", *lines]


# --- what the README says --------------------------------------------------------------------------
def test_page_lists_every_command() -> None:
    page = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\| `rps-exudyn ([\w-]+)", page, re.M)
    assert sorted(listed) == sorted(name for name in app if not name.startswith("-"))


@pytest.mark.parametrize(
    ("model", "row", "stated"),
    [
        ("quasi-static", "quasi-static, line | step_angle 1 °", 0),
        ("flank", "flank, line | step_angle 1 °", 0),  # "the same error"
        ("full", "general contact | spheres 27", 1),
    ],
)
def test_costs_and_errors_are_those_of_the_table(model: str, row: str, stated: int) -> None:
    """Of a revolution: times to a third, as machines differ, and errors to the digit that is stated."""
    about = README[README.index("## Speed against accuracy") : README.index("## From Python")]
    time, unit = re.findall(r"needs ([\d.]+) (ms|s)\b", about[about.index(f"`{model}`") :])[0]
    error = re.findall(r"([\d.]+) %", about)[stated]
    table = (ROOT / "results" / "accuracy_speed" / "README.md").read_text(encoding="utf-8")
    (cells,) = re.findall(rf"^\| {re.escape(row)}[^|]*\| ([\d.]+) \| ([\d.]+) \|", table, re.M)
    assert float(time) * {"ms": 1e-3, "s": 1.0}[unit] == pytest.approx(float(cells[0]), rel=1 / 3)
    assert float(error) == round(float(cells[1]), len(error.partition(".")[2]))


def test_readme_fits_three_screens() -> None:
    """Of 50 lines each, tables and pictures included."""
    assert len(README.splitlines()) <= 150
    assert "Developing a virtual prototype of a rack and pinion steering system" in README
    pictures = re.findall(r"!\[.+\]\((.+)\)", README)
    assert len(pictures) == 2
    assert all((ROOT / picture).exists() for picture in pictures)
