"""Spheres on the pinion's flanks against the rack's flank planes, compiled and without a contact search.

Samples and law are those of Exudyn's GeneralContact: pressure proportional to depth, Coulomb friction
regularised below a zone. They give it the tangent that its own Jacobian lacks, and what it does not keep
(normal forces, stored energy, dissipation, deepest penetration); and they check its forces independently.
"""

from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inline, kernel, record_type
from rps_exudyn.forces.friction import coulomb
from rps_exudyn.forces.rigid_motion import cross, dot, minus, plus, scaled, vector
from rps_exudyn.tooth_contact.contact_tangent import add_outer
from rps_exudyn.tooth_contact.wrench import WRENCH_SIZE


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


SPHERES = record_type(
    [
        ("first", "i8"),  # place of the first centre in the pool; the stiffnesses stand behind the centres
        ("spaces", "i8"),
        ("count", "i8"),  # spheres of each space and side
        ("radius", "f8"),
        ("damping", "f8"),
        ("friction", "f8"),
        ("zone", "f8"),
        ("gate", "f8"),
        ("pinion_origin", "f8", (3,)),
        ("pinion_frame", "f8", (3, 3)),
        ("normals", "f8", (2, 3)),
        ("offset", "f8", (2,)),
        ("base_pitch", "f8"),
        ("lowest", "f8"),
        ("rack_reference", "f8", (3,)),
    ]
)
"""Record of the spheres; fields as in `SampledContactData`."""


def pooled(data: SampledContactData, first: int) -> tuple[np.record, np.ndarray]:
    """Return the record of spheres whose centres begin at a place of the pool, and their part of the pool."""
    made = np.zeros(1, SPHERES)
    for name in set(SPHERES.names or ()) & set(SampledContactData._fields):
        made[name] = getattr(data, name)
    made["first"], made["spaces"], made["count"] = first, data.centres.shape[0], data.centres.shape[2]
    return made[0], np.concatenate([data.centres.ravel(), data.stiffness.ravel()])


@inline
def angle_from_mesh(angle, space, spaces):  # type: ignore[no-untyped-def]
    """Angle of a tooth space from the pitch point about k, in (-pi, pi] [rad]."""
    turned = angle + space * 2 * np.pi / spaces
    return turned - 2 * np.pi * np.rint(turned / (2 * np.pi))


@inline
def times(m, x):  # type: ignore[no-untyped-def]
    """The product of a matrix (3, 3) and a vector."""
    return (
        m[0, 0] * x[0] + m[0, 1] * x[1] + m[0, 2] * x[2],
        m[1, 0] * x[0] + m[1, 1] * x[1] + m[1, 2] * x[2],
        m[2, 0] * x[0] + m[2, 1] * x[1] + m[2, 2] * x[2],
    )


@kernel
def sphere_contact(  # type: ignore[no-untyped-def]
    angle, rate, position, rotation, velocity, spin, data, pool, work, factor_q, factor_v
):
    """Fill the wrench of all spheres near the mesh, see `wrench`, and its stiffness unless both factors are
    0; `data` is a record `SPHERES`, `work` a `SCRATCH`.

    A sphere's force acts at its touching point; left out of the stiffness is that the points move.
    """
    frame, count, spaces = data.pinion_frame, data.count, data.spaces
    axis = (frame[0, 2], frame[1, 2], frame[2, 2])
    to_axis = minus(vector(data.pinion_origin), vector(position))
    moving, turning = vector(velocity), vector(spin)
    c, s = np.cos(angle), np.sin(angle)
    stiffnesses = data.first + 6 * spaces * count
    begin_points(work)
    for side in range(2):
        normal = times(rotation, (data.normals[side, 0], data.normals[side, 1], data.normals[side, 2]))
        for space in range(spaces):
            if abs(angle_from_mesh(angle, space, spaces)) > data.gate:
                continue
            for i in range(count):
                number = (space * 2 + side) * count + i
                place = data.first + 3 * number
                x, y, z = pool[place], pool[place + 1], pool[place + 2]
                lever = times(frame, (c * x - s * y, s * x + c * y, z))  # from the axis of rotation
                point = plus(to_axis, lever)
                height = dot(normal, point) - data.offset[side]
                height -= data.base_pitch * np.rint(height / data.base_pitch)
                depth = data.radius - height
                if depth <= 0 or height < -data.radius:
                    continue
                if dot((rotation[0, 1], rotation[1, 1], rotation[2, 1]), point) < data.lowest:
                    continue
                # touching point on the plane: below the sphere's centre
                point, lever = minus(point, scaled(height, normal)), minus(lever, scaled(height, normal))
                press_point(
                    depth, pool[stiffnesses + number], normal, point, lever, axis, rate, moving, turning,
                    side, data, work, factor_q, factor_v,
                )  # fmt: skip


@inline
def begin_points(work):  # type: ignore[no-untyped-def]
    """Begin to add up forces at points."""
    for i in range(WRENCH_SIZE):
        work.wrench[i] = 0.0
    for i in range(6):
        for j in range(6):
            work.stiffness[i, j] = 0.0


@inline
def press_point(  # type: ignore[no-untyped-def]
    depth, stiffness, normal, point, lever, axis, rate, moving, turning, side, data, work, factor_q, factor_v
):
    """Add a load of this stiffness [N/m] at a point, with its friction.

    Args:
        depth: of the point [m].
        stiffness: of the load [N/m].
        normal: out of the rack.
        point: from the rack's reference point [m].
        lever: from the pinion's axis [m].
        axis: of the pinion.
        rate: of the pinion [rad/s].
        moving: velocity of the rack [m/s].
        turning: angular velocity of the rack [rad/s].
        side: 0 drive, 1 coast.
        data: record with `damping`, `friction` and `zone`.
        work: where all is added up.
        factor_q: of the tangent.
        factor_v: of the tangent.
    """
    out = work.wrench
    slip = minus(minus(scaled(rate, cross(axis, lever)), moving), cross(turning, point))
    approach = -dot(slip, normal)
    # with much damping a receding point pulls, as GeneralContact's spheres do
    load = stiffness * (depth + data.damping * approach)
    slip = plus(slip, scaled(approach, normal))
    speed = np.sqrt(dot(slip, slip))
    drag = coulomb(load, data.friction, speed, data.zone)
    force = minus(scaled(drag, slip), scaled(load, normal))  # on the rack
    moment = cross(point, force)
    for k in range(3):
        out[1 + k] += force[k]
        out[4 + k] += moment[k]
    out[0] -= dot(axis, cross(lever, force))
    out[7 + side] += load
    out[9] += 0.5 * stiffness * depth**2
    out[10] += drag * speed**2
    out[11] += (load - stiffness * depth) * approach
    out[12] = max(out[12], depth)
    out[13] += 1
    if factor_q != 0 or factor_v != 0:
        per_load = drag / load if load != 0 else 0.0
        pressed = plus(normal, scaled(-per_load, slip))
        factor = -stiffness * (factor_q + data.damping * factor_v)
        add_outer(work.stiffness, factor, pressed, cross(point, pressed), normal, cross(point, normal))
        _add_drag(work.stiffness, -factor_v * drag, speed > data.zone, point, normal, slip)


@inline
def _add_drag(stiffness, drag, slides, point, normal, slip):  # type: ignore[no-untyped-def]
    """Add what friction changes by with the rates: across the sliding, in the friction zone also along it."""
    if drag == 0:
        return
    size = np.sqrt(dot(slip, slip))
    along = scaled(1 / size, slip) if size > 0 else cross(normal, (0.0, 0.0, 1.0))
    aside = cross(normal, along)
    moment = cross(point, aside)
    add_outer(stiffness, drag, aside, moment, aside, moment)
    if not slides:
        moment = cross(point, along)
        add_outer(stiffness, drag, along, moment, along, moment)
