"""How the rig moves the gear."""

from typing import Any

from rps_exudyn.model import SteeringModel


def turn_pinion(model: SteeringModel) -> None:
    """Prescribe the pinion's rotation, from where the model stands, at the test's speed and direction.

    A rheonomic constraint on the pinion's coordinate, kept as `model.drive`.
    """
    from exudyn.itemInterface import CoordinateConstraint, MarkerNodeCoordinate, NodePointGround

    mbs, test = model.mbs, model.gear.test
    rate = -test.direction * test.speed
    start = float(model.start.coordinates[0, 0])

    def angle(mbs: Any, t: float, item: int, offset: float) -> float:
        return start + rate * t

    def angle_rate(mbs: Any, t: float, item: int, offset: float) -> float:
        return rate

    ground = mbs.AddNode(NodePointGround())
    markers = [
        mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
        for node in (ground, model.nodes["pinion"])
    ]
    model.drive = mbs.AddObject(
        CoordinateConstraint(markerNumbers=markers, offsetUserFunction=angle, offsetUserFunction_t=angle_rate)
    )
