"""One page and one picture about all rows: errors with their uncertainties, and what may be concluded."""

from collections import Counter
from collections.abc import Sequence
from functools import partial
from math import inf, isfinite
from typing import Any

from matplotlib.figure import Figure

from rps_exudyn.assessment.validation.compared_rows import COVERAGE, ComparedRow, predictions
from rps_exudyn.assessment.validation.row import KINDS
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.report.html import make_again
from rps_exudyn.pages.report.judged import ORDER, judgement, limits_of, mark_of
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.pages.report.result_sheet import listed
from rps_exudyn.results.judged_row import ON_COMPARISONS, Verdict
from rps_exudyn.results.page_blocks import Facts, Fold, Judged, Judgement, Mark, Pictures
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.rounding import rounded
from rps_exudyn.results.sheet import Grid, Line, Row, Section, Sheet, Text

RATIO = "E / u_val, or gears that keep a limit"
COLUMNS = ("row", "D", "S (5 to 95 %)", "E", "u_num", "u_input", "u_D", RATIO, "verdict")
TITLES = {
    "validation": "Validation: data of gears",
    "comparison": "Code to code: other programs and models",
    "verification": "Code verification: closed forms and standards",
}
UNKNOWN = (
    "Manuals state neither module, friction, spring nor accuracy of their gears: their rows compare with the "
    "band of any gear with the default teeth (inputs unknown), which is wider than most rows. Such a row "
    "excludes gross errors and validates no parameter."
)
HEADS = ("source", "simulated, with 90 % of the gears; grey is what was published", "simulated", "verdict")
PICTURE = "(simulated - measured) / measured of every row, with 95 % uncertainty"
HEADINGS = {
    Verdict.DISAGREES: "disagree",
    Verdict.WEAK: "weak",
    Verdict.KEPT_BY_ANY: "kept by any gear",
    Verdict.CALIBRATED: "calibrated",
    Verdict.NOT_COMPARABLE: "not comparable",
}
"""Verdict -> its heading in the sheet; the others agree."""
COLOURS = {
    Verdict.AGREES: "#1B1F24",
    Verdict.NOISE: "#0072B2",
    Verdict.WEAK: "#8B939D",
    Verdict.DISAGREES: "#B84A00",
    Verdict.KEPT_BY_ANY: "#C9CED4",
    Verdict.CALIBRATED: "#CC79A7",
}
LINEAR = 1.0  # percent, below which the axis is linear


def validation_page(comparisons: Sequence[ComparedRow], command: str) -> Sheet:
    """Return the sheet of all rows: verdicts, then each row with the published range in grey.

    Args:
        comparisons: judged rows.
        command: that makes it again.
    """
    judged = predictions(comparisons)
    counts = Counter(group[0].verdict for group in judged)
    agree = counts[Verdict.AGREES] + counts[Verdict.NOISE]
    rows = [Row(f"{agree} of {len(judged)}", "predictions agree with all their data from outside")]
    for verdict, heading in HEADINGS.items():
        titles = [each.row.title.partition(":")[0] for each in comparisons if each.verdict is verdict]
        if titles:
            rows.append(Row(heading, f"{len(titles)}: {listed(list(dict.fromkeys(titles)))}"))
    sections = []
    for kind in KINDS:
        some = [each for each in comparisons if each.row.kind == kind]
        if some:
            some.sort(key=lambda each: (ORDER.index(mark_of(each)), each.row.title))
            said = [" ".join(part for part in (each.row.note, each.remark) if part) for each in some]
            notes = [[each.row.title, each.row.source, text] for each, text in zip(some, said, strict=True)]
            numbers = Grid(COLUMNS, [row_cells(each) for each in some])
            folds = [
                Fold("Sources and notes", [Grid(("row", "source", "note"), notes)]),
                Fold("Errors and uncertainties", [numbers]),
            ]
            sections.append(Section(TITLES[kind], [Judged(HEADS, [_judged(each) for each in some]), *folds]))
    verdicts = Facts([(each.value, each.meaning) for each in ON_COMPARISONS])
    origin = provenance()
    details = [
        Fold("Meaning of the verdicts", [verdicts, Text(UNKNOWN)]),
        Fold("All errors in one picture", [Pictures([picture(validation_figure(comparisons), PICTURE)])]),
        make_again(origin, command),
    ]
    total = Counter(each.verdict.value for each in comparisons)
    found = ", ".join(f"{count} {verdict}" for verdict, count in total.items())
    return Sheet(
        "Validation",
        "manuals, standards, other programs, closed forms",
        rows,
        text=[Grid(COLUMNS, [row_cells(each) for each in comparisons]), Line(f"{found}.", is_bold=True)],
        more="every row",
        data=lambda: {"origin": origin, "rows": [each.as_dict() for each in comparisons]},
        sections=[*sections, Section("Details", details)],
    )


def _judged(each: ComparedRow) -> Judgement:
    data = each.row.data
    ends = limits_of(data.side, data.value, data.ends)
    if not any(map(isfinite, ends)):
        ends = (-inf, inf)
    published = row_cells(each)[1]
    title, _, what = each.row.title.partition(":")
    remark = each.remark if mark_of(each) is not Mark.KEPT else ""
    verdict = f"{each.verdict.value} · {published}"
    if each.kept_shown:
        verdict += f", {each.kept_shown}"
    show = partial(rounded, data.shown_as)
    return judgement(each, title, what.strip(), show, ends, verdict, remark, is_published=True)


def row_cells(each: ComparedRow) -> list[str]:
    """Return a row of the table, one cell for each of `COLUMNS`."""
    data = each.row.data
    show = data.shown_as.show
    limit = {1: "at most ", -1: "at least "}.get(data.side, "")
    shown = f"{show(data.ends[0])} to {show(data.ends[1])}" if data.ends else f"{limit}{show(data.value)}"
    if not each.is_known:
        return [each.row.title, shown, *[""] * 6, each.verdict.value]
    band = each.band_shown(show)
    uncertainties = [show(value) if value else "0" for value in (each.u_num, each.u_input, data.uncertainty)]
    ratio = f"{abs(each.error) / each.uncertainty:.2g}" if each.uncertainty and not data.side else ""
    ratio = each.kept_shown or ratio
    value = show(each.value) + (f" ({band})" if band else "")
    return [each.row.title, shown, value, show(each.error), *uncertainties, ratio, each.verdict.value]


def validation_figure(comparisons: Sequence[ComparedRow]) -> Figure:
    """The picture: E over |D| with its uncertainty, a row each, coloured by verdict; limits as such."""
    shown = [each for each in comparisons if each.verdict is not Verdict.NOT_COMPARABLE]
    shown.sort(key=lambda each: (KINDS.index(each.row.kind), each.row.title))
    figure, (axes,) = style.panels([1.5 + 0.21 * len(shown)], width=9.0)
    for place, each in enumerate(shown):
        size = abs(each.row.data.value)
        error, half = 100 * each.error / size, 100 * COVERAGE * each.uncertainty / size
        mark: Any = {1: "<", -1: ">"}.get(each.row.data.side, "o")
        look: Any = {"color": COLOURS[each.verdict], "markersize": 5, "capsize": 2, "linewidth": 1}
        axes.errorbar(error, place, xerr=half, fmt=mark, **look)
    style.signed_decades(axes, LINEAR)
    axes.set_yticks(range(len(shown)), [each.row.title for each in shown], fontsize=8)
    axes.set_ylim(len(shown) - 0.3, -0.7)
    axes.axvline(0, **style.REFERENCE_LINE)
    axes.set_xlabel(
        "(simulated - measured) / measured [%] with 95 % uncertainty; triangles: the side of a kept limit",
        loc="right",
    )
    for verdict, colour in COLOURS.items():
        axes.plot([], [], "o", color=colour, label=verdict.value)
    style.name_curves(axes)
    return figure
