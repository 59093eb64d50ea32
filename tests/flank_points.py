"""The contact of the teeth by brute force: points on the modified flanks, each an independent spring.

Equal cells of tangent length and Z on every flank, each with its own place and normal. A point bears where it
lies inside a tooth of the rack: below its flank's plane, above its tips and within its round bar, and on the
pinion between form and tip circle. Neither the kernels' expansions nor their limits are in it.
"""

from typing import Any

import numpy as np

from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.wrench import (
    FORCE,
    MOMENT,
    NORMAL_COAST,
    NORMAL_DRIVE,
    PENETRATION,
    TORQUE,
    WRENCH_SIZE,
)

BEYOND = 1e-4  # tangent length by which the cells reach further than the perfect flank [m]
DEEPEST = 1.5e-4  # what is deeper does not touch but lies in another tooth [m]


def wrench_by_points(
    gear: SteeringGear, *args: Any, zone: float, shape: tuple[int, int] = (3000, 300)
) -> np.ndarray:
    """The wrench of pressure per depth; the arguments of a mesh contact kernel, `zone` of the friction [m/s],
    cells along profile and face of a flank."""
    angle, rate, position, rotation, velocity, spin = args
    pair, mesh, form, out = GearPair.of(gear), gear.mesh, FlankForm.of(gear), np.zeros(WRENCH_SIZE)
    cos, sin = np.cos(angle), np.sin(angle)
    frame = pair.pinion_frame @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    k, axis = pair.pinion_frame[:, 2], pair.pinion_origin
    for side in (-1, 1):
        normal = rotation @ pair.rack_flank_normal(side)
        for tooth in range(pair.teeth):
            flank = Flank(pair, tooth, side, form)
            x, depth, area = _touching_cells(flank, frame, position, rotation, shape)
            slip = velocity + np.cross(spin, x - position) - rate * np.cross(k, x - axis)
            approach = slip @ normal
            load = np.maximum(mesh.stiffness * (depth + mesh.damping * approach), 0) * area
            slip -= approach[:, None] * normal
            drag = mesh.friction * load / np.maximum(np.linalg.norm(slip, axis=1), zone)
            forces = -load[:, None] * normal - drag[:, None] * slip
            out[FORCE] += forces.sum(axis=0)
            out[MOMENT] += np.cross(x - position, forces).sum(axis=0)
            out[TORQUE] -= np.cross(x - axis, forces).sum(axis=0) @ k
            out[NORMAL_DRIVE if side < 0 else NORMAL_COAST] += load.sum()
            out[PENETRATION] = max(out[PENETRATION], depth.max(initial=0.0))
    return out


def _touching_cells(
    flank: Flank,
    frame: np.ndarray,
    position: np.ndarray,
    rotation: np.ndarray,
    shape: tuple[int, int],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points in the housing, depths and areas of one flank's cells that lie inside the rack's teeth."""
    pair, of_rack = flank.pair, flank.pair.rack_flank_normal(flank.side)
    q_form = flank.form_tangent_length
    lowest, highest = max(q_form - BEYOND, 0.0), flank.tip_tangent_length + BEYOND
    dq, dz = (highest - lowest) / shape[0], pair.face_width / shape[1]
    q = (lowest + dq * (np.arange(shape[0]) + 0.5))[:, None]
    z = (-pair.face_width / 2 + dz * (np.arange(shape[1]) + 0.5))[None]
    psi = flank.generator(q, z)
    facing = flank.normal(psi) @ frame.T @ rotation @ of_rack < -0.9
    points = flank.point(psi, z)[facing]
    area = np.broadcast_to(flank.area_element(psi, z), facing.shape)[facing] * dq / pair.base_radius * dz
    radius = np.hypot(points[:, 0], points[:, 1])
    points = pair.pinion_origin + (points + pair.eccentricity) @ frame.T
    in_rack = (points - position) @ rotation
    offset = pair.normal_base_pitch / 4 + np.sin(pair.alpha_n) * pair.reference_height
    depth = offset - in_rack @ of_rack
    depth -= pair.normal_base_pitch * np.round(depth / pair.normal_base_pitch)
    inside = (depth > 0) & (depth < DEEPEST)
    inside &= in_rack[:, 1] > -pair.reference_height - pair.rack_addendum
    inside &= np.hypot(in_rack[:, 1], in_rack[:, 2]) < pair.bar_radius
    inside &= (radius < pair.tip_radius) & (radius > np.hypot(pair.base_radius, q_form))
    return points[inside], depth[inside], area[inside]
