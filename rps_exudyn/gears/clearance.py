"""Clearances of pinion and rack away from the flanks, and where they would cut into each other.

All in the pinion's transverse section: the rack's section there is the basic rack, stretched by
1 / cos beta_p along X, for any shaft angle. Runout takes away from every clearance.
"""

from functools import lru_cache

import numpy as np

from rps_exudyn.gears.basic_rack import cutter_tip_centre, half_angle, straight_depth
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.trochoid import form_point


def pinion_root_clearance(pair: GearPair) -> float:
    """Clearance of the rack's tips from the pinion's root circle [m]."""
    return pair.rack_dedendum - pair.rack_addendum


def rack_root_clearance(pair: GearPair) -> float:
    """Clearance of the pinion's tip circle from the rack's root [m]."""
    return pair.reference_line_height + pair.rack_dedendum - pair.tip_radius


def rack_tip_interference(pair: GearPair) -> float:
    """Reach of the rack's tips beyond the end of the cutter's straight flank, if positive [m].

    A rack tooth inside the cutter's outline only sweeps room that the cutter swept before. Beyond C1 the
    cutter is rounded and the rack is not: its corners then cut into the pinion's root.
    """
    return pair.rack_addendum - straight_depth(pair)


def pinion_tip_interference(pair: GearPair, positions: int = 2001) -> float:
    """Depth to which the pinion's tip corners cut into the rack's root fillets, across the teeth [m].

    Negative: the least room; minus infinity if the corners never come as deep as the fillets.
    """
    return _pinion_tip_interference(pair.design, positions)


@lru_cache(maxsize=64)
def _pinion_tip_interference(pair: GearPair, positions: int) -> float:
    r, ra, half = pair.reference_radius, pair.tip_radius, half_angle(pair, pair.tip_radius)
    from_centre = np.linspace(-0.5, 0.5, positions) * np.pi  # of the corner, from the line pinion to rack
    turn = from_centre + half  # of its tooth; the rack's space is at X = -r turn
    depth = ra * np.cos(from_centre) - pair.reference_line_height
    across = np.abs(-ra * np.sin(from_centre) + r * turn) * np.cos(pair.beta_p)
    u, y = cutter_tip_centre(pair)
    in_fillet = (depth > straight_depth(pair)) & (depth < pair.rack_dedendum)
    if not in_fillet.any():
        return -np.inf
    half_space = u + np.sqrt(pair.fillet_radius**2 - (depth[in_fillet] + y) ** 2)
    return float((across[in_fillet] - half_space).max())


def path_on_involute(pair: GearPair) -> tuple[float, float]:
    """q0, qa: ends from the pitch point of the active path of contact where the involute exists [m]."""
    q0, qa = pair.active_path
    return max(q0, form_point(pair).tangent_length - pair.reference_radius * float(np.sin(pair.alpha_t))), qa


def transverse_contact_ratio(pair: GearPair) -> float:
    """Transverse contact ratio epsilon_alpha; negative if the teeth do not meet."""
    q0, qa = path_on_involute(pair)
    return (qa - q0) * float(np.cos(pair.beta_b)) / pair.normal_base_pitch
