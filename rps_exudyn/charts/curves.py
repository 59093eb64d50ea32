"""Signals over the pinion angle, the two directions of a record told apart."""

from matplotlib.axes import Axes

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.analysis.passes import Signals, passes
from rps_exudyn.charts import style
from rps_exudyn.results.quantities import SIGNALS

DIRECTIONS = {+1: ("towards +X", "forward"), -1: ("towards -X", "backward")}
AGAINST_MOTION = "torque against the motion"


def over_angle(axes: Axes, signals: Signals, name: str, axis: str, colour: str, label: str = "") -> None:
    """One signal as recorded: a curve in `colour`, or one per pass in the colour of its direction."""
    runs = passes(signals)
    if len(runs) < 2:
        runs_shown = [(signals, colour, label)]
    else:
        runs_shown = [(turned.signals, DIRECTIONS[turned.direction][1], "") for turned in runs]
    for shown, its_colour, its_label in runs_shown:
        angle = SIGNALS["pinion_angle"].displayed(shown["pinion_angle"])
        style.line(axes, angle, shown[name], SIGNALS[name], axis, its_colour, its_label or None)


def torque_against_motion(axes: Axes, signals: Signals) -> None:
    """Both directions of the torque on one side of zero, so that their ripples can be seen."""
    named = set()
    for turned in passes(signals):
        label, colour = DIRECTIONS[turned.direction]
        angle = SIGNALS["pinion_angle"].displayed(turned.angle)
        torque = turned.direction * turned.signals["pinion_torque"]
        style.line(
            axes,
            angle,
            torque,
            SIGNALS["pinion_torque"],
            AGAINST_MOTION,
            colour,
            None if label in named else label,
        )
        named.add(label)


def add_measured(axes: Axes, measured: MeasuredTorque, against_motion: bool = False) -> None:
    """A measured torque over those that are drawn, as thin as its points are many."""
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
