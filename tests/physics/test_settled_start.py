"""The start of a steady motion forgets how the gear came there, or the run says that it does not."""

from dataclasses import replace

import numpy as np
import pytest

import rps_exudyn as rps
from bad_cases import bad_cases
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.scenes.checks.after_run import unsettled_share
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.scenes.maneuver import maneuvers_of_test, steady_maneuver, swing_maneuver
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.equilibrium import SETTLED, Start, equilibrium_path, starting_guess, steady_rates
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.prescribed_motion import Swing
from rps_exudyn.solvers.rescue import Settling
from rps_exudyn.solvers.settled_start import ALIKE, settled_path, settled_start, start_of_motion
from rps_exudyn.solvers.settling import TOLERANCE, differences
from verification.law_area import by_law
from verification.stability import ScenePlan, unchecked

CASES = bad_cases()
CREEPS_LONG, CREEPS = (CASES[f"a soft seat, {found}"].plan.gear for found in ("creeps long", "creeps"))
FIDELITY = Fidelity.preset("quasi-static")


def far_back(gear: SteeringGear, pitches: float) -> float:
    """Mean torque over the test, of equilibria that begin so many pitches before it in 24 steps each."""
    maneuver = maneuvers_of_test(gear, "pinion", FIDELITY.step_angle)[0]
    back = pitches * 2 * np.pi / gear.pinion.teeth / gear.test.speed
    before = np.linspace(-back, 0.0, int(24 * pitches), endpoint=False)
    time = np.concatenate([before, maneuver.time])
    path = equilibrium_path(gear_forces(gear, FIDELITY).statics, GearPair.of(gear), maneuver.drive, time)
    return float(-maneuver.drive.sign * path.forces[before.size + maneuver.lead :, 0].mean())


@pytest.mark.parametrize(
    "gear",
    [
        pytest.param(CREEPS_LONG, marks=pytest.mark.long, id="long"),
        pytest.param(CREEPS, marks=pytest.mark.long, id="short"),
        pytest.param(by_law(CREEPS, "line"), id="line"),
    ],
)
@pytest.mark.parametrize("model", ["quasi-static", "flank"])
def test_a_short_record_is_that_of_a_motion_that_began_far_back(gear: SteeringGear, model: str) -> None:
    """20 tooth pitches and an odd part, in steps of its own. 0.5 %: such steps are right to 0.2 %, and what
    is left of the start is 0.2 %; one and three pitches miss 27 and 14 % of one gear, 7 and 1.3 % of the
    other."""
    run = rps.run("free-pinion-torque", gear, fidelity=model)
    assert run.status is Status.OK, run.message
    assert run.summary["torque_mean"] == pytest.approx(far_back(gear, 20.4), rel=5e-3)


@pytest.mark.parametrize(("first", "last"), [(0.3, 1.0), (1.0, 0.3), (-1.0, -0.3)])
def test_a_beginning_may_go_back_as_far_as_there_are_teeth(first: float, last: float) -> None:
    gear = SteeringGear()
    maneuver = steady_maneuver(gear, "pinion", first, last, FIDELITY.step_angle)
    earliest = maneuver.drive.place(-maneuver.approach.toothed)  # type: ignore[union-attr]
    assert earliest * np.sign(last - first) == pytest.approx(-largest_angle(gear))


@pytest.mark.parametrize("angle", [0.4, 0.48, 0.8])
def test_motion_with_inertia_begins_with_the_rates_of_its_start(angle: float) -> None:
    """Central differences of equilibria a hundredth of a pitch apart, over the rack's speed: 8e-4 in every
    coordinate, and 4e-4 to 5e-4 here. Backward differences over the last step of the way to the start, a
    48th of a pitch, are half of it late: 1.6e-3 to 1.8e-3. A random gear vibrated with such a difference by
    6 % of its torque."""
    gear = SteeringGear().replace({"mesh.law": "line", "pinion.runout": 30e-6, "test.start_angle": angle})
    maneuver = maneuvers_of_test(gear, "pinion", FIDELITY.step_angle)[0]
    course = gear_forces(gear, FIDELITY).statics, GearPair.of(gear), maneuver.drive, maneuver.approach
    begun = start_of_motion(*course, step=np.deg2rad(1))
    h = 0.01 * 2 * np.pi / gear.pinion.teeth / gear.test.speed
    near = settled_path(*course, h * np.array([-1.0, 0.0, 1.0]))
    right = (near.coordinates[-1] - near.coordinates[-3]) / (2 * h)
    apart = np.abs(begun.rates[-1] - right) * course[0].lengths / abs(right[1])
    assert apart.max() < 8e-4


def test_steps_that_lead_to_the_start_are_not_followed_twice() -> None:
    """A path that goes on from one that leads to it is the same, to the tolerance of equilibria (1e-5)."""
    gear = SteeringGear()
    maneuver = maneuvers_of_test(gear, "pinion", FIDELITY.step_angle)[0].one_period()
    course = gear_forces(gear, FIDELITY).statics, GearPair.of(gear), maneuver.drive
    whole = equilibrium_path(*course, maneuver.time)
    parts = equilibrium_path(*course, maneuver.time, equilibrium_path(*course, maneuver.time[:20]))
    assert parts.coordinates == pytest.approx(whole.coordinates, abs=1e-7)
    assert parts.forces[:, 0] == pytest.approx(whole.forces[:, 0], rel=1e-4)
    assert parts.evaluations < 1.1 * whole.evaluations


@pytest.mark.parametrize("per_time", [0.0, 5.0])
def test_the_tangent_of_a_beginning_is_that_of_its_forces(per_time: float) -> None:
    """That of the laws beside differences of 1 nm, along which rates follow places: 1 % of the largest entry,
    as Newton's method needs."""
    balance, pair = gear_forces(SteeringGear(), FIDELITY).statics, GearPair.of(SteeringGear())
    free, guess, steady = balance.free(0), starting_guess(pair, 0.2), steady_rates(pair, 1.0)
    start, levers = guess[free], balance.lengths[free]
    base = start - steady[free] / per_time if per_time else start

    def evaluate(q: np.ndarray, v: np.ndarray, factor_v: float) -> tuple[np.ndarray, np.ndarray]:
        return balance.force_and_tangent(q, v, 1.0, factor_v)

    begin = Settling(evaluate, free, balance.lengths, guess, steady, base, per_time)
    found = begin.tangent(start)
    true = differences(begin.unbalanced, levers)(start)
    scale = np.outer(levers, levers)
    assert found / scale == pytest.approx(true / scale, abs=1e-2 * np.abs(true / scale).max())


def test_instants_of_a_beginning_rise() -> None:
    """Also before a start to which steps as long as those of the way there lead, for 20 degrees and more."""
    gear = SteeringGear().replace({"test.turns": 1.0})
    maneuver = maneuvers_of_test(gear, "pinion", np.deg2rad(30))[0]
    course = gear_forces(gear, FIDELITY).statics, GearPair.of(gear), maneuver.drive, maneuver.approach
    for step in (20.0, 30.0):
        assert start_of_motion(*course, step=np.deg2rad(step)).converged
        assert maneuver.approach is not None
        start = -4 * np.deg2rad(step) * gear.pinion.teeth / (2 * np.pi) / 16 * maneuver.approach.unit
        led = settled_start(*course, np.array([start]))
        assert led is not None
        assert (np.diff(led.time) > 0).all()
        assert led.time[-1] == start


def test_an_ordinary_gear_settles_at_once() -> None:
    """Over one tooth pitch, which costs a dozen equilibria. Two beginnings that agree bound what is left:
    1e-4 of the force, against a ripple of some percent."""
    gear = SteeringGear()
    maneuver = maneuvers_of_test(gear, "pinion", FIDELITY.step_angle)[0]
    course = gear_forces(gear, FIDELITY).statics, GearPair.of(gear), maneuver.drive
    path = settled_path(*course, maneuver.approach, np.zeros(1))
    assert replace(path.start, unsettled_behind=0.0) == SETTLED
    assert path.start.unsettled_behind < ALIKE
    assert path.begun == pytest.approx(-2 * np.pi / gear.pinion.teeth / gear.test.speed)


@pytest.mark.parametrize("model", ["quasi-static", "flank"])
def test_one_cycle_of_a_swing_is_as_any_other(model: str) -> None:
    """A rack that is steered by 3 degrees rolls to and fro, and first had to come there: the first cycle's
    hysteresis was 1.4 % less than the second's. 0.1 %: what a beginning may leave, over twice."""
    small = SteeringGear().replace({"test.amplitude": "3 deg", "mesh.friction": 0.25, "test.speed": "1 rpm"})
    first, second = (
        rps.run("reversal", small, fidelity=model, cycles=cycles).summary["hysteresis_area"]
        for cycles in (1, 2)
    )
    assert first == pytest.approx(second, rel=1e-3)


def test_a_gear_that_rests_nowhere_begins_creeping() -> None:
    """Seat of 25 degrees, soft, the yoke at its nut, much friction: no place of rest exists at the start, as
    the rack rolls away from any; there is an equilibrium at every instant all the same, each to 1e-3 N."""
    gear = SteeringGear().replace(
        {
            "yoke.seat_angle": "25 deg",
            "yoke.seat_stiffness": 1e7,
            "yoke.clearance": "5 um",
            "mesh.friction": 0.25,
        }
    )
    drive = swing_maneuver(gear, FIDELITY.step_angle).drive
    assert isinstance(drive, Swing)
    time = np.linspace(0, drive.period / 2, 60)
    balance = gear_forces(gear, FIDELITY).statics
    path = equilibrium_path(balance, GearPair.of(gear), drive, time)
    assert path.converged
    free = [i for i in range(8) if i != drive.coordinate]
    for i in range(len(time)):
        unbalanced = balance.force(path.coordinates[i], path.rates[i])[free]
        assert np.abs(unbalanced / CHARACTERISTIC_LENGTHS[free]).max() <= TOLERANCE


@pytest.mark.long
@pytest.mark.parametrize(
    ("stiffness", "zone", "step"),
    [(5e12, 0.001, "12 deg"), (5e12, 0.001, "20 deg"), (1e14, 0.001, "20 deg"), (2e13, 1.0, "8 deg")],
)
def test_long_slow_steps_begin_near_their_equilibria(stiffness: float, zone: float, step: str) -> None:
    """Coulomb's friction knows no speed: the mean at 0.5 rpm in long steps is that in steps of a degree to
    0.5 %. Rates over far shorter steps than these threw the rack out of the contact, and so did the
    accelerations that the equilibrium's tolerance leaves over the mass."""
    settings = {"mesh.stiffness": stiffness, "test.turns": 1.0, "test.speed": "0.5 rpm"}
    gear = by_law(SteeringGear().replace(settings), "area")
    means = []
    for each in (step, "1 deg"):
        model = Fidelity.preset("flank").replace({"step_angle": each, "zone_ratio": zone})
        run = unchecked(ScenePlan("free-pinion-torque", gear, model))
        assert run.status is Status.OK, run.message
        means.append(run.summary["torque_mean"])
    assert means[0] == pytest.approx(means[1], rel=5e-3)


def test_too_few_teeth_before_the_start_widen_the_bar_of_the_peak_to_peak() -> None:
    """From lock to lock the rack has teeth for one pitch before the start. The first pitch of the record owes
    6 % to that: the difference from equilibria that begin where the teeth do. The run looks at 48 places of
    that pitch, between which the largest may be a tenth larger. With parallel axes it is 1e-4."""
    gear = SteeringGear().replace({"installation.angle_error": 0.02, "test.path": "lock-to-lock"})
    run = rps.run("free-pinion-torque", gear, fidelity=FIDELITY)
    maneuver = maneuvers_of_test(gear, "pinion", FIDELITY.step_angle)[0]
    assert maneuver.approach is not None
    time = run["time"][run["time"] < maneuver.approach.unit]
    led = np.linspace(-maneuver.approach.toothed, 0.0, 40, endpoint=False)
    balance, drive = gear_forces(gear, FIDELITY).statics, maneuver.drive
    path = equilibrium_path(
        balance, GearPair.of(gear), drive, np.concatenate([led, time + maneuver.record_start])
    )
    real = -drive.sign * path.forces[led.size :, drive.coordinate]
    apart = np.abs(real - run["pinion_torque"][: time.size]).max() / np.abs(real).max()
    assert apart > 0.05
    assert run.findings["start_unsettled"] == pytest.approx(apart, rel=0.1)
    moved = 0.9 * apart * np.abs(run["pinion_torque"]).mean()
    assert not run.errors["torque_peak_to_peak"] < moved  # nan: no other level ends
    parallel = rps.run(
        "free-pinion-torque", gear.replace({"installation.angle_error": 0.0}), fidelity=FIDELITY
    )
    assert parallel.findings["start_unsettled"] < 3e-4
    assert "torque_peak_to_peak" in parallel.summary


@pytest.mark.quick
@pytest.mark.parametrize(
    ("start", "recorded", "share"),
    [
        (SETTLED, 1.0, 0.0),
        (Start(0.05, 4.0), 1.0, 0.05),
        (Start(0.05, 4.0), 40.0, 0.005),  # settled in a tenth of the record
        (Start(0.05, np.inf), 40.0, 0.05),
    ],
)
def test_what_the_start_remembers_moves_the_mean_while_it_lasts(
    start: Start, recorded: float, share: float
) -> None:
    assert unsettled_share(start, {"time": np.array([0.0, recorded])}) == pytest.approx(share)
