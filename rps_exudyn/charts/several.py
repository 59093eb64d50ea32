"""Picture of several results' torques over the pinion angle, named in the legend."""

from typing import Any

from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import passes
from rps_exudyn.charts import style
from rps_exudyn.charts.curves import AGAINST_MOTION, add_measured
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (3, 1.5)), (0, (1, 1)), (0, (6, 2, 1, 2)), "-")
"""Line styles, so that curves that lie over each other can be distinguished."""


def torques_figure(
    results: dict[str, Result], headline: str, measured: MeasuredTorque | None = None
) -> Figure:
    """The picture of the first pass of each result (by its name); at most as many as there are colours."""
    figure, (axes,) = style.panels([3.8])
    for (name, result), colour, dashes in zip(results.items(), style.SEVERAL, DASHES, strict=False):
        turned = passes(result.signals)[0]
        torque = turned.direction * turned.signals["pinion_torque"]
        axes.plot(
            SIGNALS["pinion_angle"].displayed(turned.angle),
            SIGNALS["pinion_torque"].displayed(torque),
            color=colour,
            linewidth=1.4,
            linestyle=dashes,
            label=name,
        )
    axes.set_ylabel(SIGNALS["pinion_torque"].axis_label(AGAINST_MOTION))
    if measured is not None:
        first = next(iter(results.values()))
        add_measured(axes, measured, first.signals, against_motion=True)
    style.legend_above(axes)
    style.angle_axis(axes)
    style.title(figure, headline)
    return figure
