"""Plans that would end in a wrong number are not run, or repaired on request; a repair is reported."""

import numpy as np
import pytest

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.checks.rules import SPACING, breaches_of_plan
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.simulate.run import run, simulate
from rps_exudyn.simulate.run_plan import run_with_fallback
from rps_exudyn.tooth_contact.mean_depth import mean_depth
from verification.law_area import by_law
from verification.references import STRIPS

GEAR = by_law(SteeringGear().replace({"test.turns": 1 / 6}), "area")
TORQUE = "free-pinion-torque"
STILL = Fidelity.preset("quasi-static")
SPHERES = Fidelity.preset("full").replace({"bush": "condensed", "profile_samples": 6, "axial_samples": 5})
REFUSED = {
    "fidelity.step_angle is 40 deg": (STILL.replace({"step_angle": "40 deg"}), {}),
    "fidelity.profile_samples is 6": (SPHERES, {"mesh.stiffness": 3e14}),
    "the deepest contact predicted": (Fidelity.preset("full"), {"mesh.stiffness": 1e11}),
}


@pytest.mark.parametrize("sentence", REFUSED)
def test_plan_beyond_a_limit_is_not_run_and_the_repaired_one_is_within(sentence: str) -> None:
    fidelity, settings = REFUSED[sentence]
    gear = GEAR.replace(settings)
    result = run(TORQUE, gear, fidelity=fidelity)
    assert result.status is Status.INVALID
    assert result.message.startswith(f"not run: {sentence}")
    assert not result.signals
    repairs = {
        name: value
        for breach in breaches_of_plan(gear, fidelity, motion="steady")
        for name, value in breach.repair.items()
    }
    assert not list(breaches_of_plan(gear, fidelity.replace(repairs), motion="steady"))


@pytest.mark.parametrize("helix", ["0 deg", "20 deg", "-40 deg"])
def test_fewest_spheres_lie_two_and_a_half_strips_apart(helix: str) -> None:
    """A strip reaches as far as the flank leaves its tangent plane at the pitch point by the depth."""
    gear = SteeringGear().replace({"pinion.helix_angle": helix})
    pair = GearPair.of(gear)
    flank, pitch_point = Flank(pair, 0, 1), pair.reference_radius * np.sin(pair.alpha_t)
    radius = flank.area_element(flank.generator(pitch_point, 0.0), 0.0)
    strip, path = 2 * np.sqrt(2 * radius * mean_depth(gear)), np.ptp(pair.active_path)
    (breach,) = breaches_of_plan(gear, SPHERES.replace({"axial_samples": 18}), motion="steady")
    assert -breach.limit == np.ceil(path / strip / SPACING)


def test_bars_cover_a_wide_zone_of_friction_of_teeth_near_their_pitch_line() -> None:
    """Teeth of nearly parallel axes slide slowly: the widest zone takes 0.2 % of their torque."""
    gear = SteeringGear().replace({"pinion.helix_angle": "4 deg", "rack.tooth_angle": "-4 deg"})
    right, wide = (run(TORQUE, gear, fidelity=STILL.replace({"zone_ratio": ratio})) for ratio in (0.1, 1.0))
    assert right.status is wide.status is Status.OK
    off = abs(wide.summary["torque_mean"] - right.summary["torque_mean"])
    assert off <= wide.errors["torque_mean"]


def test_bars_cover_a_wide_zone_of_friction_where_the_motion_stops() -> None:
    """Level 1 halves the widest zone; a yoke that rubs much is slowed by it at each impact."""
    gear = SteeringGear().replace({"yoke.friction_law": "stribeck", "yoke.static_ratio": 2})
    wide, right = (
        run("yoke-impact", gear, fidelity=Fidelity.preset("flank").replace({"zone_ratio": ratio}))
        for ratio in (1.0, 0.003)
    )
    assert wide.errors
    for name, error in wide.errors.items():
        assert abs(wide.summary[name] - right.summary[name]) <= error + right.errors[name], name


def test_bars_cover_the_work_that_a_wide_zone_of_friction_takes_of_a_swing() -> None:
    """4 % of this gear's in the widest zone, which level 1 halves."""
    assert not list(breaches_of_plan(GEAR, STILL.replace({"zone_ratio": 1.0}), motion="unsteady"))
    wide, right = (
        run("reversal", GEAR, fidelity=STILL.replace({"zone_ratio": ratio})) for ratio in (1.0, 0.001)
    )
    off = abs(wide.summary["hysteresis_area"] - right.summary["hysteresis_area"])
    assert off <= wide.errors["hysteresis_area"]


@pytest.mark.parametrize("scene", [TORQUE, "rack-lift"])
@pytest.mark.parametrize("law", ["line", "teeth"])
def test_bars_cover_few_points_of_integration_on_lines_of_contact(scene: str, law: str) -> None:
    """Level 1 doubles single points, level 0 has them: the bars have their whole error."""
    gear = SteeringGear().replace({"mesh.law": law, "installation.angle_error": "1 deg"})
    few, many = (
        run(scene, gear, fidelity=STILL.replace({"strip_stations": n, "strip_points": n}), turns=0.34)
        for n in (1, 16)
    )
    assert few.status is many.status is Status.OK
    for name, error in few.errors.items():
        assert abs(few.summary[name] - many.summary[name]) <= error + many.errors[name], name


def test_a_gear_at_rest_asks_for_no_straight_bar() -> None:
    """A chain of segments is condensed: random plans were refused for it."""
    wide = Fidelity.preset("flank").replace({"zone_ratio": 1.0, "bush": "chain"})
    bowed = SteeringGear().replace({"rack.bow": 1e-4})
    assert list(breaches_of_plan(bowed, wide, motion="unsteady"))
    assert not list(breaches_of_plan(bowed, wide, motion="at rest"))
    found, right = (run("radial-play", bowed, fidelity=model) for model in (wide, Fidelity.preset("flank")))
    assert found.status is Status.OK, found.message
    assert found.summary["radial_play_y"] == pytest.approx(right.summary["radial_play_y"], rel=1e-6)


@pytest.mark.parametrize("preset", ["full", "flank", "quasi-static", "closed-form"])
def test_presets_are_within_all_limits(preset: str) -> None:
    assert not list(breaches_of_plan(SteeringGear(), Fidelity.preset(preset), motion="steady"))


def test_fallback_reports_every_try() -> None:
    result = run_with_fallback(TORQUE, GEAR, STILL.replace({"step_angle": "40 deg"}))
    assert result.status is Status.OK
    assert "step_angle" in result.message
    assert result.fidelity["step_angle"] == pytest.approx(
        result.findings["tries"][-1]["changed"]["step_angle"]
    )
    assert result.summary["torque_mean"] == pytest.approx(0.6348, rel=1e-3)


def test_fallback_of_a_misaligned_gear_is_right_and_says_what_it_changed() -> None:
    askew = GEAR.replace({"installation.angle_error": "0.8 deg"})
    result = run_with_fallback(TORQUE, askew, STILL.replace({"step_angle": "35 deg", "strip_points": 1}))
    assert result.status is Status.OK
    assert "step_angle" in result.message
    fine = run(TORQUE, askew, fidelity=STILL.replace(STRIPS))
    assert result.summary["torque_mean"] == pytest.approx(fine.summary["torque_mean"], rel=5e-3)


def test_fallback_leaves_a_sound_plan_alone() -> None:
    result = run_with_fallback(TORQUE, GEAR, STILL)
    assert (result.status, result.message) == (Status.OK, "")
    assert result.findings["tries"] == [{"changed": {}, "status": "ok", "message": ""}]


def test_fallback_in_vain_keeps_the_first_failure() -> None:
    too_soft = GEAR.replace({"mesh.stiffness": 1e11})
    result = run_with_fallback(TORQUE, too_soft, STILL.replace({"step_angle": "10 deg"}))
    assert result.status is Status.INVALID
    assert "mesh_penetration" in result.message
    assert "did not help" in result.message
    assert len(result.findings["tries"]) > 2


def test_time_limit_ends_a_run_from_outside() -> None:
    result = simulate(TORQUE, GEAR, STILL.replace({"step_angle": "0.01 deg"}), time_limit=TimeLimit(0.001))
    assert result.status is Status.TIMEOUT
    assert "time limit of 0.001 s" in result.message
