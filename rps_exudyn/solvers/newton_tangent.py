"""All forces of a rigid gear with their tangent along a path, for laws of friction without memory.

The tangent of the teeth stands beside their forces (`mesh_contact.contact_tangent`); that of seat and fit
is here. Left out is what turns with the bar's small angles: it serves Newton's method, which evaluates the
forces themselves.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import borrowing, kernel_over, nested, unowned
from rps_exudyn.forces.bearing import bearing_force
from rps_exudyn.forces.external_load import dead_force
from rps_exudyn.forces.rigid_motion import cross, dot, minus, plus, scaled, spin_of, turn_of, vector
from rps_exudyn.forces.sliding_fit import held_fit_force
from rps_exudyn.forces.yoke import nut_force, seat_points, spring_force

Kernel = Callable[..., Any]

# Columns of the outputs of all force elements at an instant: name -> first column, number
OUTPUTS = {
    "mesh": (0, 15),
    "seat": (15, 12),
    "yoke_spring": (27, 5),
    "yokenut": (32, 5),
    "bearing": (37, 5),
    "bush": (42, 11),
    "load": (53, 10),
    "weight": (63, 10),
}
ALL_OUTPUTS = 73
SEAT_LOADS = 25  # first of the seat's own two outputs
PLUNGER = 7


@borrowing
def _add_outer(tangent, factor, force, moment, plunger, by_force, by_moment, by_plunger):  # type: ignore[no-untyped-def]
    """Add factor times the product of two wrenches on rack and plunger."""
    a = (force[0], force[1], force[2], moment[0], moment[1], moment[2], plunger)
    b = (by_force[0], by_force[1], by_force[2], by_moment[0], by_moment[1], by_moment[2], by_plunger)
    for i in range(7):
        for j in range(7):
            tangent[1 + i, 1 + j] += factor * a[i] * b[j]


@nested
def add_seat_tangent(q, v, data, per_time, tangent, of_loads):  # type: ignore[no-untyped-def]
    """Add what the seat's forces on rack and plunger change by along a path, to (8, 8); q, v of the stack.

    Fills `of_loads` (2, 8) with the derivatives of its own outputs, the normal force and the part along Y.

    A point under the load k depth acts on the bar along its normal n, its friction against the slip's
    direction t: -k (n + mu t) w . dq with the wrench w of n; across t friction is viscous.
    """
    turn = turn_of(q[4:7])
    omega, axis = spin_of(turn, v[4:7]), turn.axis
    slope_y, slope_z = axis[1] / axis[0], axis[2] / axis[0]
    gap = (q[2] - q[1] * slope_y - q[PLUNGER] + data.rest_gap, q[3] - q[1] * slope_z)
    tilt = min(max(slope_y, -data.tilt), data.tilt)
    points = seat_points(gap, (slope_y - tilt, slope_z), data)
    of_loads[:] = 0.0
    for i in range(points.shape[0]):
        ny, nz, stiffness = points[i, 0], points[i, 1], points[i, 3]
        arm = scaled((points[i, 2] - q[1]) / axis[0], axis)
        depth = (q[2] + arm[1] - points[i, 2] * tilt - q[PLUNGER] + data.rest_gap) * ny + (q[3] + arm[2]) * nz
        if depth <= 0:
            continue
        normal = (-(slope_y * ny + slope_z * nz), ny, nz)
        surface = plus(arm, (0.0, data.bar_radius * ny, data.bar_radius * nz))
        slip = plus(minus(vector(v[1:4]), (0.0, v[PLUNGER], 0.0)), cross(omega, surface))
        slip = minus(slip, scaled(dot(slip, normal), normal))
        speed = np.sqrt(dot(slip, slip))
        rub = scaled(data.friction / max(speed, data.zone), slip)
        moment = cross(arm, normal)
        deeper = (normal[0], normal[1], normal[2], moment[0], moment[1], moment[2], -ny)
        for j in range(7):
            of_loads[0, 1 + j] += stiffness * deeper[j]
            of_loads[1, 1 + j] += stiffness * ny * deeper[j]
        _add_outer(
            tangent,
            -stiffness,
            plus(normal, rub),
            plus(moment, cross(surface, rub)),
            -ny - rub[1],
            normal,
            moment,
            -ny,
        )
        drag = -per_time * data.friction * stiffness * depth / max(speed, data.zone)
        if drag != 0:
            aside = scaled(1 / max(speed, 1e-30), cross(normal, slip))
            moment = cross(surface, aside)
            _add_outer(tangent, drag, aside, moment, -aside[1], aside, moment, -aside[1])
            if speed <= data.zone:
                along = cross(aside, normal)
                moment = cross(surface, along)
                _add_outer(tangent, drag, along, moment, -along[1], along, moment, -along[1])


@nested
def add_fit_tangent(q, v, data, per_time, tangent):  # type: ignore[no-untyped-def]
    """Add what the fit's forces on the rack change by: its stiffness at its place, and drag as it rolls."""
    lever, k = data.station - q[1], data.stiffness
    moved = np.zeros((4, 6))
    moved[0, 1], moved[0, 5], moved[1, 2], moved[1, 4] = 1.0, lever, 1.0, -lever
    moved[2, 4], moved[3, 5] = 1.0, 1.0
    for i in range(4):
        for j in range(4):
            if k[i, j] != 0:
                for m in range(1, 6):
                    for n in range(1, 6):
                        tangent[1 + m, 1 + n] -= moved[i, m] * k[i, j] * moved[j, n]
    roll = data.radius * v[4]
    speed = np.sqrt(v[1] * v[1] + roll * roll)
    tangent[4, 4] -= per_time * data.drag / max(speed, data.zone) * data.radius * data.radius


@cache
def newton_forces(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile forces(q, v, handle, per_time, out, total, tangent, of_loads): a gear's forces along a path.

    Fills `out` (73,) with the elements' outputs, `total` (8,) with the generalised forces, `tangent` (8, 8)
    with their derivative by places whose rates change `per_time` times as much, `of_loads` (2, 8) with that
    of the columns from `SEAT_LOADS` on of `out`.
    """

    def forces_and_tangent(q, v, handle, per_time, out, total, tangent, of_loads):  # type: ignore[no-untyped-def]
        data, by_mesh = unowned(handle.data), np.zeros((7, 7))
        total[:] = 0.0
        tangent[:] = 0.0
        mesh = mesh_tangent(q[0:7], v[0:7], data.mesh, 1.0, per_time, by_mesh)
        for i in range(7):
            for j in range(7):
                tangent[i, j] = by_mesh[i, j]
        _put(out, 0, mesh, total, 0, 7)
        _put(out, 15, seat_force(q[1:8], v[1:8], data.seat), total, 1, 7)
        add_seat_tangent(q, v, data.seat, per_time, tangent, of_loads)
        _put(out, 27, spring_force(q[7:8], v[7:8], data.spring), total, 7, 1)
        _put(out, 32, nut_force(q[7:8], v[7:8], data.nut), total, 7, 1)
        tangent[7, 7] -= data.spring.rate
        if q[7] > data.nut.clearance:
            tangent[7, 7] -= data.nut.stiffness
        _put(out, 37, bearing_force(q[0:1], v[0:1], data.bearing), total, 0, 1)
        _put(out, 42, held_fit_force(q[1:7], v[1:7], data.fit), total, 1, 6)
        add_fit_tangent(q, v, data.fit, per_time, tangent)
        _put(out, 53, dead_force(q[1:7], v[1:7], data.load), total, 1, 6)
        _put(out, 63, dead_force(q[1:7], v[1:7], data.weight), total, 1, 6)

    return kernel_over(forces_and_tangent, mesh_tangent, seat_force)


@cache
def outputs_along(mesh_tangent: Kernel, seat_force: Kernel) -> Kernel:
    """Compile each(coordinates, rates, handle) -> (n, 73), the elements' outputs at states (n, 8) each.

    One loop over all elements, where a loop over each would have to be compiled.
    """
    evaluate = newton_forces(mesh_tangent, seat_force)

    def each_element(coordinates, rates, handle):  # type: ignore[no-untyped-def]
        n = coordinates.shape[0]
        out, total, tangent, of_loads = (
            np.empty((n, ALL_OUTPUTS)),
            np.empty(8),
            np.empty((8, 8)),
            np.empty((2, 8)),
        )
        for i in range(n):
            evaluate(coordinates[i], rates[i], handle, 0.0, out[i], total, tangent, of_loads)
        return out

    return kernel_over(each_element, evaluate)


@borrowing
def _put(out, first, values, total, begin, count):  # type: ignore[no-untyped-def]
    """Keep an element's output, and add its forces."""
    for i in range(values.size):
        out[first + i] = values[i]
    for i in range(count):
        total[begin + i] += values[i]
