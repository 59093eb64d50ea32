"""A torque on the steering wheel against the tyres: a slow cycle, and a mass integrated apart."""

from functools import cache

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import EXTREMES, LOSS_SHARES, VARIATIONS
from rps_exudyn.results.result import Result
from rps_exudyn.solvers import equilibrium
from rps_exudyn.solvers.closed_form import free_torque
from rps_exudyn.solvers.steering_column import ColumnModel
from verification.sampler import random_gear
from verification.two_masses import settled_work

FRICTION, TYRES, PEAK = 0.4, 200e3, 4.0
# friction of the bearings alone does not grow with the load
GEAR = SteeringGear().replace(
    {
        "mesh.friction": 0.0,
        "yoke.friction": 0.0,
        "bush.drag": 0.0,
        "bearing.friction_torque": FRICTION,
        "test.tyre_stiffness": TYRES,
        "test.steer_torque": PEAK,
    }
)
RESTORING = TYRES * float(GearPair.of(GEAR).gain) ** 2
COLUMN = GEAR.column.stiffness


@cache
def steered(fidelity: str, frequency: float = GEAR.test.steer_frequency, tyres: float = TYRES) -> Result:
    gear = GEAR.replace({"test.steer_frequency": frequency, "test.tyre_stiffness": tyres})
    result = rps.run("steering-torque", gear, fidelity=fidelity)
    assert result.status is Status.OK, result.message
    return result


def test_slow_cycle_runs_round_a_parallelogram() -> None:
    """Dead bands to 0.3 %, the area to 0.5 %: teeth and guides yield in series with the column."""
    found = steered("quasi-static", 0.02).summary
    assert found["angle_dead_band"] == pytest.approx(2 * FRICTION / RESTORING, rel=3e-3)
    expected = 2 * FRICTION * COLUMN / (COLUMN + RESTORING)
    assert found["torque_dead_band"] == pytest.approx(expected, rel=3e-3)
    assert found["steering_gradient"] == pytest.approx(1 / (1 / COLUMN + 1 / RESTORING), rel=3e-3)
    assert found["feel_area"] == pytest.approx(4 * FRICTION * (PEAK - FRICTION) / RESTORING, rel=5e-3)


@pytest.mark.parametrize("fidelity", ["quasi-static", "flank"])
@pytest.mark.parametrize(("frequency", "tyres"), [(0.5, 200e3), (0.2, 30e3)])
def test_swing_is_that_of_two_masses(fidelity: str, frequency: float, tyres: float) -> None:
    """Work of a settled cycle to 2 % of that of wheel and gear as two masses with Coulomb friction; the first
    cycle has 7 % less to 22 % more."""
    gear = GEAR.replace({"test.steer_frequency": frequency, "test.tyre_stiffness": tyres})
    found = steered(fidelity, frequency, tyres).summary["feel_area"]
    assert found == pytest.approx(settled_work(gear, FRICTION), rel=0.02)


def test_tyres_hold_against_the_rack() -> None:
    """Their force is the stiffness times the travel; all works and what is stored balance to 0.1 %."""
    for fidelity in ("quasi-static", "flank"):
        result = steered(fidelity)
        assert result["tyre_force"] == pytest.approx(-TYRES * result["rack_displacement"], abs=1e-6)
        assert abs(result.summary["energy_residual"]) < 1e-3


def test_hand_gives_what_is_asked() -> None:
    """The torque at the wheel is the sinusoid to rounding, from its peak or from less than a step before."""
    for fidelity in ("quasi-static", "flank"):
        result, rate = steered(fidelity), 2 * np.pi * GEAR.test.steer_frequency
        before = float(np.arccos(min(result["wheel_torque"][0] / PEAK, 1.0)))
        assert before < rate * 0.05
        expected = PEAK * np.cos(rate * result["time"] - before)
        assert result["wheel_torque"] == pytest.approx(expected, abs=1e-9 * PEAK)


def test_wheel_behind_a_joint_carries_the_hand() -> None:
    """Power passes the joint: its ratio at the wheel's angle times the pinion's torque is the hand's, and
    the column twists under that torque; to the tolerance of equilibria, 1e-3 N at a centimetre, and ten times
    that where the gear is let go. The wheel turns so slowly that its inertia takes nothing."""
    slow = {"column.joint_angle": "30 deg", "column.damping": 0.0, "test.steer_frequency": 1e-3}
    gear = GEAR.replace(slow)
    column, result = ColumnModel.of(gear), rps.run("steering-torque", gear, fidelity="quasi-static")
    assert result.status is Status.OK, result.message
    angle, torque = result["wheel_angle"], result["pinion_torque"]
    assert column.ratio(angle) * torque == pytest.approx(result["wheel_torque"], abs=1e-4)
    assert column.output(angle) - result["pinion_angle"] == pytest.approx(torque / column.stiffness, rel=1e-9)
    assert np.ptp(column.ratio(angle)) > 0.05


# --- a torque that grows -----------------------------------------------------------------------------
WHOLE = {
    "mesh.friction": SteeringGear().mesh.friction,
    "yoke.friction": SteeringGear().yoke.friction,
    "bush.drag": SteeringGear().bush.drag,
    "bearing.friction_torque": SteeringGear().bearing.friction_torque,
}


def grown(settings: dict[str, object], fidelity: str = "flank", rack: str = "free") -> Result:
    gear = GEAR.replace({"test.steer_shape": "ramp", **settings})
    result = rps.run("steering-torque", gear, fidelity=Fidelity.preset(fidelity).replace({"rack": rack}))
    assert result.status is Status.OK, result.message
    return result


@pytest.mark.parametrize(
    ("settings", "fidelity", "expected", "tolerance"),
    [
        ({"test.steer_frequency": 1e-3}, "quasi-static", FRICTION, 1e-3),
        ({}, "quasi-static", FRICTION, 0.015),
        ({}, "flank", FRICTION, 0.015),  # the free wheel swings meanwhile
        ({"test.direction": -1}, "flank", FRICTION, 0.015),
        ({"bearing.friction_law": "bristle", "bearing.bristle_travel": 2e-6}, "flank", FRICTION, 0.01),
        ({"column.joint_angle": "30 deg"}, "flank", FRICTION / np.cos(np.pi / 6), 0.025),
    ],
)
def test_wheel_moves_off_where_the_torque_overcomes_friction(
    settings: dict[str, object], fidelity: str, expected: float, tolerance: float
) -> None:
    """The bearings' friction, through the joint's ratio with its yoke in the bend's plane, 1 / cos beta."""
    found = grown(settings, fidelity)
    assert found.summary["breakaway_torque"] == pytest.approx(expected, rel=tolerance)
    rate = 4 * PEAK * found.gear.test.steer_frequency * found.gear.test.direction
    assert found["wheel_torque"] == pytest.approx(rate * found["time"], abs=1e-9 * PEAK)


@pytest.mark.parametrize("ratio", [1.0, 1.2])
def test_static_friction_of_all_parts_is_overcome(ratio: float) -> None:
    """Behind a guided rack the sum of the closed form's torques times the static ratio, to 1 %; bristles of
    2 um remember it (0.61 and 0.74 N m)."""
    parts = ("mesh", "yoke", "bush", "bearing")
    law = {"friction_law": "bristle", "static_ratio": ratio, "bristle_travel": 2e-6}
    laws = {f"{part}.{name}": value for part in parts for name, value in law.items()}
    found = grown(WHOLE | laws, rack="guided").summary["breakaway_torque"]
    assert found == pytest.approx(ratio * free_torque(SteeringGear()), rel=0.01)


def test_bars_cover_what_a_wide_zone_of_friction_does_where_friction_lets_go() -> None:
    gear = SteeringGear().replace({"test.steer_shape": "ramp", "test.tyre_stiffness": TYRES})
    still = Fidelity.preset("quasi-static")
    narrow, wide = (
        rps.run("steering-torque", gear, fidelity=still.replace({"zone_ratio": ratio}))
        for ratio in (0.005, 0.03)
    )
    assert narrow.status is wide.status is Status.OK
    assert {"yoke_force_max", "rack_gain", "loss_share_mesh"} <= wide.errors.keys()
    for name, bar in wide.errors.items():
        assert abs(wide.summary[name] - narrow.summary[name]) <= bar, name


def test_equilibria_after_breakaway_leave_open_which_state_friction_larger_at_rest_leads_to() -> None:
    """Half the friction zone led one gear to a rack rolled half as far, its shares of losses 6 % off."""
    gear = SteeringGear().replace({"test.steer_shape": "ramp", "test.tyre_stiffness": TYRES})
    falls = gear.replace({"mesh.friction_law": "stribeck", "mesh.static_ratio": 1.2})
    plain, open_ended = (rps.run("steering-torque", each, fidelity="quasi-static") for each in (gear, falls))
    assert {"loss_share_mesh", "rack_roll_range", "yoke_force_max"} <= plain.summary.keys()
    assert open_ended.status is Status.OK
    unknown = {name for name, bar in open_ended.errors.items() if np.isnan(bar)}
    assert unknown == (VARIATIONS | EXTREMES | LOSS_SHARES) & open_ended.summary.keys()
    assert "more than one state after breakaway" in open_ended.message


def test_bars_cover_what_a_wide_zone_does_to_the_breakaway() -> None:
    """The gear creeps out of its static friction: 16 % less in a zone of half the sliding."""
    parts = ("mesh", "yoke", "bush", "bearing")
    law = {"friction_law": "stribeck", "static_ratio": 1.5}
    laws = {f"{part}.{name}": value for part in parts for name, value in law.items()}
    gear = SteeringGear().replace({"test.steer_shape": "ramp", "test.tyre_stiffness": 30e3, **laws})
    wide, narrow = (
        rps.run("steering-torque", gear, fidelity=Fidelity.preset("flank").replace({"zone_ratio": ratio}))
        for ratio in (0.5, 0.002)
    )
    off = abs(wide.summary["breakaway_torque"] - narrow.summary["breakaway_torque"])
    assert 0.1 * narrow.summary["breakaway_torque"] < off <= wide.errors["breakaway_torque"]


def test_a_torque_below_friction_moves_nothing_off() -> None:
    result = grown({"test.steer_torque": 0.3})
    assert "breakaway_torque" not in result.summary
    assert "the column twists and the gear stays" in result.message


@pytest.mark.parametrize(
    ("settings", "fidelity", "sentence"),
    [
        ({"test.tyre_stiffness": 0.0, "test.steer_shape": "ramp"}, "flank", "needs a restoring load"),
        ({"test.steer_shape": "step"}, "flank", "test.steer_shape"),
        ({"test.tyre_stiffness": 0.0}, "flank", "test.tyre_stiffness is 0 .* needs a restoring load"),
        ({"test.tyre_stiffness": 5e3}, "flank", "test.steer_torque = 4 .* the teeth for rack.travel"),
        ({}, "closed-form", "fidelity.solver is closed-form, which has no steering column"),
    ],
)
def test_refused(settings: dict[str, object], fidelity: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        rps.run("steering-torque", GEAR.replace(settings), fidelity=fidelity)


def test_instants_between_those_of_the_test_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A random gear whose equilibria need shorter steps than the test's; it was an IndexError."""
    between = []
    halve = equilibrium._Rows.halve
    monkeypatch.setattr(
        equilibrium._Rows, "halve", lambda rows, k, *how: between.append(k) or halve(rows, k, *how)
    )
    gear = random_gear(np.random.default_rng(17), "steering-feel")
    slow = {"test.tyre_stiffness": 200e3, "test.steer_torque": 4.0, "test.steer_frequency": 1e-3}
    gear = gear.replace(slow)
    result = rps.run("steering-torque", gear, fidelity="quasi-static")
    assert result.signals, result.message
    assert between
    steps = np.diff(result["time"])
    assert steps == pytest.approx(steps[0], rel=1e-9)
    # each angle of the wheel twists the column by the hand's torque
    column = ColumnModel.of(gear)
    twist = column.output(result["wheel_angle"]) - result["pinion_angle"]
    torque = result["wheel_torque"] / column.ratio(result["wheel_angle"])
    settled = column.stiffness * twist + column.damping * np.gradient(twist, result["time"])
    jumps = (
        np.abs(np.diff(result["pinion_angle"])) > 0.1
    )  # there the wheel's inertia takes a part of the torque
    smooth = ~(np.append(jumps, False) | np.insert(jumps, 0, False))
    assert smooth.mean() > 0.99
    assert settled[smooth] == pytest.approx(torque[smooth], abs=0.02 * np.ptp(torque))
