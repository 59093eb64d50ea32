"""Messages of the cases of a study, linked to them: remarks on those that ended ok, and causes of failure."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from hashlib import sha256

import matplotlib as mpl
import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import words
from rps_exudyn.inference.uncertainty.joint import groups_of, read_pairs
from rps_exudyn.inference.uncertainty.statistics import LEVELS, contributions, quantiles
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.signals import WIDTH, abscissa, label_abscissa
from rps_exudyn.pages.report.effects_charts import COLOUR_MAP
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.pages.report.study_rows import count
from rps_exudyn.parameters.gear import CORRELATION
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.results.sheet import (
    Block,
    Cell,
    Fold,
    Grid,
    Link,
    Links,
    Picture,
    Section,
    Text,
    Warning,
)
from rps_exudyn.scenes import is_scene, scene_named
from rps_exudyn.study.case_progress import Group, groups
from rps_exudyn.study.definition import UNCERTAIN_DESIGN, Case
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import PENDING, CaseTable, show_value

MOST_ROWS = 300  # cases listed one by one
MOST_LINKS = 40  # cases of one group
LINK_DIGITS = 3


def case_id(table: CaseTable, case: Case) -> str:
    """The place of a case on its page, among all cases, also those of another folder of the same study."""
    folder = sha256(str(table.path).encode(errors="replace")).hexdigest()[:6]
    return f"{table.description.name}-{folder}-{case.hash}".replace(" ", "-")


def case_link(table: CaseTable, case: Case) -> Links:
    """The case's name, which leads to its row as far as cases are listed."""
    listed = {each.hash for each in table.cases[:MOST_ROWS]}
    return Links([Link(case.hash, case_id(table, case) if case.hash in listed else "")])


def settings(table: CaseTable, case: Case, digits: int = 6) -> list[str]:
    """The values of the axes as text."""
    return [show_value(axis, case.values[axis.name], digits) for axis in table.description.axes]


def remarks_section(table: CaseTable) -> list[Section]:
    """The section of remarks; none without remarks."""
    found = groups(table.remarked())
    if not found:
        return []
    blocks: list[Block] = []
    limited = int(table.limited.sum())
    if 0 < limited < table.ok.sum():
        blocks.append(
            Warning(
                f"{count(limited, 'case')} of {int(table.ok.sum())} met a limit of the gear, where a contact "
                "opens or closes: numbers have a kink there. Charts show these cases as diamonds; lines and "
                "colours are not carried from one side to the other."
            )
        )
    else:
        blocks.append(Text("Completed, with warnings."))
    rows: list[Sequence[Cell]] = [
        [count(len(each.cases), "case"), each.example, _links(table, each)] for each in found
    ]
    blocks.append(Grid(("how many", "remark of the first", _which(table)), rows))
    return [Section("Remarks", blocks)]


def failed_blocks(table: CaseTable) -> Iterable[Block]:
    """Causes with their numbers of cases, then every failed case by the way it ended."""
    failed = list(table.failed())
    if causes := groups(failed):
        rows: list[Sequence[Cell]] = [
            [count(len(each.cases), "case"), each.status.value, each.example, _links(table, each)]
            for each in causes
        ]
        yield Grid(("how many", "ended", "message of the first", _which(table)), rows, "Causes")
    for status in dict.fromkeys(row.status for _, row in failed):
        listed = [
            [row.message, *settings(table, case), case.hash] for case, row in failed if row.status is status
        ]
        grid = Grid(("message", *table.axes, "case"), listed[:MOST_ROWS])
        yield Fold(f"{status}: {count(len(listed), 'case')}", [Text(status.remedy), grid], is_open=True)
    if table.skipped:
        files = [[path.name, sentence] for path, sentence in table.skipped]
        yield Grid(("file", "why it could not be read"), files[:MOST_ROWS], "Files left out")
    if not failed and not table.skipped:
        yield Text("None.")


def _which(table: CaseTable) -> str:
    """The heading over links to cases, which are named by the values of the axes."""
    return f"which ({', '.join(table.axes)})"


def _links(table: CaseTable, group: Group) -> Links:
    """Links to the cases as far as they are listed on the page."""
    listed = {case.hash for case in table.cases[:MOST_ROWS]}
    links = [
        Link(
            ", ".join(settings(table, case, LINK_DIGITS)), case_id(table, case) if case.hash in listed else ""
        )
        for case in group.cases[:MOST_LINKS]
    ]
    more = len(group.cases) - len(links)
    return Links([*links, Link(f"and {more} more", "")] if more else links)


# --- The curves of a study's cases in one picture, each linked with its row in the table of cases

MOST_CURVES, MOST_POINTS = 40, 400
CURVES_HEIGHT = 3.0  # [in]
BRIGHTEST = 0.85  # of the colour map: brighter curves vanish on white


def curve_id(table: CaseTable, case: Case) -> str:
    """The place of a case's curve on its page."""
    return f"curve-of-{case_id(table, case)}"


def curves_of_cases(table: CaseTable, store: Store, listed: Sequence[Case]) -> tuple[list[Picture], set[str]]:
    """Return the picture of the scene's signal in some of the listed cases, and the hashes of those drawn.

    There is no picture of a scene that is not known, or of cases whose signals were not kept.
    """
    scene = table.description.scene
    if not is_scene(scene):
        return [], set()
    signal = scene_named(scene).signal
    ok = {case.hash for case, good in zip(table.cases, table.ok, strict=True) if good}
    cases = list({case.hash: case for case in listed if case.hash in ok}.values())
    cases = cases[:: max(1, -(-len(cases) // MOST_CURVES))]
    results: dict[str, tuple[Case, Result]] = {}
    for case in cases:
        with suppress(InputError):  # a file that has vanished or is damaged by now
            result = store.result(case)
            if signal in result.signals:
                results[", ".join(settings(table, case, 4)) or case.hash] = case, result
    if not results:
        return [], set()
    drawn = _picture_of_curves(table, results, signal)
    return [drawn], {case.hash for case, _ in results.values()}


def _picture_of_curves(table: CaseTable, results: dict[str, tuple[Case, Result]], signal: str) -> Picture:
    over = abscissa([result for _, result in results.values()])
    figure, (axes,) = style.panels([CURVES_HEIGHT], WIDTH)
    colours = mpl.colormaps[COLOUR_MAP](np.linspace(0, BRIGHTEST, len(results)))
    for colour, (label, (_, result)) in zip(colours, results.items(), strict=True):
        some = slice(None, None, max(1, -(-result[over].size // MOST_POINTS)))
        axes.plot(
            SIGNALS[over].displayed(result[over][some]),
            SIGNALS[signal].displayed(result[signal][some]),
            color=colour,
            linewidth=1,
            label=label,
        )
    axes.set_ylabel(SIGNALS[signal].axis_label(words(signal)))
    label_abscissa(axes, over)
    links = {label: (curve_id(table, case), case_id(table, case)) for label, (case, _) in results.items()}
    caption = f"{words(signal)} of {count(len(results), 'case')}, from the first (dark) to the last (bright)"
    return picture(figure, caption, links)


# --- The section about bands of a study with the design `uncertain`: quantiles with errors, contributions

LEAST_KNOWN = 8  # cases, for quantiles
WITH_CONTRIBUTIONS = 6  # numbers


def band_sections(table: CaseTable, names: Sequence[str]) -> list[Section]:
    """Return the section about these numbers; none of a study of another design."""
    if table.description.design != UNCERTAIN_DESIGN:
        return []
    return [Section("Bands", list(_band_blocks(table, names)))]


def _band_blocks(table: CaseTable, names: Sequence[str]) -> Iterable[Block]:
    failed = sum(status not in (Status.OK, PENDING) for status in table.status)
    if failed:
        yield Warning(
            f"{failed} of {len(table.status)} samples failed and are in no quantile; see Failed cases."
        )
    rows = [
        _levels_of(table.numbers[name], name, failed) for name in names if _known(table.numbers[name]).any()
    ]
    head = ("number", *(f"{100 * level:g} %" for level in LEVELS), "error at 5 %", "error at 95 %")
    rows = [row for row in rows if row]
    if not rows:
        yield Text(f"Quantiles need at least {LEAST_KNOWN} cases that ended ok.")
        return
    yield Grid(head, rows, "Quantiles; errors are standard errors, from the number of samples")
    inputs = [name for name, values in table.axes.items() if values.dtype.kind == "f"]
    for name in names[:WITH_CONTRIBUTIONS]:
        yield from _contributions(table, name, inputs)


def _levels_of(numbers: np.ndarray, name: str, failed: int) -> list[str]:
    known = numbers[_known(numbers)]
    if known.size < LEAST_KNOWN:
        return []
    found, show = quantiles(known, failed), SUMMARY[name].show
    errors = [show(float(found.errors[at])) for at in (0, -1)]
    return [words(name), *(show(value) for value in found.values.tolist()), *errors]


def _contributions(table: CaseTable, name: str, inputs: list[str]) -> Iterable[Block]:
    """Fractions of the variance; the quantile of a value is its rank among all that were drawn."""
    known = _known(table.numbers[name])
    ranks = [np.argsort(np.argsort(table.axes[axis])) for axis in inputs]
    if not ranks:
        return
    quantile = (np.stack(ranks, axis=1) + 0.5) / len(known)
    groups = groups_of(inputs, read_pairs(table.description.correlation, CORRELATION, []))
    shares = contributions(quantile[known], table.numbers[name][known], groups) if known.any() else None
    if shares is None:
        return
    rows = [[axis, f"{share:.0%}"] for axis, share in shares.fractions.items()]
    rows.append(["acting together", f"{shares.together:.0%}"])
    caption = f"Share of the variance of {words(name)}, each within {shares.error:.0%} by chance"
    yield Fold(f"Contributions to {words(name)}", [Grid(("input", "share"), rows, caption)])


def _known(numbers: np.ndarray) -> np.ndarray:
    return np.isfinite(numbers)
