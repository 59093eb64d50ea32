"""Stability maps: which settings are right, which are wrong and do not say so, and what theory predicts."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.patches import Patch

from rps_exudyn.analysis.stability import Cell
from rps_exudyn.charts import style

CELL_COLOURS = {
    Cell.RIGHT: "#a9cf8f",
    Cell.INACCURATE: "#f4d58d",
    Cell.WRONG: "#b00020",
    Cell.FAILED: "#8fa3b8",
    Cell.NOT_COMPUTED: "#f2f2f2",
}


def draw_map(content: Mapping[str, Any], path: Path) -> None:
    """Cells over two axes of single values, as studies/stability_maps.py writes them."""
    x, y, cells = content["x"], content["y"], content["cells"]
    figure, (axes,) = style.panels([1.4 + 0.5 * len(y)], width=7.5)
    axes.grid(False)
    for row, line in enumerate(cells):
        for column, cell in enumerate(line):
            axes.add_patch(_square(column, row, CELL_COLOURS[Cell(cell)]))
    inside = [(c, _place(limit, y)) for c, limit in enumerate(content["predicted"]) if limit == limit]
    if inside:
        for column, place in inside:
            axes.plot([column - 0.5, column + 0.5], [place, place], color="black", linewidth=2)
    axes.set_xticks(range(len(x)), [f"{value:g}" for value in x])
    axes.set_yticks(range(len(y)), [f"{value:g}" for value in y])
    axes.set_xlim(-0.5, len(x) - 0.5)
    axes.set_ylim(-0.5, len(y) - 0.5)
    axes.set_xlabel(content["x_name"])
    axes.set_ylabel(content["y_name"])
    axes.set_title(content["title"], loc="left")
    present = {Cell(cell) for line in cells for cell in line}
    handles: list[Any] = [Patch(color=CELL_COLOURS[c], label=c.value) for c in Cell if c in present]
    if inside:
        handles.append(axes.plot([], [], color="black", linewidth=2, label=content["prediction"])[0])
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1, 1), frameon=False)
    style.save(figure, path)


def _square(column: int, row: int, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=colour, edgecolor="white", linewidth=2)


def _place(limit: float, values: Sequence[float]) -> float:
    """Where a value stands between evenly drawn ones, on a logarithmic scale; at the border if beyond."""
    order = np.argsort(values)
    place = np.interp(np.log(limit), np.log(np.array(values)[order]), order)
    if min(values) <= limit <= max(values):
        return float(place)
    return float(place + (0.45 if place > 0 else -0.45))


def draw_limits(limits: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Bisected limits of the step over the predicted ones."""
    figure, (axes,) = style.panels([1.0 + 0.32 * len(limits)], width=7.5)
    ratios = [limit["measured"] / limit["predicted"] for limit in limits]
    axes.axvspan(0.9, 1.1, color="#e8f1e0", zorder=0)
    axes.axvline(1.0, **style.REFERENCE_LINE)
    axes.plot(ratios, range(len(limits)), "o", color=style.COLOURS["torque"])
    axes.set_yticks(
        range(len(limits)), [f"{limit['name']}, {1e6 * limit['predicted']:.3g} µs" for limit in limits]
    )
    axes.set_xlim(min(0.8, *ratios) - 0.02, max(1.2, *ratios) + 0.02)
    axes.invert_yaxis()
    axes.set_xlabel("largest stable step of velocity Verlet, bisected, over 2 / omega_max")
    style.save(figure, path)
