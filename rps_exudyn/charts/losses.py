"""Picture of the losses: work lost at each place per angle turned, stacked to the torque of the drive."""

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.work_balance import describe_losses, loss_torques
from rps_exudyn.base.errors import InputError
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

CALLED = {"bearing": "bearings", "bush": "bush", "seat": "plunger's seat", "mesh": "teeth"}


def losses_figure(result: Result) -> Figure:
    """The picture of the first pass; the drive's torque is a line over the stack.

    Raises:
        InputError: the record has no pass, or no losses.
    """
    runs = passes(result.signals)
    torques = loss_torques(runs[0].signals) if runs else {}
    if not torques:
        raise InputError("No losses to draw: the result has no record of work over the pinion angle.")
    signals, fractions = runs[0].signals, describe_losses(runs[0].signals)
    figure, (axes,) = style.panels([3.6])
    angle = SIGNALS["pinion_angle"].displayed(runs[0].angle)
    quantity, below = SIGNALS["pinion_torque"], np.zeros_like(angle)
    for place, called in CALLED.items():
        if place not in torques:
            continue
        above = below + quantity.displayed(torques[place])
        label = f"{called} {100 * fractions[f'loss_share_{place}']:.1f} %"
        axes.fill_between(
            angle, below, above, color=style.COLOURS[place], linewidth=0, alpha=0.85, label=label
        )
        below = above
    if "pinion_torque" in signals:
        driving = runs[0].direction * signals["pinion_torque"]
        axes.plot(angle, quantity.displayed(driving), color="black", linewidth=1, label="drive")
    axes.set_ylabel(quantity.axis_label("torque lost"))
    axes.set_ylim(0, None)
    axes.legend(reverse=True, loc="upper left", bbox_to_anchor=(1, 1), frameon=False)  # as the layers lie
    style.angle_axis(axes)
    head(figure, result, "Where the torque goes", {})
    return figure
