"""The command `check`: the requirement sheet of a gear."""

from collections.abc import Sequence
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable, write_json
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.base.units import to_si
from rps_exudyn.cli.options import PAPER_GEAR, All, Flag, GearOptions, Inputs, Jobs, Json
from rps_exudyn.cli.output import (
    DONE,
    FAILED,
    QUIET_ALONE,
    command_line,
    print_files,
    print_json,
    printing,
    put,
    put_table,
)

if TYPE_CHECKING:
    from rps_exudyn.assessment.requirements.sheet import RequirementRow
    from rps_exudyn.pages.report.html import Article
    from rps_exudyn.parameters.gear import SteeringGear

COLUMNS = ("requirement", "limit", "nominal", "5 to 95 %", "gears that keep it", "verdict")


def check(
    *,
    gear: GearOptions = PAPER_GEAR,
    inputs: Inputs = None,
    limits: Path | None = None,
    rated_torque: str = "30 N*m",
    out: Path | None = None,
    jobs: Jobs = None,
    every: All = False,
    quiet: Flag = False,
    json: Json = False,
) -> int:
    """Compare a gear with its requirements: torque, variation, efficiency, strength, lift, travel, gain.

    The exit status is 1 if a requirement is not kept.

    Args:
        limits: TOML file of limits that replace the default ones; a line of it is
            `free_torque = { least = "0.8 N*m", most = "1.8 N*m" }`. Default limits and their sources are in
            `rps_exudyn/assessment/requirements/limits.toml`.
        rated_torque: Pinion torque for the strength of the teeth and the lift of the rack.
        out: Sheet as a page (.html), or as data (.json), from which `report` makes the page.
        quiet: Print only errors.
    """
    if quiet and (every or json):
        raise InputError(QUIET_ALONE)
    from rps_exudyn.assessment.requirements.limits import read_limits
    from rps_exudyn.assessment.requirements.requirement_page import requirement_article
    from rps_exudyn.assessment.requirements.sheet import judge, law_of_sheet
    from rps_exudyn.cli.printed import print_sheet
    from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
    from rps_exudyn.simulate.cases.run_cases import checked_jobs

    own, chosen, asked = gear.drawn(), gear.load(), read_limits(limits)
    if out is not None:
        check_writable(out, (".json", ".html"))
    try:
        torque = to_si(rated_torque, "N*m")
    except ValueError as error:
        raise InputError(f"--rated-torque {error}.") from None
    processes = checked_jobs(jobs)
    drawn, law = uncertain_inputs(chosen, inputs, own), law_of_sheet(chosen)
    with printing(quiet):
        with shown_progress() as show:

            def report(text: str, fraction: float) -> None:
                show(f"computing: {text}", fraction)

            sheet = list(judge(chosen, drawn, asked, torque, on_progress=report, jobs=processes))
            report("sheet", 1.0)
            article = requirement_article(sheet, chosen, torque, command_line())
            if out is not None:
                _write(out, article, chosen, _as_dict(sheet, law))
        files = [out] if out is not None else []
        if json:
            print_json(_as_dict(sheet, law))
        elif every:
            _print(sheet, torque, law, files)
        else:
            print_sheet(article.sheet, files, "limits, bands and sources")
    return DONE if all(each.verdict == "pass" for each in sheet) else FAILED


def _write(out: Path, article: "Article", gear: "SteeringGear", data: dict[str, object]) -> None:
    """Write the sheet as a page, or as data from which a page can be made."""
    from rps_exudyn.pages.report.sheet_file import KEY, sheet_as_dict, with_gear
    from rps_exudyn.pages.report.write_report import write_pages

    if out.suffix == ".html":
        write_pages([with_gear(article, gear)], out)
    else:
        write_json(out, data | {KEY: sheet_as_dict(article, gear)})


def _known(value: float) -> float | None:
    """The number, for JSON, which has no nan."""
    return None if isnan(value) else value


def _as_dict(sheet: "Sequence[RequirementRow]", law: str) -> dict[str, object]:
    from rps_exudyn.assessment.requirements.limits import REQUIRED

    rows = {
        each.name: {
            "verdict": each.verdict,
            "nominal": _known(each.value),
            "error": _known(each.error) if each.is_known else None,
            "band": [_known(each.low), _known(each.high)],
            "unit": REQUIRED[each.name].unit,
            "limit": each.limit.show(REQUIRED[each.name]),
            "share": each.share,
            "source": each.limit.source,
            "remark": each.remark,
        }
        for each in sheet
    }
    kept = all(each.verdict == "pass" for each in sheet)
    return {"all_kept": kept, "contact_law": law, "requirements": rows}


def _print(sheet: "Sequence[RequirementRow]", torque: float, law: str, files: Sequence[Path]) -> None:
    from rps_exudyn.assessment.requirements.limits import REQUIRED
    from rps_exudyn.assessment.requirements.sheet import ASSURED
    from rps_exudyn.results.rounding import shown_with_bar

    rows = []
    for each in sheet:
        show = REQUIRED[each.name].show
        nominal = shown_with_bar(REQUIRED[each.name], each.value, each.error) if each.is_known else ""
        band = each.band_shown(show)
        share = f"{each.share:.0%}" if band else ""
        rows.append((each.name, each.limit.show(REQUIRED[each.name]), nominal, band, share, each.verdict))
    put_table(COLUMNS, rows)
    for each in sheet:
        remark = f" {each.remark}." if each.remark else ""
        text = f"{each.name}: {REQUIRED[each.name].long_name}. From: {each.limit.source}.{remark}"
        put(text)
    put(f"Rated torque {torque:g} N m. Contact law {law}.")
    put(f"A requirement passes if {ASSURED:.0%} of the gears keep it.")
    print_files(files)
