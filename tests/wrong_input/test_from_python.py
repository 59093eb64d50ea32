"""Wrong arguments from Python are refused in a sentence, as on the command line."""

from typing import Any

import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.declaration import Length, Table, parameter
from rps_exudyn.parameters.fidelity import Fidelity

SCENE = "free-pinion-torque"


@pytest.mark.parametrize("fidelity", [3, {"mesh": "flank"}])
def test_fidelity_is_a_name_or_a_fidelity(fidelity: Any) -> None:
    with pytest.raises(InputError, match=r"^fidelity is .*; it must be one of full, .*, or a Fidelity\.$"):
        rps.run(SCENE, fidelity=fidelity)


@pytest.mark.parametrize("gear", [{}, {"yoke": {"preload": 3}}, "gear.toml"])
def test_gear_is_a_steering_gear(gear: Any) -> None:
    with pytest.raises(InputError, match=r"^gear is a (dict|str); it must be a SteeringGear"):
        rps.run(SCENE, gear)


def test_constructor_speaks_in_sentences() -> None:
    with pytest.raises(InputError) as caught:
        rps.SteeringGear(pinion=3, yoke={"preload": "3 kg"}, brake={"force": 3})
    assert [problem.split(";")[0] for problem in caught.value.problems] == [
        "pinion is 3",
        "yoke.preload is '3 kg', which is no quantity in N",
        "brake is no table of parameters",
    ]
    with pytest.raises(InputError, match=r"^mesh is 'glue'; it must be general-contact or"):
        Fidelity(mesh="glue")


def test_default_that_is_not_allowed_is_reported_and_not_searched_for_ever() -> None:
    class Wrong(Table):
        length: Length = parameter("-1 mm", "a length", "estimate", gt=0)

    with pytest.raises(InputError, match="length is"):
        Wrong()
