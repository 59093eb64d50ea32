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
    (" 3e-1 ", "", 0.3),
]


@pytest.mark.parametrize(("text", "unit", "value"), ACCEPTED)
def test_number_and_unit(text: str, unit: str, value: float) -> None:
    assert units.to_si(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.timeout(10)
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
