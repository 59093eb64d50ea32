"""Every scene has its picture, drawn from signals alone; a measured curve lies over every torque."""

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from benchmarks.charts import losses_figure, map_to_scale, spectrum_figure, torques_figure
from picture_faults import names_of
from rps_exudyn.analysis.measured import compare_with_measured
from rps_exudyn.base.errors import InputError
from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.curves import AT_REVERSAL, NOT_SIMULATED
from rps_exudyn.pages.charts.scene_figures import draw, load_test_figure, torque_figure
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import MeasuredTorque, Result, content_of
from rps_exudyn.scenes import SCENE_NAMES
from rps_exudyn.study.case_blocks import load
from shell import Command


@pytest.fixture
def there_and_back(made_up_result: Result) -> Result:
    """Two turns and back, with everything that a scene's picture may look for."""
    forward = np.linspace(-2 * np.pi, 2 * np.pi, 481)
    angle = np.concatenate([forward, forward[-2::-1]])
    rising = np.arange(angle.size) <= 480
    signals = {
        "time": np.arange(angle.size) / 100,
        "pinion_angle": angle,
        "pinion_torque": np.where(rising, 0.6, -0.58) + 0.01 * np.cos(6 * angle),
        "rack_force": np.where(rising, 110.0, -110.0),
        "load_force": np.full_like(angle, 98.0665),
        "rack_displacement": 0.00557 * angle,
        "rack_y": 3e-6 * np.cos(angle),
        "yokenut_force": np.maximum(100 * np.cos(angle), 0),
        "plunger_displacement": 3e-6 * np.cos(angle),
        "work_drive": 0.6 * np.arange(angle.size),
        "work_mesh_friction": 0.4 * np.arange(angle.size),
        "work_seat_friction": 0.2 * np.arange(angle.size),
    }
    return dataclasses.replace(made_up_result, signals=signals)


@pytest.fixture
def measured() -> MeasuredTorque:
    """A synthetic curve that stands for a measured one."""
    angle = np.concatenate([np.linspace(-3, 3, 60), np.linspace(3, -3, 60)])
    torque = 0.61 * np.repeat([1, -1], 60)
    return MeasuredTorque("bench", {"pinion_angle": angle, "pinion_torque": torque})


@pytest.mark.parametrize("scene", SCENE_NAMES)
def test_every_scene_is_drawn_with_a_measured_curve_too(
    scene: str, there_and_back: Result, measured: MeasuredTorque, tmp_path: Path
) -> None:
    draw(dataclasses.replace(there_and_back, scene=scene), tmp_path / "a.png", measured)
    assert (tmp_path / "a.png").stat().st_size > 5000


@pytest.mark.parametrize("scene", SCENE_NAMES)
@pytest.mark.parametrize("case", ["nan", "huge", "one sample", "nothing recorded", "mean values only"])
def test_failed_and_simple_results_are_drawn_too(
    scene: str, case: str, there_and_back: Result, tmp_path: Path
) -> None:
    """Warnings are errors here: matplotlib must be spared what it cannot draw."""
    signals, summary = {name: values.copy() for name, values in there_and_back.signals.items()}, {}
    if case in ("nan", "huge"):
        for name in signals.keys() - {"time"}:
            signals[name][60:] = np.nan if case == "nan" else -1e30
        summary = {"torque_mean": np.inf if case == "huge" else np.nan}
    elif case == "mean values only":
        signals = {name: values for name, values in signals.items() if name != "rack_y"}
    else:
        signals = {name: values[: int(case == "one sample")] for name, values in signals.items()}
    failed = {"status": Status.DIVERGED, "summary": there_and_back.summary | summary}
    draw(dataclasses.replace(there_and_back, scene=scene, signals=signals, **failed), tmp_path / "a.png")


def test_both_directions_are_drawn_against_their_motion(there_and_back: Result) -> None:
    torque = torque_figure(there_and_back).axes[0]
    assert torque.get_ylabel() == "torque against the motion [N m]"
    assert names_of(torque) == ["towards +X", "towards -X"]
    for line, level in zip(torque.lines, (0.6, 0.58), strict=True):
        assert np.mean(line.get_ydata()) == pytest.approx(level, abs=1e-3)


def measured_lines(axes: Axes) -> list[Line2D]:
    return [line for line in axes.lines if line.get_color() == style.COLOURS["measured"]]


def test_measured_curve_of_a_load_test_has_the_sense_of_the_simulated(
    there_and_back: Result, measured: MeasuredTorque
) -> None:
    (torque,) = load_test_figure(there_and_back, measured).axes
    assert "measured: bench" in names_of(torque)
    levels = [np.mean(line.get_ydata()) for line in measured_lines(torque)]
    assert levels == pytest.approx([0.61, -0.61])


@pytest.mark.parametrize("recorded", ["there and back", "there", "back"])
def test_both_directions_of_a_measured_torque_have_a_panel_each(
    recorded: str, there_and_back: Result, measured: MeasuredTorque
) -> None:
    """Against the motion, so that an axis spans the ripple and not both signs."""
    part = {"there and back": slice(None), "there": slice(481), "back": slice(481, None)}[recorded]
    signals = {name: values[part] for name, values in there_and_back.signals.items()}
    summary = {"torque_mean": float(np.mean(signals["pinion_torque"]))}
    result = dataclasses.replace(there_and_back, signals=signals, summary=summary, errors={})
    forward, backward, *_ = torque_figure(result, measured).axes
    for axes, direction in ((forward, "there"), (backward, "back")):
        low, high = axes.get_ylim()
        assert 0.5 < low < high < 0.7
        (line,) = measured_lines(axes)
        assert np.mean(line.get_ydata()) == pytest.approx(0.61)
        labels = names_of(axes)
        assert "measured: bench" in labels
        assert ("simulated" if direction in recorded else NOT_SIMULATED) in labels


@pytest.mark.parametrize("lag", [0, 3])
def test_samples_just_after_a_reversal_are_marked_and_scale_no_axis(
    lag: int, there_and_back: Result, measured: MeasuredTorque
) -> None:
    """They have the new direction and the old sign, as far as the channel of the torque is late."""
    late = np.roll(measured.signals["pinion_torque"], lag)
    late[:lag] = 0.61
    curve = MeasuredTorque("bench", measured.signals | {"pinion_torque": late})
    panels = torque_figure(there_and_back, curve).axes
    assert [axes.get_ylabel().split("\n")[0] for axes in panels] == [
        "torque towards +X",
        "torque towards -X",
        "measured",
    ]
    assert all(np.ptp(axes.get_ylim()) < 0.15 for axes in panels)
    marked = AT_REVERSAL.format(lag - 1)  # the first of them still stands at the turn
    assert (marked in names_of(panels[1])) == (lag > 0)
    (_, back) = compare_with_measured(curve, there_and_back.signals, 6)
    assert back.measured["torque_mean"] == pytest.approx(-0.61)


@pytest.mark.parametrize("level", [0.05, 0.61, 5.0])
def test_measured_curve_lies_inside_the_axes_over_the_simulated_angles(
    level: float, made_up_result: Result
) -> None:
    """Angles from -180 to 180 deg lie in two pieces over the simulated turn from 0 to 360 deg."""
    angle = np.linspace(-np.pi, np.pi, 181)
    measured = MeasuredTorque("bench", {"pinion_angle": angle, "pinion_torque": level + 0.1 * np.cos(angle)})
    torque = torque_figure(made_up_result, measured).axes[0]
    assert torque.get_xlim() == pytest.approx((0, 360))
    pieces = measured_lines(torque)
    assert sum(len(line.get_xdata()) for line in pieces) == angle.size
    for line in pieces:
        for values, limits in (
            (line.get_xdata(), torque.get_xlim()),
            (line.get_ydata(), torque.get_ylim()),
        ):
            assert limits[0] - 1e-6 <= np.min(values)
            assert np.max(values) <= limits[1] + 1e-6


def test_a_result_keeps_the_measured_torque_and_report_and_show_have_it(
    made_up_result: Result, measured: MeasuredTorque, command: Command
) -> None:
    dataclasses.replace(made_up_result, measured=measured).save("r.h5")
    found = load("r.h5").measured
    assert found is not None
    assert found.name == "bench"
    for name, values in measured.signals.items():
        np.testing.assert_array_equal(found.signals[name], values)
    shown = command(["show", "r.h5", "--plot", "r.svg"])
    assert "Torque towards +X, pinion angles of" in shown.out
    assert "measured" in json.loads(command(["show", "r.h5", "--json"]).out)
    assert command(["report", "r.h5"]).status == 0
    page = Path("r.html").read_text(encoding="utf-8")
    assert page.count(">measured: bench<") == 4  # in the legend of each direction, wide and narrow
    assert "Comparison with bench" in page
    assert "difference: RMS" in shown.out
    assert "Difference: RMS" in page


def replaced(group: h5py.Group, name: str, data: object) -> None:
    del group[name]
    group.create_dataset(name, data=data)


@pytest.mark.parametrize(
    "damage",
    [
        lambda group: group.pop("pinion_torque"),
        lambda group: group.attrs.pop("name"),
        lambda group: group.attrs.create("name", 3),
        lambda group: replaced(group, "pinion_angle", np.full(120, np.nan)),
        lambda group: replaced(group, "pinion_angle", np.zeros((3, 2))),
        lambda group: replaced(group, "pinion_angle", np.zeros(3)),
        lambda group: replaced(group, "pinion_angle", "text"),
        lambda group: (group.pop("pinion_angle"), group.create_group("pinion_angle")),
    ],
)
def test_a_damaged_measured_torque_is_refused(
    damage: Callable[[h5py.Group], object], made_up_result: Result, measured: MeasuredTorque, tmp_path: Path
) -> None:
    """In a file without a checksum, as versions before 1.2 wrote them."""
    content = content_of(dataclasses.replace(made_up_result, measured=measured))
    (tmp_path / "r.h5").write_bytes(content)
    with h5py.File(tmp_path / "r.h5", "r+") as file:
        damage(file["measured"])
    with pytest.raises(InputError, match=r"r\.h5 is damaged"):
        load(tmp_path / "r.h5")


def test_load_test_shows_the_torque_without_losses_and_says_self_locking(there_and_back: Result) -> None:
    locking = {"rack_gain": 0.035, "torque_reverse": -0.1}
    figure = load_test_figure(dataclasses.replace(there_and_back, summary=locking, errors={}))
    (ideal,) = (line for line in figure.axes[0].lines if line.get_label() == "without losses")
    assert ideal.get_ydata()[0] == pytest.approx(98.0665 * 0.035 / (2 * np.pi))
    assert "self-locking" in figure.get_suptitle()


def test_spectrum_shows_each_order_at_its_amplitude(there_and_back: Result) -> None:
    (axes,) = spectrum_figure({"a": there_and_back}).axes
    (dots,) = (line for line in axes.lines if line.get_label() == "a")
    (amplitude,) = dots.get_ydata()[dots.get_xdata() == 6]
    assert amplitude == pytest.approx(10, rel=1e-2)  # [N mm]
    short = {name: values[:100] for name, values in there_and_back.signals.items()}
    with pytest.raises(InputError, match="less than a revolution"):
        spectrum_figure({"a": dataclasses.replace(there_and_back, signals=short)})


def test_losses_are_stacked_to_the_torque(there_and_back: Result) -> None:
    (axes,) = losses_figure(there_and_back).axes
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["drive", "teeth 66.7 %", "plunger's seat 33.3 %"]
    with pytest.raises(InputError, match="no record of work"):
        losses_figure(
            dataclasses.replace(there_and_back, signals={"time": np.zeros(3), "pinion_angle": np.zeros(3)})
        )


def test_several_results_are_distinguished(there_and_back: Result) -> None:
    (axes,) = torques_figure({"one": there_and_back, "two": there_and_back}, "Both").axes
    assert names_of(axes) == ["one", "two"]
    assert len({line.get_color() for line in axes.lines}) == 2


def struck(result: Result, *impacts: tuple[float, float, float]) -> Result:
    """A yoke impact of one second whose nut is struck by half sines: begin, end [s], force [N]."""
    time = np.linspace(0, 1, 4001)
    force = np.zeros_like(time)
    for begin, end, size in impacts:
        inside = (time > begin) & (time < end)
        force[inside] = size * np.sin(np.pi * (time[inside] - begin) / (end - begin))
    signals = {"time": time, "yokenut_force": force, "plunger_displacement": 1e-8 * force}
    return dataclasses.replace(result, scene="yoke-impact", signals=signals, summary={}, errors={})


def test_impact_is_drawn_large(made_up_result: Result) -> None:
    """The group with the largest force, in panels of its own; nothing is cut from the whole record."""
    result = struck(made_up_result, (0.1, 0.11, 300), (0.5, 0.51, 900), (0.5103, 0.52, 400))
    whole, force, plunger = draw(result).axes
    assert whole.get_xlim() == pytest.approx((0, 1000))
    for close in (force, plunger):
        assert close.get_xlim() == pytest.approx((500 - 3, 520 + 3), abs=0.5)  # ms, with 15 % on each side
    assert len(draw(struck(made_up_result)).axes) == 2  # never struck
    assert len(draw(struck(made_up_result, (0.1, 0.9, 300))).axes) == 2  # all of it


def test_map_has_its_cells_where_they_belong() -> None:
    """Halfway between uneven places; figures are dark on bright cells and bright on dark ones."""
    _, (axes,) = style.panels([3.0])
    x, y = np.array([1.0, 2.0]), np.array([0.0, 1.0, 5.0])
    values = np.array([[0.0, 10.0], [5.0, np.nan], [10.0, 0.0]])
    image = map_to_scale(axes, x, y, values, "{:.0f}", "none")
    corners = image.get_coordinates()
    np.testing.assert_allclose(corners[:, 0, 1], [-0.5, 0.5, 3.0, 7.0])
    np.testing.assert_allclose(corners[0, :, 0], [0.5, 1.5, 2.5])
    colours = {(text.get_text(), text.get_color()) for text in axes.texts}
    assert {("0", "white"), ("10", "black"), ("none", "black")} <= colours
