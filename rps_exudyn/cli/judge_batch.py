"""The command `judge-batch`: what the free torques of a production batch show."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES, check_writable, replacing
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import PAPER_GEAR, GearOptions, Jobs, Json
from rps_exudyn.cli.output import DONE, present
from rps_exudyn.results.sheet import Block, Grid, Line, Sheet, Text

if TYPE_CHECKING:
    from rps_exudyn.inference.fitting.production import ProductionLot, Risks
    from rps_exudyn.results.limit import Limit

COLUMNS = (
    "gear", "level [N m]", "low [N m]", "high [N m]", "expected [N m]", "moving average [N m]", "P e [N mm]",
    "P e found", "verdict", "drift",
)  # fmt: skip
_TOLERANCE = re.compile(r"(?:(?P<low>.+?)\s+)?to(?:\s+(?P<high>.+))?")


def judge_batch(
    folder: Path,
    /,
    *,
    tolerance: str | None = None,
    gear: GearOptions = PAPER_GEAR,
    out: Path | None = None,
    plot: Path | None = None,
    jobs: Jobs = None,
    json: Json = False,
) -> int:
    """Judge a production batch: scatter between gears, risks of the tolerance, drift.

    Args:
        folder: Folder with one measured file of the free torque per gear.
        tolerance: Tolerance of the free torque, such as "0.5 N*m to 0.8 N*m", for limits with guard bands and
            risks.
        out: Table of the gears (.csv).
        plot: Picture (.png, .svg, .pdf) of the drift.
    """
    from rps_exudyn.inference.fitting.production import GUARD, accepted_within, judge_lot
    from rps_exudyn.simulate.cases.run_cases import checked_jobs

    limits = parse_tolerance(tolerance) if tolerance is not None else None
    for path, suffixes in ((out, (".csv",)), (plot, PICTURES)):
        if path is not None:
            check_writable(path, suffixes)
    with shown_progress(asked=False):
        found = judge_lot(folder, gear.load(), jobs=checked_jobs(jobs))
    guard = GUARD * found.sd
    risks = [] if limits is None else [found.risks(limits, each) for each in (0.0, guard)]
    accepted = limits and accepted_within(limits, guard)
    rows = list(_rows(found, accepted))
    if out is not None:
        with replacing(out) as partial:
            partial.write_text("".join(",".join(row) + "\n" for row in (COLUMNS, *rows)), "utf-8")
    if plot is not None:
        from rps_exudyn.pages.charts.inference import drift_figure
        from rps_exudyn.pages.charts.style import save

        save(drift_figure(found, accepted), plot)

    def data() -> dict[str, Any]:
        return {
            "gears": [dict(zip(COLUMNS, row, strict=True)) for row in rows],
            "mean": found.mean,
            "mean_sd": found.mean_sd,
            "scatter": dict(zip(("median", "low", "high"), found.scatter, strict=True)),
            "parameters": found.parameters,
            "scatter_alone": found.alone,
            "drift_alarms": [found.gears[i].name for i in found.drift.alarms],
            "risks": [vars(each) | {"limits": [each.limits.least, each.limits.most]} for each in risks],
            "refused": list(found.refused),
        }

    rejected = None if limits is None else [row[0] for row in rows if row[-2] == "rejected"]
    sheet = Sheet(text=_text(found, risks, rejected), data=data)
    present(sheet, [path for path in (out, plot) if path is not None], json=json)
    return DONE


def _text(found: "ProductionLot", risks: "Sequence[Risks]", rejected: list[str] | None) -> Iterator[Block]:
    from rps_exudyn.inference.fitting.findings import shown

    middle, low, high = (100 * each for each in found.scatter)
    yield Line(f"batch · {len(found.gears)} gears", is_bold=True)
    yield Text(f"mean free torque {found.mean:.4g} +- {1.96 * found.mean_sd:.2g} N m (95 %)")
    yield Text(
        f"scatter between gears {middle:.3g} % ({low:.3g} to {high:.3g} %, 95 %), without that of the "
        f"measurement, {100 * found.sd / found.mean:.3g} %"
    )
    cells = [
        (path, shown(path, value), f"{100 * sd:.3g} %", f"{100 * found.alone[path]:.3g} %")
        for path, (value, sd) in found.parameters.items()
        if path in found.alone
    ]
    heads = ("parameter", "mean of the batch", "deviation", "scatter, if no other parameter scatters")
    yield Grid(heads, cells)
    for name, each in zip(("without guard bands", "with guard bands"), risks, strict=False):
        yield Text(
            f"limits {name}, {each.limits.least:.4g} to {each.limits.most:.4g} N m: consumer's risk "
            f"{100 * each.consumer:.2g} %, producer's risk {100 * each.producer:.2g} %"
        )
    if rejected is not None:
        yield Text(f"{len(rejected)} rejected" + (f": {', '.join(rejected[:10])}" if rejected else ""))
    alarms = found.drift.alarms
    drifts = f"from {found.gears[alarms[0]].name} on" if alarms.size else "none (false in 1 % of batches)"
    yield Text(f"drift of the moving average: {drifts}")
    yield from (Text(f"note: left out: {sentence}") for sentence in found.refused)


def parse_tolerance(text: str) -> "Limit":
    """Return limits [N m] of "LOW to HIGH"; either may be left out.

    Raises:
        InputError: it is no tolerance.
    """
    from rps_exudyn.results.limit import Limit

    found = _TOLERANCE.fullmatch(text.strip())
    inf = float("inf")
    try:
        low, high = (
            units.to_si(found[end], "N*m") if found and found[end] else None for end in ("low", "high")
        )
    except ValueError:
        low = high = None
    limits = Limit(-inf if low is None else low, inf if high is None else high, "the tolerance")
    if (low is None and high is None) or not limits.least < limits.most:
        raise InputError(
            f'--tolerance {text} is no tolerance; write for instance --tolerance "0.5 N*m to 0.8 N*m", or '
            '"to 0.8 N*m".'
        )
    return limits


def _rows(found: "ProductionLot", accepted: "Limit | None") -> Iterator[tuple[str, ...]]:
    """The row of each gear, by `COLUMNS`; the verdict is that of limits of acceptance."""
    alarms = set(found.drift.alarms.tolist())
    for i, each in enumerate(found.gears):
        runout, verdict = each.runout, ""
        if accepted is not None:
            verdict = "accepted" if accepted.keeps(each.level) else "rejected"
        numbers = (each.level, *each.interval, found.expected[i], found.drift.average[i])
        yield (
            each.name,
            *(f"{number:.6g}" for number in numbers),
            "" if runout is None else f"{1e3 * runout.stored:.4g}",
            "" if runout is None else "yes" if runout.is_found else "no",
            verdict,
            "beyond" if i in alarms else "",
        )
