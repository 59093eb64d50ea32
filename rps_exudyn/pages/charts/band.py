"""Picture of a band: the scene's signal with its bands of 50 and 90 %, and the inputs that make them."""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import turning_points
from rps_exudyn.inference.uncertainty.band import Band
from rps_exudyn.inference.uncertainty.statistics import LEVELS, Contributions
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.style import scene_of
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.scenes import scene_named

SHOWN = 6  # contributions by name
BANDS = ((0, -1, 0.18), (1, -2, 0.32))  # outer and inner quantiles, opacity


def band_figure(band: Band) -> Figure:
    """The picture: curves above, contributions to the scene's figure below."""
    figure, axes = style.panels([3.6], width=8.0)
    _draw_curves(axes[0], band)
    shares = band.contributions.get(scene_named(band.nominal.scene).figure)
    if shares is not None:
        figure.set_size_inches(8.0, 5.6)
        _draw_contributions(figure, axes[0], shares)
    style.title(figure, _headline(band), _failures(band))
    return figure


def _headline(band: Band) -> str:
    name = scene_named(band.nominal.scene).figure
    parts = [scene_of(band.nominal), band.method]
    if (found := band.figures.get(name)) is not None:
        low, high = (SUMMARY[name].show(end) for end in (found.low, found.high))
        parts.append(f"{name.replace('_', ' ')} {low} to {high} (90 %)")
    return " · ".join(parts)


def _failures(band: Band) -> str:
    if not band.drawn.failed:
        return ""
    return f"{band.drawn.failed} of {len(band.drawn.samples)} samples failed and are in no quantile"


def _draw_curves(axes: Axes, band: Band) -> None:
    name = scene_named(band.nominal.scene).signal
    quantity = SIGNALS[name]
    angle = band.nominal.signals.get("pinion_angle")
    turns = angle is not None and bool(turning_points(angle))
    x = SIGNALS["pinion_angle"].displayed(angle) if turns else band.nominal.signals["time"]
    curves = None if band.curves is None else quantity.displayed(band.curves.quantiles)
    for part in _parts(x):
        if curves is not None:
            for low, high, opacity in BANDS:
                label = f"{100 * (LEVELS[high] - LEVELS[low]):.0f} % of the gears" if not part.start else None
                axes.fill_between(
                    x[part],
                    curves[low][part],
                    curves[high][part],
                    color=style.COLOURS["torque"],
                    alpha=opacity,
                    linewidth=0,
                    label=label,
                )
        nominal = quantity.displayed(band.nominal.signals[name])
        label = None if part.start else "inputs at their medians"
        axes.plot(x[part], nominal[part], color=style.COLOURS["torque"], linewidth=1.2, label=label)
    axes.set_ylabel(quantity.axis_label(name.replace("_", " ")))
    style.legend_above(axes)
    if turns:
        style.angle_axis(axes)
    else:
        style.abscissa(axes, "time [s]")


def _parts(x: np.ndarray) -> list[slice]:
    """Stretches over which x rises or falls."""
    step = np.sign(np.diff(x))
    joints = [0, *(np.flatnonzero(step[1:] != step[:-1]) + 1).tolist(), x.size]
    parts = [slice(i, j + 1) for i, j in pairwise(joints)]
    return [part for part in parts if part.stop - part.start > 2]


def _draw_contributions(figure: Figure, above: Axes, shares: Contributions) -> None:
    """Bars of the largest contributions, most on top."""
    shown = list(shares.fractions.items())[:SHOWN]
    rest = sum(shares.fractions.values()) - sum(value for _, value in shown)
    rows = [*shown, ("all others", rest), ("acting together", shares.together)]
    grid = figure.add_gridspec(2, 1, height_ratios=[3.2, 2.0])
    above.set_subplotspec(grid[0])
    axes = figure.add_subplot(grid[1])
    axes.barh([name for name, _ in rows], [100 * value for _, value in rows], color=style.COLOURS["torque"])
    axes.invert_yaxis()
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlabel("share of the variance [%]")
