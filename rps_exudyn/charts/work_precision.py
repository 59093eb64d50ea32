"""Work against precision: what each model of a scene costs, and how far its curve is from the reference.

A point at the floor or below it says nothing more: there the reference's own methods disagree. An unfinished
study is drawn with what there is, and says what is missing.
"""

from collections import Counter
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.accuracy.measurement import FAMILIES, PRESET_FAMILIES, Measurement, Point
from rps_exudyn.analysis.work_precision import pareto_front
from rps_exudyn.charts import style
from rps_exudyn.fidelity import PRESETS, Fidelity

STYLES = {
    "general contact": ("#b00020", "s"),
    "flank": ("#0b5394", "o"),
    "flank, bush chain": ("#674ea7", "D"),
    "quasi-static": ("#38761d", "^"),
    "generators": ("#6aa84f", "v"),
    "spheres at rest": ("#e69138", "P"),
    "closed form": ("#000000", "*"),
    "ratio": ("#777777", "X"),
}
"""Colour and marker of each family, the same in all figures."""

WANTED = (1.0, 0.1)  # [%]
OF_SCENE = {
    "free-pinion-torque": "Free pinion torque",
    "load-test": "Load test",
    "rack-push": "Rack push: force",
    "reversal": "Reversal",
    "yoke-impact": "Yoke impact: yokenut's force",
}


def draw_work_precision(measurement: Measurement, path: str | Path) -> None:
    """Draw it and write the picture.

    Raises:
        InputError: the file cannot be written.
    """
    style.save(work_precision_figure(measurement), path)


def work_precision_figure(measurement: Measurement) -> Figure:
    """Cost upwards, error to the right, both in decades; each family's Pareto front is its line."""
    figure, (axes,) = style.panels([5.6], 9.0)
    axes.set(xscale="log", yscale="log")
    floor = measurement.reference.uncertainty
    drawn = [point for point in measurement.points if point.ok and np.isfinite(point.rms)]
    for family in FAMILIES:
        _draw_family(axes, family, [point for point in drawn if point.family == family], floor)
    _mark_defaults(axes, drawn, floor)
    _draw_failures(axes, [point for point in measurement.points if not point.ok])
    _draw_floor(axes, floor)
    for wanted in WANTED:
        axes.axvline(wanted, **style.REFERENCE_LINE)
    axes.set_xlabel("error, RMS over the motion [% of the mean]")
    axes.set_ylabel("processor time of the solver [s per revolution]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, borderpad=0)
    headline = f"{OF_SCENE[measurement.scene]}: cost of a model against its error"
    style.title(figure, headline, told_missing(measurement))
    return figure


def told_missing(measurement: Measurement) -> str:
    """One sentence about what was planned and is not there; empty if all is."""
    missing = Counter(study for study, _ in measurement.missing)
    if not missing:
        return ""
    parts = ", ".join(f"{count} of {study}" for study, count in missing.items())
    total = sum(missing.values())
    return f"unfinished: {total} of {len(measurement.planned)} points are missing ({parts})"


def _draw_family(axes: Axes, family: str, points: list[Point], floor: float) -> None:
    """All points faint, the Pareto front strong and joined."""
    if not points:
        return
    colour, marker = STYLES[family]
    error = np.maximum([point.rms for point in points], floor)
    cost = np.array([point.cost for point in points])
    front = pareto_front(cost, error)
    axes.plot(error, cost, marker, color=colour, alpha=0.25, markersize=4, markeredgewidth=0)
    order = np.argsort(error[front])
    axes.plot(error[front][order], cost[front][order], marker + "-", color=colour, markersize=6, label=family)


def _mark_defaults(axes: Axes, points: list[Point], floor: float) -> None:
    """A ring around each preset as it is."""
    label = "default of a preset"
    for preset in PRESETS:
        for point in points:
            if is_default(point, preset):
                error = max(point.rms, floor)
                axes.plot(error, point.cost, "o", color="black", fillstyle="none", markersize=12, label=label)
                label = "_"
                break


def is_default(point: Point, preset: str) -> bool:
    """Whether it is this preset with nothing changed."""
    unchanged = Fidelity.preset(preset)
    named = {"name": unchanged.name}
    return point.family == PRESET_FAMILIES[preset] and point.fidelity.model_copy(update=named) == unchanged


def _draw_failures(axes: Axes, points: list[Point]) -> None:
    """At the right edge, at what they cost until they failed."""
    label = "failed"
    for point in points:
        if point.cost > 0:
            colour, _ = STYLES[point.family]
            axes.plot(
                1.0,
                point.cost,
                "x",
                color=colour,
                transform=axes.get_yaxis_transform(),
                clip_on=False,
                label=label,
            )
            label = "_"


def _draw_floor(axes: Axes, floor: float) -> None:
    axes.axvspan(floor / 3, floor, color=style.COLOURS["reference"], alpha=0.25, linewidth=0)
    axes.set_xlim(left=floor / 3)
    axes.annotate(
        f"floor {floor:.2g} %",
        (floor / 3, 0.01),
        xycoords=("data", "axes fraction"),
        fontsize=8,
        color="#444444",
    )
