"""The tangent of teeth that bend together: the derivative of their equations through the pressed stations.

With the wrenches w_i per load and those with friction u_i of the pressed stations (`contact_tangent`), and
the tangent compliance A of their equations, a small motion m changes the wrench by -U^T A^-1 W m. Which
stations are pressed does not change; the change of the compliance, which moves with the lines, is left out.
"""

import numpy as np

from rps_exudyn.base.compiled import inline
from rps_exudyn.forces.rigid_motion import cross, plus
from rps_exudyn.mesh_contact.contact_tangent import add_viscous, arm_of, friction_at
from rps_exudyn.mesh_contact.steel import HERTZ
from rps_exudyn.mesh_contact.teeth_stations import LENGTH, P_R, P_T, P_Z, TOP
from rps_exudyn.mesh_contact.unilateral import factorize, local_yield, substitute_all


@inline
def add_teeth(matrix, lines, force, drive, coast, of_drive, of_coast, data, work):  # type: ignore[no-untyped-def]
    """Add the tangent of all stations' loads; `matrix` is their compliance, `force` their loads [N]."""
    count, flank, m = data.flank.stations, data.flank, 0
    chosen = np.empty(force.size, np.int64)
    for i in range(force.size):
        if force[i] > 0:
            chosen[m] = i
            m += 1
    full = (m + 3) // 4 * 4
    system, yields, loads = np.zeros((full, full)), np.zeros((full, 6)), np.empty((m, 6))
    for row in range(m):
        i = chosen[row]
        for col in range(row):
            system[row, col] = matrix[i, chosen[col]]
        _, slope = local_yield(force[i] / lines.stations[LENGTH, i], lines.stations[TOP, i], HERTZ)
        system[row, row] = matrix[i, i] + slope / lines.stations[LENGTH, i]
        if lines.side[i // count] < 0:
            _fill_wrenches(lines.stations, i, row, force[i], yields, loads, drive, flank, work, of_drive)
        else:
            _fill_wrenches(lines.stations, i, row, force[i], yields, loads, coast, flank, work, of_coast)
    for row in range(m, full):
        system[row, row] = 1.0
    if not factorize(system, full):
        return
    substitute_all(system, full, yields)
    factor = of_drive.factor_q + flank.damping * of_drive.factor_v
    stiffness = of_drive.stiffness
    for row in range(m):
        for i in range(6):
            value = factor * loads[row, i]
            for j in range(6):
                stiffness[i, j] -= value * yields[row, j]


@inline
def _fill_wrenches(stations, i, row, load, yields, loads, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Fill a station's wrenches per load, without and with friction; add what its friction alone changes."""
    p_r, p_t, z, stance = stations[P_R, i], stations[P_T, i], stations[P_Z, i], slopes.stance
    arm = arm_of(p_r, p_t, z, stance)
    rub = friction_at(p_r, p_t, z, side, data, work, slopes)
    whole = plus(stance.normal, rub.force)
    yields[row, 0], yields[row, 1], yields[row, 2] = stance.normal
    yields[row, 3], yields[row, 4], yields[row, 5] = cross(arm, stance.normal)
    loads[row, 0], loads[row, 1], loads[row, 2] = whole
    loads[row, 3], loads[row, 4], loads[row, 5] = cross(arm, whole)
    add_viscous(load, arm, rub, slopes)
