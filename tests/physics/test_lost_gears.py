"""Random gears that equilibria lost once, each by another cause (lost_gears.json)."""

import json
from pathlib import Path

import pytest

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.simulate.run import simulate
from verification.law_area import replaced

GEARS = json.loads((Path(__file__).parents[1] / "lost_gears.json").read_text())


@pytest.mark.parametrize(
    ("name", "status", "code"),
    [
        # the bush's tangent lacked that the axis of a tilted bar swings with its roll
        ("a long rack that lies askew", Status.OK, None),
        # it had left its place before the last equilibrium
        ("a rack that rolls away", Status.CONTACT_LOST, Code.RACK_OUT_OF_MESH),
        # over the last steps a part moves a hundred times as fast as the rack
        ("bristles that let the rack snap", Status.INVALID, Code.GEAR_JUMPS),
        # beyond a fold of its equilibria the least force that is left grows with the load
        ("a rack that snaps under a load", Status.INVALID, Code.GEAR_JUMPS),
    ],
)
def test_a_gear_that_was_lost_is_right_or_refused_by_its_cause(
    name: str, status: Status, code: Code | None
) -> None:
    values = GEARS[name]
    model = Fidelity.preset("flank" if values["model"] else "quasi-static").replace(values["model"])
    run = simulate(values["scene"], replaced(SteeringGear(), values["settings"]), model)
    assert run.status is status, run.message
    assert code is None or code in run.codes


@pytest.mark.long
def test_a_rack_that_creeps_only_in_its_friction_zone_strikes_no_yokenut() -> None:
    """In a zone of 0.1 it creeps until it strikes with 112 N; without creep it ends micrometres before."""
    values = GEARS["a rack that creeps until the yokenut is struck"]
    model = Fidelity.preset("flank").replace(values["model"])
    run = simulate(values["scene"], replaced(SteeringGear(), values["settings"]), model)
    assert run.status is Status.OK, run.message
    assert run.summary["rattle_force_rms"] == 0
