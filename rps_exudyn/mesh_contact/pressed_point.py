"""Load at one point of the flanks by its depth, with friction, damping and, if asked for, its tangent."""

from rps_exudyn.base.compiled import inline
from rps_exudyn.mesh_contact.contact_tangent import add_station
from rps_exudyn.mesh_contact.flank_line import DAMPING_LOSS, ENERGY, add_load, affine


@inline
def press(depth, stiffness, eased, p_r, p_t, z, side, data, work, slopes):  # type: ignore[no-untyped-def]
    """Add the load stiffness * (depth + d * its rate) at a point, with its friction.

    `eased` is the stiffness's weight over the load's in the rule that the point belongs to; `slopes` says
    where to add the tangent.
    """
    pressing = depth
    if data.damping > 0:
        approach = affine(side.part, p_r, p_t, z)
        pressing += data.damping * approach
        if not pressing > 0:
            return
        work.sums[DAMPING_LOSS] += stiffness * (pressing - depth) * approach
    add_load(stiffness * pressing, p_r, p_t, z, side, data, work)
    work.sums[ENERGY] += stiffness * depth * depth / 2
    if slopes.wanted:
        add_station(eased * stiffness, stiffness * pressing, p_r, p_t, z, side, data, work, slopes)
