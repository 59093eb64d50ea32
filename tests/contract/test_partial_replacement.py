"""A gear with some parameters replaced is the gear validated as a whole, and names its case alike."""

import hashlib
import json
import random

import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.study.cases import MODEL_VERSION, case_hash

BASE = Setup().replace({"pinion.teeth": 7, "yoke.preload": "320 N"})


def whole(settings: dict[str, object]) -> Setup | tuple[str, ...]:
    """The setup with every table validated, or what is wrong."""
    try:
        return Setup.from_tables(BASE.model_dump(), settings, "x.toml")
    except InputError as error:
        return tuple(error.problems)


def part(settings: dict[str, object]) -> Setup | tuple[str, ...]:
    """The same by `replace`."""
    try:
        return BASE.replace(settings, "x.toml")
    except InputError as error:
        return tuple(error.problems)


def plain_hash(scene: str, setup: Setup) -> str:
    """The name of a case by JSON of all its parameters."""
    content = {
        "scene": scene,
        "gear": setup.model_dump(include=set(SteeringGear.model_fields)),
        "fidelity": setup.fidelity.model_dump(exclude={"name", "based_on"}),
        "model": MODEL_VERSION,
    }
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(canonical.encode()).hexdigest()[:16]


def test_random_replacements_are_those_of_a_whole_validation() -> None:
    """Values within and beyond their limits, alone and in conflict: same parameters, hashes, sentences."""
    chance, right, wrong = random.Random(1), 0, 0
    numbers = [item.path for item in Setup.declared() if item.unit is not None]
    for _ in range(300):
        settings: dict[str, object] = {}
        for path in chance.sample(numbers, chance.choice([1, 2, 5])):
            value = BASE.value_at(path)
            settings[path] = value * chance.uniform(0.5, 2) if value else chance.uniform(-1, 1) * 1e-5
        found, expected = part(settings), whole(settings)
        assert found == expected
        if isinstance(found, Setup):
            assert case_hash("load-test", found, found.fidelity) == plain_hash("load-test", found)
        right, wrong = right + isinstance(found, Setup), wrong + isinstance(found, tuple)
    assert right > 100
    assert wrong > 50


@pytest.mark.parametrize(
    "settings",
    [
        {"yoke.preloads": 1.0},
        {"yoke": 1.0},
        {"yolk.preload": 1.0},
        {"yoke.preload.x": 1.0},
        {"fidelity.step_angle": "2 deg"},
        {"fidelity.mesh": "cogs"},
        {"pinion.teeth": 8},
        {"yoke.preload": "300 mm"},
        {},
    ],
)
def test_odd_replacements_are_those_of_a_whole_validation(settings: dict[str, object]) -> None:
    assert part(settings) == whole(settings)
