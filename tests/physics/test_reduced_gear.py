"""The reduced gear: its table against equilibria, its laws, its scenes against the dynamics."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.scenes.maneuver import Maneuver, swing_maneuver
from rps_exudyn.scenes.reduced_table import table_of
from rps_exudyn.scenes.run_maneuver import by_equilibrium
from rps_exudyn.scenes.run_reduced import by_reduced
from rps_exudyn.scenes.scene import WITHOUT_BARS, RunOptions
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.closed_form import free_torque, mean_state
from rps_exudyn.solvers.reduced_gear import BeyondTable, ReducedGear, Tables, elements
from rps_exudyn.solvers.reduced_motion import Push, RackEnd, ReducedMotion

MODEL = Fidelity.preset("reduced")
GEAR = resolve_contact_law(SteeringGear(), MODEL, "line")
KEPT = {"stored_energy", "work_gear_friction", "work_column_damping"}
TYRES = {"test.tyre_stiffness": "30 N/mm"}


@pytest.fixture(scope="module")
def table() -> ReducedGear:
    return table_of(by_equilibrium, GEAR, MODEL, 2000.0)


def plain_gear(friction: float = 0.5, loads: int = 3) -> ReducedGear:
    """A gear without ripple, whose friction and compliance no load changes: everything has a closed form."""
    angles, forces = np.linspace(0, 1, 5), np.linspace(-1000, 1000, loads)
    ideal = np.ones((5, 1)) * 5e-3 * forces
    return ReducedGear(
        5e-3, 25e-6, 1e-4, 0.0, angles, True, forces, ideal + friction, ideal - friction, np.zeros((5, 2)),
        np.ones((5, 1)) * -1e-8 * forces, np.ones(1), np.array([1000.0]),
    )  # fmt: skip


def made_up(gear: SteeringGear, model: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Equilibria of a gear with a friction of 0.5 N m, a transmission error of 2 um and 10 N/um."""
    pair, drive = GearPair.of(gear), maneuver.drive
    angle, rate = np.array([[drive.place(t), drive.rate(t)] for t in maneuver.time[maneuver.lead :]]).T
    signals = {
        "pinion_angle": angle,
        "pinion_torque": 0.5 * np.sign(rate) + pair.gain_at(angle) * maneuver.rack_load,
        "rack_displacement": pair.travel_at(angle) + wave(angle) - 1e-7 * maneuver.rack_load,
        "yokenut_force": np.zeros_like(angle),
    }
    return SceneRun(Outcome(Status.OK), signals)


def wave(angle: np.ndarray) -> np.ndarray:
    return 2e-6 * np.cos(GEAR.pinion.teeth * angle + 1)


@pytest.mark.quick
@pytest.mark.parametrize("settings", [{}, {"pinion.runout": "20 um"}, {"rack.bow": "0.1 mm"}])
def test_the_table_holds_its_equilibria(settings: dict[str, object]) -> None:
    """In 48 cells a pitch, over a period of the gear, and over nearly all its travel if it has none."""
    gear = GEAR.replace(settings)
    table, most = table_of(made_up, gear, MODEL, 1000.0), largest_angle(gear)
    ideal = GearPair.of(gear).gain * table.loads
    assert table.error == pytest.approx(wave(table.angles)[:, None] - 1e-7 * table.loads, abs=1e-12)
    for torque, friction in ((table.up, 0.5), (table.down, -0.5)):
        assert torque == pytest.approx(friction + np.tile(ideal, (len(table.angles), 1)))
    first, last = table.angles[[0, -1]]
    spans = {0: 2 * np.pi / 6, 1: 2 * np.pi, 2: 2 * most}
    whole = spans[("pinion.runout" in settings) + 2 * ("rack.bow" in settings)]
    assert 0.95 * whole < last - first <= whole * (1 + 1e-9)
    assert np.diff(table.angles) * 48 * 6 == pytest.approx(2 * np.pi, rel=0.01)
    assert abs(first) <= most


def test_the_table_has_the_mean_torques_of_the_closed_form(table: ReducedGear) -> None:
    """Within what formulas are off by, 2 %, at loads below those at which a flank lifts."""
    for load in (0.0, 500.0):
        column = int(np.argmin(np.abs(table.loads - load)))
        for torque, direction in ((table.up, 1), (table.down, -1)):
            expected = mean_state(GEAR, direction, float(table.loads[column])).torque
            scale = free_torque(GEAR)
            assert abs(torque[:-1, column].mean() - expected) < 0.02 * max(abs(expected), scale)


def test_the_potential_gives_torque_and_travel(table: ReducedGear) -> None:
    """By differences of a few parts of a cell, over which the cubic is exact to their square."""
    tables, rng = Tables(table), np.random.default_rng(1)
    for angle, load in zip(rng.uniform(-3, 3, 50), rng.uniform(-1900, 1900, 50), strict=True):
        _, torque, travel, _ = tables.potential(angle, load)
        by_angle = [tables.potential(angle + side * 1e-6, load)[0] for side in (1, -1)]
        by_load = [tables.potential(angle, load + side * 1e-3)[0] for side in (1, -1)]
        assert (by_angle[0] - by_angle[1]) / 2e-6 == pytest.approx(torque, abs=1e-6)
        assert (by_load[0] - by_load[1]) / 2e-3 == pytest.approx(travel, abs=1e-9)


def test_the_potential_repeats_with_the_tooth(table: ReducedGear) -> None:
    tables, pitch = Tables(table), 2 * np.pi / GEAR.pinion.teeth
    for load in (-700.0, 0.0, 1500.0):
        here, there = tables.potential(0.1, load), tables.potential(0.1 + 5 * pitch, load)
        assert there[0] - here[0] == pytest.approx(5 * pitch * table.gain * load, abs=1e-9)
        assert there[1] == pytest.approx(here[1], abs=1e-9)


def test_the_rack_yields_to_a_load_and_no_friction_drives(table: ReducedGear) -> None:
    assert np.diff(table.error, axis=1).max() < 0
    assert table.friction.min() > 0


def test_ripple_follows_from_the_transmission_error(table: ReducedGear) -> None:
    """Virtual work: the conservative part of the torque's ripple under a load, which the table's torques show
    as the mean of both directions, is the load times the slope of the transmission error. The mean leaves
    what friction differs by between both directions: the ripples differ by less than 40 %."""
    both = (table.up + table.down) / 2
    seen = both[:, -1] - both[:, -1].mean()
    derived = table.loaded[:, -1, 1] + table.free[:, 1]
    assert np.ptp(derived) == pytest.approx(np.ptp(seen), rel=0.4)


def test_elements_turn_about_as_measured() -> None:
    """Two elements of known yield angles are found among the angles that are tried."""
    slip = np.linspace(0, 0.05, 5000)
    yields = np.geomspace(2e-5, 2e-2, 13)[[2, 8]]
    turned = 0.7 * np.minimum(slip / (2 * yields[0]), 1) + 0.3 * np.minimum(slip / (2 * yields[1]), 1)
    shares, stiffness = elements(slip, turned, 0.6)
    assert shares == pytest.approx([0.7, 0.3], abs=0.02)
    assert shares * 0.6 / stiffness == pytest.approx(yields, rel=0.05)


def test_a_slow_pinion_holds_until_friction_is_overcome() -> None:
    """Coulomb's law: at 99 % of the friction it rests where its spring holds it, at 101 % it runs away."""
    for share, moves in ((0.99, False), (1.01, True)):
        motion = ReducedMotion(plain_gear(), RackEnd(), 0.5)
        for k in range(2000):
            motion.push(Push(0.5 * share * min(k / 1000, 1.0)), 1e-3)
        assert (abs(motion.angle - 0.5) > 0.01) == moves
        if not moves:
            assert motion.angle - 0.5 == pytest.approx(0.5 * share / 1000, rel=1e-3)


def test_the_loop_of_a_swing_is_that_of_an_elastoplastic_spring() -> None:
    """Area 4 T (A - T / k) of Coulomb's friction T behind a spring k, over a swing of amplitude A."""
    motion, amplitude = ReducedMotion(plain_gear(), RackEnd(), 0.0), 0.2
    angles = amplitude * np.sin(np.linspace(0, 4 * np.pi, 8001))
    torques = []
    for before, after in itertools.pairwise(angles):
        motion.follow(after - before, 0.0, 1e-3)
        torques.append(motion.torque)
    last = slice(4000, None)
    area = np.trapezoid(np.array(torques)[last], angles[1:][last])
    assert area == pytest.approx(4 * 0.5 * (amplitude - 0.5 / 1000), rel=2e-3)


@pytest.mark.parametrize("end", [RackEnd(300.0), RackEnd(0.0, 3e4, 0.0)], ids=["load", "tyres"])
@pytest.mark.parametrize("step", [1e-5, 1e-3, 1e-2])
def test_what_is_put_in_is_stored_or_lost(table: ReducedGear, end: RackEnd, step: float) -> None:
    """Work of a constant torque per step and of the load, found here; whatever the length of a step."""
    motion, rng, work = ReducedMotion(table, end, 0.3), np.random.default_rng(2), 0.0
    flow, start, lost = 1e-9, _energy(motion), 0.0
    for _ in range(150):
        torque, travel = float(rng.normal(0, 2.0)), motion.travel
        turn = motion.push(Push(torque), step)
        given = torque * turn - end.load * (motion.travel - travel)
        work, flow = work + given, flow + abs(torque * turn) + abs(given)
        assert motion.lost >= lost
        lost = motion.lost
        assert abs(_energy(motion) - start + lost - work) < 1e-6 * flow


def _energy(motion: ReducedMotion) -> float:
    end = motion.end
    spring = end.stiffness * (motion.travel - end.relaxed) ** 2 / 2
    return motion.stored + spring


def test_a_load_beyond_the_table_is_stated_with_its_range(table: ReducedGear) -> None:
    with pytest.raises(BeyondTable, match=r"2500 N .* -2000 to 2000 N"):
        Tables(table).potential(0.0, 2500.0)


def test_friction_that_falls_with_speed_falls_in_the_reduced_gear(table: ReducedGear) -> None:
    falling = replace(table, speeds=np.array([0.0, 1.0]), speed_factor=np.array([1.5, 1.0]))
    motion = ReducedMotion(falling, RackEnd(), 0.0)
    at_rest, half, fast = (motion.limits(0.0, speed)[0][0] for speed in (0.0, 0.5, 9.0))
    assert (at_rest / fast, half / fast) == pytest.approx((1.5, 1.25))


@pytest.mark.quick
def test_a_swing_under_a_load_balances() -> None:
    """The load's work is -F x; what both put in is stored or lost."""
    maneuver = swing_maneuver(GEAR, MODEL.step_angle).under(1000.0)
    signals = by_reduced(made_up, GEAR, MODEL, maneuver, WITHOUT_BARS).signals
    travel = signals["rack_displacement"] - signals["rack_displacement"][0]
    assert signals["work_load"] == pytest.approx(-1000.0 * travel, abs=1e-9)
    given = signals["work_drive"] + signals["work_load"]
    assert given == pytest.approx(sum(signals[name] for name in KEPT & {*signals}), abs=1e-9)


@pytest.mark.parametrize(("scene", "names"), [
    ("reversal", ("hysteresis_area", "torque_jump")),
    ("steering-feel", ("feel_area", "feel_running_torque", "on_centre_stiffness", "breakaway_torque")),
    ("steering-torque", ("angle_dead_band", "torque_dead_band", "steering_gradient")),
    ("stick-slip", ("breakaway_torque", "breakaway_ratio")),
])  # fmt: skip
def test_scenes_agree_with_the_dynamics_within_both_bars(scene: str, names: tuple[str, ...]) -> None:
    reduced, flank = (
        rps.run(scene, SteeringGear().replace(TYRES), fidelity=name) for name in ("reduced", "flank")
    )
    assert (reduced.status, flank.status) == ("ok", "ok")
    given = reduced["work_drive"]
    kept = sum(values for name, values in reduced.signals.items() if name in KEPT)
    assert given == pytest.approx(kept, abs=1e-9 * np.abs(given).max())
    for name in names:
        apart = abs(reduced.summary[name] - flank.summary[name])
        assert apart <= reduced.errors[name] + flank.errors[name], name


def test_a_load_that_the_teeth_do_not_carry_ends_the_table() -> None:
    soft = SteeringGear().replace({**TYRES, "test.steer_torque": "60 N*m", "test.tyre_stiffness": "600 N/mm"})
    result = rps.run("steering-torque", soft, fidelity="reduced")
    assert result.status != "ok"
    assert "under a load of" in result.message


def test_where_the_nut_carries_no_error_is_known() -> None:
    """The runout closes the yoke's clearance: forces then grow as no friction of the table does."""
    tight = SteeringGear().replace({"yoke.clearance": "5 um", "pinion.runout": "40 um"})
    result = rps.run("reversal", tight, fidelity="reduced")
    assert "without a load the yokenut carries" in result.message
    assert "yoke-stopped" in result.codes
    assert all(np.isnan(result.errors[name]) for name in ("hysteresis_area", "torque_jump"))
