"""Picture of the rack's lift over the torque on the pinion, the rack held."""

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {"rack_lift": "lift", "rack_lift_end": "at the rack's end"}
CURVES = {
    "rack_y": ("rack at the pitch point", "lift"),
    "rack_end_y": ("rack's end", "torque"),
    "plunger_displacement": ("plunger", "roll"),
}


def lift_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, each curve from where it is without torque; a measured pinion torque is not drawn."""
    figure, (axes,) = style.panels([3.6])
    torque = result.signals.get("pinion_torque", np.zeros(0))
    for name, (label, colour) in CURVES.items():
        place = result.signals.get(name)
        if torque.size and place is not None:
            moved = place - place[0]
            style.line(axes, torque, moved, SIGNALS["rack_y"], "displacement from rest", colour, label)
    clearance = SIGNALS["rack_y"].displayed(result.gear.yoke.clearance)
    axes.axhline(clearance, **style.REFERENCE_LINE, label="yoke clearance")
    style.legend_above(axes)
    style.abscissa(axes, SIGNALS["pinion_torque"].axis_label("torque on the pinion"))
    head(figure, result, scene_of(result), FIGURES)
    return figure
