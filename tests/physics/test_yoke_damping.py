"""Damping of seat and yokenut, friction of the plunger in its bore: closed forms, work, none by default, and
shaken gears against a plane model."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rps_exudyn as rps
from part_law import PartLaw
from rps_exudyn.forces.external_load import Pulse, RoadForce
from rps_exudyn.forces.force_element import DAMPING_POWER, ELASTIC_ENERGY
from rps_exudyn.forces.yoke import nut_force, nut_record, seat_wedge_factor
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.solvers.gear_forces import gear_forces
from verification.difference_tangent import difference_tangent
from verification.plane_impact import shaken

GEAR = rps.SteeringGear().replace({"mesh.law": "line"})
FLANK, QUASI_STATIC = (Fidelity.preset(name) for name in ("flank", "quasi-static"))
SHARP: dict[str, object] = {"yoke.bristle_travel": "1 um"}
DAMPED = {"yoke.nut_damping": "20 us", "yoke.seat_damping": "5 us", "yoke.bore_damping": "20 N*s/m"}


def restitution(mass: float, stiffness: float, damping: float) -> float:
    """Coefficient of restitution of a contact max(k (d + tau d'), 0) (Schwager, Poschel 2007)."""
    natural, rate = np.sqrt(stiffness / mass), damping * stiffness / (2 * mass)
    swing = np.sqrt(natural**2 - rate**2)
    lasting = np.pi - np.arctan2(2 * rate * swing, swing**2 - rate**2)
    return float(np.exp(-rate / swing * lasting))


@pytest.mark.parametrize("damping", ["1 us", "10 us", "30 us"])
def test_restitution_of_the_yokenut(damping: str) -> None:
    gear = GEAR.replace({"yoke.nut_damping": damping})
    data, mass, out = nut_record(gear), gear.yoke.plunger_mass, np.zeros(5)

    def motion(_: float, state: np.ndarray) -> list[float]:
        nut_force.py_func(state[0], state[1], data, out)
        return [state[1], out[0] / mass]

    start, quarter = [gear.yoke.clearance - 1e-7, 0.05], np.pi / 2 * np.sqrt(mass / data.stiffness)
    thrown = solve_ivp(motion, (0, 4 * quarter), start, max_step=quarter / 400, rtol=1e-9, atol=1e-12)
    expected = restitution(mass, float(data.stiffness), gear.yoke.nut_damping)
    assert -thrown.y[1, -1] / 0.05 == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("part", ["seat", "yokenut", "bore"])
def test_damping_takes_what_its_force_does_not_store(part: str) -> None:
    """Power of the force = change of the stored energy + what is lost, at any place and rate."""
    frictionless = {"yoke.friction": 0.0, "yoke.clearance": 0.0}
    law = PartLaw.of(gear_forces(GEAR.replace(DAMPED | frictionless), FLANK), part)
    rng = np.random.default_rng(4)
    lost = []
    for _ in range(20):
        q = rng.uniform(-1, 1, law.size) * np.array([1e-2, 2e-5, 1e-5, 1e-3, 1e-4, 1e-4, 2e-5])[-law.size :]
        v = rng.uniform(-1, 1, law.size) * np.array([1e-2, 0.1, 0.1, 1.0, 0.1, 0.1, 0.1])[-law.size :]
        out, step = law.evaluate(q, v), 1e-9
        ahead, behind = (law.evaluate(q + way * step * v, v) for way in (1, -1))
        at = law.size + ELASTIC_ENERGY
        stored = (ahead[at] - behind[at]) / (2 * step)
        power = out[law.size + DAMPING_POWER]
        assert -out[: law.size] @ v == pytest.approx(stored + power, rel=1e-3, abs=1e-4)
        assert power >= 0
        lost.append(power)
    assert max(lost) > 0.01


def test_tangent_with_damping_is_that_of_differences() -> None:
    balance = gear_forces(GEAR.replace(DAMPED), FLANK).statics
    q, v = np.zeros(8), np.zeros(8)
    q[2], q[7], v[0], v[1], v[2], v[7] = -2e-5, 6e-5, -1.5, 8e-3, 0.05, 0.08
    q[2] += 8e-5
    lengths = np.outer(balance.lengths, balance.lengths)
    for factors in ((1.0, 0.0), (0.0, 1.0)):
        ours = balance.tangent(q, v, *factors) / lengths
        theirs = difference_tangent(balance, q, v, *factors) / lengths
        assert np.abs(ours - theirs).max() < 0.01 * np.abs(theirs).max()


def test_friction_in_the_bore_is_a_preload_more_or_less() -> None:
    """A runout lifts the plunger against P + F and lets it down against P - F: the torque of such preloads,
    of a spring whose rate counts too."""
    runout = {"pinion.runout": "20 um", "test.turns": 1.0, "yoke.spring_rate": 0.0} | SHARP
    fidelity = QUASI_STATIC.replace({"step_angle": "1 deg"})
    rubbed, *limits = (
        rps.run("free-pinion-torque", GEAR.replace(runout | changes), fidelity=fidelity)
        for changes in ({"yoke.bore_friction": 30.0}, {"yoke.preload": 330.0}, {"yoke.preload": 270.0})
    )
    plunger = rubbed.signals["plunger_displacement"]
    rate = np.gradient(plunger, rubbed.signals["time"])
    for direction, limit in zip((1, -1), limits, strict=True):
        moving = direction * rate > 0.7 * rate.max()
        ours, theirs = (each.signals["pinion_torque"][moving].mean() for each in (rubbed, limit))
        assert ours == pytest.approx(theirs, rel=0.01)
    assert abs(rubbed.signals["bore_force"]).max() == pytest.approx(30.0, rel=1e-6)
    lost = rubbed.signals["work_bore_friction"][-1]
    turning = 4e-6  # over which the element's force turns about
    assert lost == pytest.approx(30 * 2 * (np.ptp(plunger) - turning), rel=0.05)
    assert seat_wedge_factor(GEAR.yoke.seat_angle) > 1  # all of it presses the seat


@pytest.mark.parametrize(
    "changes",
    [
        {"yoke.nut_damping": "20 us", "yoke.bore_friction": "30 N"},
        {"yoke.seat_damping": "5 us", "yoke.bore_damping": "50 N*s/m"},
    ],
)
def test_an_impact_loses_work_there(changes: dict[str, object]) -> None:
    """Each of two parts loses some, and the work balances."""
    result = rps.run("yoke-impact", GEAR.replace(changes), fidelity=FLANK.replace({"rack": "free"}))
    works = {"nut_damping": "work_yokenut_damping", "seat_damping": "work_seat_damping"}
    for path in changes:
        name = works.get(path.removeprefix("yoke."), "work_bore")
        lost = sum(values[-1] for signal, values in result.signals.items() if signal.startswith(name))
        assert lost > 1e-4, path
    assert abs(result.summary["energy_residual"]) < 2e-3


def test_without_them_no_result_has_their_signals() -> None:
    damped = {"yoke.bore_friction": "30 N", "yoke.seat_damping": "5 us"}
    for changes in ({}, damped):
        gear = GEAR.replace({**changes, "test.turns": 0.02})
        result = rps.run("free-pinion-torque", gear, fidelity=FLANK.replace({"rack": "free"}))
        found = {"work_seat_damping", "work_bore_friction", "bore_force"} & set(result.signals)
        assert len(found) == (3 if changes else 0)
        assert "work_yokenut_damping" not in result.signals


def sums_of(time: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Root mean square [N] and impulse [N s] of a force."""
    whole = time[-1] - time[0]
    return np.array([np.sqrt(np.trapezoid(force**2, time) / whole), np.trapezoid(force, time)])


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_impact_with_an_o_ring_is_that_of_a_plane_model(law: str) -> None:
    """RMS and impulse of the yokenut's force, and the impulse until the first hit has ended, within 10 %: the
    plane model has beam, teeth in one point, yoke and bush, and leaves roll and motion along Z out."""
    gear = GEAR.replace({"yoke.bore_friction": 30.0, "mesh.law": law})
    result = rps.run("yoke-impact", gear)
    test = gear.test
    end = RackBar.of(gear).x_min
    pulse = Pulse((0.0, test.pulse_force, 0.0), end, test.pulse_duration, test.pulse_period, 1)
    theirs = shaken(gear, pulse.force, 2 * test.pulse_period)
    ours = result.signals["time"], result.signals["yokenut_force"]
    assert sums_of(*ours) == pytest.approx(sums_of(*theirs), rel=0.1)
    early = [sums_of(*(each[time <= 7.5e-3] for each in (time, force))) for time, force in (ours, theirs)]
    assert early[0][1] == pytest.approx(early[1][1], rel=0.1)


def test_rattle_with_an_o_ring_is_that_of_a_plane_model() -> None:
    """RMS and impulse of the yokenut's force within 10 %; what the O-ring takes of both, within 4 %."""
    found = []
    for friction in (0.0, 30.0):
        gear = GEAR.replace({"yoke.bore_friction": friction, "test.road_cycles": 1, "test.road_phases": 1})
        test = gear.test
        peak = test.road_force * np.array([np.cos(test.road_angle), np.sin(test.road_angle), 0.0])
        road = RoadForce(tuple(peak.tolist()), RackBar.of(gear).x_min, test.road_frequency, 0.0, False)
        period = 1 / test.road_frequency
        time, force = shaken(gear, road.force, 2 * period)
        second = time >= period - 1e-9
        summary = rps.run("rattle", gear).summary
        ours = summary["rattle_force_rms"], summary["rattle_impulse_per_cycle"]
        found.append((np.array(ours), sums_of(time[second], force[second])))
    for ours, theirs in found:
        assert ours == pytest.approx(theirs, rel=0.1)
    without, rubbed = found
    assert rubbed[0] / without[0] == pytest.approx(rubbed[1] / without[1], abs=0.04)
    assert max(rubbed[0] / without[0]) < 0.9
