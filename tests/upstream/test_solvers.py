"""What the package relies on, or works around, in Exudyn 1.13.6's solvers and node types.

Run these with a new Exudyn version: a test that fails shows which workaround may go or must change.
results/stability/README.md lists what each of them costs.
"""

import subprocess
import sys

import exudyn as exu
import numpy as np
import pytest
from exudyn.itemInterface import (
    CoordinateConstraint,
    CoordinateSpringDamper,
    Force,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    MarkerNodePosition,
    Node1D,
    NodePoint,
    NodePointGround,
    NodeRigidBodyEP,
    NodeRigidBodyRotVecLG,
    NodeRigidBodyRxyz,
    ObjectGround,
    ObjectMass1D,
    ObjectMassPoint,
    ObjectRigidBody,
    RigidBodySpringDamper,
    Torque,
)

EXPLICIT = ["ExplicitEuler", "ExplicitMidpoint", "RK33", "RK44", "VelocityVerlet"]


def system() -> exu.MainSystem:
    exu.config.printToConsole, exu.config.suppressWarnings = False, True
    return exu.SystemContainer().AddSystem()


def solved(mbs: exu.MainSystem, solver: str, end: float, steps: int) -> bool:
    """What SolveDynamic says of the run; fixed steps, full Newton."""
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    time = settings.timeIntegration
    time.endTime, time.numberOfSteps = end, steps
    time.explicit.computeEndOfStepAccelerations = True
    time.newton.useModifiedNewton = False
    return bool(mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, solver)))


def oscillator(stiffness: float) -> exu.MainSystem:
    """1 kg on a spring, 1 m out of its place."""
    mbs = system()
    node = mbs.AddNode(Node1D(referenceCoordinates=[0], initialCoordinates=[1.0]))
    mbs.AddObject(ObjectMass1D(nodeNumber=node, mass=1.0))
    _spring(mbs, node, stiffness)
    return mbs


def _spring(mbs: exu.MainSystem, node: object, stiffness: float) -> object:
    ground = mbs.AddNode(NodePointGround())
    markers = [mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=n, coordinate=0)) for n in (ground, node)]
    return mbs.AddObject(CoordinateSpringDamper(markerNumbers=markers, stiffness=stiffness))


# --- success flags -----------------------------------------------------------------------------------
@pytest.mark.parametrize("solver", EXPLICIT)
def test_explicit_solvers_call_an_explosion_a_success(solver: str) -> None:
    """h omega = 10: why `solve` looks at the state itself."""
    mbs = oscillator(1e4)
    assert solved(mbs, solver, end=10.0, steps=100)
    assert not np.abs(mbs.systemData.GetODE2Coordinates()).max() < 1e50


def test_explicit_solvers_call_nan_a_success() -> None:
    mbs = system()
    node = mbs.AddNode(NodePoint())
    mbs.AddObject(ObjectMassPoint(mass=1.0, nodeNumber=node))
    marker = mbs.AddMarker(MarkerNodePosition(nodeNumber=node))

    def force(mbs: object, t: float, load: object) -> list[float]:
        return [float("nan") if t > 0.05 else 1.0, 0, 0]

    mbs.AddLoad(Force(markerNumber=marker, loadVector=[1, 0, 0], loadVectorUserFunction=force))
    assert solved(mbs, "VelocityVerlet", end=0.1, steps=100)
    assert np.isnan(mbs.systemData.GetODE2Coordinates()[0])


@pytest.mark.parametrize("solver", ["GeneralizedAlpha", "VelocityVerlet"])
def test_a_run_that_was_stopped_is_called_a_success(solver: str) -> None:
    """Why `solve` compares the time reached with the end time."""
    mbs = oscillator(1.0)
    mbs.SetPreStepUserFunction(lambda mbs, t: t < 0.05)
    assert solved(mbs, solver, end=0.1, steps=100)
    assert mbs.systemData.GetTime() < 0.06


def test_exudyns_own_time_limit_ends_with_success() -> None:
    """Why `--time-limit` uses a process of its own."""
    mbs = oscillator(1.0)
    before = exu.special.solver.timeout
    exu.special.solver.timeout = 0.05
    try:
        assert solved(mbs, "VelocityVerlet", end=1e3, steps=10**8)
    finally:
        exu.special.solver.timeout = before
    assert mbs.systemData.GetTime() < 1e3


CHATTER = """
import exudyn as exu, numpy as np
from exudyn.itemInterface import *
exu.config.printToConsole = False
mbs = exu.SystemContainer().AddSystem()
node = mbs.AddNode(Node1D(referenceCoordinates=[0], initialVelocities=[1.0]))
mbs.AddObject(ObjectMass1D(nodeNumber=node, mass=1.0))
marker = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
def friction(mbs, t, load):
    return float(2 - 100 * np.sign(mbs.systemData.GetODE2Coordinates_t()[0]))
mbs.AddLoad(LoadCoordinate(markerNumber=marker, load=0, loadUserFunction=friction))
mbs.Assemble()
exu.special.solver.timeout = 0.5
settings = exu.SimulationSettings()
settings.solution.file.write = False
settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = 1.0, 100
settings.timeIntegration.relativeTolerance = settings.timeIntegration.absoluteTolerance = 1e-10
print("begun", flush=True)
mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.DOPRI5)
"""


def test_adaptive_explicit_solver_never_returns_from_friction() -> None:
    """It rejects the same step for ever, and does not look at its time limit: only a kill ends it."""
    process = subprocess.Popen([sys.executable, "-c", CHATTER], stdout=subprocess.PIPE, text=True)
    assert process.stdout
    try:
        assert process.stdout.readline().strip() == "begun"
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(2.5)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


# --- constraints and set-points ----------------------------------------------------------------------
@pytest.mark.parametrize(("solver", "reached"), [("GeneralizedAlpha", 1.0), ("VelocityVerlet", 0.0)])
def test_explicit_solvers_hold_a_moving_constraint_still(solver: str, reached: float) -> None:
    """Why no explicit solver is offered: the rig's drive is such a constraint."""
    mbs = system()
    node = mbs.AddNode(Node1D(referenceCoordinates=[0]))
    mbs.AddObject(ObjectMass1D(nodeNumber=node, mass=1.0))
    ground = mbs.AddNode(NodePointGround())
    markers = [mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=n, coordinate=0)) for n in (ground, node)]
    mbs.AddObject(
        CoordinateConstraint(
            markerNumbers=markers, offset=1.0, offsetUserFunction=lambda mbs, t, item, offset: t / 0.1
        )
    )
    assert solved(mbs, solver, end=0.1, steps=100)
    assert mbs.systemData.GetODE2Coordinates()[0] == pytest.approx(reached, abs=1e-9)


@pytest.mark.parametrize(
    ("solver", "lag"), [("VelocityVerlet", 0.0), ("RK44", 0.5), ("ExplicitMidpoint", 0.5)]
)
def test_a_set_point_written_before_the_step_misleads_multi_stage_solvers(solver: str, lag: float) -> None:
    """A heavy mass at rest on a spring whose other end moves: its momentum is the integral of the force.

    Stages see the value of the step's end: the force is wrong by k v h / 2.
    """
    stiffness, speed, steps, end = 1e3, 1.0, 50, 0.1
    mbs = system()
    node = mbs.AddNode(Node1D(referenceCoordinates=[0]))
    mbs.AddObject(ObjectMass1D(nodeNumber=node, mass=1e6))
    spring = _spring(mbs, node, stiffness)

    def move(mbs: exu.MainSystem, t: float) -> bool:
        mbs.SetObjectParameter(spring, "offset", speed * t)
        return True

    mbs.SetPreStepUserFunction(move)
    assert solved(mbs, solver, end, steps)
    momentum = 1e6 * mbs.systemData.GetODE2Coordinates_t()[0]
    surplus = momentum - stiffness * speed * end**2 / 2
    assert surplus / (stiffness * speed * end * end / steps) == pytest.approx(lag, abs=0.02)


def test_spring_between_separate_markers_makes_a_free_moment() -> None:
    """Force and opposite force at two places, and no couple: why the sliding fit has arms of its own."""
    mbs = system()
    rigid = [
        mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[x, 0, 0, 0, 0, 0], initialVelocities=[0] * 6))
        for x in (0.0, 1.0)
    ]
    bodies = [
        mbs.AddObject(ObjectRigidBody(mass=1.0, inertia=[1, 1, 1, 0, 0, 0], nodeNumber=node))
        for node in rigid
    ]
    markers = [mbs.AddMarker(MarkerBodyRigid(bodyNumber=body)) for body in bodies]
    mbs.AddObject(
        RigidBodySpringDamper(
            markerNumbers=markers,
            stiffness=np.diag([0.0, 10, 0, 0, 0, 0]),
            offset=[0.0, 1, 0, 0, 0, 0],
            damping=np.zeros((6, 6)),
        )
    )
    assert solved(mbs, "RK44", end=0.01, steps=10)
    v = mbs.systemData.GetODE2Coordinates_t()
    spin = v[7] * 1.0 + v[5] + v[11]  # m x v_y about the origin, and both spins
    force = v[1] / 0.01
    assert abs(force) == pytest.approx(10.0, rel=1e-2)
    assert spin / 0.01 == pytest.approx(-force * 1.0, rel=1e-2)  # 0 if momentum were conserved


# --- node types --------------------------------------------------------------------------------------
def twisted(node: object, solver: str) -> float:
    """Rotation after 1000 steps at a constant rate that turns 1e-9 rad in each."""
    mbs = system()
    number = mbs.AddNode(node)
    body = mbs.AddObject(ObjectRigidBody(mass=1.0, inertia=[1, 1, 1, 0, 0, 0], nodeNumber=number))
    marker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=body))
    mbs.AddLoad(Torque(markerNumber=marker, loadVector=[0, 0, 0]))
    mbs.AddObject(ObjectGround())
    assert solved(mbs, solver, end=1.0, steps=1000)
    return float(mbs.systemData.GetODE2Coordinates()[5])


RATE = [0.0, 0, 0, 0, 0, 1e-6]


def test_lie_group_nodes_lose_small_rotations() -> None:
    """Why no body has one."""
    zero = [0.0] * 6
    rxyz = NodeRigidBodyRxyz(referenceCoordinates=zero, initialVelocities=RATE)
    lie = NodeRigidBodyRotVecLG(referenceCoordinates=zero, initialVelocities=RATE)
    assert twisted(rxyz, "RK44") == pytest.approx(1e-6, rel=1e-6)
    assert abs(twisted(lie, "RK44")) < 1e-8


def test_explicit_solvers_refuse_euler_parameters() -> None:
    """The only failure that they report."""
    mbs = system()
    node = mbs.AddNode(NodeRigidBodyEP(referenceCoordinates=[0, 0, 0, 1, 0, 0, 0], initialVelocities=[0] * 7))
    mbs.AddObject(ObjectRigidBody(mass=1.0, inertia=[1, 1, 1, 0, 0, 0], nodeNumber=node))
    with pytest.raises(exu.ExudynError):
        solved(mbs, "VelocityVerlet", end=0.1, steps=10)


# --- defaults ----------------------------------------------------------------------------------------
def test_defaults_that_decide_results() -> None:
    """They changed between releases: why `solve` sets each of them."""
    time = exu.SimulationSettings().timeIntegration
    assert time.newton.useModifiedNewton
    assert (time.newton.relativeTolerance, time.newton.absoluteTolerance) == (1e-8, 1e-10)
    assert time.adaptiveStep
    assert time.minimumStepSize == 1e-8
    assert time.discontinuous.iterationTolerance == 1
    assert time.generalizedAlpha.computeInitialAccelerations
