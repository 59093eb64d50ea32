"""The sheet of a gear's requirements: how many are kept, and each on its scale."""

from collections.abc import Sequence

from rps_exudyn.assessment.requirements.limits import LABELS, REQUIRED
from rps_exudyn.assessment.requirements.sheet import ASSURED, RequirementRow, law_of_sheet
from rps_exudyn.pages.report.html import (
    Article,
    CodeText,
    Fold,
    Grid,
    Judged,
    Judgement,
    Mark,
    Section,
    parameter_grid,
    provenance_facts,
)
from rps_exudyn.pages.report.judged import ORDER, judgement, mark_of
from rps_exudyn.pages.report.sheet import Row, gear_shown, listed
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.rounding import rounded, rounded_range

HEADS = ("requirement", "value and 90 % of the gears; grey is beyond the limit", "value", "limit")
WORDS = {Mark.NOT_KEPT: "not kept", Mark.OPEN: "open", Mark.KEPT: "kept"}


def requirement_article(
    sheet: Sequence[RequirementRow], gear: SteeringGear, torque: float, command: str
) -> Article:
    """Return the sheet of all requirements, without the gear's picture.

    Args:
        sheet: judged requirements.
        gear: that was judged.
        torque: rated one, on the pinion [N m].
        command: that makes it again.
    """
    of = {mark: [each for each in sheet if mark_of(each) is mark] for mark in ORDER}
    kept = f"{len(of[Mark.KEPT])} of {len(sheet)}"
    rows = [Row(kept, f"requirements kept by {100 * ASSURED:.0f} % of the gears")]
    for mark in ORDER:
        if mark is Mark.NOT_KEPT:
            rows += [Row(WORDS[mark], _missed(each)) for each in of[mark]]
        elif of[mark]:
            rows.append(Row(WORDS[mark], listed([LABELS[each.name][0] for each in of[mark]])))
    changed = gear.changes()
    sources = [[LABELS[each.name][0], each.limit.source, each.remark, each.name] for each in sheet]
    heads = ("requirement", "source", "computed by", "name in the file")
    details = [
        Fold("Sources of the limits, and choices", [Grid(heads, sources)]),
        *([Fold("Parameters", [parameter_grid(changed)])] if changed else []),
        Fold("Make it again", [provenance_facts(provenance()), CodeText(command)]),
    ]
    judged = [_judged(each, torque) for mark in ORDER for each in of[mark]]
    return Article(
        title="Requirements",
        lead=f"{gear_shown(gear)} · rated torque {torque:g} N m · contact law {law_of_sheet(gear)}",
        rows=rows,
        sections=[Section("All requirements", [Judged(HEADS, judged)]), Section("Details", details)],
    )


def _missed(each: RequirementRow) -> str:
    """The number of a requirement that is not kept, the limits it misses, and how many gears keep them."""
    label, quantity, limit = LABELS[each.name][0], REQUIRED[each.name], each.limit
    number = f"{label} {rounded(quantity, each.value, like=limit.finite)}"
    if each.low == each.high:
        return f"{number}; limit {limit.missed(each.value, each.value).show(quantity)}"
    band = rounded_range(quantity, each.low, each.high, limit.finite)
    missed = limit.missed(each.low, each.high).show(quantity)
    return f"{number}, {band} in 90 % of gears; limit {missed}, kept by {100 * each.share:.0f} %"


def _judged(each: RequirementRow, torque: float) -> Judgement:
    label, note = LABELS[each.name]
    quantity = REQUIRED[each.name]
    mark = mark_of(each)

    def show(value: float) -> str:
        return rounded(quantity, value)

    return judgement(
        each,
        label,
        note.format(torque=f"{torque:g} N m"),
        show,
        (each.limit.least, each.limit.most),
        f"{WORDS[mark]} · {each.limit.show(quantity)}".replace(" ", "\xa0").replace("\xa0·\xa0", " · "),
        f"{each.remark}." if each.remark and (each.is_close or mark is not Mark.KEPT) else "",
    )
