"""The kinematic ratio: the ready-made gear joint, which knows the gain and nothing else of the teeth.

It couples x = gain phi stiffly and guides the rack in all other directions. There are no losses in the mesh,
no ripple and no backlash; a constant loss torque can be added, for instance the closed form's. It shows what
such a joint misses, and where it suffices.
"""

import numpy as np

from rps_exudyn.base.compiled import inline, record, record_type
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.friction import constant_drag
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear

COUPLING = 1e9  # stiffness in place of rigidity [N/m]
GUIDE = 1e5  # against rotations of the rack [N m/rad]

RATIO = record_type(
    [
        ("gain", "f8"),  # rack travel per radian [m]
        ("loss", "f8"),  # constant loss torque [N m]
        ("zone", "f8"),  # pinion rate below which it falls linearly to zero [rad/s]
    ]
)
"""Record of the kinematic ratio."""


@inline
def ratio_law(q, v, mesh, pool, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Coupling, guide and loss; q = pinion (1), rack (6), see `laws`."""
    data = mesh.ratio
    slip = q[1] + data.gain * q[0]  # the pinion's coordinate counts about k, against the steering angle
    loss = constant_drag(data.loss, v[0], data.zone)
    for i in range(15):
        out[i] = 0.0
    out[0] = -data.gain * COUPLING * slip - loss
    out[1] = -COUPLING * slip
    for i in range(2):
        out[2 + i] = -COUPLING * q[2 + i]
        tangent[2 + i, 2 + i] -= factor_q * COUPLING
    for i in range(3):
        out[4 + i] = -GUIDE * q[4 + i]
        tangent[4 + i, 4 + i] -= factor_q * GUIDE
    out[7] = 0.5 * COUPLING * (slip**2 + q[2] ** 2 + q[3] ** 2)
    out[7] += 0.5 * GUIDE * (q[4] ** 2 + q[5] ** 2 + q[6] ** 2)
    out[8] = loss * v[0]
    tangent[0, 0] -= factor_q * COUPLING * data.gain * data.gain
    tangent[0, 1] -= factor_q * COUPLING * data.gain
    tangent[1, 0] -= factor_q * COUPLING * data.gain
    tangent[1, 1] -= factor_q * COUPLING
    if abs(v[0]) < data.zone:
        tangent[0, 0] -= factor_v * data.loss / data.zone


def ratio_record(gear: SteeringGear, loss: float = 0.0) -> np.record:
    """Return the record of the ratio, with a constant loss torque of the mesh [N m].

    Raises:
        InputError: the pinion has a runout.
    """
    if gear.pinion.runout > 0:
        raise InputError(
            f"pinion.runout is {1e6 * gear.pinion.runout:g} um; the kinematic ratio has no runout: "
            "it must be 0, or fidelity.mesh another."
        )
    return record(RATIO, gain=float(GearPair.of(gear).gain), loss=loss, zone=0.01 * gear.test.speed)
