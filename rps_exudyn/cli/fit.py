"""The command `fit`: a gear estimated from measured curves."""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import PICTURES, check_writable, number_existing, replacing
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import PAPER_GEAR, All, Columns, Flag, GearOptions, Jobs, Json, chosen_columns
from rps_exudyn.cli.output import (
    DONE,
    FAILED,
    QUIET_ALONE,
    command_line,
    named_if_interrupted,
    print_files,
    print_json,
    printing,
    put,
    put_table,
    say,
)

if TYPE_CHECKING:
    from rps_exudyn.inference.fitting.fitted import Fit
    from rps_exudyn.inference.fitting.production import Limits, ProductionLot

PAGES = (".html", ".htm", ".json")
_PRIOR = re.compile(r"(?P<value>.+?)\s*(?:\+-|\+/-|±)\s*(?P<sd>.+)")

Priors = Annotated[
    tuple[str, ...],
    Parameter(
        name="--prior",
        negative=(),
        show_default=False,
        help='PATH="VALUE +- DEVIATION": what is expected of a parameter and its standard deviation, for '
        'instance --prior yoke.preload="300 N +- 10 %"; may be repeated.',
    ),
]

Freed = Annotated[
    tuple[str, ...],
    Parameter(
        name="--free",
        negative=(),
        show_default=False,
        help="PATH of a parameter that is fitted, instead of the usual ones, such as --free bush.drag; "
        "bow and angle error beside them; may be repeated.",
    ),
]


def fit(
    *files: str,
    gear: GearOptions = PAPER_GEAR,
    prior: Priors = (),
    free: Freed = (),
    column: Columns = (),
    single_law: Flag = False,
    out: Path | None = None,
    plot: Path | None = None,
    report: Path | None = None,
    series: Path | None = None,
    like: Path | None = None,
    plan: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    minutes: Path | None = None,
    batch: Path | None = None,
    tolerance: str | None = None,
    jobs: Jobs = None,
    time_limit: str | None = None,
    every: All = False,
    quiet: Flag = False,
    json: Json = False,
) -> int:
    """Estimate preload, friction, drag and runout from measured curves, and name what they cannot separate.

    Args:
        files: Measured files: FILE of the free torque, or TEST=FILE with TEST free, reversal,
            load-test@80kg, rack-push, rack-on-rollers, yoke-out or bearing. Several files of one test are
            repeats.
        single_law: Leave out the second fit by another contact law, whose difference widens the intervals.
        out: Gear file (.toml) with the estimates, default: fitted.toml. With --batch: the table of the gears
            (.csv).
        plot: Picture (.png, .svg, .pdf) of measured and fitted torque. With --batch: of the drift.
        report: Sheet as a page (.html) with pictures, intervals, correlations and assumptions, or as data
            (.json), from which `report` makes the page.
        series: File (.json) for the next gear of the series, to be given by --like.
        like: File that --series wrote for another gear with the same tests; the fit starts from it.
        plan: Plan tests instead of fitting: the tests that reach the wanted intervals in the least time.
            PATH=HALF, half the 95 % interval over the value, such as yoke.preload=15% mesh.friction=25%.
        minutes: TOML file of the bench's times for --plan: [free], setup = 5, run = 5, in minutes.
        batch: Judge a production batch instead of fitting: folder with one file of the free torque per gear.
        tolerance: Tolerance of the free torque for --batch, such as "0.5 N*m to 0.8 N*m", for limits with
            guard bands and risks.
        time_limit: Elapsed time of each simulation, for instance "20 s"; one that takes longer is left out.
        quiet: Print only errors.
    """
    if quiet and (every or json):
        raise InputError(QUIET_ALONE)
    from rps_exudyn.inference.fitting import findings
    from rps_exudyn.inference.fitting.fit import fit as fitted
    from rps_exudyn.inference.fitting.series import read_series
    from rps_exudyn.inference.fitting.unknowns import USUAL
    from rps_exudyn.simulate.cases.run_cases import checked_jobs
    from rps_exudyn.simulate.cases.time_limit import TimeLimit

    of_fit = {"--prior": prior, "--free": free, "--column": column, "--single-law": single_law}
    of_fit |= {"--report": report, "--series": series, "--like": like, "--time-limit": time_limit}
    of_fit |= {"--all": every, "--quiet": quiet}
    if plan is not None:
        if files:
            raise InputError("--plan plans tests before anything is measured; leave out the measured files.")
        of_fit |= {"--out": out, "--plot": plot, "--jobs": jobs, "--batch": batch, "--tolerance": tolerance}
        _refuse_beside("--plan prints a plan alone", of_fit)
        return print_plan(plan, gear, minutes, json)
    if minutes is not None:
        raise InputError("--minutes gives the times of a plan; add --plan.")
    if batch is not None:
        if files:
            raise InputError("--batch reads all files of its folder; leave out the measured files.")
        _refuse_beside("--batch fits no gear", of_fit)
        return judge_batch(batch, tolerance, gear, (out, plot), checked_jobs(jobs), json)
    if tolerance is not None:
        raise InputError("--tolerance applies to a production batch; add --batch FOLDER.")
    if not files:
        raise InputError("fit needs at least one measured file, for instance rps-exudyn fit measured.csv.")
    out = out or Path("fitted.toml")
    check_writable(out, (".toml",))
    for path, suffixes in ((plot, PICTURES), (report, PAGES), (series, (".json",))):
        if path:
            check_writable(path, suffixes)
    with printing(quiet), shown_progress() as show:
        show("fitting", None)
        found = fitted(
            files,
            gear.load(),
            free=free or USUAL,
            priors=parse_priors(prior),
            columns=chosen_columns(column),
            other_law=not single_law,
            like=read_series(like) if like else None,
            jobs=checked_jobs(jobs),
            time_limit=TimeLimit.of(time_limit).seconds if time_limit is not None else float("inf"),
        )
    written: list[Path] = []
    with named_if_interrupted(written), printing(quiet), shown_progress() as show:
        show("drawing", None)
        written.extend(_written_files(found, out, plot, report, series))  # keeps those before an interrupt
    if json:
        print_json(findings.fit_as_dict(found) | {"files": [str(file) for file in written]})
    elif every:
        print_fit(found, written)
    elif not quiet:
        from rps_exudyn.cli.printed import print_sheet
        from rps_exudyn.pages.report.fit_page import fit_head

        print_sheet(fit_head(found).sheet, written, "intervals, verdicts, budget, notes")
    return DONE if found.converged else FAILED


def _refuse_beside(does: str, others: Mapping[str, object]) -> None:
    """Refuse options that say nothing beside one that makes no fit.

    Raises:
        InputError: some of them are given.
    """
    if given := [option for option, value in others.items() if value]:
        raise InputError(f"{does}; leave out {', '.join(given)}.")


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
        try:
            priors[path] = _prior(found["value"], found["sd"], unit.si if unit else "")
            SteeringGear().replace({path: priors[path][0]})
        except InputError as error:
            problems += [f"--prior {text}: {problem}" for problem in error.problems]
        except ValueError as error:
            problems.append(f"--prior {text}: it {error}.")
    if problems:
        raise InputError(problems)
    return priors


def _prior(value: str, deviation: str, si: str) -> tuple[float, float]:
    """Value and deviation; a deviation in % is one of the value."""
    expected = units.to_si(value, si)
    part = deviation.strip()
    sd = abs(expected) * units.to_si(part, "") if part.endswith("%") else units.to_si(part, si)
    if not 0 < sd < float("inf"):
        raise ValueError(f"has the standard deviation {deviation}, which must be more than 0")
    return expected, sd


def print_fit(fit: "Fit", files: Iterable[Path]) -> None:
    """Print level, what is not separable, the table of parameters, and warnings."""
    from rps_exudyn.inference.fitting import findings

    tests = ", ".join(dict.fromkeys(each.test for each in fit.passes))
    put(f"fit · tests: {tests} · {'converged' if fit.converged else 'NOT CONVERGED'}", "bold")
    for sentence in (findings.level_sentence(fit), *findings.open_sentences(fit)):
        if sentence:
            put(sentence)
    put_table(("parameter", "value", "95 % interval", "prior", "verdict"), findings.rows(fit))
    put_table(findings.BUDGET, findings.budget_rows(fit))
    if sentence := findings.offset_sentence(fit):
        put(sentence)
    for sentence in (each for each in fit.assumed if each not in fit.left_out):
        put(f"assumed: {sentence}")
    for sentence in (*fit.left_out, *fit.warnings):
        put(f"note: {sentence}")
    put(f"{fit.simulations} simulations, {fit.cpu_s:.2g} s of CPU time")
    print_files(files)


def print_plan(targets: list[str], gear: GearOptions, minutes: Path | None, as_json: bool) -> int:
    """Print which tests, how often and in which order reach the wanted intervals.

    Raises:
        InputError: invalid target, table or gear.
    """
    from rps_exudyn.inference.fitting.plan import MINUTES, parse_targets, plan, read_minutes

    wanted = parse_targets(targets)
    times = read_minutes(minutes) if minutes else MINUTES
    with shown_progress(asked=False):
        found = plan(wanted, gear.load(), times)
    status = FAILED if found.missed else DONE
    if as_json:
        tests = [
            {
                "test": each.test.title,
                "runs": each.runs,
                "minutes": each.minutes,
                "halves": dict(each.half_intervals),
            }
            for each in found.tests
        ]
        print_json(
            {"targets": dict(wanted), "minutes": found.minutes, "tests": tests, "missed": found.missed}
        )
        return status
    goals = ", ".join(f"{path} +-{100 * half:.3g} %" for path, half in wanted.items())
    put(f"plan · wanted: {goals} · {found.minutes:.0f} minutes", "bold")
    heads = ("test", "runs", "minutes", *(f"{path} after it" for path in wanted))
    rows = [
        (
            each.test.title,
            f"{each.runs}",
            f"{each.minutes:.0f}",
            *(f"+-{100 * each.half_intervals[path]:.3g} %" for path in wanted),
        )
        for each in found.tests
    ]
    put_table(heads, rows)
    for path, half in found.missed.items():
        put(
            f"note: no number of runs brings {path} below +-{100 * half:.3g} % (wanted "
            f"{100 * wanted[path]:.3g} %): "
            "what tests compare although nobody measured it is known no better"
        )
    return status


_TOLERANCE = re.compile(r"(?:(?P<low>.+?)\s+)?to(?:\s+(?P<high>.+))?")


def parse_tolerance(text: str) -> "Limits":
    """Return limits [N m] of "LOW to HIGH"; either may be left out.

    Raises:
        InputError: it is no tolerance.
    """
    from rps_exudyn.inference.fitting.production import Limits

    found = _TOLERANCE.fullmatch(text.strip())
    inf = float("inf")
    try:
        low, high = (
            units.to_si(found[end], "N*m") if found and found[end] else None for end in ("low", "high")
        )
    except ValueError:
        low = high = None
    limits = Limits(-inf if low is None else low, inf if high is None else high)
    if (low is None and high is None) or not limits.low < limits.high:
        raise InputError(
            f'--tolerance {text} is no tolerance; write for instance --tolerance "0.5 N*m to 0.8 N*m", or '
            '"to 0.8 N*m".'
        )
    return limits


def judge_batch(
    folder: Path,
    tolerance: str | None,
    gear: GearOptions,
    asked: tuple[Path | None, Path | None],
    jobs: int,
    as_json: bool,
) -> int:
    """Print what a production batch shows; write the table of its gears and the chart of their drift, where
    they are `asked` for.

    Raises:
        InputError: a folder, a tolerance or a file that cannot be.
    """
    from rps_exudyn.inference.fitting.findings import shown
    from rps_exudyn.inference.fitting.production import GUARD, judge_lot

    limits = parse_tolerance(tolerance) if tolerance is not None else None
    out, plot = asked
    for path, suffixes in ((out, (".csv",)), (plot, PICTURES)):
        if path is not None:
            check_writable(path, suffixes)
    with shown_progress(asked=False):
        found = judge_lot(folder, gear.load(), jobs=jobs)
    guard = GUARD * found.sd
    risks = [] if limits is None else [found.risks(limits, each) for each in (0.0, guard)]
    rows = list(batch_rows(found, limits, guard))
    if out is not None:
        with replacing(out) as partial:
            partial.write_text("".join(",".join(row) + "\n" for row in (BATCH_COLUMNS, *rows)), "utf-8")
    if plot is not None:
        from rps_exudyn.pages.charts.inference import drift_figure
        from rps_exudyn.pages.charts.style import save

        save(drift_figure(found, limits and limits.guarded(guard)), plot)
    files = [path for path in asked if path is not None]
    alarms = found.drift.alarms
    if as_json:
        content = {
            "gears": [dict(zip(BATCH_COLUMNS, row, strict=True)) for row in rows],
            "mean": found.mean,
            "mean_sd": found.mean_sd,
            "scatter": dict(zip(("median", "low", "high"), found.scatter, strict=True)),
            "parameters": found.parameters,
            "scatter_alone": found.alone,
            "drift_alarms": [found.gears[i].name for i in alarms],
            "risks": [vars(each) | {"limits": [each.limits.low, each.limits.high]} for each in risks],
            "refused": list(found.refused),
            "files": [str(file) for file in files],
        }
        print_json(content)
        return DONE
    middle, low, high = (100 * each for each in found.scatter)
    put(f"batch · {len(found.gears)} gears", "bold")
    put(f"mean free torque {found.mean:.4g} +- {1.96 * found.mean_sd:.2g} N m (95 %)")
    put(
        f"scatter between gears {middle:.3g} % ({low:.3g} to {high:.3g} %, 95 %), without that of the "
        f"measurement, {100 * found.sd / found.mean:.3g} %"
    )
    columns = ("parameter", "mean of the batch", "deviation", "scatter, if no other parameter scatters")
    cells = [
        (path, shown(path, value), f"{100 * sd:.3g} %", f"{100 * found.alone[path]:.3g} %")
        for path, (value, sd) in found.parameters.items()
        if path in found.alone
    ]
    put_table(columns, cells)
    for name, each in zip(("without guard bands", "with guard bands"), risks, strict=False):
        put(
            f"limits {name}, {each.limits.low:.4g} to {each.limits.high:.4g} N m: consumer's risk "
            f"{100 * each.consumer:.2g} %, producer's risk {100 * each.producer:.2g} %"
        )
    if limits is not None:
        rejected = [row[0] for row in rows if row[-2] == "rejected"]
        put(f"{len(rejected)} rejected" + (f": {', '.join(rejected[:10])}" if rejected else ""))
    drifts = f"from {found.gears[alarms[0]].name} on" if alarms.size else "none (false in 1 % of batches)"
    put(f"drift of the moving average: {drifts}")
    for sentence in found.refused:
        put(f"note: left out: {sentence}")
    print_files(files)
    return DONE


BATCH_COLUMNS = (
    "gear", "level [N m]", "low [N m]", "high [N m]", "expected [N m]", "moving average [N m]", "P e [N mm]",
    "P e found", "verdict", "drift",
)  # fmt: skip


def batch_rows(found: "ProductionLot", limits: "Limits | None", guard: float) -> Iterator[tuple[str, ...]]:
    """The row of each gear, by `BATCH_COLUMNS`; the verdict is that of limits with guard bands."""
    alarms, accepted = set(found.drift.alarms.tolist()), limits and limits.guarded(guard)
    for i, each in enumerate(found.gears):
        runout, verdict = each.runout, ""
        if accepted is not None:
            verdict = "accepted" if accepted.low <= each.level <= accepted.high else "rejected"
        numbers = (each.level, *each.interval, found.expected[i], found.drift.average[i])
        yield (
            each.name,
            *(f"{number:.6g}" for number in numbers),
            "" if runout is None else f"{1e3 * runout.stored:.4g}",
            "" if runout is None else "yes" if runout.is_found else "no",
            verdict,
            "beyond" if i in alarms else "",
        )


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
        from rps_exudyn.pages.report.fit_page import write_fit_sheet

        write_fit_sheet(fit, report, command_line())
        yield report
