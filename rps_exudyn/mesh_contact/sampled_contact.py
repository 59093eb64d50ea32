"""Spheres on the pinion's flanks against the rack's flank planes, compiled and without a contact search.

Samples and law are those of Exudyn's GeneralContact: pressure proportional to depth, Coulomb friction
regularised below a zone. They give it the tangent that its own Jacobian lacks, and what it does not keep
(normal forces, stored energy, dissipation, deepest penetration); and they check its forces independently.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import apart, kernel
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.friction import coulomb
from rps_exudyn.forces.rigid_motion import cross, dot, rotation_matrix, spin_map, times, turn_of
from rps_exudyn.mesh_contact.wrench import MESH_OUTPUTS, WRENCH_SIZE, on_coordinates


class SampledContactData(NamedTuple):
    """Spheres of every tooth space's two flanks, and the planes they meet."""

    # by tooth space, drive and coast flank; pinion frame, pinion angle 0
    centres: np.ndarray  # (z, 2, n, 3) [m]
    stiffness: np.ndarray  # (z, 2, n) [N/m]
    radius: float
    damping: float  # damping over stiffness [s]
    friction: float
    zone: float  # friction zone [m/s]
    gate: float  # only tooth spaces within this angle from the mesh are evaluated [rad]
    pinion_origin: np.ndarray  # (3,) housing frame
    pinion_frame: np.ndarray  # (3, 3) columns e, Y, k
    normals: np.ndarray  # (2, 3) out of the rack's flanks, rack frame
    offset: np.ndarray  # (2,) plane of tooth 0: normal . x = offset, rack frame [m]
    base_pitch: float
    lowest: float  # y in the rack frame where the flanks' triangles end, in the air beyond the tips [m]
    rack_reference: np.ndarray  # (3,) rack's reference point at displacement 0


@kernel
def angle_from_mesh(angle, space, spaces):  # type: ignore[no-untyped-def]
    """Angle of a tooth space from the pitch point about k, in (-pi, pi] [rad]."""
    turned = angle + space * 2 * np.pi / spaces
    return turned - 2 * np.pi * np.rint(turned / (2 * np.pi))


@apart
def sampled_wrench(angle, rate, position, rotation, velocity, spin, data):  # type: ignore[no-untyped-def]
    """Contact of all samples near the mesh; see `wrench` for arguments and result."""
    out = np.zeros(WRENCH_SIZE)
    axis = data.pinion_frame[:, 2]
    spaces = data.centres.shape[0]
    c, s = np.cos(angle), np.sin(angle)
    torque = 0.0
    for side in range(2):
        normal = rotation @ data.normals[side]
        for space in range(spaces):
            if abs(angle_from_mesh(angle, space, spaces)) > data.gate:
                continue
            for i in range(data.centres.shape[2]):
                x, y, z = data.centres[space, side, i]
                px, py = c * x - s * y, s * x + c * y
                lever = data.pinion_frame @ np.array([px, py, z])  # from the axis of rotation
                place = data.pinion_origin + lever - position
                height = normal @ place - data.offset[side]
                height -= data.base_pitch * np.rint(height / data.base_pitch)
                depth = data.radius - height
                if depth <= 0 or height < -data.radius or dot(rotation[:, 1], place) < data.lowest:
                    continue
                # touching point on the plane: below the sphere's centre
                place = place - height * normal
                lever = lever - height * normal
                slip = rate * np.array(cross(axis, lever)) - velocity - np.array(cross(spin, place))
                approach = -(slip @ normal)
                # with much damping a receding sphere pulls, as GeneralContact's do
                normal_force = data.stiffness[space, side, i] * (depth + data.damping * approach)
                slip += approach * normal
                speed = np.sqrt(slip @ slip)
                drag = coulomb(normal_force, data.friction, speed, data.zone)
                force = drag * slip - normal_force * normal  # on the rack
                out[1:4] += force
                out[4:7] += np.array(cross(place, force))
                torque -= dot(axis, cross(lever, force))
                out[7 + side] += normal_force
                out[9] += 0.5 * data.stiffness[space, side, i] * depth**2
                out[10] += drag * speed**2
                out[11] += (normal_force - data.stiffness[space, side, i] * depth) * approach
                out[12] = max(out[12], depth)
                out[13] += 1
    out[0] = torque
    return out


@kernel
def sampled_force(q, v, data):  # type: ignore[no-untyped-def]
    """Forces of all samples on the coordinates; q = pinion (1), rack (6)."""
    map_ = spin_map(q[4:7])
    wrench = sampled_wrench(
        q[0], v[0], data.rack_reference + q[1:4], rotation_matrix(q[4:7]), v[1:4], times(map_, v[4:7]), data
    )
    return on_coordinates(wrench, turn_of(q[4:7]))


def sampled_element(data: SampledContactData) -> ForceElement:
    """The contact as a force element, valid to half the spheres' radius: one deeper than its radius passes
    through GeneralContact's triangles unnoticed."""
    return ForceElement(
        "mesh", ("pinion", "rack"), sampled_force, data, MESH_OUTPUTS, {"mesh_penetration": data.radius / 2}
    )
