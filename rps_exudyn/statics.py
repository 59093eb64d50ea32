"""Equilibrium of the gear from pinion angle to pinion angle, everything sliding.

Unknowns are the rack's six coordinates and the plunger's; the pinion's angle is given. The forces are those
of the dynamic model (`gear_kernel`) without inertia; the rates that friction needs are the path's own,
by backward differences, so that this is the limit of slow dynamics and not a model of its own. At the first
angle they are those of steady turning: the rack moves along X at gain times pinion rate, nothing else moves.

Newton's method with Broyden's update of the inverse tangent: along a smooth path one angle costs three or
four evaluations of the forces, and a new tangent is rare.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.compiled import kernel, kernel_over
from rps_exudyn.errors import InputError
from rps_exudyn.gear_kernel import STACK
from rps_exudyn.gears.gear_pair import GearPair

SIZE = 8  # coordinates of pinion, rack and plunger

TOLERANCE = 1e-3  # largest unbalanced force accepted [N], moments over 10 mm: 1e-5 of the torque
MAX_ITERATIONS = 60
SETTLING_STEPS = 600
LEVERS = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 1.0])  # free coordinates to lengths [m]
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
    follow = _follower(force)
    found, evaluations, iterations, tangents, residual = follow(-angles, coordinates, rates, forces, data)
    if found == 0:  # the guess was too far off: let the gear settle there first
        guess, steady = starting_guess(pair, angles[0]), steady_rates(pair, speed)

        def unbalanced(free: np.ndarray) -> np.ndarray:
            return np.asarray(force(np.append(guess[0], free), steady, data)[1:8])

        coordinates[0, 0] = guess[0]
        coordinates[0, 1:], _ = settled(unbalanced, guess[1:], LEVERS)
        rates[0] = steady
        found, evaluations, iterations, tangents, residual = follow(-angles, coordinates, rates, forces, data)
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


# Loops in place of array expressions: numba compiles those much slower, with all their broadcasting.


@kernel
def backward_difference(x, y, k, base):  # type: ignore[no-untyped-def]
    """y'(x_k) = factor (y_k - base) of the parabola through the last three points; fills base."""
    h, g = x[k] - x[k - 1], x[k - 1] - x[k - 2]
    factor = (2 * h + g) / (h * (h + g))
    for i in range(base.size):
        base[i] = ((h + g) / (h * g) * y[k - 1, i] - h / (g * (h + g)) * y[k - 2, i]) / factor
    return factor


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
def newton_move(inverse, forces, move):  # type: ignore[no-untyped-def]
    """Fill the step of the free coordinates, shortened to where the contact stays the same contact: 0.1 mm,
    or 10 mrad."""
    largest = 0.0
    for i in range(7):
        move[i] = 0.0
        for j in range(7):
            move[i] -= inverse[i, j] * forces[1 + j]
        largest = max(largest, abs(move[i]) * (0.01 if 3 <= i <= 5 else 1.0))
    if largest > 1e-4:
        for i in range(7):
            move[i] *= 1e-4 / largest


@kernel
def explain_step(inverse, move, before, after):  # type: ignore[no-untyped-def]
    """Broyden's update: the inverse tangent that maps the change of the forces onto the step made."""
    mapped, row, size = np.zeros(7), np.zeros(7), 0.0
    for i in range(7):
        for j in range(7):
            mapped[i] += inverse[i, j] * (after[1 + j] - before[1 + j])
            row[i] += move[j] * inverse[j, i]
        size += move[i] * mapped[i]
    if size == 0 or not np.isfinite(size):
        return
    for i in range(7):
        for j in range(7):
            inverse[i, j] += (move[i] - mapped[i]) * row[j] / size


@kernel
def shifted(q, move, share, trial):  # type: ignore[no-untyped-def]
    """Fill the coordinates a share of the step away."""
    trial[0] = q[0]
    for i in range(7):
        trial[1 + i] = q[1 + i] + share * move[i]


@kernel
def rates_from(q, base, per_time, v):  # type: ignore[no-untyped-def]
    """Fill the rates of rack and plunger that the path has at q; per_time 0 keeps those given."""
    if per_time != 0:
        for i in range(1, 8):
            v[i] = (q[i] - base[i]) * per_time


@cache
def _follower(force: Callable[..., Any]) -> Callable[..., Any]:
    def inverse_tangent(q, v, base, per_time, data, r):  # type: ignore[no-untyped-def]
        # one-sided differences: Broyden's updates refine what they miss
        tangent, trial = np.empty((7, 7)), q.copy()
        for j in range(7):
            step = 1e-8 if 3 <= j <= 5 else 1e-9
            trial[1 + j] = q[1 + j] + step
            rates_from(trial, base, per_time, v)
            moved = force(trial, v, data)
            for i in range(7):
                tangent[i, j] = (moved[1 + i] - r[1 + i]) / step
            trial[1 + j] = q[1 + j]
        return np.linalg.inv(tangent)

    inverse_tangent = kernel_over(inverse_tangent, force)

    def follow(angles, coordinates, rates, forces, data):  # type: ignore[no-untyped-def]
        evaluations, iterations, tangents = 0, 0, 0
        inverse, move = np.empty((7, 7)), np.empty(7)
        q, v, base, trial = coordinates[0].copy(), rates[0].copy(), np.empty(8), np.empty(8)
        norm = np.inf
        for k in range(angles.size):
            per_time = 0.0
            if k == 1:
                base[:] = coordinates[0]
                per_time = rates[0, 0] / (angles[1] - angles[0])
                q[1] += rates[0, 1] / per_time
            elif k > 1:
                per_time = backward_difference(angles, coordinates, k, base) * rates[0, 0]
                stretch = (angles[k] - angles[k - 1]) / (angles[k - 1] - angles[k - 2])
                for i in range(1, 8):
                    q[i] += stretch * (q[i] - coordinates[k - 2, i])
            q[0] = angles[k]
            rates_from(q, base, per_time, v)
            r = force(q, v, data)
            evaluations += 1
            norm = unbalance(r)
            fresh = False
            for _ in range(MAX_ITERATIONS):
                if norm <= TOLERANCE:
                    break
                if tangents == 0:
                    inverse = inverse_tangent(q, v, base, per_time, data, r)
                    tangents, evaluations, fresh = tangents + 1, evaluations + 7, True
                iterations += 1
                share = 1.0
                newton_move(inverse, r, move)
                while True:
                    shifted(q, move, share, trial)
                    rates_from(trial, base, per_time, v)
                    r_trial = force(trial, v, data)
                    evaluations += 1
                    norm_trial = unbalance(r_trial)
                    enough = SLOW if share == 1.0 else 1 - 0.1 * share
                    if norm_trial < enough * norm or share < 0.02 or not fresh:
                        break
                    share *= 0.5
                if not fresh and not norm_trial < SLOW * norm:  # an old tangent: try again with a new one
                    inverse = inverse_tangent(q, v, base, per_time, data, r)
                    tangents, evaluations, fresh = tangents + 1, evaluations + 7, True
                    continue
                for i in range(7):
                    move[i] *= share
                explain_step(inverse, move, r, r_trial)
                fresh = False
                q[:], r, norm = trial, r_trial, norm_trial
            if not norm <= TOLERANCE:
                return k, evaluations, iterations, tangents, norm
            rates_from(q, base, per_time, v)
            coordinates[k], rates[k], forces[k] = q, v, r
        return angles.size, evaluations, iterations, tangents, norm

    return kernel_over(follow, force)


def approach_under(load: float, mesh_force: Callable[..., Any], data: Any, offset: float) -> float:
    """How far a load [N] along -Y presses the guided rack into a frictionless mesh, at pinion angle 0 [m].

    The rack keeps its direction; it finds its place along X between the flanks by itself. `offset` [m] is
    where it would stand without load.

    Raises:
        InputError: the teeth cannot carry the load within the range of their contact law.
    """
    if load == 0:
        return -offset
    q, still = np.zeros(7), np.zeros(7)

    def unbalanced(place: np.ndarray) -> np.ndarray:
        q[1:3] = place
        return np.asarray(mesh_force(q, still, data)[1:3] - np.array([0.0, load]))

    place, rest = settled(unbalanced, np.array([0.0, offset - TYPICAL_APPROACH]), np.ones(2))
    if rest > 1e-3 * load:
        raise InputError(
            f"yoke.preload is {load:g} N, more than teeth of mesh.stiffness carry "
            "within the range of their contact law."
        )
    return float(-place[1])


def settled(
    force: Callable[[np.ndarray], np.ndarray], start: np.ndarray, levers: np.ndarray
) -> tuple[np.ndarray, float]:
    """Let the coordinates creep to where the force vanishes; the place, and what remains unbalanced [N].

    Pseudo-transient continuation: implicit Euler steps of levers^2 dq/dt = force, which cannot overshoot far,
    longer the smaller the force has become until they are Newton's. `levers` turn rotations into lengths [m].
    """
    q, r = start.copy(), force(start)
    stretch = 1e-9  # [m/N]
    for _ in range(SETTLING_STEPS):
        norm = float(np.abs(r / levers).max())
        if norm <= TOLERANCE / 10:
            break
        tangent = np.empty((q.size, q.size))
        for j, step in enumerate(1e-9 / levers):
            moved = q.copy()
            moved[j] += step
            tangent[:, j] = (force(moved) - r) / step
        move = np.linalg.lstsq(np.diag(levers**2) / stretch - tangent, r, rcond=None)[0]
        move *= min(1.0, 20e-6 / float(np.abs(move * levers).max() or 1.0))
        r_next = force(q + move)
        growth = norm / float(np.abs(r_next / levers).max() or norm)
        stretch *= min(max(growth, 1.3), 10.0) if growth > 0.9 else 0.2
        if growth > 0.2:
            q, r = q + move, r_next
    return q, float(np.abs(r / levers).max())
