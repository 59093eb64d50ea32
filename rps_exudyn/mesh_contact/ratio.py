"""The kinematic ratio: the ready-made gear joint, which knows the gain and nothing else of the teeth.

It couples x = gain phi stiffly and guides the rack in all other directions. There are no losses in the mesh,
no ripple and no backlash; a constant loss torque can be added, for instance the closed form's. It shows what
such a joint misses, and where it suffices.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import constant_drag
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear

COUPLING = 1e9  # stiffness in place of rigidity [N/m]
GUIDE = 1e5  # against rotations of the rack [N m/rad]


class RatioData(NamedTuple):
    """Constants of the kinematic ratio."""

    gain: float  # rack travel per radian [m]
    loss: float  # constant loss torque [N m]
    zone: float  # pinion rate below which it falls linearly to zero [rad/s]


@kernel
def ratio_force(q, v, data):  # type: ignore[no-untyped-def]
    """Coupling, guide and loss; q = pinion (1), rack (6)."""
    out = np.zeros(7 + 3)
    slip = q[1] + data.gain * q[0]  # the pinion's coordinate counts about k, against the steering angle
    loss = constant_drag(data.loss, v[0], data.zone)
    out[0] = -data.gain * COUPLING * slip - loss
    out[1] = -COUPLING * slip
    out[2:4] = -COUPLING * q[2:4]
    out[4:7] = -GUIDE * q[4:7]
    out[7] = 0.5 * COUPLING * (slip**2 + q[2] ** 2 + q[3] ** 2)
    out[7] += 0.5 * GUIDE * (q[4] ** 2 + q[5] ** 2 + q[6] ** 2)
    out[8] = loss * v[0]
    return out


def ratio_element(gear: SteeringGear, loss: float = 0.0) -> ForceElement:
    """The ratio, with a constant loss torque of the mesh [N m].

    Raises:
        InputError: the pinion has a runout.
    """
    if gear.pinion.runout > 0:
        raise InputError(
            f"pinion.runout is {1e6 * gear.pinion.runout:g} um; the kinematic ratio knows no runout: "
            "it must be 0, or fidelity.mesh another."
        )
    data = RatioData(float(GearPair.of(gear).gain), loss, 0.01 * gear.test.speed)
    return ForceElement("mesh", ("pinion", "rack"), ratio_force, data)
