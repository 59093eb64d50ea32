"""Charts that benchmarks alone draw: torques of several results, orders, losses, maps of two parameters."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.work_balance import describe_losses
from rps_exudyn.base.errors import InputError
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.curves import AGAINST_MOTION, add_measured
from rps_exudyn.pages.charts.style import head
from rps_exudyn.results.quantities import SIGNALS, SUMMARY
from rps_exudyn.results.result import MeasuredTorque, Result
from verification.orders import loss_torques, order_spectrum

DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (3, 1.5)), (0, (1, 1)), (0, (6, 2, 1, 2)), "-")
"""Line styles, so that curves that lie over each other can be distinguished."""


def torques_figure(
    results: dict[str, Result], headline: str, measured: MeasuredTorque | None = None
) -> Figure:
    """The picture of the first pass of each result (by its name); at most as many as there are colours."""
    figure, (axes,) = style.panels([3.8])
    for (name, result), colour, dashes in zip(results.items(), style.SEVERAL, DASHES, strict=False):
        turned = passes(result.signals)[0]
        torque = turned.direction * turned.signals["pinion_torque"]
        axes.plot(
            SIGNALS["pinion_angle"].displayed(turned.angle),
            SIGNALS["pinion_torque"].displayed(torque),
            color=colour,
            linewidth=1.4,
            linestyle=dashes,
            label=name,
        )
    axes.set_ylabel(SIGNALS["pinion_torque"].axis_label(AGAINST_MOTION))
    if measured is not None:
        first = next(iter(results.values()))
        add_measured(axes, measured, first.signals, against_motion=True)
    style.name_curves(axes)
    style.angle_axis(axes)
    style.title(figure, headline)
    return figure


# --- Picture of the orders of a torque: amplitudes over periods per revolution, as stems

HIGHEST_ORDER = 36
LEAST_AMPLITUDE = 1e-3  # [N mm], where the scale begins: far below what a bench can measure


def spectrum_figure(results: dict[str, Result]) -> Figure:
    """The picture of the first pass of each result (by its name), from order 1 on, on a logarithmic scale;
    amplitudes below `LEAST_AMPLITUDE` are left out.

    Raises:
        InputError: a record covers no whole revolution.
    """
    figure, (axes,) = style.panels([3.2])
    quantity, width = SUMMARY["torque_first_order"], 0.8 / len(results)
    for i, (name, result) in enumerate(results.items()):
        signals = passes(result.signals)[0].signals
        spectrum = order_spectrum(signals["pinion_angle"], signals["pinion_torque"], HIGHEST_ORDER)
        if spectrum is None:
            raise InputError(f"No spectrum of {name}: its record covers less than a revolution.")
        orders = spectrum.orders[1:] + (i - (len(results) - 1) / 2) * width
        amplitude = 1e3 * quantity.displayed(spectrum.amplitude[1:])
        known = amplitude > LEAST_AMPLITUDE
        colour = style.SEVERAL[i]
        axes.vlines(orders[known], LEAST_AMPLITUDE, amplitude[known], color=colour, linewidth=1.6)
        axes.plot(orders[known], amplitude[known], "o", color=colour, markersize=4, label=name)
    axes.set_yscale("log")
    axes.set_ylim(LEAST_AMPLITUDE, None)
    axes.set_ylabel("amplitude [N mm]")
    axes.set_xlabel("order [1/revolution]")
    teeth = next(iter(results.values())).gear.pinion.teeth
    axes.set_xticks([1, *range(teeth, HIGHEST_ORDER + 1, teeth)])
    style.name_curves(axes)
    head(figure, next(iter(results.values())), "Orders of the pinion torque", {})
    return figure


# --- Picture of the losses: work lost at each place per angle turned, stacked to the torque of the drive

LOSS_PLACES = {"bearing": "bearings", "bush": "bush", "seat": "plunger's seat", "mesh": "teeth"}


def losses_figure(result: Result) -> Figure:
    """The picture of the first pass; the drive's torque is a line over the stack.

    Raises:
        InputError: the record has no pass, or no losses.
    """
    runs = passes(result.signals)
    torques = loss_torques(runs[0].signals) if runs else {}
    if not torques:
        raise InputError("No losses to draw: the result has no record of work over the pinion angle.")
    signals, fractions = runs[0].signals, describe_losses(runs[0].signals)
    figure, (axes,) = style.panels([3.6])
    angle = SIGNALS["pinion_angle"].displayed(runs[0].angle)
    quantity, below = SIGNALS["pinion_torque"], np.zeros_like(angle)
    for place, called in LOSS_PLACES.items():
        if place not in torques:
            continue
        above = below + quantity.displayed(torques[place])
        label = f"{called} {100 * fractions[f'loss_share_{place}']:.1f} %"
        axes.fill_between(
            angle, below, above, color=style.COLOURS[place], linewidth=0, alpha=0.85, label=label
        )
        below = above
    if "pinion_torque" in signals:
        driving = runs[0].direction * signals["pinion_torque"]
        axes.plot(angle, quantity.displayed(driving), color="black", linewidth=1, label="drive")
    axes.set_ylabel(quantity.axis_label("torque lost"))
    axes.set_ylim(0, None)
    axes.legend(reverse=True, loc="upper left", bbox_to_anchor=(1, 1), frameon=False)  # as the layers lie
    style.angle_axis(axes)
    head(figure, result, "Where the torque goes", {})
    return figure


# --- Maps of two parameters


def map_to_scale(
    axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray, text: str, missing: str
) -> Any:
    """Colour cells at their places on both axes, of any distances, with their values as text; return the
    colours for a colour bar.

    Args:
        axes: where.
        x: rising places of the columns, shape (n,).
        y: rising places of the rows, shape (m,).
        values: shape (m, n); nan stays white.
        text: format of a value.
        missing: text of a nan.
    """
    image = axes.pcolormesh(_edges(x), _edges(y), values, cmap="viridis", edgecolors="white", linewidth=0.5)
    for (i, j), value in np.ndenumerate(values):
        dark = np.isfinite(value) and _brightness(image.to_rgba(value)) < 0.5
        label = text.format(value) if np.isfinite(value) else missing
        colour = "white" if dark else "black"
        axes.text(float(x[j]), float(y[i]), label, ha="center", va="center", color=colour)
    axes.set_xticks(x)
    axes.set_yticks(y)
    axes.grid(False)
    return image


def _edges(places: np.ndarray) -> np.ndarray:
    """Edges of cells around rising places: halfway between them."""
    if places.size == 1:
        return places[0] + np.array([-0.5, 0.5])
    halfway = (places[1:] + places[:-1]) / 2
    return np.concatenate([[2 * places[0] - halfway[0]], halfway, [2 * places[-1] - halfway[-1]]])


def _brightness(colour: Any) -> float:
    """Brightness of a colour, from 0 to 1 (ITU-R BT.601)."""
    red, green, blue, *_ = colour
    return float(0.299 * red + 0.587 * green + 0.114 * blue)
