"""How far a load presses the rack into the mesh, and where what begins far from an equilibrium settles."""

from collections.abc import Callable
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.solvers.newton_approach import CLOSE, newton_approach
from rps_exudyn.solvers.path_follower import TOLERANCE

Force = Callable[[np.ndarray], np.ndarray]  # of coordinates (n,) -> (n,)
Tangent = Callable[[np.ndarray], np.ndarray]  # -> (n, n)

SETTLING_STEPS = 600
PATIENCE, PROGRESS = 150, 0.9  # steps over which the least force must fall to that share: what settles at
# last may first stand still for more than 50 steps
TYPICAL_APPROACH = 15e-6  # of the rack under the yoke's preload [m]


def static_approach(
    load: float,
    mesh_force: Callable[..., Any],
    data: Any,
    offset: float,
    tangent: Callable[..., Any] | None = None,
) -> float:
    """Return how far a load [N] along -Y presses the guided rack into a frictionless mesh at pinion angle 0
    [m].

    The rack keeps its direction; it finds its place along X between the flanks by itself. `offset` [m] is
    where it would stand without load; `tangent` gives the same forces with their tangent, if that is known.

    Raises:
        InputError: the teeth cannot carry the load within the range of their contact law.
    """
    if load == 0:
        return -offset
    if tangent is not None:
        _, y, rest = newton_approach(tangent)(load, 0.0, offset - TYPICAL_APPROACH, data)
        if rest <= CLOSE:
            return -float(y)
    q, still = np.zeros(7), np.zeros(7)

    def unbalanced(place: np.ndarray) -> np.ndarray:
        q[1:3] = place
        return np.asarray(mesh_force(q, still, data)[1:3] - np.array([0.0, load]))

    place, rest = settled(unbalanced, np.array([0.0, offset - TYPICAL_APPROACH]), np.ones(2))
    if rest > 1e-3 * max(load, 1.0):
        raise InputError(
            f"yoke.preload is {load:g} N, more than the teeth carry within the range of their contact law, "
            "by mesh.law and its stiffness."
        )
    return float(-place[1])


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
