"""The pinion's bearings: constant Coulomb friction against its rotation."""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import constant_drag
from rps_exudyn.parameters.gear import SteeringGear


class BearingData(NamedTuple):
    """Constants of the bearings' friction."""

    torque: float  # [N m]
    zone: float  # friction zone [rad/s]


@kernel
def bearing_force(q, v, data):  # type: ignore[no-untyped-def]
    """Friction torque, linear below the zone; q = pinion (1)."""
    torque = constant_drag(data.torque, v[0], data.zone)
    return np.array([-torque, 0.0, torque * v[0], 0.0, torque])


def bearing(gear: SteeringGear, *, friction_zone: float) -> ForceElement:
    """Friction of the pinion's bearings and seal."""
    data = BearingData(gear.bearing.friction_torque, friction_zone)
    return ForceElement("bearing", ("pinion",), bearing_force, data, ("bearing_torque",))
