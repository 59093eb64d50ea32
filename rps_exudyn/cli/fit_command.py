"""The command `fit`: what measured curves tell of a gear."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import check_writable, number_existing, replacing
from rps_exudyn.cli.kept import named_if_interrupted, say
from rps_exudyn.cli.progress import shown_progress

if TYPE_CHECKING:
    from rps_exudyn.fitting.fitted import Fit
    from rps_exudyn.parameters.gear import SteeringGear

PAGES = (".html", ".htm")
_PRIOR = re.compile(r"(?P<value>.+?)\s*(?:\+-|\+/-|±)\s*(?P<sd>.+)")


def parse_priors(texts: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Path -> expected value and standard deviation, of texts PATH="VALUE +- DEVIATION".

    Raises:
        InputError: everything that is wrong with them.
    """
    from rps_exudyn.fitting.unknowns import FREEABLE
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
    sd = abs(expected) * units.to_si(part, "") if part.endswith("%") and si else units.to_si(part, si)
    if not si and part.endswith("%"):
        sd = abs(expected) * units.to_si(part, "")
    if not 0 < sd < float("inf"):
        raise ValueError(f"has the standard deviation {deviation}, which must be more than 0")
    return expected, sd


def print_fit(fit: "Fit", files: Iterable[Path]) -> None:
    """Print level, what is not separable, the table of parameters, and warnings."""
    from rps_exudyn.cli.text_table import put, put_table
    from rps_exudyn.fitting import findings

    tests = ", ".join(dict.fromkeys(each.test for each in fit.passes))
    put(f"fit · tests: {tests} · {'converged' if fit.converged else 'NOT CONVERGED'}", "bold")
    for sentence in (findings.level_sentence(fit), *findings.open_sentences(fit)):
        if sentence:
            put(sentence)
    columns = ("parameter", "value", "95 % interval", "expected before", "verdict")
    put_table(columns, findings.rows(fit))
    if sentence := findings.offset_sentence(fit):
        put(sentence)
    for sentence in (*fit.left_out, *fit.warnings):
        put(f"note: {sentence}")
    put(f"{fit.simulations} simulations, {fit.cpu_s:.2g} s of CPU time")
    for file in files:
        put(f"written: {file}")


def write_files(
    fit: "Fit", out: Path, plot: Path | None, report: Path | None, series: Path | None
) -> list[Path]:
    """Write the gear file, and what else is asked for; return the paths of those written.

    Raises:
        InputError: a file cannot be written.
        KeyboardInterrupt: it is interrupted; the files that are written are named.
    """
    written: list[Path] = []
    with named_if_interrupted(written):
        written.extend(_written_files(fit, out, plot, report, series))  # keeps those before an interrupt
    return written


def _written_files(
    fit: "Fit", out: Path, plot: Path | None, report: Path | None, series: Path | None
) -> Iterator[Path]:
    """Write the files one after the other, the gear first and the pictures last."""
    from rps_exudyn.fitting.findings import gear_text, headline
    from rps_exudyn.parameters.gear import gear_file

    if older := number_existing(out):
        say(f"an older file is kept: {older}.")
    with replacing(out) as partial:
        partial.write_text(gear_text(fit, gear_file(fit.gear)), encoding="utf-8")
    yield out
    if series:
        from rps_exudyn.fitting.series import write_series

        write_series(fit.series, series)
        yield series
    if plot:
        from rps_exudyn.charts import style
        from rps_exudyn.charts.fit import beliefs_figure, curves_figure

        figure = curves_figure(fit) or beliefs_figure(fit)
        if figure is not None:
            style.title(figure, headline(fit))
            style.save(figure, plot)
            yield plot
    if report:
        from rps_exudyn.report.fit_page import write_fit_page

        write_fit_page(fit, report)
        yield report


def do_fit(
    files: tuple[str, ...],
    gear: "SteeringGear",
    *,
    free: tuple[str, ...],
    priors: tuple[str, ...],
    columns: dict[str, str],
    other_law: bool,
    out: Path,
    plot: Path | None,
    report: Path | None,
    series: Path | None,
    like: Path | None,
) -> tuple["Fit", list[Path]]:
    """Check what is to be written, fit, and write it.

    Raises:
        InputError: files, priors or parameters that cannot be, or a file that cannot be written.
    """
    from rps_exudyn.base.files import PICTURES
    from rps_exudyn.fitting.fit import fit
    from rps_exudyn.fitting.series import read_series
    from rps_exudyn.fitting.unknowns import USUAL

    if not files:
        raise InputError("fit needs at least one measured file, for instance rps-exudyn fit measured.csv.")
    check_writable(out, (".toml",))
    for path, suffixes in ((plot, PICTURES), (report, PAGES), (series, (".json",))):
        if path:
            check_writable(path, suffixes)
    with shown_progress(asked=False):
        found = fit(
            files,
            gear,
            free=free or USUAL,
            priors=parse_priors(priors),
            columns=columns,
            other_law=other_law,
            like=read_series(like) if like else None,
        )
    return found, write_files(found, out, plot, report, series)
