"""The pinion's bearings: friction of constant size against its rotation."""

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.forces.force_element import Part
from rps_exudyn.forces.friction import (
    LAW,
    bristle,
    clear,
    constant_drag,
    law_of,
    rubbing,
    stored,
    stribeck,
)
from rps_exudyn.forces.memory import Patches
from rps_exudyn.parameters.gear import SteeringGear

BEARING = record_type(
    [
        ("torque", "f8"),  # [N m]
        ("zone", "f8"),  # friction zone [rad/s]
        ("radius", "f8"),  # of the shaft, on which it slides [m]
        ("law", LAW),
    ]
)
"""Record of the bearings' friction."""

PART = Part("bearing", ("pinion",), ("bearing_torque",))


@inline
def bearing_force(rate, data, memory, out):  # type: ignore[no-untyped-def]
    """Friction torque against the pinion's rate, linear below the zone; fills out (5,)."""
    law = data.law
    if law.has_state:
        load = data.torque / data.radius
        clear(law.place, memory)
        drag, _, lost = bristle(1.0, data.radius * rate, 0.0, law.place, load, law, memory)
        torque = drag * data.radius
        out[1], out[2] = stored(law.place, load, law, memory), lost
    else:
        torque = constant_drag(data.torque, rate, data.zone) * stribeck(data.radius * abs(rate), law)
        out[1], out[2] = 0.0, torque * rate
    out[0], out[3], out[4] = -torque, 0.0, torque


@inline
def bearing_slope(rate, data, memory):  # type: ignore[no-untyped-def]
    """Derivative of the torque on the pinion by its rate [N m s]."""
    load, zone, law = data.torque / data.radius, data.radius * data.zone, data.law
    _, _, ahead, _, _, _ = rubbing(data.radius * rate, 0.0, law.place, load, zone, law, memory)
    return -ahead * data.radius * data.radius


def bearing_record(gear: SteeringGear, *, friction_zone: float, patches: Patches) -> np.record:
    """Return the record of the friction of the pinion's bearings and seal."""
    return record(
        BEARING,
        torque=gear.bearing.friction_torque,
        zone=friction_zone,
        radius=gear.pinion.shaft_diameter / 2,
        law=law_of(gear.bearing, patches),
    )
