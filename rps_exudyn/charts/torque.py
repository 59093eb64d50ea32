"""Picture of a free pinion torque: torque over pinion angle, below it how the rack lifts and rolls.

For a record in both directions each torque is drawn against its motion, so that both are above zero and can
be compared (the paper's Figure 16).
"""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.measured import MeasuredTorque
from rps_exudyn.analysis.passes import passes
from rps_exudyn.charts import style
from rps_exudyn.charts.curves import add_measured, panels_over_angle
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.law_error import LawError, law_error
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result

# signal -> name on the axis, colour, height [in], least span shown [display unit]
_PANELS = {
    "pinion_torque": ("pinion torque", "torque", 3.2, 0.05),
    "rack_y": ("rack lift", "lift", 1.6, 1.0),
    "rack_roll": ("rack roll", "roll", 1.6, 0.1),
}
_ONE_WAY = {"torque_mean": "mean", "torque_peak_to_peak": "peak to peak"}
_BOTH_WAYS = {"torque_mean_forward": "mean towards +X", "torque_mean_backward": "towards -X"}


def torque_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; signals that the result's fidelity does not have get no panel."""
    figure, axes = panels_over_angle(result, _PANELS)
    both_ways = len(passes(result.signals)) > 1
    if measured is not None:
        add_measured(axes[0], measured, against_motion=both_ways)
    law = law_error(result.gear, result.fidelity)
    if law is not None and result.status is Status.OK:
        _add_law_band(axes[0], result, law, _BOTH_WAYS if both_ways else _ONE_WAY)
    if not both_ways and "torque_mean" in result.summary:
        mean = SUMMARY["torque_mean"].displayed(result.summary["torque_mean"])
        axes[0].axhline(mean, **style.REFERENCE_LINE, label="mean")
    style.legend_above(axes[0])
    head(figure, result, scene_of(result), _BOTH_WAYS if both_ways else _ONE_WAY)
    return figure


def _add_law_band(axes: Axes, result: Result, law: LawError, means: Iterable[str]) -> None:
    """Shade where the mean torques are by finite elements of whole teeth, as the law's error has it."""
    label = f"mean, with the error of law {law.law} against finite elements"
    for name in means:
        mean = result.summary.get(name, np.nan)
        if not name.startswith("torque_mean") or not np.isfinite(mean):
            continue
        low, high = (SUMMARY[name].displayed(each) for each in law.elastic_range(mean))
        axes.axhspan(low, high, label=label, **style.BAND)
        label = "_"
        (bottom, top), margin = axes.get_ylim(), 0.1 * (high - low)
        axes.set_ylim(min(bottom, low - margin), max(top, high + margin))
