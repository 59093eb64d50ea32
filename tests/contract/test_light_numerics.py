"""What replaces heavy imports gives their numbers: units, integrals and rules."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.special import beta, roots_jacobi

from rps_exudyn.analysis.work_balance import integral_from_start
from rps_exudyn.base import units
from rps_exudyn.tooth_contact.flank_data import eased, gauss_jacobi, jacobi_rules


@pytest.mark.parametrize(
    ("si_unit", "unit"),
    [(si_unit, unit) for si_unit in units._COMMON for unit in units._COMMON[si_unit][1]],
)
def test_common_units_are_those_of_pint_bit_for_bit(si_unit: str, unit: str) -> None:
    registry, meant = units._registry(), si_unit or "dimensionless"
    for number in (1.0, 1.83, -0.3, 7e-5, 2e13):
        by_pint = float(registry.Quantity(number, unit).to(meant).magnitude)
        expected = round(by_pint, 9) if unit in units.ZERO_OF else by_pint  # so that -40 degC is a limit
        assert units.to_si(f"{number!r} {unit}", si_unit) == expected
    one = float(registry.Quantity(1.0, unit).to(meant).magnitude)
    assert units.factor(unit, si_unit) == one - units.ZERO_OF.get(unit, 0.0)


@pytest.mark.parametrize("text", ["0.1 deg", "3 rad", "2 mm"])
def test_angles_and_lengths_are_no_plain_numbers(text: str) -> None:
    with pytest.raises(ValueError, match="is no quantity in plain numbers"):
        units.to_si(text, "")


@pytest.mark.parametrize("n", [1, 2, 4, 9])
@pytest.mark.parametrize(("high", "low"), [(0.0, 0.0), (1.5, 0.0), (0.0, 1.0), (1.5, 1.5)])
def test_rules_are_those_of_scipy(n: int, high: float, low: float) -> None:
    """To rounding, which grows with the number of nodes."""
    x, w = gauss_jacobi(n, high, low)
    expected_x, expected_w = roots_jacobi(n, high, low)
    np.testing.assert_allclose(x, expected_x, atol=1e-14)
    np.testing.assert_allclose(w, expected_w, rtol=1e-13)


@pytest.mark.parametrize("n", [1, 4, 9])
def test_eased_weights_integrate_the_stiffness_of_a_load_that_ends(n: int) -> None:
    """Euler's beta function of a load that vanishes with the power 3/2, its stiffness with 1/2."""
    ends = (0, 0), (0.5, 0), (0, 0.5), (0.5, 0.5)  # powers at the low and the high end
    for (x, w), factor, (low, high) in zip(jacobi_rules(n, 1.5), eased(n, 1.5, 0.5), ends, strict=True):
        assert factor * np.sum(w * x**low * (1 - x) ** high) == pytest.approx(beta(1 + low, 1 + high))


def test_integral_is_that_of_scipy_bit_for_bit() -> None:
    time = np.sort(np.random.default_rng(2).uniform(0, 3, 50))
    assert (
        integral_from_start(np.sin(time), time) == cumulative_trapezoid(np.sin(time), time, initial=0)
    ).all()
