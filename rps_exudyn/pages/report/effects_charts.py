"""Small pictures of a study: main effect of an axis, response surface over two axes, distribution.

They are as narrow as a phone; a page sets them side by side.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from rps_exudyn.base.units import words
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.display_names import named
from rps_exudyn.results.quantities import LABELS, Quantity
from rps_exudyn.study.definition import Axis, axis_quantity
from rps_exudyn.study.effects import MainEffect

WIDTH, HEIGHT = 3.4, 2.6  # [in]; two of them on a sheet of A4
MOST_TICKS = 5  # levels of a grid that are all labelled
ROOM_FOR_TICKS = 12  # labels side by side
MOST_DOTS = 500  # cases in a chart, so that a page stays small
_DOT: Any = {"alpha": 0.6, "markersize": 8, "markeredgewidth": 0}
_CASE_DOT: Any = {"color": "white", "markersize": 3.5, "markeredgecolor": "black", "markeredgewidth": 0.5}
_LIMITED_MARK: Any = {"s": 18, "marker": "D", "linewidths": 0.6, "edgecolors": "black"}
_LIMITED_DOT: Any = {"alpha": 0.8, "markersize": 4, "markerfacecolor": "none"}
COLOUR_MAP = "cividis"  # of even brightness: its order is kept in grey print


def main_effect_figure(
    axis: Axis, effect: MainEffect, name: str, quantity: Quantity, width: float = WIDTH
) -> Figure:
    """Picture of a main effect: cases as dots, the means over the axis' levels as a line."""
    figure, (axes,) = style.panels([HEIGHT], width)
    levels = _ticks(axes, "x", axis, effect.levels)
    if effect.levels.dtype.kind == "f":
        x = axis_quantity(axis).displayed(effect.values)
    else:
        x = np.searchsorted(effect.levels, effect.values).astype(float)
    some = style.thinned(effect.numbers.size, MOST_DOTS)
    numbers, mean = quantity.displayed(effect.numbers[some]), quantity.displayed(effect.mean)
    limited = effect.limited[some]
    axes.plot(x[some][~limited], numbers[~limited], ".", color=style.COLOURS["reference"], **_DOT)
    axes.plot(x[some][limited], numbers[limited], "D", color=style.COLOURS["other"], **_LIMITED_DOT)
    known = np.isfinite(mean)
    axes.plot(levels[known], mean[known], "o", color=style.COLOURS["torque"], markersize=4)
    for part in _joined(effect.side[known]):
        axes.plot(levels[known][part], mean[known][part], "-", color=style.COLOURS["torque"])
    axes.set_ylabel(quantity.axis_label(label_of(name)))
    return figure


def surface_figure(
    first: Axis,
    second: Axis,
    surface: Iterable[np.ndarray],
    name: str,
    quantity: Quantity,
    marks: tuple[np.ndarray, np.ndarray, np.ndarray],
    ends: tuple[float, float],
) -> Figure:
    """Picture of means over a grid of two axes, as colours with contour lines; unknown cases stay white.

    `marks` are both axes' values of the known cases, and which of these met a limit of the gear; the latter
    are marked, and where only some did colours are those of the single cases, without contours. `ends` are
    those of the colours' scale [SI], which pictures of one number share.
    """
    levels, others, means = surface
    figure, (axes,) = style.panels([HEIGHT + 0.3], _width_beside(others))
    shown = quantity.displayed(means)
    x, y = _ticks(axes, "x", first, levels), _ticks(axes, "y", second, others)
    image: ScalarMappable
    numeric = levels.dtype.kind == others.dtype.kind == "f"
    limited = marks[2]
    scale = MaxNLocator(12).tick_values(*quantity.displayed(np.array(ends)))
    if numeric and np.isfinite(shown).all() and limited.all() == limited.any():
        image = axes.contourf(x, y, shown.T, levels=scale, cmap=COLOUR_MAP)
        grid_x, grid_y = np.meshgrid(x, y)
        axes.plot(grid_x.ravel(), grid_y.ravel(), "o", clip_on=False, **_CASE_DOT)
    else:
        look: Any = {"cmap": COLOUR_MAP, "vmin": scale[0], "vmax": scale[-1]}
        image = axes.pcolormesh(x, y, shown.T, shading="nearest", edgecolors="face", **look)
    if limited.any():
        at_x, at_y = _place(first, marks[0], limited), _place(second, marks[1], limited)
        axes.plot(at_x, at_y, "D", clip_on=False, **_CASE_DOT)
    _colour_bar(figure, axes, image, name, quantity)
    return figure


def scattered_figure(
    first: Axis,
    second: Axis,
    points: tuple[np.ndarray, np.ndarray, np.ndarray],
    name: str,
    quantity: Quantity,
    limited: np.ndarray,
) -> Figure:
    """Picture of sampled cases over two axes, coloured by the number; those that met a limit of the gear are
    diamonds. Arrays have the shape (cases,)."""
    figure, (axes,) = style.panels([HEIGHT + 0.3], _width_beside(points[1]))
    x, y = _ticks(axes, "x", first, points[0]), _ticks(axes, "y", second, points[1])
    some = style.thinned(x.size, MOST_DOTS)
    shown = quantity.displayed(points[2][some])
    scale: Any = {"cmap": COLOUR_MAP, "vmin": shown.min(), "vmax": shown.max()}
    free, met = ~limited[some], limited[some]
    image = axes.scatter(x[some][free], y[some][free], c=shown[free], s=14, linewidths=0, **scale)
    if met.any():
        axes.scatter(x[some][met], y[some][met], c=shown[met], **scale, **_LIMITED_MARK)
    _colour_bar(figure, axes, image, name, quantity)
    return figure


def distribution_figure(numbers: np.ndarray, name: str, quantity: Quantity) -> Figure:
    """Histogram of a number, shape (cases,) [SI], with the median and the range of 90 % of the cases."""
    figure, (axes,) = style.panels([HEIGHT], WIDTH)
    shown = quantity.displayed(numbers[np.isfinite(numbers)])
    axes.hist(shown, bins="auto" if shown.size > 20 else 5, color=style.COLOURS["torque"], alpha=0.75)
    axes.set_axisbelow(True)
    low, middle, high = np.quantile(shown, [0.05, 0.5, 0.95])
    axes.axvline(middle, color=style.COLOURS["other"], linewidth=1.6, label="median")
    look: Any = {**style.BAND, "color": style.COLOURS["other"]}
    axes.axvspan(low, high, label="90 % of the cases", **look)
    axes.set_xlabel(quantity.axis_label(label_of(name)))
    axes.set_ylabel("cases")
    style.name_curves(axes)
    return figure


def label_of(name: str) -> str:
    """A number's name in words, as headings have it."""
    return LABELS.get(name, words(name))


def _place(axis: Axis, values: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Where the chosen values of an axis are in a chart: in its display unit, or by the words' numbers."""
    if values.dtype.kind == "f":
        return np.asarray(axis_quantity(axis).displayed(values[chosen]))
    return np.unique(values, return_inverse=True)[1][chosen].astype(float)


def _joined(side: np.ndarray) -> Iterable[slice]:
    """Pairs of neighbouring levels on one side of a limit: a line across it would hide the kink."""
    return (slice(at, at + 2) for at in range(len(side) - 1) if side[at] == side[at + 1])


def _width_beside(values: np.ndarray) -> float:
    """The width of a chart with these values beside its ordinate: words take more room than numbers [in]."""
    words = values.dtype.kind != "f"
    return WIDTH + (style.LETTER * max(len(str(value)) for value in values) if words else 0.0)


def _ticks(axes: Axes, direction: str, axis: Axis, values: np.ndarray) -> np.ndarray:
    """Label the axis; returns the values in its display unit, or the numbers of words, which become ticks."""
    quantity = axis_quantity(axis)
    axes.set(**{f"{direction}label": quantity.axis_label(named(axis.name))})
    if values.dtype.kind == "f":
        shown = quantity.displayed(values)
        if len(levels := np.unique(shown)) <= MOST_TICKS:
            apart = np.diff(levels, prepend=-np.inf) > np.ptp(levels) / ROOM_FOR_TICKS
            axes.set(**{f"{direction}ticks": levels[apart]})
        return shown
    words, numbers = np.unique(values, return_inverse=True)
    axes.set(**{f"{direction}ticks": np.arange(len(words)), f"{direction}ticklabels": list(words)})
    return numbers.astype(float)


def _colour_bar(figure: Figure, axes: Axes, image: ScalarMappable, name: str, quantity: Quantity) -> None:
    axes.grid(False)
    bar = figure.colorbar(image, ax=axes)
    bar.set_label(quantity.axis_label(label_of(name)))
    bar.outline.set_visible(False)
