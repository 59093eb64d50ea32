"""Picture of a yoke impact: force of the yokenut over the whole record, and below it the time of the impacts
alone, with the plunger within its clearance."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.impacts import Impact, find_impacts
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {
    "impacts": "impacts",
    "impact_peak_force": "largest force",
    "impact_impulse": "impulse",
    "impact_speed": "speed",
    "impact_contact_share": "in contact",
}
MILLISECONDS, TIME = 1e3, "time [ms]"
APART = 0.5e-3  # of time without contact between two groups of impacts [s]
MARGIN = 0.15  # of the group, shown before and after it
WIDEST = 0.6  # of the record: a group that fills more needs no closer look


def impact_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured pinion torque is not drawn."""
    window = impacts_shown(result)
    heights = [2.8, 2.2] if window is None else [1.8, 2.6, 2.2]
    figure, axes = style.panels(heights, common_abscissa=window is None)
    time = MILLISECONDS * result["time"]
    for panel in axes[:-1]:
        style.line(panel, time, result["yokenut_force"], SIGNALS["yokenut_force"], "yokenut force", "failure")
    _draw_plunger(axes[-1], time, result)
    style.abscissa(axes[-1], TIME)
    if window is not None:
        _look_closer(axes, window)
    head(figure, result, scene_of(result), FIGURES)
    return figure


def impacts_shown(result: Result) -> tuple[float, float] | None:
    """Return begin and end of the group of impacts with the largest force [ms]; None where there is none, or
    where it fills most of the record."""
    time, force = result["time"], result["yokenut_force"]
    found = find_impacts(time, force, result["plunger_displacement"]) if time.size > 1 else []
    if not found:
        return None
    largest = max(range(len(found)), key=lambda i: found[i].peak_force)
    first = last = largest
    while first > 0 and found[first].start - _end(found[first - 1]) < APART:
        first -= 1
    while last + 1 < len(found) and found[last + 1].start - _end(found[last]) < APART:
        last += 1
    begin, end = found[first].start, _end(found[last])
    if end - begin > WIDEST * np.ptp(time):
        return None
    margin = MARGIN * (end - begin)
    low, high = max(begin - margin, time[0]), min(end + margin, time[-1])
    return MILLISECONDS * float(low), MILLISECONDS * float(high)


def _end(impact: Impact) -> float:
    return impact.start + impact.duration


def _draw_plunger(axes: Axes, time: np.ndarray, result: Result) -> None:
    quantity = SIGNALS["plunger_displacement"]
    style.line(axes, time, result["plunger_displacement"], quantity, "plunger", "lift", "plunger")
    if "rack_y" in result.signals:
        style.line(axes, time, result["rack_y"], SIGNALS["rack_y"], "displacement", "roll", "rack lift")
    axes.axhline(quantity.displayed(result.gear.yoke.clearance), **style.REFERENCE_LINE, label="yokenut")
    style.legend_above(axes)


def _look_closer(axes: list[Axes], window: tuple[float, float]) -> None:
    """Let the first panel keep the whole record with the window shaded, and the others show the window."""
    whole, *close = axes
    style.abscissa(whole, TIME)
    whole.axvspan(*window, **style.BAND)
    for panel in close:
        panel.set_xlim(*window)
    close[0].tick_params(labelbottom=False)
    close[0].set_title("the shaded part", loc="left", fontsize=10)
