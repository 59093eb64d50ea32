"""Picture of two results: both torques over the pinion angle, below them their difference."""

from pathlib import Path

from matplotlib.figure import Figure

from rps_exudyn.analysis.comparison import Comparison
from rps_exudyn.base.errors import InputError
from rps_exudyn.charts import style
from rps_exudyn.results.quantities import SIGNALS


def draw_comparison(comparison: Comparison, names: tuple[str, str], path: str | Path) -> None:
    """Save the picture of two results with these names.

    Raises:
        InputError: their torques have no pinion angles in common, or the file cannot be written.
    """
    if "pinion_torque" not in comparison.signals:
        raise InputError(f"{path} is not drawn: the two results share no range of the pinion angle.")
    style.save(comparison_figure(comparison, names), path)


def comparison_figure(comparison: Comparison, names: tuple[str, str]) -> Figure:
    """The picture; the difference is second minus first, in % of the first's mean torque."""
    figure, (both, apart) = style.panels([3.2, 2.0])
    torque = comparison.signals["pinion_torque"]
    angle = SIGNALS["pinion_angle"].displayed(comparison.angle)
    style.line(both, angle, torque.first, SIGNALS["pinion_torque"], "pinion torque", "torque", names[0])
    style.line(both, angle, torque.second, SIGNALS["pinion_torque"], "pinion torque", "other", names[1])
    both.lines[1].set_linestyle((0, (5, 2)))  # the first shows through where they agree
    style.widen(both, 0.05)
    style.legend_above(both)
    if torque.mean:
        apart.plot(angle, 100 * torque.difference / abs(torque.mean), color=style.COLOURS["failure"])
        apart.set_ylabel("difference [% of mean]")
    else:
        style.line(apart, angle, torque.difference, SIGNALS["pinion_torque"], "difference", "failure")
    apart.axhline(0, **style.REFERENCE_LINE)
    style.angle_axis(apart)
    headline = f"Pinion torque of {names[1]} against {names[0]}"
    figures = f"RMS {torque.shown(torque.rms)} · largest {torque.shown(torque.largest)}"
    style.title(figure, f"{headline} · {figures}")
    return figure
