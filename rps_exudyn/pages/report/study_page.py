"""The page about a study of any scene and design, also a half-finished one."""

import itertools
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of
from rps_exudyn.base.units import words
from rps_exudyn.pages.charts.signals import overlaid_figure
from rps_exudyn.pages.report.effects_charts import (
    WIDTH,
    distribution_figure,
    label_of,
    main_effect_figure,
    scattered_figure,
    surface_figure,
)
from rps_exudyn.pages.report.html import (
    fidelity_facts,
    gear_facts,
    parameter_grid,
    part_of,
    provenance_facts,
)
from rps_exudyn.pages.report.pictures import WIDTHS, picture
from rps_exudyn.pages.report.study_rows import count, ranked, study_rows
from rps_exudyn.pages.report.study_sections import (
    MOST_ROWS,
    band_sections,
    case_id,
    case_link,
    curve_id,
    curves_of_cases,
    failed_blocks,
    remarks_section,
    settings,
)
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.names import GEAR_FACTS, named
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.rounding import rounded, shown_with_bar
from rps_exudyn.results.sheet import (
    Block,
    Cell,
    CodeText,
    Facts,
    Fold,
    Grid,
    Link,
    Links,
    Picture,
    Pictures,
    Section,
    Share,
    Shares,
    Sheet,
    Text,
    Warning,
)
from rps_exudyn.study import sensitivity
from rps_exudyn.study.definition import GRID_DESIGN, Axis, axis_quantity
from rps_exudyn.study.effects import MainEffect, grid_effect, sampled_effect, surface
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import PENDING, CaseTable, show_value

OPEN, LEADING = 2, 3  # numbers whose folds are open; with their best and worst cases
WITH_PICTURES = 6  # numbers whose effects are drawn, too
MOST_SURFACES = 3  # for each of them, over the axes with the largest effects
MOST_BARS = 6
MOST_VALUES = 8  # of an axis, written out


def study_page(store: Store) -> Sheet:
    """Everything about the study in a folder."""
    table = CaseTable.of(store)
    description, failed, gear = table.description, len(list(table.failed())), None
    with suppress(InputError):  # what is set for all cases is no gear by itself
        gear = SteeringGear().replace(dict(description.base))
    return Sheet(
        title=description.title or description.name,
        lead=f"{description.scene} · fidelity {description.fidelity.get('name', '')} · {_progress(table)}",
        rows=list(study_rows(table)),
        gear=gear,
        sections=[
            *_unfinished(table),
            Section("Main effects and response surfaces", list(_effects(table))),
            *band_sections(table, ranked(table)),
            *_sensitivity(table),
            *remarks_section(table),
            Section("Failed cases", list(failed_blocks(table)), is_folded=not (failed or table.skipped)),
            Section("Best and worst cases", list(_extremes(table, store)), is_folded=True),
            Section("Outcome", list(_outcome(table)), is_folded=True),
            Section("What was run", list(_what(table)), is_folded=True),
            Section("All cases", list(_all_cases(table, store)), is_folded=True),
            Section("Provenance", list(_provenance(table)), is_folded=True),
        ],
    )


def _shares(effects: Sequence[tuple[Axis, MainEffect]]) -> Shares:
    """Bars of the share of the variance that each factor explains, the largest first."""
    known = [(axis, effect.fraction) for axis, effect in effects if np.isfinite(effect.fraction)]
    known = sorted(known, key=lambda pair: -pair[1])[:MOST_BARS]
    bars = [
        Share(part_of(axis.paths), named(axis.name), 100 * min(max(part, 0.0), 1.0), f"{part:.0%}")
        for axis, part in known
    ]
    return Shares(bars, apart=True)


def _progress(table: CaseTable) -> str:
    parts = [f"{number} {status}" for status, number in Counter(table.status.tolist()).items()]
    return f"{count(len(table.cases), 'case')}: {', '.join(parts)}" if parts else "no cases"


def _unfinished(table: CaseTable) -> Iterable[Section]:
    """What is missing, at the head of the page."""
    warnings = []
    if pending := int((table.status == PENDING).sum()):
        warnings.append(
            f"Not finished: {pending} of {len(table.cases)} cases are still to run. The page shows the "
            "others; the same command continues where it stopped."
        )
    if table.skipped:
        warnings.append(
            f"{len(table.skipped)} files could not be read and count as missing; see Failed cases."
        )
    if warnings:
        yield Section("", [Warning(text) for text in warnings])


def _what(table: CaseTable) -> Iterable[Block]:
    description = table.description
    facts = [
        ("study", description.name),
        ("scene", description.scene),
        ("fidelity", str(description.fidelity.get("name", ""))),
        ("design", description.design),
        ("seed", "" if description.design == GRID_DESIGN else str(description.seed)),
        ("cases", _progress(table)),
        ("signals kept", _kept(table)),
        ("CPU time", _times(table)),
    ]
    yield Facts([(name, text) for name, text in facts if text])
    default = SteeringGear()
    varied = {path for axis in description.axes for path in (*axis.paths, *axis.along)}
    fixed = {
        path: description.base.get(path, default.value_at(path)) for path in GEAR_FACTS if path not in varied
    }
    yield Fold("Parameters that are not varied", [gear_facts(fixed)], is_open=True)
    rows = [
        [
            axis.name,
            ", ".join([*axis.paths, *axis.along]),
            _values(table, axis),
            axis_quantity(axis).long_name,
        ]
        for axis in description.axes
    ]
    yield Grid(("axis", "parameters", "values", "meaning"), rows, "What was varied")
    if description.base:
        yield parameter_grid(description.base, "Set for all cases")
    yield fidelity_facts(description.fidelity)


def _kept(table: CaseTable) -> str:
    keep = table.description.signals
    if keep.signals == ():
        return "none"
    names = "all" if keep.signals is None else ", ".join(keep.signals)
    return f"{names}; at most {keep.samples} samples" if keep.samples else names


def _times(table: CaseTable) -> str:
    seconds = table.times("cpu_s")
    known = seconds[np.isfinite(seconds)]
    return f"{known.sum():.3g} s together, median {np.median(known):.2g} s a case" if known.size else ""


def _values(table: CaseTable, axis: Axis) -> str:
    """The values written out, or their range."""
    if axis.values is None:
        found = table.axes[axis.name]
        low, high = (show_value(axis, found[at].item()) for at in (found.argmin(), found.argmax()))
        kind = axis.distribution.get("kind", "")
        return f"{low} to {high}{', ' if kind else ''}{kind}" if found.size else str(kind)
    if len(axis.values) <= MOST_VALUES:
        return ", ".join(show_value(axis, value) for value in axis.values)
    ends = (show_value(axis, axis.values[at]) for at in (0, -1))
    return f"{' to '.join(ends)}, {len(axis.values)} values"


def _outcome(table: CaseTable) -> Iterable[Block]:
    if not table.numbers:
        yield Text("No case has ended ok yet.")
        return
    rows = []
    for name, values in table.numbers.items():
        known = values[np.isfinite(values)]
        shown = [SUMMARY[name].show(float(at(known))) for at in (np.min, np.median, np.max)]
        rows.append([name, *shown, SUMMARY[name].long_name])
    yield Grid(
        ("quantity", "lowest", "median", "highest", "definition"), rows, "Over the cases that ended ok"
    )


def _effects(table: CaseTable) -> Iterable[Block]:
    names = ranked(table)
    if not names:
        yield Text("All completed cases have equal metrics.")
        return
    is_grid, several = table.description.design == GRID_DESIGN, len(_all_effects(table, names[0])) > 1
    line = (
        "is the mean over the settings of all other axes with a result at each of its points."
        if is_grid
        else "joins the means of classes of equal size."
    )
    bars = " Bars are shares of the variance explained by each factor by itself." if several else ""
    yield Text(f"Dots are cases; the line {line}{bars}")
    more: list[Block] = []
    for place, name in enumerate(names):
        effects = _all_effects(table, name)
        blocks: list[Block] = [Text(f"{SUMMARY[name].long_name}.{_below_bars(table, name, effects)}")]
        if len(effects) > 1:
            blocks.append(_shares(effects))
        if place < WITH_PICTURES:
            blocks.append(Pictures([*_effect_pictures(table, name), *_surfaces(table, name)]))
        rows = [_effect_row(axis, effect, name) for axis, effect in effects]
        blocks.append(Grid(("axis", "from", "to", "mean from", "mean to"), rows))
        if place < OPEN:
            yield Fold(label_of(name), blocks, is_open=True)
        else:
            more.append(Fold(words(name), blocks))
    if more:
        yield Fold(f"Effects on {count(len(more), 'other number')}", more)


def _below_bars(table: CaseTable, name: str, effects: Sequence[tuple[Axis, MainEffect]]) -> str:
    """The sentence about effects that are smaller than the cases' error bars."""
    bars = table.errors.get(name, np.empty(0))
    bar = float(np.median(bars[np.isfinite(bars)])) if np.isfinite(bars).any() else 0.0
    small = " and ".join(named(axis.name) for axis, effect in effects if effect.span < bar)
    size = float(np.nanmax(np.abs(table.numbers[name])))
    shown = f"median ± {rounded(SUMMARY[name], bar, like=size)}"
    return f" The cases' error bars ({shown}) are larger than the main effect of {small}." if small else ""


def _effect_pictures(table: CaseTable, name: str) -> Iterable[Picture]:
    if table.description.design != GRID_DESIGN:
        spread = distribution_figure(table.numbers[name], name, SUMMARY[name])
        yield picture(spread, f"{label_of(name)}: distribution")
    effects = _all_effects(table, name)
    alone = len(effects) == 1 and table.description.design == GRID_DESIGN
    for axis, effect in effects:
        for place, width in WIDTHS.items() if alone else [("", WIDTH)]:
            figure = main_effect_figure(axis, effect, name, SUMMARY[name], width)
            drawn = picture(figure, f"{label_of(name)} over {named(axis.name)}")
            yield replace(drawn, place=place)


def _surfaces(table: CaseTable, name: str) -> Iterable[Picture]:
    """Pictures over pairs of the axes with the largest effects, in one scale of colours."""
    effects = sorted(_all_effects(table, name), key=lambda pair: -pair[1].fraction)
    pairs = itertools.combinations([axis for axis, _ in effects], 2)
    shown = list(itertools.islice(pairs, MOST_SURFACES))
    numbers, quantity, figures = table.numbers[name], SUMMARY[name], list[Figure]()
    known = np.isfinite(numbers)
    limited, places = table.limited[known], {axis: each[known] for axis, each in table.axes.items()}
    if table.description.design == GRID_DESIGN:
        surfaces = [surface(table.axes, first.name, second.name, numbers) for first, second in shown]
        means = np.concatenate([np.empty(0), *(each[2].ravel() for each in surfaces)])
        ends = (float(np.nanmin(means)), float(np.nanmax(means))) if np.isfinite(means).any() else (0.0, 1.0)
        for (first, second), each in zip(shown, surfaces, strict=True):
            marks = places[first.name], places[second.name], limited
            figures.append(surface_figure(first, second, each, name, quantity, marks, ends))
    else:
        for first, second in shown:
            points = places[first.name], places[second.name], numbers[known]
            figures.append(scattered_figure(first, second, points, name, quantity, limited))
    captions = [f"{label_of(name)} over {' and '.join(named(axis.name) for axis in pair)}" for pair in shown]
    return [picture(figure, caption) for figure, caption in zip(figures, captions, strict=True)]


def _all_effects(table: CaseTable, name: str) -> list[tuple[Axis, MainEffect]]:
    """Every axis that takes several values, with its effect on a number."""
    axes = [axis for axis in table.description.axes if len(np.unique(table.axes[axis.name])) > 1]
    numbers, limited = table.numbers[name], table.limited
    if table.description.design == GRID_DESIGN:
        return [(axis, grid_effect(table.axes, axis.name, numbers, limited)) for axis in axes]
    return [(axis, sampled_effect(table.axes[axis.name], numbers, limited)) for axis in axes]


def _effect_row(axis: Axis, effect: MainEffect, name: str) -> list[str]:
    """Row from the first level to the last; words, which have no order, from the lowest mean to the
    highest."""
    known = np.flatnonzero(np.isfinite(effect.mean))
    if known.size < 2:
        return [named(axis.name), "", "", "", ""]
    if effect.levels.dtype.kind != "f":
        known = known[np.argsort(effect.mean[known], kind="stable")]
    ends = [known[0], known[-1]]
    levels = [show_value(axis, effect.levels[at].item()) for at in ends]
    means = [SUMMARY[name].show(float(effect.mean[at])) for at in ends]
    return [named(axis.name), *levels, *means]


def _sensitivity(table: CaseTable) -> list[Section]:
    design = table.description.design
    if design not in sensitivity.DESIGNS:
        return []
    kinds = sensitivity.KINDS[design]
    blocks: list[Block] = [Facts(list(kinds.items()))]
    for name in ranked(table):
        try:
            blocks.append(_indices(table, name, list(kinds)))
        except InputError as error:
            blocks.append(Text(" ".join(error.problems)))
            break
    return [Section("Sensitivity indices", blocks)]


def _indices(table: CaseTable, name: str, kinds: Sequence[str]) -> Grid:
    found = sensitivity.indices(table, name)
    show = SUMMARY[name].show if found.design == sensitivity.MORRIS else "{:.3f}".format

    def cell(index: sensitivity.Index) -> str:
        interval = f" ± {show(index.confidence)}" if np.isfinite(index.confidence) else ""
        return f"{show(index.value)}{interval}"

    rows = [[axis, *(cell(row[kind]) for kind in kinds)] for axis, row in found.rows.items()]
    left_out = f", {found.left_out} left out without a result" if found.left_out else ""
    caption = f"{words(name)}: from {found.groups} groups of cases{left_out}; ± is the 95 % interval"
    return Grid(("axis", *kinds), rows, caption)


def _ends(name: str) -> dict[str, str]:
    """The ends of a number from the better to the worse, if that is known: end -> its label."""
    if name.startswith("efficiency"):
        return {"highest": "highest (best)", "median": "median", "lowest": "lowest (worst)"}
    best, worst = (" (best)", " (worst)") if name.startswith("torque") else ("", "")
    return {"lowest": f"lowest{best}", "median": "median", "highest": f"highest{worst}"}


def _extremes(table: CaseTable, store: Store) -> Iterable[Block]:
    names = ranked(table)[:LEADING]
    if not names:
        yield Text("All completed cases have equal metrics.")
    for name in names:
        yield Fold(words(name), list(_extremes_of(table, store, name)), is_open=True)


def _extremes_of(table: CaseTable, store: Store, name: str) -> Iterable[Block]:
    numbers = table.numbers[name]
    order = np.argsort(numbers, kind="stable")[: int(np.isfinite(numbers).sum())]
    places = {"lowest": order[0], "median": order[(len(order) - 1) // 2], "highest": order[-1]}
    rows: list[Sequence[Cell]] = []
    results = {}
    for end, label in _ends(name).items():
        case = table.cases[places[end]]
        rows.append([label, _shown(table, name, places[end]), *settings(table, case), case_link(table, case)])
        try:
            results[end] = store.result(case)
        except InputError as error:
            yield Text(" ".join(error.problems))
    yield Grid(("", name, *table.axes, "case"), rows)
    figure = overlaid_figure(results)
    if figure is None:
        yield Text("No signals were kept of these cases.")
    else:
        yield Pictures([picture(figure, f"Cases with the lowest, median and highest {words(name)}")])


def _shown(table: CaseTable, name: str, at: int) -> str:
    """A number of a case with its error bar; nothing where it is unknown."""
    value, errors = float(table.numbers[name][at]), table.errors.get(name)
    error = None if errors is None else float(errors[at])
    return shown_with_bar(SUMMARY[name], value, error) if np.isfinite(value) else ""


def _all_cases(table: CaseTable, store: Store) -> Iterable[Block]:
    names = (ranked(table) or list(table.numbers))[:LEADING]
    remarked, seen = {case.hash for case, _ in table.remarked()}, set[str]()
    curves, drawn = curves_of_cases(table, store, table.cases[:MOST_ROWS])
    rows: list[Sequence[Cell]] = []
    ids = []
    for at, case in enumerate(table.cases[:MOST_ROWS]):
        shown = [_shown(table, name, at) for name in names]
        status = table.status[at].item() + ", remark" * (case.hash in remarked)
        name: Cell = Links([Link(case.hash, curve_id(table, case))]) if case.hash in drawn else case.hash
        rows.append([*settings(table, case), status, *shown, name])
        ids.append("" if case.hash in seen else case_id(table, case))
        seen.add(case.hash)
    some = f"The first {MOST_ROWS} of {len(table.cases)} cases. " if len(table.cases) > MOST_ROWS else ""
    yield Text(f"{some}Every number of every case: rps-exudyn collect {table.path}")
    if curves:
        yield Pictures(curves)
    yield Fold(count(len(rows), "case"), [Grid((*table.axes, "status", *names, "case"), rows, ids=ids)])


def _provenance(table: CaseTable) -> Iterable[Block]:
    origin = dict(table.description.provenance)
    command = str(origin.pop("command", "")) or f"rps-exudyn study {table.path / 'study.toml'}"
    yield provenance_facts(origin)
    example = next((case.hash for case, ok in zip(table.cases, table.ok, strict=True) if ok), "HASH")
    yield CodeText(
        f"{command}     # the study; what is finished is kept\n"
        f"rps-exudyn rerun {table.path / 'cases' / example}.h5     # one case\n"
        f"rps-exudyn collect {table.path}     # all numbers in one table\n"
        f"rps-exudyn report {table.path}     # this page"
    )
    with suppress(InputError):
        study_file = content_of(table.path / "study.toml").decode(errors="replace")
        yield Fold("Study file", [CodeText(study_file)])
