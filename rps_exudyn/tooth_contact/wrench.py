"""The wrench of a contact of the teeth, as all its laws fill it.

Pinion and rack are given by the pinion's rotation `angle` about its axis k and its `rate` [rad, rad/s]
(k-sense: minus the steering angle), the rack's reference point `position` [m], shape (3,), its `rotation`
matrix body -> housing, shape (3, 3), `velocity` [m/s] and angular velocity `spin` [rad/s], all in the housing
frame of `gears.gear_pair`. The rack's reference point is on the bar's axis, above the pitch point at rack
displacement 0. Forces on the pinion are the exact opposite, so that momentum and moment balance.
"""

from rps_exudyn.base.compiled import inline
from rps_exudyn.forces.force_element import FRICTION_STATE, Part
from rps_exudyn.forces.rigid_motion import on_angles

TORQUE = 0  # moment of the contact on the pinion about k, at its axis of rotation [N m]
FORCE = slice(1, 4)  # on the rack, housing frame [N]
MOMENT = slice(4, 7)  # on the rack about its reference point, housing frame [N m]
NORMAL_DRIVE = 7  # sum of normal forces on the drive flanks (side -1) [N]
NORMAL_COAST = 8  # the same on the coast flanks (side +1) [N]
ELASTIC_ENERGY = 9  # stored in the contact [J]
FRICTION_POWER = 10  # dissipated, >= 0 [W]
DAMPING_POWER = 11  # dissipated by contact damping, >= 0 [W]
PENETRATION = 12  # deepest [m]
TOUCHING = 13  # number of samples or lines in contact
PRESSURE = 14  # largest Hertzian pressure on a line [Pa]; 0 where the contact has no lines
FRICTION_LOST = 15  # work that friction with a state has lost so far [J] ...
FRICTION_STORED = 16  # ... and what it stores, a part of the elastic energy [J]
WRENCH_SIZE = 17

# What a law returns behind the energy terms
MESH_OUTPUTS = (
    "mesh_normal_force_drive",
    "mesh_normal_force_coast",
    "mesh_penetration",
    "mesh_touching",
    "mesh_pressure",
    *FRICTION_STATE,
)


PART = Part("mesh", ("pinion", "rack"), MESH_OUTPUTS)


@inline
def on_coordinates(wrench, turn, out):  # type: ignore[no-untyped-def]
    """Fill a law's output (17,) from a wrench: forces on pinion (1), rack (6), energy terms, `MESH_OUTPUTS`.

    `turn` is the rack's, see `turn_of`.
    """
    for i in range(4):
        out[i] = wrench[i]
    out[4], out[5], out[6] = on_angles(turn, (wrench[4], wrench[5], wrench[6]))
    for i in range(3):
        out[7 + i] = wrench[9 + i]
    out[10], out[11] = wrench[7], wrench[8]
    for i in range(12, WRENCH_SIZE):
        out[i] = wrench[i]
