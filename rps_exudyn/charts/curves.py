"""Curves over the pinion angle, with the two directions of a record in colours of their own."""

from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.analysis.passes import Signals, passes
from rps_exudyn.charts import style
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

DIRECTIONS = {+1: ("towards +X", "forward"), -1: ("towards -X", "backward")}
AGAINST_MOTION = "torque against the motion"


def over_angle(axes: Axes, signals: Signals, name: str, axis: str, colour: str, label: str = "") -> None:
    """Draw one signal: a curve in `colour`, or one per pass in the colour of its direction.

    `axis` is the name at the axis, `label` the one in the legend of a record in one direction.
    """
    curves = [(turned.signals, DIRECTIONS[turned.direction][1], "") for turned in passes(signals)]
    if len(curves) < 2:
        curves = [(dict(signals), colour, label)]
    for part, its_colour, its_label in curves:
        angle = SIGNALS["pinion_angle"].displayed(part["pinion_angle"])
        style.line(axes, angle, part[name], SIGNALS[name], axis, its_colour, its_label or None)


def panels_over_angle(
    result: Result, panels: Mapping[str, tuple[str, str, float, float]]
) -> tuple[Figure, list[Axes]]:
    """A figure of those signals that the result has; a torque in both directions is against its motion.

    `panels` are signal -> name at the axis, colour, height [in], least span shown [display unit].
    """
    shown = {name: panel for name, panel in panels.items() if name in result.signals}
    figure, axes = style.panels([height for _, _, height, _ in shown.values()])
    for panel, (name, (label, colour, _, least)) in zip(axes, shown.items(), strict=True):
        if name == "pinion_torque" and len(passes(result.signals)) > 1:
            torque_against_motion(panel, result.signals)
        else:
            over_angle(panel, result.signals, name, label, colour)
        style.widen(panel, least)
    style.angle_axis(axes[-1])
    return figure, axes


def torque_against_motion(axes: Axes, signals: Signals) -> None:
    """Draw both directions of the torque on one side of zero, where their ripples can be compared."""
    quantity = SIGNALS["pinion_torque"]
    for turned in passes(signals):
        angle = SIGNALS["pinion_angle"].displayed(turned.angle)
        torque = turned.direction * turned.signals["pinion_torque"]
        style.line(axes, angle, torque, quantity, AGAINST_MOTION, DIRECTIONS[turned.direction][1])
    style.name_directions(axes, {colour: label for label, colour in DIRECTIONS.values()})


def add_measured(axes: Axes, measured: MeasuredTorque, against_motion: bool = False) -> None:
    """Draw a measured torque over the others, in thin lines because it may have many points."""
    for i, turned in enumerate(passes(measured.signals)):
        angle = SIGNALS["pinion_angle"].displayed(turned.angle)
        torque = (turned.direction if against_motion else 1) * turned.signals["pinion_torque"]
        axes.plot(
            angle,
            SIGNALS["pinion_torque"].displayed(torque),
            color=style.COLOURS["measured"],
            linewidth=0.9,
            linestyle="-" if turned.direction > 0 else (0, (4, 1.5)),
            label=f"measured: {measured.name}" if i == 0 else None,
        )
