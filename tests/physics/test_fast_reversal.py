"""Equilibria of swings contain all inertia; those of turns are refused where it matters."""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_inertia, rack_masses
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.equilibrium import EquilibriumPath
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.prescribed_motion import Steady, Swing
from rps_exudyn.solvers.record import record_of_path
from verification.runs import run_scene

HEAVY = {"pinion.density": 4e6}
"""A pinion that asks for a tenth of the torque at 30 rpm and 10 degrees."""


def reversal(model: str, rpm: float, degrees: float, settings: dict[str, float] | None = None) -> Result:
    """A reversal of the default gear at this speed and amplitude."""
    swing = {"test.speed": f"{rpm} rpm", "test.amplitude": f"{degrees} deg", **(settings or {})}
    return rps.run("reversal", SteeringGear().replace(swing), fidelity=model)


@pytest.mark.parametrize(("rpm", "degrees"), [(60, 20), (60, 12)])
def test_equilibria_jump_as_dynamics_do(rpm: float, degrees: float) -> None:
    """The running torque's jump, to 0.2 %: dynamics of this step are known to 0.1 % themselves."""
    still, moving = (reversal(model, rpm, degrees) for model in ("quasi-static", "flank"))
    assert still.status is Status.OK, still.message
    assert still.summary["torque_jump"] == pytest.approx(moving.summary["torque_jump"], rel=2e-3)


def test_a_heavy_pinion_is_accelerated_by_the_drive_alone() -> None:
    """The drive's torque is larger by J times the acceleration, and nothing else changes: the same place of
    the rack (1 nm), the same work lost, and a balance that closes; its steps are of second order (0.1 %)."""
    swing = {"test.speed": "30 rpm", "test.amplitude": "10 deg"}
    gears = [SteeringGear().replace(swing | settings) for settings in ({}, HEAVY)]
    model = Fidelity.preset("quasi-static")
    runs = [run_scene("reversal", gear, model) for gear in gears]
    light, heavy = (run.signals for run in runs)
    assert runs[1].ok, runs[1].outcome.message
    added = pinion_inertia(gears[1]) - pinion_inertia(gears[0])
    amplitude, speed = np.deg2rad(10), np.pi
    angle = light["pinion_angle"] - gears[0].test.start_angle
    torque = -added * (speed / amplitude) ** 2 * angle
    largest = np.abs(torque).max()
    assert heavy["pinion_torque"] - light["pinion_torque"] == pytest.approx(torque, abs=1e-3 * largest)
    assert largest > 0.05 * np.abs(light["pinion_torque"]).max()
    assert heavy["rack_displacement"] == pytest.approx(light["rack_displacement"], abs=1e-9)
    assert abs(runs[1].summary["energy_residual"]) < 1e-3


def test_the_racks_inertia_loads_the_teeth() -> None:
    """m a along the travel goes through the teeth: the difference of both flanks' forces changes by
    m a / (cos alpha_n cos beta_r), to 3 %: friction on the teeth turns the force by up to 0.1 rad."""
    dense = {"rack.density": 7.85e5 / 20}
    swing = {"test.speed": "60 rpm", "test.amplitude": "20 deg"}
    gears = [SteeringGear().replace(swing | settings) for settings in ({}, dense)]
    model = Fidelity.preset("quasi-static")
    light, heavy = (run_scene("reversal", gear, model).signals for gear in gears)
    added = np.subtract(*(rack_masses(gear).mass for gear in reversed(gears)))
    pair = GearPair.of(gears[0])
    middle = gears[0].test.start_angle
    turning = -((2 * np.pi / np.deg2rad(20)) ** 2) * (light["pinion_angle"] - middle)
    more = [run["mesh_normal_force_drive"] - run["mesh_normal_force_coast"] for run in (light, heavy)]
    force = added * pair.gain * turning / (np.cos(pair.alpha_n) * np.cos(pair.beta_r))
    slope = float((more[1] - more[0]) @ force / (force @ force))
    assert slope == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("rpm", [150, 600])
def test_equilibria_follow_a_swing_that_shakes_the_rack(rpm: float) -> None:
    """All metrics are those of dynamics within the error bars of both, works and gain within 2 %.
    Without the inertia of rolling and tilting the torque of the slower swing is 7 % off, RMS."""
    still, moving = (reversal(model, rpm, 5) for model in ("quasi-static", "flank"))
    assert still.status is moving.status is Status.OK, still.message
    compared = (still.summary.keys() & moving.summary.keys()) - {"energy_residual"}
    assert {"hysteresis_area", "rack_gain", "yoke_force_max"} <= compared
    for name in compared:
        apart = abs(still.summary[name] - moving.summary[name])
        assert not apart > still.errors[name] + moving.errors[name], (
            name
        )  # nan: no other level of 600 rpm ends
    for name in ("hysteresis_area", "rack_gain"):
        assert still.summary[name] == pytest.approx(moving.summary[name], rel=0.02), name


def test_bars_of_equilibria_grow_with_the_turn_that_shakes_the_rack() -> None:
    """A heavy rack over 50 um of runout: dynamics take the same torque at 600 rpm, 13 % more at 1200 rpm,
    and then the rack leaves its teeth; at 2400 rpm equilibria are no answer."""
    gear = SteeringGear().replace({"pinion.runout": "50 um", "rack.density": "40000 kg/m^3", "test.turns": 2})
    slow, fast, faster = (gear.replace({"test.speed": f"{each} rpm"}) for each in (600, 1200, 2400))
    still, moving = (rps.run("free-pinion-torque", slow, fidelity=each) for each in ("quasi-static", "flank"))
    assert still.status is Status.OK, still.message
    assert still.summary["torque_mean"] == pytest.approx(moving.summary["torque_mean"], rel=3e-3)
    shaken = rps.run("free-pinion-torque", fast, fidelity="quasi-static")
    assert still.errors["torque_mean"] < 0.04 * still.summary["torque_mean"]
    assert shaken.errors["torque_mean"] > 0.1 * shaken.summary["torque_mean"]
    refused = rps.run("free-pinion-torque", faster, fidelity="quasi-static")
    assert (refused.status, refused.codes) == (Status.INVALID, (Code.TURN_TOO_FAST,))


def test_a_path_without_any_equilibrium_makes_an_empty_record() -> None:
    """A gear that is lost at the first instant is an outcome, so its record must be made."""
    rows, drive = np.zeros((0, 8)), Steady("pinion", 0.0, 1.0)
    path = EquilibriumPath(np.zeros(0), rows, rows, rows, rows, 0, 0, 0, 0, 1.0, 0.0, 0.0)
    assert record_of_path(gear_forces(rps.SteeringGear(), Fidelity()), path, drive).energy.size == 0


@pytest.mark.quick
def test_accelerations_are_the_derivatives_of_rates() -> None:
    """By central differences of the rates: 1e-6 of the largest."""
    time, short = np.linspace(0.0, 2.0, 41), 1e-5
    for drive in (Steady("rack", 0.1, 0.2), Swing("pinion", 0.3, 0.5, -2.0)):
        found = drive.acceleration(time)
        rates = [drive.rate(time + shift) for shift in (short, -short)]
        expected = (rates[0] - rates[1]) / (2 * short)
        assert found == pytest.approx(expected, abs=1e-6 * max(np.abs(expected).max(), 1.0))
