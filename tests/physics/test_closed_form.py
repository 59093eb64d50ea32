"""The closed form against independent numbers, limits, and the laws of the load test.

The reference torques are those of an independent quasi-static model of two gears (uniform load along the
lines, 300 N, mu = 0.1, 20 N bush drag, 30 N mm bearing, plunger friction 0.1 in all): A with profile shift
0.65, B all-recess. They leave out the bar's round surface, which shortens the face here: 0.5 %.
"""

import dataclasses

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.yoke import seat_wedge_factor
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.run import run
from rps_exudyn.solvers.closed_form import (
    beyond_formulas,
    free_torque,
    load_test,
    mean_lever,
    mean_state,
    pushing_force,
    runout_harmonics,
    static_surplus,
    torque_per_preload,
    unloading_force,
)
from verification.law_area import by_law

PAPER = SteeringGear()
FLAT = 0.1 / seat_wedge_factor(PAPER.yoke.seat_angle)  # plunger friction that makes kappa mu_p 0.1
SET_B = PAPER.replace({"mesh.law": "line", "yoke.friction": FLAT})
SET_A = SET_B.replace({"pinion.profile_shift": 0.65, "pinion.tip_diameter": "17.6 mm"})
LOSSLESS = {"mesh.friction": 0.0, "yoke.friction": 0.0, "bush.drag": 0.0, "bearing.friction_torque": 0.0}


def sum_of_losses(gear: SteeringGear) -> float:
    """Return the mean free torque for small friction, the load even along the lines of contact [N m]."""
    rubbing = torque_per_preload(gear) * gear.yoke.preload
    return rubbing + GearPair.of(gear).gain * gear.bush.drag + gear.bearing.friction_torque


@pytest.mark.parametrize(("gear", "torque", "lever"), [(SET_A, 0.5462, 2.699e-3), (SET_B, 0.5933, 3.229e-3)])
def test_reference_torques(gear: SteeringGear, torque: float, lever: float) -> None:
    assert free_torque(gear) == pytest.approx(torque, rel=5e-3)
    assert sum_of_losses(gear) == pytest.approx(torque, rel=5e-3)
    assert mean_lever(GearPair.of(gear)) == pytest.approx(lever, rel=2e-4)  # four digits are given


@pytest.mark.parametrize(
    ("settings", "torque"), [({"mesh.friction": 0.0}, 0.3087), ({"yoke.preload": "150 N"}, 0.3441)]
)
def test_reference_sensitivities(settings: dict[str, object], torque: float) -> None:
    assert free_torque(SET_A.replace(settings)) == pytest.approx(torque, rel=5e-3)


def test_reference_normal_forces() -> None:
    """455 and 425 N, given to the newton."""
    state = mean_state(SET_A, 1, 0.0)
    assert (state.normal_drive, state.normal_coast) == pytest.approx((455, 425), abs=1)


def test_no_friction_no_torque_and_wedge_forces() -> None:
    """Law: without losses T = 0 and N_1 = N_2 = P / (2 sin alpha_n)."""
    state = mean_state(PAPER.replace(LOSSLESS), 1, 0.0)
    wedge = PAPER.yoke.preload / (2 * np.sin(PAPER.pinion.pressure_angle))
    assert state.torque == pytest.approx(0, abs=1e-15)
    assert (state.normal_drive, state.normal_coast) == pytest.approx((wedge, wedge), rel=1e-12)


@pytest.mark.parametrize("law", ["area", "line"])
@pytest.mark.parametrize("direction", [-1, 1])
@pytest.mark.parametrize("load", [0.0, 300.0, 5000.0])
def test_power_balance(law: str, direction: int, load: float) -> None:
    """Law: what the pinion gives is the load's work and the losses; also with one flank lifted."""
    gear = by_law(PAPER, law)
    state = mean_state(gear, direction, load)
    work = load * GearPair.of(gear).gain
    losses = state.mesh_loss + state.plunger_loss + state.bush_loss + state.bearing_loss
    assert state.torque - work == pytest.approx(direction * losses, rel=1e-9)


def test_linear_in_preload_and_nearly_in_friction() -> None:
    """T_0 is affine in P exactly; in mu up to the friction's own part in the balance, 1 % up to 0.2."""
    torque = [free_torque(PAPER.replace({"yoke.preload": p})) for p in (200.0, 400.0, 600.0)]
    assert torque[2] - torque[1] == pytest.approx(torque[1] - torque[0], rel=1e-9)
    mesh = [mean_state(PAPER.replace({"mesh.friction": mu}), 1, 0.0).mesh_loss for mu in (0.05, 0.2)]
    assert mesh[1] / 0.2 == pytest.approx(mesh[0] / 0.05, rel=1e-2)


def test_direction_does_not_matter_without_load() -> None:
    assert mean_state(PAPER, -1, 0.0).torque == pytest.approx(-free_torque(PAPER), rel=1e-12)


@pytest.mark.parametrize("law", ["area", "line"])
def test_load_test_sum_and_difference(law: str) -> None:
    """Law: while both flanks touch, half the sum is the ideal torque and half the difference T_0.

    Up to the part of the friction that grows with the load: second order in mu, some 1.3 %.
    """
    test = load_test(by_law(PAPER, law), 10.0)
    forward, reverse = test.torque_forward, test.torque_reverse
    assert (forward + reverse) / 2 == pytest.approx(test.ideal_torque, rel=2e-2)
    assert (forward - reverse) / 2 == pytest.approx(test.free_torque, rel=2e-2)
    assert test.efficiency_forward == pytest.approx(1 / (1 + test.free_torque / test.ideal_torque), rel=2e-2)
    assert test.efficiency_forward_net == pytest.approx(1, abs=5e-2)


def test_one_flank_lifts_above_the_unloading_force() -> None:
    """The coast flanks carry no load above it; without friction at P cot(alpha_n) cos(beta_r) - D."""
    limit = unloading_force(PAPER)
    assert mean_state(PAPER, 1, limit).normal_coast == pytest.approx(0, abs=1e-9)
    assert mean_state(PAPER, 1, 0.99 * limit).normal_coast > 0
    above = mean_state(PAPER, 1, 1.5 * limit)
    assert above.normal_coast == 0
    assert above.plunger_force > PAPER.yoke.preload
    pair, yoke = GearPair.of(PAPER), PAPER.yoke
    lossless = PAPER.replace({**LOSSLESS, "bush.drag": 20.0})
    expected = yoke.preload / np.tan(pair.alpha_n) * np.cos(pair.beta_r) - 20.0
    assert unloading_force(lossless) == pytest.approx(expected, rel=1e-12)


def test_parallel_axes_take_the_limit() -> None:
    """Rack angle = helix angle, all recess: the lever is |q|, its mean q_a / 2, and nothing is singular."""
    parallel = PAPER.replace({"pinion.helix_angle": "10 deg", "pinion.tip_diameter": "18 mm"})
    pair = GearPair.of(parallel)
    assert pair.active_path[0] == 0
    assert mean_lever(pair) == pytest.approx(pair.active_path[1] / 2, rel=1e-12)
    nearly = PAPER.replace({"pinion.helix_angle": "10.001 deg", "pinion.tip_diameter": "18 mm"})
    assert free_torque(parallel) == pytest.approx(free_torque(nearly), rel=1e-4)


def test_runout_is_conservative_apart_from_friction() -> None:
    """Law: without losses the once-per-revolution torque of slow turning is -P e sin(phi)."""
    gear = PAPER.replace({**LOSSLESS, "pinion.runout": "40 um", "test.speed": "0.01 rpm"})
    assert runout_harmonics(gear) == pytest.approx((0, -300 * 40e-6), abs=1e-12)
    stiff = PAPER.replace({"pinion.runout": "40 um", "yoke.spring_rate": 1e6})
    soft = stiff.replace({"yoke.spring_rate": 0.0})
    rise = runout_harmonics(stiff)[0] - runout_harmonics(soft)[0]
    assert rise == pytest.approx(torque_per_preload(PAPER) * 1e6 * 40e-6, rel=1e-12)


def test_seat_wedge_factor() -> None:
    """A flat seat has none; a half cylinder 4 / pi."""
    assert seat_wedge_factor(1e-4) == pytest.approx(1, abs=1e-8)
    assert seat_wedge_factor(np.pi / 2) == pytest.approx(4 / np.pi, rel=1e-12)


def test_results_are_plain_numbers() -> None:
    for value in dataclasses.asdict(mean_state(PAPER, 1, 0.0)).values():
        assert type(value) is float


STATIC = {f"{part}.{name}": value for part in ("mesh", "yoke") for name, value in
          (("friction_law", "stribeck"), ("static_ratio", 1.5))}  # fmt: skip


@pytest.mark.parametrize(("speed", "added"), [("0.5 rpm", 0.40), ("15 rpm", 0.086)])
def test_friction_larger_at_rest_is_beyond_the_formulas(speed: str, added: float) -> None:
    """What they say that it adds is what equilibria have more by Stribeck's law."""
    gear = SteeringGear().replace({**STATIC, "test.speed": speed})
    plain = SteeringGear().replace({"test.speed": speed})
    more, usual = (run("free-pinion-torque", gear=each, fidelity="quasi-static") for each in (gear, plain))
    assert more.summary["torque_mean"] / usual.summary["torque_mean"] - 1 == pytest.approx(added, rel=0.1)
    assert static_surplus(gear) == pytest.approx(added, rel=0.1)
    assert "larger at rest" in beyond_formulas(gear)
    assert not beyond_formulas(gear.replace({"test.speed": "200 rpm"}))


@pytest.mark.parametrize(
    ("scene", "settings", "named"),
    [
        ("reversal", {"mesh.friction_law": "bristle", "test.amplitude": "1 deg"}, "bristles"),
        ("load-test", {**STATIC, "mesh.load_exponent": 0.8, "test.speed": "200 rpm"}, "mesh.load_exponent"),
        ("rack-push", {**STATIC, "yoke.load_exponent": 0.8, "test.speed": "200 rpm"}, "yoke.load_exponent"),
    ],
)
def test_formulas_say_in_which_motion_they_do_not_hold(
    scene: str, settings: dict[str, object], named: str
) -> None:
    result = run(scene, gear=SteeringGear().replace(settings), fidelity="closed-form")
    assert result.status == "invalid"
    assert named in result.message
    wide = {"reversal": {"test.amplitude": "90 deg"}, "load-test": {"mesh.load_exponent": 1.0}}
    mended = settings | wide.get(scene, {"yoke.load_exponent": 1.0})
    assert run(scene, gear=SteeringGear().replace(mended), fidelity="closed-form").status == "ok"


def test_a_gear_that_locks_itself_is_pushed_by_no_force() -> None:
    """From the friction at which the flanks lock on, no force moves the rack; until then it grows."""

    def with_friction(size: float) -> SteeringGear:
        return SteeringGear().replace({"mesh.friction": size, "yoke.friction": size})

    forces = [pushing_force(with_friction(size), +1) for size in (0.3, 0.6, 0.9)]
    assert forces == sorted(forces)
    locked = with_friction(1.0)
    assert (pushing_force(locked, +1), pushing_force(locked, -1)) == (np.inf, -np.inf)
    with pytest.raises(InputError, match="locks itself"):
        run("rack-push", locked, fidelity="closed-form")
