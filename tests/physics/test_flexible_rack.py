"""A rack that bends, or is not straight: laws of the modes beside the rigid body, and known numbers.

The reference numbers of the impact are those of an independent model: 8 + 8 modes of a Timoshenko bar fitted
to three-dimensional finite elements, integrated on its own; half its step agrees to 0.03 %.
"""

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.equilibrium import starting_guess, steady_rates
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.record import Record
from verification.difference_tangent import difference_tangent
from verification.nodal_bar import shaken_bar
from verification.seat_cells import by_cells

GEAR = SteeringGear().replace({"mesh.law": "line", "mesh.line_stiffness": 13.8265e9})
"""With the stiffness c' of ISO 6336-1, which the independent models of this file have."""
PITCH = 1 / GEAR.pinion.teeth  # [turns]
RIGID = Fidelity.preset("quasi-static").replace({"rack": "free"})
FLEXIBLE = RIGID.replace({"rack": "flexible"})
BENT = {"rack.bow": "0.3 mm", "rack.bow_angle": "90 deg", "rack.modes": 4}


def turned(settings: dict[str, object], fidelity: Fidelity = FLEXIBLE, turns: float = PITCH) -> Result:
    """The pinion turned over some tooth pitches, all right."""
    gear = GEAR.replace({"test.turns": turns, **settings})
    result = rps.run("free-pinion-torque", gear, fidelity=fidelity)
    assert result.status is Status.OK, result.message
    return result


@pytest.fixture(scope="module")
def straight() -> Result:
    return turned({}, RIGID)


# --- no bending --------------------------------------------------------------------------------------
@pytest.mark.parametrize("solver", ["equilibrium", "generalized-alpha"])
def test_without_modes_a_flexible_rack_is_the_rigid_one_to_the_last_bit(solver: str) -> None:
    rigid, none = (
        turned({"rack.modes": 0}, model.replace({"solver": solver}), PITCH / 4) for model in (RIGID, FLEXIBLE)
    )
    assert rigid.signals.keys() == none.signals.keys()
    for name, values in rigid.signals.items():
        assert np.array_equal(values, none[name]), name


def test_a_stiff_flexible_rack_is_the_rigid_one(straight: Result) -> None:
    """EI x 1e4 bends 1e-4 of the 0.2 % by which a steel bar moves the mean: 0.02 % are generous."""
    stiff = turned({"rack.youngs_modulus": 1e4 * GEAR.rack.youngs_modulus})
    assert stiff.summary["torque_mean"] == pytest.approx(straight.summary["torque_mean"], rel=2e-4)
    np.testing.assert_allclose(stiff["pinion_torque"], straight["pinion_torque"], rtol=2e-4)


# --- laws of the modes -------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def bent() -> GearForces:
    return gear_forces(GEAR.replace(BENT), FLEXIBLE.replace({"zone_ratio": 0.1}), rack_load=500.0)


def scattered(forces: GearForces, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A state near steady turning, the bar bent by some micrometres."""
    rng, size, pair = np.random.default_rng(seed), forces.statics.size, GearPair.of(GEAR)
    q, v = starting_guess(pair, 0.4, size), steady_rates(pair, GEAR.test.speed, size)
    q[0] = -0.4
    q[2:8] += 2e-6 * rng.standard_normal(6) / CHARACTERISTIC_LENGTHS[2:]
    q[8:] += 5e-6 * rng.standard_normal(size - 8)
    v[8:] += 1e-4 * rng.standard_normal(size - 8)
    return q, v


@pytest.mark.parametrize("factors", [(1.0, 0.0), (0.0, 1.0)])
def test_chain_rule_gives_the_tangent(bent: GearForces, factors: tuple[float, float]) -> None:
    """Against central differences of the whole force: that of the laws, which leaves out what turns with the
    bar's small angles, to 1e-3 of the largest entry; that by forward differences, which a contact with kinks
    leaves 1e-3, with each coordinate's own size: over the square root of the diagonal's."""
    balance = bent
    for seed in range(3):
        q, v = scattered(bent, seed)
        found = balance.tangent(q, v, *factors)
        expected = np.empty_like(found)
        steps = 1e-9 / balance.lengths
        for j, step in enumerate(steps):
            dq, dv = factors[0] * np.eye(len(q))[j] * step, factors[1] * np.eye(len(q))[j] * 100 * step
            rise = balance.force(q + dq, v + dv) - balance.force(q - dq, v - dv)
            expected[:, j] = rise / (2 * (factors[0] + 100 * factors[1]) * step)
        scale = np.outer(balance.lengths, balance.lengths)
        assert np.abs((found - expected) / scale).max() < 1e-3 * np.abs(expected / scale).max()
        size = np.sqrt(np.abs(np.diag(expected)))
        size = np.maximum(size, 1e-3 * size.max())
        by_differences = difference_tangent(balance, q, v, *factors)
        assert np.abs((by_differences - expected) / np.outer(size, size)).max() < 2e-3


@pytest.mark.parametrize("cells", [False, pytest.param(True, marks=pytest.mark.long)])
def test_forces_are_the_work_of_the_laws_on_the_local_pose(bent: GearForces, cells: bool) -> None:
    """Power of the generalised forces = power of each law at the bar's pose where it acts, of the bar's
    elasticity and damping: what the chain rule to the modes, and along the bar, must keep. To rounding, also
    where cells stand in the place of the seat."""
    bent = by_cells(bent) if cells else bent
    assert bent.bar is not None
    for seed in range(5):
        q, v = scattered(bent, seed)
        v[1:8] += np.random.default_rng(seed).standard_normal(7) * 1e-3
        rows = q[None], v[None]
        record = Record(bent, np.zeros(1), *rows, np.zeros(1), "pinion", np.zeros(1))
        power = 0.0
        for part in bent.parts:
            _, rates = record.seen_by(part)
            power += float(record.outputs(part)[0, : part.size] @ rates[0])
        elastic = float((bent.bar.stiffness * q[8:]) @ v[8:])
        power -= elastic + float(bent.bar.damping_power(rows[1])[0])
        assert float(bent.force(q, v) @ v) == pytest.approx(power, rel=1e-9)


def test_local_pose_moves_as_its_rates_say(bent: GearForces) -> None:
    """Central differences of the pose seen by the bush along a motion, the bar sliding through it."""
    assert bent.bar is not None
    q, v = scattered(bent, 1)
    before, here, after = (
        bent.bar.poses((q + s * v)[None], v[None], bent.bar.places["bush"]) for s in (-1e-4, 0, 1e-4)
    )
    np.testing.assert_allclose((after[0] - before[0]) / 2e-4, here[1], atol=1e-9)


# --- deflection --------------------------------------------------------------------------------------
KNOWN_PLAY = [("0 deg", "rack_end_y", 258e-6), ("90 deg", "rack_end_z", 179e-6)]


@pytest.mark.parametrize(("angle", "name", "known"), KNOWN_PLAY)
def test_side_force_of_98_newtons_deflects_the_end_as_known(angle: str, name: str, known: float) -> None:
    """98 N either way at the end of a gear that hardly rubs, half the way between both. An independent model
    says 256 to 260 um along Y and 179 um along Z with another contact law and another section of the toothed
    part, which together are good for 4 %; a rigid rack moves by 16 um."""
    slippery = {"mesh.friction": 0.001, "yoke.friction": 0.0, "bush.drag": 0.0, "rack.side_angle": angle}
    low, high = (turned({**slippery, "rack.side_force": force}, turns=PITCH / 12) for force in (-98.0, 98.0))
    assert (high[name].mean() - low[name].mean()) / 2 == pytest.approx(known, rel=0.04)


# --- a bar that is not straight -------------------------------------------------------------------------
@pytest.mark.parametrize("rack", ["free", "flexible"])
def test_work_balances_along_a_bent_bar(rack: str) -> None:
    """0.2 %, over half a turn: sliding along the bow stores and gives back, and does no work besides."""
    result = turned(BENT, RIGID.replace({"rack": rack}), turns=0.5)
    assert abs(result.summary["energy_residual"]) < 2e-3


def test_a_bar_that_bends_yields_to_its_bow() -> None:
    """Bush, seat and teeth pull a bent bar straight: a stiff one swings its torque more."""
    rigid, flexible = (turned(BENT, model, turns=0.5) for model in (RIGID, FLEXIBLE))
    assert flexible.summary["torque_peak_to_peak"] < rigid.summary["torque_peak_to_peak"]


# --- impact ----------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def impact() -> Result:
    result = rps.run("yoke-impact", GEAR, pulse_period="7.5 ms")
    assert result.status is Status.OK, result.message
    return result


def test_impact_has_the_numbers_of_an_independent_model(impact: Result) -> None:
    """Impulse, root mean square and displacement of the end within 1 %, the first peak within 3 %."""
    time, force = impact["time"], impact["yokenut_force"]
    first = time <= 7.5e-3 + 1e-9
    time, force = time[first], force[first]
    assert np.trapezoid(force, time) == pytest.approx(10.3, rel=0.01)
    assert np.sqrt(np.trapezoid(force**2, time) / 7.5e-3) == pytest.approx(1890, rel=0.01)
    assert np.abs(impact["rack_end_y"][first]).max() == pytest.approx(6.01e-3, rel=0.01)
    assert force.max() == pytest.approx(3645, rel=0.03)


@pytest.mark.parametrize("axis", ["y", "z"])
def test_impacts_by_both_laws_of_the_teeth_have_the_same_impulse(axis: str) -> None:
    """Of the yokenut's force until the next pulse: 4 %, by the gear's own stiffness at rest."""
    impulses = []
    for law in ("line", "teeth"):
        gear = SteeringGear().replace({"mesh.law": law, "test.pulse_axis": axis})
        result = rps.run("yoke-impact", gear, pulse_period="7.5 ms")
        assert result.status is Status.OK, result.message
        first = result["time"] <= 7.5e-3 + 1e-9
        impulses.append(np.trapezoid(result["yokenut_force"][first], result["time"][first]))
    assert impulses[0] == pytest.approx(impulses[1], rel=0.04)


def test_impact_accounts_for_the_energy_of_bending(impact: Result) -> None:
    """0.2 % of the pulse's work; the bar stores most of it for a while, and its damping takes some."""
    assert abs(impact.summary["energy_residual"]) < 2e-3
    assert impact["bending_energy"].max() > 0.5 * impact["work_load"].max()
    assert 0 < impact["work_rack_damping"][-1] < impact["work_load"].max()
    assert (np.diff(impact["work_rack_damping"]) >= 0).all()


@pytest.mark.parametrize(
    "settings",
    [
        {"test.pulse_axis": "z", "test.pulse_force": "1 kN", "test.start_angle": "-200 deg"},
        {"test.pulse_force": "2.5 kN", "test.pulse_duration": "3 ms", "test.start_angle": "250 deg"},
    ],
)
def test_impact_is_that_of_a_bar_of_nodes(settings: dict[str, object]) -> None:
    """`verification.nodal_bar`: no rigid body, no modes, no Exudyn. Eight modes for all of them, a mass
    centre on the axis and other steps leave 1 % of where the end is, and 2 % of what reaches the yokenut."""
    gear = GEAR.replace({"test.pulse_period": "4 ms", "test.pulse_duration": "4 ms", **settings})
    fidelity = Fidelity().replace({"zone_ratio": 0.1})
    result = rps.run("yoke-impact", gear, fidelity=fidelity)
    assert result.status is Status.OK, result.message
    nodal = shaken_bar(gear, fidelity, step=2e-6, end=4e-3)
    end = np.column_stack([result["rack_end_y"], result["rack_end_z"]])
    here = np.column_stack([np.interp(nodal.time, result["time"], column) for column in end.T])
    assert np.abs(here - nodal.end).max() < 0.01 * np.abs(nodal.end).max()
    impulse = np.trapezoid(nodal.yokenut_force, nodal.time)
    force = np.interp(nodal.time, result["time"], result["yokenut_force"])
    assert np.trapezoid(force, nodal.time) == pytest.approx(impulse, rel=0.02)


def test_a_rigid_rack_says_what_it_misses() -> None:
    rigid = rps.run("yoke-impact", GEAR, fidelity=Fidelity().replace({"rack": "free"}), pulse_period="5 ms")
    assert rigid.status is Status.OK
    assert "fidelity.rack" in rigid.message
    assert "rack_end_y" not in rigid.signals


# --- what cannot be ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "choice", [{"mesh": "general-contact"}, {"bush": "chain"}, {"solver": "closed-form"}]
)
def test_flexible_rack_where_the_model_knows_rigid_ones_only_is_refused(choice: dict[str, str]) -> None:
    with pytest.raises(InputError, match=r"fidelity\.rack"):
        Fidelity().replace({"rack": "flexible", **choice})


@pytest.mark.parametrize("choice", [{"mesh": "general-contact"}, {"bush": "chain"}])
def test_bow_where_the_model_knows_straight_bars_only_is_not_run(choice: dict[str, str]) -> None:
    result = rps.run(
        "free-pinion-torque", GEAR.replace({"rack.bow": "0.1 mm"}), fidelity=Fidelity().replace(choice)
    )
    assert result.status is Status.INVALID
    assert "rack.bow is 100 um" in result.message
