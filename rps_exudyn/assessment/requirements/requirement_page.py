"""The sheet of a gear's requirements: how many are kept, and each on its scale."""

from collections.abc import Iterator, Sequence
from typing import Any

from rps_exudyn.assessment.requirements.judging import ASSURED, RequirementRow, law_of_sheet
from rps_exudyn.pages.report.html import make_again, parameter_grid
from rps_exudyn.pages.report.judged import ORDER, judgement, mark_of
from rps_exudyn.pages.report.result_sheet import gear_shown, listed
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.page_blocks import Fold, Judged, Judgement, Mark
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.requirements import label_of, quantity_of
from rps_exudyn.results.rounding import rounded, rounded_range, shown_with_bar
from rps_exudyn.results.sheet import Block, Grid, Row, Section, Sheet, Text

COLUMNS = ("requirement", "limit", "nominal", "5 to 95 %", "gears that keep it", "verdict")
HEADS = ("requirement", "value and 90 % of the gears; grey is beyond the limit", "value", "limit")
WORDS = {Mark.NOT_KEPT: "not kept", Mark.OPEN: "open", Mark.KEPT: "kept"}


def requirement_page(
    sheet: Sequence[RequirementRow], gear: SteeringGear, torque: float, command: str, margins: bool = False
) -> Sheet:
    """Return the sheet of all requirements.

    Args:
        sheet: judged requirements.
        gear: that was judged.
        torque: rated one, on the pinion [N m].
        command: that makes it again.
        margins: whether the margins of what is not kept are stated.
    """
    of = {mark: [each for each in sheet if mark_of(each) is mark] for mark in ORDER}
    kept = f"{len(of[Mark.KEPT])} of {len(sheet)}"
    rows = [Row(kept, f"requirements kept by {100 * ASSURED:.0f} % of the gears")]
    for mark in ORDER:
        if mark is Mark.NOT_KEPT:
            rows += [Row(WORDS[mark], _missed(each) + _margin(each) * margins) for each in of[mark]]
        elif of[mark]:
            rows.append(Row(WORDS[mark], listed([label_of(each.name)[0] for each in of[mark]])))
    changed = gear.changes()
    sources = [[label_of(each.name)[0], each.limit.source, each.remark, each.name] for each in sheet]
    heads = ("requirement", "source", "computed by", "name in the file")
    details = [
        Fold("Sources of the limits, and choices", [Grid(heads, sources)]),
        *([Fold("Parameters", [parameter_grid(changed)])] if changed else []),
        make_again(provenance(), command),
    ]
    judged = [_judged(each, torque) for mark in ORDER for each in of[mark]]
    return Sheet(
        title="Requirements",
        lead=f"{gear_shown(gear)} · rated torque {torque:g} N m · contact law {law_of_sheet(gear)}",
        rows=rows,
        text=_text(sheet, gear, torque),
        more="limits, bands and sources",
        data=lambda: _as_dict(sheet, gear, margins),
        sections=[Section("All requirements", [Judged(HEADS, judged)]), Section("Details", details)],
        gear=gear,
    )


def _text(sheet: Sequence[RequirementRow], gear: SteeringGear, torque: float) -> Iterator[Block]:
    rows = []
    for each in sheet:
        quantity = quantity_of(each.name)
        nominal = shown_with_bar(quantity, each.value, each.error) if each.is_known else ""
        band = each.band_shown(quantity.show)
        share = f"{each.share:.0%}" if band else ""
        rows.append((each.name, each.limit.show(quantity), nominal, band, share, each.verdict))
    yield Grid(COLUMNS, rows)
    for each in sheet:
        remark = f" {each.remark}." if each.remark else ""
        yield Text(f"{each.name}: {quantity_of(each.name).long_name}. From: {each.limit.source}.{remark}")
    yield Text(f"Rated torque {torque:g} N m. Contact law {law_of_sheet(gear)}.")
    yield Text(f"A requirement passes if {ASSURED:.0%} of the gears keep it.")


def _as_dict(sheet: Sequence[RequirementRow], gear: SteeringGear, margins: bool) -> dict[str, Any]:
    rows = {
        each.name: {
            "verdict": each.verdict,
            "nominal": each.value,
            "error": each.error if each.is_known else None,
            "band": [each.low, each.high],
            "unit": quantity_of(each.name).unit,
            "limit": each.limit.show(quantity_of(each.name)),
            "share": each.share,
            "source": each.limit.source,
            "remark": each.remark,
            **({"margin": each.margin} if margins else {}),
        }
        for each in sheet
    }
    kept = all(each.verdict == "pass" for each in sheet)
    return {"all_kept": kept, "contact_law": law_of_sheet(gear), "requirements": rows}


def _missed(each: RequirementRow) -> str:
    """The number of a requirement that is not kept, the limits it misses, and how many gears keep them."""
    label, quantity, limit = label_of(each.name)[0], quantity_of(each.name), each.limit
    number = f"{label} {rounded(quantity, each.value, like=limit.finite)}"
    if each.low == each.high:
        return f"{number}; limit {limit.missed(each.value, each.value).show(quantity)}"
    band = rounded_range(quantity, each.low, each.high, limit.finite)
    missed = limit.missed(each.low, each.high).show(quantity)
    return f"{number}, {band} in 90 % of gears; limit {missed}, kept by {100 * each.share:.0f} %"


def _margin(each: RequirementRow) -> str:
    """How far the limit is missed, and where there is no band, that no gear keeps it."""
    shown = rounded(quantity_of(each.name), each.margin, like=each.limit.finite)
    return f", margin {shown}" + ", kept by 0 %" * (each.low == each.high)


def _judged(each: RequirementRow, torque: float) -> Judgement:
    label, note = label_of(each.name)
    quantity = quantity_of(each.name)
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
