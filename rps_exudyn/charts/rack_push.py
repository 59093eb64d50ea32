"""Picture of a gear driven by its rack: the force that pushes the rack, and how the rack lifts."""

from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.charts import style
from rps_exudyn.charts.curves import DIRECTIONS, over_angle
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.result import Result


def rack_push_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured pinion torque has no place in it."""
    figure, axes = style.panels([3.2, 1.6])
    over_angle(axes[0], result.signals, "rack_force", "force on the rack", "torque")
    over_angle(axes[1], result.signals, "rack_y", "rack lift", "lift")
    style.widen(axes[1], 1.0)
    style.name_directions(axes[0], {colour: label for label, colour in DIRECTIONS.values()})
    style.angle_axis(axes[-1])
    head(figure, result, scene_of(result), {})
    return figure
