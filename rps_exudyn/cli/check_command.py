"""The command `check`: the requirement sheet of a gear."""

from collections.abc import Sequence
from math import isnan
from pathlib import Path

from rps_exudyn.base.atomic import check_writable, write_json
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import to_si
from rps_exudyn.cli.options import GearOptions, parse_settings
from rps_exudyn.cli.printed import print_json
from rps_exudyn.cli.progress import shown_progress
from rps_exudyn.cli.text_table import put, put_table
from rps_exudyn.parameters.carried import carried
from rps_exudyn.requirements.limits import REQUIRED, read_limits
from rps_exudyn.requirements.sheet import ASSURED, Judged, judge
from rps_exudyn.simulate.cases.run_cases import checked_jobs
from rps_exudyn.uncertainty.input_sets import uncertain_inputs

COLUMNS = ("requirement", "limit", "nominal", "5 to 95 %", "gears that keep it", "verdict")


def do_check(
    options: GearOptions,
    inputs: str | None,
    limits: Path | None,
    rated: str,
    out: Path | None,
    as_json: bool,
    jobs: int | None = None,
) -> bool:
    """Print the sheet; return whether every requirement is kept.

    Raises:
        InputError: limits, a rated torque or distributions that cannot be, or a gear that cannot be run.
    """
    settings, _ = parse_settings(options.settings)
    own = carried(options.tables(), settings)
    gear, asked = options.load(), read_limits(limits)
    if out is not None:
        check_writable(out, (".json",))
    try:
        torque = to_si(rated, "N*m")
    except ValueError as error:
        raise InputError(f"--rated-torque {error}.") from None
    processes = checked_jobs(jobs)
    drawn = uncertain_inputs(gear, inputs, own)
    with shown_progress() as show:

        def report(text: str) -> None:
            show(f"computing: {text}", None)

        sheet = list(judge(gear, drawn, asked, torque, on_progress=report, jobs=processes))
    if out is not None:
        write_json(out, _as_dict(sheet))
    if as_json:
        print_json(_as_dict(sheet))
    else:
        _print(sheet, torque, out)
    return all(each.kept for each in sheet)


def known(value: float) -> float | None:
    """A number for JSON, which knows no nan."""
    return None if isnan(value) else value


def _as_dict(sheet: Sequence[Judged]) -> dict[str, object]:
    rows = {
        each.name: {
            "verdict": each.verdict,
            "nominal": known(each.nominal),
            "band": [known(each.low), known(each.high)],
            "unit": REQUIRED[each.name].unit,
            "limit": each.limit.show(REQUIRED[each.name]),
            "share": each.share,
            "source": each.limit.source,
            "remark": each.remark,
        }
        for each in sheet
    }
    return {"all_kept": all(each.kept for each in sheet), "requirements": rows}


def _print(sheet: Sequence[Judged], torque: float, out: Path | None) -> None:
    rows = []
    for each in sheet:
        show, evaluated = REQUIRED[each.name].show, not isnan(each.nominal)
        band = f"{show(each.low)} to {show(each.high)}" if evaluated and each.low != each.high else ""
        share = f"{each.share:.0%}" if band else ""
        nominal = show(each.nominal) if evaluated else ""
        rows.append((each.name, each.limit.show(REQUIRED[each.name]), nominal, band, share, each.verdict))
    put_table(COLUMNS, rows)
    for each in sheet:
        remark = f" {each.remark}." if each.remark else ""
        text = f"{each.name}: {REQUIRED[each.name].long_name}. From: {each.limit.source}.{remark}"
        put(text)
    put(f"Rated torque {torque:g} N m. A requirement passes if {ASSURED:.0%} of the gears keep it.")
    if out is not None:
        put(f"written: {out}")
