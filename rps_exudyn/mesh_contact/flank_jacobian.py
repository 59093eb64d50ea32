"""How the flank contact's forces change with the coordinates and their rates, for Newton's method.

Forward differences inside the compiled code. Steps are far below the penetration (some 1e-6 m) and far
above rounding; the result is good to about step / penetration, 1e-3 of its largest entries.
"""

import numpy as np

from rps_exudyn.compiled import kernel
from rps_exudyn.mesh_contact.flank_contact import flank_contact
from rps_exudyn.mesh_contact.wrench import FORCE, MOMENT, TORQUE

OUTPUTS = 7  # torque on the pinion about k, force and moment on the rack
COORDINATES = 7  # pinion angle, rack position, rack rotation vector in the housing frame

SHIFT = 1e-9  # [m]
TURN = 1e-7  # [rad], some 1e-9 m at the teeth
RATE_SHARE = 1e-4  # of the sliding speed


@kernel
def flank_jacobian(angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """d (torque, force, moment) / d (coordinates, rates), shape (7, 14), and the wrench, shape (14,).

    Rates are the pinion's, the rack's velocity and its angular velocity.
    """
    wrench = flank_contact(angle, rate, position, rotation, velocity, spin, data)
    jacobian = np.empty((OUTPUTS, 2 * COORDINATES))
    fast = RATE_SHARE * max(abs(velocity[0]), abs(velocity[1]), abs(velocity[2]), 1e-6)
    for column in range(2 * COORDINATES):
        i = column % COORDINATES
        a, p, r, w, v, s = angle, position, rotation, rate, velocity, spin
        if column < COORDINATES:
            step = SHIFT if 1 <= i <= 3 else TURN
            if i == 0:
                a += step
            elif i <= 3:
                p = position.copy()
                p[i - 1] += step
            else:
                r = _turned(rotation, i - 4, step)
        else:
            step = fast if 1 <= i <= 3 else 100 * fast
            if i == 0:
                w += step
            elif i <= 3:
                v = velocity.copy()
                v[i - 1] += step
            else:
                s = spin.copy()
                s[i - 4] += step
        other = flank_contact(a, w, p, r, v, s, data)
        jacobian[0, column] = (other[TORQUE] - wrench[TORQUE]) / step
        for k in range(3):
            jacobian[1 + k, column] = (other[FORCE.start + k] - wrench[FORCE.start + k]) / step
            jacobian[4 + k, column] = (other[MOMENT.start + k] - wrench[MOMENT.start + k]) / step
    return jacobian, wrench


@kernel
def _turned(rotation, axis, step):  # type: ignore[no-untyped-def]
    """The rotation followed by a turn about a housing axis."""
    cos, sin = np.cos(step), np.sin(step)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    turned = rotation.copy()
    turned[j] = cos * rotation[j] - sin * rotation[k]
    turned[k] = sin * rotation[j] + cos * rotation[k]
    return turned
