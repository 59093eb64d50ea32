"""Pictures of bands, fits and production batches.

A band: the scene's signal with its bands of 50 and 90 %, and the inputs that make them. A fit: measured
curves both ways with the model and its band, residuals, parameters before and after.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import residuals
from rps_exudyn.analysis.passes import passes, turning_points
from rps_exudyn.inference.fitting.fitted import Fit, FittedPass
from rps_exudyn.inference.fitting.production import ProductionLot
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.inference.uncertainty.band import Band
from rps_exudyn.inference.uncertainty.statistics import LEVELS, Contributions
from rps_exudyn.pages.charts import curves, style
from rps_exudyn.pages.charts.style import scene_of
from rps_exudyn.results.judged_row import Verdict
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.results.rounding import rounded_range
from rps_exudyn.scenes import scene_named

SHOWN = 6  # contributions by name
HEIGHT, HEIGHT_OF_SHARES = 3.6, 2.0  # of the curves and of the contributions [in]
BANDS = ((0, -1, 0.18), (1, -2, 0.32))  # outer and inner quantiles, opacity


def band_figure(band: Band) -> Figure:
    """The picture: curves above, contributions to the main metric below."""
    figure = band_curves(band)
    shares = band.contributions.get(scene_named(band.nominal.scene).main_metric)
    if shares is not None:
        _draw_contributions(figure, shares)
    failed, drawn = band.drawn.failed, len(band.drawn.samples)
    failure = f"{failed} of {drawn} samples failed and are in no quantile" if failed else ""
    style.title(figure, _headline(band), failure)
    return figure


def band_curves(band: Band) -> Figure:
    """The scene's signal at the medians of the inputs, and its bands; over them the measured torque that the
    nominal result keeps, if any, and below them its residuals."""
    signals, measured = band.nominal.signals, band.nominal.measured
    if scene_named(band.nominal.scene).signal != "pinion_torque" or "pinion_torque" not in signals:
        measured = None
    left = [] if measured is None else residuals(measured, signals)
    figure, axes = style.panels([HEIGHT, *([curves.HEIGHT_OF_RESIDUAL] if left else [])])
    if measured is not None:
        only = sum({each.direction for each in passes(signals)})
        curves.add_measured(axes[0], measured, signals, only=only)
    _draw_curves(axes[0], band)
    if left:
        curves.draw_residuals(axes[1], "measured - simulated", left, against_motion=False)
        axes[0].set_xlabel("")
        style.angle_axis(axes[1])
    return figure


def _headline(band: Band) -> str:
    name = scene_named(band.nominal.scene).main_metric
    parts = [scene_of(band.nominal), band.method]
    if (found := band.metrics.get(name)) is not None:
        shown = rounded_range(SUMMARY[name], found.low, found.high)
        parts.append(f"{name.replace('_', ' ')} {shown} (90 %)")
    return " · ".join(parts)


def _draw_curves(axes: Axes, band: Band) -> None:
    name = scene_named(band.nominal.scene).signal
    quantity = SIGNALS[name]
    angle = band.nominal.signals.get("pinion_angle")
    turns = angle is not None and bool(turning_points(angle))
    x = SIGNALS["pinion_angle"].displayed(angle) if turns else band.nominal.signals["time"]
    nominal, colour = quantity.displayed(band.nominal.signals[name]), style.COLOURS["torque"]
    levels: Any = None if band.curves is None else quantity.displayed(band.curves.quantiles)
    for part in _parts(x):
        for low, high, opacity in BANDS if levels is not None else ():
            label = f"{100 * (LEVELS[high] - LEVELS[low]):.0f} % of the gears" if not part.start else None
            look: Any = {"color": colour, "alpha": opacity, "linewidth": 0, "label": label}
            axes.fill_between(x[part], levels[low][part], levels[high][part], **look)
        label = None if part.start else "inputs at their medians"
        axes.plot(x[part], nominal[part], color=colour, linewidth=1.2, label=label)
    axes.set_ylabel(quantity.axis_label(name.replace("_", " ")))
    style.name_curves(axes)
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


def _draw_contributions(figure: Figure, shares: Contributions) -> None:
    """Bars of the largest contributions, most on top, below the panels that the figure has."""
    shown = list(shares.fractions.items())[:SHOWN]
    rest = sum(shares.fractions.values()) - sum(value for _, value in shown)
    rows = [*shown, ("all others", rest), ("acting together", shares.together)]
    above, (width, height) = list(figure.axes), figure.get_size_inches()
    figure.set_size_inches(width, height + HEIGHT_OF_SHARES)
    heights = [HEIGHT, curves.HEIGHT_OF_RESIDUAL][: len(above)]
    grid = figure.add_gridspec(len(above) + 1, 1, height_ratios=[*heights, HEIGHT_OF_SHARES])
    for row, each in enumerate(above):
        each.set_subplotspec(grid[row])
    axes = figure.add_subplot(grid[len(above)])
    axes.barh([name for name, _ in rows], [100 * value for _, value in rows], color=style.COLOURS["torque"])
    axes.invert_yaxis()
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlabel("share of the variance [%]")


# --- A production batch


def drift_figure(batch: ProductionLot, limits: Limit | None) -> Figure:
    """The levels of all gears in their order with their intervals, and below their moving average with the
    limits that 1 % of batches without drift exceed; `limits` of acceptance where a tolerance was given."""
    figure, (levels, average) = style.panels([2.8, 2.4])
    place, drift, colour = np.arange(1, len(batch.gears) + 1), batch.drift, style.COLOURS["torque"]
    known, halves = [each.level for each in batch.gears], [WIDE * each.sd for each in batch.gears]
    look: Any = {"fmt": "o", "markersize": 3, "linewidth": 0.8, "label": "a gear, 95 % of its measurement"}
    levels.errorbar(place, known, yerr=halves, color=colour, **look)
    for end in (limits.least, limits.most) if limits else ():
        if np.isfinite(end):
            levels.axhline(end, **style.REFERENCE_LINE)
    levels.set_ylabel("mean free torque\n[N m]")
    low, high = drift.mean - drift.limit, drift.mean + drift.limit
    average.fill_between(place, low, high, label="limits", **style.BAND)
    average.axhline(drift.mean, **style.REFERENCE_LINE)
    average.plot(place, drift.average, color=colour, label="moving average")
    if (beyond := drift.alarms).size:
        failure = style.COLOURS["failure"]
        average.plot(place[beyond], drift.average[beyond], "o", markersize=4, color=failure, label="beyond")
    average.set_ylabel("moving average\n[N m]")
    style.name_curves(levels)
    style.name_curves(average)
    average.set_xlabel("gear, in the order of the files")
    average.set_xlim(0, len(batch.gears) + 1)
    state = f"drift from {batch.gears[drift.alarms[0]].name} on" if drift.alarms.size else "no drift"
    shown = "" if limits is None else " · dashed: limits with guard bands"
    style.title(figure, f"Production batch of {len(batch.gears)} gears · {state}{shown}")
    return figure


# --- A fit to measured curves

WIDE = 1.96  # standard deviations of a 95 % interval
POSTERIOR = {Verdict.FOUND: "lift", Verdict.BY_PRIOR: "torque"}
FARTHEST = 6.0  # standard deviations of the noise that the ordinate of what is left shows
NAMED = 4  # factors of a combination that its bar names


def curves_figure(fit: Fit, width: float = 8.0) -> Figure | None:
    """Measured and fitted torque against the motion, and what is left; None without free turning."""
    turned = [each for each in fit.passes if each.by_angle]
    if not turned:
        return None
    figure, (torque, left) = style.panels([3.4, 2.0], width)
    noise = float(np.median([each.noise for each in turned]))
    for each in turned:
        _draw_pass(torque, left, each, FARTHEST * noise)
    torque.set_ylabel(f"{curves.AGAINST_MOTION}\n[N m]")
    left.set_ylabel("measured - fitted\n[N m]")
    left.axhspan(-2 * noise, 2 * noise, **style.BAND)
    left.axhline(0.0, **style.REFERENCE_LINE)
    style.name_curves(left)
    left.set_ylim(-1.05 * FARTHEST * noise, 1.05 * FARTHEST * noise)
    style.angle_axis(left)
    labels = set[str]()
    for line in torque.lines:  # each name once
        line.set_label(f"_{label}" if (label := str(line.get_label())) in labels else label)
        labels.add(label)
    style.name_curves(torque)
    return figure


def _draw_pass(torque: Axes, left: Axes, each: FittedPass, farthest: float) -> None:
    name, colour = curves.DIRECTIONS[each.direction]
    angle, sense = np.degrees(each.angle), each.direction
    deviation = each.value - each.model
    inside = np.abs(deviation) <= farthest
    curves.draw_dots(torque, angle[inside], sense * each.value[inside], sense, f"measured {name}")
    low, high = (sense * (each.model + sign * each.half_band) for sign in (-1, 1))
    torque.fill_between(angle, low, high, **{**style.BAND, "zorder": 1})
    look: Any = {"color": style.COLOURS[colour], "linestyle": style.DASHES.get(colour, "-"), "linewidth": 1.6}
    torque.plot(angle, sense * each.model, label=f"fitted {name}, 95 % band", **look)
    curves.draw_dots(left, angle[inside], deviation[inside], sense)
    for end, mark in ((1, "\u25b2"), (-1, "\u25bc")):
        beyond = f"{mark} {{}} beyond the axis {name}"
        curves.draw_at_end(left, angle[end * deviation > farthest], end, beyond)
        curves.draw_at_end(torque, angle[end * sense * deviation > farthest], end, beyond)


def beliefs_figure(fit: Fit) -> Figure | None:
    """Each parameter of the level over its expected value, before and after, with the combination as a bar of
    its own; None where none was fitted."""
    bars = [
        (each.path, np.log(each.value / each.prior), each.sd, each.prior_sd, each.verdict)
        for each in fit.estimates
        if each.path in LEVEL
    ]
    moved = {path: middle for path, middle, *_ in bars}
    for each in fit.combinations:
        middle = sum(power * moved[path] for path, power in each.exponents.items())
        shown = " x\n".join(each.words.split(" x ")[:NAMED])
        bars.append((f"product:\n{shown}", middle, each.sd, each.prior_sd, Verdict.FOUND))
    if not bars:
        return None
    heights = [0.9 + 0.4 * name.count("\n") for name, *_ in bars]
    figure, (axes,) = style.panels([0.6 + 0.42 * sum(heights)])
    _draw_bars(axes, bars, heights)
    axes.set_xscale("log")
    axes.set_xlabel("value over expected value; grey: before, coloured: after, 95 %")
    low, high = axes.get_xlim()
    ticks = [tick for tick in (0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0) if low <= tick <= high]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    return figure


def _draw_bars(
    axes: Axes, bars: Sequence[tuple[str, float, float, float, Verdict]], heights: Sequence[float]
) -> None:
    places = -np.cumsum(heights) + np.array(heights) / 2
    for place, (_, middle, sd, before, verdict) in zip(places, bars, strict=True):
        colour = style.COLOURS[POSTERIOR.get(verdict, "other")]
        for centre, deviation, thick, shade in ((0.0, before, 0.62, "#d0d0d0"), (middle, sd, 0.3, colour)):
            ends = np.exp(centre + WIDE * deviation * np.array([-1, 1]))
            axes.barh(place, ends[1] - ends[0], left=ends[0], height=thick, color=shade, zorder=2)
        axes.plot([np.exp(middle)], [place], "|", color="black", markersize=9, zorder=3)
    axes.axvline(1.0, **style.REFERENCE_LINE)
    axes.set_ylim(-sum(heights), 0.0)
    axes.set_yticks(places, [name for name, *_ in bars], fontsize=9)
