"""Picture of a free pinion torque: torque over pinion angle, below it how the rack lifts and rolls.

For a record in both directions each torque is drawn against its motion, so that both are above zero and can
be compared (the paper's Figure 16).
"""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.passes import passes
from rps_exudyn.charts import style
from rps_exudyn.charts.curves import DIRECTIONS, Panel, panels_over_angle
from rps_exudyn.charts.heading import head, scene_of
from rps_exudyn.results.law_error import LawError, law_error
from rps_exudyn.results.measured_torque import MeasuredTorque
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result

# signal -> name on the axis, colour, height [in], least span shown [display unit]
_PANELS = {
    "pinion_torque": ("pinion torque", "torque", 3.2, 0.05),
    "rack_y": ("rack lift", "lift", 1.6, 1.0),
    "rack_roll": ("rack roll", "roll", 1.6, 0.1),
}
_TORQUE = SIGNALS["pinion_torque"]
_ONE_WAY = {"torque_mean": "mean", "torque_peak_to_peak": "peak to peak"}
_BOTH_WAYS = {"torque_mean_forward": "mean towards +X", "torque_mean_backward": "towards -X"}


def torque_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; signals that the result's fidelity does not have get no panel."""
    figure, panels = panels_over_angle(result, _PANELS, measured)
    both_ways = len(passes(result.signals)) > 1
    law = law_error(result.gear, result.fidelity)
    for panel in panels:
        if panel.name != "pinion_torque":
            continue
        means = _means_in(panel, result, both_ways)
        if law is not None and result.status is Status.OK:
            _add_law_band(panel.axes, law, means)
        if not both_ways:
            for mean in means:
                panel.axes.axhline(_TORQUE.displayed(mean), **style.REFERENCE_LINE, label="mean")
        style.legend_above(panel.axes)
    head(figure, result, scene_of(result), _BOTH_WAYS if both_ways else _ONE_WAY)
    return figure


def _means_in(panel: Panel, result: Result, both_ways: bool) -> list[float]:
    """The summary's means of the torques that a panel shows, with the sign that they have there [N m]."""
    if both_ways:
        of_direction = dict(zip(DIRECTIONS, _BOTH_WAYS, strict=True))
        names = [of_direction[panel.direction]] if panel.direction else list(of_direction.values())
        return [result.summary[name] for name in names if name in result.summary]
    turned = [each.direction for each in passes(result.signals)]
    shown = "torque_mean" in result.summary and (not panel.direction or panel.direction in turned)
    return [(panel.direction or 1) * result.summary["torque_mean"]] if shown else []


def _add_law_band(axes: Axes, law: LawError, means: Iterable[float]) -> None:
    """Shade where mean torques [N m] are by finite elements of whole teeth, as the law's error has it."""
    label = f"mean, with the error of law {law.law}"
    for mean in means:
        if not np.isfinite(mean):
            continue
        low, high = sorted(_TORQUE.displayed(each) for each in law.elastic_range(mean))
        axes.axhspan(low, high, label=label, **style.BAND)
        label = "_"
        (bottom, top), margin = axes.get_ylim(), 0.1 * (high - low)
        axes.set_ylim(min(bottom, low - margin), max(top, high + margin))
