"""The picture of a result: panels for what the result has, its numbers and its failure in words."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from rps_exudyn.pages.charts import style
from rps_exudyn.pages.charts.scene_figures import draw, torque_figure
from rps_exudyn.pages.charts.style import NOT_ZERO
from rps_exudyn.results.result import MeasuredTorque, Result
from shell import Command


def test_panels_have_units_and_title_has_numbers(made_up_result: Result) -> None:
    figure = torque_figure(made_up_result)
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["pinion torque [N m]", "rack lift [µm]", "rack roll [mrad]"]
    assert figure.axes[-1].get_xlabel() == "pinion angle [°]"
    assert figure.get_suptitle() == (
        "Free pinion torque · mean 0.600 ± 0.001 N m · peak to peak 0.020 ± 0.001 N m\n"
        "6 teeth, module 1.83 mm · preload 300 N · 15 rpm · fidelity flank"
    )


def test_curves_are_in_the_units_of_their_labels(made_up_result: Result) -> None:
    torque, lift, _ = torque_figure(made_up_result).axes
    np.testing.assert_allclose(torque.lines[0].get_xdata(), np.degrees(made_up_result["pinion_angle"]))
    np.testing.assert_allclose(torque.lines[0].get_ydata(), made_up_result["pinion_torque"])
    np.testing.assert_allclose(lift.lines[0].get_ydata(), 1e6 * made_up_result["rack_y"])


def test_failure_is_written_over_the_curves(failed_result: Result) -> None:
    assert torque_figure(failed_result).axes[0].get_title(loc="left") == "diverged: NaN at t = 0.1 s."


def test_signal_that_the_fidelity_lacks_gets_no_panel(made_up_result: Result) -> None:
    signals = {name: values for name, values in made_up_result.signals.items() if name != "rack_roll"}
    assert len(torque_figure(dataclasses.replace(made_up_result, signals=signals)).axes) == 2


@pytest.mark.parametrize("from_zero", [False, True])
def test_torque_begins_at_zero_on_request_and_says_if_not(from_zero: bool, made_up_result: Result) -> None:
    torque, lift, _ = draw(made_up_result, from_zero=from_zero).axes
    assert bool(torque.get_ylim()[0] == 0) == from_zero
    written = [text.get_text() for text in torque.texts if text.get_gid() != style.NAME]
    assert written == ([] if from_zero else [NOT_ZERO])
    assert not lift.texts  # its zero means nothing


def test_residual_stands_below_the_measured_torque(made_up_result: Result) -> None:
    """Of a file in both directions, one turn away, where one direction was simulated; all data lie inside."""
    angle = made_up_result["pinion_angle"]
    there, back = made_up_result["pinion_torque"] + 0.3, -0.9 - 0.01 * np.sin(angle)
    signals = {
        "pinion_angle": np.concatenate([angle, angle[::-1]]) - 2 * np.pi,
        "pinion_torque": np.concatenate([there, back]),
    }
    figure = torque_figure(made_up_result, MeasuredTorque("bench", signals))
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels[2] == "measured\n\u2212 simulated [N m]"
    np.testing.assert_allclose(figure.axes[2].lines[0].get_ydata(), 0.3, atol=1e-12)
    for axes in figure.axes[:3]:
        (low, high), (bottom, top) = axes.get_ylim(), axes.dataLim.intervaly
        assert low <= bottom < top <= high
        assert 0 <= axes.dataLim.intervalx[0] < 4
        assert 356 < axes.dataLim.intervalx[1] <= 360 + 1e-9


def test_result_is_drawn_again(made_up_result: Result, command: Command, tmp_path: Path) -> None:
    made_up_result.save("r.h5")
    answer = command(["show", "r.h5", "--plot", "again.svg", "--from-zero"])
    assert answer.status == 0
    assert "written: again.svg" in answer.out
    picture = (tmp_path / "again.svg").read_text(encoding="utf-8")
    assert picture.startswith("<?xml")
    assert command(["show", "r.h5", "--plot", "again.doc"]).status == 2


def test_headline_is_broken_between_its_parts_and_no_line_ends_with_a_mark() -> None:
    figure = Figure(figsize=(4, 3))
    style.title(figure, "Free pinion torque · mean 0.62 N m · peak to peak 0.03 N m · preload 300 N")
    text = figure.get_suptitle()
    assert text == "Free pinion torque · mean 0.62 N m\npeak to peak 0.03 N m · preload 300 N"
