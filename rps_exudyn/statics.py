"""Equilibrium of the gear at a given pinion angle, everything sliding.

Unknowns are the rack's six coordinates and the plunger's; the pinion's angle is given. The forces are the
force elements of the dynamic model, with the rates of steady turning: the rack moves along X at gain times
pinion rate, nothing else moves, so all friction is sliding friction in its known direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parts.force_element import ForceElement

# Stacked coordinates: pinion (rotation about k), rack, plunger
SLOTS = {"pinion": slice(0, 1), "rack": slice(1, 7), "plunger": slice(7, 8)}
FREE = slice(1, 8)
SIZE = 8

STEPS = np.array([1e-9, 1e-9, 1e-9, 1e-8, 1e-8, 1e-8, 1e-9])  # for differences, of the free coordinates
SCALE = np.array([1.0, 1.0, 1.0, 1e-2, 1e-2, 1e-2, 1.0])  # metres of motion per unit coordinate, for norms


@dataclass(frozen=True)
class Equilibrium:
    """Where the gear rests, and how well."""

    coordinates: np.ndarray  # (8,) pinion, rack, plunger
    rates: np.ndarray  # (8,)
    residual: float  # largest unbalanced force [N] (moments over 10 mm)
    iterations: int
    converged: bool


def stacked(element: ForceElement, coordinates: np.ndarray) -> np.ndarray:
    """An element's own coordinates out of the stack."""
    return np.concatenate([coordinates[SLOTS[body]] for body in element.bodies])


def generalised_force(elements: Sequence[ForceElement], q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Sum over the elements on the stacked coordinates, shape (8,)."""
    total = np.zeros(SIZE)
    for element in elements:
        out = element.evaluate(stacked(element, q), stacked(element, v))
        start = 0
        for body in element.bodies:
            slot = SLOTS[body]
            n = slot.stop - slot.start
            total[slot] += out[start : start + n]
            start += n
    return total


def steady_rates(pair: GearPair, speed: float) -> np.ndarray:
    """Rates of steady turning at pinion speed [rad/s], shape (8,)."""
    rates = np.zeros(SIZE)
    rates[SLOTS["pinion"]] = -speed
    rates[SLOTS["rack"]][0] = pair.gain * speed
    return rates


def equilibrium(
    elements: Sequence[ForceElement],
    start: np.ndarray,
    rates: np.ndarray,
    *,
    tolerance: float = 1e-7,
    max_iterations: int = 60,
) -> Equilibrium:
    """Newton's method with a line search from the stacked coordinates `start`.

    `tolerance` is the largest unbalanced force [N] accepted.
    """
    q = start.copy()

    def residual(q: np.ndarray) -> np.ndarray:
        return generalised_force(elements, q, rates)[FREE] / SCALE

    r = residual(q)
    for iteration in range(max_iterations):
        norm = float(np.abs(r).max())
        if norm <= tolerance:
            return Equilibrium(q, rates, norm, iteration, True)
        tangent = np.empty((7, 7))
        for j in range(7):
            up, down = q.copy(), q.copy()
            up[1 + j] += STEPS[j]
            down[1 + j] -= STEPS[j]
            tangent[:, j] = (residual(up) - residual(down)) / (2 * STEPS[j])
        try:
            move = -np.linalg.solve(tangent, r)
        except np.linalg.LinAlgError:
            break
        move *= min(1.0, 1e-4 / float(np.abs(move * SCALE).max()))  # stay where the contact is the same contact
        for fraction in 0.5 ** np.arange(8):
            trial = q.copy()
            trial[FREE] += fraction * move
            r_trial = residual(trial)
            if np.abs(r_trial).max() < norm * (1 - 0.1 * fraction):
                break
        q, r = trial, r_trial
    norm = float(np.abs(r).max())
    return Equilibrium(q, rates, norm, max_iterations, norm <= tolerance)


def approach_under(load: float, mesh: ForceElement) -> float:
    """How far a load [N] along -Y presses the guided rack into the frictionless mesh, at pinion angle 0 [m].

    The rack keeps its direction; it finds its place along X between the flanks by itself.
    """
    if load == 0:
        return 0.0
    q, still = np.zeros(7), np.zeros(7)
    place = np.array([0.0, -10e-6])  # along X and Y

    def residual(place: np.ndarray) -> np.ndarray:
        q[1:3] = place
        return mesh.evaluate(q, still)[1:3] - np.array([0.0, load])

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
