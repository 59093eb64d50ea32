"""The pinion's bearings: friction against its rotation, of constant size and by the load of its supports."""

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.forces.force_element import FRICTION_STATE, Part
from rps_exudyn.forces.friction import (
    LAW,
    Patches,
    constant_drag,
    law_of,
    rubbing,
    slide,
    slide_slopes,
    stribeck,
    stribeck_slope,
)
from rps_exudyn.parameters.gear import SteeringGear

BEARING = record_type(
    [
        ("torque", "f8"),  # of constant size [N m]
        ("friction", "f8"),  # coefficient, under the radial forces of a supported pinion
        ("zone", "f8"),  # friction zone [rad/s]
        ("radius", "f8"),  # of the shaft, on which it slides [m]
        ("law", LAW),
    ]
)
"""Record of the bearings' friction."""

PART = Part("bearing", ("pinion",), ("bearing_torque", *FRICTION_STATE))


@inline
def bearing_force(rate, load, data, memory, out):  # type: ignore[no-untyped-def]
    """Friction torque against the rate under a radial load, linear below the zone; fills out (7,)."""
    law, size = data.law, data.torque + data.friction * data.radius * load
    if law.has_state:
        slip = data.radius * rate
        limit = size / data.radius * stribeck(abs(slip), law)
        drag, _, out[1], out[5] = slide(limit, slip, 0.0, law.place, law, memory)
        torque = drag * data.radius
        out[6] = out[1]
    else:
        torque = constant_drag(size, rate, data.zone) * stribeck(data.radius * abs(rate), law)
        out[1] = out[5] = out[6] = 0.0
    out[0], out[2], out[3], out[4] = -torque, torque * rate, 0.0, torque


@inline
def bearing_slope(rate, load, data, memory):  # type: ignore[no-untyped-def]
    """Derivative of the torque on the pinion by its rate [N m s]."""
    size, zone, law = data.torque / data.radius + data.friction * load, data.radius * data.zone, data.law
    slip = data.radius * rate
    if law.has_state:
        g, fall = stribeck(abs(slip), law), size * stribeck_slope(abs(slip), law)
        ahead, _, _, _, _, _, _, _ = slide_slopes(size * g, slip, 0.0, fall, law.place, law, memory)
    else:
        _, _, ahead, _, _, _ = rubbing(slip, 0.0, size, zone, law)
    return -ahead * data.radius * data.radius


def bearing_record(gear: SteeringGear, *, friction_zone: float, patches: Patches) -> np.record:
    """Return the record of the friction of the pinion's bearings and seal."""
    bearing, radius = gear.bearing, gear.pinion.shaft_diameter / 2
    usual = bearing.friction_torque / radius + bearing.friction * gear.yoke.preload
    return record(
        BEARING,
        torque=bearing.friction_torque,
        friction=bearing.friction,
        zone=friction_zone,
        radius=radius,
        law=law_of(bearing, patches, usual),
    )
