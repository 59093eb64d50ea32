"""The steering column: its joint, its torques, and the feel at the wheel by equilibria and by dynamics."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.wheel_metrics import describe_feel
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.multibody.column import jointed_forces, jointed_tangent
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.solvers.steering_column import ColumnModel
from verification.work_precision import both_over_time, rms_difference, size_of

GEAR = SteeringGear()
BENT = SteeringGear().replace({"column.joint_angle": "30 deg", "column.joint_phase": "20 deg"})
PARTS = ("mesh", "yoke", "bush", "bearing")


@cache
def feel(law: str = "coulomb", fidelity: str = "quasi-static", joint: bool = False) -> Result:
    gear = (BENT if joint else GEAR).replace({f"{part}.friction_law": law for part in PARTS})
    result = rps.run("steering-feel", gear, fidelity=fidelity)
    assert result.status is Status.OK, result.message
    return result


def test_joint_turns_as_two_yokes_across_each_other() -> None:
    """The axes of both yokes are perpendicular at every angle: the cross between them holds them so."""
    column = replace(ColumnModel.of(GEAR), bend=0.6, phase=0.3)
    for angle in np.linspace(-4, 4, 23):
        wheel_side = angle + column.phase
        gear_side = float(column.output(angle)) + np.arctan2(
            np.sin(column.phase), np.cos(column.phase) * np.cos(column.bend)
        )
        across = np.array([np.cos(wheel_side), np.sin(wheel_side), 0.0])
        leaning = np.array([np.cos(column.bend), 0.0, -np.sin(column.bend)])  # across the output's shaft
        other = -np.sin(gear_side) * leaning + np.cos(gear_side) * np.array([0.0, 1.0, 0.0])
        assert across @ other == pytest.approx(0.0, abs=1e-12)


def test_slopes_of_the_joint_are_its_derivatives() -> None:
    """Central differences, to 1e-8."""
    column, angle, step = replace(ColumnModel.of(GEAR), bend=0.6, phase=0.3), np.linspace(-4, 4, 99), 1e-5
    ratio = (column.output(angle + step) - column.output(angle - step)) / (2 * step)
    slope = (column.ratio(angle + step) - column.ratio(angle - step)) / (2 * step)
    assert column.ratio(angle) == pytest.approx(ratio, abs=1e-8)
    assert column.ratio_slope(angle) == pytest.approx(slope, abs=1e-8)


def test_tangent_of_a_jointed_column() -> None:
    """Differences of the torques by places and rates, to 1e-6 of the stiffness."""
    column = replace(ColumnModel.of(GEAR), bend=0.6, phase=0.3)
    q, v, step = np.array([0.7, 0.69]), np.array([0.3, -0.2]), 1e-6
    for factors in ((1.0, 0.0), (0.0, 1.0), (0.3, 2.0)):
        found = jointed_tangent(q, v, column, *factors)
        for j, unit in enumerate(np.eye(2)):
            ahead, behind = (
                jointed_forces(
                    q + sign * factors[0] * step * unit, v + sign * factors[1] * step * unit, column
                )
                for sign in (1, -1)
            )
            assert found[:, j] == pytest.approx((ahead - behind) / (2 * step), abs=1e-4)


def test_jointed_column_does_no_work_of_its_own() -> None:
    """Undamped, the power that wheel and pinion give is that of the spring, to rounding."""
    column = replace(ColumnModel.of(GEAR), bend=0.6, phase=0.3, damping=0.0)
    q, v = np.array([0.7, 0.69]), np.array([0.3, -0.2])
    twist = float(column.output(-q[0]) + q[1])
    twisting = float(v[1] - column.ratio(-q[0]) * v[0])
    assert -jointed_forces(q, v, column) @ v == pytest.approx(column.stiffness * twist * twisting, rel=1e-12)


@pytest.mark.parametrize("law", ["coulomb", "bristle"])
def test_equilibria_feel_as_dynamics_do(law: str) -> None:
    """Metrics to 2 %, what steps of a twentieth of the angle of yielding and the friction zone leave behind
    the column."""
    still, moving = (feel(law, model).summary for model in ("quasi-static", "flank"))
    for name in ("feel_area", "feel_running_torque", "on_centre_stiffness", "feel_angle_hysteresis"):
        assert still[name] == pytest.approx(moving[name], rel=2e-2), name


def test_joint_is_felt_alike_by_both() -> None:
    """Torque over angle of a bent column, equilibria against dynamics, to 0.2 % of the running torque (RMS)
    and 1.5 % as the gear breaks away, and far from a straight one: the ratio goes from 0.87 to 1.15."""
    still, moving, straight = feel(joint=True), feel(fidelity="flank", joint=True), feel()
    time = np.linspace(0.1, still["time"][-1] - 0.1, 400)
    curves = [np.interp(time, each["time"], each["column_torque"]) for each in (still, moving, straight)]
    running = straight.summary["feel_running_torque"]
    turning = np.abs(np.diff(np.sign(np.gradient(still["wheel_angle"])))) > 0
    away = np.all([np.abs(time - t) > 0.02 for t in still["time"][1:][turning]], axis=0)
    apart = (curves[0] - curves[1])[away]
    assert np.sqrt(np.mean(apart**2)) < 2e-3 * running
    assert np.abs(apart).max() < 0.015 * running
    assert np.abs(curves[0] - curves[2]).max() > 0.05 * running


def test_curves_in_different_steps_lie_over_each_other() -> None:
    """Recording begins at another phase with every step, which a comparison over time takes into account: the
    curves differ by the steps' error (0.06 %) and not by the phase (1.5 %)."""
    flank = Fidelity.preset("flank")
    coarse, fine = (flank.replace({"step_angle": step}) for step in ("0.83 deg", "0.5 deg"))
    curves = [
        scene_named("steering-feel").curve(rps.run("steering-feel", GEAR, fidelity=each).signals, GEAR, each)
        for each in (coarse, fine)
    ]
    assert rms_difference(*both_over_time(*curves), size_of(curves[1])) < 0.2


def test_column_is_a_spring_in_series() -> None:
    """Coulomb's friction holds the gear until it slides: the stiffness at the wheel is the column's, to
    0.5 %; bristles yield as well, which softens it."""
    assert feel().summary["on_centre_stiffness"] == pytest.approx(GEAR.column.stiffness, rel=5e-3)
    assert feel("bristle").summary["on_centre_stiffness"] < 0.85 * GEAR.column.stiffness


@pytest.mark.parametrize("fidelity", ["quasi-static", "flank"])
@pytest.mark.parametrize("mounts", [5e6, 2e7])
def test_mounts_of_the_housing_are_a_spring_in_series(mounts: float, fidelity: str) -> None:
    """5 N/um make 68 of the column's 120 N m/rad; the housing yields by the running torque's force on it, and
    what column and mounts store belongs to the balance."""
    gear = GEAR.replace({"housing.mount_stiffness": mounts})
    result, gain = rps.run("steering-feel", gear, fidelity=fidelity), float(GearPair.of(GEAR).gain)
    expected = 1 / (1 / GEAR.column.stiffness + 1 / (mounts * gain**2))
    assert result.summary["on_centre_stiffness"] == pytest.approx(expected, rel=5e-3)
    moved = -result["pinion_torque"] / (gain * mounts)
    assert result["housing_displacement"] == pytest.approx(moved, abs=0.02 * np.abs(moved).max())
    assert abs(result.summary["energy_residual"]) < 1e-3
    assert "housing_displacement" not in feel(fidelity=fidelity).signals


def test_hand_carries_the_wheel() -> None:
    """What the hand gives beyond the column's torque is inertia times acceleration, to 1e-9."""
    result = feel("bristle", "flank")
    extra = result["wheel_torque"] - result["column_torque"]
    amplitude, speed = GEAR.test.amplitude, GEAR.test.speed
    largest = GEAR.column.wheel_inertia * speed**2 / amplitude
    expected = -GEAR.column.wheel_inertia * (speed / amplitude) ** 2 * result["wheel_angle"]
    assert np.abs(extra - expected).max() < 1e-9 * largest


def test_work_over_the_column_balances() -> None:
    """Drive, friction, the column's damping and what is stored, to 0.2 % by both solvers; the column stores
    half k x^2."""
    for result in (feel("bristle"), feel("bristle", "flank"), feel(fidelity="flank", joint=True)):
        assert abs(result.summary["energy_residual"]) < 2e-3
        stored = GEAR.column.stiffness * result["column_twist"] ** 2 / 2
        assert result["column_energy"] == pytest.approx(stored, rel=1e-12)
        assert result["work_column_damping"][-1] > 0


def test_metrics_of_a_made_up_loop() -> None:
    """A parallelogram: running 0.6 N m after 0.01 rad at 120 N m/rad, area 4 T (A - T / k)."""
    stiffness, running, amplitude = 120.0, 0.6, 0.5
    half = 0.5 * np.pi + np.linspace(0, 2 * np.pi, 40001)
    angle = amplitude * np.sin(np.concatenate([np.linspace(-np.pi / 2, np.pi / 2, 2000), half[1:]]))
    torque, value = np.empty_like(angle), -running
    for i, step in enumerate(np.diff(angle, prepend=angle[0])):
        value = float(np.clip(value + stiffness * step, -running, running))
        torque[i] = value
    signals = {"wheel_angle": angle, "column_torque": torque, "pinion_angle": angle}
    metrics = describe_feel(signals)
    assert metrics["feel_running_torque"] == pytest.approx(running, rel=1e-6)
    assert metrics["on_centre_stiffness"] == pytest.approx(stiffness, rel=1e-3)
    assert metrics["feel_angle_hysteresis"] == pytest.approx(1.9 * running / stiffness, rel=1e-3)
    assert metrics["feel_area"] == pytest.approx(4 * running * (amplitude - running / stiffness), rel=1e-3)
    assert metrics["breakaway_ratio"] == pytest.approx(1.0, rel=1e-6)


def test_column_at_rest_changes_no_other_scene() -> None:
    """A scene that turns the pinion gives the same numbers whatever the column is."""
    other = GEAR.replace({"column.stiffness": "50 N*m/rad", "column.joint_angle": "30 deg"})
    first, second = (
        rps.run("reversal", gear, fidelity=Fidelity.preset("quasi-static")) for gear in (GEAR, other)
    )
    assert first.summary == second.summary


def test_a_way_that_ends_before_the_torque_turns_about_has_no_breakaway() -> None:
    """The record of a run that failed a little after the wheel turned back."""
    angle = np.concatenate([np.linspace(-0.5, 0.5, 400), np.linspace(0.5, 0.4999, 40)[1:]])
    signals = {"wheel_angle": angle, "column_torque": np.full(angle.size, 0.6), "pinion_angle": angle}
    assert "on_centre_stiffness" not in describe_feel(signals)
