"""Picture of reversals: the loop of torque over angle, below it how the rack stays behind."""

from matplotlib.figure import Figure

from rps_exudyn.analysis.rack_motion import transmission_error
from rps_exudyn.charts import style
from rps_exudyn.charts.curves import add_measured
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {
    "hysteresis_area": "loop",
    "torque_jump": "jump",
    "reversal_angle": "running again after",
    "lost_motion": "lost motion",
}
LEAD = SIGNALS["rack_y"]  # of its unit: a deflection


def reversal_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; the rack's lead is its displacement beyond gain times pinion angle, from its mean."""
    figure, axes = style.panels([3.8, 2.0])
    angle = SIGNALS["pinion_angle"].displayed(result["pinion_angle"])
    style.line(axes[0], angle, result["pinion_torque"], SIGNALS["pinion_torque"], "pinion torque", "torque")
    axes[0].axhline(0, color="black", linewidth=0.8)
    lead = transmission_error(result.signals, GearPair.of(result.gear).gain)
    style.line(axes[1], angle, lead, LEAD, "rack's lead", "lift")
    if measured is not None:
        add_measured(axes[0], measured, result.signals)
    style.legend_above(axes[0])
    style.angle_axis(axes[-1])
    head(figure, result, scene_of(result), FIGURES)
    return figure
