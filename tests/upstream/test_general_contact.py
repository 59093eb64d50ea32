"""What the package relies on, or works around, in Exudyn 1.13.6's GeneralContact.

Run these with a new Exudyn version: a test that fails shows which workaround may go or must change.
"""

import exudyn as exu
import numpy as np
import pytest
from exudyn.itemInterface import (
    Force,
    MarkerBodyPosition,
    MarkerBodyRigid,
    MarkerNodePosition,
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
    """Why `checks.after_run` bounds the penetration."""
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


def test_spheres_and_triangles_of_an_assembled_system_can_be_moved() -> None:
    """Why a few places for them stand for the many of a turn: what touches is found where they are now."""
    mbs = exu.SystemContainer().AddSystem()
    ground = mbs.AddObject(ObjectGround())
    plate, ball = (
        mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=[0, 0, z])) for z in (0, 10)
    )
    contact = mbs.AddGeneralContact()
    contact.SetFrictionPairings(np.zeros((1, 1)))
    contact.SetSearchTreeBox(pMin=[-1, -1, -1], pMax=[3, 3, 1])
    contact.AddSphereWithMarker(ball, RADIUS, STIFFNESS, 0.0, 0)
    contact.AddTrianglesRigidBodyBased(plate, STIFFNESS, 0.0, 0, PLATE, [[0, 1, 2]])
    mbs.Assemble()

    def touches() -> bool:
        contact.UpdateContacts(mbs)
        return len(contact.GetActiveContacts(exu.ContactTypeIndex.IndexSpheresMarkerBased, 0)) > 0

    assert not touches()
    mbs.SetMarkerParameter(ball, "localPosition", [0, 0, 0.5 * RADIUS])
    assert touches()
    contact.SetTriangleRigidBodyBased(0, PLATE - [0, 0, RADIUS])
    assert not touches()


def test_forces_are_kept_only_on_request() -> None:
    assert contact_force(0.4 * RADIUS, keep_forces=False).size == 0


# --- in the implicit solver ------------------------------------------------------------------------
TWO_HALVES = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
ONE_TRIANGLE, TWO_TRIANGLES = (PLATE, [[0, 1, 2]]), (TWO_HALVES, [[0, 1, 2], [0, 2, 3]])


def balls_on_plate(
    balls: list[tuple[list[float], list[float]]],
    triangles: tuple[np.ndarray, list[list[int]]],
    *,
    mass: float,
    contacts: str = "common",
    weight: float = 0.0,
    sphere_sphere: bool = False,
) -> exu.MainSystem:
    """Balls with places and velocities above a plate, in one common contact or each in its own."""
    exu.config.printToConsole = False
    mbs = exu.SystemContainer().AddSystem()
    plate = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    contact = None
    for place, velocity in balls:
        if contact is None or contacts == "own":
            contact = mbs.AddGeneralContact()
            contact.verboseMode = 0
            contact.sphereSphereContact = sphere_sphere
            contact.SetFrictionPairings(np.zeros((1, 1)))
            contact.SetSearchTreeBox(pMin=[-1, -1, -1], pMax=[3, 3, 1])
            contact.SetSearchTreeCellSize(numberOfCells=[4, 4, 4])
            contact.AddTrianglesRigidBodyBased(plate, 1e6 * STIFFNESS, 0.0, 0, *triangles)
        node = mbs.AddNode(NodePoint(referenceCoordinates=place, initialVelocities=velocity))
        body = mbs.AddObject(ObjectMassPoint(mass=mass, nodeNumber=node))
        marker = mbs.AddMarker(MarkerBodyPosition(bodyNumber=body))
        contact.AddSphereWithMarker(marker, RADIUS, STIFFNESS, 0.0, 0)
        force = mbs.AddMarker(MarkerNodePosition(nodeNumber=node))
        mbs.AddLoad(Force(markerNumber=force, loadVector=[0, 0, -weight]))
    mbs.Assemble()
    return mbs


def integrate(mbs: exu.MainSystem, step: float, steps: int) -> None:
    """By generalised alpha with differences of the whole system."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    time = settings.timeIntegration
    time.endTime, time.numberOfSteps = step * steps, steps
    time.generalizedAlpha.spectralRadius, time.discontinuous.iterationTolerance = 0.7, 1e-4
    time.newton.relativeTolerance = 1e-6
    time.newton.numericalDifferentiation.doSystemWideDifferentiation = True
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.GeneralizedAlpha)


@pytest.mark.parametrize(("sphere_sphere", "fraction"), [(False, 0.0), (True, 1.0)])
def test_contact_between_spheres_alone_has_a_jacobian(sphere_sphere: bool, fraction: float) -> None:
    """Why the general contact brings a Jacobian of its own."""
    mbs = balls_on_plate(
        [([0.1, 0.1, 0.6 * RADIUS], [0, 0, 0])], ONE_TRIANGLE, mass=1.0, sphere_sphere=sphere_sphere
    )
    integrate(mbs, 1e-9, 1)
    _, stiffness, _ = mbs.ComputeLinearizedSystem()
    assert stiffness[2, 2] == pytest.approx(fraction * STIFFNESS, rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("contacts", ["common", "own"])
def test_active_set_test_compares_numbers_of_contacts_only(contacts: str) -> None:
    """One ball leaves the plate while another one lands: in a common contact the step is accepted with the
    contacts it began with; the ball that left is pulled, the one that landed sinks in unhindered."""
    leaves, lands = ([0.1, 0.1, 0.9 * RADIUS], [0, 0, 0.4]), ([0.5, 0.5, 1.1 * RADIUS], [0, 0, -0.4])
    mbs = balls_on_plate([leaves, lands], ONE_TRIANGLE, mass=1e3, contacts=contacts)
    integrate(mbs, 1e-3, 1)
    force = 1e3 * mbs.systemData.GetODE2Coordinates_tt()[[2, 5]]
    depth = 0.3 * RADIUS  # of the one that lands, and height of the one that left, after 1 ms
    true, wrong = [0.0, STIFFNESS * depth], [-STIFFNESS * depth, 0.0]
    assert force == pytest.approx(true if contacts == "own" else wrong, abs=0.01 * STIFFNESS * depth)


@pytest.mark.parametrize(("triangles", "least"), [(ONE_TRIANGLE, 0.0), (TWO_TRIANGLES, 1.0)])
def test_ball_that_crosses_an_inner_edge_is_kicked(
    triangles: tuple[np.ndarray, list[list[int]]], least: float
) -> None:
    """It rolls under its weight; during the step that crosses it keeps the old triangle, whose edge halves
    the force. Why a flank of the rack is one triangle."""
    weight = 9.81
    resting = [-0.05, 0.0, RADIUS - weight / STIFFNESS]
    mbs = balls_on_plate([(resting, [1.0, 0.3, 0.0])], triangles, mass=1.0, weight=weight)
    kicks: list[float] = []
    mbs.SetPostStepUserFunction(
        lambda mbs, t: bool(kicks.append(abs(mbs.systemData.GetODE2Coordinates_tt()[2])) or True)
    )
    integrate(mbs, 1e-3, 100)
    assert least * weight <= max(kicks) < max(10 * least, 1e-4) * weight
