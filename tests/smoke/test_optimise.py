"""The command `optimise` at the smallest size: sheet, JSON, a page whose front leads to gears, gear files."""

import json
import re
from pathlib import Path

import pytest

import rps_exudyn as rps
from rps_exudyn.optimisation.definition import read_problem
from shell import Command
from study_files import TOLERANCES, TWO


def test_front_on_sheet_page_and_in_json(command: Command) -> None:
    pytest.importorskip("pymoo")
    Path("two.toml").write_text(TWO)
    first = command(["optimise", "two.toml", "--jobs", "1"])
    assert first.status == 0
    assert "24 of 24" in first.out
    found = json.loads(command(["optimise", "two.toml", "--jobs", "1", "--json"]).out)
    torques = [design["numbers"][0] for design in found["front"]]
    gains = [design["numbers"][1] for design in found["front"]]
    assert torques == sorted(torques)
    assert gains == sorted(gains)
    page = Path("two/optimisation.html").read_text()
    links = re.findall(r'xlink:href="#(part-\d-1|[0-9a-f]{16})"', page)
    assert len(links) == len(found["front"])
    assert all(f'id="{link}"' in page for link in links)
    gear = rps.SteeringGear.from_toml("two/gear-1.toml")
    assert gear.yoke.preload == found["front"][0]["variables"]["yoke.preload"]
    assert "yoke.preload" in found["at_bounds"] or gear.yoke.preload > 202
    assert command(["report", "two", "--out", "sheet.html"]).status == 0
    assert "Fresh gears and other models" in Path("sheet.html").read_text()


def test_no_design_keeps_the_limits(command: Command) -> None:
    """The sheet states which limit the nearest one misses, and the page has no front."""
    pytest.importorskip("pymoo")
    Path("none.toml").write_text(TWO.replace("24", "12") + '[constraints.torque_mean]\nmost = "0.1 N*m"\n')
    answer = command(["optimise", "none.toml", "--jobs", "1"])
    assert answer.status == 1
    assert "none" in answer.out
    assert "the nearest has torque_mean (nominal)" in answer.out
    assert Path("none/optimisation.html").exists()


def test_tolerances_in_a_report_also_unfinished(command: Command) -> None:
    """The sheet of the folder; of an interrupted choice, which has gears and no designs, what was asked."""
    Path("costs.toml").write_text(TOLERANCES)
    found = json.loads(command(["optimise", "costs.toml", "--jobs", "1", "--json"]).out)
    assert [each["name"] for each in found["limits"]] == ["torque_mean"]
    assert command(["report", "costs"]).status == 0
    assert "The chosen classes" in Path("costs/report.html").read_text()
    Path("costs/optimisation.json").unlink()
    assert command(["report", "costs"]).status == 0
    assert "What was varied" in Path("costs/report.html").read_text()


def test_shipped_file_is_read() -> None:
    problem = read_problem(Path(__file__).parents[2] / "studies" / "optimise_ripple.toml")
    assert len(problem.study.axes) == 7
    assert problem.numbers[0].quantile == 0.9
