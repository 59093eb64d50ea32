"""The code in the pages runs, page by page and in the order in which it stands there.

Python blocks of a page share their names. Shell blocks run command by command in the process of the test;
studies are run at toy size, and what makes no sense here is named in `ELSEWHERE`.
"""

import ast
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from made_up_study import make_study
from rps_exudyn.cli import commands
from rps_exudyn.results.result import Result

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```(python|sh|toml)\n(.+?)^```", re.S | re.M)
ELSEWHERE = {
    "pip install": "installs: .ci/run does",
    "python3 -m venv": "the same",
    ".venv/bin/": "the same",
    "python benchmarks/make.py": "tests/benchmarks run every topic at toy size",
    "dask ": "two servers: tests/smoke/test_cluster.py starts some",
    "--cluster": "the same",
    "rps-exudyn check": "ends with 1 for the default gear: tests/physics/test_requirements.py",
    "--time-limit": "starts a process: tests/stability/test_time_limit.py does",
    "study studies/preload_friction_runout.toml": "with --dry-run in the line above; the README runs a study",
}
NOT_HERE = ("dask_jobqueue",)  # libraries of a cluster, whose blocks are only parsed
SMALL = {"study": ("--toy", "--yes", "--jobs", "1")}  # added where the page has a study of full size
FEW = "8"  # samples of a band
MEASURED = "pinion_angle [deg]; pinion_torque [N m]\n0; 0.61\n60; 0.62\n120; 0.61\n"


def blocks(page: Path) -> Iterator[tuple[str, str]]:
    """Language and text of every block of a page."""
    yield from BLOCK.findall(page.read_text(encoding="utf-8"))


def commands_of(text: str) -> Iterator[str]:
    """The single commands of a shell block, without comments."""
    for line in text.splitlines():
        yield from (part.strip() for part in line.split(" #")[0].split("&&") if part.strip())


@pytest.mark.parametrize("page", [pytest.param(page, id=page.name) for page in PAGES if any(blocks(page))])
def test_code_runs(
    page: Path, made_up_result: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "studies", tmp_path / "studies")
    if page.name != "README.md":
        make_study(tmp_path / "preload", made_up_result)  # stands for a study that was run before
    names: dict[str, object] = {}
    exec("import rps_exudyn as rps\ngear = rps.SteeringGear()", names)
    for number, (language, text) in enumerate(blocks(page), 1):
        if language == "toml":
            (tmp_path / "studies" / f"page{number}.toml").write_text(text, encoding="utf-8")
            run_command(f"rps-exudyn study studies/page{number}.toml --dry-run")
        elif language == "python" and any(library in text for library in NOT_HERE):
            ast.parse(text)
        elif language == "python":
            exec(compile(text, f"{page.name}, block {number}", "exec"), names)
        else:
            for line in commands_of(text):
                run_line(line, monkeypatch)


def run_line(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a line of a shell block."""
    if any(part in line for part in ELSEWHERE) and "--dry-run" not in line:
        return
    if line.startswith("cd "):
        monkeypatch.chdir(line.removeprefix("cd "))
        return
    if line.startswith("python "):
        monkeypatch.setattr(sys, "argv", shlex.split(line)[1:])
        exec(Path(sys.argv[0]).read_text(encoding="utf-8"), {"__name__": "__main__"})
        return
    run_command(line)


def run_command(line: str) -> None:
    """Run `rps-exudyn` in this process; it must end well."""
    program, name, *arguments = shlex.split(line)
    assert program == "rps-exudyn", f"unknown command in a page: {line}"
    if name == "study" and "--dry-run" not in arguments:
        arguments += [each for each in SMALL[name] if each not in arguments]
    if "--band" in arguments:
        arguments = [FEW if each.isdigit() else each for each in arguments]
    if "--measured" in arguments:
        Path("measured.csv").write_text(MEASURED, encoding="utf-8")
    assert commands.main([name, *arguments]) == 0, line


def test_pages_have_code() -> None:
    """What is looked for is found: the number of blocks can only grow."""
    found = [language for page in PAGES for language, _ in blocks(page)]
    assert found.count("python") >= 15
    assert found.count("sh") >= 8
