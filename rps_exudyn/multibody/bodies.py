"""Pinion, rack, plunger and yokenut as Exudyn bodies, with their masses, and pictures from their solids."""

from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.gears import masses, solids
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.solvers.balance import SIZE

if TYPE_CHECKING:
    from collections.abc import Callable

    from rps_exudyn.gears.polyhedron import Solid
    from rps_exudyn.parameters.gear import SteeringGear

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
        _add_modes(model)


def _add_pinion(model: SteeringModel) -> None:
    from exudyn.itemInterface import ObjectRotationalMass1D, VObjectRotationalMass1D

    pair = GearPair.of(model.gear)
    drawing = shapes_of(model, solids.pinion_solid, "steelblue")
    model.nodes["pinion"] = _node_1d(model, "pinion")
    model.bodies["pinion"] = model.mbs.AddObject(
        ObjectRotationalMass1D(
            inertia=masses.pinion_inertia(model.gear),
            nodeNumber=model.nodes["pinion"],
            referencePosition=pair.pinion_origin,
            referenceRotation=pair.pinion_frame,
            visualization=VObjectRotationalMass1D(graphicsData=drawing),
        )
    )


def _add_rack(model: SteeringModel, axis: list[float]) -> None:
    from exudyn.itemInterface import NodeRigidBodyRxyz, ObjectRigidBody, VObjectRigidBody

    place, rate = _start(model, "rack")
    model.nodes["rack"] = model.mbs.AddNode(
        NodeRigidBodyRxyz(
            referenceCoordinates=[*axis, 0, 0, 0], initialCoordinates=place, initialVelocities=rate
        )
    )
    bar = masses.rack_masses(model.gear)
    com = bar.centre_of_mass
    about_reference = bar.inertia + bar.mass * ((com @ com) * np.eye(3) - np.outer(com, com))
    model.bodies["rack"] = model.mbs.AddObject(
        ObjectRigidBody(
            mass=bar.mass,
            centerOfMass=com,
            inertia=six_moments(about_reference),
            nodeNumber=model.nodes["rack"],
            visualization=VObjectRigidBody(graphicsData=shapes_of(model, solids.rack_solid, "grey")),
        )
    )


def _add_plunger(model: SteeringModel, axis: list[float]) -> None:
    from exudyn.itemInterface import ObjectMass1D, VObjectMass1D

    drawing = shapes_of(model, solids.plunger_solid, "orange", ALONG_Y.T)
    model.nodes["plunger"] = _node_1d(model, "plunger")
    model.bodies["plunger"] = model.mbs.AddObject(
        ObjectMass1D(
            mass=model.gear.yoke.plunger_mass,
            nodeNumber=model.nodes["plunger"],
            referencePosition=axis,
            referenceRotation=ALONG_Y,
            visualization=VObjectMass1D(graphicsData=drawing),
        )
    )


def _add_modes(model: SteeringModel) -> None:
    """Add the node of the rack's modes of bending; the object of the gear's forces has their masses."""
    from exudyn.itemInterface import NodeGenericODE2

    place, rate = (rows[0, SIZE:] for rows in (model.start.coordinates, model.start.rates))
    model.nodes["modes"] = model.mbs.AddNode(
        NodeGenericODE2(
            numberOfODE2Coordinates=model.modes,
            referenceCoordinates=np.zeros(model.modes),
            initialCoordinates=place,
            initialCoordinates_t=rate,
        )
    )


def _add_yokenut(model: SteeringModel, axis: list[float]) -> None:
    from exudyn.itemInterface import ObjectGround, VObjectGround

    drawing = VObjectGround(graphicsData=shapes_of(model, solids.yokenut_solid, "darkgrey"))
    model.bodies["yokenut"] = model.mbs.AddObject(ObjectGround(referencePosition=axis, visualization=drawing))


def _node_1d(model: SteeringModel, body: str) -> Any:
    from exudyn.itemInterface import Node1D

    place, rate = _start(model, body)
    return model.mbs.AddNode(
        Node1D(referenceCoordinates=[0.0], initialCoordinates=place, initialVelocities=rate)
    )


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
    """Return graphics data of a body, its solid turned by `rotation` (3, 3); none of a model without
    pictures."""
    if not model.pictured:
        return []
    from exudyn import graphics

    solid = solid_of(model.gear)
    points = solid.vertices if rotation is None else solid.vertices @ rotation.T
    return [graphics.FromPointsAndTrigs(points, solid.faces, color=[*COLOURS[color], 1.0])]


# --- Inertia tensors in Exudyn's order


def six_moments(inertia: np.ndarray) -> np.ndarray:
    """The components xx, yy, zz, yz, xz, xy of an inertia tensor (3, 3) [kg m^2], shape (6,)."""
    return inertia[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
