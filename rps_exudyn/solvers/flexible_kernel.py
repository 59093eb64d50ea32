"""The gear's forces with a bar that is bent: the laws of straight racks, at the bar's pose where they act.

Modes of the free bar, eta, stand behind the coordinates of `gear_kernel`: pinion, rack (6), plunger, eta (m).
At the station xi of the bar, where an element touches it, the bar is displaced by w = sum(phi eta) + bow and
turned by theta in plane y, likewise by u and psi in plane z. A straight rack that touches there has

    y' = y + w - xi theta,  c' = c + theta        z' = z + u - xi psi,  b' = b - psi

and the element's law sees this local pose. Station xi = X - x for what stands at X in the housing, so that
the local pose moves along the bar as the rack is displaced. By virtual work a law's forces on the local pose
act on the rack as they are, on the modes by the derivatives of the local pose, and along X by what the local
pose changes with the station: without that part, sliding along a bent bar would do work.

Deflections are linear in eta: slopes of 0.02 rad shorten the bar by a part in five thousand.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.compiled import kernel, kernel_over
from rps_exudyn.forces.bearing import bearing_force
from rps_exudyn.forces.external_load import add_dead_force, dead_force
from rps_exudyn.forces.memory import duration, slip_rates
from rps_exudyn.forces.sliding_fit import held_fit_force
from rps_exudyn.forces.yoke import nut_force, spring_force
from rps_exudyn.solvers.gear_kernel import (
    GearData,
    Kernel,
    difference_steps,
    differences,
    steps_in_zone,
)

MODES = 8  # where the modes begin in the stack

# Rows of a bar's fields at its nodes: w, dw/dxi, theta, dtheta/dxi of a unit of each mode, and of the bow
SHAPE, SLOPE, ROTATION, CURVATURE = 0, 1, 2, 3
# Rows of its sections: what it lifts and turns a straight rack that touches it, and both by the station
LIFT, TURN, LIFT_DRIFT, TURN_DRIFT = 0, 1, 2, 3
# Rows of a local pose
POSE, RATE, DRIFT = 0, 1, 2  # six coordinates, their rates, their derivatives by the station


class BarData(NamedTuple):
    """Shapes of a bar's modes and its bow at even stations."""

    first: float  # station [m]
    spacing: float  # [m]
    fields: np.ndarray  # (n, 4, m + 2): rows SHAPE .. CURVATURE of the modes, of the bow in y and in z
    in_y: int  # modes in plane y, which come first
    stiffness: np.ndarray  # (m,) angular frequency squared [1/s^2]
    damping: np.ndarray  # (m,) twice the damping ratio times the angular frequency [1/s]


class FlexibleData(NamedTuple):
    """Constants of the laws, and the bar."""

    gear: GearData
    bar: BarData


@kernel
def bar_sections(station, bar):  # type: ignore[no-untyped-def]
    """Return rows LIFT .. TURN_DRIFT at a station, shape (4, m + 2), by cubic Hermite interpolation."""
    place = (station - bar.first) / bar.spacing
    i = min(max(int(np.floor(place)), 0), bar.fields.shape[0] - 2)
    t, h = place - i, bar.spacing
    a, b = bar.fields[i], bar.fields[i + 1]
    at_a, at_b = (1 + 2 * t) * (1 - t) ** 2, t * t * (3 - 2 * t)
    by_a, by_b = t * (1 - t) ** 2 * h, t * t * (t - 1) * h
    rise, by_a_rise, by_b_rise = 6 * t * (1 - t) / h, (1 - t) * (1 - 3 * t), t * (3 * t - 2)
    sections = np.empty(a.shape)
    for k in range(a.shape[1]):
        w = at_a * a[SHAPE, k] + at_b * b[SHAPE, k] + by_a * a[SLOPE, k] + by_b * b[SLOPE, k]
        slope = rise * (b[SHAPE, k] - a[SHAPE, k]) + by_a_rise * a[SLOPE, k] + by_b_rise * b[SLOPE, k]
        turn = at_a * a[ROTATION, k] + at_b * b[ROTATION, k] + by_a * a[CURVATURE, k] + by_b * b[CURVATURE, k]
        bend = rise * (b[ROTATION, k] - a[ROTATION, k])
        bend += by_a_rise * a[CURVATURE, k] + by_b_rise * b[CURVATURE, k]
        sections[LIFT, k], sections[TURN, k] = w - station * turn, turn
        sections[LIFT_DRIFT, k], sections[TURN_DRIFT, k] = slope - turn - station * bend, bend
    return sections


@kernel
def local_pose(q, v, sections, drifts, bar):  # type: ignore[no-untyped-def]
    """Return the pose of a straight rack that touches the bar at a station, rows POSE, RATE and DRIFT.

    `drifts` is how fast the station moves over the rack's speed along X: -1, or 0 where it is a point of the
    bar.
    """
    m = bar.stiffness.size
    pose = np.zeros((3, 6))
    for i in range(6):
        pose[POSE, i], pose[RATE, i] = q[1 + i], v[1 + i]
    for plane in range(2):
        begin, end, bow = (0, bar.in_y, m) if plane == 0 else (bar.in_y, m, m + 1)
        lift, turn = sections[LIFT, bow], sections[TURN, bow]
        lift_drift, turn_drift = sections[LIFT_DRIFT, bow], sections[TURN_DRIFT, bow]
        lift_rate = turn_rate = 0.0
        for k in range(begin, end):
            eta, eta_rate = q[MODES + k], v[MODES + k]
            lift += sections[LIFT, k] * eta
            turn += sections[TURN, k] * eta
            lift_rate += sections[LIFT, k] * eta_rate
            turn_rate += sections[TURN, k] * eta_rate
            lift_drift += sections[LIFT_DRIFT, k] * eta
            turn_drift += sections[TURN_DRIFT, k] * eta
        across, about, sense = (1, 5, 1.0) if plane == 0 else (2, 4, -1.0)
        pose[POSE, across] += lift
        pose[POSE, about] += sense * turn
        pose[RATE, across] += lift_rate + lift_drift * drifts * v[1]
        pose[RATE, about] += sense * (turn_rate + turn_drift * drifts * v[1])
        pose[DRIFT, across] = lift_drift
        pose[DRIFT, about] = sense * turn_drift
    return pose


@kernel
def add_to_bar(total, forces, pose, sections, drifts, bar):  # type: ignore[no-untyped-def]
    """Add forces (6) on a local pose to those on the rack and its modes."""
    for i in range(6):
        total[1 + i] += forces[i]
        total[1] += drifts * forces[i] * pose[DRIFT, i]
    for k in range(bar.in_y):
        total[MODES + k] += forces[1] * sections[LIFT, k] + forces[5] * sections[TURN, k]
    for k in range(bar.in_y, bar.stiffness.size):
        total[MODES + k] += forces[2] * sections[LIFT, k] - forces[4] * sections[TURN, k]


@kernel
def add_elasticity(total, q, v, bar):  # type: ignore[no-untyped-def]
    """Add the modes' own forces: elastic, and of the bar's damping."""
    for k in range(bar.stiffness.size):
        total[MODES + k] -= bar.stiffness[k] * q[MODES + k] + bar.damping[k] * v[MODES + k]


@kernel
def local_poses(coordinates, rates, place, drifts, bar):  # type: ignore[no-untyped-def]
    """Return the local poses along a motion, shape (n, 3, 6), at X = `place` in the housing (`drifts` -1) or
    at that station of the bar (0)."""
    poses = np.empty((coordinates.shape[0], 3, 6))
    for i in range(coordinates.shape[0]):
        q, v = coordinates[i], rates[i]
        station = place + drifts * q[1]
        poses[i] = local_pose(q, v, bar_sections(station, bar), drifts, bar)
    return poses


@cache
def contact_force(mesh_force: Kernel, seat_force: Kernel) -> Kernel:
    """Forces (8) on pinion, local pose at the mesh, and plunger: all but those of fit and loads."""

    def contact(q, v, data):  # type: ignore[no-untyped-def]
        total = np.zeros(8)
        mesh, seat = mesh_force(q[0:7], v[0:7], data.mesh), seat_force(q[1:8], v[1:8], data.seat)
        for i in range(7):
            total[i] += mesh[i]
            total[1 + i] += seat[i]
        total[7] += spring_force(q[7:8], v[7:8], data.spring)[0] + nut_force(q[7:8], v[7:8], data.nut)[0]
        total[0] += bearing_force(q[0:1], v[0:1], data.bearing)[0]
        return total

    return kernel_over(contact, mesh_force, seat_force)


@kernel
def with_neighbours(x, local):  # type: ignore[no-untyped-def]
    """Return a local pose between the pinion's and the plunger's coordinate, shape (8,)."""
    whole = np.empty(8)
    whole[0], whole[1:7], whole[7] = x[0], local, x[7]
    return whole


@cache
def flexible_gear_force(mesh_force: Kernel, seat_force: Kernel) -> Kernel:
    """Generalised forces (8 + m) of a gear whose bar is bent."""
    contact = contact_force(mesh_force, seat_force)

    def flexible_force(q, v, handle):  # type: ignore[no-untyped-def]
        gear, bar, total = handle.data.gear, handle.data.bar, np.zeros(q.size)
        add_elasticity(total, q, v, bar)
        v = slip_rates(q, v, gear.memory)
        sections = bar_sections(-q[1], bar)  # mesh and yoke stand at X = 0
        pose = local_pose(q, v, sections, -1.0, bar)
        forces = contact(with_neighbours(q, pose[POSE]), with_neighbours(v, pose[RATE]), gear)
        total[0], total[7] = forces[0], forces[7]
        add_to_bar(total, forces[1:7], pose, sections, -1.0, bar)
        sections = bar_sections(gear.fit.station - q[1], bar)
        pose = local_pose(q, v, sections, -1.0, bar)
        on_fit = held_fit_force(pose[POSE], pose[RATE], gear.fit)
        add_to_bar(total, on_fit, pose, sections, -1.0, bar)
        if gear.load.place != 0:
            sections = bar_sections(gear.load.place, bar)
            pose = local_pose(q, v, sections, 0.0, bar)
            load = dead_force(pose[POSE], pose[RATE], gear.load)
            add_to_bar(total, load, pose, sections, 0.0, bar)
        add_dead_force(total[1:], q[1:7], gear.weight)  # on the rigid body: it bends no mode of a free bar
        return total

    return kernel_over(flexible_force, mesh_force, seat_force)


# --- tangent ---------------------------------------------------------------------------------------
@kernel
def pose_by_bar(n, pose, sections, drifts, bar):  # type: ignore[no-untyped-def]
    """Return the derivatives of a local pose by all coordinates, shape (6, n)."""
    by = np.zeros((6, n))
    for i in range(6):
        by[i, 1 + i] = 1.0
        by[i, 1] += drifts * pose[DRIFT, i]
    for k in range(bar.in_y):
        by[1, MODES + k], by[5, MODES + k] = sections[LIFT, k], sections[TURN, k]
    for k in range(bar.in_y, bar.stiffness.size):
        by[2, MODES + k], by[4, MODES + k] = sections[LIFT, k], -sections[TURN, k]
    return by


@kernel
def add_geometric(result, forces, sections, drifts, factor_q, bar):  # type: ignore[no-untyped-def]
    """Add what forces (6) on a local pose change as the station moves along the modes."""
    for k in range(bar.stiffness.size):
        if k < bar.in_y:
            change = forces[1] * sections[LIFT_DRIFT, k] + forces[5] * sections[TURN_DRIFT, k]
        else:
            change = forces[2] * sections[LIFT_DRIFT, k] - forces[4] * sections[TURN_DRIFT, k]
        result[1, MODES + k] += factor_q * drifts * change
        result[MODES + k, 1] += factor_q * drifts * change


@cache
def flexible_tangent(mesh_force: Kernel, seat_force: Kernel) -> Kernel:
    """The tangent of `flexible_gear_force`, a function as `gear_kernel.tangent` returns: differences of the
    laws over their own coordinates, and the chain rule to the modes."""
    contact = contact_force(mesh_force, seat_force)
    of_contact, of_fit, of_load = (differences(law) for law in (contact, held_fit_force, dead_force))

    def chain_rule_tangent(q, v, handle, factor_q, factor_v):  # type: ignore[no-untyped-def]
        gear, bar, n = handle.data.gear, handle.data.bar, q.size
        steps = difference_steps(MODES)
        rate_steps = steps_in_zone(steps, gear.fit.zone)
        result = np.zeros((n, n))
        for k in range(bar.stiffness.size):
            result[MODES + k, MODES + k] -= factor_q * bar.stiffness[k] + factor_v * bar.damping[k]
        v, h = slip_rates(q, v, gear.memory), duration(gear.memory)
        if h > 0:  # rates of the laws are what the coordinates moved over the step
            factor_v = factor_q / h
        sections = bar_sections(-q[1], bar)
        pose = local_pose(q, v, sections, -1.0, bar)
        place, rate = with_neighbours(q, pose[POSE]), with_neighbours(v, pose[RATE])
        by = np.zeros((8, n))
        by[0, 0] = by[7, 7] = 1.0
        by[1:7] = pose_by_bar(n, pose, sections, -1.0, bar)
        result += by.T @ (of_contact(place, rate, gear, steps, rate_steps, factor_q, factor_v) @ by)
        add_geometric(result, contact(place, rate, gear)[1:7], sections, -1.0, factor_q, bar)
        sections = bar_sections(gear.fit.station - q[1], bar)
        pose = local_pose(q, v, sections, -1.0, bar)
        held = pose_by_bar(n, pose, sections, -1.0, bar)
        by_fit = of_fit(pose[POSE], pose[RATE], gear.fit, steps[1:7], rate_steps[1:7], factor_q, factor_v)
        result += held.T @ (by_fit @ held)
        on_fit = held_fit_force(pose[POSE], pose[RATE], gear.fit)
        add_geometric(result, on_fit, sections, -1.0, factor_q, bar)
        if gear.load.place != 0:
            sections = bar_sections(gear.load.place, bar)
            pose = local_pose(q, v, sections, 0.0, bar)
            end = pose_by_bar(n, pose, sections, 0.0, bar)
            on_end = of_load(pose[POSE], pose[RATE], gear.load, steps[1:7], rate_steps[1:7], factor_q, 0.0)
            result += end.T @ (on_end @ end)
        return result

    return kernel_over(chain_rule_tangent, mesh_force, seat_force)
