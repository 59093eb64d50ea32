"""The command `fit`: a gear estimated from measured curves."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES, check_writable, number_existing, replacing
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import (
    HEAD_ALONE,
    PAPER_GEAR,
    Columns,
    Flag,
    Freed,
    GearOptions,
    Jobs,
    Printing,
    Priors,
    chosen_columns,
)
from rps_exudyn.cli.output import DONE, FAILED, command_line, named_if_interrupted, present, printing, say

if TYPE_CHECKING:
    from rps_exudyn.inference.fitting.fitted import Fit

PAGES = (".html", ".htm", ".json")
_PRIOR = re.compile(r"(?P<value>.+?)\s*(?:\+-|\+/-|±)\s*(?P<sd>.+)")


def fit(
    *files: str,
    gear: GearOptions = PAPER_GEAR,
    prior: Priors = (),
    free: Freed = (),
    column: Columns = (),
    single_law: Flag = False,
    out: Path = Path("fitted.toml"),
    plot: Path | None = None,
    report: Path | None = None,
    series: Path | None = None,
    like: Path | None = None,
    limits: Path | None = None,
    jobs: Jobs = None,
    time_limit: str | None = None,
    shown: Printing = HEAD_ALONE,
) -> int:
    """Estimate preload, friction, drag and runout from measured curves, and name what they cannot separate.

    Args:
        files: Measured files: FILE of the free torque, or TEST=FILE with TEST free, reversal,
            load-test@80kg, rack-push, rack-on-rollers, yoke-out or bearing. Several files of one test are
            repeats.
        single_law: Leave out the second fit by another contact law, whose difference widens the intervals.
        out: Gear file (.toml) with the estimates.
        plot: Picture (.png, .svg, .pdf) of measured and fitted torque.
        report: Sheet as a page (.html) with pictures, intervals, correlations and assumptions, or as data
            (.json), from which `report` makes the page.
        series: File (.json) for the next gear of the series, to be given by --like.
        like: File that --series wrote for another gear with the same tests; the fit starts from it.
        limits: TOML file of limits, as of `check`, for the adjustment of the yoke: free_torque, rated_lift.
        time_limit: Elapsed time of each simulation, for instance "20 s"; one that takes longer is left out.
    """
    shown.check()
    from rps_exudyn.inference.fitting.fit import fit as fitted
    from rps_exudyn.inference.fitting.series import read_series
    from rps_exudyn.inference.fitting.unknowns import USUAL
    from rps_exudyn.simulate.cases.run_cases import checked_jobs
    from rps_exudyn.simulate.cases.time_limit import TimeLimit

    if not files:
        raise InputError("fit needs at least one measured file, for instance rps-exudyn fit measured.csv.")
    for path, suffixes in ((out, (".toml",)), (plot, PICTURES), (report, PAGES), (series, (".json",))):
        if path:
            check_writable(path, suffixes)
    with printing(shown.quiet), shown_progress() as show:
        show("fitting", None)
        found = fitted(
            files,
            gear.load(),
            free=free or USUAL,
            priors=parse_priors(prior),
            columns=chosen_columns(column),
            other_law=not single_law,
            like=read_series(like) if like else None,
            limits=limits,
            jobs=checked_jobs(jobs),
            time_limit=TimeLimit.of(time_limit).seconds if time_limit is not None else float("inf"),
        )
    written: list[Path] = []
    with named_if_interrupted(written), printing(shown.quiet), shown_progress() as show:
        show("drawing", None)
        written.extend(_written_files(found, out, plot, report, series))  # keeps those before an interrupt
    with printing(shown.quiet):
        from rps_exudyn.pages.report.fit_page import fit_sheet

        present(fit_sheet(found), written, every=shown.every, json=shown.json)
    return DONE if found.converged else FAILED


def parse_priors(texts: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Path -> expected value and standard deviation, of texts PATH="VALUE +- DEVIATION".

    Raises:
        InputError: everything that is wrong with them.
    """
    from rps_exudyn.inference.fitting.unknowns import FREEABLE
    from rps_exudyn.parameters.gear import SteeringGear

    priors, problems = {}, []
    for text in texts:
        path, _, prior = text.partition("=")
        path, found = path.strip(), _PRIOR.fullmatch(prior.strip())
        if path not in FREEABLE:
            problems.append(f"--prior {text}: {path} cannot be fitted; there are {', '.join(FREEABLE)}.")
            continue
        if not found:
            example = 'yoke.preload="300 N +- 30 N"'
            problems.append(
                f"--prior {text} is no prior; write PATH=VALUE +- DEVIATION, for instance {example}."
            )
            continue
        unit = SteeringGear.declared_at(path)[0].unit
        si, deviation = unit.si if unit else "", found["sd"].strip()
        try:
            expected = units.to_si(found["value"], si)
            share = abs(expected) if deviation.endswith("%") else 1.0  # a deviation in % is one of the value
            sd = share * units.to_si(deviation, "" if deviation.endswith("%") else si)
            if not 0 < sd < float("inf"):
                raise ValueError(f"has the standard deviation {found['sd']}, which must be more than 0")
            priors[path] = expected, sd
            SteeringGear().replace({path: priors[path][0]})
        except InputError as error:
            problems += [f"--prior {text}: {problem}" for problem in error.problems]
        except ValueError as error:
            problems.append(f"--prior {text}: it {error}.")
    if problems:
        raise InputError(problems)
    return priors


def _written_files(
    fit: "Fit", out: Path, plot: Path | None, report: Path | None, series: Path | None
) -> Iterator[Path]:
    """Write the files one after the other, the gear first and the pictures last."""
    from rps_exudyn.inference.fitting.findings import gear_text, headline
    from rps_exudyn.parameters.gear import gear_file

    if older := number_existing(out):
        say(f"previous file renamed to {older}.")
    with replacing(out) as partial:
        partial.write_text(gear_text(fit, gear_file(fit.gear)), encoding="utf-8")
    yield out
    if series:
        from rps_exudyn.inference.fitting.series import write_series

        write_series(fit.series, series)
        yield series
    if plot:
        from rps_exudyn.pages.charts import style
        from rps_exudyn.pages.charts.inference import beliefs_figure, curves_figure

        figure = curves_figure(fit) or beliefs_figure(fit)
        if figure is not None:
            style.title(figure, headline(fit))
            style.save(figure, plot)
            yield plot
    if report:
        from rps_exudyn.pages.report.fit_page import fit_page
        from rps_exudyn.pages.report.sheet_file import write_sheet

        write_sheet(fit_page(fit, command_line()), report)
        yield report
