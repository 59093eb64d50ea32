"""Errors, orders and fronts of curves made by formula."""

import numpy as np
import pytest

from verification.work_precision import (
    Curve,
    Reference,
    agreed_reference,
    curve_errors,
    pareto_front,
    power_law,
)

TURN = 2 * np.pi


def torque(steps: int, mean: float = 2.0, ripple: float = 0.1) -> Curve:
    """One turn of a gear with 6 teeth at 1 rad/s."""
    time = np.linspace(0, TURN, steps + 1)
    return Curve(time, mean + ripple * np.cos(6 * time))


FINE = Reference(torque(3600), 0.0, {})


def test_a_shift_of_the_mean_is_bias_and_rms() -> None:
    found = curve_errors(torque(720, mean=2.02), FINE)
    assert (found.bias, found.rms) == (pytest.approx(1.0, rel=1e-3), pytest.approx(1.0, rel=1e-3))
    assert found.peak_to_peak == pytest.approx(0.0, abs=1e-6)


def test_a_larger_ripple_is_seen_in_its_order() -> None:
    found = curve_errors(torque(720, ripple=0.12), FINE, turned=TURN, teeth=6)
    assert found.tooth_order == pytest.approx(1.0, rel=1e-3)
    assert found.first_order == pytest.approx(0.0, abs=1e-3)
    assert found.peak_to_peak == pytest.approx(2.0, rel=1e-3)
    assert found.rms == pytest.approx(1 / np.sqrt(2), rel=1e-3)


def test_straight_lines_between_few_points_cost_what_theory_says() -> None:
    """Mean square of f'' h^2 x (1-x) / 2 over a step: h^4 <f''^2> / 120."""
    steps = 36
    expected = 100 * np.sqrt((TURN / steps) ** 4 * (0.1 * 36) ** 2 / 2 / 120) / 2.0
    found = curve_errors(torque(steps), FINE)
    assert found.rms_linear == pytest.approx(expected, rel=0.15)
    assert found.either_way == found.rms_linear > found.rms


def test_part_of_the_motion_is_compared_with_that_part() -> None:
    pitch = Curve(*(values[:121] for values in (torque(720).time, torque(720).values)))
    assert curve_errors(pitch, FINE).rms < 1e-3


def test_between_uneven_steps_nothing_overshoots() -> None:
    """A torque that changes sign within a hundredth of the steps beside it, and two instants that rounding
    leaves apart: a cubic spline goes beyond the values there by 10 % and more."""
    time = np.array([0.0, 1.0, 2.0, 3.0, 3.01, 4.0, 5.0, 5.0 + 1e-15, 6.0])
    values = np.array([-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    smooth = Curve(time, values).over([np.linspace(0, 6, 1201)])
    assert np.abs(smooth).max() <= 1.0 + 1e-12
    assert smooth[600] == pytest.approx(-1.0)


def test_joined_maneuvers_are_compared_piece_by_piece() -> None:
    def joined(steps: int) -> Curve:
        forth = torque(steps)
        return Curve(np.tile(forth.time, 2), np.concatenate([forth.values, -forth.values]))

    reference = agreed_reference({"fine": joined(3600), "other": joined(1800)})
    assert reference.uncertainty < 1e-6
    assert curve_errors(joined(720), reference).rms < 1e-3


def test_a_reference_is_as_good_as_the_agreement_of_its_methods() -> None:
    reference = agreed_reference(
        {"a": torque(720), "b": torque(720, mean=2.002), "c": torque(720, mean=1.999)}
    )
    assert reference.uncertainty == pytest.approx(0.15, rel=1e-2)
    assert reference.differences["a - b"] == pytest.approx(0.1, rel=1e-2)
    with pytest.raises(ValueError, match="two methods"):
        agreed_reference({"alone": torque(720)})


def test_exponent_is_fitted() -> None:
    sizes = np.array([1, 2, 4, 8, 16.0])
    assert power_law(sizes, 3 * sizes**1.5) == (pytest.approx(1.5), pytest.approx(3.0))


def test_pareto_front() -> None:
    cost = np.array([1, 2, 3, 2, np.nan, 1])
    error = np.array([3, 2, 2, 1, 0.1, 3])
    assert pareto_front(cost, error).tolist() == [True, False, False, True, False, True]
