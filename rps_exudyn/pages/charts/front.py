"""Picture of an optimisation: designs over two objectives and their Pareto front, or one over the designs."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.pages.charts import style
from rps_exudyn.results.quantities import Quantity

HEIGHT = 3.6  # [in]


def front_figure(
    designs: np.ndarray,
    front: np.ndarray,
    given: np.ndarray,
    labels: Sequence[tuple[str, Quantity]],
    links: Sequence[str] = (),
    width: float = 8.0,
    names: tuple[str, str] = ("designs", "the gear as given"),
) -> Figure:
    """Return the picture.

    Args:
        designs: those that keep all limits, (n, 2) [SI].
        front: the best of them, (m, 2), in order.
        given: the gear as given, (1, 2), or (0, 2) where it has no numbers.
        labels: name and quantity of the abscissa and of the ordinate.
        links: where a click on a design of the front leads, m of them.
        width: of the picture [in].
        names: of all points, and of the one that is marked as given.
    """
    figure, (axes,) = style.panels([HEIGHT], width)
    (name_x, over), (name_y, quantity) = labels

    def places(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return over.displayed(points[:, 0]), quantity.displayed(points[:, 1])

    grey, ink = style.COLOURS["reference"], style.COLOURS["torque"]
    axes.plot(*places(designs), ".", color=grey, alpha=0.4, markersize=5, markeredgewidth=0, label=names[0])
    axes.step(*places(front), where="post", color=ink, linewidth=1, alpha=0.5)
    dots = axes.scatter(*places(front), s=30, color=ink, zorder=3, label="the best")
    dots.set_urls(list(links))
    axes.plot(*places(given), "D", color=style.COLOURS["failure"], markersize=7, label=names[1])
    axes.set_ylabel(quantity.axis_label(name_y))
    axes.set_xlabel(over.axis_label(name_x))
    style.legend_above(axes)
    return figure
