"""Two results compared: over the angles that both have, in either sense of rotation, whatever they lack."""

import dataclasses

import numpy as np
import pytest

from picture_faults import names_of
from rps_exudyn.analysis.result_comparison import compare
from rps_exudyn.pages.charts.analyses import comparison_figure
from rps_exudyn.results.result import Result


def recorded(result: Result, angle: np.ndarray) -> Result:
    """The made-up result as recorded at other angles, turning the way they go."""
    turned = np.append(0, np.cumsum(np.abs(np.diff(angle))))
    return dataclasses.replace(
        result,
        signals={
            "time": turned / 1.57,
            "pinion_angle": angle,
            "pinion_torque": 0.6 + 0.01 * np.cos(6 * angle),
            "work_drive": 0.6 * turned,
        },
    )


def test_result_does_not_differ_from_itself(made_up_result: Result) -> None:
    same = compare(made_up_result, made_up_result)
    assert same.settings == {}
    assert same.summary["torque_mean"] == (0.6, 0.6)
    assert set(same.signals) == set(made_up_result.signals) - {"pinion_angle"}
    assert all(pair.rms == 0 and pair.largest == 0 for pair in same.signals.values())


def test_difference_is_second_minus_first_with_its_place(made_up_result: Result) -> None:
    angle = made_up_result["pinion_angle"]
    bump = np.where(np.arange(angle.size) == 30, -0.03, 0.0)
    signals = made_up_result.signals | {"pinion_torque": made_up_result["pinion_torque"] + bump}
    torque = compare(made_up_result, dataclasses.replace(made_up_result, signals=signals)).signals[
        "pinion_torque"
    ]
    assert torque.largest == pytest.approx(-0.03)
    assert torque.angle == angle[30]
    assert torque.rms == pytest.approx(0.03 / np.sqrt(120))  # of a single sample among 120 steps
    assert torque.shown(torque.largest) == "-5 %"


def test_only_common_angles_count_and_sums_start_there(made_up_result: Result) -> None:
    first = recorded(made_up_result, np.linspace(0, 4, 401))
    second = recorded(made_up_result, np.linspace(1, 6, 701))
    compared = compare(first, second)
    assert compared.angle[0] == 1
    assert compared.angle[-1] == 4
    assert compared.signals["pinion_torque"].rms < 1e-5  # of interpolation
    assert abs(compared.signals["work_drive"].largest) < 1e-12
    assert abs(compared.signals["time"].largest) < 1e-12


def test_opposite_rotations_meet_at_the_same_angles(made_up_result: Result) -> None:
    angle = np.linspace(0, 4, 401)
    compared = compare(recorded(made_up_result, angle), recorded(made_up_result, angle[::-1]))
    assert abs(compared.signals["pinion_torque"].largest) < 1e-15
    assert compared.signals["work_drive"].first[0] == 0
    assert compared.signals["work_drive"].second[-1] == 0


@pytest.mark.parametrize(
    "angle",
    [np.zeros(5), np.linspace(7, 9, 5), np.array([0.0, np.nan]), np.zeros(0)],
)
def test_nothing_is_compared_without_common_angles(angle: np.ndarray, made_up_result: Result) -> None:
    first = recorded(made_up_result, np.linspace(0, 4, 401))
    signals = {"time": np.arange(angle.size, dtype=float), "pinion_angle": angle, "pinion_torque": angle}
    compared = compare(first, dataclasses.replace(made_up_result, signals=signals))
    assert compared.angle.size == 0
    assert compared.signals == {}


def test_records_there_and_back_are_compared_in_a_direction_of_both(made_up_result: Result) -> None:
    """Of the first 0..4, of the second 2..5 in its longer pass towards +X; only back there is nothing."""
    first = recorded(made_up_result, np.concatenate([np.linspace(0, 4, 401), np.linspace(3.99, 1, 300)]))
    second = recorded(made_up_result, np.concatenate([np.linspace(3, 2, 101), np.linspace(2.01, 5, 300)]))
    assert compare(first, second).angle[[0, -1]] == pytest.approx([2.01, 4])
    assert compare(first, second).signals["pinion_torque"].rms < 1e-5
    back = recorded(made_up_result, np.linspace(4, 0, 401))
    assert compare(first, back).angle[[0, -1]] == pytest.approx([1, 3.99])
    assert compare(second, recorded(made_up_result, np.zeros(5))).signals == {}


def test_settings_that_differ_have_their_paths(made_up_result: Result) -> None:
    other = dataclasses.replace(
        made_up_result,
        gear=made_up_result.gear.replace({"yoke.preload": 310}),
        fidelity=made_up_result.fidelity | {"name": "full"},
        solver={"name": "equilibrium"},
        summary={"rack_gain": 0.035, "torque_first_order": 0.1},
        errors={},
    )
    compared = compare(made_up_result, other)
    assert compared.settings == {
        "yoke.preload": (300, 310),
        "fidelity.name": ("flank", "full"),
        "solver.name": ("generalized-alpha", "equilibrium"),
        "solver.step": (1e-3, None),
    }
    assert compared.summary["torque_mean"] == (0.6, None)
    assert compared.summary["torque_first_order"] == (None, 0.1)


def test_picture_has_both_torques_and_their_difference(made_up_result: Result) -> None:
    signals = made_up_result.signals | {"pinion_torque": made_up_result["pinion_torque"] + 0.006}
    compared = compare(made_up_result, dataclasses.replace(made_up_result, signals=signals))
    both, apart = comparison_figure(compared, ("a", "b")).axes
    assert sorted(names_of(both)) == ["a", "b"]
    np.testing.assert_allclose(both.lines[1].get_ydata(), signals["pinion_torque"])
    np.testing.assert_allclose(apart.lines[0].get_ydata(), 1.0)
    assert apart.get_ylabel() == "difference [% of mean]"
