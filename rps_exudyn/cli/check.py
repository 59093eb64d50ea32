"""The command `check`: the requirement sheet of a gear."""

from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import (
    HEAD_ALONE,
    PAPER_GEAR,
    GearOptions,
    Inputs,
    Jobs,
    Printing,
    rated_torque_of,
)
from rps_exudyn.cli.output import DONE, FAILED, command_line, present, printing


def check(
    *,
    gear: GearOptions = PAPER_GEAR,
    inputs: Inputs = None,
    limits: Path | None = None,
    only: bool = False,
    rated_torque: str = "30 N*m",
    out: Path | None = None,
    jobs: Jobs = None,
    shown: Printing = HEAD_ALONE,
) -> int:
    """Compare a gear with its requirements: torque, variation, efficiency, strength, lift, travel, gain.

    The exit status is 1 if a requirement is not kept.

    Args:
        limits: TOML file of limits that replace the default ones; a line of it is
            `free_torque = { least = "0.8 N*m", most = "1.8 N*m" }`. Default limits and their sources are in
            `rps_exudyn/results/limits.toml`. It may limit any metric of a free pinion
            torque, a load test or a rack lift: `torque_peak_to_peak = { most = "0.3 N*m" }`.
        only: Judge the rows of `--limits` alone, and state by how much they are missed.
        rated_torque: Pinion torque for the strength of the teeth and the lift of the rack.
        out: Sheet as a page (.html), or as data (.json), from which `report` makes the page.
    """
    shown.check()
    from rps_exudyn.assessment.requirements.judging import judge
    from rps_exudyn.assessment.requirements.requirement_page import requirement_page
    from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
    from rps_exudyn.pages.report.sheet_file import write_sheet
    from rps_exudyn.results.requirements import read_limits, read_only
    from rps_exudyn.simulate.cases.run_cases import checked_jobs

    if only and limits is None:
        raise InputError("--only judges the rows of a file alone; add --limits FILE.")
    own, chosen = gear.drawn(), gear.load()
    asked = read_only(limits) if only and limits else read_limits(limits)
    if out is not None:
        check_writable(out, (".json", ".html"))
    torque = rated_torque_of(rated_torque)
    processes = checked_jobs(jobs)
    drawn = uncertain_inputs(chosen, inputs, own)
    with printing(shown.quiet):
        with shown_progress() as show:

            def report(text: str, fraction: float) -> None:
                show(f"computing: {text}", fraction)

            rows = list(judge(chosen, drawn, asked, torque, on_progress=report, jobs=processes))
            report("sheet", 1.0)
            sheet = requirement_page(rows, chosen, torque, command_line(), margins=only)
            if out is not None:
                write_sheet(sheet, out)
        present(sheet, [out] if out is not None else [], every=shown.every, json=shown.json)
    return DONE if all(each.verdict == "pass" for each in rows) else FAILED
