"""Stick-slip of gear and column: limits of one inertia, by events and by eigenvalues, and the whole gear."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.friction_oscillator import (
    Oscillator,
    Rubbing,
    describe_stick_slip,
    sticking_speed,
)
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.stick_slip import predictions
from rps_exudyn.solvers.gear_forces import gear_forces, mass_matrix
from rps_exudyn.solvers.prescribed_motion import Steady
from rps_exudyn.solvers.sliding_stability import (
    one_inertia_damping,
    reduced_gear,
    sliding_damping,
)
from verification.runge_kutta import FreeMotion
from verification.sliding_limit import fast_growth, growth, measured_damping
from verification.stick_slip import event_based, largest_sticking_speed, regularised, sliding_limit
from verification.stick_slip import on_bristles as cells_on_bristles

GEAR = SteeringGear().replace({"column.stiffness": "100 N*m/rad"})
STEEL = GEAR.replace(
    {f"{part}.{name}": value
     for part in ("mesh", "yoke")
     for name, value in {"friction_law": "stribeck", "static_ratio": 1.2}.items()}
)  # fmt: skip


def damped(ratio: float) -> Oscillator:
    """Teeth and plunger with static ratio 1.2, and a column of 100 N m/rad with a damping ratio."""
    model = reduced_gear(STEEL)
    return replace(model, damping=2 * ratio * np.sqrt(model.stiffness * model.inertia))


@cache
def run(speed: float, fidelity: tuple[tuple[str, float], ...] = (), law: str = "stribeck") -> Result:
    laws: dict[str, object] = {f"{part}.friction_law": law for part in ("mesh", "yoke")}
    laws |= {f"{part}.bristle_travel": "0.5 um" for part in ("mesh", "yoke")}
    gear = STEEL.replace({"test.speed": speed, **laws})
    return rps.run("stick-slip", gear, fidelity=Fidelity.preset("flank").replace(dict(fidelity)))


@pytest.mark.parametrize("ratio", [0.03, 0.1])
def test_largest_sticking_speed_is_that_of_events(ratio: float) -> None:
    """Steps of a hundredth of a period against an integrator that finds the events, to 2 %."""
    model = damped(ratio)
    found = sticking_speed(model)
    assert found == pytest.approx(largest_sticking_speed(model, 1.5 * found), rel=0.02)


def test_sticking_speeds_of_the_table_with_its_stribeck_speeds() -> None:
    """With 5 mm/s for the teeth and 10 mm/s for the plunger, damping ratios 0.01, 0.03 and 0.1: events of a
    two-part model give 14.5, 6.8 and 2.8 rad/s, met to 2 %, and none at 0.3, where 5 mm/s for both leaves
    0.84 rad/s. Events found by another integrator say the same of the last."""
    gear = STEEL.replace({"mesh.stribeck_speed": "5 mm/s", "yoke.stribeck_speed": "10 mm/s"})
    model, other = reduced_gear(gear), damped(0.3)
    unit = 2 * np.sqrt(model.stiffness * model.inertia)
    speeds = [sticking_speed(replace(model, damping=ratio * unit)) for ratio in (0.01, 0.03, 0.1, 0.3)]
    assert speeds[:3] == pytest.approx([14.5, 6.8, 2.8], rel=0.02)
    assert speeds[3] == 0.0
    assert event_based(replace(model, damping=0.3 * unit), 0.7, rtol=1e-7) is None
    assert event_based(other, 0.7, rtol=1e-7) is not None


def test_slow_sticking_needs_falling_friction() -> None:
    plain = Oscillator(7e-5, 100.0, 0.001, (Rubbing(0.6),))
    assert sticking_speed(plain) == 0.0


def test_linear_limit_is_where_an_eigenvalue_crosses() -> None:
    """At the damping of the limit the linearised motion neither grows nor decays (differences to 1e-6 of its
    frequency); the worst speed asks for 0.858 of the surplus over Stribeck's speed, 2 / sqrt(e) / sqrt(2)."""
    model = damped(0.0)
    for speed in (0.3, 0.8, 2.0):
        limit = model.linear_limit(speed)
        slope = (model.friction(speed + 1e-5) - model.friction(speed - 1e-5)) / 2e-5
        matrix = np.array([[0.0, -1.0], [model.stiffness, -limit - slope]]) / [[1.0], [model.inertia]]
        assert np.linalg.eigvals(matrix).real.max() == pytest.approx(0.0, abs=1e-3 * model.frequency * 1e-3)
    for part in model.parts[:2]:
        worst = max(-part.slope(speed) for speed in np.linspace(0.1, 5, 500))
        assert worst == pytest.approx(0.858 * part.torque * (part.ratio - 1) / part.stribeck_speed, rel=1e-3)


def test_bristles_in_steady_sliding_follow_the_speed_alone() -> None:
    """The margin of steady sliding changes its sign at the damping of falling friction."""
    model, speed = damped(0.0), 0.8
    limit = model.linear_limit(speed)
    margins = [replace(model, damping=share * limit).sliding_margin(speed) for share in (0.99, 1.0, 1.01)]
    assert margins[0] < 0 < margins[2]
    assert margins[1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("speed", [1.5])
def test_gear_sticks_as_one_inertia_does(speed: float) -> None:
    """Period and amplitude of the whole gear are those of the reduced one by events, to 12 %: friction that
    depends on the load, teeth and guides that yield, and a zone are what differs."""
    found, expected = run(speed), event_based(reduced_gear(STEEL), speed)
    assert found.status is Status.OK, found.message
    assert expected is not None
    metrics = found.summary
    assert metrics["stick_share"] > 0.05
    assert metrics["stick_slip_frequency"] == pytest.approx(1 / (expected.stick + expected.slip), rel=0.12)
    assert metrics["stick_slip_amplitude"] == pytest.approx(expected.amplitude, rel=0.12)
    assert metrics["sticking_speed"] > speed


def test_gear_slides_above_the_limit() -> None:
    """Twice as fast as it can stick it does not, and its vibration has decayed."""
    fast = run(2.0 * sticking_speed(reduced_gear(STEEL)))
    assert fast.status is Status.OK
    assert fast.summary["stick_share"] == 0
    assert fast.summary["stick_slip_torque"] < 0.05 * fast.summary["breakaway_torque"]


def test_work_of_a_sticking_gear_balances() -> None:
    assert abs(run(1.5).summary["energy_residual"]) < 1e-3


@pytest.mark.parametrize("elements", [1, 4])
def test_gear_on_bristles_sticks_as_without(elements: int) -> None:
    """At 1.5 rad/s frequency and amplitude on bristles of 0.5 um are those without, to 5 %; the balance of
    work closes to 1e-3."""
    bristles, plain = run(1.5, (("friction_elements", elements),), "bristle"), run(1.5)
    assert bristles.status is Status.OK, bristles.message
    for name in ("stick_slip_frequency", "stick_slip_amplitude"):
        assert bristles.summary[name] == pytest.approx(plain.summary[name], rel=0.05)
    assert bristles.summary["bristle_margin"] < 0
    assert bristles.summary["sticking_speed"] == plain.summary["sticking_speed"]
    assert abs(bristles.summary["energy_residual"]) < 1e-3


def test_remarks_on_what_cannot_stick() -> None:
    plain = run(1.5, law="coulomb")
    assert "larger at rest than in motion" in plain.message
    assert "stick_slip_amplitude" not in plain.summary  # what is left of the start
    assert "stick_slip_torque" in plain.summary


def test_bars_cover_what_a_wide_zone_does_to_the_amplitude() -> None:
    """A part at rest creeps in it."""
    wide, narrow = (run(1.5, (("zone_ratio", ratio),)) for ratio in (0.2, 0.005))
    for name in ("stick_slip_amplitude", "stick_slip_torque"):
        assert abs(wide.summary[name] - narrow.summary[name]) <= wide.errors[name]


def test_metrics_of_a_made_up_record() -> None:
    """A third of each period of 10 ms at rest: share, frequency and amplitude."""
    time = np.linspace(0, 0.2, 20001)
    turning = np.where((time % 0.01) < 0.01 / 3, 0.0, 1.5)
    angle = np.concatenate([[0.0], np.cumsum(turning[:-1] * np.diff(time))])
    twist = time - angle
    metrics = describe_stick_slip(
        {"time": time, "pinion_angle": angle, "column_twist": twist, "column_torque": 100 * twist + 0.6}, 1.0
    )
    assert metrics["stick_share"] == pytest.approx(1 / 3, rel=0.02)
    assert metrics["stick_slip_frequency"] == pytest.approx(100, rel=0.01)
    assert metrics["stick_slip_amplitude"] == pytest.approx(0.01 / 6, rel=0.03)


def test_vibration_without_sticking_has_no_frequency() -> None:
    """Which of its waves count depends on the steps: 24 or 46 Hz of one random gear."""
    time = np.linspace(0, 0.2, 20001)
    angle = time + 1e-4 * np.sin(2 * np.pi * 100 * time)
    signals = {"time": time, "pinion_angle": angle, "column_twist": time - angle, "column_torque": time}
    metrics = describe_stick_slip(signals, 1.0)
    assert metrics["stick_share"] == 0
    assert "stick_slip_frequency" not in metrics


@pytest.mark.parametrize("law", ["stribeck", "bristle"])
def test_limit_of_the_whole_gear_is_the_predicted_one(law: str) -> None:
    """The damping at which a small vibration neither grows nor decays, within 10 % at 1.5 rad/s: it grows at
    0.9 and decays at 1.1 of the prediction, with bristles of 0.5 um as without any."""
    parts = {f"{part}.friction_law": law for part in ("mesh", "yoke", "bush", "bearing")}
    short = {f"{part}.bristle_travel": "0.5 um" for part in ("mesh", "yoke", "bush", "bearing")}
    gear = STEEL.replace({**parts, **short, "test.speed": 1.5})
    predicted = one_inertia_damping(gear)
    assert predicted == pytest.approx(0.0310, rel=0.02)
    rates = [
        growth(gear.replace({"column.damping": share * predicted}), Fidelity.preset("flank"))
        for share in (0.9, 1.1)
    ]
    assert rates[0] > 0 > rates[1]


def test_limit_on_short_bristles_is_that_of_falling_friction() -> None:
    """Elements that slide have no lag along the sliding: the limit of the whole gear is the same, to
    rounding. None is stated on long ones, whose lag across it feeds a vibration of the guides."""
    parts = {f"{part}.friction_law": "bristle" for part in ("mesh", "yoke")}
    gear, model = STEEL.replace({"test.speed": 2.5}), Fidelity.preset("flank")
    short = gear.replace({**parts, "mesh.bristle_travel": "0.5 um", "yoke.bristle_travel": "0.5 um"})
    assert sliding_damping(short, model) == pytest.approx(sliding_damping(gear, model))
    assert np.isnan(sliding_damping(gear.replace(parts), model))


def test_pinion_vibrates_against_the_teeth_up_to_the_limit() -> None:
    """At 2.5 rad/s friction that falls feeds a vibration of 10 kHz where one inertia is stable already.
    Motion in steps of 1 us, where it grows fastest, agrees: it grows at 0.85 of the limit and decays
    at 1.15."""
    gear, model = STEEL.replace({"test.speed": 2.5}), Fidelity.preset("flank")
    limit = sliding_damping(gear, model)
    assert 0.85 * limit > 1.05 * one_inertia_damping(gear)
    place = gear.replace({"test.start_angle": "40.9 deg"})
    rates = [fast_growth(place.replace({"column.damping": share * limit}), model) for share in (0.85, 1.15)]
    assert rates[0] > 20
    assert rates[1] < -20


def fallen(ratio: float, stiffness: float, speed: float) -> SteeringGear:
    """The default gear whose teeth and plunger are larger at rest, on a column, and the wheel's speed."""
    laws = {f"{part}.static_ratio": ratio for part in ("mesh", "yoke")}
    return STEEL.replace({**laws, "column.stiffness": stiffness, "test.speed": speed})


@pytest.mark.parametrize("case", [(1.3, 57.0, 0.8), (1.5, 100.0, 0.8), (1.4, 100.0, 1.0)])
def test_strong_instability_is_not_called_stable(case: tuple[float, float, float]) -> None:
    """Beyond a damping ratio of about -0.7 eigenvalues are real, or far from the natural frequency: they
    count. The gear's limit is between 1 and 1.3 of that which integration of one inertia finds."""
    gear = fallen(*case)
    measured = sliding_limit(reduced_gear(gear), case[2])
    assert one_inertia_damping(gear) == pytest.approx(measured, rel=0.02)
    assert 1.0 < sliding_damping(gear, Fidelity.preset("flank")) / measured < 1.3


def test_limit_of_random_columns_is_that_of_events() -> None:
    """Three random columns, ratios and speeds up to the one at which friction falls steepest: one inertia to
    2 %, and the whole gear above it but for 2 % (the page has 200 of them)."""
    rng = np.random.default_rng(33)
    for _ in range(3):
        speed = float(np.exp(rng.uniform(np.log(0.1), np.log(0.8))))
        gear = fallen(rng.uniform(1.05, 1.6), float(np.exp(rng.uniform(np.log(20), np.log(400)))), speed)
        measured = sliding_limit(reduced_gear(gear), speed)
        assert one_inertia_damping(gear) == pytest.approx(measured, rel=0.02)
        assert sliding_damping(gear, Fidelity.preset("flank")) > 0.98 * measured


def test_masses_of_the_linearised_gear_are_those_of_its_exudyn_system() -> None:
    """All entries to 1e-9 of the largest of their rows and columns."""
    forces = gear_forces(STEEL, Fidelity.preset("flank"))
    motion = FreeMotion.of(STEEL, Fidelity.preset("flank"), Steady("pinion", 0.0, 0.0))
    found = mass_matrix(STEEL, forces, motion.place)
    size = np.sqrt(np.outer(np.diag(motion.mass), np.diag(motion.mass)))
    assert np.abs((found - motion.mass) / size).max() < 1e-9


def test_scene_states_the_limit_of_the_whole_gear() -> None:
    """Its metric is the damping by eigenvalues, in either direction of the wheel (the gear is not the same
    both ways, 15 %); nothing is stated where no friction falls."""
    gear, model = STEEL.replace({"test.speed": 2.5}), Fidelity.preset("flank")
    stated = predictions(gear, model)["sliding_damping"]
    assert stated == sliding_damping(gear, model) > 0
    other = predictions(gear.replace({"test.direction": -1}), model)["sliding_damping"]
    assert other == pytest.approx(stated, rel=0.15)
    assert predictions(GEAR, model)["sliding_damping"] == 0.0


def test_limit_is_not_found_where_nothing_grows() -> None:
    with pytest.raises(ArithmeticError, match="growth is"):
        measured_damping(GEAR.replace({"test.speed": 1.5}), Fidelity.preset("flank"), 0.02)


def test_cells_on_bristles_stick_inside_the_limit_and_slide_outside() -> None:
    """Half the damping of falling friction, and three times as much, at its worst speeds."""
    model = damped(0.0)
    speed = np.array([0.8, 1.2])
    limit = np.array([model.linear_limit(each) for each in speed])
    for presliding in (4e-4, 1e-3):
        assert (cells_on_bristles(model, presliding, speed, 0.5 * limit, 15) < 0.6).all()
        assert (cells_on_bristles(model, presliding, speed, 3 * limit, 15) > 0.9).all()


@pytest.mark.parametrize("implicit", [False, True])
def test_regularised_integration_tends_to_the_events(implicit: bool) -> None:
    """Amplitude of the twist in a zone of 0.01 and fine steps, to 2 %."""
    model = damped(0.05)
    exact = event_based(model, 1.0)
    assert exact is not None
    step = 2 * np.pi / model.frequency / 400
    time, twist = regularised(model, 1.0, 0.01, step, 5 * (exact.stick + exact.slip), implicit)
    later = time > time[-1] / 2
    assert np.ptp(twist[later]) / 2 == pytest.approx(exact.amplitude, rel=0.02)
