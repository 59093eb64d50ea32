"""What an optimisation found, for the terminal, as JSON and as a page: the best, and how far to trust it."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.optimisation.confirmation import MODELS, SEARCHED, Confirmed, finalists
from rps_exudyn.optimisation.definition import NONE, Problem, bounds_of
from rps_exudyn.optimisation.goals import Number
from rps_exudyn.optimisation.search import Design, Search
from rps_exudyn.pages.charts.front import front_figure
from rps_exudyn.pages.report.html import make_again
from rps_exudyn.pages.report.pictures import picture
from rps_exudyn.pages.report.result_page import gear_page
from rps_exudyn.parameters.display_names import named
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.page_blocks import Pictures, Warning
from rps_exudyn.results.provenance import provenance
from rps_exudyn.results.quantities import Quantity
from rps_exudyn.results.rounding import rounded
from rps_exudyn.results.sheet import Block, Grid, Line, Row, Section, Sheet, Text

AT_BOUND = 0.01  # of the range between its bounds, within which a variable is at one of them
NOTHING = "no design keeps all limits"


@dataclass(frozen=True)
class Optimisation:
    """What was found: all designs, and (hash of a design, model) -> its numbers on fresh gears.

    Examples:
        >>> found = rps.optimise("optimise.toml", "found")  # doctest: +SKIP
        >>> found.front[0].gear.pinion.helix_angle  # doctest: +SKIP
        0.52
    """

    search: Search
    confirmed: Mapping[tuple[str, str], Confirmed]

    @property
    def problem(self) -> Problem:
        """What was asked for."""
        return self.search.problem

    @property
    def front(self) -> list[Design]:
        """The best designs, by the first objective; see `Search.front`."""
        return self.search.front

    @property
    def held(self) -> dict[str, str]:
        """Variable -> the bound at which it stands in the best design: the optimum may lie beyond."""
        found = {}
        for axis in self.problem.study.axes if self.front else ():
            low, high = bounds_of(axis)
            place = (float(self.front[0].case.values[axis.name]) - low) / (high - low)
            if min(place, 1 - place) < AT_BOUND:
                end, which = (high, "upper") if place > 0.5 else (low, "lower")
                found[axis.name] = f"{which} bound, {SteeringGear.declared_at(axis.name)[0].show(end)}"
        return found

    def luck(self, design: Design, at: int = 0) -> float:
        """Return by how much fresh gears are worse than the search's in a number, over the search's; nan
        without any."""
        fresh = self.confirmed.get((design.case.hash, SEARCHED))
        return nan if fresh is None else (fresh.values[at] - design.numbers[at]) / abs(design.numbers[at])

    def gain(self, design: Design, model: str, at: int = 0) -> float:
        """Return the relative change of a number from the gear as given to a design, on the same fresh
        gears."""
        pair = [self.confirmed.get((each.case.hash, model)) for each in (self.search.given, design)]
        if None in pair:
            return nan
        before, after = (each.values[at] for each in pair if each)
        return (after - before) / abs(before) if before else nan


def optimisation_sheet(found: Optimisation, command: str) -> Sheet:
    """Return the sheet of an optimisation; `command` makes it again."""
    problem, search = found.problem, found.search
    series = f"{problem.samples} gears, errors {problem.errors}" if problem.errors != NONE else "one gear"
    refused = sum(len(group.cases) for group in search.refused)
    kept = sum(design.is_feasible for design in search.designs)
    rows = [*_best(found)] if found.front else [Row("none", f"{NOTHING}: {_nearest(search)}")]
    rows += [
        Row(
            f"at its {where.partition(',')[0]}",
            f"{named(name)}: {where.partition(', ')[2]}, the optimum may lie beyond",
        )
        for name, where in found.held.items()
    ]
    rows.append(
        Row(
            f"{kept} of {len(search.designs)}",
            f"designs keep all limits; {len(found.front)} of them are on the front",
        )
    )
    if search.refused:
        cause = search.refused[0]
        rows.append(Row(f"{refused} refused", f"{len(cause.cases)} of them: {cause.example}"))
    sections = [
        Section("", [Warning(NOTHING.capitalize() + ".")] if not found.front else []),
        Section("Front", [Pictures([_picture(found)]), _front_grid(found)] if found.front else []),
        Section(
            "Fresh gears and other models",
            [_confirmed_grid(found), Text(_how(problem))] if found.confirmed else [],
        ),
        Section("Refused designs", [_refused_grid(search)] if search.refused else []),
        Section("Details", [make_again(provenance(), command)]),
    ]
    return Sheet(
        title=problem.study.title,
        lead=f"{len(search.designs)} designs of {series} · {search.store.path}",
        rows=rows,
        text=list(_text(found)),
        more="front, confirmed numbers, refused designs",
        data=lambda: _data(found),
        sections=[each for each in sections if each.blocks],
        gear=found.front[0].gear if found.front else None,
    )


def gear_sheets(found: Optimisation) -> list[Sheet]:
    """Return the sheets of the designs that were confirmed, to stand below the first one."""
    return [
        replace(
            gear_page(each.gear, found.search.store.path / _file_of(i)), title=f"Gear {i + 1} of the front"
        )
        for i, each in enumerate(finalists(found.search))
    ]


def _file_of(place: int) -> str:
    return f"gear-{place + 1}.toml"


def gear_files(found: Optimisation) -> dict[Path, SteeringGear]:
    """Return path -> gear of the designs that were confirmed."""
    return {
        found.search.store.path / _file_of(i): each.gear for i, each in enumerate(finalists(found.search))
    }


def _best(found: Optimisation) -> Iterator[Row]:
    """The best by the first objective, by each model on fresh gears."""
    design, number = found.front[0], found.problem.numbers[0]
    for model in MODELS:
        fresh = found.confirmed.get((design.case.hash, model))
        if fresh is None or not isfinite(fresh.values[0]):
            continue
        change = found.gain(design, model)
        words = (
            f"{number.words}: {100 * change:+.0f} % against the gear as given"
            if isfinite(change)
            else number.words
        )
        yield Row(_shown(number, fresh, 0), f"{words}, {fresh.samples} fresh gears, {model}")
    if not found.confirmed:
        yield Row(number.quantity.show(design.numbers[0]), f"{number.words}, in the search; not confirmed")
    if isfinite(luck := found.luck(design)):
        seen = number.quantity.show(design.numbers[0])
        yield Row(
            f"{100 * luck:+.1f} %",
            f"from the search's own number, {seen}, to fresh gears: its luck and its coarser steps",
        )


def _nearest(search: Search) -> str:
    known = [each for each in search.designs if each.numbers]
    if not known:
        return "every one is refused"
    best = min(known, key=lambda each: max(each.excess, default=0.0))
    worst = int(np.argmax(best.excess))
    limit = search.problem.constraints[worst]
    value = best.numbers[len(search.problem.objectives) + worst]
    show = limit.number.quantity.show
    return f"the nearest has {limit.number.words} {show(value)}, {limit.limit.show(limit.number.quantity)}"


def _shown(number: Number, fresh: Confirmed, at: int) -> str:
    """A number with the sum of its sampling error and its numerical bar."""
    value, error = fresh.values[at], fresh.errors[at] + fresh.bars[at]
    return (
        "failed"
        if not isfinite(value)
        else rounded(number.quantity, value, error)
        if error
        else number.quantity.show(value)
    )


def _grid_of(found: Optimisation, designs: Iterable[Design]) -> Iterator[list[str]]:
    for each in designs:
        gear, path = each.gear, SteeringGear.declared_at
        shown = [
            number.quantity.show(value)
            for number, value in zip(found.problem.numbers, each.numbers, strict=True)
        ]
        yield [
            *shown,
            *(path(axis.name)[0].show(gear.value_at(axis.name)) for axis in found.problem.study.axes),
        ]


def _heads(found: Optimisation) -> list[str]:
    return [
        *(number.words for number in found.problem.numbers),
        *(axis.name for axis in found.problem.study.axes),
    ]


def _front_grid(found: Optimisation) -> Grid:
    ids = [each.case.hash for each in found.front]
    return Grid(_heads(found), list(_grid_of(found, found.front)), "The front, in the search", ids)


def _confirmed_grid(found: Optimisation) -> Grid:
    rows = []
    designs = {
        "as given": found.search.given,
        **{_file_of(i): each for i, each in enumerate(finalists(found.search))},
    }
    for name, design in designs.items():
        for model in MODELS:
            if fresh := found.confirmed.get((design.case.hash, model)):
                shown = [_shown(number, fresh, k) for k, number in enumerate(found.problem.numbers)]
                rows.append(
                    [
                        name,
                        model,
                        f"{fresh.samples}, {fresh.failed} failed",
                        *shown,
                        "; ".join(_not_kept(found, fresh)),
                    ]
                )
    return Grid(
        ("gear", "model", "fresh gears", *(number.words for number in found.problem.numbers), "not kept"),
        rows,
    )


def _not_kept(found: Optimisation, fresh: Confirmed) -> Iterator[str]:
    """Limits that fresh numbers miss by more than their errors."""
    for k, each in enumerate(found.problem.constraints, len(found.problem.objectives)):
        error = (
            np.nan_to_num(fresh.errors[k] + fresh.bars[k]) / each.limit.finite if each.limit.finite else 0.0
        )
        if not each.excess(fresh.values[k]) <= error:
            yield each.number.name


def _how(problem: Problem) -> str:
    words = "± is the standard error of the quantile plus the median of the runs' error bars."
    return (
        f"{words} Stresses here have each gear's own face load factor; the search took that of the "
        "gear as given."
        if problem.needs_face_load
        else words
    )


def _refused_grid(search: Search) -> Grid:
    return Grid(
        ("designs", "for instance"), [[str(len(each.cases)), each.example] for each in search.refused]
    )


def _picture(found: Optimisation) -> Any:
    """The front over two objectives; of one objective, the designs in their order."""
    problem, front = found.problem, found.front
    shown = [each.number for each in problem.objectives[:2]]
    known = [each for each in found.search.designs if each.is_feasible]
    order = {each.case.hash: float(i) for i, each in enumerate(found.search.designs)}

    def point(design: Design) -> list[float]:
        first = design.numbers[1] if len(shown) > 1 else order.get(design.case.hash, 0.0)
        return [first, design.numbers[0]]

    links = [f"#{each.case.hash}" for each in front]
    for i, each in enumerate(finalists(found.search)):
        links[front.index(each)] = f"#part-{i + 2}-1"
    over = (shown[1].words, shown[1].quantity) if len(shown) > 1 else ("design", Quantity("", "", ""))
    ordered = sorted(front, key=point)
    clicks = [links[front.index(each)] for each in ordered]
    points, best = (np.array([point(each) for each in some]) for some in (known, ordered))
    labels = [over, (shown[0].words, shown[0].quantity)]
    drawn = front_figure(points, best, np.array(point(found.search.given)), labels, clicks)
    made = picture(drawn, "Designs that keep all limits; a click on one of the best shows the gear")
    return replace(made, svg=re.sub(r'href="#[0-9a-f]{8}((?:part-|[0-9a-f]{16}"))', r'href="#\1', made.svg))


def _text(found: Optimisation) -> Iterator[Block]:
    yield Line(found.problem.study.title, is_bold=True)
    for row in optimisation_rows(found):
        yield Text(row)
    if found.front:
        yield _front_grid(found)
    if found.confirmed:
        yield _confirmed_grid(found)
        yield Text(_how(found.problem))
    if found.search.refused:
        yield _refused_grid(found.search)


def optimisation_rows(found: Optimisation) -> list[str]:
    """Return the bounds that hold the best design, a sentence each."""
    return [
        f"{name} stands at its {where}: the optimum may lie beyond." for name, where in found.held.items()
    ]


def _data(found: Optimisation) -> dict[str, Any]:
    """For JSON, which has no nan."""
    search, numbers = found.search, found.problem.numbers

    def known(values: Iterable[float]) -> list[float | None]:
        return [value if isfinite(value) else None for value in values]

    def as_dict(design: Design) -> dict[str, Any]:
        models = {model: found.confirmed.get((design.case.hash, model)) for model in MODELS}
        fresh = {
            model: {"samples": each.samples, "failed": each.failed, "cause": each.cause}
            | {"values": known(each.values), "errors": known(each.errors), "bars": known(each.bars)}
            for model, each in models.items()
            if each
        }
        return {
            "hash": design.case.hash,
            "variables": dict(design.case.values),
            "numbers": list(design.numbers),
            "fresh": fresh,
        }

    return {
        "folder": str(search.store.path),
        "numbers": [
            {"name": each.name, "of": each.of, "quantile": each.quantile, "unit": each.quantity.unit}
            for each in numbers
        ],
        "given": as_dict(search.given),
        "front": [as_dict(each) for each in found.front],
        "designs": len(search.designs),
        "feasible": sum(each.is_feasible for each in search.designs),
        "refused": [{"designs": len(each.cases), "cause": each.example} for each in search.refused],
        "at_bounds": found.held,
        "luck": known([found.luck(found.front[0])])[0] if found.front else None,
    }
