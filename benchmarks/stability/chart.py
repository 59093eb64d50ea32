"""Stability maps: which settings are right, which are wrong and do not say so, and what theory predicts."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from rps_exudyn.pages.charts import style
from verification.stability import Cell

CELL_COLOURS = {
    Cell.RIGHT: "#a9cf8f",
    Cell.INACCURATE: "#f4d58d",
    Cell.WRONG: "#b00020",
    Cell.FAILED: "#8fa3b8",
    Cell.NOT_COMPUTED: "#f2f2f2",
}
LINES: Sequence[Any] = ("-", "--", ":")
WIDTH, ROW, HEAD = 8.5, 0.28, 1.0  # inches


def draw_maps(maps: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Draw one map below the other; each has the fields of `StabilityMap`."""
    heights = [HEAD + ROW * len(each["y"]) for each in maps]
    with mpl.rc_context({"font.size": 9.5}):
        figure = Figure(figsize=(WIDTH, sum(heights)), layout="constrained")
        panels = figure.subplots(len(maps), 1, squeeze=False, height_ratios=heights)[:, 0]
        for axes, each in zip(panels, maps, strict=True):
            _draw_map(axes, each)
    style.save(figure, path)


def _draw_map(axes: Axes, content: Mapping[str, Any]) -> None:
    """Draw cells over two axes of single values; predicted lines go from column to column."""
    x, y, cells = content["x"], content["y"], content["cells"]
    for row, line in enumerate(cells):
        for column, cell in enumerate(line):
            axes.add_patch(_square(column, row, CELL_COLOURS[Cell(cell)]))
    handles: list[Any] = [Patch(color=colour, label=cell.value) for cell, colour in CELL_COLOURS.items()]
    present = {cell for line in cells for cell in line}
    handles = [handle for handle in handles if handle.get_label() in present]
    flagged = np.argwhere(content["flagged"])[:, ::-1]  # column and row
    if flagged.size:
        label = "refused or called invalid"
        dots: Any = {"markersize": 4, "markeredgecolor": "black", "label": label}
        handles += axes.plot(*np.transpose(flagged), "o", color="white", **dots)
    for line, dashes in zip(content["lines"], LINES, strict=False):
        across = np.arange(-0.5, len(x), 1.0)  # to both sides of every column
        places = [_place(limit, y) for limit in line["y"]]
        ends = [places[0], *(np.add(places[1:], places[:-1]) / 2), places[-1]]
        points = sorted([*zip(np.arange(len(x)), places, strict=True), *zip(across, ends, strict=True)])
        handles += axes.plot(*np.transpose(points), color="black", linestyle=dashes, label=line["label"])
    axes.set_xticks(range(len(x)), [f"{value:.4g}" for value in x])
    axes.set_yticks(range(len(y)), [f"{value:.4g}" for value in y])
    axes.set_xlim(-0.5, len(x) - 0.5)
    axes.set_ylim(-0.5, len(y) - 0.5)
    axes.set_xlabel(content["x_name"])
    axes.set_ylabel(content["y_name"])
    axes.set_title(content["title"], loc="left", fontsize=10)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1, 1), frameon=False)


def _square(column: int, row: int, colour: str) -> Any:
    return Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor=colour, edgecolor="white", linewidth=2)


def _place(limit: float, values: Sequence[float]) -> float:
    """Place of a value between evenly drawn ones, on a logarithmic scale; at the border if beyond."""
    if not np.isfinite(limit):
        return float("nan")
    order = np.argsort(values)
    place = np.interp(np.log(limit), np.log(np.array(values)[order]), order)
    if min(values) <= limit <= max(values):
        return float(place)
    return float(place + (0.45 if limit > max(values) else -0.45))


def draw_limits(limits: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Draw bisected limits of the step over the predicted ones, line by line."""
    figure, (axes,) = style.panels([1.0 + 0.2 * len(limits)], width=8.5)
    ratios = [limit["measured"] / limit["predicted"] for limit in limits]
    axes.axvspan(0.9, 1.1, color="#e8f1e0", zorder=0)
    axes.axvline(1.0, **style.REFERENCE_LINE)
    lines = list(dict.fromkeys(limit["line"] for limit in limits))
    colours = [style.SEVERAL[lines.index(limit["line"]) % len(style.SEVERAL)] for limit in limits]
    axes.scatter(ratios, range(len(limits)), color=colours, zorder=3)
    axes.set_yticks(
        range(len(limits)),
        [f"{limit['line']}, {limit['at']}: {1e6 * limit['predicted']:.3g} µs" for limit in limits],
        fontsize=8.5,
    )
    axes.set_xlim(min(0.85, *ratios) - 0.02, max(1.15, *ratios) + 0.02)
    axes.margins(y=0.01)
    axes.invert_yaxis()
    axes.set_xlabel("largest stable step, bisected, over the predicted one")
    style.save(figure, path)
