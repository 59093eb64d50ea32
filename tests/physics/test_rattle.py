"""Rattle: metrics of made-up impacts, bands of acceleration, and a short shake of the default gear."""

from dataclasses import replace

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.impacts import describe_rattle, split_at_repeats
from rps_exudyn.forces.external_load import RoadForce
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.rattle import GrowingForce, threshold
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.prescribed_motion import Steady

GEAR = SteeringGear()
PERIOD, MASS = 0.05, 0.06
BAND = (100, 1000)


def made_up(speeds: tuple[float, ...], lift: float = 0.0, sounding: float = 300.0) -> dict[str, np.ndarray]:
    """One cycle with impacts of 100 N for 1 ms at evenly spread instants, the plunger approaching at a speed;
    the rack shakes by `lift` [m] at `sounding` [Hz]."""
    time = np.linspace(0, PERIOD, 5001)
    force, plunger = np.zeros_like(time), np.zeros_like(time)
    for i, speed in enumerate(speeds):
        begin = 500 + i * 1000
        force[begin : begin + 101] = 100.0
        plunger[begin - 200 : begin + 101] = speed * 1e-5 * np.arange(301)
    shaking = lift * np.sin(2 * np.pi * sounding * time)
    return {"time": time, "yokenut_force": force, "plunger_displacement": plunger, "rack_y": shaking}


def joined(*runs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    starts = np.arange(len(runs)) * PERIOD
    parts = [{**run, "time": run["time"] + start} for run, start in zip(runs, starts, strict=True)]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@pytest.mark.quick
def test_metrics_of_known_impacts() -> None:
    """Two and one impacts in two runs of one cycle: impulse 100 N x 1 ms each, half a sample is 1 %."""
    metrics = describe_rattle(joined(made_up((0.1, 0.2)), made_up((0.3,))), PERIOD, MASS, BAND)
    assert metrics["rattle_impacts_per_cycle"] == pytest.approx(1.5)
    assert metrics["rattle_impacts_scatter"] == pytest.approx(0.5)
    assert metrics["rattle_impulse_per_cycle"] == pytest.approx(0.15, rel=0.02)
    assert metrics["rattle_force_rms"] == pytest.approx(np.sqrt(0.03 * 100**2 / 1), rel=0.02)
    assert metrics["rattle_speed_rms"] == pytest.approx(np.sqrt((0.01 + 0.04 + 0.09) / 3))
    assert metrics["rattle_energy_per_cycle"] == pytest.approx(MASS / 4 * (0.01 + 0.04 + 0.09))
    assert metrics["rattle_fastest_impact"] == pytest.approx(0.25)
    assert metrics["rattle_fastest_scatter"] == pytest.approx(0.05)


@pytest.mark.quick
def test_uncertainty_of_cycles_is_that_of_their_mean() -> None:
    """Cycles of 0.2 and 0.1 N s have a mean of 0.15 and a standard uncertainty of 0.05 (half a sample: 2 %);
    squares of 400 and 200 N^2 one of 100 N^2, which is 2 rms u. One cycle has none."""
    runs = made_up((0.1, 0.2)), made_up((0.3,))
    metrics = describe_rattle(joined(*runs), PERIOD, MASS, BAND)
    assert metrics["rattle_impulse_uncertainty"] == pytest.approx(0.05, rel=0.02)
    rms, energy = metrics["rattle_force_rms"], MASS / 4 * abs(0.01 + 0.04 - 0.09)
    assert metrics["rattle_force_rms_uncertainty"] == pytest.approx(100 / (2 * rms), rel=0.02)
    assert metrics["rattle_energy_uncertainty"] == pytest.approx(energy)
    assert not [name for name in describe_rattle(runs[0], PERIOD, MASS, BAND) if "uncertainty" in name]


@pytest.mark.quick
def test_no_impacts_no_rattle() -> None:
    metrics = describe_rattle(made_up(()), PERIOD, MASS, BAND)
    assert not any(metrics.values())


@pytest.mark.quick
@pytest.mark.parametrize(("sounding", "heard"), [(300.0, True), (40.0, False), (2000.0, False)])
def test_band_takes_what_lies_in_it(sounding: float, heard: bool) -> None:
    """RMS of A omega^2 sin is A omega^2 / sqrt 2 inside the band; a Hann window leaks 1e-3 of a tone outside,
    where omega is higher."""
    lift = 1e-6
    metrics = describe_rattle(made_up((), lift, sounding), PERIOD, MASS, BAND)
    whole = lift * (2 * np.pi * sounding) ** 2 / np.sqrt(2)
    expected = pytest.approx(whole, rel=0.02) if heard else pytest.approx(0, abs=0.05 * whole)
    assert metrics["rattle_acceleration_rms"] == expected


@pytest.mark.quick
def test_record_is_split_where_an_instant_stands_twice() -> None:
    runs = split_at_repeats(joined(made_up((0.1,)), made_up((0.1,)), made_up((0.1,))))
    assert [len(run["time"]) for run in runs] == [5001] * 3


@pytest.mark.quick
def test_road_force_is_a_sine_or_its_positive_halves() -> None:
    whole, halves = (RoadForce((3.0, 4.0, 0.0), -0.18, 20.0, 0.0, half) for half in (False, True))
    quarter = 1 / 80
    np.testing.assert_allclose(whole.force(quarter), [3, 4, 0])
    np.testing.assert_allclose(whole.force(3 * quarter), [-3, -4, 0])
    np.testing.assert_allclose(halves.force(3 * quarter), 0, atol=1e-15)
    np.testing.assert_allclose(replace(whole, phase=np.pi / 2).force(0.0), [3, 4, 0])


@pytest.mark.quick
def test_growing_force_finds_its_amplitude_at_the_first_hit() -> None:
    """It grows to 5 N in two cycles after one of run-in; the hit comes after a quarter of them: 1.25 N."""
    road = (3.0, 4.0, 0.0), -0.18, 1 / PERIOD, 0.0, False
    force = GrowingForce(*road, begin=PERIOD, duration=2 * PERIOD)
    assert force.share(PERIOD / 4) == 0
    assert force.share(PERIOD * 1.25) == pytest.approx(0.125)
    assert force.grown(9 * PERIOD) == 1
    time = np.linspace(0, 2 * PERIOD, 401)
    signals = {"time": time, "yokenut_force": np.where(time >= PERIOD / 2, 10.0, 0.0)}
    maneuver = Maneuver(Steady("pinion", 0.0, 0.0), PERIOD / 200, 200, 400, pulse=force)
    metrics = threshold(joined(signals, signals), [maneuver, maneuver])
    assert metrics["rattle_threshold_force"] == pytest.approx(1.25)
    assert metrics["rattle_threshold_scatter"] == pytest.approx(0, abs=1e-9)
    signals["yokenut_force"][:] = 0
    assert threshold(signals, [maneuver]) == {}


# --- the gear ----------------------------------------------------------------------------------------
FAST = {"test.road_frequency": "100 Hz", "test.road_cycles": 2, "test.road_phases": 1, "rack.modes": 4}


@pytest.fixture(scope="module")
def shaken() -> Result:
    result = rps.run("rattle", GEAR.replace(FAST), fidelity=Fidelity.preset("flank"))
    assert result.status is Status.OK, result.message
    return result


def test_shaken_gear_rattles(shaken: Result) -> None:
    """The plunger hits in each cycle; work of the road is stored or lost to 0.2 %; the force's signal is that
    of the road, 1 kN at 100 Hz."""
    assert 0.99 <= shaken.summary["rattle_impacts_per_cycle"] <= 4
    assert abs(shaken.summary["energy_residual"]) < 2e-3
    expected = 1000 * np.sin(2 * np.pi * 100 * shaken["time"])
    np.testing.assert_allclose(shaken["road_force"], expected, atol=1.0)


def test_impulse_on_the_nut_is_what_the_plunger_carries_over_whole_cycles(shaken: Result) -> None:
    """Over whole cycles the plunger's momentum returns: the nut's impulse is the seat's less the spring's.

    The plunger keeps 0.06 kg x 0.1 m/s; that and every fourth instant of short impacts leave 3 % of it.
    """
    time, yoke = shaken["time"], GEAR.yoke
    spring = yoke.preload + yoke.spring_rate * shaken["plunger_displacement"]
    left = np.trapezoid(shaken["seat_force"] - spring - shaken["yokenut_force"], time)
    assert abs(left) < 0.03 * np.trapezoid(shaken["yokenut_force"], time)


def test_half_the_steps_change_no_promised_figure(shaken: Result) -> None:
    """Impulse, force RMS and speed RMS of steps half as long: 3 %."""
    finer = rps.run(
        "rattle", GEAR.replace(FAST), fidelity=Fidelity.preset("flank").replace({"swing_steps": 14})
    )
    for name in ("rattle_impulse_per_cycle", "rattle_force_rms", "rattle_speed_rms"):
        assert shaken.summary[name] == pytest.approx(finer.summary[name], rel=0.03)


def test_threshold_lies_between_forces_that_do_not_hit_and_forces_that_do() -> None:
    """A steady sine of 0.7 of the threshold hits nothing, one of 1.1 times it does."""
    slow = FAST | {"test.road_cycles": 5, "test.road_shape": "growing-sine"}
    found = rps.run("rattle", GEAR.replace(slow), fidelity=Fidelity.preset("flank"))
    assert "grows by 200 N per cycle" in found.message
    limit = found.summary["rattle_threshold_force"]
    hits = [
        rps.run("rattle", GEAR.replace(FAST | {"test.road_force": share * limit})).summary["rattle_force_rms"]
        for share in (0.7, 1.1)
    ]
    assert hits[0] == 0 < hits[1]


@pytest.mark.quick
def test_a_growing_force_on_a_gear_that_finds_no_start_keeps_its_cause(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nothing is recorded then: there is no threshold to read, and nothing to remark."""
    lost = SceneRun(Outcome(Status.NO_CONVERGENCE, "no start was found"))
    monkeypatch.setattr("rps_exudyn.scenes.rattle.run_maneuver", lambda *_, **__: lost)
    growing = FAST | {"test.road_shape": "growing-sine"}
    result = rps.run("rattle", GEAR.replace(growing))
    assert (result.status, result.message) == (Status.NO_CONVERGENCE, "no start was found")
