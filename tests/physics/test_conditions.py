"""Temperature and wear: their laws against closed forms and marching; a new gear at 20 degC is unchanged."""

import math

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.yoke import seat_wedge_factor
from rps_exudyn.inference.fitting.bench_tests import BenchTest
from rps_exudyn.inference.fitting.prediction import Prediction
from rps_exudyn.inference.uncertainty.quick_band import formula_torques
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.scenes.checks.rules import Breach
from rps_exudyn.solvers.closed_form import free_torque, mean_state
from rps_exudyn.solvers.temperature_and_wear import (
    STEEL_EXPANSION,
    bush_clearance_per_kelvin,
    bush_in_operation,
    clearance_per_kelvin,
    operating_gear,
    viscosity,
    wear_per_cycle,
)

GEAR = rps.SteeringGear()
DRY = {"-40 degC": 0.718, "-30 degC": 0.695, "0 degC": 0.642, "80 degC": 0.564}  # [N m], computed elsewhere


def at(temperature: str, **others: object) -> rps.SteeringGear:
    return GEAR.replace({"conditions.temperature": temperature, **others})


def test_a_new_gear_at_20_degrees_is_the_gear_itself() -> None:
    assert operating_gear(GEAR) is None
    assert operating_gear(at("20 degC")) is None
    assert operating_gear(at("293.15 K")) is None


@pytest.mark.parametrize("temperature", DRY)
@pytest.mark.parametrize("fidelity", ["closed-form", "quasi-static"])
def test_dry_torque_over_temperature(temperature: str, fidelity: str) -> None:
    result = rps.run("free-pinion-torque", at(temperature), fidelity=fidelity)
    assert result.status.value == "ok"
    assert result.summary["torque_mean"] == pytest.approx(DRY[temperature], rel=0.02)


def test_clearance_follows_the_materials() -> None:
    """Of a housing and a plunger of aluminium, and of a plunger of POM."""
    assert clearance_per_kelvin(GEAR) == pytest.approx(0.32e-6, rel=0.03)
    polymer = GEAR.replace({"yoke.plunger_expansion": "115e-6 1/K"})
    assert clearance_per_kelvin(polymer) == pytest.approx(-1.70e-6, rel=0.03)
    hot = operating_gear(polymer.replace({"conditions.temperature": "40 degC"}))
    assert hot is not None
    assert hot.gear.yoke.clearance == pytest.approx(16e-6, abs=1e-6)


def test_a_spring_that_has_set_presses_less() -> None:
    """5 % less force: 3.8 % less torque, of which drag and bearings take their part all the same."""
    new, old = (
        rps.run("free-pinion-torque", each, fidelity="quasi-static").summary
        for each in (GEAR, GEAR.replace({"conditions.spring_set": 0.05}))
    )
    assert old["operating_preload"] == pytest.approx(0.95 * GEAR.yoke.preload, rel=1e-12)
    assert old["torque_mean"] / new["torque_mean"] - 1 == pytest.approx(-0.038, abs=0.002)


def test_bore_of_a_tube_that_the_housing_holds() -> None:
    """By finite differences of rings of the wall, in generalised plane strain; 0.65 um/K on the default gear
    (0.6 um/K estimated elsewhere)."""
    bush, rings = GEAR.bush, 400
    held, nu = GEAR.housing.expansion, bush.poisson_ratio
    r = np.linspace(bush.inner_diameter / 2, bush.outer_diameter / 2, rings + 1)
    # sigma of strains e_r = u', e_t = u / r, e_z = held, without what heat alone would make of them
    wall, cross = 1 - nu, nu
    system, right = np.zeros((rings + 1, rings + 1)), np.zeros(rings + 1)
    hot = (1 + nu) * bush.expansion - nu * held
    for a, b in ((i, i + 1) for i in range(rings)):  # energy of each ring, its middle
        middle, width = (r[a] + r[b]) / 2, r[b] - r[a]
        radial, around = np.zeros(rings + 1), np.zeros(rings + 1)
        radial[[a, b]], around[[a, b]] = (-1 / width, 1 / width), (0.5 / middle, 0.5 / middle)
        weight = middle * width
        for one, other, size in (
            (radial, radial, wall),
            (around, around, wall),
            (radial, around, cross),
            (around, radial, cross),
        ):
            system += weight * size * np.outer(one, other)
        right += weight * hot * (radial + around)
    outer = held * r[-1]
    inner = np.linalg.solve(system[:-1, :-1], right[:-1] - system[:-1, -1] * outer)[0]
    expected = 2 * inner - STEEL_EXPANSION * GEAR.rack.bar_diameter
    assert bush_clearance_per_kelvin(GEAR) == pytest.approx(expected, rel=1e-3)
    assert bush_clearance_per_kelvin(GEAR) == pytest.approx(-0.65e-6, rel=0.02)


def test_the_bush_grips_in_the_heat_and_lets_go_in_the_cold() -> None:
    pressed = {"bush.interference": "50 um"}
    assert bush_in_operation(at("80 degC")) == (0.0, 20.0)  # slotted: it does not follow
    closing = 60 * bush_clearance_per_kelvin(GEAR)
    assert bush_in_operation(at("80 degC", **pressed)) == pytest.approx((0.0, 20 * (1 - closing / 50e-6)))
    room, drag = bush_in_operation(at("-40 degC", **pressed | {"bush.interference": "30 um"}))
    assert (room, drag) == pytest.approx((-closing - 30e-6, 0.0))
    assert bush_in_operation(at("80 degC", **{"bush.clearance": "60 um"}))[0] == pytest.approx(
        60e-6 + closing
    )
    with pytest.raises(InputError, match=r"it closes bush\.clearance = 30 um by 39\.3 um: the bar jams"):
        operating_gear(at("80 degC", **{"bush.clearance": "30 um"}))
    hot, usual = (
        rps.run("free-pinion-torque", each, fidelity="quasi-static").summary
        for each in (at("80 degC", **pressed), GEAR.replace(pressed))
    )
    assert hot["operating_bush_drag"] == pytest.approx(35.7, rel=1e-3)
    assert "operating_bush_drag" not in usual


def test_viscosities_of_data_sheets() -> None:
    """ISO 3448 grades by definition at 40 degC; PAO 32 as its data sheet has it."""
    for oil, at_40 in {"PAO 32": 31.5, "VG 68": 68, "VG 100": 100, "VG 150": 150}.items():
        assert 1e6 * viscosity(oil, 313.15) == pytest.approx(at_40, rel=2e-3)
    assert 1e6 * viscosity("VG 100", 373.15) == pytest.approx(11.1, rel=2e-3)
    with pytest.raises(InputError, match="pour point"):
        viscosity("VG 100", 233.15)


def test_grease_drag_is_the_same_by_formula_and_equilibria_and_closes_the_work() -> None:
    gear = at("-30 degC", **{"grease.base_oil": "VG 100"})
    formula, balance = (
        rps.run("free-pinion-torque", gear, fidelity=name) for name in ("closed-form", "quasi-static")
    )
    assert balance.summary["torque_mean"] == pytest.approx(formula.summary["torque_mean"], rel=0.02)
    assert abs(balance.summary["energy_residual"]) < 1e-3
    dry = rps.run("free-pinion-torque", at("-30 degC"), fidelity="quasi-static")
    assert balance.summary["torque_mean"] > 1.5 * dry.summary["torque_mean"]


def test_viscous_drag_follows_the_speed() -> None:
    """Twice the speed adds once more what the viscous drag has added to the torque."""
    slow, fast = (
        rps.run(
            "free-pinion-torque",
            GEAR.replace({"bush.viscous_drag": "1000 N*s/m"}),
            fidelity="quasi-static",
            speed=speed,
        ).summary["torque_mean"]
        for speed in ("15 rpm", "30 rpm")
    )
    without = rps.run("free-pinion-torque", GEAR, fidelity="quasi-static").summary["torque_mean"]
    assert fast - without == pytest.approx(2 * (slow - without), rel=2e-3)


def test_wear_against_marching_with_the_work_that_runs_book() -> None:
    """A life in ten steps, from the friction work of equilibria: normal force times way is work over mu."""
    life, steps, turned = 1e6, 10, 4 * GEAR.conditions.cycle_angle
    mean, (_, by_teeth) = mean_state(GEAR, 1, 0.0), wear_per_cycle(GEAR)
    wedge = seat_wedge_factor(GEAR.yoke.seat_angle)  # normal force on the seat's arc over the preload
    seat = GEAR.rack.bar_diameter * math.sin(GEAR.yoke.seat_angle) * GEAR.yoke.seat_length
    closing = 0.0
    for _ in range(steps):
        tested = GEAR.replace(
            {
                "yoke.preload": GEAR.yoke.preload - GEAR.yoke.spring_rate * closing,
                "yoke.clearance": GEAR.yoke.clearance + closing,
            }
        )
        run = rps.run("free-pinion-torque", tested, fidelity="quasi-static", turns=1)
        way = run["work_seat_friction"][-1] / GEAR.yoke.friction / wedge * turned / (2 * math.pi)
        mesh = run["work_mesh_friction"][-1] / (2 * math.pi * mean.mesh_loss)  # over that of the new gear
        closing += life / steps * (GEAR.yoke.liner_wear * way / seat + by_teeth * GEAR.yoke.preload * mesh)
    worn = operating_gear(GEAR.replace({"conditions.steering_cycles": life}))
    assert worn is not None
    assert worn.wear.closing == pytest.approx(closing, rel=0.05)


@pytest.mark.parametrize("coefficient", [1e-15, 5.5e-15])
def test_torque_over_a_life_is_that_of_the_closed_form(coefficient: float) -> None:
    """What a million cycles take off the torque, by equilibria and by formula, to 1 % of it."""
    changes = []
    for fidelity in ("quasi-static", "closed-form"):
        new, old = (
            rps.run(
                "free-pinion-torque",
                GEAR.replace({"conditions.steering_cycles": cycles, "yoke.liner_wear": coefficient}),
                fidelity=fidelity,
            ).summary["torque_mean"]
            for cycles in (0.0, 1e6)
        )
        changes.append(old / new - 1)
    assert changes[0] == pytest.approx(changes[1], rel=0.01)
    assert changes[1] == pytest.approx({1e-15: -0.0040, 5.5e-15: -0.0202}[coefficient], rel=0.01)


def test_wear_ends_where_the_spring_is_at_rest() -> None:
    """However long the life, the plunger cannot follow further than the spring presses."""
    worn = operating_gear(GEAR.replace({"conditions.steering_cycles": 1e8, "yoke.liner_wear": 1e-13}))
    assert worn is not None
    assert worn.wear.closing == pytest.approx(GEAR.yoke.preload / GEAR.yoke.spring_rate, rel=1e-6)
    assert worn.gear.yoke.preload == pytest.approx(0.0, abs=1e-3)


def test_wear_over_cycles_is_in_proportion_at_first() -> None:
    closings = [
        operating_gear(GEAR.replace({"conditions.steering_cycles": n})).wear.closing  # type: ignore[union-attr]
        for n in (1e3, 2e3)
    ]
    assert closings[1] / closings[0] == pytest.approx(2.0, rel=1e-4)


def test_fits_and_bands_take_the_gear_in_operation() -> None:
    """A curve measured in the cold is compared with the gear in the cold, by formula and by equilibria."""
    cold, prediction = at("-30 degC"), Prediction.of([BenchTest("free")])
    formula, run = (
        rps.run("free-pinion-torque", cold, fidelity=each) for each in ("closed-form", "quasi-static")
    )
    forward = slice(prediction.blocks[0].grid.size)
    found = prediction.simulated(cold)[forward].mean(), prediction.by_formula(cold)[forward].mean()
    assert found[0] == pytest.approx(run.summary["torque_mean"], rel=1e-3)
    assert found[1] == pytest.approx(formula.summary["torque_mean"], rel=1e-9)
    one = Samples.drawn(
        {"conditions.temperature": Distribution.read("uniform(-31 degC, -29 degC)", "K")}, 8, 1
    )
    torques = formula_torques(GEAR, one)
    assert torques == pytest.approx(np.full(8, found[1]), rel=0.005)


@pytest.mark.parametrize("robust", [False, True])
def test_checks_before_a_run_look_at_the_gear_in_operation(
    robust: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A limit that the preload of a new gear keeps may be exceeded in the cold, and the other way about."""
    looked_at = []

    def breaches(gear: rps.SteeringGear, *_: object, **__: object) -> list[Breach]:
        looked_at.append(gear.yoke.preload)
        return []

    monkeypatch.setattr("rps_exudyn.scenes.checks.rules.breaches_of_plan", breaches)
    monkeypatch.setattr("rps_exudyn.simulate.run_plan.breaches_of_plan", breaches)
    rps.run("free-pinion-torque", at("-40 degC"), fidelity="closed-form", robust=robust)
    assert looked_at == [pytest.approx(306.2, rel=1e-3)]


def test_formulas_refuse_a_viscous_drag_at_changing_speed() -> None:
    gear = GEAR.replace({"bush.viscous_drag": 500.0})
    assert free_torque(gear) > free_torque(GEAR)
    result = rps.run("reversal", gear, fidelity="closed-form")
    assert result.status.value == "invalid"
    assert "constant speed" in result.message


def test_a_distribution_of_temperatures_has_its_width_in_kelvin() -> None:
    drawn = Distribution.read("20 degC +- 10 degC", "K")
    assert (drawn.first, drawn.second) == pytest.approx((293.15, 10.0))
    np.testing.assert_allclose(Distribution.read("uniform(0 degC, 40 degC)", "K").ends, (273.15, 313.15))
