"""Picture of a gear driven by its rack: the force that pushes the rack, and how the rack lifts."""

from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.charts.curves import DIRECTIONS, panels_over_angle
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.result import Result

# signal -> name on the axis, colour, height [in], least span shown [display unit]
_PANELS = {
    "rack_force": ("force on the rack", "torque", 3.2, 1.0),
    "rack_y": ("rack lift", "lift", 1.6, 1.0),
}
FIGURES = {"push_force_mean": "mean", "push_force_peak_to_peak": "peak to peak"}


def rack_push_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, without the lift if the fidelity has none; a measured pinion torque is not drawn."""
    figure, panels = panels_over_angle(result, _PANELS)
    style.name_directions(panels[0].axes, {colour: label for label, colour in DIRECTIONS.values()})
    head(figure, result, scene_of(result), FIGURES)
    return figure
