"""The tangent of each law is the derivative of its forces: of every part alone, and of whole gears.

By central differences of a nanometre along paths on which rates follow places, dF/dq + factor dF/dv; what
turns with the bar's small angles is left out. Errors count over the largest entry, moments at a centimetre.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from part_law import alone
from rps_exudyn.forces.friction import TIME
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import steady_maneuver
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS, Balance
from rps_exudyn.solvers.equilibrium import EquilibriumPath, equilibrium_path
from rps_exudyn.solvers.follower import add_column_to
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.gear_model import SEAT_LOADS
from verification.law_area import replaced

STEP, RATE_STEP = 1e-9, 1e-7  # of differences [m], [m/s]
PARTS = ("mesh", "yoke", "bush", "bearing")
FORM = {"pinion.profile_slope": 3e-6, "installation.angle_error": 3e-4, "installation.axis_offset": 60e-6}
ERRORS = FORM | {"pinion.runout": 15e-6, "pinion.runout_angle": 1.0}
Settings = Mapping[str, Any]


def rubbing(law: str) -> Settings:
    """All parts with a friction law, whose friction falls by a third about the speeds of sliding."""
    of_law = {"friction_law": law, "static_ratio": 1.5}
    speeds = {f"{part}.stribeck_speed": 5e-3 for part in PARTS[:3]}
    return {f"{part}.{name}": value for part in PARTS for name, value in of_law.items()} | speeds


def followed(settings: Settings, fidelity: Settings | None = None) -> tuple[GearForces, EquilibriumPath]:
    """The forces of a gear with errors, and twelve equilibria 3 degrees apart."""
    gear = replaced(SteeringGear(), {"test.turns": 0.5, **ERRORS, **settings})
    model = Fidelity.preset("quasi-static").replace({"rack": "free", **(fidelity or {})})
    forces, maneuver = gear_forces(gear, model), steady_maneuver(gear, "pinion", 0.0, np.pi, np.radians(3.0))
    path = equilibrium_path(forces.statics, GearPair.of(gear), maneuver.drive, maneuver.time[:12])
    assert path.converged
    return forces, path


def derivative(
    balance: Balance, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float, lengths: np.ndarray
) -> np.ndarray:
    """factor_q dF/dq + factor_v dF/dv by central differences."""
    slope = np.empty((q.size, q.size))
    for j in range(q.size):
        moved, turned, size = np.zeros(q.size), np.zeros(q.size), STEP if factor_q else RATE_STEP
        moved[j], turned[j] = factor_q * size / lengths[j], factor_v * size / lengths[j]
        rise = balance.force(q + moved, v + turned) - balance.force(q - moved, v - turned)
        slope[:, j] = rise / (2 * size / lengths[j])
    return slope


def error(balance: Balance, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float) -> float:
    """Largest difference between tangent and derivative, over the derivative's largest entry."""
    lengths = np.append(balance.lengths, CHARACTERISTIC_LENGTHS[1:7])[: q.size]
    found = balance.force_and_tangent(q, v, factor_q, factor_v)[1]
    expected = derivative(balance, q, v, factor_q, factor_v, lengths)
    scale = np.outer(lengths, lengths)
    largest = np.abs(expected / scale).max()
    return float(np.abs((found - expected) / scale).max() / (largest or 1.0))


def begin_at(balance: Balance, state: np.ndarray, time: float) -> None:
    """Go to a step from a state of the bristles to a time."""
    balance.memory[0], balance.memory[1, TIME] = state, time


# --- each part alone --------------------------------------------------------------------------------
MESHES: dict[str, tuple[Settings, Settings]] = {
    "line": ({}, {}),
    "teeth": ({"mesh.law": "teeth"}, {}),
    # the derivative of a sum over few points is off where a corner of the strip passes one of them
    "area": ({"mesh.law": "area"}, {"strip_stations": 12, "strip_points": 8}),
    "spheres": ({"mesh.law": "area"}, {"mesh": "general-contact", "profile_samples": 27}),
    "triangles": ({}, {"mesh": "triangles"}),
}
SLIDING = ("coulomb", "stribeck")


@pytest.mark.parametrize("law", SLIDING)
@pytest.mark.parametrize(
    "mesh", ["line", "teeth", "spheres", "triangles", pytest.param("area", marks=pytest.mark.long)]
)
def test_tangent_of_each_part_is_the_derivative_of_its_forces(mesh: str, law: str) -> None:
    """What slides: 1e-3, by places, by rates, and along a path."""
    bound = 1.3e-3 if mesh == "triangles" else 1.1e-3  # where they slide slowly the sense of friction turns
    settings, fidelity = MESHES[mesh]
    if mesh in ("spheres", "triangles") and law != "coulomb":
        return  # these have that law alone
    forces, path = followed({**settings, **rubbing(law)}, fidelity)
    for part in ("mesh", "seat", "bush", "bearing"):
        balance = alone(forces, part).statics
        for k in (2, 4, 10):
            for factors in ((1.0, 0.0), (0.0, 1.0), (1.0, 500.0)):
                found = error(balance, path.coordinates[k], path.rates[k], *factors)
                assert found < bound, (part, k, factors)


BESIDE_MESH = ("seat", "bush", "bearing")
BRISTLES = [(mesh, part) for mesh in ("line", "teeth") for part in (*BESIDE_MESH, "mesh")]
OPEN_END = ("teeth", "mesh", 4)
"""A line of contact ends where its flanks part, and its stations move with that end: what the sum over few of
them changes by, 2.1 % by eight and 3.4 % by four, also without friction, is no change of the forces."""


@pytest.mark.parametrize(("mesh", "part"), BRISTLES)
def test_tangent_of_bristles_is_their_derivative(mesh: str, part: str) -> None:
    """Of bristles that slide, and that turn about over a step of 3e-7 to 1.5e-5 m back: 1e-3."""
    settings, fidelity = MESHES[mesh]
    damped = {f"{part}.bristle_damping": 1e-4 for part in PARTS}
    forces, path = followed({**settings, **rubbing("bristle"), **damped}, fidelity)
    balance, rng = alone(forces, part).statics, np.random.default_rng(4)
    for k in (4, 9):
        begin_at(balance, path.kept[k, 0], path.time[k])
        assert error(balance, path.coordinates[k], path.rates[k], 1.0, 0.0) < 1e-3
        for share in (1e-3, 1e-2, 5e-2):
            begin_at(balance, path.kept[k, 1], path.time[k] + 0.01)
            q = path.coordinates[k] - share * (path.coordinates[k] - path.coordinates[k - 1])
            q[2:] += rng.normal(size=q.size - 2) * 1e-7 / CHARACTERISTIC_LENGTHS[2:]
            bound = 0.03 if (mesh, part, k) == OPEN_END else 1e-3
            assert error(balance, q, np.zeros(q.size), 1.0, 0.0) < bound, (k, share)


@pytest.mark.parametrize("clearance", [0.0, 40e-6])
def test_tangent_of_a_tilted_bar_turns_with_its_roll(clearance: float) -> None:
    """A roll swings the bar's axis about X, and bends the bush far from the mesh: 1 % of each column. By a
    tangent without this, runs of long racks that lie askew found no equilibrium."""
    forces, path = followed({"bush.distance": 0.5, "bush.clearance": clearance})
    balance = alone(forces, "bush").statics
    q = path.coordinates[3].copy()
    q[4:7] = 3e-3, 2e-3, -4e-3  # roll, about Y and Z
    still = np.zeros(q.size)
    found = balance.force_and_tangent(q, still, 1.0, 0.0)[1]
    expected = derivative(balance, q, still, 1.0, 0.0, balance.lengths)
    for j in range(1, 7):
        assert found[:, j] == pytest.approx(expected[:, j], abs=0.01 * np.abs(expected[:, j]).max())
    assert error(balance, q, path.rates[3], 0.0, 1.0) < 1e-5  # it slips along the tilted axis


# --- whole gears ------------------------------------------------------------------------------------
WHOLE: dict[str, tuple[Settings, Settings, float]] = {
    "teeth": (MESHES["teeth"][0], {}, 1e-3),
    "rigid bush": ({}, {"bush": "rigid"}, 1e-3),
    "guided rack": ({}, {"rack": "guided"}, 1e-3),
    "loads": ({"installation.gravity": -9.81, "rack.side_force": 200.0}, {}, 1e-3),
    "load exponent": (
        {**rubbing("stribeck"), "mesh.load_exponent": 0.8, "yoke.load_exponent": 0.8}, {}, 1e-3,
    ),
    # that the plunger follows the bar's slope is left out
    "play of the plunger": ({"yoke.bore_clearance": 15e-6}, {}, 0.03),
    "flexible rack": ({}, {"rack": "flexible"}, 1e-3),
    "flexible rack on bristles": (rubbing("bristle"), {"rack": "flexible"}, 1e-3),
    "pinion on bearings": ({}, {"pinion": "supported"}, 1e-3),
    "pinion on bearings, yoke on bristles": ({"yoke.friction_law": "bristle"}, {"pinion": "supported"}, 1e-3),
    "bow": ({"rack.bow": 0.3e-3, "rack.bow_angle": 1.0}, {}, 2e-3),
}  # fmt: skip


@pytest.mark.parametrize("name", WHOLE)
def test_tangent_of_a_gear_is_the_derivative_of_its_forces(name: str) -> None:
    settings, fidelity, bound = WHOLE[name]
    forces, path = followed(settings, fidelity)
    balance = forces.statics
    assert balance.lengths.size == balance.size == path.coordinates.shape[1]
    for k in (3, 9):
        for factors in ((1.0, 0.0), (0.0, 1.0), (1.0, 500.0)):
            if balance.has_bristles:
                begin_at(balance, path.kept[k, 0], path.time[k])
            assert error(balance, path.coordinates[k], path.rates[k], *factors) < bound, (k, factors)


@pytest.mark.parametrize("settings", [{}, rubbing("bristle")], ids=["coulomb", "bristle"])
def test_tangent_of_a_rack_in_a_chain_is_the_derivative_of_its_forces(settings: Settings) -> None:
    """The last segment moves too, by micrometres and micrometres per second: 1e-3."""
    gear = SteeringGear().replace({**ERRORS, **settings})
    balance, rng = gear_forces(gear, Fidelity(bush="chain")), np.random.default_rng(2)
    _, path = followed(settings)
    for k in (3, 9):
        q = np.append(path.coordinates[k], 1e-6 * rng.normal(size=6))
        v = np.append(path.rates[k], 1e-5 * rng.normal(size=6))
        for factors in ((1.0, 0.0), (0.0, 1.0), (1.0, 500.0)):
            if balance.has_bristles:
                begin_at(balance, path.kept[k, 0], path.time[k])
                balance.memory[0, 1 + 8 : 1 + 14] = q[8:] - 0.1 * v[8:]
                factors = 1.0, 0.0
            assert error(balance, q, v, *factors) < 1e-3, (k, factors)


def test_tangent_of_the_loads_on_the_seat() -> None:
    """They are corrected by it where the last step of Newton's method is not evaluated: 1 %."""
    forces, path = followed({}, {})
    balance, q, v = forces.statics, path.coordinates[3], path.rates[3]
    balance.force_and_tangent(q, v, 1.0, 0.0)
    found = np.array(balance.works[0]["of_loads"])
    expected, loads = np.empty((2, 7)), slice(SEAT_LOADS, SEAT_LOADS + 2)
    for j in range(7):
        step = np.zeros(q.size)
        step[1 + j] = STEP / CHARACTERISTIC_LENGTHS[1 + j]
        ends = []
        for sign in (1, -1):
            balance.force(q + sign * step, v)
            ends.append(np.array(balance.works[0]["out"][loads]))
        expected[:, j] = (ends[0] - ends[1]) / (2 * step[1 + j])
    scale = CHARACTERISTIC_LENGTHS[1:]
    assert np.abs((found - expected) / scale).max() < 0.01 * np.abs(expected / scale).max()


def test_a_column_without_masses_is_one_whose_masses_are_zero() -> None:
    """In steady motion there is no mass matrix: nothing is read from it."""
    column, rng = np.array([1.0, 80.0, 0.05, 0.5, 0.3, 2e5, 1e-4]), np.random.default_rng(5)
    q, v, before = rng.normal(size=(3, 9))
    found = []
    for masses in (np.zeros((0, 0)), np.zeros((9, 9))):
        total, tangent = np.zeros(9), np.zeros((9, 9))
        add_column_to(q, v, column, 0.4, masses, before, 200.0, 200.0, total, tangent)
        found.append((total, tangent))
    for empty, zero in zip(*found, strict=True):
        assert (empty == zero).all()


@pytest.mark.parametrize("bend", [0.0, 0.5])
def test_tangent_of_column_and_tyres_is_their_derivative(bend: float) -> None:
    """Torques on pinion and wheel, through a universal joint too, the tyres' force on the rack, and the
    inertia of all masses along the path, where some are coupled."""
    column = np.array([1.0, 80.0, 0.05, bend, 0.3, 2e5, 1e-4])
    q, v, before, masses, per_time = (*np.zeros((3, 9)), np.zeros((9, 9)), 200.0)
    q[[0, 1, 8]], v[[0, 1, 8]] = (-0.71, 4e-3, -0.7), (-1.5, 8e-3, -1.4)
    masses[[0, 1, 8], [0, 1, 8]], before[[0, 1, 8]] = (4e-5, 2.5, 0.035), (-1.3, 7e-3, -1.45)
    masses[[1, 5], [5, 1]] = 0.02

    def at(q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        total, tangent = np.zeros(9), np.zeros((9, 9))
        add_column_to(q, v, column, 0.4, masses, before, per_time, per_time, total, tangent)
        return total, tangent

    found, expected = at(q, v)[1], np.empty((9, 9))
    for j in range(9):
        step = 1e-6 * np.eye(9)[j]
        expected[:, j] = (at(q + step, v + per_time * step)[0] - at(q - step, v - per_time * step)[0]) / 2e-6
    lengths = np.append(CHARACTERISTIC_LENGTHS, 0.01)
    difference, scale = np.abs(found - expected) / np.outer(lengths, lengths), np.abs(expected[0, 0]) / 1e-4
    assert difference.max() < 1e-3 * scale
