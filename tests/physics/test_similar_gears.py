"""Similar gears give similar results: mirrored hands, and other units of length, force and time."""

from functools import cache

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from verification.sampler import random_gear, with_laws
from verification.similar import (
    ALONG_Z,
    LEFT_OUT,
    NO_UNITS,
    SIDES,
    UNITS,
    differences,
    in_units,
    mirrored,
    size_of,
    twins,
)

SAME_HAND, SAME = (
    1e-6,
    4e-3,
)  # of each metric; equilibria are found to 1e-3 N, and ripples are small differences
GEARS: dict[str, dict[str, object]] = {
    "default": {},
    "skew": {
        "pinion.helix_angle": "20 deg",
        "rack.tooth_angle": "8 deg",
        "pinion.runout": "20 um",
        "mesh.law": "line",
        "yoke.clearance": "0.03 mm",
    },
    "bent": {
        "pinion.teeth": 7,
        "installation.angle_error": "0.2 deg",
        "rack.bow": "0.05 mm",
        "rack.bow_angle": "40 deg",
        "bush.end_overhang": "60 mm",
    },
    "loose": {
        "bush.clearance": "0.06 mm",
        "bush.drag": "10 N",
        "pinion.helix_angle": "15 deg",
    },
    "supported": {
        "pinion.helix_angle": "15 deg",
        "pinion.axial_float": "0.05 mm",
        "bearing.lower_clearance": "20 um",
    },
    "falling": {
        f"{part}.{name}": value
        for part in ("mesh", "yoke", "bush", "bearing")
        for name, value in {"friction_law": "stribeck", "static_ratio": 1.3}.items()
    },
}
SCENES = (
    "free-pinion-torque",
    "load-test",
    "rack-push",
    "radial-play",
    "input-shaft-play",
    "yoke-setting",
    "reversal",
    "steering-feel",
    "steering-torque",
)
CASES = [
    (scene, name)
    for scene in SCENES
    for name in GEARS
    if (scene, name) != ("steering-torque", "falling")  # it jumps as friction falls: only dynamics follow
]
OF_A_MIRROR = [case for case in CASES if case[1] != "supported"]  # whose upper bearing would be the lower one


def gear_of(name: str) -> SteeringGear:
    test = {"test.turns": 0.2, "test.load_mass": "30 kg", "test.tyre_stiffness": "30 N/mm"}
    return SteeringGear().replace({**test, **GEARS[name]})


LARGEST = {"contact_pressure_max": 5e-6}  # of stations, whose forces equilibria know to 1e-3 N


@cache
def run_of(scene: str, name: str) -> Result:
    return rps.run(scene, gear_of(name), fidelity="quasi-static")


@pytest.mark.parametrize(("scene", "name"), OF_A_MIRROR)
def test_mirrored_gear_is_similar(scene: str, name: str) -> None:
    """The other hand of helix, teeth, bow and errors turns over what happens along Z and nothing else."""
    first, second = run_of(scene, name), rps.run(scene, mirrored(gear_of(name)), fidelity="quasi-static")
    assert first.status is second.status
    for metric, value in first.summary.items():
        if metric in LEFT_OUT:
            continue
        sign = -1 if metric in ALONG_Z else 1
        found = sign * second.summary[SIDES.get(metric, metric)]
        same = max(SAME_HAND, LARGEST.get(metric, 0))
        assert found == pytest.approx(value, rel=same, abs=1e-9), metric


@pytest.mark.parametrize(("scene", "name"), CASES)
def test_scaled_gear_is_similar(scene: str, name: str) -> None:
    """Twice as large under four times the force in 1.41 times the time: nothing with a unit is hidden."""
    first = run_of(scene, name)
    second = rps.run(scene, in_units(gear_of(name), **UNITS), fidelity="quasi-static")
    assert first.status is second.status
    assert first.codes == second.codes
    shares = differences(first, second, **UNITS) if first.status is Status.OK else {}
    assert {metric: share for metric, share in shares.items() if not abs(share) < SAME} == {}


def test_a_swing_begun_the_other_way_is_similar() -> None:
    """Over two cycles it is the same loop, half a cycle later: each metric to 0.2 %."""
    first, second = (
        rps.run("reversal", SteeringGear(), fidelity="quasi-static", cycles=2, direction=direction)
        for direction in (1, -1)
    )
    assert first.status is second.status is Status.OK
    shares = differences(first, second)
    assert {metric: share for metric, share in shares.items() if not abs(share) < 2e-3} == {}


RANDOM = {  # scene -> gears, and by how much their metrics may differ
    "free-pinion-torque": (2, SAME),
    "radial-play": (2, SAME),
    "input-shaft-play": (2, SAME),
    "rack-push": (3, SAME),
    "rack-on-rollers": (3, SAME),
    "rack-lift": (3, SAME),
    "load-test": (1, SAME),
    "yoke-setting": (1, SAME),
    "yoke-impact": (1, SAME),
    "rattle": (1, SAME),
    "reversal": (1, SAME),
    "steering-feel": (1, SAME),
    "steering-torque": (1, SAME),
    "stick-slip": (1, 0.02),
}
BY_ROUNDING = {"stick-slip": {"stick_share"}}
"""Metrics of a scene that a rounding moves: the instants at which the wheel sticks, of 4 % of the time."""


@pytest.mark.long
@pytest.mark.parametrize("scene", RANDOM)
def test_random_gears_are_similar(scene: str) -> None:
    """Gears of any kind and all their twins end in the same way, with metrics that agree within bars."""
    gears, same = RANDOM[scene]
    fidelity = "flank" if scene_named(scene).needs_inertia else "quasi-static"
    for number in range(gears):
        rng = np.random.default_rng([9, number])
        gear = with_laws(rng, random_gear(rng, scene)).replace(NO_UNITS)
        first = rps.run(scene, gear, fidelity=fidelity)
        for twin in twins(gear, scene):
            second = rps.run(scene, twin.gear, fidelity=fidelity)
            moved = BY_ROUNDING.get(scene, set())
            codes = [
                [code for code in run.codes if not (moved and code == Code.METRIC_NOT_CONFIRMED)]
                for run in (first, second)
            ]
            assert (second.status, codes[1]) == (first.status, codes[0]), twin.kind
            if first.status is Status.OK:
                shares = twin.differences(first, second)
                bars = {name: 2 * bar / abs(first.summary[name] or 1) for name, bar in first.errors.items()}
                allowed = {metric: np.nan_to_num(bars.get(metric, 0.0), nan=np.inf) for metric in shares}
                off = {name for name, share in shares.items() if not abs(share) < max(same, allowed[name])}
                assert off <= moved, {metric: shares[metric] for metric in off}


@pytest.mark.quick
def test_sizes_of_units() -> None:
    """A mass is force times time^2 over length."""
    assert size_of("kg", 2.0, 4.0, 3.0) == pytest.approx(18.0)
    assert size_of("N*m*s/rad", 2.0, 4.0, 3.0) == pytest.approx(24.0)
    assert size_of("kg/m^3", 2.0, 4.0, 3.0) == pytest.approx(18.0 / 8)
    assert size_of("", 2.0, 4.0, 3.0) == 1.0
