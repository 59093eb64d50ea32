"""Friction that remembers against closed forms: a mass on a belt, loops before sliding, rest, reversals."""

from functools import cache

import numpy as np
import pytest
from numba import njit

import rps_exudyn as rps
from rps_exudyn.analysis.friction_oscillator import Oscillator, Rubbing
from rps_exudyn.base.compiled import record
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.friction import ACROSS, ALONG, KINDS, LAW, LOAD, bristle, clear, stored
from rps_exudyn.forces.memory import MEMORY_SIZE, PATCHES, PLACES, TIME, Patches
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.drive import Steady
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from verification.stick_slip import event_based

PARTS = ("mesh", "yoke", "bush", "bearing")
GEAR = SteeringGear()


def with_law(gear: SteeringGear = GEAR, **law: object) -> SteeringGear:
    """The gear with a law on all its parts."""
    return gear.replace({f"{part}.{name}": value for part in PARTS for name, value in law.items()})


@njit(error_model="numpy")  # type: ignore[untyped-decorator]
def press(loads, slips, friction, laws, rows, out):  # type: ignore[no-untyped-def]
    """Press points with loads (n,) and slips (n, 2) on a patch; fill the friction and power of the last
    one, and the energy stored."""
    law = laws[0]
    clear(law.place, rows)
    for i in range(loads.size):
        out[0], out[1], out[2] = bristle(loads[i], slips[i, 0], slips[i, 1], law.place, friction, law, rows)
    out[3] = stored(law.place, friction, law, rows)


class Patch:
    """One patch of bristles moved step by step."""

    def __init__(
        self, presliding: float, ratio: float = 1.0, speed: float = 1.0, damping: float = 0.0
    ) -> None:
        self.place, self.rows = Patches().taken(3), np.zeros((2, MEMORY_SIZE))
        law = record(
            LAW,
            kind=KINDS["bristle"],
            has_state=1,
            surplus=ratio - 1,
            speed=speed,
            exponent=2.0,
            load_exponent=1.0,
            usual_load=1.0,
            presliding=presliding,
            damping=damping,
            place=self.place,
        )
        self.laws = np.array([law], dtype=LAW)

    def slide(
        self, friction: float, *slips: tuple[float, float], step: float, loads: tuple[float, ...] = (1.0,)
    ) -> np.ndarray:
        """Friction against the slip of the last point, its power lost, and the energy stored."""
        self.rows[0] = self.rows[1]
        self.rows[1, TIME] += step
        out = np.empty(4)
        press(np.array(loads), np.array(slips), friction, self.laws, self.rows, out)
        return out


# --- one patch ---------------------------------------------------------------------------------------
def test_a_mass_on_a_belt_sticks_and_slips() -> None:
    """Period parts and amplitude of Coulomb's jump from 0.4 to 0.3, to 1 %: bristles of 0.1 um, damped, whose
    Stribeck speed is a five-hundredth of the belt's are that jump."""
    mass, stiffness, belt, load, step = 1.0, 100.0, 0.1, 9.81, 2e-5
    patch = Patch(presliding=1e-7, ratio=4 / 3, speed=2e-4, damping=1e-4)
    place, speed, states = 0.0, belt, np.empty((80000, 2))
    for i in range(len(states)):
        pull = -load * patch.slide(0.3, (speed - belt, 0.0), step=step)[0]
        speed += step / mass * (pull - stiffness * place)
        place += step * speed
        states[i] = place, speed
    stuck = np.abs(states[:, 1] - belt) < 0.01 * belt
    ends = np.flatnonzero(np.diff(stuck.astype(int)))  # begins stuck: released, held, released, held
    slip, stick, again = step * np.diff(ends)[:3]
    assert np.ptp(states[ends[1] : ends[3], 0]) / 2 == pytest.approx(14.008e-3, rel=0.01)
    assert stick == pytest.approx(0.1962, rel=0.01)
    assert (slip, again) == pytest.approx((0.47316, 0.47316), rel=0.01)


def test_event_based_reference_knows_the_belt() -> None:
    """Stick 2 D / (k v), slip (2 / w)(pi - atan(D w / (k v))), amplitude sqrt((D / k)^2 + (v / w)^2) with D
    the jump of the friction, to 1e-3."""
    found = event_based(Oscillator(1.0, 100.0, 0.0, (Rubbing(0.3 * 9.81, 4 / 3, 1e-6),)), 0.1)
    assert found is not None
    times = found.stick, found.slip
    assert times == pytest.approx((0.1962, 0.47316), rel=1e-3)
    assert found.amplitude == pytest.approx(14.008e-3, rel=1e-3)


@pytest.mark.parametrize("reach", [0.1, 1.0, 4.0])
@pytest.mark.parametrize("steps", [8, 64])
def test_loops_before_sliding(reach: float, steps: int) -> None:
    """A loop of slip +-a ends at z = tanh(a / delta) and loses 4 mu N (a - delta tanh(a / delta)), whatever
    the steps, for within a step the solution is exact; the loss as far as the trapezoidal rule is, 2 %."""
    delta, friction = 5e-6, 0.2
    patch, a = Patch(delta), reach * 5e-6
    forces, slips = [], []
    for cycle in range(40):
        for way in (1.0, -1.0):
            for _ in range(steps):
                force = patch.slide(friction, (way * 2 * a / steps, 0.0), step=1.0)[0]
                if cycle == 39:
                    forces.append(force)
                    slips.append(way * 2 * a / steps)
    top = friction * np.tanh(reach)
    assert max(forces) == pytest.approx(top, rel=2e-3)
    assert min(forces) == pytest.approx(-top, rel=2e-3)
    before = np.append(forces[-1], forces[:-1])
    lost = float(np.sum((before + np.array(forces)) / 2 * np.array(slips)))
    exact = 4 * friction * (a - delta * np.tanh(reach))
    assert lost == pytest.approx(exact, rel=0.02 if steps > 8 else 0.6)


@pytest.mark.parametrize("damping", [0.0, 1e-4])
def test_bristles_never_gain(damping: float) -> None:
    """Along random slips in two directions the power lost is at least 0, and work is what is stored and lost
    (fine steps of even slip, 2 %)."""
    rng, friction = np.random.default_rng(3), 0.1
    patch, step = Patch(5e-6, ratio=1.3, speed=5e-3, damping=damping), 1e-4
    work = lost = 0.0
    before = np.zeros(4)
    for _ in range(40):
        velocity = rng.normal(size=2) * 10.0 ** rng.uniform(-4, -2)
        for _ in range(50):
            now = patch.slide(friction, (float(velocity[0]), float(velocity[1])), step=step)
            assert now[2] >= 0
            work += float((now[:2] + before[:2]) / 2 @ velocity) * step
            lost += (now[2] + before[2]) / 2 * step
            before = now
    assert now[3] >= 0
    assert work == pytest.approx(lost + now[3], rel=0.03)


def test_two_points_share_a_patch() -> None:
    """The mean deflection, weighed with the load, is what the next step begins with."""
    patch = Patch(5e-6)
    patch.slide(0.1, (1.0, 0.0), (-1.0, 0.0), step=1.0, loads=(3.0, 1.0))
    assert patch.rows[1, patch.place + np.array([ALONG, ACROSS, LOAD])] == pytest.approx([2.0, 0.0, 4.0])
    assert patch.place >= PATCHES


# --- the gear ----------------------------------------------------------------------------------------
@cache
def reversal(law: str, presliding: str = "10 um", fidelity: str = "quasi-static") -> Result:
    gear = with_law(friction_law=law, bristle_travel=presliding)
    result = rps.run("reversal", gear, fidelity=fidelity)
    assert result.status is Status.OK, result.message
    return result


def test_loop_at_large_amplitude_is_coulombs() -> None:
    """The loop loses 0.5 % of its area at most to the turning about (5 um)."""
    area = reversal("coulomb").summary["hysteresis_area"]
    assert reversal("bristle", "5 um").summary["hysteresis_area"] == pytest.approx(area, rel=5e-3)
    balance = reversal("bristle", "5 um").summary["energy_residual"]
    assert abs(balance) < 1e-3


def test_dynamics_remember_as_equilibria_do() -> None:
    """Angle and area of a reversal, to 1 %: the rack's inertia is what differs."""
    still, moving = (reversal("bristle", "5 um", model).summary for model in ("quasi-static", "flank"))
    for name in ("reversal_angle", "hysteresis_area"):
        assert moving[name] == pytest.approx(still[name], rel=0.01)


# --- parts that remember beside parts that do not, and racks that bend ---------------------------------
@pytest.fixture(scope="module")
def mixed() -> Result:
    """The combination that asked for 99 381 Jacobians while their steps left the friction zone."""
    gear = GEAR.replace({f"{part}.friction_law": "bristle" for part in ("yoke", "bush")})
    return rps.run("reversal", gear, fidelity="flank")


def test_bristles_beside_a_friction_zone_cost_no_more(mixed: Result) -> None:
    """At most twice the Jacobians of friction zones alone; the loop lies between both laws'."""
    coulomb, bristles = reversal("coulomb", fidelity="flank"), reversal("bristle", "5 um", "flank")
    assert mixed.status is Status.OK, mixed.message
    assert mixed.counters["jacobians"] < 2 * coulomb.counters["jacobians"]
    area = mixed.summary["hysteresis_area"]
    assert bristles.summary["hysteresis_area"] < area < coulomb.summary["hysteresis_area"]


@pytest.mark.parametrize("remembering", [("yoke", "bush"), ()])
def test_tangent_within_the_friction_zone(remembering: tuple[str, ...]) -> None:
    """Against central differences in steps of 1 % of the zone, at rates of a third of it and over a step of
    0.1 ms: entries to 2 % of the diagonal's."""
    gear = GEAR.replace({f"{part}.friction_law": "bristle" for part in remembering} | {"test.speed": "1 rpm"})
    forces = gear_forces(gear, Fidelity.preset("flank"))
    balance, h = forces.dynamics, 1e-4
    q = equilibrium_path(
        forces.statics, GearPair.of(gear), Steady("pinion", 0.0, gear.test.speed), np.zeros(1)
    ).coordinates[0]
    v = np.zeros(8)
    v[1] = 0.3 * forces.friction_zone
    if remembering:
        balance.memory[0, PLACES : PLACES + 8] = q - h * v
        balance.memory[:, TIME] = 0.0, h
    found = balance.tangent(q, v, 1.0, 1 / h)
    expected, step = np.empty((8, 8)), 0.01 * forces.friction_zone * np.where(np.arange(8) % 4, 1, 10)
    for j in range(8):
        dv = step * (np.arange(8) == j)
        rise = balance.force(q + h * dv, v + dv) - balance.force(q - h * dv, v - dv)
        expected[:, j] = rise / (2 * h * step[j])
    size = np.sqrt(np.abs(np.diag(expected)))
    assert np.abs((found - expected) / np.outer(size, size)).max() < 0.02


@pytest.fixture(scope="module")
def bending() -> dict[str, Result]:
    """Reversals on bristles of 5 um of a rack with two modes in each plane."""
    gear = with_law(GEAR.replace({"rack.modes": 2}), friction_law="bristle", bristle_travel="5 um")
    models = {name: Fidelity.preset(name).replace({"rack": "flexible"}) for name in ("quasi-static", "flank")}
    return {name: rps.run("reversal", gear, fidelity=model) for name, model in models.items()}


def test_a_bending_rack_remembers_in_dynamics_as_in_equilibria(bending: dict[str, Result]) -> None:
    """Angle and area to 0.5 %; the balance of the work, bristles' energy and all, to 0.2 %."""
    still, moving = (bending[name] for name in ("quasi-static", "flank"))
    for result in (still, moving):
        assert result.status is Status.OK, result.message
        assert abs(result.summary["energy_residual"]) < 2e-3
    for name in ("reversal_angle", "hysteresis_area"):
        assert moving.summary[name] == pytest.approx(still.summary[name], rel=5e-3)


def test_a_bar_that_hardly_bends_is_a_rigid_one() -> None:
    """A thousand times the modulus: a reversal's angle on bristles to 0.1 %, of which bending makes 5 %."""
    gear = with_law(GEAR.replace({"rack.modes": 2}), friction_law="bristle", bristle_travel="5 um")
    stiff = gear.replace({"rack.youngs_modulus": 1e3 * gear.rack.youngs_modulus})
    bent = Fidelity.preset("quasi-static").replace({"rack": "flexible"})
    angle = rps.run("reversal", stiff, fidelity=bent).summary["reversal_angle"]
    assert angle == pytest.approx(reversal("bristle", "5 um").summary["reversal_angle"], rel=1e-3)


@pytest.mark.parametrize("step", ["1 deg", "0.1 deg"])
@pytest.mark.parametrize("fidelity", ["quasi-static", "flank"])
def test_steady_means_are_coulombs(fidelity: str, step: str) -> None:
    """The mean torque, to 0.1 %, in steps over which bristles turn about and in far shorter ones: sliding one
    way all bristles lie as Coulomb's friction does."""
    model = Fidelity.preset(fidelity).replace({"step_angle": step})
    coulomb = rps.run("free-pinion-torque", GEAR, fidelity=model, turns=1 / 6)
    gear = with_law(friction_law="bristle")
    remembered = rps.run("free-pinion-torque", gear, fidelity=model, turns=1 / 6)
    assert remembered.status is Status.OK, remembered.message
    assert remembered.summary["torque_mean"] == pytest.approx(coulomb.summary["torque_mean"], rel=1e-3)


@pytest.mark.parametrize(("law", "holds"), [("bristle", True), ("coulomb", False)])
def test_what_rests_does_not_creep(law: str, holds: bool) -> None:
    """Ten seconds under a load after turning: bristles hold every coordinate to 0.1 um, a wide friction zone
    lets the rack creep."""
    model = Fidelity.preset("quasi-static").replace({"zone_ratio": 0.1})
    forces = gear_forces(with_law(friction_law=law), model, 98.0)
    moved, speed = 0.1, GEAR.test.speed
    drive = TurnAndHold("pinion", 0.0, speed, moved / speed)
    time = np.concatenate([np.linspace(0, moved / speed, 40), moved / speed + np.linspace(0.1, 10.1, 30)])
    path = equilibrium_path(forces.statics, GearPair.of(GEAR), drive, time)
    assert path.converged
    held = path.coordinates[40:] * CHARACTERISTIC_LENGTHS
    drift = float(np.abs(held[-1] - held[0]).max())
    assert (drift < 1e-7) is holds


class TurnAndHold(Steady):
    """A motion at constant speed that ends at `STOP`, and rest."""

    def __init__(self, body: str, start: float, speed: float, stop: float) -> None:
        super().__init__(body, start, speed)  # type: ignore[arg-type]
        object.__setattr__(self, "stop", stop)

    def place(self, time: np.ndarray | float) -> np.ndarray:
        return super().place(np.minimum(time, self.stop))  # type: ignore[attr-defined]

    def rate(self, time: np.ndarray | float) -> np.ndarray:
        return np.where(np.asarray(time) <= self.stop, self.speed, 0.0)  # type: ignore[attr-defined]


def test_stribecks_law_at_three_speeds() -> None:
    """All parts 1.2 times as large at rest, 5 mm/s: the torque is 1.2 times Coulomb's at 0.5 rpm, and
    Coulomb's at 60 rpm, each to 0.5 %."""
    gear = with_law(friction_law="stribeck", static_ratio=1.2)
    usual = rps.run("free-pinion-torque", GEAR, fidelity="quasi-static", turns=1 / 6).summary["torque_mean"]
    for speed, factor in (("0.5 rpm", 1.2), ("60 rpm", 1.0)):
        found = rps.run("free-pinion-torque", gear, fidelity="quasi-static", turns=1 / 6, speed=speed)
        assert found.summary["torque_mean"] == pytest.approx(factor * usual, rel=5e-3)


def test_coulombs_law_knows_one_coefficient() -> None:
    """What belongs to other laws changes nothing, whatever the speed."""
    gear = with_law(static_ratio=1.5, stribeck_speed="50 mm/s")
    torques = [
        rps.run("free-pinion-torque", each, fidelity="quasi-static", turns=1 / 6, speed="0.5 rpm").summary
        for each in (GEAR, gear)
    ]
    assert torques[0]["torque_mean"] == torques[1]["torque_mean"]


def test_friction_of_less_than_proportional_load() -> None:
    """Under a load that presses the coast flanks less and the drive flanks more, an exponent below 1 lowers
    the friction where the load is above the preload's."""
    gear = GEAR.replace({"mesh.friction_law": "stribeck", "test.load_mass": "40 kg"})
    less = gear.replace({"mesh.load_exponent": 0.8})
    torques = [
        rps.run("load-test", each, fidelity="quasi-static", turns=1 / 6).summary["torque_forward"]
        for each in (gear, less)
    ]
    assert torques[1] < 0.995 * torques[0]


def test_laws_that_a_model_does_not_know() -> None:
    with pytest.raises(InputError, match="friction_law is bristle"):
        rps.run("free-pinion-torque", with_law(friction_law="bristle"), fidelity="full", turns=0.01)
    with pytest.raises(InputError, match="has only coulomb"):
        rps.run("free-pinion-torque", GEAR.replace({"mesh.friction_law": "stribeck"}), fidelity="full")
