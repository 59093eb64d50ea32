"""The picture of a result, by its scene; a scene names its function CHART_figure here."""

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rps_exudyn.analysis.impacts import find_impacts, split_at_repeats
from rps_exudyn.analysis.passes import Signals, passes
from rps_exudyn.analysis.rack_motion import transmission_error
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.curves import DIRECTIONS, Panel, add_measured, panels_over_angle
from rps_exudyn.pages.charts.style import head, scene_of
from rps_exudyn.results.law_error import LawError, error_of_law
from rps_exudyn.results.quantities import SIGNALS, Quantity
from rps_exudyn.results.result import MeasuredTorque, Result
from rps_exudyn.scenes import is_scene, scene_named

FORCES = ("[N m]", "[N]")  # units in which zero means something


def scene_figure(
    result: Result, measured: MeasuredTorque | None = None, *, from_zero: bool = False
) -> Figure:
    """The picture of a result that has signals; ordinates of torque and force begin at zero, or a mark shows
    that they do not. `measured` is drawn over it, by default the measured torque that the result keeps."""
    chart = scene_named(result.scene).chart if is_scene(result.scene) else "torque"
    figure: Figure = globals()[f"{chart}_figure"](result, result.measured if measured is None else measured)
    for axes in figure.axes:
        if axes.get_ylabel().endswith(FORCES):
            if from_zero:
                style.from_zero(axes)
            style.tell_where_it_begins(axes)
    return figure


def _named_lines(
    axes: Axes, x: np.ndarray, signals: Signals, curves: Mapping[str, tuple[str, str]], axis: str, unit: str
) -> None:
    """Draw those of the `curves` (signal -> legend, colour) that there are, as the signal `unit` is shown."""
    for name, (label, colour) in curves.items():
        if name in signals:
            style.line(axes, x, signals[name], SIGNALS[unit], axis, colour, label)


def _mark_clearance(axes: Axes, result: Result, label: str) -> None:
    """Mark the yoke's clearance in operation over the curves of displacements, and name all of them."""
    clearance = result.summary.get("operating_clearance", result.gear.yoke.clearance)
    axes.axhline(SIGNALS["rack_y"].displayed(clearance), **style.REFERENCE_LINE, label=label)
    style.name_curves(axes)


def draw(
    result: Result,
    path: str | Path | None = None,
    measured: MeasuredTorque | None = None,
    *,
    from_zero: bool = False,
) -> Figure:
    """Draw as `scene_figure`, and save it to `path`.

    Raises:
        InputError: the file cannot be written.
    """
    figure = scene_figure(result, measured, from_zero=from_zero)
    style.fix_margins(figure)
    if path is not None:
        style.save(figure, path)
    return figure


# --- Picture of a free pinion torque: torque over pinion angle, below it how the rack lifts and rolls
#
# For a record in both directions each torque is drawn against its motion, so that both are above zero and can
# be compared (the paper's Figure 16).

# signal -> name on the axis, colour, height [in], least span shown [display unit]
_FREE_TORQUE_PANELS = {
    "pinion_torque": ("pinion torque", "torque", 3.2, 0.05),
    "rack_y": ("rack lift", "lift", 1.6, 1.0),
    "rack_roll": ("rack roll", "roll", 1.6, 0.1),
}
_TORQUE = SIGNALS["pinion_torque"]
_ONE_WAY = {"torque_mean": "mean", "torque_peak_to_peak": "peak to peak"}
_BOTH_WAYS = {"torque_mean_forward": "mean towards +X", "torque_mean_backward": "towards -X"}


def torque_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; signals that the result's fidelity does not have get no panel."""
    figure, panels = panels_over_angle(result, _FREE_TORQUE_PANELS, measured)
    both_ways = len(passes(result.signals)) > 1
    law = error_of_law(result)
    for panel in (each for each in panels if each.name == "pinion_torque"):
        means = _means_in(panel, result, both_ways)
        if law is not None:
            _add_law_band(panel.axes, law, means)
        if not both_ways:
            for mean in means:
                name = "_" if law else "mean"  # the band's name has it
                panel.axes.axhline(_TORQUE.displayed(mean), **style.REFERENCE_LINE, label=name)
        style.name_curves(panel.axes)
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


# --- Picture of a gear driven by its rack: the force that pushes the rack, and how the rack lifts

# signal -> name on the axis, colour, height [in], least span shown [display unit]
_RACK_PUSH_PANELS = {
    "rack_force": ("force on the rack", "torque", 3.2, 1.0),
    "rack_y": ("rack lift", "lift", 1.6, 1.0),
}
_RACK_PUSH_METRICS = {
    "push_force_mean": "mean",
    "roller_force_mean": "mean",
    "push_force_peak_to_peak": "peak to peak",
}


def rack_push_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, without the lift if the fidelity has none; a measured pinion torque is not drawn."""
    figure, panels = panels_over_angle(result, _RACK_PUSH_PANELS)
    style.name_directions(panels[0].axes, {colour: label for label, colour in DIRECTIONS.values()})
    head(figure, result, scene_of(result), _RACK_PUSH_METRICS)
    return figure


# --- Picture of a load test: torque that raises the weight and torque that holds it while it is lowered
#
# The paper's Figure 17. Without losses both curves would lie on the dashed line.

_RAISES_OR_LOWERS = {+1: "raising", -1: "lowering"}
_LOAD_TEST_METRICS = {  # in the headline, where they are efficiencies, from 0 to 100 %
    "efficiency_forward": "efficiency forward",
    "efficiency_reverse": "reverse",
    "efficiency_forward_net": "net forward",
    "efficiency_reverse_net": "net reverse",
}


def load_test_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; the torque in the sense of the pinion angle, below zero where the gear is self-locking."""
    figure, (axes,) = style.panels([3.8])
    force = result.signals.get("load_force", np.zeros(0))  # on the rack's end towards -X [N]
    load = float(np.median(force)) if force.size else 0.0
    raises = -1 if load < 0 else 1
    for turned in passes(result.signals):
        angle = SIGNALS["pinion_angle"].displayed(turned.angle)
        torque, colour = turned.signals["pinion_torque"], DIRECTIONS[turned.direction][1]
        label = _RAISES_OR_LOWERS[raises * turned.direction]
        style.line(axes, angle, torque, SIGNALS["pinion_torque"], "pinion torque", colour, label)
    if measured is not None:
        add_measured(axes, measured, result.signals)
    if load and "rack_gain" in result.summary:
        ideal = load * result.summary["rack_gain"] / (2 * np.pi)
        axes.axhline(ideal, **style.REFERENCE_LINE, label="without losses")
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0), high)
    axes.axhline(0, color="black", linewidth=0.8)
    style.name_curves(axes)
    style.angle_axis(axes)
    locking = result.summary.get("torque_reverse", 0.0) < 0
    known = {
        name: label for name, label in _LOAD_TEST_METRICS.items() if 0 <= result.summary.get(name, 0) <= 1
    }
    head(figure, result, scene_of(result) + " · self-locking" * locking, known)
    return figure


# --- Picture of reversals: the loop of torque over angle, below it how the rack stays behind

_REVERSAL_METRICS = {
    "hysteresis_area": "loop",
    "torque_jump": "jump",
    "reversal_angle": "running again after",
    "lost_motion": "lost motion",
}
_LEAD = SIGNALS["rack_y"]  # of its unit: a deflection


def reversal_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; the rack's lead is its displacement beyond gain times pinion angle, from its mean."""
    figure, axes = style.panels([3.8, 2.0])
    angle = SIGNALS["pinion_angle"].displayed(result["pinion_angle"])
    style.line(axes[0], angle, result["pinion_torque"], SIGNALS["pinion_torque"], "pinion torque", "torque")
    axes[0].axhline(0, color="black", linewidth=0.8)
    lead = transmission_error(result.signals, GearPair.of(result.gear).travel_rule)
    style.line(axes[1], angle, lead, _LEAD, "rack's lead", "lift")
    if measured is not None:
        add_measured(axes[0], measured, result.signals)
    style.name_curves(axes[0])
    style.angle_axis(axes[-1])
    head(figure, result, scene_of(result), _REVERSAL_METRICS)
    return figure


# --- Picture of steering feel: the loop of torque over the wheel's angle, below it how the pinion lags

_FEEL_METRICS = {
    "feel_area": "loop",
    "feel_running_torque": "running",
    "on_centre_stiffness": "stiffness on centre",
    "feel_angle_hysteresis": "turned about after",
    "breakaway_ratio": "breakaway over running",
    "angle_dead_band": "dead band",
    "torque_dead_band": "dead band of torque",
}
_FEEL_CURVES = {"column_torque": ("column", "torque"), "wheel_torque": ("hand, with inertia", "other")}
_BEHIND = SIGNALS["column_twist"]  # of its unit: an angle


def steering_feel_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured torque over an angle is drawn as one of the wheel."""
    figure, axes = style.panels([3.8, 2.0])
    over = result.signals.get("wheel_angle", result["pinion_angle"])
    angle = SIGNALS["wheel_angle"].displayed(over)
    _named_lines(axes[0], angle, result.signals, _FEEL_CURVES, "torque at the wheel", "wheel_torque")
    axes[0].axhline(0, color="black", linewidth=0.8)
    style.line(axes[1], angle, over - result["pinion_angle"], _BEHIND, "pinion behind", "lift")
    if measured is not None:
        add_measured(axes[0], measured, result.signals)
    style.name_curves(axes[0])
    style.angle_axis(axes[-1])
    axes[-1].set_xlabel(SIGNALS["wheel_angle"].axis_label("wheel angle"))
    head(figure, result, scene_of(result), _FEEL_METRICS)
    return figure


# --- Picture of the rack's lift over the torque on the pinion, the rack held

_LIFT_METRICS = {"rack_lift": "lift", "rack_lift_end": "at the rack's end"}
_LIFT_CURVES = {
    "rack_y": ("rack at the pitch point", "lift"),
    "rack_end_y": ("rack's end", "torque"),
    "plunger_displacement": ("plunger", "roll"),
}


def lift_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, each curve from where it is without torque; a measured pinion torque is not drawn."""
    figure, (axes,) = style.panels([3.6])
    torque = result.signals.get("pinion_torque", np.zeros(0))
    if torque.size:
        moved = {name: each - each[0] for name, each in result.signals.items() if name in _LIFT_CURVES}
        _named_lines(axes, torque, moved, _LIFT_CURVES, "displacement from rest", "rack_y")
    _mark_clearance(axes, result, "yoke clearance")
    style.abscissa(axes, SIGNALS["pinion_torque"].axis_label("torque on the pinion"))
    head(figure, result, scene_of(result), _LIFT_METRICS)
    return figure


# --- Picture of the radial play: how far the rack's end yields to a force across it, along Y and along Z

_PLAY_METRICS = {"radial_play_y": "play along Y", "radial_play_z": "along Z"}
_PLAY_PARTS = {"rack_end": ("rack's end", "torque"), "rack": ("rack at the pitch point", "lift")}
_PLAY_AXES = {"y": "along Y, from the pinion", "z": "along Z, sideways"}


def play_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, one panel for each direction; a measured pinion torque is not drawn."""
    figure, axes = style.panels([2.6, 2.6])
    for panel, (axis, along) in zip(axes, _PLAY_AXES.items(), strict=True):
        for part, (label, colour) in _PLAY_PARTS.items():
            _yielding(panel, result, f"end_force_{axis}", f"{part}_{axis}", along, colour, label)
    style.name_curves(axes[0])
    style.abscissa(axes[-1], "force across the rack's end [N]")
    head(figure, result, scene_of(result), _PLAY_METRICS)
    return figure


_SHAFT_METRICS = {"input_shaft_play_radial": "radial play", "input_shaft_play_axial": "axial play"}
_SHAFT_AXES = {"y": "along Y", "across": "across Y", "axial": "along the shaft"}


def shaft_play_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture, one panel for each direction; a measured pinion torque is not drawn."""
    figure, axes = style.panels([2.0] * len(_SHAFT_AXES))
    for panel, (axis, along) in zip(axes, _SHAFT_AXES.items(), strict=True):
        _yielding(panel, result, f"shaft_force_{axis}", f"shaft_end_{axis}", along, "torque")
    style.abscissa(axes[-1], "force on the input shaft's end [N]")
    forces = [np.abs(each).max() for name, each in result.signals.items() if "shaft_force_" in name]
    largest = max(forces, default=1.0)
    axes[-1].set_xlim(-largest, largest)  # the panels share it, and the axial force is the smallest
    head(figure, result, scene_of(result), _SHAFT_METRICS)
    return figure


def _yielding(
    axes: Axes, result: Result, force: str, place: str, axis: str, colour: str, label: str | None = None
) -> None:
    """Draw how far a place has moved from rest over the force of this direction, where that is at work, with
    the instants at which it begins and ends; nothing where one of them was not kept."""
    pressing, at = result.signals.get(force, np.zeros(0)), result.signals.get(place)
    if pressing.size and at is not None:
        acting = pressing != 0
        shown = acting | np.roll(acting, 1) | np.roll(acting, -1)
        style.line(axes, pressing[shown], (at - at[0])[shown], SIGNALS["rack_y"], axis, colour, label)


# --- Picture of a yoke impact: force of the yokenut over the whole record, below it a close-up of its impacts

_IMPACT_METRICS = {
    "impacts": "impacts",
    "impact_peak_force": "largest force",
    "impact_impulse": "impulse",
    "impact_speed": "speed",
    "impact_contact_share": "in contact",
}
MILLISECONDS, TIME = 1e3, "time [ms]"
GROUP_GAP = 0.5e-3  # of time without contact between two groups of impacts [s]
GROUP_MARGIN = 0.15  # of the group, shown before and after it
WIDEST_GROUP = 0.6  # of the record: a group that fills more needs no closer look


def impact_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured pinion torque is not drawn."""
    window = impacts_shown(result)
    heights = [2.8, 2.2] if window is None else [1.8, 2.6, 2.2]
    figure, axes = style.panels(heights, common_abscissa=window is None)
    time = MILLISECONDS * result["time"]
    for panel in axes[:-1]:
        style.line(panel, time, result["yokenut_force"], SIGNALS["yokenut_force"], "yokenut force", "failure")
    _named_lines(axes[-1], time, result.signals, _RATTLE_CURVES, "displacement", "rack_y")
    _mark_clearance(axes[-1], result, "yokenut")
    style.abscissa(axes[-1], TIME)
    if window is not None:
        whole, *close = axes
        style.abscissa(whole, TIME)
        whole.axvspan(*window, **style.BAND)
        for panel in close:
            panel.set_xlim(*window)
        close[0].tick_params(labelbottom=False)
        close[0].set_title("the shaded part", loc="left", fontsize=10)
    head(figure, result, scene_of(result), _IMPACT_METRICS)
    return figure


def impacts_shown(result: Result) -> tuple[float, float] | None:
    """Return begin and end of the group of impacts with the largest force [ms]; None where there is none, or
    where it fills most of the record."""
    time, force = result["time"], result["yokenut_force"]
    found = find_impacts(time, force, result["plunger_displacement"]) if time.size > 1 else []
    if not found:
        return None
    begins = np.array([each.start for each in found])
    ends = begins + [each.duration for each in found]
    group = np.cumsum([0, *(begins[1:] - ends[:-1] >= GROUP_GAP)])
    chosen = group == group[np.argmax([each.peak_force for each in found])]
    begin, end = begins[chosen][0], ends[chosen][-1]
    if end - begin > WIDEST_GROUP * np.ptp(time):
        return None
    margin = GROUP_MARGIN * (end - begin)
    low, high = max(begin - margin, time[0]), min(end + margin, time[-1])
    return MILLISECONDS * float(low), MILLISECONDS * float(high)


# --- Picture of a rattling gear: forces of road and yokenut over time, below them the plunger and the rack

_RATTLE_METRICS = {
    "rattle_force_rms": "force RMS",
    "rattle_speed_rms": "impact speed RMS",
    "rattle_impulse_per_cycle": "impulse per cycle",
    "rattle_impacts_per_cycle": "impacts per cycle",
}
_RATTLE_FORCES = {"road_force": "torque", "yokenut_force": "failure"}
_RATTLE_CURVES = {"plunger_displacement": ("plunger", "lift"), "rack_y": ("rack lift", "roll")}


def rattle_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture of the first run; a measured pinion torque is not drawn."""
    figure, axes = style.panels([1.6, 2.6, 2.2])
    signals = next(iter(split_at_repeats(result.signals)), result.signals)
    time = MILLISECONDS * signals.get("time", np.zeros(0))
    for panel, (name, colour) in zip(axes, _RATTLE_FORCES.items(), strict=False):
        if name in signals:
            style.line(panel, time, signals[name], SIGNALS[name], name.replace("_", " "), colour)
    _named_lines(axes[2], time, signals, _RATTLE_CURVES, "displacement", "rack_y")
    _mark_clearance(axes[2], result, "yokenut")
    style.abscissa(axes[-1], TIME)
    head(figure, result, scene_of(result), _RATTLE_METRICS)
    return figure


# --- Picture of stick-slip: torque at the wheel over time, below it how fast the pinion turns

_STICK_SLIP_METRICS = {
    "stick_share": "sticks",
    "stick_slip_torque": "amplitude",
    "stick_slip_frequency": "frequency",
    "sticking_speed": "predicted up to",
    "breakaway_ratio": "breakaway over running",
}
_PINION_SPEED = Quantity("rad/s", "rad/s", "speed of the pinion")


def stick_slip_figure(result: Result, measured: MeasuredTorque | None = None) -> Figure:
    """The picture; a measured torque over an angle is not drawn."""
    figure, axes = style.panels([2.6, 2.2])
    name = "column_torque" if "column_torque" in result.signals else "pinion_torque"
    time = MILLISECONDS * result["time"]
    style.line(axes[0], time, result[name], SIGNALS[name], "torque at the wheel", "torque")
    angle = result["pinion_angle"]
    speed = np.gradient(angle, result["time"]) if angle.size > 1 else np.full(angle.size, np.nan)
    style.line(axes[1], time, speed, _PINION_SPEED, "pinion's speed", "lift")
    wheel = result.gear.test.direction * result.gear.test.speed
    axes[1].axhline(wheel, **style.REFERENCE_LINE, label="wheel")
    style.name_curves(axes[1])
    style.abscissa(axes[-1], TIME)
    head(figure, result, scene_of(result), _STICK_SLIP_METRICS)
    return figure
