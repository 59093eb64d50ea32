"""Equilibrium of the gear from pinion angle to pinion angle, everything sliding.

Unknowns are the rack's six coordinates and the plunger's; the pinion's angle is given. The forces are those
of the dynamic model (`gear_kernel`) without inertia; the rates that friction needs are the path's own,
by backward differences, so that this is the limit of slow dynamics and not a model of its own. At the first angle
they are those of steady turning: the rack moves along X at gain times pinion rate, nothing else moves.

Newton's method with Broyden's update of the inverse tangent: along a smooth path one angle costs three or
four evaluations of the forces, and a new tangent is rare.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.compiled import kernel, kernel_over
from rps_exudyn.gear_kernel import STACK
from rps_exudyn.gears.gear_pair import GearPair

SIZE = 8  # coordinates of pinion, rack and plunger

TOLERANCE = 1e-3  # largest unbalanced force accepted [N], moments over 10 mm: 1e-5 of the torque
MAX_ITERATIONS = 60
TYPICAL_APPROACH = 15e-6  # of the rack under the yoke's preload [m]
MAX_HALVINGS = 8
SLOW = 0.9  # a step that leaves more of the unbalance than this asks for a new tangent


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria at given pinion angles; arrays have one row per angle, up to the first without one."""

    coordinates: np.ndarray  # (n, 8) pinion, rack, plunger
    rates: np.ndarray  # (n, 8)
    forces: np.ndarray  # (n, 8) generalised forces: the first is what the drive must overcome
    evaluations: int  # of the gear's forces
    iterations: int
    tangents: int
    residual: float  # largest unbalanced force at the last angle tried [N]
    converged: bool  # at all angles


def steady_rates(pair: GearPair, speed: float) -> np.ndarray:
    """Rates of steady turning at pinion speed [rad/s], shape (8,)."""
    rates = np.zeros(SIZE)
    rates[STACK["pinion"]] = -speed
    rates[STACK["rack"].start] = pair.gain * speed
    return rates


def starting_guess(pair: GearPair, angle: float) -> np.ndarray:
    """Stacked coordinates near the equilibrium at pinion angle `angle` [rad]: the rack follows the runout,
    pressed a little into the mesh."""
    phase = angle + pair.runout_angle
    lift = pair.axis_offset + pair.runout * np.cos(phase)
    swing = pair.runout * np.sin(phase) * np.cos(pair.beta_p) / np.cos(pair.beta_r)
    guess = np.zeros(SIZE)
    guess[STACK["pinion"]] = -angle
    guess[STACK["rack"]][:2] = pair.gain * angle + swing, lift - TYPICAL_APPROACH
    guess[STACK["plunger"]] = lift
    return guess


def equilibrium_path(
    force: Callable[..., Any], data: Any, pair: GearPair, angles: np.ndarray, speed: float
) -> EquilibriumPath:
    """Equilibria at pinion angles [rad] in the order in which they are reached, at pinion speed [rad/s].

    `force` (q, v, data) -> (8,) is a kernel of `gear_kernel`; the sign of `speed` is the sense of rotation.
    """
    angles = np.asarray(angles, dtype=float)
    coordinates = np.empty((len(angles), SIZE))
    rates = np.empty_like(coordinates)
    forces = np.empty_like(coordinates)
    coordinates[0], rates[0] = starting_guess(pair, angles[0]), steady_rates(pair, speed)
    found, evaluations, iterations, tangents, residual = _follower(force)(
        -angles, coordinates, rates, forces, data
    )
    return EquilibriumPath(
        coordinates[:found],
        rates[:found],
        forces[:found],
        evaluations,
        iterations,
        tangents,
        residual,
        found == len(angles),
    )


def adaptive_path(
    force: Callable[..., Any],
    data: Any,
    pair: GearPair,
    angles: np.ndarray,
    speed: float,
    tolerance: float,
) -> EquilibriumPath:
    """As `equilibrium_path`, with angles put between those given where the torque bends.

    An angle is missed by as much as its torque differs from the cubic through its four neighbours; the
    intervals beside one that is missed by more than `tolerance` [N m] are halved, until none is.
    """
    path = equilibrium_path(force, data, pair, angles, speed)
    evaluations, iterations, tangents = path.evaluations, path.iterations, path.tangents
    for _ in range(MAX_HALVINGS):
        if not path.converged:
            break
        missed = _missed(angles, path.forces[:, 0]) > tolerance
        halved = missed[:-1] | missed[1:]
        if not halved.any():
            break
        angles = np.insert(angles, np.flatnonzero(halved) + 1, ((angles[:-1] + angles[1:]) / 2)[halved])
        path = equilibrium_path(force, data, pair, angles, speed)
        evaluations += path.evaluations
        iterations += path.iterations
        tangents += path.tangents
    return replace(path, evaluations=evaluations, iterations=iterations, tangents=tangents)


def _missed(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distance of each value from the cubic through its four neighbours; 0 at the two ends each way."""
    missed = np.zeros(len(x))
    at = x[2:-2]
    nodes = [x[:-4], x[1:-3], x[3:-1], x[4:]]
    values = [y[:-4], y[1:-3], y[3:-1], y[4:]]
    cubic = np.zeros(len(at))
    for i, value in enumerate(values):
        weight = np.ones(len(at))
        for j, node in enumerate(nodes):
            if j != i:
                weight *= (at - node) / (nodes[i] - node)
        cubic += weight * value
    missed[2:-2] = np.abs(y[2:-2] - cubic)
    return missed


@kernel
def backward_difference(x, y, k):  # type: ignore[no-untyped-def]
    """y'(x_k) = factor (y_k - base) for the parabola through the last three points: factor and base."""
    h, g = x[k] - x[k - 1], x[k - 1] - x[k - 2]
    factor = (2 * h + g) / (h * (h + g))
    base = ((h + g) / (h * g) * y[k - 1] - h / (g * (h + g)) * y[k - 2]) / factor
    return factor, base


@kernel
def unbalance(forces):  # type: ignore[no-untyped-def]
    """Largest unbalanced force on rack and plunger [N]; moments over 10 mm."""
    largest = 0.0
    for i in range(1, 8):
        scale = 0.01 if 4 <= i <= 6 else 1.0
        size = abs(forces[i]) / scale
        if not size <= largest:  # also a nan
            largest = size
    return largest


@kernel
def limited(move):  # type: ignore[no-untyped-def]
    """The step, shortened so that the contact stays the same contact: 0.1 mm, or 10 mrad."""
    largest = 0.0
    for i in range(7):
        largest = max(largest, abs(move[i]) * (0.01 if 3 <= i <= 5 else 1.0))
    return move * (1e-4 / largest) if largest > 1e-4 else move


@cache
def _follower(force: Callable[..., Any]) -> Callable[..., Any]:
    def evaluate(q, v, base, per_time, data):  # type: ignore[no-untyped-def]
        # the rates follow the coordinates, from the previous angle's
        if per_time != 0:
            v[1:8] = (q[1:8] - base[1:8]) * per_time
        return force(q, v, data)

    evaluate = kernel_over(evaluate, force)

    def inverse_tangent(q, v, base, per_time, data, r):  # type: ignore[no-untyped-def]
        # one-sided differences: Broyden's updates refine what they miss
        tangent = np.empty((7, 7))
        trial = q.copy()
        for j in range(7):
            step = 1e-8 if 3 <= j <= 5 else 1e-9
            trial[1 + j] = q[1 + j] + step
            tangent[:, j] = (evaluate(trial, v, base, per_time, data)[1:8] - r[1:8]) / step
            trial[1 + j] = q[1 + j]
        return np.linalg.inv(tangent)

    inverse_tangent = kernel_over(inverse_tangent, force)

    def follow(angles, coordinates, rates, forces, data):  # type: ignore[no-untyped-def]
        evaluations, iterations, tangents = 0, 0, 0
        inverse = np.empty((7, 7))
        norm = np.inf
        for k in range(angles.size):
            q, v = coordinates[k], rates[k]
            base, per_time = q, 0.0
            if k == 1:
                base = coordinates[0]
                per_time = rates[0, 0] / (angles[1] - angles[0])
                q[:] = base
                q[1] += rates[0, 1] / per_time
            elif k > 1:
                per_time, base = backward_difference(angles, coordinates, k)
                per_time *= rates[0, 0]
                stretch = (angles[k] - angles[k - 1]) / (angles[k - 1] - angles[k - 2])
                q[:] = coordinates[k - 1] + stretch * (coordinates[k - 1] - coordinates[k - 2])
            v[:] = rates[0]
            q[0] = angles[k]
            r = evaluate(q, v, base, per_time, data)
            evaluations += 1
            norm = unbalance(r)
            fresh = False
            for _ in range(MAX_ITERATIONS):
                if norm <= TOLERANCE:
                    break
                if tangents == 0:
                    inverse[:] = inverse_tangent(q, v, base, per_time, data, r)
                    tangents, evaluations, fresh = tangents + 1, evaluations + 7, True
                iterations += 1
                move = limited(-inverse @ r[1:8])
                trial = q.copy()
                trial[1:8] += move
                r_trial = evaluate(trial, v, base, per_time, data)
                evaluations += 1
                norm_trial = unbalance(r_trial)
                if not norm_trial < SLOW * norm:
                    if not fresh:  # an old tangent: try again with a new one
                        inverse[:] = inverse_tangent(q, v, base, per_time, data, r)
                        tangents, evaluations, fresh = tangents + 1, evaluations + 7, True
                        continue
                    share = 1.0
                    while not norm_trial < (1 - 0.1 * share) * norm and share > 0.02:
                        share *= 0.5
                        trial[1:8] = q[1:8] + share * move
                        r_trial = evaluate(trial, v, base, per_time, data)
                        evaluations += 1
                        norm_trial = unbalance(r_trial)
                    move = share * move
                # Broyden: the inverse tangent that explains this step
                change = inverse @ (r_trial[1:8] - r[1:8])
                size = move @ change
                if size != 0 and np.isfinite(size):
                    inverse += np.outer(move - change, move @ inverse) / size
                fresh = False
                q[:], r, norm = trial, r_trial, norm_trial
            if not norm <= TOLERANCE:
                return k, evaluations, iterations, tangents, norm
            if per_time != 0:
                v[1:8] = (q[1:8] - base[1:8]) * per_time
            forces[k] = r
        return angles.size, evaluations, iterations, tangents, norm

    return kernel_over(follow, force)


def approach_under(load: float, mesh_force: Callable[..., Any], data: Any) -> float:
    """How far a load [N] along -Y presses the guided rack into a frictionless mesh, at pinion angle 0 [m].

    The rack keeps its direction; it finds its place along X between the flanks by itself.
    """
    if load == 0:
        return 0.0
    q, still = np.zeros(7), np.zeros(7)
    place = np.array([0.0, -TYPICAL_APPROACH])  # along X and Y

    def residual(place: np.ndarray) -> np.ndarray:
        q[1:3] = place
        return np.asarray(mesh_force(q, still, data)[1:3] - np.array([0.0, load]))

    for _ in range(50):
        r = residual(place)
        if np.abs(r).max() <= 1e-9 * max(load, 1.0):
            break
        tangent = np.column_stack(
            [(residual(place + step) - residual(place - step)) / 2e-9 for step in 1e-9 * np.eye(2)]
        )
        move = np.linalg.solve(tangent, -r)
        place = place + move * min(1.0, 10e-6 / float(np.abs(move).max()))
    return float(-place[1])
