"""Picture of a yoke impact: force of the yokenut over time, below it the plunger within its clearance."""

from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {
    "impacts": "impacts",
    "impact_peak_force": "largest force",
    "impact_impulse": "impulse",
    "impact_speed": "speed",
    "impact_contact_share": "in contact",
}
MILLISECONDS = 1e3


def impact_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured pinion torque is not drawn."""
    figure, axes = style.panels([2.8, 2.2])
    time = MILLISECONDS * result["time"]
    style.line(axes[0], time, result["yokenut_force"], SIGNALS["yokenut_force"], "yokenut force", "failure")
    quantity = SIGNALS["plunger_displacement"]
    style.line(axes[1], time, result["plunger_displacement"], quantity, "plunger", "lift", "plunger")
    if "rack_y" in result.signals:
        style.line(axes[1], time, result["rack_y"], SIGNALS["rack_y"], "displacement", "roll", "rack lift")
    clearance = quantity.displayed(result.gear.yoke.clearance)
    axes[1].axhline(clearance, **style.REFERENCE_LINE, label="yokenut")
    style.legend_above(axes[1])
    style.abscissa(axes[-1], "time [ms]")
    head(figure, result, scene_of(result), FIGURES)
    return figure
