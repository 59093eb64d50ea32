"""The HTML page about speed and accuracy: scene by scene, then what limits accuracy besides numerics."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks.accuracy_speed.chart import (
    law_band_figure,
    scaling_figure,
    unfinished,
    work_precision_figure,
)
from benchmarks.accuracy_speed.tables import LAW_HEAD, LIMITS, SCALING_HEAD, law_rows, scaling_rows
from benchmarks.topic import load_data
from rps_exudyn.base.atomic import replacing
from rps_exudyn.report.blocks import (
    Article,
    Block,
    Code,
    Fold,
    Grid,
    Picture,
    Pictures,
    Section,
    Text,
    Warning,
)
from rps_exudyn.report.common import provenance_facts
from rps_exudyn.report.html import page
from rps_exudyn.report.pictures import picture
from rps_exudyn.scenes import SCENE_NAMES, scene_named
from rps_exudyn.verification.measurement import FAMILIES, Measurement, Order, Point, load_measurement
from rps_exudyn.verification.work_precision import pareto_front

COLUMNS = (
    "family",
    "settings",
    "error %",
    "of the mean %",
    "first order %",
    "lift um",
    "CPU ms",
    "steps",
    "Newton iterations",
    "Jacobians",
    "force evaluations",
)
COMMANDS = """python benchmarks/make.py accuracy_speed      # all points, charts, files and this page
python benchmarks/make.py law_and_scaling     # contact law, cost against size
python benchmarks/make.py promise_table       # the table behind --accuracy"""


def write_accuracy_page(folder: Path, out: Path) -> None:
    """Write the page about all measurements in a folder; it names what is missing.

    Raises:
        InputError: a file of the folder is damaged, or `out` cannot be written.
    """
    articles = [_scene_article(scene, folder) for scene in SCENE_NAMES] + [_limits_article(folder)]
    with replacing(out) as partial:
        partial.write_text(page("Speed against accuracy", articles), encoding="utf-8")


def _scene_article(scene: str, folder: Path) -> Article:
    file = folder / f"{scene}.h5"
    if not file.exists():
        missing = "Nothing was measured: python benchmarks/make.py accuracy_speed"
        return Article(
            scene_named(scene).title, "not measured", [Section("Measured points", [Warning(missing)])]
        )
    return scene_article(load_measurement(file))


def scene_article(measurement: Measurement) -> Article:
    """Article about one scene, finished or not."""
    points = measurement.points
    failed = [point for point in points if not point.ok]
    floor = measurement.reference.uncertainty
    return Article(
        title=scene_named(measurement.scene).title,
        lead=f"{len(points)} of {len(measurement.planned)} points measured, {len(failed)} of them failed; "
        f"the reference is known to {floor:.2g} %",
        sections=[
            Section("Cost against error", list(_chart(measurement))),
            Section("The cheapest for each error", list(_fronts(measurement))),
            Section("Failures", list(_failures(failed))),
            Section("Orders of convergence", list(_orders(measurement.orders))),
            Section("Reference", list(_reference(measurement))),
            Section("Measured with", [provenance_facts(measurement.origin), Code(COMMANDS)]),
        ],
    )


def _chart(measurement: Measurement) -> Iterable[Block]:
    if missing := unfinished(measurement):
        yield Warning(f"The study is {missing}.")
    figure = work_precision_figure(measurement)
    yield Pictures([_lean_picture(figure, "Each family's Pareto front is its line; grey: below the floor.")])
    measured = {point.family for point in measurement.points}
    yield Fold(
        "What the families are",
        [Grid(("family", "what it is"), [(n, text) for n, text in FAMILIES.items() if n in measured])],
    )


def _fronts(measurement: Measurement) -> Iterable[Block]:
    sound = [point for point in measurement.points if point.ok and np.isfinite(point.error)]
    if not sound:
        yield Text("No point ended well.")
        return
    floor = measurement.reference.uncertainty
    per = scene_named(measurement.scene).unit_of_cost
    caption = f"Pareto front of all families; time and counters per {per}"
    yield Grid(COLUMNS, [_row(point) for point in front_of(sound, floor)], caption)
    by_family = [_short_row(p) for family in FAMILIES for p in front_of(_of(family, sound), floor)]
    yield Fold("The front of each family", [Grid(("family", "settings", "error %", "CPU ms"), by_family)])
    bush = [point for point in measurement.points if point.study == "bush"]
    if bush:
        condensed = [p for p in _of("flank", sound) if p.study == "flank"]
        condensed = [
            p for p in condensed if p.label in ("step_angle 1 °, strips 3", "step_angle 3 °, strips 3")
        ]
        yield Fold("Segments of the bush", [Grid(COLUMNS, [_row(p) for p in bush + condensed])])


def _of(family: str, points: Sequence[Point]) -> list[Point]:
    return [point for point in points if point.family == family]


def front_of(points: Sequence[Point], floor: float) -> list[Point]:
    """Points that no other beats in both cost and error, cheapest first; below the floor all are alike."""
    error = np.maximum([point.error for point in points], floor)
    best = pareto_front(np.array([point.cost for point in points]), error)
    return sorted((p for p, one in zip(points, best, strict=True) if one), key=lambda point: point.cost)


def _row(point: Point) -> tuple[str, ...]:
    if not point.ok:
        return (point.family, point.label, point.status, *[""] * (len(COLUMNS) - 3))
    return (
        point.family,
        point.label,
        f"{point.error:.2g}",
        f"{point.bias:+.2g}",
        _number(point.first_order, "+.1g"),
        _number(1e6 * point.lift, ".2g"),
        f"{1e3 * point.cost:.3g}",
        *(_number(getattr(point, name), ".4g") for name in _COUNTERS),
    )


def _short_row(point: Point) -> tuple[str, ...]:
    return point.family, point.label, f"{point.error:.2g}", f"{1e3 * point.cost:.3g}"


_COUNTERS = ("steps", "newton_iterations", "jacobians", "force_evaluations")


def _number(value: float, form: str) -> str:
    return format(value, form) if np.isfinite(value) else ""


def _failures(failed: Sequence[Point]) -> Iterable[Block]:
    if not failed:
        yield Text("No point failed.")
        return
    rows = [(p.family, p.label, p.status, p.message, f"{1e3 * p.cost:.3g}") for p in failed]
    yield Grid(("family", "settings", "outcome", "cause", "CPU ms until then"), rows)


def _orders(orders: Sequence[Order]) -> Iterable[Block]:
    if not orders:
        yield Text("None was fitted: the curve jumps, or the points are missing.")
        return
    rows = [
        (
            each.family,
            each.knob,
            each.error,
            f"{each.observed:.2f}" if np.isfinite(each.observed) else "too few above the floor",
            f"{each.expected:g}",
            str(each.points),
            each.why,
        )
        for each in orders
    ]
    yield Grid(("family", "made finer", "error", "observed", "expected", "points", "because"), rows)


def _reference(measurement: Measurement) -> Iterable[Block]:
    yield Text(
        "The largest RMS difference of two methods is the floor. "
        "Points below it claim nothing and are drawn on it."
    )
    rows = [(pair, f"{value:.2g}") for pair, value in measurement.reference.differences.items()]
    yield Grid(("methods", "differ by % of the mean"), rows)


def _lean_picture(figure: Figure, caption: str) -> Picture:
    """Half as large: without the headline, which the page has, without fonts, minor ticks, spaces."""
    figure.suptitle("")
    for axes in figure.axes:
        axes.minorticks_off()
    drawn = picture(figure, caption)
    svg = re.sub(r"font-family: [^;\"]*;? ?", "", drawn.svg)
    svg = re.sub(r">\s+<", "><", svg).replace(" \n", " ")
    return replace(drawn, svg=re.sub(r"<g>(<use [^>]*/>)</g>", r"\1", svg))


# --- what limits accuracy besides ------------------------------------------------------------------
def _limits_article(folder: Path) -> Article:
    title = "Besides numerics"
    if not (folder / LIMITS).exists():
        missing = Warning("Nothing was measured: python benchmarks/make.py law_and_scaling")
        return Article(title, "not measured", [Section("Contact law", [missing])])
    limits = load_data(folder / LIMITS)
    return Article(
        title,
        "what the contact law leaves open, and how cost grows with size",
        [
            Section("Contact law", list(_laws(limits))),
            Section("Cost against size", list(_scaling(limits))),
        ],
    )


def _laws(limits: Any) -> Iterable[Block]:
    torques = {name: np.array(values) for name, values in limits["torques"].items()}
    figure = law_band_figure(np.array(limits["angle"]), torques, limits["default"])
    yield Pictures([_lean_picture(figure, "Free pinion torque over a tooth pitch by every law of contact.")])
    yield Grid(LAW_HEAD, law_rows(limits))
    zones = [(f"{zone:g}", f"{off:+.4f}") for zone, off in limits["zones"]]
    yield Grid(("friction zone over the smallest sliding speed", "mean against the default %"), zones)


def _scaling(limits: Any) -> Iterable[Block]:
    series = {name: (np.array(size), np.array(cost)) for name, (size, cost) in limits["scaling"].items()}
    yield Pictures([_lean_picture(scaling_figure(series), "CPU time over the size of the problem.")])
    yield Grid(SCALING_HEAD, scaling_rows(limits))
