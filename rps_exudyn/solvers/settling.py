"""How far a load presses the rack into the mesh, and where what begins far from an equilibrium settles."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import VECTOR, Law, called, entry, stacked, stacked_zeros
from rps_exudyn.base.errors import InputError
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.gear_model import GEARS, LAW, WORKS

TOLERANCE = 1e-3  # largest unbalanced force accepted [N], moments over 10 mm: 1e-5 of the torque

Force = Callable[[np.ndarray], np.ndarray]  # of coordinates (n,) -> (n,)
Tangent = Callable[[np.ndarray], np.ndarray]  # -> (n, n)

SETTLING_STEPS = 600
PATIENCE, PROGRESS = 150, 0.9  # steps over which the least force must fall to that share: what settles at
# last may first stand still for more than 50 steps
TYPICAL_APPROACH = 15e-6  # of the rack under the yoke's preload [m] ...
LEAST_APPROACH = 15e-9  # ... and of the stiffest teeth


MAX_STEPS = 60
FARTHEST = 20e-6  # of one step [m]
CLOSE = 1e-4  # largest unbalanced force accepted [N]
SMALLEST_FRACTION = 1e-3


@entry(Law(LAW), VECTOR, VECTOR, VECTOR, GEARS, VECTOR, WORKS, VECTOR)
def find_approach(law, loads, x, y, gears, pool, works, residuals):  # type: ignore[no-untyped-def]
    """Move the racks of gears, which keep their direction, to where the teeth carry loads [N] along -Y and no
    force along X, by Newton's method from places x and y (g,) [m]; fills the residuals (g,) [N]."""
    work, q, v, total, tangent = works[0], stacked_zeros(8), stacked_zeros(8), stacked(8), stacked((8, 8))
    for g in range(gears.shape[0]):
        norm, fraction, move_x, move_y = np.inf, 1.0, 0.0, 0.0
        for _ in range(MAX_STEPS):
            q[1], q[2] = x[g] + fraction * move_x, y[g] + fraction * move_y
            called(law, q, v, gears, g, pool, works, 1.0, 0.0, total, tangent)
            along, across = work.out[1], work.out[2] - loads[g]
            residual = max(abs(along), abs(across))
            if not residual < norm:  # too far along the last step
                fraction *= 0.5
                if fraction < SMALLEST_FRACTION:
                    break
                continue
            x[g], y[g], norm, fraction = q[1], q[2], residual, 1.0
            if norm <= CLOSE:
                break
            slope = work.of_mesh
            a, b, c, d = slope[0, 0], slope[0, 1], slope[1, 0], slope[1, 1]
            size = a * d - b * c
            if not abs(size) > 0:
                break
            move_x, move_y = (b * across - d * along) / size, (c * along - a * across) / size
            largest = max(abs(move_x), abs(move_y))
            if not np.isfinite(largest):
                break
            if largest > FARTHEST:
                move_x, move_y = move_x * FARTHEST / largest, move_y * FARTHEST / largest
        residuals[g] = norm


def static_approach(load: float, law: Any, ideal: np.ndarray, pool: np.ndarray, offset: float) -> float:
    """Return how far a load [N] along -Y presses the guided rack into a frictionless mesh at angle 0 [m].

    The rack keeps its direction; it finds its place along X between the flanks by itself.

    `ideal` is the gear's record (1,) without friction and runout; `offset` [m] the place without load.

    Raises:
        InputError: the teeth cannot carry the load within the range of their contact law.
    """
    if load == 0:
        return -offset
    balance = Balance(law, ideal, pool)
    q, still = np.zeros(8), np.zeros(8)

    def unbalanced(place: np.ndarray) -> np.ndarray:
        q[1:3] = place
        balance.force(q, still)
        return np.asarray(balance.works[0]["out"][1:3] - np.array([0.0, load]))

    begun = np.array([0.0, offset - TYPICAL_APPROACH])
    for _ in range(MAX_STEPS):
        x, y, rest = begun[:1].copy(), begun[1:].copy(), np.zeros(1)
        find_approach(law, np.array([load]), x, y, ideal, pool, balance.works, rest)
        if rest[0] <= CLOSE:
            return -float(y[0])
        left = unbalanced(begun)
        if left[1] == -load:
            begun[1] -= TYPICAL_APPROACH  # worn teeth do not touch yet
        elif np.isfinite(left).all() or offset - begun[1] <= LEAST_APPROACH:
            break
        else:
            begun[1] = (offset + begun[1]) / 2  # stiff teeth have no law so deep
    place, residual = settled(unbalanced, begun, np.ones(2))
    if residual > 1e-3 * max(load, 1.0):
        raise InputError(
            f"yoke.preload is {load:g} N, more than the teeth carry within the range of their contact law, "
            "by mesh.law and its stiffness."
        )
    return -float(place[1])


def settled(
    force: Force,
    start: np.ndarray,
    levers: np.ndarray,
    steps: int = SETTLING_STEPS,
    tangent: Tangent | None = None,
) -> tuple[np.ndarray, float]:
    """Let the coordinates creep to where the force vanishes; return the place and the residual [N].

    Pseudo-transient continuation: implicit Euler steps of levers^2 dq/dt = force, which cannot overshoot far,
    longer the smaller the force has become until they are Newton's. `levers` turn rotations into lengths [m];
    without a `tangent` of the force it is taken from differences.

    Raises:
        LinAlgError: the force is not finite.
    """
    q, r = start.copy(), force(start)
    slope, least = tangent or differences(force, levers), [np.inf]
    stretch = 1e-9  # [m/N]
    for _ in range(steps):
        norm = float(np.abs(r / levers).max())
        least.append(min(norm, least[-1]))
        stagnates = len(least) > PATIENCE + 1 and least[-1] > PROGRESS * least[-1 - PATIENCE]
        if norm <= TOLERANCE / 10 or stagnates:
            break
        move = _solution(np.diag(levers**2) / stretch - slope(q), r)
        move *= min(1.0, 20e-6 / float(np.abs(move * levers).max() or 1.0))
        r_next = force(q + move)
        growth = norm / float(np.abs(r_next / levers).max() or norm)
        stretch *= min(max(growth, 1.3), 10.0) if growth > 0.9 else 0.2
        if growth > 0.2:
            q, r = q + move, r_next
    return q, float(np.abs(r / levers).max())


def differences(force: Force, levers: np.ndarray) -> Tangent:
    """Return the tangent of a force by forward differences of 1 nm."""

    def tangent(q: np.ndarray) -> np.ndarray:
        here, slope = force(q), np.empty((q.size, q.size))
        for j, step in enumerate(1e-9 / levers):
            moved = q.copy()
            moved[j] += step
            slope[:, j] = (force(moved) - here) / step
        return slope

    return tangent


def _solution(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve a small system, by least squares where it is singular.

    Raises:
        LinAlgError: it is not finite, which LAPACK would print a line about.
    """
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        raise np.linalg.LinAlgError("the force is not finite")
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])
