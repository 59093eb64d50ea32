"""What the loop over many gears knows, and in which words it leaves all else to single runs."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.loop_legs import SIGNALS

TABLES = ("basic_rack", "pinion", "rack", "installation", "yoke", "bush", "bearing", "mesh")
NOT_NUMBERS = ("rack.bow", "rack.side_force", "rack.side_angle", "installation.gravity")
WEIGHT = "test.load_mass"

LEFT_TO_SINGLE_RUNS = {
    "scene": "the loop knows the scenes free-pinion-torque, load-test and rack-push",
    "path": "the loop knows the paths one-way and there-and-back",
    "fidelity": "the loop knows the fidelity quasi-static, with its own step_angle",
    "parts": "the loop knows no teeth that bend, no bow, side force or weight of the rack",
    "friction": "the loop knows Coulomb's friction alone",
    "parameter": "the loop does not know how gears differ in {path}",
    "text": "the values of {path} are no plain numbers",
    "signals": "the loop keeps the signals {signals} alone",
    "few": "the table has too few gears for a loop, or its middle gear is not found",
}
"""All reasons for which no gear of a table goes through the loop."""


def why_not(scene: str, gear: SteeringGear, fidelity: Fidelity, values: Mapping[str, Any]) -> str:
    """Return what of a batch the loop does not know, or ""."""
    usual = fidelity.replace({"step_angle": Fidelity.preset("quasi-static").step_angle})
    parts = gear.mesh.law == "teeth" or gear.rack.bow or gear.rack.side_force or gear.installation.gravity
    laws = {gear.mesh.friction_law, gear.yoke.friction_law, gear.bush.friction_law, gear.bearing.friction_law}
    unknown = {
        "scene": scene not in SIGNALS,
        "path": gear.test.path == "lock-to-lock",
        "fidelity": usual != Fidelity.preset("quasi-static"),
        "parts": bool(parts),
        "friction": laws != {"coulomb"},
    }
    if reason := next((name for name, holds in unknown.items() if holds), ""):
        return LEFT_TO_SINGLE_RUNS[reason]
    for path, column in values.items():
        number = SteeringGear.declared_at(path)[0]
        known = path == WEIGHT or (path.partition(".")[0] in TABLES and path not in NOT_NUMBERS)
        if not known or not isinstance(gear.value_at(path), float) or not hasattr(number, "show"):
            return LEFT_TO_SINGLE_RUNS["parameter"].format(path=path)
        if np.asarray(column).dtype.kind not in "fiu":
            return LEFT_TO_SINGLE_RUNS["text"].format(path=path)
    return ""
