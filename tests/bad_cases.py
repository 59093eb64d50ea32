"""Configurations that end in a wrong number where nothing is checked; the solver calls most a success.

Most were found by random plans (bad_cases.json); the others vary one known weakness. Each states what must
come out: the status, and the check that fires by a piece of its message. Cases that are "ok" are right now.
What each gives without any check stands in results/stability/corpus.csv, which
`python benchmarks/make.py corpus` writes again. Of the slow ones the suite runs none.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from verification.law_area import replaced
from verification.stability import ScenePlan

TORQUE = "free-pinion-torque"
STILL = {"solver": "equilibrium"}
SPHERES = {"mesh": "general-contact", "profile_samples": 27, "axial_samples": 18}
Settings = dict[str, Any]


@dataclass(frozen=True)
class BadCase:
    """A plan, and the outcome that it must have."""

    plan: ScenePlan
    status: Status
    message: str = ""  # a piece of it
    slow: bool = False  # it and its reference take more than ten seconds: left to the benchmark


def bad_cases() -> dict[str, BadCase]:
    """Name -> case."""
    cases = {}
    for name, values in json.loads(Path(__file__).with_suffix(".json").read_text()).items():
        expected, scene = values.pop("expected"), values.pop("scene")
        slow = values.pop("slow", False)
        cases[name] = BadCase(_plan(scene, values), Status(expected["status"]), expected["message"], slow)
    for name, message, values in _made_up():
        status = Status.CONTACT_LOST if message == "out of its place" else Status.INVALID
        scene = values.pop("scene", TORQUE)
        cases[name] = BadCase(_plan(scene, {"test.turns": 1 / 6} | values), status, message)
    return cases


def _plan(scene: str, values: Settings) -> ScenePlan:
    # their numbers are those of this law, under which they were found
    settings = {"mesh.law": "area"} | {path: value for path, value in values.items() if "." in path}
    gear = replaced(SteeringGear(), settings)
    choices = {path: value for path, value in values.items() if "." not in path}
    return ScenePlan(scene, gear, Fidelity.preset("flank").replace(choices))


def _made_up() -> Iterator[tuple[str, str, Settings]]:
    """Name, piece of the message, settings."""
    stiff = {"mesh.stiffness": 3e14}
    for profile, axial in ((4, 4), (6, 5), (8, 10), (5, 18)):
        spheres = SPHERES | {"profile_samples": profile, "axial_samples": axial}
        name = f"{profile} x {axial} spheres on stiff teeth"
        yield name, "not run: fidelity.profile_samples", STILL | spheres | stiff
    hard = {"mesh.stiffness": 1e15, "installation.angle_error": "0.7 deg", "test.turns": 0.005}
    yield "spheres on hard teeth, shafts askew", "spheres touch", STILL | SPHERES | hard
    for stiffness in (2e10, 5e10, 1e11, 3e11):
        message = "out of its place" if stiffness == 2e10 else "mesh_penetration"
        soft, name = {"mesh.stiffness": stiffness}, f"flanks of {stiffness:g} N/m^3, deeper than their law"
        yield name, message, STILL | soft
        yield f"dynamic {name}", message, soft
    name, half = "spheres on teeth of 3e11 N/m^3, deeper than half of them", {"mesh.stiffness": 3e11}
    yield name, "not run: the deepest contact predicted", STILL | SPHERES | half
    loaded = {"yoke.preload": 2000, "mesh.stiffness": 1e12}
    yield "2 kN on soft teeth", "mesh_penetration", STILL | loaded
    bowed = {"rack.bow": "0.3 mm"}
    yield "a bow in general contact", "not run: rack.bow", STILL | SPHERES | bowed
    yield "a bow in a bush of segments", "not run: rack.bow", {"bush": "chain"} | bowed
    hard = {"scene": "yoke-setting", "test.path": "there-and-back", "test.back_off": 0.0}
    yield "a cap of 60 N m, not turned back", "mesh_penetration", STILL | hard | {"test.cap_torque": 60.0}
    turned = {"scene": "rack-lift", "rack": "free", "test.lift_torque": 300.0}
    yield "300 N m against a held rack", "mesh_penetration", STILL | turned
    stopped = {"pinion.runout": "60 um", "yoke.clearance": "10 um", "test.turns": 1.0, "step_angle": "40 deg"}
    yield "two samples of 60 um runout per turn", "not run: fidelity.step_angle", STILL | stopped
