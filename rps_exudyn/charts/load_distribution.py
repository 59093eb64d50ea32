"""Picture of the loads on the lines of contact: force of each, the densest, stiffness of the mesh."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.load_distribution import LoadDistribution, load_distribution
from rps_exudyn.analysis.mesh_stiffness import mesh_stiffness
from rps_exudyn.analysis.passes import Signals, passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FLANKS = {-1: "drive flanks", +1: "coast flanks"}
NEWTON_PER_MILLIMETRE = 1e-3
NEWTON_PER_MICROMETRE = 1e-6
LEAST = 1e-3  # of the largest force: a line that never carries more is not drawn


def load_figure(result: Result) -> Figure:
    """The picture of the first pass: forces of the lines, largest loads per length, stiffness of the mesh.

    Raises:
        InputError: the record has no pass, lacks the rack's motions, or its law knows no load per length.
    """
    runs = passes(result.signals)
    if not runs:
        raise InputError("No load distribution: the pinion does not turn in this result.")
    loads = load_distribution(result.gear, runs[0].signals)
    figure, axes = style.panels([2.2, 2.2, 2.0, 2.0])
    for panel, side in zip(axes, FLANKS, strict=False):
        _forces(panel, loads, side)
    _densest(axes[2], loads)
    _stiffness(axes[3], result.gear, runs[0].signals)
    style.angle_axis(axes[-1])
    head(figure, result, "Loads on the lines of contact", {})
    return figure


def _forces(axes: Axes, loads: LoadDistribution, side: int) -> None:
    angle = SIGNALS["pinion_angle"].displayed(loads.angle)
    whole = loads.force_on(side)
    lines = [line for line in loads.lines if line[0] == side]
    shown = [line for line in lines if loads.force_of(*line).max() > LEAST * max(whole.max(), 1e-300)]
    named = len(shown) <= len(style.SEVERAL)
    for k, (_, tooth) in enumerate(shown):
        colour = style.SEVERAL[k % len(style.SEVERAL)]
        first = "_" if k else f"{len(shown)} rack teeth, colours in turn"
        label = f"rack tooth {tooth}" if named else first
        axes.plot(angle, loads.force_of(side, tooth), color=colour, label=label)
    axes.plot(angle, whole, color="black", linewidth=0.8, linestyle="--", label="all")
    axes.set_ylabel(f"{FLANKS[side]} [N]")
    axes.set_ylim(0, None)
    style.legend_above(axes)


def _densest(axes: Axes, loads: LoadDistribution) -> None:
    angle = SIGNALS["pinion_angle"].displayed(loads.angle)
    for side, colour in zip(FLANKS, style.SEVERAL, strict=False):
        largest = np.zeros(loads.angle.size)
        chosen = loads.side == side
        np.maximum.at(largest, loads.instant[chosen], loads.load[chosen])
        axes.plot(angle, NEWTON_PER_MILLIMETRE * largest, color=colour, label=FLANKS[side])
    axes.set_ylabel("largest load\n[N/mm]")
    axes.set_ylim(0, None)
    style.legend_above(axes)


def _stiffness(axes: Axes, gear: SteeringGear, signals: Signals) -> None:
    angle = SIGNALS["pinion_angle"].displayed(signals["pinion_angle"])
    along_x = NEWTON_PER_MICROMETRE * mesh_stiffness(gear, signals)[:, 0]
    axes.plot(angle, along_x, color="black")
    axes.set_ylabel("mesh stiffness\nalong X [N/µm]")
    style.widen(axes, 0.2 * float(along_x.max()))
