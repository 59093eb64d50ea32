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
from rps_exudyn.results.sheet import Grid, Row, Section, Sheet

COST, SCRAP = Quantity("", "", "cost of all classes"), Quantity("", "%", "gears that miss a limit")
MOST_DRAWN = 1000  # sets of the picture


def tolerance_sheet(found: Tolerancing, command: str) -> Sheet:
    """Return the sheet of a choice of tolerances; `command` makes it again."""
    problem, blocks = found.problem, [_classes(found), _steps(found)]
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
        more="classes, steps from the chosen set",
        data=lambda: _data(found),
        sections=[
            Section("Cost against scrap", [pictures]),
            Section("Tolerances", blocks),
            Section("Details", [make_again(provenance(), command)]),
        ],
        gear=problem.problem.study.base.steering_gear,
    )


def _percent(share: Share) -> str:
    return f"{100 * share.value:.1f} ± {100 * share.error:.1f} %"


def _rows(found: Tolerancing) -> Iterator[Row]:
    chosen, wanted = found.chosen, f"{100 * found.problem.share:g} %"
    estimate = Share(float(1 - found.scrap[chosen]), float(found.errors[chosen]))
    worst = max(found.misses, key=lambda name: found.misses[name])
    if found.keeps:
        yield Row(f"{found.costs[chosen]:g}", f"least cost with which {wanted} of the gears keep the limits")
    else:
        yield Row("none", f"of the sets keeps {wanted}; the nearest is kept by {_percent(estimate)}")
        yield Row("forbidden", f"by {worst}, which {100 * found.misses[worst]:.1f} % of its gears miss")
    for path, name in found.classes.items():
        yield Row(name, named(path))
    for model, scrap in found.fresh.items():
        kept = Share(1 - scrap.value, scrap.error)
        yield Row(_percent(kept), f"of {_fresh(found, model)} fresh gears keep the limits, {model}")
        if model == SEARCHED and found.keeps and kept.value + kept.error < found.problem.share:
            yield Row("not kept", f"on fresh gears; in the search {_percent(estimate)}")


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
        "misses": dict(found.misses),
        "steps": [asdict(each) for each in found.steps],
        "front": [[float(found.costs[i]), float(found.scrap[i])] for i in found.front],
        "gears": found.gears,
    }
