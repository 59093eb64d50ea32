"""The sheet of a run: as the README prints it, its header, its units."""

import re
from dataclasses import replace
from pathlib import Path

import rps_exudyn as rps
from rps_exudyn.pages.report.result_sheet import changes_shown, sheet_of
from rps_exudyn.results.result import Result
from shell import Command

README = Path(__file__).parents[2] / "README.md"


def test_run_prints_the_sheet_of_the_readme(command: Command) -> None:
    (printed,) = re.findall(r"```text\n(Free pinion torque:.*?)```", README.read_text(encoding="utf-8"), re.S)
    assert command(["run"]).out == printed


def test_header_counts_parameters_that_follow_apart() -> None:
    settings = {"pinion.teeth": 7, "pinion.normal_module": "1.9 mm", "yoke.preload": "500 N"}
    gear = rps.SteeringGear.from_tables({}, settings)
    assert changes_shown(gear) == "3 parameters changed, 3 derived"
    assert changes_shown(rps.SteeringGear()) == "default"


def test_header_of_a_band_counts_medians_apart_and_its_law_is_stated(command: Command) -> None:
    """The medians of the runout and of its angle differ from the default gear, which nobody changed."""
    answer = command(["run", "--band", "8", "--fidelity", "quasi-static", "--no-plot"])
    assert "; default; 14 inputs at their medians; quasi-static; law teeth" in answer.out
    assert (
        "the band uses the contact law teeth, as every series of gears; a single run uses line." in answer.err
    )


def test_numbers_of_one_quantity_have_one_unit(made_up_result: Result) -> None:
    summary = {"torque_mean": 0.62, "torque_peak_to_peak": 2.7e-3}
    values = [row.value for row in sheet_of(replace(made_up_result, summary=summary)).rows[:2]]
    assert values[0].endswith(" N m")
    assert values[1] == "0.003 ± 0.001 N m"


def test_wide_and_unknown_bars_are_vague(made_up_result: Result) -> None:
    """Wider than a fifth of the value."""
    errors = {"torque_mean": 0.119, "torque_peak_to_peak": 0.0041, "rack_gain": float("nan")}
    rows = sheet_of(replace(made_up_result, errors=errors)).rows[:3]
    assert [row.is_vague for row in rows] == [False, True, True]
