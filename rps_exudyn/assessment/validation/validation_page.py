"""One page and one picture about all rows: errors with their uncertainties, and what may be concluded."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from rps_exudyn.assessment.validation.compared_rows import COVERAGE, ComparedRow
from rps_exudyn.assessment.validation.row import KINDS
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.report.html import Article, Facts, Grid, Pictures, Section, Text, page, provenance_facts
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.results.judged_row import ON_COMPARISONS, Verdict
from rps_exudyn.results.provenance import provenance

COLUMNS = ("row", "D", "S (5 to 95 %)", "E", "u_num", "u_input", "u_D", "size of E / u_val", "verdict")
TITLES = {
    "validation": "Validation: data of gears",
    "comparison": "Code to code: other programs and models",
    "verification": "Code verification: closed forms and standards",
}
UNKNOWN = (
    "Manuals print neither module, friction, spring nor accuracy of their gears: their rows compare with the "
    "band of any gear with the default teeth (inputs unknown). Half of that band is 44 % of the mean torque, "
    "wider than most rows; such a row excludes gross errors and validates no parameter."
)
COLOURS = {
    Verdict.AGREES: "#38761d",
    Verdict.NOISE: "#0b5394",
    Verdict.WEAK: "#6fa8dc",
    Verdict.DISAGREES: "#b00020",
}
TICKS = (-100.0, -10.0, -1.0, 0.0, 1.0, 10.0, 100.0)
LINEAR = 1.0  # percent, below which the axis is linear


def validation_page(comparisons: Sequence[ComparedRow]) -> str:
    """Return the HTML page."""
    counts = Counter(each.verdict for each in comparisons)
    lead = ", ".join(f"{counts[verdict]} {verdict.value}" for verdict in ON_COMPARISONS if counts[verdict])
    sections = [
        Section(
            "What may be concluded",
            [Facts([(each.value, each.meaning) for each in ON_COMPARISONS]), Text(UNKNOWN)],
        ),
        Section(
            "All rows",
            [Pictures([picture(validation_figure(comparisons), "E over D of every row, with 2 u_val")])],
        ),
    ]
    for kind in KINDS:
        rows = [each for each in comparisons if each.row.kind == kind]
        if rows:
            table = Grid(COLUMNS, [row_cells(each) for each in rows])
            notes = Grid(("row", "source", "note"), [_note(each) for each in rows], "Sources and notes")
            sections.append(Section(TITLES[kind], [table, notes]))
    sections.append(Section("Provenance", [provenance_facts(provenance())]))
    return page("Validation", [Article("Validation", f"{len(comparisons)} rows: {lead}", sections)])


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
    ratio = f"{abs(each.error) / each.uncertainty:.2g}" if each.uncertainty else ""
    return [
        each.row.title,
        shown,
        show(each.value) + (f" ({band})" if band else ""),
        show(each.error),
        *uncertainties,
        ratio,
        each.verdict.value,
    ]


def _note(each: ComparedRow) -> list[str]:
    return [each.row.title, each.row.source, " ".join(part for part in (each.row.note, each.remark) if part)]


def validation_figure(comparisons: Sequence[ComparedRow]) -> Figure:
    """The picture: E over |D| with its uncertainty, a row each, coloured by verdict; limits as such."""
    shown = [each for each in comparisons if each.verdict is not Verdict.NOT_COMPARABLE]
    shown.sort(key=lambda each: (KINDS.index(each.row.kind), each.row.title))
    figure, (axes,) = style.panels([1.5 + 0.21 * len(shown)], width=9.0)
    for place, each in enumerate(shown):
        size = abs(each.row.data.value)
        error, half = 100 * each.error / size, 100 * COVERAGE * each.uncertainty / size
        mark: Any = {1: "<", -1: ">"}.get(each.row.data.side, "o")
        axes.errorbar(
            error,
            place,
            xerr=half,
            fmt=mark,
            color=COLOURS[each.verdict],
            markersize=5,
            capsize=2,
            linewidth=1,
        )
    axes.set_xscale("symlog", linthresh=LINEAR, linscale=0.5)
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.set_yticks(range(len(shown)), [each.row.title for each in shown], fontsize=8)
    axes.set_ylim(len(shown) - 0.3, -0.7)
    axes.axvline(0, **style.REFERENCE_LINE)
    axes.set_xlabel(
        "E over D [%] with 2 u_val, linear within 1 %; triangles point to where a limit is kept", loc="right"
    )
    for verdict, colour in COLOURS.items():
        axes.plot([], [], "o", color=colour, label=verdict.value)
    style.legend_above(axes)
    return figure
