"""`rps.run(..., accuracy="1%")`: the same choice as the command's, and the same refusals."""

import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.simulate.by_accuracy import choose


def test_the_cheapest_model_is_taken_with_its_reason() -> None:
    gear = rps.SteeringGear()
    result = rps.run("free-pinion-torque", gear, accuracy="1%")
    choice = choose("free-pinion-torque", gear, 1.0)
    assert result.status == "ok"
    assert result.fidelity == choice.fidelity.model_dump()
    assert result.findings["accuracy"] == choice.why + choice.beside


def test_of_the_preset_named() -> None:
    result = rps.run("rack-push", accuracy="1%", fidelity="flank", turns=0.2)
    assert result.fidelity["solver"] == "generalized-alpha"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"accuracy": "one"}, "for instance 1%"),
        ({"accuracy": "1e-9%"}, "no stricter accuracy"),
        ({"accuracy": "1%", "fidelity": Fidelity()}, "accuracy chooses the model itself"),
    ],
)
def test_refused_in_a_sentence(given: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        rps.run("free-pinion-torque", **given)
