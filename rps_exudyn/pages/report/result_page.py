"""The page about one result of any scene, and the comparison of several side by side."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import NOTHING_TO_COMPARE, AgainstMeasured, compared_with_own
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError, as_sentence
from rps_exudyn.base.units import short, words
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.inference.uncertainty.band import Band
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.curves import ripple_figure
from rps_exudyn.pages.charts.inference import band_curves
from rps_exudyn.pages.charts.scene_figures import scene_figure
from rps_exudyn.pages.charts.signals import signals_figure
from rps_exudyn.pages.charts.style import about, scene_of
from rps_exudyn.pages.report import html
from rps_exudyn.pages.report.pictures import at_widths, picture
from rps_exudyn.pages.report.result_sheet import (
    REMARK,
    WORK_LOST,
    loss_shares,
    sheet_of,
    shown_effects,
    summary_grid,
)
from rps_exudyn.parameters.display_names import GEAR_FACTS, named
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import error_of_law
from rps_exudyn.results.outcome import Status, sentences
from rps_exudyn.results.page_blocks import (
    CodeText,
    Columns,
    Facts,
    Fold,
    Picture,
    Pictures,
    Share,
    Shares,
    Warning,
)
from rps_exudyn.results.quantities import COUNTERS, GEOMETRY, LABELS, PARTS, SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import rounded, shown_metric
from rps_exudyn.results.sheet import Block, Grid, Row, Section, Sheet, Text
from rps_exudyn.scenes import is_scene, scene_named
from rps_exudyn.scenes.free_pinion_torque import SCENE as FREE_TURNING_SCENE

if TYPE_CHECKING:
    from rps_exudyn.analysis.load_distribution import LoadDistribution


def result_page(result: Result, path: Path, more: Sequence[Section] = (), band: Band | None = None) -> Sheet:
    """The sheet of a result in the file `path`: number, curve, losses, `more`; folded below, everything else.
    The result is the nominal run of the `band` of uncertain inputs."""
    compared = compared_with_own(result)
    sheet = sheet_of(result, compared, band)
    is_free, heading = result.scene == FREE_TURNING_SCENE.name, "Curves"
    if result.signals and is_scene(result.scene):
        heading = words(scene_named(result.scene).signal).capitalize() + " over the pinion's angle" * is_free
    beside = [*_losses(result), *_ripple(result)]
    sections = [
        Section("Outcome", list(_notices(result))),
        Section(heading, list(_curves(result, band))),
        *([Section("", [Columns(beside)])] if len(beside) > 1 else beside),
        *([] if band is None else _scatter(band)),
        *more,
        Section("Details", list(_details(result, compared, path))),
    ]
    return Sheet(
        title=scene_of(result),
        lead=f"{path.name} · {about(result)} · {result.provenance['date'][:10]}",
        rows=[row for row in sheet.rows if row.value not in (REMARK, WORK_LOST)],
        sections=[each for each in sections if each.blocks],
        gear=result.gear,
        result=result,
    )


def gear_page(gear: SteeringGear, path: Path) -> Sheet:
    """The sheet of the gear in the file `path`: sizes, warnings, parameters.

    Raises:
        InputError: a gear that cannot exist.
    """
    report = geometry_report(gear)
    changed, numbers = gear.changes(), report.numbers
    differing = Fold("Parameters that differ from the defaults", [html.parameter_grid(changed)], is_open=True)
    every = {item.path: gear.value_at(item.path) for item in SteeringGear.declared()}
    details = [
        Fold("Geometry", [_sizes(numbers)]),
        Fold("All parameters of gear and test", [html.parameter_grid(every)]),
        Fold("Simulate it", [CodeText(f"rps-exudyn run --gear {path}")]),
    ]
    sections = [
        Section("Warnings", [Warning(text) for text in report.warnings]),
        Section("Details", [differing, *details] if changed else details),
    ]
    return Sheet(
        title="Gear",
        lead=f"{path.name} · {repr(gear).strip('<>').removeprefix('SteeringGear: ')}",
        rows=[Row(GEOMETRY[name].show(numbers[name]), GEOMETRY[name].long_name) for name in HEAD_SIZES],
        sections=[each for each in sections if each.blocks],
        gear=gear,
    )


def side_by_side(results: Mapping[Path, Result]) -> Sheet:
    """The outcomes, numbers and differing parameters of several results, by their files, in one table."""
    names = {path: path.name for path in results}
    if len(set(names.values())) < len(names):
        names = {path: str(path) for path in results}
    messages = [result.message for result in results.values()]
    rows = [
        ["scene", *(result.scene for result in results.values())],
        ["fidelity", *(result.fidelity["name"] for result in results.values())],
        ["status", *(result.status.value for result in results.values())],
        *([["message", *messages]] if any(messages) else []),
    ]
    for name in SUMMARY:
        values = [shown_metric(each, name) if name in each.summary else "" for each in results.values()]
        if any(values):
            rows.append([name, *values])
    settings = {path: result.gear.changes() for path, result in results.items()}
    for parameter in dict.fromkeys(name for changed in settings.values() for name in changed):
        values = [result.gear.value_at(parameter) for result in results.values()]
        if len({repr(value) for value in values}) > 1:
            shown = [html.parameter_grid({parameter: value}).rows[0][1] for value in values]
            rows.append([parameter, *shown])
    grid = Grid(["", *names.values()], rows)
    return Sheet("Results side by side", f"{len(results)} files", sections=[Section("Numbers", [grid])])


Compared = Sequence[AgainstMeasured] | None
QUANTITIES = ("quantity", "value", "definition")
HEAD_SIZES = ("total_contact_ratio", "travel_per_turn", "tip_diameter", "crest_width", "toothed_length")
MOST_SHARES = 6  # inputs that make the band, by name
MOST_EFFECTS = 4  # the same in a cell
DEFLECTIONS = ("rack_y", "rack_roll")


def _notices(result: Result) -> Iterable[Block]:
    if result.status is not Status.OK:
        yield Warning(
            f"The simulation failed ({result.status}): {result.message or 'no message'} "
            f"{result.status.remedy} Do not use its numbers."
        )
    elif result.message:
        yield Grid(("remarks",), [[sentence] for sentence in sentences(result.message)])


def _ripple(result: Result) -> Iterable[Section]:
    if result.scene != FREE_TURNING_SCENE.name or result.status is not Status.OK:
        return
    if (figure := ripple_figure(result)) is not None:
        caption = f"Mean of {result.gear.pinion.teeth} teeth."
        if (law := error_of_law(result)) is not None:
            said = law.ripple.replace("its ripple", f"the ripple by law {law.law}")
            said = said.replace("theirs", "that by finite elements")
            caption += f" {as_sentence(said)}"
        yield Section("Ripple over one tooth", [Pictures([picture(figure, caption)])])


def _losses(result: Result) -> Iterable[Section]:
    if shares := loss_shares(result):
        mean = result.summary.get("torque_mean", 0.0) if result.scene == FREE_TURNING_SCENE.name else 0.0
        torque = SUMMARY["torque_mean"]
        below = {part: f"\n{rounded(torque, share * mean)}" * bool(mean) for part, share in shares.items()}
        parts = [
            Share(part, PARTS[part], 100 * share, f"{100 * share:.0f} %{below[part]}")
            for part, share in shares.items()
        ]
        yield Section("Where the work goes", [Shares(parts)])


def _details(result: Result, compared: Compared, path: Path) -> Iterable[Block]:
    if result.signals and (every := signals_figure(result)) is not None:
        yield Fold("Signals that vary", [Pictures([picture(every, "Signals that vary")])])
    if result.measured is not None:
        found: list[Block] = []
        for each in compared or ():
            found.append(Grid(("quantity", "measured", "simulated"), each.rows, each.heading))
            found.append(Text(as_sentence(each.difference)))
        yield Fold(f"Comparison with {result.measured.name}", found or [Text(NOTHING_TO_COMPARE)])
    if result.summary:
        yield Fold(f"All {len(result.summary)} quantities", [summary_grid(result)])
    else:
        yield Text("It has no numbers.")
    yield Fold("Parameters", list(_parameters(result)))
    if error := error_of_law(result):
        yield Fold("Error of the contact law", [Text(error.sentence)])
    again = f"rps-exudyn rerun {path}     # repeat this run\nrps-exudyn show {path}"
    yield html.make_again(result.provenance, again)


def _scatter(band: Band) -> Iterable[Section]:
    name = scene_named(band.nominal.scene).main_metric
    errors, found = band.drawn.numerical, list[Block]()
    if (shares := band.contributions.get(name)) is not None:
        parts = {**dict(list(shares.fractions.items())[:MOST_SHARES]), "acting together": shares.together}
        bars = [
            Share(html.part_of(path.split(" with ")), named(path), 100 * share, f"{100 * share:.0f} %")
            for path, share in parts.items()
        ]
        found += [Text(f"Shares of the variance of the {LABELS.get(name, name)}"), Shares(bars, apart=True)]
    causes = [f"{count} of the gears failed: {cause}" for cause, count in band.drawn.failures.items()]
    rows = [
        [
            name,
            *(SUMMARY[name].show(float(value)) for value in (each.low, each.median, each.high)),
            SUMMARY[name].show(errors[name].of_sample) if name in errors else "",
        ]
        for name, each in band.metrics.items()
    ]
    grid = Grid(("quantity", "5 %", "median", "95 %", "numerical error"), rows)
    folds = [Fold(f"Quantiles of {len(rows)} quantities", [grid])]
    if band.contributions:
        folds.insert(0, Fold("Inputs that make quantities scatter", [effects_grid(band)]))
    yield Section("Scatter", [*map(Warning, causes), *found, *folds])


def effects_grid(band: Band) -> Grid:
    """The inputs that scatter each metric most; of those that scatter by more than their numerical error."""
    errors = {name: each.of_sample for name, each in band.drawn.numerical.items()}
    rows = [
        [name, shown_effects(each, MOST_EFFECTS), f"{100 * each.together:.0f} %", f"{100 * each.error:.0f} %"]
        for name, each in band.contributions.items()
        if band.metrics[name].half_width > errors.get(name, 0.0)
    ]
    caption = (
        "Shares of the variance; in brackets the sign of the effect, or the elasticity: per cent of the "
        "quantity for a per cent of the input."
    )
    return Grid(("quantity", "inputs", "acting together", "chance"), rows, caption)


def _curves(result: Result, band: Band | None) -> Iterable[Block]:
    if not result.signals:
        yield Text("No signals were kept.")
        return
    pictures = at_widths(lambda width: _scene_figure(result, width, band), _caption(result, band))
    yield Pictures(pictures) if pictures else Text("No curve to draw.")


def _caption(result: Result, band: Band | None) -> str:
    parts = ["Line: this gear"]
    if band is not None:
        parts.append(f"grey: {len(band.drawn.samples)} gears of a series")
    elif error_of_law(result) and result.scene == FREE_TURNING_SCENE.name:
        parts.append("grey: error of the contact law around the mean")
    if result.measured is not None:
        dots = f"dots: {short(result.measured.name, 40)}, filled towards −X"
        parts += [dots, "below, measured − simulated"]
    return as_sentence("; ".join(parts))


def _scene_figure(result: Result, width: float, band: Band | None) -> Figure | None:
    """The scene's own picture, or its band, without the headline, which the page has; None if signals are
    missing."""
    if result.status is not Status.OK or not is_scene(result.scene):
        return None
    if result.scene == FREE_TURNING_SCENE.name:  # deflections are among all signals
        signals = {name: each for name, each in result.signals.items() if name not in DEFLECTIONS}
        result = replace(result, signals=signals)
    try:
        figure = scene_figure(result) if band is None else band_curves(band)
    except (KeyError, IndexError):  # signals that were not kept
        return None
    figure.suptitle("")
    figure.set_size_inches(width, figure.get_size_inches()[1])
    for axes in figure.axes:
        if axes.get_legend_handles_labels()[1]:
            style.name_curves(axes)  # for this width
    return figure


def _parameters(result: Result) -> Iterable[Block]:
    yield html.gear_facts({path: result.gear.value_at(path) for path in GEAR_FACTS})
    if changed := result.gear.changes():
        yield html.parameter_grid(changed, "Parameters that differ from the defaults")
    else:
        yield Text("Every parameter has its default.")
    every = {item.path: result.gear.value_at(item.path) for item in SteeringGear.declared()}
    yield Fold("All parameters of gear and test", [html.parameter_grid(every)])
    yield html.fidelity_facts(result.fidelity)
    settings = [(name, html.as_text(value)) for name, value in result.solver.items()]
    yield Fold("Settings of the solver", [Facts(settings)])
    if result.counters:
        rows = [("CPU time", f"{result.cpu_s:.3g} s"), ("elapsed time", f"{result.wall_s:.3g} s")]
        rows += [(COUNTERS[name].long_name, COUNTERS[name].show(n)) for name, n in result.counters.items()]
        yield Fold("What it took", [Facts(rows)])
    if result.findings:
        found = [(words(name), html.as_text(value)) for name, value in result.findings.items()]
        yield Fold("Findings of the solver", [Facts(found)])
    if result.geometry:
        yield Fold("Geometry", [_sizes(result.geometry)])


def _sizes(values: Mapping[str, float]) -> Grid:
    rows = [[name, GEOMETRY[name].show(value), GEOMETRY[name].long_name] for name, value in values.items()]
    return Grid(QUANTITIES, rows)


# --- The section about the contact of the teeth: loads of the lines, shares of the teeth, contact pattern
#
# It is drawn on request: the contact law is evaluated again at every recorded pose.


def contact_section(result: Result) -> Section:
    """Return the section, or one sentence where the record has no loads of the contact."""
    return Section("Contact of the teeth", list(_contact_blocks(result)))


def _contact_blocks(result: Result) -> Iterator[Block]:
    from rps_exudyn.analysis.load_distribution import load_distribution  # loads the compiled contact
    from rps_exudyn.pages.charts.analyses import FLANK_NAMES, load_figure

    if result.status is not Status.OK:
        yield Text("The simulation failed: its loads are not those of the gear.")
        return
    if (modelled := result.fidelity["mesh"]) not in ("flank", "triangles"):
        yield Text(f"fidelity.mesh is {modelled}; only flank and triangles have places where teeth touch.")
        return
    try:
        yield Pictures([touching_picture(result)])
        if modelled == "triangles":
            return
        yield Pictures([picture(load_figure(result), "Loads on the lines of contact")])
        loads = load_distribution(result.gear, passes(result.signals)[0].signals)
        rows = [_largest_loads(loads, side, name) for side, name in FLANK_NAMES.items()]
        columns = (
            "flanks",
            "normal force",
            "largest load per length",
            "Hertz's pressure",
            "share of one tooth",
        )
        yield Grid(columns, rows)
    except InputError as error:  # no pass, no motions of the rack, or a law without load per length
        yield Text(" ".join(error.problems))


def touching_picture(result: Result) -> Picture:
    """Return the picture of where the teeth touch over a tooth pitch.

    Raises:
        InputError: the record has no pass, lacks the rack's motions, or its law has no load per length.
    """
    from rps_exudyn.pages.animation.surfaces_figure import surfaces_figure
    from rps_exudyn.pages.charts.analyses import pattern_figure

    if result.fidelity["mesh"] == "triangles":
        return picture(surfaces_figure(result), "Where the surfaces touch")
    return picture(pattern_figure(result), "Contact pattern")


def _largest_loads(loads: "LoadDistribution", side: int, name: str) -> list[str]:
    chosen, share = loads.side == side, loads.largest_share(side)
    force = f"{loads.force_on(side).max():.4g} N"
    load = f"{1e-3 * loads.load[chosen].max(initial=0.0):.4g} N/mm"
    pressure = f"{1e-6 * loads.pressure[chosen].max(initial=0.0):.4g} MPa"
    carries = bool(np.isfinite(share).any())
    shared = f"{100 * np.nanmin(share):.3g} to {100 * np.nanmax(share):.3g} %" if carries else ""
    return [name, force, load, pressure, shared]
