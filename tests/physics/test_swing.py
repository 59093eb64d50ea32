"""A swing is recorded in cycles that are all alike, in steps short enough for how the rack rolls over."""

from dataclasses import replace

import numpy as np
import pytest

from bad_cases import bad_cases
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, swept_revolutions
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.closed_form import free_torque
from verification.stability import ScenePlan

STILL = Fidelity.preset("quasi-static")


def made(plan: ScenePlan) -> Result:
    return run_unchecked(plan.scene, plan.gear, plan.fidelity)


def test_reversal_by_the_closed_form_jumps_by_both_free_torques() -> None:
    """A record without the rack's motions across its travel, as formulas leave it, is a closed loop, too."""
    gear = SteeringGear()
    result = run_unchecked("reversal", gear, Fidelity.preset("closed-form"))
    assert result.summary["torque_jump"] == pytest.approx(2 * free_torque(gear), rel=1e-3)


@pytest.mark.quick
def test_revolutions_of_a_swing_are_those_of_its_record() -> None:
    gear = SteeringGear().replace({"test.cycles": 2, "test.amplitude": "1.2 rad"})
    maneuver = swing_maneuver(gear, STILL.step_angle)
    recorded = maneuver.time[maneuver.time >= maneuver.record_start * (1 - 1e-6)]
    angles = [float(maneuver.drive.place(time)) for time in recorded]
    assert swept_revolutions(gear) == pytest.approx(np.abs(np.diff(angles)).sum() / (2 * np.pi), rel=2e-3)


def test_bars_cover_a_gear_that_rolls_into_its_cycle() -> None:
    """The first cycle recorded takes the work of the sixth within its bar."""
    plan = bad_cases()["reversal 971"].plan
    later = ScenePlan(plan.scene, plan.gear.replace({"test.cycles": 6}), plan.fidelity)
    first, last = (
        run_unchecked(each.scene, each.gear, each.fidelity, DEFAULT_OPTIONS) for each in (plan, later)
    )
    apart = abs(plan.main_metric(first) - plan.main_metric(last))
    assert not apart > first.errors["hysteresis_area"]  # nan: no other level ends
    assert apart < 2e-3 * plan.main_metric(last)


def test_cycles_before_a_swing_are_divided_as_its_last_one() -> None:
    gear = SteeringGear().replace({"test.cycles": 2})
    once, swing = (swing_maneuver(each, STILL.step_angle) for each in (SteeringGear(), gear))
    assert once.begun_earlier(1) == replace(swing, lead=swing.lead + swing.steps // 2, steps=once.steps)
    assert once.halved(2).parts == 4 * once.parts
    assert np.all(np.diff(once.time) > 0)


def test_cycles_before_the_record_keep_its_steps() -> None:
    """The record's instants are those without them, some periods later."""
    maneuver = swing_maneuver(SteeringGear(), STILL.step_angle)
    earlier = maneuver.begun_earlier(2)
    recorded, more = (int(np.sum(each.time >= each.record_start)) for each in (maneuver, earlier))
    assert recorded == more
    assert earlier.time[-recorded:] - 2 * maneuver.drive.period == pytest.approx(
        maneuver.time[-recorded:], abs=1e-9
    )


@pytest.mark.parametrize("ratio", [0.02, 0.1, 0.3])
def test_bars_cover_what_a_wide_zone_of_friction_does_to_a_swing(ratio: float) -> None:
    gear = SteeringGear()
    narrow, wide = (
        made(ScenePlan("reversal", gear, STILL.replace({"zone_ratio": each}))) for each in (0.002, ratio)
    )
    for name, bar in wide.errors.items():
        assert abs(wide.summary[name] - narrow.summary[name]) <= bar + narrow.errors[name], name
