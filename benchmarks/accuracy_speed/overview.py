"""What a digit costs and what it is worth: cost against numerical error, beside the other uncertainties.

Cost and error are the measured points of the free pinion torque. An error far below that of the contact law,
or below what is known of the gear, means nothing for the gear.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.accuracy_speed.chart import STYLES, front, in_decades
from benchmarks.accuracy_speed.measurement import Point, load_measurement
from benchmarks.accuracy_speed.tables import cheapest
from benchmarks.topic import Columns, Topic, digits, load_data, save_data, table_of
from rps_exudyn.inference.uncertainty.input_sets import uncertain_inputs
from rps_exudyn.inference.uncertainty.quick_band import quick_band
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import MEASURED

POINTS, DATA, PICTURE = "free-pinion-torque.h5", "overview.json", "overview.png"
SHOWN = {
    "general contact": "full: spheres on triangles, as in the paper",
    "flank, line": "flank: Exudyn, analytic contact",
    "quasi-static, teeth": "equilibria, teeth that bend together",
    "quasi-static, line": "quasi-static: equilibria",
    "closed form": "closed form",
}
"""Family -> its name for a reader, in the order of their costs."""

INPUTS = {"series": "inputs of a series", "unknown": "inputs unknown"}
WANTED = (10.0, 3.0, 1.0, 0.1, 0.01)  # [%]


def run(folder: Path, runs: int = 64) -> None:
    """Find the uncertainties of the mean free torque; draw them with the measured points, if any."""
    found = uncertainties(runs)
    rows = []
    if (folder / POINTS).exists():
        points = [point for point in load_measurement(folder / POINTS).points if point.ok]
        style.save(overview_figure(points, found), folder / PICTURE)
        best = {wanted: cheapest(points, SHOWN, wanted) for wanted in WANTED}
        rows = [
            {"wanted": wanted, "family": point.family, "error": point.error, "cost": point.cost}
            for wanted, point in best.items()
            if point
        ]
    save_data(folder / DATA, {"uncertainties": found, "cheapest": rows})


def uncertainties(runs: int) -> dict[str, float]:
    """What -> half width of the mean free torque's uncertainty [%]: contact laws and inputs, 5 to 95 %."""
    laws = {f"contact law {name}": 100 * MEASURED[name].largest for name in ("teeth", "line")}
    return laws | {INPUTS[name]: 100 * half_width(name, runs) for name in INPUTS}


def half_width(inputs: str, runs: int) -> float:
    """Half width of the band over the mean torque's median."""
    gear = SteeringGear()
    drawn = uncertain_inputs(gear, inputs, {})
    mean = quick_band(gear, Fidelity.preset("quasi-static"), drawn, runs).metrics["torque_mean"]
    return mean.half_width / mean.median


def overview_figure(points: Iterable[Point], uncertain: Mapping[str, float]) -> Figure:
    """Fronts of a few families in plain words, and a line at each uncertainty [%]."""
    figure, (axes,) = style.panels([4.8], 9.0)
    in_decades(axes)
    every = [point for point in points if np.isfinite(point.error)]
    for family, name in SHOWN.items():
        colour, marker = STYLES[family]
        best = front([point for point in every if point.family == family])
        axes.plot(*best, marker + "-", color=colour, markersize=6, label=name)
    _mark(axes, uncertain)
    axes.set_xlim(0.001, 100)
    axes.set_xlabel("numerical error of the torque, RMS over the motion [% of the mean]")
    axes.set_ylabel("CPU time of the solver [s per revolution]")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, frameon=False)
    style.title(figure, "Free pinion torque: what a digit costs, and what it is worth")
    return figure


def _mark(axes: Axes, uncertain: Mapping[str, float]) -> None:
    """Draw a line at each uncertainty; what lies left of it is lost in it."""
    for name, percent in uncertain.items():
        axes.axvline(percent, **style.REFERENCE_LINE)
        place: Any = {"xytext": (3, 0), "xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
        look: Any = {"rotation": 90, "ha": "left", "va": "center", "fontsize": 9, "color": "#444444"}
        axes.annotate(f"{name}: {digits(percent)} %", (percent, 0.45), **place, **look)


def worth_table(folder: Path) -> str:
    """What each digit costs, and in which uncertainties it is lost."""
    data = load_data(folder / DATA)

    def larger(row: Mapping[str, float]) -> str:
        return ", ".join(name for name, size in data["uncertainties"].items() if size > row["wanted"]) or "-"

    columns: Columns = {
        "numerical error": "{wanted:g} %",
        "cheapest model": lambda row: SHOWN[row["family"]],
        "CPU time per revolution": lambda row: f"{digits(1e3 * row['cost'])} ms",
        "lost in": larger,
    }
    return table_of(data["cheapest"], columns)


TOPIC = Topic("5 s", "accuracy_speed", run, {"runs": 12}, {"digits_worth": worth_table})
