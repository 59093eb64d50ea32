"""Work against precision: what each model of a scene costs, and how far its curve is from the reference.

Points at the floor or below it are alike: there the reference's own methods disagree. An unfinished
measurement is drawn with its points, and says what is missing.
"""

from collections import Counter
from collections.abc import Mapping
from itertools import cycle
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter

from benchmarks.accuracy_speed.measurement import PRESET_FAMILIES, Measurement, Point
from benchmarks.topic import digits
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import PRESETS
from rps_exudyn.results.law_error import LawError
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.scenes import scene_named
from verification.work_precision import pareto_front, power_law

STYLES = {
    "general contact": ("#b00020", "s"),
    "flank": ("#0b5394", "o"),
    "flank, bush chain": ("#674ea7", "D"),
    "quasi-static": ("#38761d", "^"),
    "flank, line": ("#073763", "o"),
    "quasi-static, line": ("#274e13", "^"),
    "flank, teeth": ("#3d85c6", "d"),
    "quasi-static, teeth": ("#93c47d", ">"),
    "flank, bending rack": ("#a64d79", "o"),
    "quasi-static, bending rack": ("#741b47", "^"),
    "flank, supported pinion": ("#6aa84f", "o"),
    "quasi-static, supported pinion": ("#b6d7a8", "^"),
    "flank, Stribeck": ("#cc4125", "o"),
    "quasi-static, Stribeck": ("#85200c", "^"),
    "flank, bristles": ("#f1c232", "o"),
    "quasi-static, bristles": ("#bf9000", "^"),
    "flank, four bristles": ("#ffd966", "s"),
    "quasi-static, four bristles": ("#7f6000", "v"),
    "loop over gears, line": ("#134f5c", "*"),
    "spheres at rest": ("#e69138", "P"),
    "quasi-static, triangles": ("#0097a7", "X"),
    "shaped pinion": ("#c27ba0", "h"),
    "meshed pinion": ("#b45f06", "p"),
    "reduced, line": ("#8e7cc3", "v"),
    "closed form": ("#000000", "*"),
}
"""Colour and marker of each family, the same in all figures."""

LINES = "flank, line", "quasi-static, line"
PANELS = {
    "models": ("general contact", "spheres at rest", "quasi-static, triangles", *LINES, "closed form"),
    "contact laws": ("flank", "quasi-static", *LINES, "flank, teeth", "quasi-static, teeth"),
    "friction laws": (*LINES, *(name for name in STYLES if name.endswith(("Stribeck", "bristles")))),
    "bodies that yield, and many gears": tuple(
        name for name in STYLES if name.endswith((" rack", "supported pinion", "gears, line"))
    ),
}
"""Families of a panel each, where a scene has more than six; others stand in tables alone."""

MOST = 6  # families of a panel
WANTED = (1.0, 0.1)  # [%]
DEFAULT_LAW = ", line"  # of the families whose gear has the default contact law


def work_precision_figure(
    measurement: Measurement, whole: Mapping[str, float] = MappingProxyType({})
) -> Figure:
    """Cost upwards, error to the right, both in decades; each family's Pareto front is its line. `whole`:
    preset -> CPU time of a whole default run [s], which stands in the title."""
    panels = panels_of({point.family for point in measurement.points})
    figure, column = style.panels([5.6] if len(panels) == 1 else [3.4] * len(panels), 9.0)
    for axes, (title, families) in zip(column, panels.items(), strict=True):
        _draw_panel(axes, title, measurement, families)
    column[-1].set_xlabel("error, RMS over the motion [% of the mean]")
    name, _, _ = scene_named(measurement.scene).title.partition(":")
    headline = f"{name}: cost of a model against its error"
    if whole:
        runs = ", ".join(f"{preset} {shown_time(seconds)}" for preset, seconds in whole.items())
        headline += f"\nwhole default run in a warm process: {runs}"
    style.title(figure, headline, unfinished(measurement))
    return figure


def shown_time(seconds: float) -> str:
    """A time to two digits, in ms below a second."""
    return f"{digits(1e3 * seconds)} ms" if seconds < 1 else f"{digits(seconds)} s"


def panels_of(families: set[str]) -> dict[str, set[str]]:
    """Return the families of each panel: one of up to six, else those that no other panel shows too."""
    if len(families) <= MOST:
        return {"": families}
    shown = {title: families & {*members} for title, members in PANELS.items()}
    return {
        title: own for title, own in shown.items() if own and not any(own < each for each in shown.values())
    }


def _draw_panel(axes: Axes, title: str, measurement: Measurement, families: set[str]) -> None:
    axes.set_title(title, loc="right")
    in_decades(axes)
    floor = measurement.uncertainty
    points = [point for point in measurement.points if point.family in families]
    drawn = [point for point in points if point.ok and np.isfinite(point.error)]
    for family in STYLES:
        _draw_family(axes, family, [point for point in drawn if point.family == family], floor)
    _mark_defaults(axes, drawn, floor)
    _draw_failures(axes, [point for point in points if not point.ok])
    axes.axvspan(floor / 3, floor, color=style.COLOURS["reference"], alpha=0.25, linewidth=0)
    axes.set_xlim(left=floor / 3)
    place: Any = {"xycoords": ("data", "axes fraction"), "fontsize": 8, "color": "#444444"}
    axes.annotate(f"floor {floor:.2g} %", (floor / 3, 0.01), **place)
    low, high = axes.get_xlim()
    for wanted in WANTED:
        if low <= wanted <= high:
            axes.axvline(wanted, **style.REFERENCE_LINE)
    per = "revolution" if scene_named(measurement.scene).revolutions else "run"
    axes.set_ylabel(f"CPU time of the solver\n[s per {per}]")
    _legend_beside(axes)


def unfinished(measurement: Measurement) -> str:
    """One sentence about planned points that were not measured; empty if all were."""
    missing = Counter(study for study, _ in measurement.missing)
    if not missing:
        return ""
    parts = ", ".join(f"{count} of {study}" for study, count in missing.items())
    total = sum(missing.values())
    return f"unfinished: {total} of {len(measurement.planned)} points are missing ({parts})"


class PlainNumbers(LogFormatter):
    """Numbers without exponents, at the ticks that a logarithmic axis labels."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the label of a tick."""
        return f"{x:g}" if super().__call__(x, pos) else ""


def in_decades(axes: Axes) -> None:
    """Scale both axes by decades, with plain numbers."""
    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(PlainNumbers())
        axis.set_minor_formatter(PlainNumbers(minor_thresholds=(1, 0.4)))


def _legend_beside(axes: Axes) -> None:
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, borderpad=0)


def _draw_family(axes: Axes, family: str, points: list[Point], floor: float) -> None:
    """Draw all points faint, the Pareto front strong and joined."""
    if not points:
        return
    colour, marker = STYLES[family]
    error, cost = np.maximum([point.error for point in points], floor), [point.cost for point in points]
    # as an image, of which a page with hundreds of marks is half as large
    axes.plot(error, cost, marker, color=colour, alpha=0.25, markersize=4, markeredgewidth=0, rasterized=True)
    axes.plot(*front(points, floor), marker + "-", color=colour, markersize=6, label=family)


def front(points: list[Point], floor: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Error [%], at least the floor, and cost [s] of the points that no other beats, by error."""
    error = np.maximum([point.error for point in points], floor)
    cost = np.array([point.cost for point in points])
    best = pareto_front(cost, error)
    order = np.argsort(error[best])
    return error[best][order], cost[best][order]


def _mark_defaults(axes: Axes, points: list[Point], floor: float) -> None:
    """Draw a ring around each unmodified preset."""
    label = "default of a preset"
    for preset in PRESETS:
        alike = [point for point in points if is_default(point, preset)]
        if alike:
            point = max(alike, key=lambda point: point.family.endswith(DEFAULT_LAW))
            error = max(point.error, floor)
            axes.plot(error, point.cost, "o", color="black", fillstyle="none", markersize=12, label=label)
            label = "_"


def is_default(point: Point, preset: str) -> bool:
    """Return whether a point is this unmodified preset, by the default law or the chart's."""
    family = point.family.removesuffix(DEFAULT_LAW)
    return family == PRESET_FAMILIES[preset] and point.fidelity.name == preset


def _draw_failures(axes: Axes, points: list[Point]) -> None:
    """Draw failed points at the right edge, at their cost until they failed."""
    label = "failed"
    for point in points:
        if point.cost > 0:
            colour, _ = STYLES[point.family]
            edge: Any = {"transform": axes.get_yaxis_transform(), "clip_on": False}
            axes.plot(1.0, point.cost, "x", color=colour, label=label, **edge)
            label = "_"


def scaling_figure(measured: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> Figure:
    """Cost over size of each problem, sizes and CPU seconds (n,), with the exponent fitted to them."""
    figure, (axes,) = style.panels([4.6], 9.0)
    in_decades(axes)
    for colour, (name, (size, cost)) in zip(cycle(style.SEVERAL), measured.items(), strict=False):
        power, factor = power_law(size, cost)
        axes.plot(size, cost, "o", color=colour, markersize=5, label=f"{name}: exponent {power:.2f}")
        axes.plot(size, factor * size**power, "-", color=colour, linewidth=1)
    axes.set_xlabel("size: number of what the legend names")
    axes.set_ylabel("CPU time [s]")
    _legend_beside(axes)
    style.title(figure, "Cost against the size of the problem, and the exponents of cost ~ size^p")
    return figure


def law_band_figure(
    angle: np.ndarray, torques: Mapping[str, np.ndarray], default: str, errors: Mapping[str, LawError]
) -> Figure:
    """Torque over the angle [rad] by each law, (n,), and where the error of its mean puts finite elements.

    `default` is the name of the law drawn bold, `errors` are those of the laws that get a band, by name.
    """
    figure, (axes,) = style.panels([4.2], 9.0)
    degrees = SIGNALS["pinion_angle"].displayed(angle)
    quantity = SIGNALS["pinion_torque"]
    for colour, (name, torque) in zip(cycle(style.SEVERAL), torques.items(), strict=False):
        bold = name == default
        axes.plot(
            degrees, torque, color="black" if bold else colour, linewidth=2.2 if bold else 1.2, label=name
        )
        if name in errors:
            low, high = zip(*map(errors[name].elastic_range, torque), strict=True)
            label = f"law {errors[name].law}: error of its mean against finite elements"
            shade = "black" if bold else colour
            axes.fill_between(degrees, low, high, color=shade, alpha=0.15, linewidth=0, label=label)
    axes.set_ylabel(quantity.axis_label("pinion torque"))
    style.angle_axis(axes)
    _legend_beside(axes)
    style.title(figure, "What the contact law itself leaves open")
    return figure
