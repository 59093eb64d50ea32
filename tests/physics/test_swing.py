"""A swing is recorded in cycles that are all alike, in steps short enough for how the rack rolls over."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bad_cases import bad_cases
from rps_exudyn.analysis.curve import lag
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import WITHOUT_FINER_STEPS
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.metric_confirmation import changes, run_swing, unclosed, with_cycle_closed
from rps_exudyn.scenes.run_maneuver import run_ever_longer, run_maneuver
from rps_exudyn.scenes.scene import DEFAULT_OPTIONS, WITH_BARS
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.simulate.run_plan import run_unchecked
from rps_exudyn.solvers.closed_form import closed_form
from verification.stability import ScenePlan

STILL = Fidelity.preset("quasi-static")


def made(plan: ScenePlan) -> Result:
    return run_unchecked(plan.scene, plan.gear, plan.fidelity)


def test_lag_does_not_depend_on_where_steps_are_divided() -> None:
    """A way turned about once: half of the change of its rate, times the step there."""
    even = np.linspace(0, 10, 11)
    divided = np.unique(np.concatenate([even, np.linspace(8, 10, 9)]))
    assert lag(even, np.abs(even - 5)) == pytest.approx(1.0)
    assert lag(divided, np.abs(divided - 5)) == pytest.approx(1.0)
    assert lag(divided, 3 * divided) == pytest.approx(0.0, abs=1e-12)


def test_reversal_by_the_closed_form_jumps_by_both_free_torques() -> None:
    """A record without the rack's motions across its travel, as formulas leave it, is a closed loop, too."""
    gear = SteeringGear()
    result = run_unchecked("reversal", gear, Fidelity.preset("closed-form"))
    assert result.summary["torque_jump"] == pytest.approx(2 * closed_form(gear).free_torque, rel=1e-3)


def test_bars_cover_a_gear_that_rolls_into_its_cycle() -> None:
    """The first cycle recorded takes the work of the sixth within its bar."""
    plan = bad_cases()["reversal 971"].plan
    later = ScenePlan(plan.scene, plan.gear.replace({"test.cycles": 6}), plan.fidelity)
    first, last = (run_unchecked(each.scene, each.gear, each.fidelity, WITH_BARS) for each in (plan, later))
    apart = abs(plan.figure(first) - plan.figure(last))
    assert not apart > first.errors["hysteresis_area"]  # nan: no other level ends
    assert apart < 2e-3 * plan.figure(last)


def test_a_swing_whose_small_motions_wander_on_is_printed_without_them() -> None:
    """A drift of the roll by a tenth of its range over the cycle leaves out what small motions make."""
    gear, maneuver = SteeringGear(), swing_maneuver(SteeringGear(), STILL.step_angle)
    run = run_maneuver(gear, STILL, maneuver).described(
        lambda _: dict.fromkeys(["lost_motion", "torque_jump"], 1.0)
    )
    assert with_cycle_closed(run, gear, maneuver) is run
    roll = run.signals["rack_roll"]
    drift = np.linspace(0.0, 0.1 * np.ptp(roll), roll.size)
    found = with_cycle_closed(replace(run, signals=run.signals | {"rack_roll": roll + drift}), gear, maneuver)
    assert found.ok
    assert set(found.summary) == {"torque_jump"}
    assert "from where it began" in found.outcome.message


def test_a_longer_try_begins_with_the_steps_that_the_one_before_needed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A gear that asks for halves once: the second try makes no record in the steps that were too long."""
    lengths: list[int] = []

    def late(signals: Signals, gear: SteeringGear) -> bool:
        lengths.append(signals["time"].size)
        return lengths[-1] < 400

    monkeypatch.setattr("rps_exudyn.scenes.run_maneuver.rolls_over_late", late)
    gear, maneuver = SteeringGear(), swing_maneuver(SteeringGear(), STILL.step_angle)
    with run_ever_longer(gear, STILL, DEFAULT_OPTIONS) as made:
        first, second = made(maneuver), made(maneuver)
    assert lengths == [257, 513, 513]
    assert first.outcome.findings["halvings"] == second.outcome.findings["halvings"] == 1
    assert second.signals["pinion_torque"] == pytest.approx(first.signals["pinion_torque"])


def test_a_swing_that_half_the_steps_let_vibrate_is_made_in_longer_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Half the steps miss more of how the rack rolls over, so that no shorter ones follow."""
    late = iter([0.010, 0.012])
    monkeypatch.setattr("rps_exudyn.scenes.run_maneuver.rolls_over_late", lambda *_: True)
    monkeypatch.setattr("rps_exudyn.scenes.run_maneuver.rolls_late_by", lambda *_: next(late))
    run = run_maneuver(SteeringGear(), STILL, swing_maneuver(SteeringGear(), STILL.step_angle))
    assert run.signals["time"].size == 257
    assert "halvings" not in run.outcome.findings


def test_a_confirming_run_halves_the_zone_of_the_run_that_it_confirms(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Also where that one halved its steps before by itself, in the zone that was asked for."""
    zones: list[float] = []

    def watched(gear: SteeringGear, fidelity: Fidelity, *others: Any) -> SceneRun:
        zones.append(fidelity.zone_ratio)
        return run_maneuver(gear, fidelity, *others)

    monkeypatch.setattr(
        "rps_exudyn.scenes.run_maneuver.rolls_over_late", lambda signals, _: signals["time"].size < 400
    )
    monkeypatch.setattr("rps_exudyn.scenes.metric_confirmation.run_maneuver", watched)
    gear, model = SteeringGear(), STILL.replace({"zone_ratio": 0.02})
    maneuver = swing_maneuver(gear, STILL.step_angle)
    run = run_swing(gear, model, maneuver, DEFAULT_OPTIONS, lambda _: {"torque_jump": 1.0}, "torque_jump")
    assert run.ok
    assert zones == [0.01]


def test_an_ordinary_swing_by_enough_stations_is_made_once_in_the_steps_asked_for() -> None:
    maneuver = swing_maneuver(SteeringGear(), STILL.step_angle)
    result = made(ScenePlan("reversal", SteeringGear(), STILL.replace({"strip_stations": 12})))
    assert "halvings" not in result.findings
    assert unclosed(result.signals, maneuver) < 0.5
    assert len(result.signals["time"]) == 1 + maneuver.parts - maneuver.lead  # whose run-in is not divided


def test_cycles_before_a_swing_are_divided_as_its_last_one() -> None:
    gear = SteeringGear().replace({"test.cycles": 2})
    once, swing = (swing_maneuver(each, STILL.step_angle) for each in (SteeringGear(), gear))
    assert once.begun_earlier(1) == replace(swing, lead=swing.lead + swing.steps // 2, steps=once.steps)
    assert once.halved(2).parts == 4 * once.parts
    assert np.all(np.diff(once.time) > 0)


@pytest.mark.parametrize("ratio", [0.02, 0.1, 0.3])
def test_no_metric_of_a_swing_depends_on_the_zone_of_friction(ratio: float) -> None:
    """Half the zone confirms them, or they are left out. What halves change by a tolerance, narrower ones
    change by half of it more. In the default zone stations leave the angle of a reversal no value."""
    gear = SteeringGear()
    right = made(ScenePlan("reversal", gear, STILL))
    wide = made(ScenePlan("reversal", gear, STILL.replace({"zone_ratio": ratio})))
    assert wide.status is Status.OK
    change = changes(wide.summary, right.summary, right.signals)
    assert max(change[name] for name in wide.summary.keys() & change.keys() - WITHOUT_FINER_STEPS) <= 1.5
    assert "hysteresis_area" in wide.summary


def test_cycles_before_the_record_keep_its_steps() -> None:
    """The record's instants are those without them, some periods later."""
    maneuver = swing_maneuver(SteeringGear(), STILL.step_angle)
    earlier = maneuver.begun_earlier(2)
    recorded, more = (int(np.sum(each.time >= each.record_start)) for each in (maneuver, earlier))
    assert recorded == more
    assert earlier.time[-recorded:] - 2 * maneuver.drive.period == pytest.approx(
        maneuver.time[-recorded:], abs=1e-9
    )


def test_a_swing_from_more_cycles_before_goes_on_where_the_one_before_ended() -> None:
    """Dynamics take the steps of what it adds alone; its record is that of a swing made at once."""
    gear, moving = SteeringGear(), Fidelity.preset("flank")
    once = swing_maneuver(gear, moving.step_angle)
    later = once.begun_earlier(1)
    with run_ever_longer(gear, moving, DEFAULT_OPTIONS) as run:
        short, long = (run(each) for each in (once, later))
    whole = run_maneuver(gear, moving, later)
    steps = [each.outcome.counters["steps"] for each in (short, long, whole)]
    assert steps[1] == pytest.approx(steps[2], rel=0.1)
    assert steps[0] < 0.7 * steps[1]
    assert np.ptp(long.signals["pinion_torque"]) == pytest.approx(
        np.ptp(whole.signals["pinion_torque"]), rel=1e-3
    )
    for name in ("rack_displacement", "work_drive"):  # not the torque, which jumps between two instants
        at_once = np.interp(long.signals["time"], whole.signals["time"], whole.signals[name])
        assert long.signals[name] == pytest.approx(at_once, abs=2e-3 * np.ptp(at_once)), name


def test_short_steps_show_the_vibration_that_bristles_of_the_teeth_allow() -> None:
    """Friction of the teeth by a law of the rate damps it, and so do long steps."""
    bristles = SteeringGear().replace({f"{part}.friction_law": "bristle" for part in RUBBING_PARTS})
    damped = bristles.replace({"mesh.friction_law": "coulomb"})
    moving = Fidelity.preset("flank")
    short = moving.replace({"step_angle": "0.03 deg"})
    vibrating = made(ScenePlan("reversal", bristles, short))
    assert vibrating.status is Status.INVALID
    assert "the gear vibrates, its pinion_torque goes up and down" in vibrating.message
    still = made(ScenePlan("reversal", bristles, moving))
    assert (still.status, made(ScenePlan("reversal", damped, short)).status) == (Status.OK, Status.OK)
    area = made(ScenePlan("reversal", bristles, STILL)).summary["hysteresis_area"]
    assert still.summary["hysteresis_area"] == pytest.approx(area, rel=2e-3)
