"""The pinion's bearings: friction of constant size against its rotation."""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import (
    BRISTLE,
    STRIBECK,
    Law,
    bristle,
    clear,
    constant_drag,
    law_of,
    stored,
    stribeck,
)
from rps_exudyn.forces.memory import Memory
from rps_exudyn.parameters.gear import SteeringGear


class BearingData(NamedTuple):
    """Constants of the bearings' friction."""

    torque: float  # [N m]
    zone: float  # friction zone [rad/s]
    radius: float  # of the shaft, on which it slides [m]
    law: Law


@kernel
def bearing_force(q, v, data):  # type: ignore[no-untyped-def]
    """Friction torque, linear below the zone; q = pinion (1)."""
    law = data.law
    if law.kind == BRISTLE:
        clear(law.place, law)
        drag, _, lost = bristle(1.0, data.radius * v[0], 0.0, law.place, data.torque / data.radius, law)
        torque = drag * data.radius
        return np.array([-torque, stored(law.place, data.torque / data.radius, law), lost, 0.0, torque])
    torque = constant_drag(data.torque, v[0], data.zone)
    if law.kind == STRIBECK:
        torque *= stribeck(data.radius * abs(v[0]), law)
    return np.array([-torque, 0.0, torque * v[0], 0.0, torque])


def bearing(gear: SteeringGear, *, friction_zone: float, memory: Memory) -> ForceElement:
    """Friction of the pinion's bearings and seal."""
    law, radius = law_of(gear.bearing, memory), gear.pinion.shaft_diameter / 2
    data = BearingData(gear.bearing.friction_torque, friction_zone, radius, law)
    return ForceElement("bearing", ("pinion",), bearing_force, data, ("bearing_torque",))
