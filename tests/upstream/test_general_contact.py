"""What the package relies on, or works around, in Exudyn 1.13.6's GeneralContact.

A new Exudyn version is judged by running these: one that fails shows which workaround may go or must change.
"""

import exudyn as exu
import numpy as np
import pytest
from exudyn.itemInterface import (
    MarkerBodyPosition,
    MarkerBodyRigid,
    NodePoint,
    ObjectGround,
    ObjectMassPoint,
)

RADIUS, STIFFNESS = 1e-3, 1e6
PLATE = np.array([[-1.0, -1, 0], [3, -1, 0], [-1, 3, 0]])  # right-angled, outward normal +Z


def contact_force(
    height: float,
    place: tuple[float, float] = (0.1, 0.1),
    *,
    receding: float = 0.0,
    damping: float = 0.0,
    keep_forces: bool = True,
) -> np.ndarray:
    """Force on a sphere whose centre stands above a plate, from one evaluation of the right-hand side."""
    mbs = exu.SystemContainer().AddSystem()
    ground = mbs.AddObject(ObjectGround())
    plate = mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=[0, 0, 0]))
    node = mbs.AddNode(NodePoint(referenceCoordinates=[*place, height], initialVelocities=[0, 0, receding]))
    body = mbs.AddObject(ObjectMassPoint(mass=1.0, nodeNumber=node))
    contact = mbs.AddGeneralContact()
    contact.sphereSphereContact = False
    contact.computeContactForces = keep_forces
    contact.SetFrictionPairings(np.zeros((1, 1)))
    contact.SetSearchTreeBox(pMin=[-1, -1, -1], pMax=[3, 3, 1])
    contact.SetSearchTreeCellSize(numberOfCells=[4, 4, 4])
    contact.AddSphereWithMarker(
        mbs.AddMarker(MarkerBodyPosition(bodyNumber=body)), RADIUS, STIFFNESS, damping, 0
    )
    contact.AddTrianglesRigidBodyBased(plate, 1e6 * STIFFNESS, 0.0, 0, PLATE, [[0, 1, 2]])
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.endTime = 1e-9
    settings.timeIntegration.numberOfSteps = 1
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.ExplicitEuler)
    return contact.GetSystemODE2RhsContactForces(copy=True)


def test_force_is_stiffness_times_depth() -> None:
    """The triangles' stiffness is in series and a million times the sphere's."""
    assert contact_force(0.4 * RADIUS)[2] == pytest.approx(0.6 * RADIUS * STIFFNESS, rel=2e-6)


def test_sphere_deeper_than_its_radius_passes_through_unnoticed() -> None:
    """Why `judge` bounds the penetration."""
    assert contact_force(0.01 * RADIUS)[2] == pytest.approx(0.99 * RADIUS * STIFFNESS, rel=1e-5)
    assert contact_force(-0.01 * RADIUS)[2] <= 0.0


def test_damped_sphere_that_recedes_pulls() -> None:
    """Why the compiled samples do not cut the force at zero either."""
    force = contact_force(0.4 * RADIUS, receding=1.0, damping=1000.0)[2]
    assert force == pytest.approx(0.6 * RADIUS * STIFFNESS - 1000.0, rel=1e-4)
    assert force < 0


def test_outer_edge_halves_the_force() -> None:
    """Why the rack's triangles are larger than its flanks."""
    on_edge = contact_force(0.4 * RADIUS, (0.1, -1.0 - 1e-9))[2]
    assert on_edge == pytest.approx(0.5 * 0.6 * RADIUS * STIFFNESS, rel=1e-3)


def test_forces_are_kept_only_on_request() -> None:
    assert contact_force(0.4 * RADIUS, keep_forces=False).size == 0
