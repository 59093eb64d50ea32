"""Configurations that end in a wrong number where nobody checks: the solver calls each of them a success.

Most were found by the random plans of studies/stability_plans.py (bad_cases.json); the others vary one known
weakness. What each gives without any check stands in results/stability/corpus.csv, which
`python studies/stability_corpus.py` writes again.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.verification.stability import Plan

TORQUE = "free-pinion-torque"
STILL = {"solver": "equilibrium"}
SPHERES = {"mesh": "general-contact", "profile_samples": 27, "axial_samples": 18}
Settings = dict[str, Any]


def bad_cases() -> dict[str, Plan]:
    """Name -> plan."""
    found = json.loads(Path(__file__).with_suffix(".json").read_text())
    cases = {name: _plan(values.pop("scene"), values) for name, values in found.items()}
    return cases | {name: _plan(TORQUE, {"test.turns": 1 / 6} | values) for name, values in _made_up()}


def _plan(scene: str, values: Settings) -> Plan:
    settings = {path: value for path, value in values.items() if "." in path}
    choices = {path: value for path, value in values.items() if "." not in path}
    return Plan(scene, SteeringGear().replace(settings), Fidelity.preset("flank").replace(choices))


def _made_up() -> Iterator[tuple[str, Settings]]:
    stiff = {"mesh.stiffness": 3e14}
    for profile, axial in ((4, 4), (6, 5), (8, 10), (5, 18)):
        spheres = SPHERES | {"profile_samples": profile, "axial_samples": axial}
        yield f"{profile} x {axial} spheres on stiff teeth", STILL | spheres | stiff
    hard = {"mesh.stiffness": 1e15, "installation.angle_error": "0.7 deg", "test.turns": 0.02}
    yield "spheres on hard teeth, shafts askew", STILL | SPHERES | hard
    for stiffness in (2e10, 5e10, 1e11, 3e11):
        soft = {"mesh.stiffness": stiffness}
        yield f"flanks of {stiffness:g} N/m^3, deeper than their law", STILL | soft
        yield f"dynamic flanks of {stiffness:g} N/m^3, deeper than their law", soft
    yield (
        "spheres on teeth of 3e11 N/m^3, deeper than half of them",
        STILL | SPHERES | {"mesh.stiffness": 3e11},
    )
    yield "2 kN on soft teeth", STILL | {"yoke.preload": 2000, "mesh.stiffness": 1e12}
    stopped = {"pinion.runout": "60 um", "yoke.clearance": "10 um", "test.turns": 1.0}
    yield "two samples of 60 um runout per turn", STILL | stopped | {"step_angle": "40 deg"}
