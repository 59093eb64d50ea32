"""One look for all charts: sizes, colours by meaning, axes with units, and how a picture is saved."""

import textwrap
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.atomic import replacing
from rps_exudyn.quantities import Quantity

COLOURS = {
    "torque": "#0b5394",
    "lift": "#38761d",
    "roll": "#b45f06",
    "reference": "#777777",
    "failure": "#b00020",
}

_LOOK: Any = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.formatter.useoffset": False,
    "grid.color": "#e4e4e4",
    "lines.linewidth": 1.4,
    "legend.frameon": False,
}

REFERENCE_LINE: Any = {"color": COLOURS["reference"], "linewidth": 1, "linestyle": "--", "zorder": 1}

PICTURES = (".png", ".svg", ".pdf")
"""File types a chart can be saved as."""


def panels(heights: list[float], width: float = 8.0) -> tuple[Figure, list[Axes]]:
    """A figure of panels one below the other over one common abscissa; sizes in inches."""
    with mpl.rc_context(_LOOK):
        figure = Figure(figsize=(width, sum(heights)), layout="constrained")
        axes = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    figure.align_ylabels(axes)
    return figure, list(axes)


def line(axes: Axes, x: np.ndarray, y: np.ndarray, quantity: Quantity, name: str, colour: str) -> None:
    """One signal over x (display units), shape (n,) both; y is SI and drawn in its display unit."""
    axes.plot(x, quantity.displayed(y), color=COLOURS[colour], linewidth=_LOOK["lines.linewidth"])
    axes.set_ylabel(quantity.axis_label(name))


def title(figure: Figure, headline: str, failure: str = "") -> None:
    """What the picture shows, and below it, in the colour of failure, why not to trust it."""
    figure.suptitle(headline, x=0.01, ha="left", fontsize=11)
    if failure:
        text = "\n".join(textwrap.wrap(failure, width=100))
        figure.axes[0].set_title(text, loc="left", fontsize=10, color=COLOURS["failure"])


def widen(axes: Axes, least: float) -> None:
    """Show at least this span (display unit), so that rounding noise does not look like a signal."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = (low + high) / 2
        axes.set_ylim(middle - least / 2, middle + least / 2)


def save(figure: Figure, path: str | Path) -> None:
    """Write the picture in the format of the path's suffix, whole or not at all.

    Raises:
        InputError: the file cannot be written.
    """
    with replacing(path) as partial:
        figure.savefig(partial, dpi=150)
