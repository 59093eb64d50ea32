"""The inertia that equilibria leave out in steady motion: what it changes is found without a dynamic run."""

import numpy as np
import pytest

from rps_exudyn.analysis.harmonics import order_amplitude
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.neglected_inertia import (
    MovedMasses,
    accelerations,
    beside_travel,
    ringing,
    with_inertia,
)
from rps_exudyn.simulate.gear_table import simulate_table
from rps_exudyn.simulate.run import run
from rps_exudyn.solvers.closed_form import runout_harmonics

GEAR = SteeringGear().replace({"pinion.runout": "20 um"})
SHAKEN = {"torque_first_order", "torque_tooth_order", "torque_peak_to_peak", "rack_yaw_range"}


def test_acceleration_of_two_maneuvers_is_exact_for_parabolas() -> None:
    """Each has its own; the way back begins at the time at which the way there ends."""
    time = np.concatenate([np.linspace(0, 1, 11), np.linspace(1, 3, 21)])
    place = np.where(np.arange(32) < 11, 2 * time**2, 5 - 3 * time**2)
    (found,) = accelerations({"time": time, "x": np.stack([place, 2 * place])}, "x")
    assert found[0, :11] == pytest.approx(4)
    assert found[1, 11:] == pytest.approx(-12)


@pytest.mark.parametrize("rpm", [200, 400, 600])
def test_the_drive_with_inertia_has_the_orders_of_dynamics(rpm: int) -> None:
    """First order of Exudyn's motion; equilibria without inertia are 1, 5 and 10 % below."""
    gear = GEAR.replace({"test.speed": f"{rpm} rpm"})
    still, moving = (
        run("free-pinion-torque", gear=gear, fidelity=name) for name in ("quasi-static", "flank")
    )
    torque = with_inertia(still.signals, MovedMasses.of(gear))["pinion_torque"]
    expected = moving.summary["torque_first_order"]
    assert order_amplitude(still["pinion_angle"], torque, 1) == pytest.approx(expected, rel=0.015)
    lacking = order_amplitude(still["pinion_angle"], still["pinion_torque"], 1) / expected - 1
    assert lacking == pytest.approx(-0.1 * (rpm / 600) ** 2, abs=0.01)


def test_bars_of_what_needs_inertia_grow_with_the_speed() -> None:
    """At 60 rpm inertia adds nothing that counts, at 600 much to what varies, little to means."""
    slow, fast = (
        run("free-pinion-torque", gear=GEAR.replace({"test.speed": speed}), fidelity="quasi-static")
        for speed in ("60 rpm", "600 rpm")
    )
    for name in SHAKEN & fast.errors.keys():
        assert fast.errors[name] > 2 * slow.errors[name], name
    assert fast.errors["torque_mean"] < 0.02 * fast.summary["torque_mean"]


def test_a_rack_whose_rate_jumps_rings_on_its_teeth() -> None:
    """The amplitude of a mass on a spring after a jump of its rate; of a slow acceleration its static
    deflection."""
    masses = MovedMasses.of(SteeringGear())
    stiffness, time = 1e8, np.linspace(0, 1, 101)
    frequency = np.sqrt(stiffness / masses.rack)
    still = {"time": time, "pinion_torque": np.ones(101), "mesh_normal_force": np.full(101, 100.0)}
    still |= {"mesh_penetration": np.full(101, 100.0 / stiffness), "rack_y": np.zeros(101)}
    jump = still | {"rack_displacement": 1e-3 * np.maximum(time - 0.5, 0)}
    assert ringing(jump, masses) == pytest.approx(1e-3 / frequency, rel=1e-6)
    quick = {**still, "time": time * 1e-4, "rack_displacement": 0.5 * 3 * (time * 1e-4) ** 2}
    assert ringing(quick, masses) == pytest.approx(3 / frequency**2, rel=1e-6)


def test_inertia_grows_with_the_square_of_the_speed() -> None:
    shares = []
    for speed in ("100 rpm", "200 rpm"):
        gear = GEAR.replace({"test.speed": speed})
        still = run("rack-push", gear=gear, fidelity="quasi-static")
        shares.append(beside_travel(still.signals, MovedMasses.of(gear)))
    assert shares[1] == pytest.approx(4 * np.array(shares[0]), rel=1e-3)


def test_bars_of_many_gears_have_the_inertia_of_single_ones() -> None:
    """Racks of different mass, turned fast."""
    gear = GEAR.replace({"test.speed": "300 rpm", "bush.inner_diameter": "26 mm"})
    rng, fidelity = np.random.default_rng(1), Fidelity.preset("quasi-static")
    table = {"rack.bar_diameter": rng.uniform(0.022, 0.0255, 40), "pinion.runout": rng.uniform(0, 3e-5, 40)}
    many = simulate_table("free-pinion-torque", gear, fidelity, table)
    assert many is not None
    for row in range(0, 40, 8):
        own = {path: float(values[row]) for path, values in table.items()}
        single = run("free-pinion-torque", gear=gear.replace(own), fidelity=fidelity)
        for name in SHAKEN & single.errors.keys():
            assert many.errors[name][row] == pytest.approx(single.errors[name], rel=0.1), name


def test_formulas_have_the_inertia_along_the_travel() -> None:
    """The harmonic of the runout by formula is that of dynamics to 4 % at 600 rpm."""
    gear = GEAR.replace({"test.speed": "600 rpm"})
    moving = run("free-pinion-torque", gear=gear, fidelity="flank")
    assert np.hypot(*runout_harmonics(gear)) == pytest.approx(moving.summary["torque_first_order"], rel=0.04)
