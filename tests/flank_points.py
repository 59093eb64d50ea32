"""The contact of the teeth by brute force: points on the modified flanks, each an independent spring.

Equal cells of tangent length and Z on every flank, each with its own place and normal. A point bears where it
lies inside a tooth of the rack: below its flank's plane, above its tips and within its round bar, and on the
pinion between form and tip circle. Neither the kernels' expansions nor their limits are in it.
"""

from typing import Any

import numpy as np

from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.tooth_stiffness import line_stiffness
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
            cells = _pressed_cells(gear, flank, frame, position, rotation, shape)
            x, depth, area = (each[cells[4]] for each in cells[:3])
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


def line_wrench_by_points(gear: SteeringGear, *args: Any, shape: tuple[int, int] = (3000, 400)) -> np.ndarray:
    """The wrench of law "line" without friction and damping, from the deepest point of each section of a
    flank."""
    angle, _, position, rotation, _, _ = args
    pair, form, out = GearPair.of(gear), FlankForm.of(gear), np.zeros(WRENCH_SIZE)
    cos, sin = np.cos(angle), np.sin(angle)
    frame = pair.pinion_frame @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    length = pair.face_width / shape[1] / np.cos(pair.beta_b)
    for side in (-1, 1):
        normal = rotation @ pair.rack_flank_normal(side)
        for tooth in range(pair.teeth):
            flank = Flank(pair, tooth, side, form)
            x, depth, _, section, bears = _pressed_cells(gear, flank, frame, position, rotation, shape)
            order = np.lexsort((-depth, section))
            _, first = np.unique(section[order], return_index=True)
            deepest = order[first]
            x, depth = x[deepest], np.where(bears[deepest], depth[deepest], 0.0)
            forces = -(line_stiffness(gear) * depth * length)[:, None] * normal
            out[FORCE] += forces.sum(axis=0)
            out[MOMENT] += np.cross(x - position, forces).sum(axis=0)
            out[TORQUE] -= np.cross(x - pair.pinion_origin, forces).sum(axis=0) @ pair.pinion_frame[:, 2]
            out[NORMAL_DRIVE if side < 0 else NORMAL_COAST] -= (forces @ normal).sum()
    return out


def _pressed_cells(
    gear: SteeringGear,
    flank: Flank,
    frame: np.ndarray,
    position: np.ndarray,
    rotation: np.ndarray,
    shape: tuple[int, int],
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of one flank's cells that lie below the rack's planes: points in the housing, depths, areas, numbers of
    their sections, and whether they lie on both flanks."""
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
    teeth = np.round(depth / pair.normal_base_pitch)
    depth -= pair.normal_base_pitch * teeth
    if (grid := measured_flanks(gear).rack) is not None:
        for number in np.unique(teeth):
            on = teeth == number
            depth[on] += grid.at(in_rack[on, 1], in_rack[on, 2], int(-flank.side * number), flank.side)
    inside = (depth > 0) & (depth < DEEPEST)
    bears = in_rack[:, 1] > -pair.reference_height - pair.rack_addendum
    bears &= np.hypot(in_rack[:, 1], in_rack[:, 2]) < pair.bar_radius
    bears &= (radius < pair.tip_radius) & (radius > np.hypot(pair.base_radius, q_form))
    section = np.broadcast_to(np.arange(shape[1]), facing.shape)[facing]
    return points[inside], depth[inside], area[inside], section[inside], bears[inside]
