"""Gears of the usual kind under tests of every kind: what climbs of the ladder are tried on.

    gears = gears_under_tests(seed=1, scene="rack-push", count=40)

The gears are those of `population`; speed, direction, start, path, turns, load, amplitude, pulses and forces
of the test, gravity and the rack's travel come from the wide ranges of `stated_ranges`.
"""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.rattle import GROWING
from verification.population import admissible_gears
from verification.sampler import REACHES, drawn, placed
from verification.stated_ranges import GEAR

BESIDE_TEST = ("installation.gravity", "rack.travel")
TRIES = 20  # tests drawn for a gear before the next one is taken


def gears_under_tests(seed: int | Sequence[int], scene: str, count: int) -> list[SteeringGear]:
    """Return the first gears of a seed, each with a test of the scene that stays on its teeth."""
    return list(islice(_tested(np.random.default_rng(seed), scene), count))


def _tested(rng: np.random.Generator, scene: str) -> Iterator[SteeringGear]:
    for gear in admissible_gears(rng):
        for _ in range(TRIES):
            tested = placed(gear.replace(_test_of(rng, gear)))
            try:
                REACHES[scene](tested)
            except InputError:
                continue
            yield tested
            break


def _test_of(rng: np.random.Generator, gear: SteeringGear) -> dict[str, Any]:
    """Draw a test, in turns of the gear's tooth pitches."""
    values = drawn(rng, SteeringGear, GEAR)
    test = {path: values[path] for path in values if path.startswith("test.") or path in BESIDE_TEST}
    test["test.turns"] /= gear.pinion.teeth
    if test["test.road_shape"] == GROWING:  # finds a threshold, which is another quantity
        test["test.road_shape"] = "sine"
    return test
