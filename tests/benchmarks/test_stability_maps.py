"""Cells of stability maps, computed live: what is wrong without checks is flagged by them."""

import pytest

from bad_cases import bad_cases
from benchmarks.stability.maps import cell_and_flag
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from verification.law_area import by_law
from verification.stability import STILL, STRIP, Cell, ScenePlan

REFERENCE = (STILL | STRIP,)
CASES = bad_cases()


def test_a_sound_plan_is_right_and_not_flagged() -> None:
    plan = ScenePlan("free-pinion-torque", SteeringGear().replace({"test.turns": 1 / 6}), Fidelity())
    assert cell_and_flag(plan, REFERENCE) == (Cell.RIGHT, False)


@pytest.mark.parametrize("name", ["4 x 4 spheres on stiff teeth"])
def test_a_wrong_plan_is_flagged(name: str) -> None:
    cell, flagged = cell_and_flag(CASES[name].plan, REFERENCE)
    assert cell in (Cell.WRONG, Cell.INACCURATE)
    assert flagged


def test_a_plan_that_fails_says_so() -> None:
    """A preload that soft teeth do not carry."""
    settings = {"test.turns": 1 / 6, "yoke.preload": 3000.0, "mesh.stiffness": 1e11}
    gear = by_law(SteeringGear().replace(settings), "area")
    spheres = Fidelity().replace({"mesh": "general-contact", "solver": "equilibrium", "step_angle": "3 deg"})
    cell, _ = cell_and_flag(ScenePlan("free-pinion-torque", gear, spheres), REFERENCE)
    assert cell is Cell.FAILED
