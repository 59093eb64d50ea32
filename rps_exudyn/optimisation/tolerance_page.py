"""What a choice of tolerances found, as a sheet: the cheapest set, and the steps from it."""

from collections.abc import Iterator
from dataclasses import asdict
from math import isfinite
from typing import Any

import numpy as np

from rps_exudyn.optimisation.confirmation import SEARCHED
from rps_exudyn.optimisation.tolerance_search import Share, Tolerancing
from rps_exudyn.pages.charts.front import front_figure
from rps_exudyn.pages.report.html import make_again
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.parameters.display_names import named
from rps_exudyn.results.page_blocks import Pictures
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.quantities import Quantity
from rps_exudyn.results.sheet import Block, Grid, Row, Section, Sheet, Text

COST, SCRAP = Quantity("", "", "cost of all classes"), Quantity("", "%", "gears that miss a limit")
ERRORS = (
    "± is the standard error; on fresh gears, plus how far the share moves if all gears are wrong by their "
    "error bars to the same side."
)
MOST_DRAWN = 1000  # sets of the picture


def tolerance_sheet(found: Tolerancing, command: str) -> Sheet:
    """Return the sheet of a choice of tolerances; `command` makes it again."""
    problem, tables = found.problem, [_classes(found), _limits(found), _steps(found)]
    blocks: list[Block] = [*tables, Text(ERRORS)]
    labels = [("cost", COST), ("scrap", SCRAP)]
    points = np.array([found.costs, found.scrap]).T
    names = "sets of classes", "the chosen set"
    drawn = points[:: -(-len(points) // MOST_DRAWN)]
    figure = front_figure(drawn, points[found.front], points[[found.chosen]], labels, names=names)
    pictures = Pictures([picture(figure, "Cost of each set of classes against its scrap")])
    return Sheet(
        title=problem.problem.study.title,
        lead=f"{len(found.costs)} sets of classes, {found.gears} gears for all of them · {found.folder}",
        rows=list(_rows(found)),
        text=blocks,
        more="classes, limits, steps from the chosen set",
        data=lambda: _data(found),
        sections=[
            Section("Cost against scrap", [pictures]),
            Section("Tolerances", blocks),
            Section("Details", [make_again(provenance(), command)]),
        ],
        gear=problem.problem.study.base.steering_gear,
    )


def _percent(share: Share) -> str:
    return f"{100 * share.value:.1f} ± {100 * (share.error + share.numerical):.1f} %"


def _rows(found: Tolerancing) -> Iterator[Row]:
    chosen, wanted = found.chosen, f"{100 * found.problem.share:g} %"
    missed, worst = max((missed, each.number.name) for each, missed, _ in found.limits)
    if found.keeps:
        yield Row(f"{found.costs[chosen]:g}", f"least cost with which {wanted} of the gears keep the limits")
    else:
        yield Row("none", f"of the sets keeps {wanted}; the nearest is kept by {_percent(found.kept)}")
        yield Row("forbidden", f"by {worst}, which {100 * missed:.1f} % of its gears miss")
        if found.not_kept:
            yield Row("not kept", f"the own share of {', '.join(found.not_kept)}")
    for path, name in found.classes.items():
        yield Row(name, named(path))
    for model, scrap in found.fresh.items():
        kept = Share(1 - scrap.value, scrap.error, scrap.numerical)
        yield Row(_percent(kept), f"of {_fresh(found, model)} fresh gears keep the limits, {model}")
        most = kept.value + kept.error + kept.numerical
        if model == SEARCHED and found.keeps and most < found.problem.share:
            yield Row("not kept", f"on fresh gears; in the search {_percent(found.kept)}")


def _fresh(found: Tolerancing, model: str) -> int:
    return found.problem.problem.confirm[model != SEARCHED]


def _classes(found: Tolerancing) -> Grid:
    at = found.problem.sets[found.chosen].tolist()
    declared = {item.path: item for item in found.problem.problem.study.base.steering_gear.declared()}
    rows = []
    for (path, own), k in zip(found.problem.classes.items(), at, strict=True):
        low, high = own[k].scatter.ends
        ends = declared[path].show
        rows.append([path, own[k].name, own[k].scatter.kind, ends(low), ends(high), f"{own[k].cost:g}"])
    return Grid(("tolerance", "class", "distribution", "least", "most", "cost"), rows, "The chosen classes")


def _limits(found: Tolerancing) -> Grid:
    rows = [["all", "", _percent(found.kept), f"{100 * found.problem.share:g} %"]]
    for each, missed, share in found.limits:
        limit, own = each.limit.show(each.number.quantity), f"{100 * share:g} %" if share else ""
        rows.append([each.number.name, limit, f"{100 * (1 - missed):.1f} %", own])
    return Grid(("metric", "limit", "gears that keep it", "at least"), rows, "The limits, in the search")


def _steps(found: Tolerancing) -> Grid:
    rows = [
        [
            *(each.path, f"{each.before} to {each.after}", f"{each.cost:+g}", _percent(each.scrap)),
            f"{price:.3g}" if isfinite(price := each.cost_per_percent) else "not clear",
        ]
        for each in found.steps
    ]
    heads = ("tolerance", "step", "cost", "scrap", "cost of a per cent less scrap")
    return Grid(heads, rows, "Steps of one tolerance from the chosen set")


def _data(found: Tolerancing) -> dict[str, Any]:
    chosen = found.chosen
    return {
        "folder": str(found.folder),
        "keeps": found.keeps,
        "classes": found.classes,
        "cost": float(found.costs[chosen]),
        "scrap": asdict(Share(float(found.scrap[chosen]), float(found.errors[chosen]))),
        "fresh": {model: asdict(each) for model, each in found.fresh.items()},
        "limits": [
            {"name": each.number.name, "missed": m, "share": share} for each, m, share in found.limits
        ],
        "steps": [asdict(each) for each in found.steps],
        "front": [[float(found.costs[i]), float(found.scrap[i])] for i in found.front],
        "gears": found.gears,
    }
