"""Spheres of general contact in the order in which they touch the rack.

A sphere touches once per turn, over a few degrees: of thousands a hundred touch at a time.
`by_touching_angle` puts neighbours in that order into groups, so that the compiled samples and Exudyn's
contacts list which can be reached and leave out the rest. A sphere that is left out is in the air: no force
changes.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.mean_depth import mean_depth, rack_approach
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData
from rps_exudyn.tooth_contact.spheres import SHALLOWEST, borders, sample_flank

GROUPS_A_TURN = 90  # of about 4 degrees; a strip of contact is 5 to 10 wide
PRECISION = np.deg2rad(2.0)  # to which the angles are found at which a sphere begins and ends to touch
TILT = np.deg2rad(3.0)  # of the rack, by which a sphere may touch earlier or later


def by_touching_angle(data: SampledContactData, pair: GearPair) -> SampledContactData:
    """Return the same spheres in groups by the pinion's angle at which they touch, instead of tooth spaces.

    Group g of G touches near the angle -2 pi g / G, within the new `gate` of it, as long as no contact is
    deeper than half the spheres' radius, to which the law holds, and the rack tilts by less than `TILT`.
    Groups are filled up with spheres without stiffness on the pinion's axis, where nothing touches.
    """
    spaces, sides, count, _ = data.centres.shape
    begin, end = touching_angles(data, pair)
    groups = spaces * max(1, round(GROUPS_A_TURN / spaces))
    width, later = 2 * np.pi / groups, np.arange(spaces)[:, None, None] * groups // spaces
    number = np.round(-(begin + end) / (2 * width)).astype(int)  # (side, n), of the first tooth space
    reach = np.maximum(end + number * width, -(begin + number * width)).max()
    number = (number + later) % groups  # (space, side, n)
    rank = _rank(np.moveaxis(number, 1, 0).reshape(sides, -1)).reshape(sides, spaces, count)
    place = number, np.arange(sides)[:, None], np.moveaxis(rank, 0, 1)
    shape = groups, sides, int(rank.max()) + 1
    centres, stiffness = np.zeros((*shape, 3)), np.zeros(shape)
    centres[place], stiffness[place] = data.centres, data.stiffness
    gate = min(data.gate, float(reach + PRECISION + TILT))
    return data._replace(centres=centres, stiffness=stiffness, gate=gate)


def _rank(numbers: np.ndarray) -> np.ndarray:
    """How many equal numbers stand before each in its row."""
    order = np.argsort(numbers, axis=1, kind="stable")
    ordered = np.take_along_axis(numbers, order, axis=1)
    places = np.arange(numbers.shape[1])
    first = np.array([np.searchsorted(row, row) for row in ordered])
    rank = np.empty_like(numbers)
    np.put_along_axis(rank, order, places - first, axis=1)
    return rank


def touching_angles(data: SampledContactData, pair: GearPair) -> tuple[np.ndarray, np.ndarray]:
    """Return the pinion's angles between which the first tooth space's spheres may touch (2, n) each [rad].

    The rack follows the pinion, pressed in by as much as the law holds. A sphere that stays above it touches
    where it is lowest.
    """
    angles = np.arange(-data.gate, data.gate + PRECISION, PRECISION)
    height = _heights(data, pair, angles)
    above = np.where(height >= -data.radius, height, np.inf)
    touching, lowest = above < data.radius, angles[np.argmin(above, axis=0)]
    begin, end = angles[np.argmax(touching, axis=0)], angles[-1 - np.argmax(touching[::-1], axis=0)]
    reached = touching.any(axis=0)
    return np.where(reached, begin, lowest), np.where(reached, end, lowest)


def _heights(data: SampledContactData, pair: GearPair, angles: np.ndarray) -> np.ndarray:
    """Heights of the first tooth space's spheres over the nearest flank of the rack, at some angles of the
    pinion (angle, 2, n) [m]; without end where that flank has ended."""
    x, y, z = np.moveaxis(data.centres[0] - pair.eccentricity, -1, 0)
    c, s, travel = np.cos(angles), np.sin(angles), angles * pair.gain
    pressed = data.radius / 2 / np.abs(data.normals[:, 1])
    origin = data.pinion_origin - data.rack_reference

    def along(direction: np.ndarray, side: int) -> np.ndarray:
        """Places of one side's spheres over the rack along a direction (angle, n)."""
        e, across, k = direction @ data.pinion_frame
        fixed = direction @ origin + direction[1] * pressed[side] + k * z[side]
        turns = np.outer(c, e * x[side] + across * y[side]) + np.outer(s, across * x[side] - e * y[side])
        return np.asarray(turns + fixed + direction[0] * travel[:, None])

    sides = range(len(data.normals))
    up = np.array([0.0, 1.0, 0.0])
    height = np.stack([along(data.normals[side], side) - data.offset[side] for side in sides], axis=1)
    height -= data.base_pitch * np.round(height / data.base_pitch)
    return np.where(np.stack([along(up, side) for side in sides], axis=1) < data.lowest, np.inf, height)


# --- Spheres of general contact whose load grows with the depth as law "line" asks
#
# Spheres on the flank bear the load per length c' d sqrt(d / d_0): that of the line law at the mean depth d_0
# alone. Where errors of form or place make one part of a line deeper than another, its deep parts bear too
# much. Spheres that stand out of the flank by a height h touch at the depth d + h, over a wider strip, and
# bear
#
#     F' = c' d_0 ((d + h) / (d_0 + h))^(3/2),      dF'/dd = 3/2 c' d_0 / (d_0 + h)   at d_0,
#
# which with h = d_0 / 2 has both the value and the slope of c' d there. Between half and twice the mean depth
# it is within 9 % of it; without, 29 to 41 % off. A flank in the air touches until it is h away, with a fifth
# of the load at d_0 at most. The depth of a contact by spheres counts from where they stand.

STANDING_OUT = 0.5  # height over the flank, in mean depths


def standing_out(
    data: SampledContactData, gear: SteeringGear, *, profile: int, axial: int
) -> SampledContactData:
    """Return the spheres of law "line" that `tooth_contact.spheres.contact_data` made, made to stand out of
    the flanks; those of law "area" as they are, whose pressure is proportional to depth."""
    if gear.mesh.contact_law != "line":
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

    flanks = [[Flank(pair, *each, form) for each in borders(space)] for space in range(pair.teeth)]
    return np.array(
        [[sample_flank(each, profile, axial, approach).normals for each in row] for row in flanks]
    )
