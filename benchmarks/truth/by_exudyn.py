"""The problems in Exudyn: general contact of spheres and triangles, explicit steps."""

from time import process_time
from typing import Any

import numpy as np

from benchmarks.truth.problem_files import corners
from benchmarks.truth.problems import ALONG, UP, Body, Box, Motion, Scene
from benchmarks.truth.soft_feet import SoftFeet

COORDINATES = {("slide", ALONG): 0, ("slide", UP): 2, ("hinge", UP): 5}
"""Freedom -> coordinate of a node: three places, three angles."""
RECORDED = 4000  # instants
FACES = [[0, 1, 2], [0, 2, 3]]  # of a plate's upper face
HARDER = 1e3  # plates than feet, so that the feet's stiffness counts


class Exudyn(SoftFeet):
    """Exudyn with settings."""

    def run(self, scene: Scene) -> tuple[Motion, float]:
        """Return the motion and the CPU time of its loop [s].

        Raises:
            ArithmeticError: the motion is not finite.
        """
        import exudyn as exu
        from exudyn.itemInterface import SensorNode

        mbs = exu.SystemContainer().AddSystem()
        nodes = self._build(mbs, scene)
        freedoms = {freedom.name: (body, freedom) for body in scene.bodies for freedom in body.freedoms}
        body, freedom = freedoms[scene.observed]
        node, coordinate = nodes[body.name], COORDINATES[freedom.kind, freedom.axis]
        if scene.drive:
            _drive(mbs, scene, node, coordinate)
        kinds = exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t
        sensors = [
            mbs.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind))
            for kind in kinds
        ]
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = scene.seconds / RECORDED
        settings.timeIntegration.endTime = scene.seconds
        settings.timeIntegration.numberOfSteps = int(np.ceil(scene.seconds / self.step(scene)))
        start = process_time()
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.VelocityVerlet)
        spent = process_time() - start
        places, rates = (np.asarray(mbs.GetSensorStoredData(sensor)) for sensor in sensors)
        time, place, rate = places[:, 0], places[:, 1 + coordinate], rates[:, 1 + coordinate]
        if not np.isfinite(place).all():
            raise ArithmeticError("Exudyn: the motion is not finite")
        force = np.zeros(len(time))
        if scene.drive:
            ends = np.array([scene.drive.target(each) for each in time])
            force = scene.drive.stiffness * (ends - place) - scene.drive.damping * rate
        return Motion(time, place, rate, force), spent

    def _build(self, mbs: Any, scene: Scene) -> dict[str, int]:
        """Add bodies and contact; return the bodies' nodes."""
        from exudyn.itemInterface import MarkerBodyRigid, ObjectGround

        ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
        contact = mbs.AddGeneralContact()
        contact.sphereSphereContact = False
        contact.frictionProportionalZone = self.zone
        contact.SetFrictionPairings([[scene.friction]])
        contact.SetSearchTreeBox(pMin=[-0.6, -0.1, -0.05], pMax=[0.6, 0.1, 0.1])
        contact.SetSearchTreeCellSize(numberOfCells=[40, 10, 10])
        nodes = {}
        hardest = max(self.stiffness(scene, body) for body in scene.bodies)

        def add_plates(boxes: tuple[Box, ...], frame: int) -> None:
            for box in boxes:
                contact.AddTrianglesRigidBodyBased(frame, HARDER * hardest, 0.0, 0, corners(box), FACES)

        for body in scene.bodies:
            nodes[body.name], number = _add(mbs, body, scene)
            stiffness = self.stiffness(scene, body)
            damping = self.damping(scene, body)
            for foot in body.feet:
                marker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=number, localPosition=foot))
                contact.AddSphereWithMarker(marker, body.foot_radius, stiffness, damping, 0)
            add_plates(body.boxes, mbs.AddMarker(MarkerBodyRigid(bodyNumber=number)))
        add_plates(scene.ground, ground)
        return nodes


def _still(mbs: Any) -> int:
    from exudyn.itemInterface import MarkerNodeCoordinate, NodePointGround

    number: int = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()), coordinate=0))
    return number


def _drive(mbs: Any, scene: Scene, node: int, coordinate: int) -> None:
    """Add the spring as one to the ground, and the force of its moved end."""
    from exudyn.itemInterface import CoordinateSpringDamper, LoadCoordinate, MarkerNodeCoordinate

    drive = scene.drive
    assert drive is not None
    marker = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
    spring = {"stiffness": drive.stiffness, "damping": drive.damping}
    mbs.AddObject(CoordinateSpringDamper(markerNumbers=[_still(mbs), marker], **spring))

    def pull(_: Any, time: float, __: float) -> float:
        return drive.stiffness * drive.target(time)

    mbs.AddLoad(LoadCoordinate(markerNumber=marker, load=0.0, loadUserFunction=pull))


def _add(mbs: Any, body: Body, scene: Scene) -> tuple[int, int]:
    """Add a body that moves along its freedoms alone; return its node and its number."""
    from exudyn.itemInterface import (
        CoordinateConstraint,
        LoadMassProportional,
        MarkerBodyMass,
        MarkerNodeCoordinate,
        NodeRigidBodyRxyz,
        ObjectRigidBody,
    )

    node = mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[*body.place, 0, 0, 0]))
    inertia = [body.inertia] * 3 + [0.0] * 3
    number = mbs.AddObject(ObjectRigidBody(mass=body.mass, inertia=inertia, nodeNumber=node))
    mass = mbs.AddMarker(MarkerBodyMass(bodyNumber=number))
    mbs.AddLoad(LoadMassProportional(markerNumber=mass, loadVector=list(scene.gravity)))
    still, free = _still(mbs), {COORDINATES[each.kind, each.axis] for each in body.freedoms}
    for coordinate in set(range(6)) - free:
        marker = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        mbs.AddObject(CoordinateConstraint(markerNumbers=[still, marker]))
    return node, number
