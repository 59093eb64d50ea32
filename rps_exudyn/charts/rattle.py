"""Picture of a rattling gear: forces of road and yokenut over time, below them the plunger and the rack."""

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.analysis.rattle import split_at_repeats
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {
    "rattle_force_rms": "force RMS",
    "rattle_speed_rms": "impact speed RMS",
    "rattle_impulse_per_cycle": "impulse per cycle",
    "rattle_impacts_per_cycle": "impacts per cycle",
}
MILLISECONDS = 1e3
CURVES = {"plunger_displacement": ("plunger", "lift"), "rack_y": ("rack lift", "roll")}


def rattle_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture of the first run; a measured pinion torque is not drawn."""
    figure, axes = style.panels([1.6, 2.6, 2.2])
    signals = next(iter(split_at_repeats(result.signals)), result.signals)
    time = MILLISECONDS * signals.get("time", np.zeros(0))
    for panel, name, label, colour in (
        (axes[0], "road_force", "road force", "torque"),
        (axes[1], "yokenut_force", "yokenut force", "failure"),
    ):
        if name in signals:
            style.line(panel, time, signals[name], SIGNALS[name], label, colour)
    for name, (label, colour) in CURVES.items():
        if name in signals:
            style.line(axes[2], time, signals[name], SIGNALS["rack_y"], "displacement", colour, label)
    clearance = SIGNALS["plunger_displacement"].displayed(result.gear.yoke.clearance)
    axes[2].axhline(clearance, **style.REFERENCE_LINE, label="yokenut")
    style.legend_above(axes[2])
    style.abscissa(axes[-1], "time [ms]")
    head(figure, result, scene_of(result), FIGURES)
    return figure
