"""Wrong arguments from Python are refused in a sentence, as on the command line."""

from collections.abc import Callable
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


@pytest.mark.parametrize("gear", [{}, {"yoke": {"preload": 3}}, "gear.toml", 0])
def test_gear_is_a_steering_gear(gear: Any) -> None:
    with pytest.raises(InputError, match=r"^gear is .*; it must be a SteeringGear"):
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


GEAR = rps.SteeringGear()
WRONG: dict[str, Callable[[], object]] = {
    "path is None; it must be text or a Path": lambda: rps.load(None),  # type: ignore[arg-type]
    "path is 3; it must be text": lambda: rps.open_study(3),  # type: ignore[arg-type]
    r"path is \[\]; it must be text": lambda: rps.SteeringGear.from_toml([]),  # type: ignore[arg-type]
    "path is 0; it must be text": lambda: rps.read_measured_torque(0),  # type: ignore[arg-type]
    "files is 3; it must be a list": lambda: rps.fit(3),  # type: ignore[arg-type]
    "a.csv cannot be read: there is no such file": lambda: rps.fit("a.csv"),
    "free is None; it must be a list": lambda: rps.fit("a.csv", free=None),  # type: ignore[arg-type]
    "the prior of x is 3; it must be": lambda: rps.fit("a.csv", priors={"x": 3}),  # type: ignore[dict-item]
    "a change is None; it must be path -> value": lambda: GEAR.replace(None),  # type: ignore[arg-type]
    "a parameter's path is 3; it must be text": lambda: GEAR.replace({3: 4}),  # type: ignore[dict-item]
    "write yoke.preload, without quotes": lambda: GEAR.replace({'"yoke.preload"': 300}),
    '"yoke.preload" is one key; write it': lambda: rps.SteeringGear.from_tables({"yoke.preload": 300}),
    "accuracy is 0; it must be a percentage": lambda: rps.run(SCENE, accuracy=0),  # type: ignore[arg-type]
    "fidelity is ''; it must be one of": lambda: rps.run(SCENE, fidelity=""),
    r"SCENE is \[\]; it must be one of": lambda: rps.run([]),  # type: ignore[arg-type]
    "yoke.preload is 300; a column must": lambda: rps.batch(SCENE, GEAR, {"yoke.preload": 300}),  # type: ignore[dict-item]
    "a column must be a list": lambda: rps.batch(SCENE, GEAR, {"yoke.preload": [[1, 2], [3, 4]]}),
    "gear is None; it must be": lambda: rps.batch(SCENE, None, {"yoke.preload": [3]}),  # type: ignore[arg-type]
    "fidelity is ''; it must be a Fid": lambda: rps.build_model(GEAR, ""),  # type: ignore[arg-type]
    "scene is None; it must be a Scene": lambda: rps.add_scene(None),  # type: ignore[arg-type]
    "measured is 'b.csv'; it must": lambda: rps.compare_with_measured("b.csv", {}, 6),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("sentence", WRONG)
def test_wrong_types_end_in_one_sentence(sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as caught:
        WRONG[sentence]()
    assert len(caught.value.problems) == 1


def test_default_that_is_not_allowed_is_reported_and_not_searched_for_ever() -> None:
    class Wrong(Table):
        length: Length = parameter("-1 mm", "a length", "estimate", gt=0)

    with pytest.raises(InputError, match="length is"):
        Wrong()
