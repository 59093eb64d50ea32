"""Picture of a load test: torque that raises the weight and torque that holds it while it is lowered.

The paper's Figure 17. Without losses both curves would lie on the dashed line.
"""

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import passes
from rps_exudyn.charts import style
from rps_exudyn.charts.curves import DIRECTIONS, add_measured
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

DOES = {+1: "raising", -1: "lowering"}
FIGURES = {  # in the headline, where they are efficiencies, from 0 to 100 %
    "efficiency_forward": "efficiency forward",
    "efficiency_reverse": "reverse",
    "efficiency_forward_net": "net forward",
    "efficiency_reverse_net": "net reverse",
}


def load_test_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; the torque in the sense of the pinion angle, below zero where the gear is self-locking."""
    figure, (axes,) = style.panels([3.8])
    load = _load(result)
    raises = -1 if load < 0 else 1
    for turned in passes(result.signals):
        angle = SIGNALS["pinion_angle"].displayed(turned.angle)
        torque, colour = turned.signals["pinion_torque"], DIRECTIONS[turned.direction][1]
        quantity = SIGNALS["pinion_torque"]
        style.line(axes, angle, torque, quantity, "pinion torque", colour, DOES[raises * turned.direction])
    if measured is not None:
        add_measured(axes, measured, result.signals)
    if load and "rack_gain" in result.summary:
        ideal = load * result.summary["rack_gain"] / (2 * np.pi)
        axes.axhline(ideal, **style.REFERENCE_LINE, label="without losses")
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0), high)
    axes.axhline(0, color="black", linewidth=0.8)
    style.legend_above(axes)
    style.angle_axis(axes)
    locking = result.summary.get("torque_reverse", 0.0) < 0
    figures = {name: label for name, label in FIGURES.items() if 0 <= result.summary.get(name, 0.0) <= 1}
    head(figure, result, scene_of(result) + " · self-locking" * locking, figures)
    return figure


def _load(result: Result) -> float:
    """Force on the rack's end towards -X [N]; 0 if it was not recorded."""
    force = result.signals.get("load_force", np.zeros(0))
    return float(np.median(force)) if force.size else 0.0
