"""The whole gear's forces in one compiled function, which the fast models evaluate thousands of times.

The coordinates are stacked [pinion (about k), rack (6), plunger]; with the bush as a chain its last segment
(6) follows. The force laws are those of `forces` and `mesh_contact`, called without a detour through Python.
The laws of mesh and yoke are chosen by their kernels; every function made here is compiled for them and takes
a `Handle` on `GearData`.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.base.compiled import inlined, kernel, kernel_over, unowned
from rps_exudyn.base.linear import put
from rps_exudyn.forces.bearing import BearingData, bearing_force
from rps_exudyn.forces.external_load import DeadForceData, add_dead_force
from rps_exudyn.forces.memory import begin_step, duration, slip_rates
from rps_exudyn.forces.sliding_fit import FitData, fit_force, held_fit_force
from rps_exudyn.forces.yoke import NutData, SpringData, nut_force, spring_force

Kernel = Callable[..., Any]

STEPS_PER_SECOND = 100.0  # of a rate's difference over that of its coordinate, at most ...
PART_OF_ZONE = 0.04  # ... and that difference over the friction zone
SHORTEST_STEP = 1e-15  # [m]: of a coordinate of 0.1 m the last digits

COORDINATE_BLOCKS = {
    "pinion": slice(0, 1),
    "rack": slice(1, 7),
    "plunger": slice(7, 8),
    "segment": slice(8, 14),
}


def stacked(bodies: Sequence[str]) -> np.ndarray:
    """Indices of some bodies' coordinates in the stack, in the order of the bodies."""
    return np.concatenate([np.r_[COORDINATE_BLOCKS[body]] for body in bodies])


class GearData(NamedTuple):
    """Constants of all force laws; each is the `data` of a `ForceElement`."""

    mesh: Any
    seat: Any  # of the plunger's seat, or of the yoke as a force
    spring: SpringData
    nut: NutData
    bearing: BearingData
    fit: FitData
    load: DeadForceData
    weight: DeadForceData
    memory: np.ndarray  # (2, .) of friction that remembers, see `forces.memory`; (2, 0) without


@inlined
def _add(total, forces, n):  # type: ignore[no-untyped-def]
    for i in range(n):
        total[i] += forces[i]


@inlined
def _add_all_but_fit(total, mesh, seat, q, v, data):  # type: ignore[no-untyped-def]
    _add(total, mesh, 7)
    _add(total[1:], seat, 7)
    _add(total[7:], spring_force(q[7:8], v[7:8], data.spring), 1)
    _add(total[7:], nut_force(q[7:8], v[7:8], data.nut), 1)
    _add(total, bearing_force(q[0:1], v[0:1], data.bearing), 1)
    add_dead_force(total[1:], q[1:7], data.load)
    add_dead_force(total[1:], q[1:7], data.weight)


@cache
def gear_force(mesh_force: Kernel, seat_force: Kernel) -> Kernel:
    """Generalised forces (8,) with the bush condensed into the fit."""

    def force(q, v, handle):  # type: ignore[no-untyped-def]
        data, total = unowned(handle.data), np.zeros(8)
        v = slip_rates(q, v, data.memory)
        mesh = mesh_force(q[0:7], v[0:7], data.mesh)
        seat = seat_force(q[1:8], v[1:8], data.seat)
        _add_all_but_fit(total, mesh, seat, q, v, data)
        _add(total[1:], held_fit_force(q[1:7], v[1:7], data.fit), 6)
        return total

    return kernel_over(force, mesh_force, seat_force)


@cache
def chain_gear_force(mesh_force: Kernel, seat_force: Kernel) -> Kernel:
    """Generalised forces (14,) with the rack in the last segment of a chain."""

    def chain_force(q, v, handle):  # type: ignore[no-untyped-def]
        data, total = unowned(handle.data), np.zeros(14)
        v = slip_rates(q, v, data.memory)
        mesh = mesh_force(q[0:7], v[0:7], data.mesh)
        seat = seat_force(q[1:8], v[1:8], data.seat)
        _add_all_but_fit(total, mesh, seat, q, v, data)
        fit = fit_force(np.concatenate((q[8:14], q[1:7])), np.concatenate((v[8:14], v[1:7])), data.fit)
        _add(total[8:], fit, 6)
        _add(total[1:], fit[6:], 6)
        return total

    return kernel_over(chain_force, mesh_force, seat_force)


@cache
def differences(force: Kernel) -> Kernel:
    """Forward differences of a law: (q, v, data, steps, rate_steps, factor_q, factor_v) ->
    factor_q dF/dq + factor_v dF/dv, shape (n, n), in steps (n,) of coordinates and of rates.

    `force` is any kernel whose first outputs are the forces on the coordinates.
    """

    def forward_differences(q, v, data, steps, rate_steps, factor_q, factor_v):  # type: ignore[no-untyped-def]
        n = q.size
        result, here = np.zeros((n, n)), force(q, v, data)
        place, rate = q.copy(), v.copy()
        for j in range(n):
            if factor_q != 0:
                place[j] += steps[j]
                moved, per_step = force(place, v, data), factor_q / (place[j] - q[j])
                place[j] = q[j]
                for i in range(n):
                    result[i, j] += per_step * (moved[i] - here[i])
            if factor_v != 0:
                rate[j] += rate_steps[j]
                moved, per_step = force(q, rate, data), factor_v / (rate[j] - v[j])
                rate[j] = v[j]
                for i in range(n):
                    result[i, j] += per_step * (moved[i] - here[i])
        return result

    return kernel_over(forward_differences, force)


@kernel
def difference_steps(n):  # type: ignore[no-untyped-def]
    """Steps of n coordinates stacked as above: far below penetrations (micrometres), for 1 % of the largest
    entries of a tangent, enough for Newton's method; rotations act at distances of centimetres."""
    steps = np.full(n, 1e-8)
    for j in range(n):
        if 1 <= j <= 3 or 7 <= j <= 10:
            steps[j] = 1e-9
    return steps


@kernel
def steps_in_zone(steps, zone):  # type: ignore[no-untyped-def]
    """Steps of the rates, far below the zone [m/s] in which friction turns about."""
    return min(STEPS_PER_SECOND, PART_OF_ZONE * zone / 1e-9) * steps


@cache
def tangent(force: Kernel) -> Kernel:
    """Differences of a law that knows no gear: (q, v, data, factor_q, factor_v) ->
    factor_q dF/dq + factor_v dF/dv."""
    by_steps = differences(force)

    def difference_tangent(q, v, data, factor_q, factor_v):  # type: ignore[no-untyped-def]
        steps = difference_steps(q.size)
        return by_steps(q, v, data, steps, STEPS_PER_SECOND * steps, factor_q, factor_v)

    return kernel_over(difference_tangent, force)


@cache
def gear_tangent(force: Kernel) -> Kernel:
    """The same of all forces of a gear, in steps within its friction zone.

    Where friction remembers, its laws see no rates but what the coordinates moved over the step: a step of a
    coordinate is one of its rate then, and as short.
    """
    by_steps = differences(force)

    def zone_tangent(q, v, handle, factor_q, factor_v):  # type: ignore[no-untyped-def]
        steps = difference_steps(q.size)
        rate_steps = steps_in_zone(steps, handle.data.fit.zone)
        h = duration(handle.data.memory)
        if h > 0:
            factor_v = 0.0
            steps = np.minimum(steps, np.maximum(h * rate_steps, SHORTEST_STEP))
        return by_steps(q, v, handle, steps, rate_steps, factor_q, factor_v)

    return kernel_over(zone_tangent, force)


@cache
def along(force: Kernel) -> Kernel:
    """A kernel over many states: (coordinates (n, .), rates (n, .), data, time (n,), begun (n, .), memory)
    -> outputs (n, .).

    `begun` are what friction remembers at the begin of the steps that end in the states, (n, 0) if nothing.
    """

    def each(coordinates, rates, data, time, begun, memory):  # type: ignore[no-untyped-def]
        begin_step(memory, begun[0], time[0])
        first = force(coordinates[0], rates[0], data)
        out = np.empty((coordinates.shape[0], first.size))
        put(first, out[0])
        for i in range(1, coordinates.shape[0]):
            begin_step(memory, begun[i], time[i])
            put(force(coordinates[i], rates[i], data), out[i])
        return out

    return kernel_over(each, force)
