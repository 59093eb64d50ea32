"""Time against error of the package and of its peers: one picture."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.peers.rounds import Row
from rps_exudyn.pages.charts import style

STYLES = {
    "quasi-static": ("#274e13", "^"),
    "flank": ("#0b5394", "o"),
    "full": ("#b00020", "s"),
    "MuJoCo, spheres": ("#e69138", "D"),
    "MuJoCo, convex pieces": ("#b45f06", "v"),
    "Drake, hydroelastic": ("#674ea7", "P"),
    "Newton, spheres": ("#45818e", "X"),
}
"""Colour and marker of each program."""


def work_precision_figure(rows: Sequence[Row], floor: float) -> Figure:
    """Whole runs filled, the loop alone hollow below; error to the right, time upwards, in decades."""
    figure, (axes,) = style.panels([5.4], 9.0)
    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    for program, (colour, marker) in STYLES.items():
        own = sorted((row for row in rows if row.program == program and row.ok), key=lambda row: row.error)
        if own:
            _draw(axes, own, floor, colour, marker)
    axes.axvline(1.0, **style.REFERENCE_LINE)
    axes.set_xlabel("error, RMS over a turn [% of the mean]")
    axes.set_ylabel("CPU time per turn [s]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False, borderpad=0)
    style.title(figure, "The same gear in several programs: whole runs (filled), the loop alone (hollow)")
    return figure


def _draw(axes: Axes, rows: Sequence[Row], floor: float, colour: str, marker: str) -> None:
    error = [max(row.error, floor) for row in rows]
    whole, loop = [row.whole_s for row in rows], [row.loop_s for row in rows]
    axes.plot(error, whole, marker + "-", color=colour, markersize=6, label=rows[0].program)
    axes.plot(error, loop, marker, color=colour, fillstyle="none", markersize=5)
    axes.vlines(error, loop, whole, colors=colour, linewidth=0.6, alpha=0.6)
