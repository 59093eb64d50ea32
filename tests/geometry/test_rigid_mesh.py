"""Rigid kinematics: perfect gears transmit without error, whatever the distance and the shaft angle.

The rack's position is sought by brute force: at each pinion angle, how far must the rack stand along X so
that no point of the pinion's flanks is behind the rack flank it meets. Generators 0.4 mrad apart touch the
plane to q (0.2 mrad)^2 / 2 = 1.4e-10 m, the only error of the search.
"""

import dataclasses

import numpy as np
import pytest

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear

SEARCH_STEP = 4e-4  # between generators [rad]
PAPER = GearPair.of(SteeringGear())


def flank_points(pair: GearPair, side: int) -> np.ndarray:
    """Points of tooth 0's flank, seven on each generator, pinion frame, shape (n, 7, 3)."""
    flank, b = Flank(pair, 0, side), pair.face_width
    q = (flank.form_tangent_length, flank.tip_tangent_length)
    corners = [float(flank.generator(length, Z)) for length in q for Z in (-b / 2, b / 2)]
    psi = np.arange(min(corners), max(corners), SEARCH_STEP)[:, None]
    # a generator begins and ends at an end face, the tip or the form circle; where it misses, first > last
    at_middle, slope = flank.tangent_length(psi, 0.0), side * np.tan(pair.beta_b)
    with np.errstate(divide="ignore"):
        ends = (at_middle - q[0]) / slope, (at_middle - q[1]) / slope
    first, last = np.maximum(np.minimum(*ends), -b / 2), np.minimum(np.maximum(*ends), b / 2)
    return flank.point(psi, first + (last - first) * np.linspace(0, 1, 7))


def rack_positions(pair: GearPair, side: int, angles: np.ndarray, lift: float) -> np.ndarray:
    """Contact of the flanks of one side: rack displacement at each angle [m], the rack lifted by `lift`."""
    bar = RackBar(pair, -1.0, 1.0, 1)
    plane = bar.flank(0, side)
    height = pair.bar_axis_height + lift
    points = flank_points(pair, side)
    found = []
    for angle in angles:
        candidates = []
        for tooth in range(pair.teeth):
            azimuth = np.pi / pair.teeth * (1 + 2 * tooth) - angle  # of the tooth, from the rack's direction
            turns = np.round(azimuth / (2 * np.pi))
            c, s = (
                np.cos(2 * np.pi * tooth / pair.teeth - angle),
                np.sin(2 * np.pi * tooth / pair.teeth - angle),
            )
            turned = points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ pair.pinion_frame.T
            on_rack = turned - [0, height, 0]
            reach = (on_rack[..., 1] > plane.tip_height) & (on_rack[..., 1] < plane.form_height)
            if reach.any():
                # tooth 0 and tooth -1 hold rack tooth 0 between their flanks -1 and +1
                number = turns * pair.teeth - tooth - (side > 0)
                gap = (on_rack[reach] - plane.point) @ plane.normal
                candidates.append(gap / plane.normal[0] - number * pair.rack_pitch)
        limit = np.concatenate(candidates)
        found.append(limit.max() if side < 0 else limit.min())
    return np.array(found)


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(
    ("helix", "rack_angle", "lift"),
    [(25, 10, 0.0), (25, 10, 0.15e-3), (25, -15, 0.0), (20, 20, 0.1e-3), (-30, 5, 0.3e-3), (28, 28, 0.0)],
)
def test_no_transmission_error_over_a_turn(side: int, helix: float, rack_angle: float, lift: float) -> None:
    """X = gain * phi + constant to 1e-9 m; a rack lifted by h has the play h tan(alpha_n) / cos(beta_r).

    Pinion tip and width are those of the default gear where it is not pointed.
    """
    pair = dataclasses.replace(
        PAPER, beta_p=np.radians(helix), beta_r=np.radians(rack_angle), tip_radius=9.0e-3, face_width=16e-3
    )
    angles = np.linspace(0, 2 * np.pi, 37)
    error = rack_positions(pair, side, angles, lift) - pair.gain * angles
    play = side * lift * np.tan(pair.alpha_n) / np.cos(pair.beta_r)
    np.testing.assert_allclose(error, play, rtol=0, atol=1e-9)


def test_search_sees_a_transmission_error() -> None:
    """It is not blind: a shaft 0.1 degrees off runs on the edges of its teeth, micrometres to and fro."""
    angles = np.linspace(0, 2 * np.pi / PAPER.teeth, 13)
    skewed = dataclasses.replace(PAPER, angle_error=np.radians(0.1))
    assert np.ptp(rack_positions(skewed, -1, angles, 0.0) - skewed.gain * angles) > 1e-6
