"""Picture of one result: pinion torque over pinion angle, below it how the rack lifts and rolls."""

from pathlib import Path

from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.outcome import Status
from rps_exudyn.quantities import SIGNALS, SUMMARY
from rps_exudyn.result import Result

# signal -> name on the axis, colour, height [in], least span shown [display unit]
_PANELS = {
    "pinion_torque": ("pinion torque", "torque", 3.2, 0.05),
    "rack_y": ("rack lift", "lift", 1.6, 1.0),
    "rack_roll": ("rack roll", "roll", 1.6, 0.1),
}


def draw_torque(result: Result, path: str | Path) -> None:
    """Save the picture of a result that has signals.

    Raises:
        InputError: the file cannot be written.
    """
    style.save(torque_figure(result), path)


def torque_figure(result: Result) -> Figure:
    """The picture; signals that the result's fidelity does not have get no panel."""
    shown = {name: panel for name, panel in _PANELS.items() if name in result.signals}
    figure, axes = style.panels([height for _, _, height, _ in shown.values()])
    angle = SIGNALS["pinion_angle"].displayed(result["pinion_angle"])
    for panel, (name, (label, colour, _, least)) in zip(axes, shown.items(), strict=True):
        style.line(panel, angle, result[name], SIGNALS[name], label, colour)
        style.widen(panel, least)
    if "torque_mean" in result.summary:
        mean = SUMMARY["torque_mean"].displayed(result.summary["torque_mean"])
        axes[0].axhline(mean, **style.REFERENCE_LINE, label="mean")
        style.legend_above(axes[0])
    style.angle_axis(axes[-1])
    style.title(
        figure, _headline(result), "" if result.status is Status.OK else f"{result.status}: {result.message}"
    )
    return figure


def _headline(result: Result) -> str:
    parts = [result.scene.replace("-", " ").capitalize(), f"fidelity {result.fidelity['name']}"]
    for name, label in (("torque_mean", "mean"), ("torque_peak_to_peak", "peak to peak")):
        if name in result.summary:
            parts.append(f"{label} {SUMMARY[name].show(result.summary[name])}")
    return " · ".join(parts)
