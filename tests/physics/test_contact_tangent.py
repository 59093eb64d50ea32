"""The tangent of the flank contact is the derivative of its forces, for each law."""

from typing import Any

import numpy as np
import pytest

from part_law import alone
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS, Balance
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from verification.law_area import by_law

LENGTHS = CHARACTERISTIC_LENGTHS[:7]  # of pinion (1), rack (6)
STEP = 1e-8  # of differences [m]: their error is below 1e-6 of the largest entry
GEAR = SteeringGear().replace({"pinion.runout": 20e-6})

# Largest difference over the largest entry. What is left out, the lines' ends and the change of the sliding
# with the place, is as large at a pose that tilts the rack against its teeth; the median pose has a fifth.
CLOSE = {"line": 0.01, "teeth": 0.02, "area": 0.02}
# Law "area" by many points: the derivative of a sum over few is off by a tenth where a corner of the strip
# passes one of them
POINTS = {"line": (4, 2), "teeth": (4, 2), "area": (12, 8)}


def poses(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Random poses pressed and tilted as in use, and rates."""
    rng, gain = np.random.default_rng(4), GearPair.of(GEAR).gain
    found = []
    for _ in range(count):
        angle = rng.uniform(0, 2 * np.pi)
        lift = GEAR.pinion.runout * np.cos(angle) - rng.uniform(4e-6, 9e-6)
        q = np.array([-angle, gain * angle, lift, 0.0, *rng.uniform(-2e-4, 2e-4, 3), 0.0])
        v = np.array([-1.5, 1.5 * gain, *rng.uniform(-1e-5, 1e-5, 2), *rng.uniform(-1e-3, 1e-3, 3), 0.0])
        found.append((q, v))
    return found


def mesh_of(gear: SteeringGear, along: int, across: int) -> GearForces:
    """The contact of a gear's flanks with some points, all else without force."""
    points = {"strip_stations": along, "strip_points": across}
    forces = gear_forces(gear, Fidelity.preset("quasi-static").replace(points))
    forces.gears["mesh"]["flank"]["zone"] = 1e-5
    return alone(forces, "mesh")


def both_tangents(
    balance: Balance, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float
) -> tuple[np.ndarray, np.ndarray]:
    """The tangent and that by differences, by lengths instead of coordinates, (7, 7)."""
    tangent = balance.force_and_tangent(q, v, factor_q, factor_v)[1][:7, :7]
    by_differences = np.empty((7, 7))
    for j in range(7):
        step = np.zeros(8)
        step[j] = STEP / LENGTHS[j]
        after = balance.force(q + factor_q * step, v + factor_v * step)
        before = balance.force(q - factor_q * step, v - factor_v * step)
        by_differences[:, j] = (after - before)[:7] / (2 * step[j])
    scale = np.outer(LENGTHS, LENGTHS)
    return tangent / scale, by_differences / scale


def error_of(*arguments: Any) -> float:
    """Largest difference between both tangents, over the largest entry."""
    tangent, by_differences = both_tangents(*arguments)
    return float(np.abs(tangent - by_differences).max() / np.abs(by_differences).max())


@pytest.mark.parametrize("law", ["line", "teeth", pytest.param("area", marks=pytest.mark.long)])
def test_tangent_is_the_derivative_of_the_forces(law: str) -> None:
    """Along paths on which rates follow places, as the equilibria's: dF/dq + per_time dF/dv."""
    balance = mesh_of(by_law(GEAR, law), *POINTS[law]).statics
    errors = [error_of(balance, q, v, 1.0, per_time) for q, v in poses(10) for per_time in (0.0, 500.0)]
    assert max(errors) < CLOSE[law]
    assert np.median(errors) < CLOSE[law] / 5


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_tangent_has_a_friction_that_changes_with_the_whole_load(law: str) -> None:
    """Along the teeth, where only friction resists the rates."""
    falling = {"friction_law": "stribeck", "static_ratio": 1.5, "load_exponent": 0.6, "friction": 0.3}
    gear = GEAR.replace({f"mesh.{name}": value for name, value in falling.items()})
    balance = mesh_of(by_law(gear, law), *POINTS[law]).statics
    for factors in ((1.0, 0.0), (0.0, 1.0)):
        errors = [error_of(balance, q, v, *factors) for q, v in poses(10)]
        assert np.median(errors) < CLOSE[law] / 2


@pytest.mark.parametrize(("law", "close"), [("line", 1e-5), ("teeth", 0.1)])
def test_tangent_has_the_place_where_sliding_turns_about(law: str, close: float) -> None:
    """With parallel axes it lies within a line, which is taken in two pieces there; beside the diagonal.

    Without it the median pose's entries are wrong by nine tenths.
    """
    axes = {"pinion.profile_shift": 0.3, "pinion.helix_angle": 0.35, "rack.tooth_angle": 0.349}
    forces = mesh_of(by_law(GEAR.replace(axes), law), *POINTS[law])
    assert forces.gears["mesh"]["flank"]["breaks_sliding"].all()
    errors = []
    for q, v in poses(20):
        tangent, by_differences = both_tangents(forces.statics, q, v, 0.0, 1.0)
        size = np.sqrt(np.abs(np.diag(by_differences)))
        errors.append((np.abs(tangent - by_differences) / np.outer(size, size)).max())
    assert np.median(errors) < close


@pytest.mark.parametrize("law", ["line", "teeth"])
def test_unmodified_flanks_are_the_limit_of_modified_ones(law: str) -> None:
    """Their lines are known in closed form; a crowning far below an atom goes the way of all modifications.

    Both begin the solution of the loads at the same place: what rounding makes of it is below 1e-7.
    """
    crowned = by_law(GEAR.replace({"pinion.crowning": 1e-16}), law)
    plain, modified = (mesh_of(gear, 4, 2).statics for gear in (by_law(GEAR, law), crowned))
    for q, v in poses(10):
        found, expected = (each.force(q, v)[:7] / LENGTHS for each in (plain, modified))
        assert found == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())
