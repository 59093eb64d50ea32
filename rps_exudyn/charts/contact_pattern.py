"""Picture of the contact pattern: the largest pressure on each point of the unrolled flanks."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from rps_exudyn.analysis.contact_pattern import contact_pattern, one_pitch
from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.charts import style
from rps_exudyn.charts.heading import head
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.results.result import Result

FLANKS = {-1: "flanks that drive the rack towards +X", +1: "flanks that drive it towards -X"}
MILLIMETRES, MEGAPASCAL = 1e3, 1e-6


def pattern_figure(result: Result) -> Figure:
    """The picture of both sides over one tooth pitch in the middle of the first pass, all teeth superimposed.

    Raises:
        InputError: the record has no pass, or lacks the rack's motions.
    """
    runs = passes(result.signals)
    if not runs:
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
        panel.set_title(
            f"{FLANKS[pattern.side]}: up to {pattern.pressure.max() * MEGAPASCAL:.0f} MPa",
            loc="left",
            fontsize=10,
        )
        panel.set_xlabel("along the face [mm]")
        panel.set_facecolor("#f2f2f2")
    axes[0].set_ylabel("length of roll from the base circle [mm]")
    figure.colorbar(shown, ax=axes, label="largest pressure [MPa]", pad=0.01)
    head(figure, result, "Contact pattern over one tooth pitch", {})
    return figure
