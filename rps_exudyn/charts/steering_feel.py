"""Picture of steering feel: the loop of torque over the wheel's angle, below it how the pinion lags."""

from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.charts.curves import add_measured
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {
    "feel_area": "loop",
    "feel_running_torque": "running",
    "on_centre_stiffness": "stiffness on centre",
    "feel_angle_hysteresis": "turned about after",
    "breakaway_ratio": "breakaway over running",
    "angle_dead_band": "dead band",
    "torque_dead_band": "dead band of torque",
}
BEHIND = SIGNALS["column_twist"]  # of its unit: an angle


def steering_feel_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured torque over an angle is drawn as one of the wheel."""
    figure, axes = style.panels([3.8, 2.0])
    over = result.signals.get("wheel_angle", result["pinion_angle"])
    angle = SIGNALS["wheel_angle"].displayed(over)
    curves = {
        "column_torque": ("column", "torque"),
        "wheel_torque": ("hand, with inertia", "other"),
    }
    for name, (label, colour) in curves.items():
        if name in result.signals:
            style.line(axes[0], angle, result[name], SIGNALS[name], "torque at the wheel", colour, label)
    axes[0].axhline(0, color="black", linewidth=0.8)
    style.line(axes[1], angle, over - result["pinion_angle"], BEHIND, "pinion behind", "lift")
    if measured is not None:
        add_measured(axes[0], measured, result.signals)
    style.legend_above(axes[0])
    style.angle_axis(axes[-1])
    axes[-1].set_xlabel(SIGNALS["wheel_angle"].axis_label("wheel angle"))
    head(figure, result, scene_of(result), FIGURES)
    return figure
