"""A result and a gear at a prompt, in a notebook, as a picture and as a Dataset."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result


def test_printed_result_is_a_few_lines_with_status_and_first_numbers(made_up_result: Result) -> None:
    text = repr(made_up_result)
    assert len(text.splitlines()) <= 6
    assert len(text) < 600
    assert "free-pinion-torque" in text
    assert "status ok" in text
    assert "torque_mean 0.6 N m" in text


def test_printed_failure_says_why(failed_result: Result) -> None:
    assert "status diverged" in repr(failed_result)
    assert failed_result.message in repr(failed_result)


def test_notebook_shows_every_number_and_escapes_text(made_up_result: Result) -> None:
    page = dataclasses.replace(made_up_result, message="a < b")._repr_html_()
    assert all(name in page for name in made_up_result.summary)
    assert "a &lt; b" in page


def test_dataset_holds_signals_over_the_time_with_units(made_up_result: Result) -> None:
    dataset = made_up_result.to_xarray()
    assert set(dataset.variables) == set(made_up_result.signals)
    assert dataset["pinion_torque"].dims == ("time",)
    assert np.array_equal(dataset["pinion_torque"], made_up_result["pinion_torque"])
    assert all(dataset[name].attrs["units"] == SIGNALS[name].unit for name in dataset.variables)
    assert dataset.attrs["torque_mean"] == made_up_result.summary["torque_mean"]


def test_plot_draws_and_saves(made_up_result: Result, tmp_path: Path) -> None:
    figure = made_up_result.plot(tmp_path / "a.svg")
    assert figure.axes
    assert "<svg" in (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_plot_without_signals_is_refused(failed_result: Result) -> None:
    with pytest.raises(InputError, match=r"no signals to draw: diverged, NaN at t = 0\.1 s"):
        dataclasses.replace(failed_result, signals={}).plot()


def test_printed_gear_names_what_differs_from_the_default() -> None:
    assert "default" in repr(SteeringGear())
    changed = SteeringGear().replace({"yoke.preload": "400 N", "bush.segments": 7})
    assert "yoke.preload 400 N" in repr(changed)
    assert "bush.segments 7" in str(changed)
    assert len(repr(changed)) < 200
    assert "yoke.preload 400 N" in changed._repr_html_()


def test_printed_fidelity_is_its_name_which_hides_no_change() -> None:
    changed = Fidelity.preset("full").replace({"bush": "rigid"})
    assert "full with bush rigid" in repr(changed)
    assert changed.replace({"step_angle": "0.1 deg"}).name == "full with bush rigid, step_angle 0.1 deg"
    assert changed.replace({}) == changed
