"""Picture of stick-slip: torque at the wheel over time, below it how fast the pinion turns."""

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS, Quantity
from rps_exudyn.results.result import Result

FIGURES = {
    "stick_share": "sticks",
    "stick_slip_torque": "amplitude",
    "stick_slip_frequency": "frequency",
    "sticking_speed": "predicted up to",
    "breakaway_ratio": "breakaway over running",
}
MILLISECONDS = 1e3
SPEED = Quantity("rad/s", "rad/s", "speed of the pinion")


def stick_slip_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured torque over an angle is not drawn."""
    figure, axes = style.panels([2.6, 2.2])
    name = "column_torque" if "column_torque" in result.signals else "pinion_torque"
    time = MILLISECONDS * result["time"]
    style.line(axes[0], time, result[name], SIGNALS[name], "torque at the wheel", "torque")
    angle = result["pinion_angle"]
    speed = np.gradient(angle, result["time"]) if angle.size > 1 else np.full(angle.size, np.nan)
    style.line(axes[1], time, speed, SPEED, "pinion's speed", "lift")
    wheel = result.gear.test.direction * result.gear.test.speed
    axes[1].axhline(wheel, **style.REFERENCE_LINE, label="wheel")
    style.legend_above(axes[1])
    style.abscissa(axes[-1], "time [ms]")
    head(figure, result, scene_of(result), FIGURES)
    return figure
