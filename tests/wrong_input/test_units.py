"""What counts as a quantity: a number and its unit; nothing that has to be worked out."""

import pytest

from rps_exudyn.base import units

ACCEPTED = [
    ("50 N/mm", "N/m", 5e4),
    ("30 N*mm", "N*m", 0.03),
    ("30 N mm", "N*m", 0.03),
    ("30 N.mm", "N*m", 0.03),
    ("2e13 N/m^3", "N/m^3", 2e13),
    ("2e13 N/m**3", "N/m^3", 2e13),
    ("2e13 N/m³", "N/m^3", 2e13),
    ("14 N/mm/um", "N/m^2", 1.4e10),
    ("10 %", "", 0.1),
    ("10%", "", 0.1),
    ("1.83mm", "m", 1.83e-3),
    ("-.5 µm", "m", -5e-7),
    ("180°", "rad", 3.141592653589793),
    ("15 1/s", "rad/s", 15.0),
    ("0.6 Nm", "N*m", 0.6),
    ("30 Nmm", "N*m", 0.03),
    ("3 Ncm", "N*m", 0.03),
    ("2 mNm", "N*m", 0.002),
    ("1 kN", "N", 1000.0),
    ("12 μm", "m", 1.2e-5),  # the Greek letter, not the micro sign
    ("15 U/min", "rad/s", 1.5707963267948966),
    ("1,83 mm", "m", 1.83e-3),
    ("0,125", "", 0.125),
    ("−2,5 mm", "m", -2.5e-3),
    ("300,0 N", "N", 300.0),
    (" 3e-1 ", "", 0.3),
]


@pytest.mark.parametrize(("text", "unit", "value"), ACCEPTED)
def test_number_and_unit(text: str, unit: str, value: float) -> None:
    assert units.to_si(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.cpu_limit(10)
@pytest.mark.parametrize(
    "text", ["9**9**9 N", "9^9^9 N", "3 N**9**9", "3 N^999999999", "(2+1) N", "2*3 N", "3 N " + "m " * 10_000]
)
def test_nothing_is_evaluated(text: str) -> None:
    with pytest.raises(ValueError, match="is no quantity in N") as caught:
        units.to_si(text, "N")
    assert len(str(caught.value)) < 200


def test_whole_number_beyond_all_floats_is_refused() -> None:
    with pytest.raises(ValueError, match="too large"):
        units.to_si(10**400, "N")


@pytest.mark.parametrize("text", ["1,234 mm", "12,500 N", "1,234"])
def test_comma_that_may_divide_thousands_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="a comma that may divide thousands: write 1"):
        units.to_si(text, "m")


def test_bare_number_with_a_comma_is_si() -> None:
    assert units.to_si("1,5", "m") == 1.5


@pytest.mark.parametrize("text", ["1,2,3 mm", "1.234,5 mm", "", "5 kg"])
def test_other_commas_and_units_are_no_length(text: str) -> None:
    with pytest.raises(ValueError, match="no quantity in m"):
        units.to_si(text, "m")
