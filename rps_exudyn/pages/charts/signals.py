"""Picture of the signals of any scene: all of one result, or the same ones of several results.

The abscissa is the pinion angle if it runs one way, else time. A signal that stands still or is a straight
line gets no panel.
"""

from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.result_comparison import turns_one_way
from rps_exudyn.base.units import words
from rps_exudyn.pages.charts import style
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

WIDTH, FIRST_HEIGHT, HEIGHT = 5.2, 2.2, 1.5  # [in]; readable on a phone
COLOURS = ("torque", "other", "lift", "roll", "failure", "reference")
MOST_TOGETHER, MOST_PANELS = len(COLOURS), 3
STRAIGHT = 0.01  # a curve is straight if it deviates from a line by less than this fraction of its span
STILL = 1e-6  # a signal stands still if its span is less than this fraction of it

_SMALL_LEGEND: Any = {"columnspacing": 1, "handlelength": 1, "borderpad": 0, "frameon": False, "fontsize": 9}

Panel = Sequence[tuple[str, np.ndarray, np.ndarray, str, str]]  # signal, abscissa, values, colour, label


def signals_figure(result: Result) -> Figure | None:
    """The picture of a result's curved signals, those of one kind in one panel; None if there are none."""
    over = abscissa([result])
    panels = [
        [
            (name, result[over], result[name], colour, label)
            for colour, name, label in zip(COLOURS, group, _labels(group), strict=False)
        ]
        for group in _of_one_kind(curved_signals(result, over))
    ]
    return _drawn(panels, over) if panels else None


def overlaid_figure(results: Mapping[str, Result]) -> Figure | None:
    """The picture of the first curved signals of several results, by their labels; None without any."""
    recorded = {label: result for label, result in results.items() if result.signals}
    over = abscissa(list(recorded.values()))
    curved = {name for result in recorded.values() for name in curved_signals(result, over)}
    panels = [
        [
            (name, result[over], result[name], colour, label)
            for colour, (label, result) in zip(COLOURS, recorded.items(), strict=False)
            if name in result.signals
        ]
        for name in [name for name in SIGNALS if name in curved][:MOST_PANELS]
    ]
    return _drawn(panels, over) if panels else None


def abscissa(results: Sequence[Result]) -> str:
    """The name of the signal over which all results are drawn."""
    return "pinion_angle" if results and all(turns_one_way(result) for result in results) else "time"


def curved_signals(result: Result, over: str) -> list[str]:
    """Names of the signals, except works, that are no straight line over `over`, in order of declaration."""
    return [
        name
        for name in SIGNALS
        if name in result.signals
        and name not in ("time", over)
        and not name.startswith("work_")
        and _is_curved(result[over], result[name])
    ]


def _is_curved(x: np.ndarray, values: np.ndarray) -> bool:
    known = np.isfinite(x) & np.isfinite(values)
    x, values = x[known], values[known]
    if x.size < 3 or np.ptp(x) == 0 or np.ptp(values) <= STILL * np.abs(values).max():
        return False
    line = np.polynomial.Polynomial.fit(x, values, 1)(x)
    return bool(np.abs(values - line).max() > STRAIGHT * np.ptp(values))


def _of_one_kind(names: Sequence[str]) -> list[list[str]]:
    """Groups of names with a common first word and unit, at most as many in each as there are colours."""
    groups: dict[tuple[str, str], list[str]] = {}
    for name in names:
        groups.setdefault((name.split("_")[0], SIGNALS[name].display), []).append(name)
    return [
        group[at : at + MOST_TOGETHER]
        for group in groups.values()
        for at in range(0, len(group), MOST_TOGETHER)
    ]


def _labels(group: Sequence[str]) -> list[str]:
    """The words of each name after those that all have in common."""
    common = len(_common(group))
    return [words(name)[common:].strip() or "total" for name in group] if len(group) > 1 else [""]


def _common(names: Sequence[str]) -> str:
    """The words that all names begin with."""
    columns = zip(*(name.split("_") for name in names), strict=False)
    return " ".join(column[0] for column in takewhile(lambda column: len(set(column)) == 1, columns))


def _drawn(panels: Sequence[Panel], over: str) -> Figure:
    figure, axes = style.panels([FIRST_HEIGHT] + [HEIGHT] * (len(panels) - 1), WIDTH)
    for place, panel in zip(axes, panels, strict=True):
        for name, x, values, colour, label in panel:
            style.line(place, SIGNALS[over].displayed(x), values, SIGNALS[name], "", colour, label)
        names = list(dict.fromkeys(name for name, *_ in panel))
        place.set_ylabel(SIGNALS[names[0]].axis_label("").strip())
        place.set_title(_common(names), loc="left", fontsize=10)  # there is no room for names beside curves
        if any(label for *_, label in panel):
            place.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=MOST_TOGETHER, **_SMALL_LEGEND)
    label_abscissa(axes[-1], over)
    return figure


def label_abscissa(axes: Axes, over: str) -> None:
    """Label the common abscissa, the pinion's angle or the time, and limit it to the data."""
    if over == "pinion_angle":
        style.angle_axis(axes)
    else:
        axes.set_xlabel(SIGNALS["time"].axis_label("time"))
        axes.margins(x=0)
