"""Picture of the orders of a torque: amplitudes over periods per revolution, as stems."""

from matplotlib.figure import Figure

from rps_exudyn.analysis.harmonics import order_spectrum
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result

HIGHEST = 36
LEAST = 1e-3  # [N mm], where the scale begins: far below what a bench can measure


def spectrum_figure(results: dict[str, Result]) -> Figure:
    """The picture of the first pass of each result (by its name), from order 1 on, on a logarithmic scale;
    amplitudes below `LEAST` are left out.

    Raises:
        InputError: a record covers no whole revolution.
    """
    figure, (axes,) = style.panels([3.2])
    quantity, width = SUMMARY["torque_first_order"], 0.8 / len(results)
    for i, (name, result) in enumerate(results.items()):
        signals = passes(result.signals)[0].signals
        spectrum = order_spectrum(signals["pinion_angle"], signals["pinion_torque"], HIGHEST)
        if spectrum is None:
            raise InputError(f"No spectrum of {name}: its record covers less than a revolution.")
        orders = spectrum.orders[1:] + (i - (len(results) - 1) / 2) * width
        amplitude = 1e3 * quantity.displayed(spectrum.amplitude[1:])
        known = amplitude > LEAST
        colour = style.SEVERAL[i]
        axes.vlines(orders[known], LEAST, amplitude[known], color=colour, linewidth=1.6)
        axes.plot(orders[known], amplitude[known], "o", color=colour, markersize=4, label=name)
    axes.set_yscale("log")
    axes.set_ylim(LEAST, None)
    axes.set_ylabel("amplitude [N mm]")
    axes.set_xlabel("order [1/revolution]")
    teeth = next(iter(results.values())).gear.pinion.teeth
    axes.set_xticks([1, *range(teeth, HIGHEST + 1, teeth)])
    style.legend_above(axes)
    head(figure, next(iter(results.values())), "Orders of the pinion torque", {})
    return figure
