"""Objects of the Exudyn system: pinion, rack, plunger and yokenut with masses, forces, bush segments."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np
from exudyn import graphics
from exudyn import itemInterface as items

from rps_exudyn.forces.bush import Chain, housing_station
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.forces.friction import TIME
from rps_exudyn.gears import masses, solids
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.multibody.secant import Secant
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import SIZE

if TYPE_CHECKING:
    from rps_exudyn.gears.polyhedron import Solid

COLOURS = {  # by their names in CSS, as red, green and blue
    "steelblue": (70 / 255, 130 / 255, 180 / 255),
    "grey": (128 / 255, 128 / 255, 128 / 255),
    "orange": (1.0, 165 / 255, 0.0),
    "darkgrey": (169 / 255, 169 / 255, 169 / 255),
}
ALONG_Y = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # ObjectMass1D moves along its local x


def add_bodies(model: SteeringModel) -> None:
    """Add all bodies but the bush; pinion, rack and plunger start where the model starts."""
    axis = [0.0, GearPair.of(model.gear).bar_axis_height, 0.0]
    _add_pinion(model)
    _add_rack(model, axis)
    _add_plunger(model, axis)
    _add_yokenut(model, axis)
    if model.modes:
        _add_generic(model, "modes", slice(SIZE, SIZE + model.modes))
    if held := len(model.forces.supported):
        _add_generic(model, "supports", slice(-held, None))


def _add_pinion(model: SteeringModel) -> None:
    drawing = shapes_of(model, solids.pinion_solid, "steelblue")
    add_turning_mass(model, "pinion", masses.pinion_inertia(model.gear), _start(model, "pinion"), drawing)


def add_turning_mass(
    model: SteeringModel, name: str, inertia: float, start: tuple[Any, Any], drawing: Sequence[Any] = ()
) -> None:
    """Add a body that turns about the pinion's axis; place and rate of its start are rows (1,)."""
    pair = GearPair.of(model.gear)
    model.nodes[name] = _node_1d(model, *start)
    model.bodies[name] = model.mbs.AddObject(
        items.ObjectRotationalMass1D(
            inertia=inertia,
            nodeNumber=model.nodes[name],
            referencePosition=pair.pinion_origin,
            referenceRotation=pair.pinion_frame,
            visualization=items.VObjectRotationalMass1D(graphicsData=list(drawing)),
        )
    )


def _add_rack(model: SteeringModel, axis: list[float]) -> None:
    place, rate = _start(model, "rack")
    model.nodes["rack"] = model.mbs.AddNode(
        items.NodeRigidBodyRxyz(
            referenceCoordinates=[*axis, 0, 0, 0], initialCoordinates=place, initialVelocities=rate
        )
    )
    bar = masses.rack_masses(model.gear)
    com = bar.centre_of_mass
    about_reference = bar.inertia + bar.mass * ((com @ com) * np.eye(3) - np.outer(com, com))
    model.bodies["rack"] = model.mbs.AddObject(
        items.ObjectRigidBody(
            mass=bar.mass,
            centerOfMass=com,
            inertia=six_moments(about_reference),
            nodeNumber=model.nodes["rack"],
            visualization=items.VObjectRigidBody(graphicsData=shapes_of(model, solids.rack_solid, "grey")),
        )
    )


def _add_plunger(model: SteeringModel, axis: list[float]) -> None:
    drawing = shapes_of(model, solids.plunger_solid, "orange", ALONG_Y.T)
    model.nodes["plunger"] = _node_1d(model, *_start(model, "plunger"))
    model.bodies["plunger"] = model.mbs.AddObject(
        items.ObjectMass1D(
            mass=model.gear.yoke.plunger_mass,
            nodeNumber=model.nodes["plunger"],
            referencePosition=axis,
            referenceRotation=ALONG_Y,
            visualization=items.VObjectMass1D(graphicsData=drawing),
        )
    )


def _add_generic(model: SteeringModel, name: str, columns: slice) -> None:
    """Add the node of the rack's modes of bending, or of the pinion's supports, which start in these columns
    of the start's coordinates; the object of the gear's forces has their masses."""
    place, rate = (rows[0, columns] for rows in (model.start.coordinates, model.start.rates))
    model.nodes[name] = model.mbs.AddNode(
        items.NodeGenericODE2(
            numberOfODE2Coordinates=place.size,
            referenceCoordinates=np.zeros(place.size),
            initialCoordinates=place,
            initialCoordinates_t=rate,
        )
    )


def _add_yokenut(model: SteeringModel, axis: list[float]) -> None:
    drawing = items.VObjectGround(graphicsData=shapes_of(model, solids.yokenut_solid, "darkgrey"))
    model.bodies["yokenut"] = model.mbs.AddObject(
        items.ObjectGround(referencePosition=axis, visualization=drawing)
    )


def _node_1d(model: SteeringModel, place: Any, rate: Any) -> Any:
    return model.mbs.AddNode(
        items.Node1D(referenceCoordinates=[0.0], initialCoordinates=place, initialVelocities=rate)
    )


def coordinate_marker(model: SteeringModel, node: Any, coordinate: int = 0) -> Any:
    """Add a marker of one of a node's coordinates; return its number."""
    return model.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))


def _start(model: SteeringModel, body: str) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and rates of a body where the model starts."""
    block = COORDINATE_BLOCKS[body]
    return model.start.coordinates[0, block], model.start.rates[0, block]


def shapes_of(
    model: SteeringModel,
    solid_of: "Callable[[SteeringGear], Solid]",
    color: str,
    rotation: np.ndarray | None = None,
) -> list[Any]:
    """Return graphics data of a body, its solid turned by `rotation` (3, 3); none without pictures."""
    if not model.pictured:
        return []
    solid = solid_of(model.gear)
    points = solid.vertices if rotation is None else solid.vertices @ rotation.T
    return [graphics.FromPointsAndTrigs(points, solid.faces, color=[*COLOURS[color], 1.0])]


# --- Inertia tensors in Exudyn's order


def six_moments(inertia: np.ndarray) -> np.ndarray:
    """The components xx, yy, zz, yz, xz, xy of an inertia tensor (3, 3) [kg m^2], shape (6,)."""
    return inertia[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]


# --- A force element as an Exudyn object: an `ObjectGenericODE2`, massless but for modes of bending. Unlike a
# connector between separated markers it carries its own lever arms, so moments balance exactly.


def add_forces(
    mbs: exu.MainSystem,
    nodes: Sequence[Any],
    size: int,
    force_of: Callable[[np.ndarray, np.ndarray], np.ndarray],
    tangent_of: Callable[[np.ndarray, np.ndarray, float, float], np.ndarray],
    *,
    memory: np.ndarray | None = None,
    mass: np.ndarray | None = None,
    applied: Callable[[float], np.ndarray] | None = None,
) -> Any:
    """Add an object with a law of forces, and its Jacobian, over the coordinates of some nodes.

    Args:
        mbs: the system.
        nodes: whose coordinates the law takes, one after the other.
        size: number of coordinates.
        force_of: (q, v) -> forces (size,), a new array each time.
        tangent_of: (q, v, factor_q, factor_v) -> factor_q dF/dq + factor_v dF/dv, shape (size, size).
        memory: state of the bristle friction, where the time at which a step ends is set.
        mass: of these coordinates besides that of their bodies, shape (size, size); none by default.
        applied: forces (size,) at a time [s] that act besides.
    """
    secant = Secant()

    def force(mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]) -> np.ndarray:
        if memory is not None:
            memory[1, TIME] = t
        rates = np.array(v)  # Exudyn uses its arrays again
        total = secant.recorded(t, rates, force_of(np.asarray(q), rates))
        return total if applied is None else total + applied(t)

    def jacobian(
        mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float], fq: float, fv: float
    ) -> np.ndarray:
        if memory is not None:
            memory[1, TIME] = t
        tangent = secant.corrected(tangent_of(np.asarray(q), np.asarray(v), fq, fv), t, fv)
        # an iteration may leave the law's range: Exudyn repeats such a step in a shorter one, but ends with
        # an error if the Jacobian before cannot be factorized
        return -tangent if np.isfinite(tangent.sum()) else np.zeros_like(tangent)  # of the left-hand side

    return mbs.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((size, size)) if mass is None else mass,
            forceUserFunction=force,
            jacobianUserFunction=jacobian,
            visualization=items.VObjectGenericODE2(show=False),
        )
    )


# --- The bush as bodies and springs


def add_chain(
    mbs: exu.MainSystem,
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
    centres = housing_station(gear, chain.centres)
    moments = six_moments(inertia)
    nodes, bodies = [], []
    for x, start in zip(centres, rest, strict=True):
        node = mbs.AddNode(
            items.NodeRigidBodyRxyz(
                referenceCoordinates=[x, axis_height, 0, 0, 0, 0], initialCoordinates=start
            )
        )
        nodes.append(node)
        bodies.append(mbs.AddObject(items.ObjectRigidBody(mass=mass, inertia=moments, nodeNumber=node)))

    housing = mbs.AddObject(items.ObjectGround())

    def marker(segment: int, x: float) -> Any:
        body, place = (
            (bodies[segment], [x - centres[segment], 0, 0])
            if segment >= 0
            else (housing, [x, axis_height, 0])
        )
        return mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=place))

    for connection in chain.connections:
        x = housing_station(gear, connection.station)
        markers = [marker(connection.before, x), marker(connection.after, x)]
        mbs.AddObject(
            items.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=markers,
                stiffness=np.diag(connection.stiffness),
                visualization=items.VObjectConnectorRigidBodySpringDamper(show=False),
            )
        )
    return nodes, bodies
