"""Friction that remembers against closed forms: a mass on a belt, loops before sliding, rest, reversals."""

from functools import cache
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.analysis.friction_oscillator import Oscillator, Rubbing
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.kernel_compiler import from_python
from rps_exudyn.forces.friction import (
    ELEMENT_SHARES,
    ELEMENT_TRAVELS,
    LAW,
    LOST,
    PATCH_SUMS,
    PATCHES,
    PLACES,
    STATE_SIZE,
    TIME,
    Patches,
    add_point,
    clear_patch,
    law_of,
    slide,
    slide_patch,
    slide_slopes,
)
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.prescribed_motion import Steady
from verification.stick_slip import event_based

PARTS = ("mesh", "yoke", "bush", "bearing")
GEAR = SteeringGear()


def with_law(gear: SteeringGear = GEAR, **law: object) -> SteeringGear:
    """The gear with a law on all its parts."""
    return gear.replace({f"{part}.{name}": value for part in PARTS for name, value in law.items()})


@from_python
def press(loads, slips, friction, laws, rows, out):  # type: ignore[no-untyped-def]
    """Press points with loads (n,) and slips (n, 2) on a patch; fill its friction, the energy stored, the
    work lost so far and the slip that it has as a whole."""
    law, sums = laws[0], np.empty(PATCH_SUMS)
    clear_patch(sums)
    for i in range(loads.size):
        add_point(loads[i], slips[i, 0], slips[i, 1], law, sums)
    _, out[2], out[3] = slide_patch(friction, law.place, law, rows, sums)
    out[0], out[1], out[4], out[5] = sums[17], sums[18], sums[12], sums[13]


@from_python
def follow_histories(limits, slips, laws, rows, found):  # type: ignore[no-untyped-def]
    """Slide along histories of limits (t,) and slips (t, 2) in steps of 1 s; fill rows (t, 4) of friction,
    energy and work lost."""
    law = laws[0]
    for k in range(limits.size):
        rows[0] = rows[1]
        rows[1, TIME] += 1.0
        f_a, f_b, stored, lost = slide(limits[k], slips[k, 0], slips[k, 1], law.place, law, rows)
        found[k, 0], found[k, 1], found[k, 2], found[k, 3] = f_a, f_b, stored, lost


@from_python
def slopes_at(limit, slip, laws, rows):  # type: ignore[no-untyped-def]
    """Derivatives of the friction as `slide_slopes` returns them."""
    law = laws[0]
    return slide_slopes(limit, slip[0], slip[1], 0.0, law.place, law, rows)


class Patch:
    """One patch of bristles moved step by step: by default 30 N over 5 um on four elements."""

    def __init__(
        self,
        travel: float = 5e-6,
        usual: float = 30.0,
        elements: int = 4,
        ratio: float = 1.0,
        speed: float = 5e-3,
        damping: float = 0.0,
    ) -> None:
        patches, self.rows = Patches(elements), np.zeros((2, STATE_SIZE))
        part = GEAR.mesh.model_copy(
            update={
                "friction_law": "bristle",
                "bristle_travel": travel,
                "static_ratio": ratio,
                "stribeck_speed": speed,
                "bristle_damping": damping,
            }
        )
        self.laws = np.array([law_of(part, patches, 1.0, usual)], dtype=LAW)
        self.place, self.usual = int(self.laws["place"][0]), usual

    def slide(
        self, friction: float, *slips: tuple[float, float], step: float, loads: tuple[float, ...]
    ) -> Any:
        """Friction against the slip velocities of points over a step, energy stored, work lost, mean slip."""
        self.rows[0] = self.rows[1]
        self.rows[1, TIME] += step
        out = np.empty(6)
        press(np.array(loads), np.array(slips), friction, self.laws, self.rows, out)
        return out

    def along(self, slips: Any, limits: Any = None) -> np.ndarray:
        """Rows (t, 4) of friction, energy and work lost along slips (t,) or (t, 2) [m]."""
        slips = np.asarray(slips, dtype=float)
        slips = slips if slips.ndim == 2 else np.column_stack([slips, 0 * slips])
        limits = np.broadcast_to(self.usual if limits is None else limits, len(slips))
        found = np.empty((len(slips), 4))
        follow_histories(np.array(limits, dtype=float), slips, self.laws, self.rows, found)
        return found


# --- one patch ---------------------------------------------------------------------------------------
def test_constants_of_the_elements() -> None:
    """Shares sum to one, to 1e-4; the largest error of 1 - exp(-s / delta) is that stated, to 1.5e-3."""
    s = np.linspace(0, 20, 20001)
    for error, travels, shares in zip(
        (0.153, 0.046, 0.023, 0.014), ELEMENT_TRAVELS, ELEMENT_SHARES, strict=True
    ):
        assert sum(shares) == pytest.approx(1, abs=1e-4)
        first = sum(w * np.minimum(s / h, 1) for h, w in zip(travels, shares, strict=True))
        assert float(np.abs(first - (1 - np.exp(-s))).max()) == pytest.approx(error, abs=1.5e-3)


def test_first_loading_and_reversal_in_numbers() -> None:
    """To 4 digits, in one step each: stretches of 30 N over 5 um on four elements."""
    for travel, force in ((1e-6, 5.0395), (5e-6, 18.9256), (10e-6, 26.0453)):
        assert Patch().along([travel])[-1, 0] == pytest.approx(force, abs=6e-5)
    for travel, force in ((5e-6, 6.0619), (10e-6, -7.8513), (20e-6, -22.0906)):
        assert Patch().along([50e-6, -travel])[-1, 0] == pytest.approx(force, abs=2e-4)


@pytest.mark.parametrize("steps", [1, 7, 64])
@pytest.mark.parametrize("elements", [1, 2, 3, 4])
def test_loop_and_masings_rule(elements: int, steps: int) -> None:
    """A loop of +-50 um loses 4 phi (A - h), h the mean of H delta, in any steps, since within one the work
    is exact; a branch after a turn is the first loading at twice the scale, to 1e-12."""
    patch, a = Patch(elements=elements), 50e-6
    first = patch.along(np.full(steps, a / steps))
    back = patch.along(np.full(steps, -2 * a / steps))
    forth = patch.along(np.full(steps, 2 * a / steps))
    assert first[-1, 0] - back[:, 0] == pytest.approx(2 * first[:, 0], rel=1e-12)
    held = 5e-6 * float(np.dot(ELEMENT_SHARES[elements - 1], ELEMENT_TRAVELS[elements - 1]))
    share = sum(ELEMENT_SHARES[elements - 1])
    lost = forth[-1, 3] - first[-1, 3]
    assert lost == pytest.approx(4 * 30 * (a * share - held), rel=1e-9)
    if elements == 4:
        assert lost == pytest.approx(4.8e-3, abs=6e-7)


def test_circular_slip() -> None:
    """On a circle of radius R one element loses phi sqrt(1 - (h / R)^2) per length, to 0.1 %: radial return
    is of first order in the step."""
    patch, radius, n = Patch(elements=1), 40e-6, 4000
    angle = np.linspace(0, 6 * np.pi, 3 * n + 1)
    slips = radius * np.diff(np.column_stack([np.cos(angle), np.sin(angle)]), axis=0)
    lost = patch.along(slips)[:, 3]
    per_length = (lost[-1] - lost[-n - 1]) / (2 * np.pi * radius)
    assert per_length == pytest.approx(30 * np.sqrt(1 - (10e-6 / radius) ** 2), rel=1e-3)


def test_peaks_of_a_static_ratio() -> None:
    """Ratio 1.5, 5 mm/s: the largest friction over the kinetic one when a load is pushed at 0.01, 1 and
    5 mm/s."""
    for speed, peak in ((1e-5, 1.5), (1e-3, 1.4804), (5e-3, 1.1839)):
        patch = Patch(ratio=1.5)
        forces = [patch.slide(1.0, (speed, 0.0), step=1e-6 / speed, loads=(30.0,))[0] for _ in range(100)]
        assert max(forces) / 30 == pytest.approx(peak, abs=6e-5)


def test_random_histories_make_no_energy() -> None:
    """2000 histories of 50 steps of slip in two directions and load, half of them with no load at times: in
    each step friction at its end times slip less what is stored is at least -1e-9 of the history's work; what
    is booked as lost never falls, and friction never exceeds its limit."""
    rng = np.random.default_rng(11)
    for number in range(2000):
        patch = Patch(elements=1 + number % 4, damping=0.0 if number % 3 else 0.4)
        slips = rng.normal(size=(50, 2)) * 10.0 ** rng.uniform(-7, -4.5, size=(50, 1))
        limits = 30 * rng.uniform(0, 2, size=50) * (rng.uniform(size=50) > 0.2 * (number % 2))
        found = patch.along(slips, limits)
        works = np.einsum("ti,ti->t", found[:, :2], slips)
        kept = np.diff(found[:, 2], prepend=0.0)
        assert (works - kept).min() >= -1e-9 * np.abs(works).sum()
        assert np.diff(found[:, 3], prepend=0.0).min() >= 0
        assert (np.linalg.norm(found[:, :2], axis=1) <= limits * (1 + 1e-4)).all()


def test_held_under_a_rippling_load_does_not_drift() -> None:
    """A pull of 50 +- 20 % of the usual friction, and a limit that ripples by 20 % at another frequency:
    after the first cycles the place moves by less than 0.05 um from cycle to cycle (LuGre: 2.9 um)."""
    for elements in (1, 4):
        patch = Patch(elements=elements)
        place, places = 0.0, []
        for k in range(20 * 60):
            limit = 30 * (1 + 0.2 * np.sin(2 * np.pi * k / 37))
            pull = 30 * (0.5 + 0.2 * np.sin(2 * np.pi * k / 60))
            place += _balanced(patch, pull, limit)
            if k % 60 == 0:
                places.append(place)
        drift = np.diff(places[8:])
        assert np.abs(drift).max() < 5e-8


def _balanced(patch: Patch, pull: float, limit: float) -> float:
    """Move a patch until its friction is a pull; return by how much."""
    start, low, high = patch.rows[1].copy(), -1e-4, 1e-4
    for _ in range(60):
        middle = (low + high) / 2
        patch.rows[1] = start
        low, high = (middle, high) if patch.along([middle], [limit])[-1, 0] < pull else (low, middle)
    return middle


def test_derivatives_against_differences() -> None:
    """By slip and limit, to 1e-6 of the stiffness, over random steps of one to four elements with damping."""
    rng = np.random.default_rng(2)
    for number in range(100):
        patch = Patch(elements=1 + number % 4, damping=0.3 if number % 2 else 0.0)
        patch.along(rng.normal(size=(5, 2)) * 5e-6)
        rows, slip, limit = patch.rows, rng.normal(size=2) * 1e-5, 30 * rng.uniform(0.5, 1.5)
        rows[0] = rows[1]
        rows[1, TIME] += 1.0
        slopes = slopes_at(limit, slip, patch.laws, rows)

        h = 1e-11
        by_slip = [
            (_next(patch, slip + h * e, limit) - _next(patch, slip - h * e, limit)) / (2 * h)
            for e in np.eye(2)
        ]
        by_limit = (_next(patch, slip, limit + 1e-4) - _next(patch, slip, limit - 1e-4)) / 2e-4
        stiffness = float(patch.laws["stiffness"].sum())
        assert np.column_stack(by_slip).ravel() == pytest.approx(slopes[:4], abs=2e-5 * stiffness)
        assert by_limit == pytest.approx(slopes[6:], abs=1e-6)


def _next(patch: Patch, slip: np.ndarray, limit: float) -> np.ndarray:
    """Friction (2,) after a step from where the patch's step begins."""
    state, found = np.stack([patch.rows[0], patch.rows[0]]), np.empty((1, 4))
    follow_histories(np.array([limit]), slip[None], patch.laws, state, found)
    return found[0, :2]


def test_lifted_off_and_back() -> None:
    """Without load no force and no energy; what was stored is lost."""
    patch = Patch()
    stored = patch.along([3e-6])[-1, 2]
    force, _, energy, lost = patch.along([1e-6], [0.0])[-1]
    assert force == energy == 0
    assert lost > 0.5 * stored
    assert patch.along([1e-6])[-1, 0] == pytest.approx(5.0395, abs=6e-5)


def test_a_mass_on_a_belt_sticks_and_slips() -> None:
    """Period parts and amplitude of Coulomb's jump from 0.4 to 0.3, to 1 %: bristles of 0.1 um, damped, whose
    Stribeck speed is a ten-thousandth of the belt's are that jump."""
    mass, stiffness, belt, load, step = 1.0, 100.0, 0.1, 9.81, 2e-5
    patch = Patch(travel=1e-7, usual=0.3 * load, elements=1, ratio=4 / 3, speed=1e-5, damping=1e-4)
    place, speed, states = 0.0, belt, np.empty((80000, 2))
    for i in range(len(states)):
        pull = -patch.slide(0.3, (speed - belt, 0.0), step=step, loads=(load,))[0]
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


def test_points_share_a_patch() -> None:
    """The slip is the mean weighted with the load, the limit is that of all."""
    patch = Patch()
    found = patch.slide(1.0, (1e-6, 0.0), (-1e-6, 0.0), step=1.0, loads=(22.5, 7.5))
    assert found[4:] == pytest.approx([5e-7, 0.0])
    assert found[0] == pytest.approx(Patch().along([5e-7])[-1, 0])
    assert patch.place >= PATCHES
    assert patch.rows[1, patch.place + LOST] == 0


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


@pytest.mark.parametrize("fidelity", ["quasi-static", "flank"])
@pytest.mark.parametrize("travel", ["5 um", "50 um"])
@pytest.mark.parametrize("elements", [1, 4])
def test_work_of_reversals_balances_at_the_default_step(travel: str, elements: int, fidelity: str) -> None:
    """To 1e-4, over 30 deg and over 5 deg, where long bristles turn about over half the way."""
    model = Fidelity.preset(fidelity).replace({"friction_elements": elements})
    gear = with_law(friction_law="bristle", bristle_travel=travel)
    for amplitude in ("30 deg", "5 deg"):
        result = rps.run("reversal", gear.replace({"test.amplitude": amplitude}), fidelity=model)
        assert result.status is Status.OK, result.message
        assert abs(result.summary["energy_residual"]) < 1e-4


@pytest.mark.parametrize("travel", ["2 um", "5 um", "10 um", "50 um"])
def test_reversal_angle_at_the_default_step(travel: str) -> None:
    """Within 1 % of that in steps of 0.02 deg."""
    fine = Fidelity.preset("quasi-static").replace({"step_angle": "0.02 deg"})
    gear = with_law(friction_law="bristle", bristle_travel=travel)
    limit = rps.run("reversal", gear, fidelity=fine).summary["reversal_angle"]
    assert reversal("bristle", travel).summary["reversal_angle"] == pytest.approx(limit, rel=0.01)


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


def test_bristles_beside_a_friction_zone_cost_little_more(mixed: Result) -> None:
    """At most three times the Jacobians of friction zones alone (2.7; 14 where zones took the mean rates of
    a step, too), and as many steps to a tenth; the loop lies between both laws'."""
    coulomb, bristles = reversal("coulomb", fidelity="flank"), reversal("bristle", "5 um", "flank")
    assert mixed.status is Status.OK, mixed.message
    assert mixed.counters["jacobians"] < 3 * coulomb.counters["jacobians"]
    assert mixed.counters["steps"] == pytest.approx(coulomb.counters["steps"], rel=0.1)
    area = mixed.summary["hysteresis_area"]
    assert bristles.summary["hysteresis_area"] < area < coulomb.summary["hysteresis_area"]


@pytest.mark.parametrize("remembering", [("yoke", "bush"), ()])
def test_tangent_within_the_friction_zone(remembering: tuple[str, ...]) -> None:
    """Against central differences in steps of 1 % of the zone, at rates of a third of it and over a step of
    0.1 ms: entries to 2 % of the diagonal's."""
    gear = GEAR.replace({f"{part}.friction_law": "bristle" for part in remembering} | {"test.speed": "1 rpm"})
    forces = gear_forces(gear, Fidelity.preset("flank"))
    balance, h = forces, 1e-4
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
