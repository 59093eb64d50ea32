"""Curves over the pinion angle, with the two directions of a record in colours of their own."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import onto_simulated, residuals
from rps_exudyn.analysis.passes import Pass, Signals, passes
from rps_exudyn.base.units import short
from rps_exudyn.pages.charts import style
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import MeasuredTorque, Result

DIRECTIONS = {+1: ("towards +X", "forward"), -1: ("towards -X", "backward")}
AGAINST_MOTION = "torque against the motion"
AT_REVERSAL = "\u25bc {} just after a reversal"
NOT_SIMULATED = "not simulated (test.path = there-and-back does)"
RESIDUAL, HEIGHT_OF_RESIDUAL = "residual", 1.6  # name and height [in] of its panel
HEIGHT_OF_ONE_WAY = 0.8  # of the panel of both directions
LONGEST_NAME = 40  # letters of a file's name in a legend
MOST_DOTS = 250  # of a measured curve, evenly chosen; more hide each other
_GREY: Any = {"linestyle": "none", "color": style.COLOURS["measured"], "marker": "o", "zorder": 1.8}
MEASURED_DOTS = _GREY | {"markersize": 3, "markeredgewidth": 0.6, "markerfacecolor": "none"}
OTHER_DOTS = _GREY | {"markersize": 2, "markeredgewidth": 0, "markerfacecolor": style.COLOURS["measured"]}
"""Measured points are hollow; those of the other direction are small and filled."""


def over_angle(axes: Axes, signals: Signals, name: str, axis: str, colour: str) -> None:
    """Draw one signal: a curve in `colour`, or one per pass in the colour of its direction."""
    curves = [(turned.signals, DIRECTIONS[turned.direction][1]) for turned in passes(signals)]
    for part, its_colour in curves if len(curves) > 1 else [(dict(signals), colour)]:
        angle = SIGNALS["pinion_angle"].displayed(part["pinion_angle"])
        style.line(axes, angle, part[name], SIGNALS[name], axis, its_colour)


class Panel(NamedTuple):
    """Axes of one signal."""

    name: str
    direction: int  # the only one that is drawn there; 0: both
    axes: Axes


def panels_over_angle(
    result: Result,
    panels: Mapping[str, tuple[str, str, float, float]],
    measured: MeasuredTorque | None = None,
) -> tuple[Figure, list[Panel]]:
    """A figure of those signals that the result has; a torque in both directions is against its motion.

    A measured torque leaves only panels of the torque: one for each direction, and below them the measured
    less the simulated torque.

    `panels` are signal -> name at the axis, colour, height [in], least span shown [display unit].
    """
    kept = () if measured is None else (result.signals, measured.signals)
    turned = {each.direction for signals in kept for each in passes(signals)}
    ways = tuple(sorted(turned, reverse=True)) if len(turned) > 1 else (0,)
    apart = residuals(measured, result.signals) if measured and "pinion_torque" in result.signals else []
    shown = [
        (name, way, panel)
        for name, panel in panels.items()
        if name in result.signals and (measured is None or name == "pinion_torque")
        for way in (ways if name == "pinion_torque" else (0,))
    ]
    if apart:
        shown.insert(len(ways), (RESIDUAL, 0, ("measured - simulated", "measured", HEIGHT_OF_RESIDUAL, 0.0)))
    heights = [height * (HEIGHT_OF_ONE_WAY if way else 1) for _, way, (_, _, height, _) in shown]
    figure, axes = style.panels(heights)
    drawn = [Panel(name, way, each) for (name, way, _), each in zip(shown, axes, strict=True)]
    for panel, (name, way, (label, colour, _, least)) in zip(axes, shown, strict=True):
        both_ways = name == "pinion_torque" and len(passes(result.signals)) > 1
        if name == RESIDUAL:
            draw_residuals(panel, label, apart, len(ways) > 1)
        elif way:
            torque_one_way(panel, result.signals, measured, way)
        elif both_ways:
            torque_against_motion(panel, result.signals)
        else:
            over_angle(panel, result.signals, name, label, colour)
        if measured is not None and name == "pinion_torque" and not way:
            add_measured(panel, measured, result.signals, against_motion=both_ways)
        style.widen(panel, least)
    style.angle_axis(axes[-1])
    return figure, drawn


def draw_residuals(axes: Axes, label: str, pieces: Sequence[Pass], against_motion: bool) -> None:
    """Draw pieces of the measured less the simulated torque, those of two directions in their marks."""
    for piece in pieces:
        angle = SIGNALS["pinion_angle"].displayed(piece.angle)
        torque = (piece.direction if against_motion else 1) * piece.signals["pinion_torque"]
        draw_dots(axes, angle, SIGNALS["pinion_torque"].displayed(torque), piece.direction)
    axes.axhline(0, **style.REFERENCE_LINE)
    axes.set_ylabel(SIGNALS["pinion_torque"].axis_label(label.replace(" - ", "\n\u2212 ")))


def torque_one_way(axes: Axes, signals: Signals, measured: MeasuredTorque | None, way: int) -> None:
    """Draw the simulated and the measured torque against the motion in one direction."""
    name, colour = DIRECTIONS[way]
    quantity, label = SIGNALS["pinion_torque"], "simulated"
    for turned in passes(signals):
        if turned.direction == way:
            angle = SIGNALS["pinion_angle"].displayed(turned.angle)
            style.line(axes, angle, way * turned.signals["pinion_torque"], quantity, "", colour, label)
            label = "_"
    axes.set_ylabel(quantity.axis_label(f"torque {name}\nagainst the motion"))
    if measured is not None:
        add_measured(axes, measured, signals, against_motion=True, only=way)
    if label != "_":
        axes.plot([], [], " ", color=style.COLOURS["reference"], label=NOT_SIMULATED)


def torque_against_motion(axes: Axes, signals: Signals) -> None:
    """Draw both directions of the torque on one side of zero, where their ripples can be compared."""
    quantity = SIGNALS["pinion_torque"]
    for turned in passes(signals):
        angle = SIGNALS["pinion_angle"].displayed(turned.angle)
        torque = turned.direction * turned.signals["pinion_torque"]
        style.line(axes, angle, torque, quantity, AGAINST_MOTION, DIRECTIONS[turned.direction][1])
    style.name_directions(axes, {colour: label for label, colour in DIRECTIONS.values()})


def add_measured(
    axes: Axes, measured: MeasuredTorque, signals: Signals, *, against_motion: bool = False, only: int = 0
) -> None:
    """Draw the points of a measured torque below the others, brought onto the angles of the simulated one by
    whole turns: of the direction `only` (0: both), both on one side of zero if `against_motion`."""
    label: str | None = f"measured: {short(measured.name, LONGEST_NAME)}"
    for turned in onto_simulated(measured, signals):
        if only in (0, turned.direction):
            angle = SIGNALS["pinion_angle"].displayed(turned.angle)
            torque = (turned.direction if against_motion else 1) * turned.signals["pinion_torque"]
            draw_dots(axes, angle, SIGNALS["pinion_torque"].displayed(torque), turned.direction, label)
            label = None
    if against_motion:
        pieces = onto_simulated(measured, signals, at_reversal=True)
        angles = [np.empty(0), *(each.angle for each in pieces if only in (0, each.direction))]
        draw_at_end(axes, SIGNALS["pinion_angle"].displayed(np.concatenate(angles)), -1, AT_REVERSAL)


FOLDED, BINS = 121, 24  # points of a simulated pitch, and classes of a measured one


def ripple_figure(result: Result) -> Figure | None:
    """The torque of the first pass less its mean over one tooth pitch, the mean of all its teeth, and the
    measured one likewise, whose runout is left out with that; None where the record covers no revolution."""
    if not {"pinion_angle", "pinion_torque"} <= result.signals.keys():
        return None
    turned = passes(result.signals)
    if not turned or np.ptp(turned[0].angle) < 2 * np.pi * (1 - 1e-6):
        return None
    first, pitch = turned[0], 2 * np.pi / result.gear.pinion.teeth
    over = np.linspace(0, pitch, FOLDED)
    low = first.angle.min()
    every = low + over + pitch * np.arange(result.gear.pinion.teeth)[:, None]
    torque = first.direction * first.over(every.ravel(), "pinion_torque").reshape(every.shape).mean(axis=0)
    figure, (axes,) = style.panels([2.3], 5.2)
    quantity, degrees = SIGNALS["pinion_torque"], SIGNALS["pinion_angle"].displayed
    style.line(axes, degrees(over), torque - torque.mean(), quantity, "torque - mean", "torque", "simulated")
    if result.measured is not None:
        points = _folded(result.measured, first.direction, low, pitch)
        draw_dots(axes, degrees(points[0]), quantity.displayed(points[1]), 1, "measured, mean of the teeth")
    axes.axhline(0, **style.REFERENCE_LINE)
    style.legend_above(axes)
    style.angle_axis(axes)
    return figure


def _folded(measured: MeasuredTorque, direction: int, low: float, pitch: float) -> np.ndarray:
    """Angles within a pitch and the mean measured torque less its mean there, shape (2, m)."""
    pieces = [each for each in passes(measured.signals) if each.direction == direction]
    if not pieces:
        return np.empty((2, 0))
    angle = np.concatenate([each.angle for each in pieces])
    torque = direction * np.concatenate([each.signals["pinion_torque"] for each in pieces])
    number = ((angle - low) % pitch / pitch * BINS).astype(int) % BINS
    count = np.bincount(number, minlength=BINS)
    known = count > 0
    mean = np.bincount(number, torque, minlength=BINS)[known] / count[known]
    return np.stack([(np.flatnonzero(known) + 0.5) / BINS * pitch, mean - mean.mean()])


def draw_at_end(axes: Axes, x: np.ndarray, end: int, label: str) -> None:
    """Mark points beyond the ordinate at its upper (`end` +1) or lower end, where they do not scale it."""
    if x.size:
        look: Any = {"color": style.COLOURS["measured"], "linestyle": "none", "markersize": 4}
        place, mark = (1.0, "^") if end > 0 else (0.0, "v")
        look |= {"transform": axes.get_xaxis_transform(), "clip_on": False, "marker": mark}
        axes.plot(x, np.full(x.size, place), label=label.format(x.size), **look)


def draw_dots(axes: Axes, x: np.ndarray, y: np.ndarray, direction: int, label: str | None = None) -> None:
    """Draw measured points by the marks of their direction; the axes hold also those that are left out."""
    if x.size:
        axes.update_datalim([(x.min(), y.min()), (x.max(), y.max())])
    some, look = style.thinned(x.size, MOST_DOTS), OTHER_DOTS if direction < 0 else MEASURED_DOTS
    axes.plot(x[some], y[some], label=label, **look)
