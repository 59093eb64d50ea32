"""The bush as bodies and springs of an Exudyn system."""

from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.forces.bush import Chain, housing_station
from rps_exudyn.multibody.bodies import six_moments
from rps_exudyn.parameters.gear import SteeringGear

if TYPE_CHECKING:
    import exudyn


def add_chain(
    mbs: "exudyn.MainSystem",
    gear: SteeringGear,
    chain: Chain,
    rest: np.ndarray,
    *,
    mass: float,
    inertia: np.ndarray,
    axis_height: float,
) -> tuple[list[Any], list[Any]]:
    """Add segments and springs to an Exudyn system; returns the segments' nodes and bodies.

    `rest` (N, 6) is where they start; each has `mass` [kg] and `inertia` (3, 3) [kg m^2] about its centre.
    Springs sit at one point of both neighbours, so that the pair of forces has no free moment.
    """
    from exudyn.itemInterface import (
        MarkerBodyRigid,
        NodeRigidBodyRxyz,
        ObjectConnectorRigidBodySpringDamper,
        ObjectGround,
        ObjectRigidBody,
        VObjectConnectorRigidBodySpringDamper,
    )

    centres = housing_station(gear, chain.centres)
    moments = six_moments(inertia)
    nodes, bodies = [], []
    for x, start in zip(centres, rest, strict=True):
        node = mbs.AddNode(
            NodeRigidBodyRxyz(referenceCoordinates=[x, axis_height, 0, 0, 0, 0], initialCoordinates=start)
        )
        nodes.append(node)
        bodies.append(mbs.AddObject(ObjectRigidBody(mass=mass, inertia=moments, nodeNumber=node)))

    housing = mbs.AddObject(ObjectGround())

    def marker(segment: int, x: float) -> Any:
        body, place = (
            (bodies[segment], [x - centres[segment], 0, 0])
            if segment >= 0
            else (housing, [x, axis_height, 0])
        )
        return mbs.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=place))

    for connection in chain.connections:
        x = housing_station(gear, connection.station)
        markers = [marker(connection.before, x), marker(connection.after, x)]
        mbs.AddObject(
            ObjectConnectorRigidBodySpringDamper(
                markerNumbers=markers,
                stiffness=np.diag(connection.stiffness),
                visualization=VObjectConnectorRigidBodySpringDamper(show=False),
            )
        )
    return nodes, bodies
