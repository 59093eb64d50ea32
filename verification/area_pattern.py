"""Pressures on the flanks by law "area": stiffness times depth, of points placed by a recorded motion."""

import numpy as np

from rps_exudyn.analysis.passes import Signals
from rps_exudyn.analysis.rack_motion import rack_poses
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear

DEEPEST = 0.1e-3  # what stands deeper in a rack flank's plane is at its back or beyond the mesh [m]


def pressures(
    gear: SteeringGear, signals: Signals, side: int, roll: np.ndarray, face: np.ndarray
) -> np.ndarray:
    """Pressure at each instant on each tooth, shape (instants, teeth, roll, face) [Pa]."""
    pair, form = GearPair.of(gear), FlankForm.of(gear)
    centres, _, turns = rack_poses(pair, signals)
    q, Z = roll[:, None], face[None, :]
    flanks = [Flank(pair, tooth, side, form) for tooth in range(pair.teeth)]
    points = np.stack([flank.point(flank.generator(q, Z), Z) for flank in flanks]) + pair.eccentricity
    return np.stack(
        [
            gear.mesh.stiffness * np.maximum(_depth(pair, points, side, *pose), 0.0)
            for pose in zip(signals["pinion_angle"], centres, turns, strict=True)
        ]
    )


def _depth(
    pair: GearPair, points: np.ndarray, side: int, angle: float, place: np.ndarray, turn: np.ndarray
) -> np.ndarray:
    """Depth in the rack's flanks [m] of points of the pinion, shape (..., 3) in its frame."""
    c, s = np.cos(angle), np.sin(angle)
    about_k = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])  # the pinion angle counts against k
    housing = points @ (pair.pinion_frame @ about_k).T + pair.pinion_origin
    of_rack = (housing - place) @ turn
    offset = pair.normal_base_pitch / 4 + np.sin(pair.alpha_n) * pair.reference_height
    height = of_rack @ pair.rack_flank_normal(side) - offset
    depth = pair.normal_base_pitch * np.round(height / pair.normal_base_pitch) - height
    y, z = of_rack[..., 1], of_rack[..., 2]
    on_teeth = (y >= -pair.reference_height - pair.rack_addendum) & (y**2 + z**2 <= pair.bar_radius**2)
    return np.where(on_teeth & (depth < DEEPEST), depth, 0.0)
