"""The tangent of the flank contact is the derivative of its forces, for each law."""

import numpy as np
import pytest

from part_law import alone
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
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


@pytest.mark.parametrize("law", ["line", "teeth", pytest.param("area", marks=pytest.mark.long)])
def test_tangent_is_the_derivative_of_the_forces(law: str) -> None:
    """Along paths on which rates follow places, as the equilibria's: dF/dq + per_time dF/dv."""
    balance = mesh_of(by_law(GEAR, law), *POINTS[law]).statics
    errors = []
    for q, v in poses(10):
        for per_time in (0.0, 500.0):
            tangent = balance.force_and_tangent(q, v, 1.0, per_time)[1][:7, :7]
            by_differences = np.empty((7, 7))
            for j in range(7):
                step = np.zeros(8)
                step[j] = STEP / LENGTHS[j]
                after = balance.force(q + step, v + per_time * step)
                before = balance.force(q - step, v - per_time * step)
                by_differences[:, j] = (after - before)[:7] / (2 * step[j])
            scale = np.outer(LENGTHS, LENGTHS)
            error = np.abs((tangent - by_differences) / scale).max()
            errors.append(error / np.abs(by_differences / scale).max())
    assert max(errors) < CLOSE[law]
    assert np.median(errors) < CLOSE[law] / 5


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
