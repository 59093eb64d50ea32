"""The page about a study of any scene and design, also a half-finished one."""

import itertools
from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress
from functools import partial
from hashlib import sha256

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of
from rps_exudyn.base.units import words
from rps_exudyn.inference.uncertainty.joint import groups_of, read_pairs
from rps_exudyn.inference.uncertainty.statistics import LEVELS, Polynomials, quantiles
from rps_exudyn.pages.charts import signals, style
from rps_exudyn.pages.report import effects_charts as effects
from rps_exudyn.pages.report.effects_charts import label_of
from rps_exudyn.pages.report.html import fidelity_facts, gear_facts, parameter_grid, part_of, provenance_facts
from rps_exudyn.pages.report.pictures import at_widths, picture
from rps_exudyn.pages.report.study_rows import count, ranked, study_rows
from rps_exudyn.parameters.display_names import GEAR_FACTS, named
from rps_exudyn.parameters.gear import CORRELATION, SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.page_blocks import CodeText, Facts, Fold, Picture, Pictures, Share, Shares, Warning
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import rounded, shown_with_bar
from rps_exudyn.results.sheet import Block, Cell, Grid, Link, Links, Section, Sheet, Text
from rps_exudyn.scenes import is_scene, scene_named
from rps_exudyn.study import sensitivity
from rps_exudyn.study.case_progress import Group, groups
from rps_exudyn.study.definition import GRID_DESIGN, UNCERTAIN_DESIGN, Axis, Case, axis_quantity
from rps_exudyn.study.effects import MainEffect, grid_effect, sampled_effect, surface
from rps_exudyn.study.store import Store
from rps_exudyn.study.table import PENDING, CaseTable, show_value

OPEN, LEADING = 2, 3  # numbers whose folds are open; with their best and worst cases
WITH_PICTURES = 6  # numbers whose effects are drawn, too
MOST_SURFACES = 3  # for each of them, over the axes with the largest effects
MOST_BARS = 6
MOST_VALUES = 8  # of an axis, written out
MOST_ROWS = 300  # cases listed one by one
MOST_LINKS, LINK_DIGITS = 40, 3  # cases of one group, and digits of their values
EQUAL = "All completed cases have equal metrics."


def study_page(store: Store) -> Sheet:
    """Everything about the study in a folder."""
    table = CaseTable.of(store)
    description, failed, gear = table.description, len(list(table.failed())), None
    is_uncertain = description.design == UNCERTAIN_DESIGN
    with suppress(InputError):  # what is set for all cases is no gear by itself
        gear = SteeringGear().replace(dict(description.base))
    sections = [
        Section("", list(_unfinished(table))),
        Section("Main effects and response surfaces", list(_effects(table))),
        Section("Bands", list(band_blocks(table, ranked(table))) if is_uncertain else []),
        Section("Sensitivity indices", list(_sensitivity(table))),
        Section("Remarks", list(_remarks(table))),
        Section("Failed cases", list(_failed(table)), is_folded=not (failed or table.skipped)),
        Section("Best and worst cases", list(_extremes(table, store)), is_folded=True),
        Section("Outcome", list(_outcome(table)), is_folded=True),
        Section("What was run", list(_what(table)), is_folded=True),
        Section("All cases", list(_all_cases(table, store)), is_folded=True),
        Section("Provenance", list(_provenance(table)), is_folded=True),
    ]
    return Sheet(
        title=description.title or description.name,
        lead=f"{description.scene} · fidelity {description.fidelity.get('name', '')} · {_progress(table)}",
        rows=list(study_rows(table)),
        gear=gear,
        sections=[each for each in sections if each.blocks],
    )


def _progress(table: CaseTable) -> str:
    parts = [f"{number} {status}" for status, number in Counter(table.status.tolist()).items()]
    return f"{count(len(table.cases), 'case')}: {', '.join(parts)}" if parts else "no cases"


def _unfinished(table: CaseTable) -> Iterable[Block]:
    if pending := int((table.status == PENDING).sum()):
        yield Warning(
            f"Not finished: {pending} of {len(table.cases)} cases are still to run. The page shows the "
            "others; the same command continues where it stopped."
        )
    if files := len(table.skipped):
        yield Warning(f"{files} files could not be read and count as missing; see Failed cases.")


def _what(table: CaseTable) -> Iterable[Block]:
    description, keep, seconds = table.description, table.description.signals, table.times("cpu_s")
    kept = "all" if keep.signals is None else ", ".join(keep.signals) or "none"
    if keep.samples and keep.signals != ():
        kept += f"; at most {keep.samples} samples"
    known = seconds[np.isfinite(seconds)]
    took = f"{known.sum():.3g} s together, median {np.median(known):.2g} s a case" if known.size else ""
    facts = [
        ("study", description.name),
        ("scene", description.scene),
        ("fidelity", str(description.fidelity.get("name", ""))),
        ("design", description.design),
        ("seed", "" if description.design == GRID_DESIGN else str(description.seed)),
        ("cases", _progress(table)),
        ("signals kept", kept),
        ("CPU time", took),
    ]
    yield Facts([(name, text) for name, text in facts if text])
    values = {path: SteeringGear().value_at(path) for path in GEAR_FACTS} | dict(description.base)
    paths = [[*axis.paths, *axis.along] for axis in description.axes]
    for path in itertools.chain(*paths):
        values.pop(path, None)
    yield Fold("Parameters that are not varied", [gear_facts(values)], is_open=True)
    rows = [
        [axis.name, ", ".join(each), _values(table, axis), axis_quantity(axis).long_name]
        for axis, each in zip(description.axes, paths, strict=True)
    ]
    yield Grid(("axis", "parameters", "values", "meaning"), rows, "What was varied")
    if description.base:
        yield parameter_grid(description.base, "Set for all cases")
    yield fidelity_facts(description.fidelity)


def _values(table: CaseTable, axis: Axis) -> str:
    if axis.values is None:
        found, kind = table.axes[axis.name], str(axis.distribution.get("kind", ""))
        if not found.size:
            return kind
        low, high = (show_value(axis, found[at].item()) for at in (found.argmin(), found.argmax()))
        return f"{low} to {high}{', ' if kind else ''}{kind}"
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
    columns = ("quantity", "lowest", "median", "highest", "definition")
    yield Grid(columns, rows, "Over the cases that ended ok")


def _effects(table: CaseTable) -> Iterable[Block]:
    names = ranked(table)
    if not names:
        yield Text(EQUAL)
        return
    several = len(_all_effects(table, names[0])) > 1
    line = (
        "is the mean over the settings of all other axes with a result at each of its points."
        if table.description.design == GRID_DESIGN
        else "joins the means of classes of equal size."
    )
    bars = " Bars are shares of the variance explained by each factor by itself." if several else ""
    yield Text(f"Dots are cases; the line {line}{bars}")
    folds = [_effects_on(table, name, place < WITH_PICTURES) for place, name in enumerate(names)]
    for name, shown in zip(names[:OPEN], folds, strict=False):
        yield Fold(label_of(name), shown, is_open=True)
    if more := [Fold(words(name), shown) for name, shown in zip(names[OPEN:], folds[OPEN:], strict=True)]:
        yield Fold(f"Effects on {count(len(more), 'other number')}", more)


def _effects_on(table: CaseTable, name: str, is_drawn: bool) -> list[Block]:
    """The effects of all axes on a number: their shares, pictures and ends."""
    found = _all_effects(table, name)
    shown: list[Block] = [Text(f"{SUMMARY[name].long_name}.{_below_bars(table, name, found)}")]
    if len(found) > 1:
        known = [(axis, effect.fraction) for axis, effect in found if np.isfinite(effect.fraction)]
        known = sorted(known, key=lambda pair: -pair[1])[:MOST_BARS]
        bars = [
            Share(part_of(axis.paths), named(axis.name), 100 * min(max(part, 0.0), 1.0), f"{part:.0%}")
            for axis, part in known
        ]
        shown.append(Shares(bars, apart=True))
    if is_drawn:
        shown.append(Pictures([*_effect_pictures(table, name), *_surfaces(table, name)]))
    rows = [_effect_row(axis, effect, name) for axis, effect in found]
    return [*shown, Grid(("axis", "from", "to", "mean from", "mean to"), rows)]


def _below_bars(table: CaseTable, name: str, found: Sequence[tuple[Axis, MainEffect]]) -> str:
    """The sentence about effects that are smaller than the cases' error bars."""
    bars = table.errors.get(name, np.empty(0))
    bar = float(np.median(bars[np.isfinite(bars)])) if np.isfinite(bars).any() else 0.0
    small = " and ".join(named(axis.name) for axis, effect in found if effect.span < bar)
    size = float(np.nanmax(np.abs(table.numbers[name])))
    shown = f"median ± {rounded(SUMMARY[name], bar, like=size)}"
    return f" The cases' error bars ({shown}) are larger than the main effect of {small}." if small else ""


def _effect_pictures(table: CaseTable, name: str) -> Iterable[Picture]:
    if table.description.design != GRID_DESIGN:
        spread = effects.distribution_figure(table.numbers[name], name, SUMMARY[name])
        yield picture(spread, f"{label_of(name)}: distribution")
    found = _all_effects(table, name)
    alone = len(found) == 1 and table.description.design == GRID_DESIGN
    for axis, effect in found:
        drawn = partial(effects.main_effect_figure, axis, effect, name, SUMMARY[name])
        caption = f"{label_of(name)} over {named(axis.name)}"
        yield from at_widths(drawn, caption) if alone else [picture(drawn(effects.WIDTH), caption)]


def _surfaces(table: CaseTable, name: str) -> Iterable[Picture]:
    """Pictures over pairs of the axes with the largest effects, in one scale of colours."""
    found = sorted(_all_effects(table, name), key=lambda pair: -pair[1].fraction)
    pairs = itertools.combinations([axis for axis, _ in found], 2)
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
            figures.append(effects.surface_figure(first, second, each, name, quantity, marks, ends))
    else:
        for first, second in shown:
            points = places[first.name], places[second.name], numbers[known]
            figures.append(effects.scattered_figure(first, second, points, name, quantity, limited))
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
        return [named(axis.name), *4 * [""]]
    if effect.levels.dtype.kind != "f":
        known = known[np.argsort(effect.mean[known], kind="stable")]
    ends = [known[0], known[-1]]
    levels = [show_value(axis, effect.levels[at].item()) for at in ends]
    means = [SUMMARY[name].show(float(effect.mean[at])) for at in ends]
    return [named(axis.name), *levels, *means]


def _sensitivity(table: CaseTable) -> Iterable[Block]:
    if (design := table.description.design) not in sensitivity.DESIGNS:
        return
    kinds = sensitivity.KINDS[design]
    yield Facts(list(kinds.items()))
    try:
        yield from (_indices(table, name, list(kinds)) for name in ranked(table))
    except InputError as error:
        yield Text(" ".join(error.problems))


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
    yield from (Fold(words(name), list(_extremes_of(table, store, name)), is_open=True) for name in names)
    if not names:
        yield Text(EQUAL)


def _extremes_of(table: CaseTable, store: Store, name: str) -> Iterable[Block]:
    numbers = table.numbers[name]
    order = np.argsort(numbers, kind="stable")[: int(np.isfinite(numbers).sum())]
    places = {"lowest": order[0], "median": order[(len(order) - 1) // 2], "highest": order[-1]}
    rows: list[Sequence[Cell]] = []
    results = {}
    for end, label in _ends(name).items():
        case = table.cases[places[end]]
        link = Links([Link(case.hash, _row_id(table, case))])
        rows.append([label, _shown(table, name, places[end]), *_settings(table, case), link])
        try:
            results[end] = store.result(case)
        except InputError as error:
            yield Text(" ".join(error.problems))
    yield Grid(("", name, *table.axes, "case"), rows)
    figure = signals.overlaid_figure(results)
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
    curves, drawn = _curves_of_cases(table, store, table.cases[:MOST_ROWS])
    rows: list[Sequence[Cell]] = []
    ids = []
    for at, case in enumerate(table.cases[:MOST_ROWS]):
        shown = [_shown(table, name, at) for name in names]
        status = table.status[at].item() + ", remark" * (case.hash in remarked)
        case_id = _case_id(table, case)
        name: Cell = Links([Link(case.hash, CURVE_OF + case_id)]) if case.hash in drawn else case.hash
        rows.append([*_settings(table, case), status, *shown, name])
        ids.append("" if case.hash in seen else case_id)
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


# --- Cases and their messages, linked with their rows: remarks, and causes of failure


def _case_id(table: CaseTable, case: Case) -> str:
    """The place of a case on its page, among all cases, also those of another folder of the same study."""
    folder = sha256(str(table.path).encode(errors="replace")).hexdigest()[:6]
    return f"{table.description.name}-{folder}-{case.hash}".replace(" ", "-")


def _row_id(table: CaseTable, case: Case) -> str:
    """The place of a case's row; "" of one that is not listed."""
    is_listed = any(case.hash == each.hash for each in table.cases[:MOST_ROWS])
    return _case_id(table, case) if is_listed else ""


def _settings(table: CaseTable, case: Case, digits: int = 6) -> list[str]:
    """The values of the axes as text."""
    return [show_value(axis, case.values[axis.name], digits) for axis in table.description.axes]


def _remarks(table: CaseTable) -> Iterable[Block]:
    rows: list[Sequence[Cell]] = [
        [count(len(each.cases), "case"), each.example, _links(table, each)]
        for each in groups(table.remarked())
    ]
    if not rows:
        return
    limited = int(table.limited.sum())
    if 0 < limited < table.ok.sum():
        yield Warning(
            f"{count(limited, 'case')} of {int(table.ok.sum())} met a limit of the gear, where a contact "
            "opens or closes: numbers have a kink there. Charts show these cases as diamonds; lines and "
            "colours are not carried from one side to the other."
        )
    else:
        yield Text("Completed, with warnings.")
    yield Grid(("how many", "remark of the first", _which(table)), rows)


def _failed(table: CaseTable) -> Iterable[Block]:
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
            [row.message, *_settings(table, case), case.hash] for case, row in failed if row.status is status
        ]
        grid = Grid(("message", *table.axes, "case"), listed[:MOST_ROWS])
        yield Fold(f"{status}: {count(len(listed), 'case')}", [Text(status.remedy), grid], is_open=True)
    if table.skipped:
        files = [[path.name, sentence] for path, sentence in table.skipped]
        yield Grid(("file", "why it could not be read"), files[:MOST_ROWS], "Files left out")
    if not failed and not table.skipped:
        yield Text("None.")


def _which(table: CaseTable) -> str:
    return f"which ({', '.join(table.axes)})"


def _links(table: CaseTable, group: Group) -> Links:
    """Links to the cases as far as they are listed on the page."""
    links = [
        Link(", ".join(_settings(table, case, LINK_DIGITS)), _row_id(table, case))
        for case in group.cases[:MOST_LINKS]
    ]
    more = len(group.cases) - len(links)
    return Links([*links, Link(f"and {more} more", "")] if more else links)


# --- The curves of a study's cases in one picture, each linked with its row in the table of cases

MOST_CURVES, MOST_POINTS = 40, 400
CURVES_HEIGHT, CURVE_OF = 3.0, "curve-of-"  # [in]; begin of the id of a case's curve
BRIGHTEST = 0.85  # of the colour map: brighter curves vanish on white


def _curves_of_cases(
    table: CaseTable, store: Store, listed: Sequence[Case]
) -> tuple[list[Picture], set[str]]:
    """Return the picture of the scene's signal in some of the listed cases, and the hashes of those drawn.

    There is no picture of a scene that is not known, or of cases whose signals were not kept.
    """
    scene = table.description.scene
    if not is_scene(scene):
        return [], set()
    signal = scene_named(scene).signal
    ok = {case.hash for case, good in zip(table.cases, table.ok, strict=True) if good}
    cases = list({case.hash: case for case in listed if case.hash in ok}.values())
    cases = cases[style.thinned(len(cases), MOST_CURVES)]
    results: dict[str, tuple[Case, Result]] = {}
    for case in cases:
        with suppress(InputError):  # a file that has vanished or is damaged by now
            result = store.result(case)
            if signal in result.signals:
                results[", ".join(_settings(table, case, 4)) or case.hash] = case, result
    if not results:
        return [], set()
    over = signals.abscissa([result for _, result in results.values()])
    figure, (axes,) = style.panels([CURVES_HEIGHT], signals.WIDTH)
    colours = mpl.colormaps[effects.COLOUR_MAP](np.linspace(0, BRIGHTEST, len(results)))
    for colour, (label, (_, result)) in zip(colours, results.items(), strict=True):
        some = style.thinned(result[over].size, MOST_POINTS)
        x, y = (SIGNALS[name].displayed(result[name][some]) for name in (over, signal))
        axes.plot(x, y, color=colour, linewidth=1, label=label)
    axes.set_ylabel(SIGNALS[signal].axis_label(words(signal)))
    signals.label_abscissa(axes, over)
    ids = {label: _case_id(table, case) for label, (case, _) in results.items()}
    links = {label: (CURVE_OF + case_id, case_id) for label, case_id in ids.items()}
    caption = f"{words(signal)} of {count(len(results), 'case')}, from the first (dark) to the last (bright)"
    return [picture(figure, caption, links)], {case.hash for case, _ in results.values()}


# --- Bands of a study with the design `uncertain`: quantiles with errors, contributions

LEAST_KNOWN = 8  # cases, for quantiles


def band_blocks(table: CaseTable, names: Sequence[str]) -> Iterable[Block]:
    """The bands of these numbers."""
    failed = sum(status not in (Status.OK, PENDING) for status in table.status)
    if failed:
        of_all = f"{failed} of {len(table.status)} samples"
        yield Warning(f"{of_all} failed and are in no quantile; see Failed cases.")
    head = ("number", *(f"{100 * level:g} %" for level in LEVELS), "error at 5 %", "error at 95 %")
    rows = []
    for name in names:
        known = table.numbers[name][np.isfinite(table.numbers[name])]
        if known.size >= LEAST_KNOWN:
            found, show = quantiles(known, failed), SUMMARY[name].show
            numbers = (*found.values.tolist(), *found.errors[[0, -1]].tolist())
            rows.append([words(name), *map(show, numbers)])
    if not rows:
        yield Text(f"Quantiles need at least {LEAST_KNOWN} cases that ended ok.")
        return
    yield Grid(head, rows, "Quantiles; errors are standard errors, from the number of samples")
    inputs = [name for name, values in table.axes.items() if values.dtype.kind == "f"]
    for name in names:
        yield from _contributions(table, name, inputs)


def _contributions(table: CaseTable, name: str, inputs: list[str]) -> Iterable[Block]:
    """Fractions of the variance; the quantile of a value is its rank among all that were drawn."""
    known = np.isfinite(table.numbers[name])
    if not inputs or not known.any():
        return
    ranks = [np.argsort(np.argsort(table.axes[axis])) for axis in inputs]
    quantile = (np.stack(ranks, axis=1) + 0.5) / len(known)
    groups = groups_of(inputs, read_pairs(table.description.correlation, CORRELATION, []))
    values = {axis: table.axes[axis][known] for axis in inputs}
    shares = Polynomials.at(quantile[known], groups, values).contributions(table.numbers[name][known])
    if shares is None:
        return
    rows = [[axis, f"{share:.0%}", shares.effect_of(axis)] for axis, share in shares.fractions.items()]
    rows.append(["acting together", f"{shares.together:.0%}", ""])
    caption = f"Share of the variance of {words(name)}, each within {shares.error:.0%} by chance"
    yield Fold(
        f"Contributions to {words(name)}", [Grid(("input", "share", "sign or elasticity"), rows, caption)]
    )
