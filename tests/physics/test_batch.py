"""A batch of gears ends as single runs of them: metrics, curves, and failures as rows."""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.results.outcome import Status

RUNOUTS = [0.0, 10e-6, -1.0, 20e-6]  # the third is no runout
PRELOADS = ["250 N", "300 N", "300 N", "350 N"]
ANGLES = np.radians([0.0, 5.0, 30.5, 61.0])  # the last one beyond the record


@pytest.fixture(scope="module")
def gear() -> rps.SteeringGear:
    return rps.SteeringGear().replace({"test.turns": 1 / 6})


@pytest.fixture(scope="module")
def found(gear: rps.SteeringGear) -> rps.Batch:
    return rps.batch("free-pinion-torque", gear, {"pinion.runout": RUNOUTS, "yoke.preload": PRELOADS})


def test_rows_are_those_of_single_runs(gear: rps.SteeringGear, found: rps.Batch) -> None:
    for row in (0, 1, 3):
        varied = gear.replace({"pinion.runout": RUNOUTS[row], "yoke.preload": PRELOADS[row]})
        alone = rps.run("free-pinion-torque", varied, fidelity="quasi-static")
        assert (found.statuses[row], found.messages[row]) == (alone.status, alone.message)
        assert {name: values[row] for name, values in found.summary.items()} == pytest.approx(
            alone.summary, rel=1e-5, abs=1e-9
        )
        expected = np.interp(ANGLES[:3], alone["pinion_angle"], alone["pinion_torque"])
        assert found.curves("pinion_torque", ANGLES)[row, :3] == pytest.approx(expected, rel=1e-5)


def test_a_gear_that_cannot_exist_is_a_row_with_its_cause(found: rps.Batch) -> None:
    assert found.statuses[2] is Status.INVALID
    assert "pinion.runout is -1" in found.messages[2]
    assert found.ok.tolist() == [True, True, False, True]
    assert np.isnan(found.summary["torque_mean"]).tolist() == [False, False, True, False]
    assert np.isnan(found.curves("pinion_torque", ANGLES)[2]).all()


def test_where_every_gear_fails_each_figure_is_nan() -> None:
    """A search that goes beyond what can exist reads metrics as elsewhere; it was a KeyError."""
    found = rps.batch("free-pinion-torque", rps.SteeringGear(), {"pinion.runout": [-1.0, -2.0]})
    assert found.statuses == (Status.INVALID, Status.INVALID)
    assert list(found.summary) == ["torque_mean"]
    for name in ("torque_mean", "torque_peak_to_peak"):
        assert found.summary[name].shape == (2,)
        assert np.isnan(found.summary[name]).all()
    with pytest.raises(KeyError, match="torque_men"):
        found.summary["torque_men"]


def test_curves_end_where_the_record_does(found: rps.Batch) -> None:
    assert np.isnan(found.curves("pinion_torque", ANGLES)[0]).tolist() == [False, False, False, True]


def test_a_curve_of_no_signal_is_refused(found: rps.Batch) -> None:
    with pytest.raises(InputError, match="'nonsense' is no signal"):
        found.curves("nonsense", np.radians([0.0, 90.0]))


def test_whole_numbers_of_numpy_are_whole_numbers() -> None:
    assert rps.SteeringGear().replace({"pinion.teeth": np.int64(7)}).pinion.teeth == 7


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({}, "no column"),
        ({"yoke.preload": []}, "yoke.preload has no value"),
        ({"pinion.runouts": [0.0]}, "pinion.runouts is no parameter"),
        ({"pinion": [0.0]}, "pinion is a table of parameters"),
        ({"pinion.runout": [0.0, 1e-6], "yoke.preload": [300.0]}, "pinion.runout has 2, yoke.preload has 1"),
    ],
)
def test_a_wrong_table_is_refused(values: dict[str, list[float]], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        rps.batch("free-pinion-torque", rps.SteeringGear(), values)
