"""Pictures of what is computed from results: differences of two, loads and pattern of the contact."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.contact_pattern import contact_pattern, one_pitch
from rps_exudyn.analysis.load_distribution import LoadDistribution, load_distribution, mesh_stiffness
from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.result_comparison import ResultComparison
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.style import head
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

# --- Two results: both torques over the pinion angle, below them their difference


def draw_comparison(comparison: ResultComparison, names: tuple[str, str], path: str | Path) -> None:
    """Save the picture of two results with these names.

    Raises:
        InputError: their torques have no pinion angles in common, or the file cannot be written.
    """
    if "pinion_torque" not in comparison.signals:
        raise InputError(f"{path} is not drawn: the two results share no range of the pinion angle.")
    style.save(comparison_figure(comparison, names), path)


def comparison_figure(comparison: ResultComparison, names: tuple[str, str]) -> Figure:
    """The picture; the difference is second minus first, in % of the first's mean torque."""
    figure, (both, apart) = style.panels([3.2, 2.0])
    torque = comparison.signals["pinion_torque"]
    angle = SIGNALS["pinion_angle"].displayed(comparison.angle)
    style.line(both, angle, torque.first, SIGNALS["pinion_torque"], "pinion torque", "torque", names[0])
    style.line(both, angle, torque.second, SIGNALS["pinion_torque"], "pinion torque", "other", names[1])
    both.lines[1].set_linestyle((0, (5, 2)))  # the first shows through where they agree
    style.widen(both, 0.05)
    style.name_curves(both)
    if torque.mean:
        apart.plot(angle, 100 * torque.difference / abs(torque.mean), color=style.COLOURS["failure"])
        apart.set_ylabel("difference [% of mean]")
    else:
        style.line(apart, angle, torque.difference, SIGNALS["pinion_torque"], "difference", "failure")
    apart.axhline(0, **style.REFERENCE_LINE)
    style.angle_axis(apart)
    differences = f"RMS {torque.shown(torque.rms)} · largest {torque.shown(torque.largest)}"
    style.title(figure, f"Pinion torque of {names[1]} against {names[0]} · {differences}")
    return figure


# --- Picture of the loads on the lines of contact: force of each, the densest, stiffness of the mesh

FLANK_NAMES = {-1: "drive flanks", +1: "coast flanks"}
NEWTON_PER_MILLIMETRE = 1e-3
NEWTON_PER_MICROMETRE = 1e-6
LEAST_FORCE = 1e-3  # of the largest force: a line that never carries more is not drawn


def load_figure(result: Result) -> Figure:
    """The picture of the first pass: forces of the lines, largest loads per length, stiffness of the mesh.

    Raises:
        InputError: the record has no pass, lacks the rack's motions, or its law has no load per length.
    """
    if not (runs := passes(result.signals)):
        raise InputError("No load distribution: the pinion does not turn in this result.")
    loads = load_distribution(result.gear, runs[0].signals)
    figure, axes = style.panels([2.2, 2.2, 2.0, 2.0])
    for panel, side in zip(axes, FLANK_NAMES, strict=False):
        _forces(panel, loads, side)
    _densest(axes[2], loads)
    along_x = NEWTON_PER_MICROMETRE * mesh_stiffness(result.gear, runs[0].signals)[:, 0]
    axes[3].plot(SIGNALS["pinion_angle"].displayed(runs[0].angle), along_x, color="black")
    axes[3].set_ylabel("mesh stiffness\nalong X [N/µm]")
    style.widen(axes[3], 0.2 * float(along_x.max()))
    style.angle_axis(axes[-1])
    head(figure, result, "Loads on the lines of contact", {})
    return figure


def _forces(axes: Axes, loads: LoadDistribution, side: int) -> None:
    angle = SIGNALS["pinion_angle"].displayed(loads.angle)
    whole = loads.force_on(side)
    lines = [line for line in loads.lines if line[0] == side]
    shown = [line for line in lines if loads.force_of(*line).max() > LEAST_FORCE * max(whole.max(), 1e-300)]
    for k, (_, tooth) in enumerate(shown):
        colour, label = style.SEVERAL[k % len(style.SEVERAL)], f"rack tooth {tooth}"
        if len(shown) > len(style.SEVERAL):
            label = "_" if k else f"{len(shown)} rack teeth, colours in turn"
        axes.plot(angle, loads.force_of(side, tooth), color=colour, label=label)
    axes.plot(angle, whole, color="black", linewidth=0.8, linestyle="--", label="all")
    axes.set_ylabel(f"{FLANK_NAMES[side]} [N]")
    axes.set_ylim(0, None)
    style.name_curves(axes)


def _densest(axes: Axes, loads: LoadDistribution) -> None:
    angle = SIGNALS["pinion_angle"].displayed(loads.angle)
    for side, colour in zip(FLANK_NAMES, style.SEVERAL, strict=False):
        largest = np.zeros(loads.angle.size)
        chosen = loads.side == side
        np.maximum.at(largest, loads.instant[chosen], loads.load[chosen])
        axes.plot(angle, NEWTON_PER_MILLIMETRE * largest, color=colour, label=FLANK_NAMES[side])
    axes.set_ylabel("largest load\n[N/mm]")
    axes.set_ylim(0, None)
    style.name_curves(axes)


# --- Picture of the contact pattern: the largest pressure on each point of the unrolled flanks

PATTERN_FLANKS = {-1: "flanks that drive the rack towards +X", +1: "flanks that drive it towards -X"}
MILLIMETRES, MEGAPASCAL = 1e3, 1e-6


def pattern_figure(result: Result) -> Figure:
    """The picture of both sides over one tooth pitch in the middle of the first pass, all teeth superimposed.

    Raises:
        InputError: the record has no pass, or lacks the rack's motions.
    """
    if not (runs := passes(result.signals)):
        raise InputError("No contact pattern: the pinion does not turn in this result.")
    signals = one_pitch(runs[0].signals, result.gear.pinion.teeth)
    patterns = contact_pattern(result.gear, signals)
    pair = GearPair.of(result.gear)
    pitch = pair.reference_radius * np.sin(pair.alpha_t)
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=(9.5, 4.2), layout="constrained")
        axes = figure.subplots(1, 2, sharey=True)
    highest = max(pattern.pressure.max() for pattern in patterns) * MEGAPASCAL
    for panel, pattern in zip(axes, patterns, strict=True):
        pressure = np.ma.masked_equal(pattern.pressure * MEGAPASCAL, 0)
        face, roll = MILLIMETRES * pattern.face, MILLIMETRES * pattern.roll
        shown = panel.pcolormesh(face, roll, pressure, cmap="viridis", vmin=0, vmax=highest, rasterized=True)
        panel.axhline(MILLIMETRES * pitch, **style.REFERENCE_LINE)
        panel.text(face[-1], MILLIMETRES * pitch, "pitch line ", ha="right", va="bottom", fontsize=8.5)
        most = f"up to {pattern.pressure.max() * MEGAPASCAL:.0f} MPa"
        panel.set_title(f"{PATTERN_FLANKS[pattern.side]}: {most}", loc="left", fontsize=10)
        panel.set_xlabel("along the face [mm]")
        panel.set_facecolor("#f2f2f2")
    axes[0].set_ylabel("length of roll from the base circle [mm]")
    figure.colorbar(shown, ax=axes, label="largest pressure [MPa]", pad=0.01)
    head(figure, result, "Contact pattern over one tooth pitch", {})
    return figure
