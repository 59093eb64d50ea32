"""The tangent of the flank contact is the derivative of its forces, for each law."""

import numpy as np
import pytest

from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_element import flank_element
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS

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
        q = np.array([-angle, gain * angle, lift, 0.0, *rng.uniform(-2e-4, 2e-4, 3)])
        v = np.array([-1.5, 1.5 * gain, *rng.uniform(-1e-5, 1e-5, 2), *rng.uniform(-1e-3, 1e-3, 3)])
        found.append((q, v))
    return found


def forces(element: ForceElement, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The forces alone, by the kernel that gives the tangent too: one to compile instead of two."""
    assert element.tangent is not None
    return np.asarray(element.tangent(q, v, element.data, 0.0, 0.0, np.zeros((7, 7)))[:7])


@pytest.mark.parametrize("law", ["line", "teeth", "area"])
def test_tangent_is_the_derivative_of_the_forces(law: str) -> None:
    """Along paths on which rates follow places, as the equilibria's: dF/dq + per_time dF/dv."""
    along, across = POINTS[law]
    gear = GEAR.replace({"mesh.law": law})
    element = flank_element(gear, friction_zone=1e-5, along=along, across=across)
    assert element.tangent is not None
    errors = []
    for q, v in poses(10):
        for per_time in (0.0, 500.0):
            tangent, by_differences = np.zeros((7, 7)), np.empty((7, 7))
            element.tangent(q, v, element.data, 1.0, per_time, tangent)
            for j in range(7):
                step = np.zeros(7)
                step[j] = STEP / LENGTHS[j]
                after = forces(element, q + step, v + per_time * step)
                before = forces(element, q - step, v - per_time * step)
                by_differences[:, j] = (after - before) / (2 * step[j])
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
    plain = flank_element(GEAR.replace({"mesh.law": law}), friction_zone=1e-5, along=4, across=2)
    crowned = GEAR.replace({"mesh.law": law, "pinion.crowning": 1e-16})
    modified = flank_element(crowned, friction_zone=1e-5, along=4, across=2)
    for q, v in poses(10):
        found, expected = forces(plain, q, v), forces(modified, q, v)
        largest = np.abs(expected / LENGTHS).max()
        assert found / LENGTHS == pytest.approx(expected / LENGTHS, abs=1e-7 * largest)
