"""What an optimisation found, for the terminal, as JSON and as a page: the best, and how far to trust it."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.optimisation.confirmation import MODELS, SEARCHED, Confirmed, finalists
from rps_exudyn.optimisation.definition import NONE, bounds_of
from rps_exudyn.optimisation.search import Design, Search
from rps_exudyn.pages.charts.front import front_figure
from rps_exudyn.pages.report.html import make_again
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.pages.report.result_page import gear_page
from rps_exudyn.parameters.display_names import named
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.page_blocks import Picture, Pictures
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.quantities import Quantity
from rps_exudyn.results.rounding import rounded
from rps_exudyn.results.sheet import Block, Grid, Row, Section, Sheet, Text

AT_BOUND = 0.01  # of the range between its bounds, within which a variable is at one of them
ERRORS = "± is the standard error of the quantile plus the median of the runs' error bars."
OWN_LOAD = "Stresses here have each gear's own face load factor; the search took that of the gear as given."


@dataclass(frozen=True)
class Optimisation:
    """What was found: all designs, and (hash of a design, model) -> its numbers on fresh gears."""

    search: Search
    confirmed: Mapping[tuple[str, str], Confirmed]

    @property
    def front(self) -> list[Design]:
        """The best designs, by the first objective; see `Search.front`."""
        return self.search.front

    @property
    def files(self) -> dict[Path, Design]:
        """Path -> design of those that were confirmed, whose gears it will hold."""
        chosen = finalists(self.search)
        return {self.search.store.path / f"gear-{i}.toml": each for i, each in enumerate(chosen, 1)}

    @property
    def at_bounds(self) -> dict[str, str]:
        """Variable -> the bound at which it stands in the best design: the optimum may lie beyond."""
        found = {}
        for axis in self.search.problem.study.axes if self.front else ():
            (low, high), show = bounds_of(axis), SteeringGear.declared_at(axis.name)[0].show
            place = (float(self.front[0].case.values[axis.name]) - low) / (high - low)
            if min(place, 1 - place) < AT_BOUND:
                found[axis.name] = (
                    f"upper bound, {show(high)}" if place > 0.5 else f"lower bound, {show(low)}"
                )
        return found

    def fresh(self, design: Design, model: str, at: int = 0) -> float:
        """Return a number of a design on fresh gears; nan without."""
        found = self.confirmed.get((design.case.hash, model))
        return nan if found is None else found.values[at]

    def luck(self, design: Design, at: int = 0) -> float:
        """Return by how much a number on fresh gears is more than in the search, over that."""
        seen = design.numbers[at]
        return (self.fresh(design, SEARCHED, at) - seen) / abs(seen) if seen else nan

    def change(self, design: Design, model: str, at: int = 0) -> float:
        """Return the relative change of a number from the gear as given, both on the same fresh gears."""
        given = self.fresh(self.search.given, model, at)
        return (self.fresh(design, model, at) - given) / abs(given) if given else nan

    def not_kept(self, fresh: Confirmed) -> list[str]:
        """Return the names of limits that fresh numbers miss by more than their errors."""
        limits = enumerate(self.search.problem.constraints, len(self.search.problem.objectives))
        return [
            each.number.name
            for k, each in limits
            if not each.excess(fresh.values[k]) * each.limit.finite <= fresh.errors[k] + fresh.bars[k]
        ]

    def shown(self, fresh: Confirmed, at: int) -> str:
        """Return a fresh number with the sum of its sampling error and its numerical bar."""
        value, error = fresh.values[at], fresh.errors[at] + fresh.bars[at]
        quantity = self.search.problem.numbers[at].quantity
        return rounded(quantity, value, error) if error and isfinite(value) else quantity.show(value)


def optimisation_sheet(found: Optimisation, command: str) -> Sheet:
    """Return the sheet of an optimisation; `command` makes it again."""
    search, problem, front = found.search, found.search.problem, found.front
    series = "one gear" if problem.errors == NONE else f"{problem.samples} gears, errors {problem.errors}"
    confirmed: list[Block] = [
        _confirmed(found),
        Text(ERRORS),
        *([Text(OWN_LOAD)] if problem.needs_face_load else []),
    ]
    causes = [[str(len(each.cases)), each.example] for each in search.refused]
    blocks: dict[str, list[Block]] = {
        "Front": [Pictures([_picture(found)]), _grid(found)] if front else [],
        "Fresh gears and other models": confirmed if found.confirmed else [],
        "Refused designs": [Grid(("designs", "for instance"), causes)] if causes else [],
        "Details": [make_again(provenance(), command)],
    }
    shown = [*blocks.values()][:-1]
    return Sheet(
        title=problem.study.title,
        lead=f"{len(search.designs)} designs of {series} · {search.store.path}",
        rows=list(_rows(found)),
        text=[block for each in shown for block in each if not isinstance(block, Pictures)],
        more="front, confirmed numbers, refused designs",
        data=lambda: _data(found),
        sections=[Section(title, each) for title, each in blocks.items() if each],
        gear=front[0].gear if front else None,
    )


def gear_sheets(found: Optimisation) -> list[Sheet]:
    """Return the sheets of the designs that were confirmed, to stand below the first one."""
    return [replace(gear_page(each.gear, path), title=path.stem) for path, each in found.files.items()]


def _rows(found: Optimisation) -> Iterator[Row]:
    """The best by the first objective on fresh gears, its luck and bounds; then all designs."""
    search, number = found.search, found.search.problem.numbers[0]
    kept = sum(each.is_feasible for each in search.designs)
    if not found.front:
        yield Row("none", f"of the designs keeps all limits; {_nearest(search)}")
    for best in found.front[:1]:
        seen = number.quantity.show(best.numbers[0])
        for model in MODELS:
            if (fresh := found.confirmed.get((best.case.hash, model))) and isfinite(fresh.values[0]):
                change = found.change(best, model)
                against = f"{100 * change:+.0f} % against the gear as given, " if isfinite(change) else ""
                yield Row(
                    found.shown(fresh, 0), f"{number.words}: {against}{fresh.samples} fresh gears, {model}"
                )
        fresh = found.confirmed.get((best.case.hash, SEARCHED))
        if broken := found.not_kept(fresh) if fresh else []:
            yield Row("not kept", f"on fresh gears: {', '.join(broken)}")
        if isfinite(luck := found.luck(best)):
            yield Row(f"{100 * luck:+.1f} %", f"from {seen} in the search: its luck, and its coarser steps")
        else:
            yield Row(seen, f"{number.words} in the search, not confirmed")
        for name, where in found.at_bounds.items():
            yield Row(
                where.partition(", ")[2],
                f"{named(name)}, at its {where.partition(',')[0]}: better gears may lie beyond",
            )
    yield Row(
        f"{kept} of {len(search.designs)}", f"designs keep all limits; on the front: {len(found.front)}"
    )
    for each in search.refused[:1]:
        refused = sum(len(group.cases) for group in search.refused)
        yield Row(f"{refused} refused", f"{len(each.cases)} of them: {each.example}")


def _nearest(search: Search) -> str:
    known, problem = [each for each in search.designs if each.numbers], search.problem
    if not known:
        return "every one is refused"
    best = min(known, key=lambda each: max(each.excess))
    at = int(np.argmax(best.excess))
    limit, value = problem.constraints[at], best.numbers[len(problem.objectives) + at]
    quantity = limit.number.quantity
    return f"the nearest has {limit.number.words} {quantity.show(value)}, {limit.limit.show(quantity)}"


def _grid(found: Optimisation) -> Grid:
    problem, front = found.search.problem, found.front
    declared = {axis.name: SteeringGear.declared_at(axis.name)[0] for axis in problem.study.axes}
    rows = [
        [
            *(each.quantity.show(value) for each, value in zip(problem.numbers, design.numbers, strict=True)),
            *(each.show(design.gear.value_at(name)) for name, each in declared.items()),
        ]
        for design in front
    ]
    heads = [*(each.words for each in problem.numbers), *declared]
    return Grid(heads, rows, "The front, in the search", [each.case.hash for each in front])


def _confirmed(found: Optimisation) -> Grid:
    problem, rows = found.search.problem, []
    designs = {"as given": found.search.given} | {path.name: each for path, each in found.files.items()}
    for name, model in ((name, model) for name in designs for model in MODELS):
        if fresh := found.confirmed.get((designs[name].case.hash, model)):
            numbers = [found.shown(fresh, k) for k in range(len(problem.numbers))]
            rows.append(
                [
                    name,
                    model,
                    f"{fresh.samples}, {fresh.failed} failed",
                    *numbers,
                    ", ".join(found.not_kept(fresh)),
                ]
            )
    return Grid(("gear", "model", "fresh gears", *(each.words for each in problem.numbers), "not kept"), rows)


def _picture(found: Optimisation) -> Picture:
    """The front over two objectives; of one objective, the designs in their order."""
    search, objectives = found.search, found.search.problem.objectives
    order = {each.case.hash: float(i) for i, each in enumerate(search.designs)}

    def places(designs: list[Design]) -> np.ndarray:
        across = [
            each.numbers[1] if len(objectives) > 1 else order.get(each.case.hash, 0.0) for each in designs
        ]
        return np.array([across, [each.numbers[0] for each in designs]]).T

    pages = {each.case.hash: f"part-{i}-1" for i, each in enumerate(found.files.values(), 2)}
    ordered = sorted(found.front, key=lambda each: tuple(places([each])[0]))
    links = [f"#{pages.get(each.case.hash, each.case.hash)}" for each in ordered]
    first, *others = [(each.number.words, each.number.quantity) for each in objectives]
    labels = [(others or [("design", Quantity("", "", ""))])[0], first]
    known = places([each for each in search.designs if each.is_feasible])
    figure = front_figure(
        known, places(ordered), places([search.given] if search.given.numbers else []), labels, links
    )
    made = picture(figure, "Designs that keep all limits; a click on one of the best shows its gear")
    within_page = re.sub(r'href="#[0-9a-f]{8}(part-|[0-9a-f]{16}")', r'href="#\1', made.svg)
    return replace(made, svg=within_page.replace(' target="_blank"', ""))


def _data(found: Optimisation) -> dict[str, Any]:
    search, problem = found.search, found.search.problem

    def as_dict(design: Design) -> dict[str, Any]:
        fresh = {model: found.confirmed.get((design.case.hash, model)) for model in MODELS}
        known = {model: asdict(each) for model, each in fresh.items() if each}
        return {
            "hash": design.case.hash,
            "variables": dict(design.case.values),
            "numbers": design.numbers,
            "fresh": known,
        }

    numbers = [asdict(each) | {"unit": each.quantity.unit} for each in problem.numbers]
    return {
        "folder": str(search.store.path),
        "numbers": numbers,
        "given": as_dict(search.given),
        "front": [as_dict(each) for each in found.front],
        "designs": len(search.designs),
        "feasible": sum(each.is_feasible for each in search.designs),
        "refused": [{"designs": len(each.cases), "cause": each.example} for each in search.refused],
        "at_bounds": found.at_bounds,
    }
