"""Spheres of general contact whose load grows with the depth as law "line" asks.

Spheres on the flank bear the load per length c' d sqrt(d / d_0): that of the line law at the mean depth d_0
alone. Where errors of form or place make one part of a line deeper than another, its deep parts bear too
much. Spheres that stand out of the flank by a height h touch at the depth d + h, over a wider strip, and bear

    F' = c' d_0 ((d + h) / (d_0 + h))^(3/2),      dF'/dd = 3/2 c' d_0 / (d_0 + h)   at d_0,

which with h = d_0 / 2 has both the value and the slope of c' d there. Between half and twice the mean depth
it is within 9 % of it; without, 29 to 41 % off. A flank in the air touches until it is h away, with a fifth
of the load at d_0 at most. The depth of a contact by spheres counts from where they stand.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.mesh_contact.mean_depth import mean_depth, rack_approach
from rps_exudyn.mesh_contact.sampled_contact import SampledContactData
from rps_exudyn.mesh_contact.samples import sample_flank
from rps_exudyn.mesh_contact.spheres import SHALLOWEST, borders
from rps_exudyn.parameters.gear import SteeringGear

STANDING_OUT = 0.5  # height over the flank, in mean depths


def standing_out(
    data: SampledContactData, gear: SteeringGear, *, profile: int, axial: int
) -> SampledContactData:
    """Return the spheres of law "line" that `mesh_contact.spheres.contact_data` made, made to stand out of
    the flanks; those of law "area" as they are, whose pressure is proportional to depth."""
    if gear.mesh.law != "line":
        return data
    depth = mean_depth(gear)
    pair = replace(GearPair.of(gear), runout=0.0)
    normals = _normals(pair, FlankForm.of(gear), profile, axial, rack_approach(pair, depth))
    height = STANDING_OUT * max(depth, SHALLOWEST)
    return data._replace(
        centres=data.centres + height * normals, stiffness=data.stiffness / (1 + STANDING_OUT) ** 1.5
    )


@lru_cache(maxsize=2)
def _normals(pair: GearPair, form: FlankForm, profile: int, axial: int, approach: float) -> np.ndarray:
    """Normals out of the flanks where the spheres touch them, (z, 2, n, 3), pinion frame."""

    def normals(tooth: int, side: int) -> np.ndarray:
        return sample_flank(Flank(pair, tooth, side, form), profile, axial, approach).normals

    return np.array([[normals(*each) for each in borders(space)] for space in range(pair.teeth)])
