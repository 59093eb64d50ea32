"""Picture of the radial play: how far the rack's end yields to a force across it, along Y and along Z."""

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

FIGURES = {"radial_play_y": "play along Y", "radial_play_z": "along Z"}
PARTS = {"rack_end": ("rack's end", "torque"), "rack": ("rack at the pitch point", "lift")}
NAMES = {"y": "along Y, from the pinion", "z": "along Z, sideways"}


def play_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, one panel for each direction; a measured pinion torque is not drawn."""
    figure, axes = style.panels([2.6, 2.6])
    for panel, axis in zip(axes, ("y", "z"), strict=True):
        force = result.signals.get(f"end_force_{axis}", np.zeros(0))
        pressed = _pressed(force)
        for part, (label, colour) in PARTS.items():
            place = result.signals.get(f"{part}_{axis}")
            if force.size and place is not None:
                moved = (place - place[0])[pressed]
                quantity = SIGNALS["rack_y"]
                style.line(panel, force[pressed], moved, quantity, NAMES[axis], colour, label)
    style.legend_above(axes[0])
    style.abscissa(axes[-1], "force across the rack's end [N]")
    head(figure, result, scene_of(result), FIGURES)
    return figure


def _pressed(force: np.ndarray) -> np.ndarray:
    """Where the force of this direction is at work, with the instants at which it begins and ends."""
    acting = force != 0
    return acting | np.roll(acting, 1) | np.roll(acting, -1)
