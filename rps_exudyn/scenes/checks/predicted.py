"""Quantities of a plan that are computed before it is run: the limits of its method concern them."""

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import closed_form
from rps_exudyn.tooth_contact.mean_depth import mean_depth

SPACING = 2.5  # of spheres along the profile, over the width of the strip that touches: 1 % of the torque


def work_in_zone(gear: SteeringGear, ratio: float) -> float:
    """Return the share of the friction's work in a sinusoidal swing that a zone takes away.

    Friction is mu N v / zone below it. The zone of a part is r times its largest speed of sliding v. The
    integral of v^2 / r instead of v loses 1 - sqrt(1 - r^2) / 2 - arcsin(r) / (2 r), about r^2 / 6. Bristles
    have no zone; Stribeck's friction is larger there than in motion.
    """
    pair, losses = GearPair.of(gear), closed_form(gear).forward
    slowest, along = pair.least_sliding, np.array([pair.gain])
    parts = {  # zone of a ratio of 1, sliding speeds over the pinion's, loss
        "mesh": (slowest, pair.friction_levers, losses.mesh_loss),
        "yoke": (slowest, along, losses.plunger_loss),
        "bush": (slowest, along, losses.bush_loss),
        "bearing": (1.0, np.ones(1), losses.bearing_loss),
    }
    lost = 0.0
    for part, (zone, speeds, loss) in parts.items():
        law = getattr(gear, part)
        if ratio > 0 and not law.facts.has_state:
            r = np.clip(ratio * zone / speeds, 1e-9, 1.0)
            share = 1 - np.sqrt(1 - r**2) / 2 - np.arcsin(r) / (2 * r)
            lost += loss * np.average(share, weights=speeds) * (1 + law.surplus)
    return float(lost / losses.losses) if losses.losses > 0 else 0.0


def widest_zone(gear: SteeringGear, ratio: float, lost: float) -> float:
    """Return the ratio of the zone, below a given one, that takes no more than a share of the friction's
    work."""
    from scipy.optimize import brentq  # loads in a third of a second

    return float(brentq(lambda each: work_in_zone(gear, each) - lost, 0.0, ratio))


def least_profile_samples(gear: SteeringGear) -> int:
    """Return the spheres along the path of contact such that `SPACING` strips of contact lie between two of
    them."""
    pair = GearPair.of(gear)
    curvature_radius = float(pair.reference_radius * np.sin(pair.alpha_t) / np.cos(pair.beta_p) ** 2)
    strip = 2 * np.sqrt(2 * curvature_radius * max(mean_depth(gear), 1e-9))
    path = abs(pair.active_path[1] - pair.active_path[0])
    return int(np.ceil(path / (SPACING * strip)))
