"""Equilibria that Newton's method does not find: the gear settles, or creeps, to them."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.forces.friction import PLACES, TIME
from rps_exudyn.solvers.settling import TOLERANCE, differences, settled

Evaluate = Callable[[np.ndarray, np.ndarray, float], tuple[np.ndarray, np.ndarray]]
"""(q, v, factor of the rates' derivative) -> forces (n,), their tangent (n, n)."""

JUMP = 0.5  # of the contact's forces where its quadrature changes [N]
RESCUING_STEPS = 100  # most rescues take 30 to 80
CREEP_PARTS, CREEP_STEPS = 12, 3  # of a tooth pitch, of which a gear that finds no rest makes steps ...
FINER, FINEST_PARTS = 4, 12 * 4**4  # ... or of shorter ones, down to this part


@dataclass(frozen=True, eq=False)
class Settling:
    """The search for a balance of the free coordinates, from which the rates follow."""

    evaluate: Evaluate  # the forces that are to be balanced, and their tangent
    free: np.ndarray  # numbers of the unknown coordinates (m,)
    lengths: np.ndarray  # turn all coordinates into lengths [m]
    q: np.ndarray  # all coordinates (n,), those that are not free as given
    v: np.ndarray  # their rates, likewise
    base: np.ndarray  # of the rates of the free ones, (place - base) per_time (m,)
    per_time: float  # factor of these rates [1/s]; 0 if the rates are those given

    def at(self, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and rates with the free ones at a place (m,)."""
        q, v = self.q.copy(), self.v.copy()
        q[self.free] = place
        if self.per_time:
            v[self.free] = (place - self.base) * self.per_time
        return q, v

    def unbalanced(self, place: np.ndarray) -> np.ndarray:
        """Return the forces on the free coordinates there."""
        return self.evaluate(*self.at(place), 0.0)[0][self.free]

    def tangent(self, place: np.ndarray) -> np.ndarray:
        """Return their tangent; by differences where the gear has no stiffness against a force."""
        slope = self.evaluate(*self.at(place), self.per_time)[1][np.ix_(self.free, self.free)]
        if np.isfinite(slope).all() and np.linalg.matrix_rank(slope) == len(slope):
            return slope
        return differences(self.unbalanced, self.lengths[self.free])(place)

    def settled(self, start: np.ndarray, steps: int = RESCUING_STEPS) -> tuple[np.ndarray, float]:
        """Return where the free coordinates settle from a start (m,), and the residual [N]."""
        return settled(self.unbalanced, start, self.lengths[self.free], steps, self.tangent)


def beginning(
    settling: Settling, pitch: float, steps: int, memory: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates of a gear that rests beside its steady motion, or else creeps.

    `settling` starts from a guess, its rates are those of steady motion. `pitch` is the time in which a tooth
    pitch is turned [s], 0 of a gear that stands still. `memory` is that of friction with a state, if there is
    any: it creeps from unloaded bristles, which hold what hardly slides by any force up to their limit.

    A tilted rack may have no equilibrium nearby: friction lets it roll and creep away. What slides across
    damps it, the more the shorter the step, so that each implicit Euler step has a solution.
    """
    guess = settling.q[settling.free]
    place, residual = settling.settled(guess, steps)
    if residual > TOLERANCE:
        with suppress(np.linalg.LinAlgError):
            nearer = by_hybrid_method(settling, place)
            place, residual = min((place, residual), nearer, key=lambda each: each[1])
    if residual <= TOLERANCE or not pitch:
        return settling.at(place)
    before, parts, found = guess, CREEP_PARTS, 0
    while found < CREEP_STEPS:
        step = pitch / parts
        # rates beside those of steady motion
        base = before - settling.v[settling.free] * step
        creeping = replace(settling, base=base, per_time=1 / step)
        if memory is not None:
            if found:
                memory[0] = memory[1]
            memory[0, TIME] = memory[1, TIME] - step
            moved = settling.q - settling.v * step
            moved[settling.free] = base
            memory[0, PLACES : PLACES + len(moved)] = moved
        place, residual = creeping.settled(before, steps)
        if residual <= TOLERANCE:
            before, found = place, found + 1
            creeping.unbalanced(place)  # what was evaluated last may have been a trial
        elif parts < FINEST_PARTS and not found:
            parts *= FINER
        else:
            break
    return creeping.at(place)


def search(settling: Settling, starts: list[np.ndarray]) -> tuple[np.ndarray, float]:
    """Find the equilibrium that Newton's method did not find, from one start (m,) after the other; return the
    place and the residual [N].

    First by Powell's hybrid method, whose trust region and updated tangent pass corners of friction and
    contact, then the gear creeps there: a residual up to `JUMP` is left where the contact's forces jump. From
    where the hybrid method has left no more than that, it creeps a last bit.
    """
    best, least = starts[-1], np.inf
    for method in (by_hybrid_method, Settling.settled):
        for start in [best] if least <= JUMP else starts:
            with np.errstate(all="ignore"):  # far from an equilibrium the forces may be of any size
                try:
                    place, residual = method(settling, start)
                except np.linalg.LinAlgError:  # not finite there
                    continue
            if residual < least:
                best, least = place, residual
            if least <= (JUMP if method is by_hybrid_method else TOLERANCE):
                break
        if least <= TOLERANCE:
            break
    return best, least


def by_hybrid_method(settling: Settling, start: np.ndarray) -> tuple[np.ndarray, float]:
    """Return place and residual [N] by Powell's hybrid method (MINPACK) from a start (m,).

    Its tangent is of differences: they see a corner within their step.

    Raises:
        LinAlgError: the forces are not finite.
    """
    from scipy.optimize import root  # takes 0.3 s, and few runs need it

    lengths = settling.lengths[settling.free]

    def scaled(place: np.ndarray) -> np.ndarray:
        forces = settling.unbalanced(place / lengths) / lengths
        if not np.isfinite(forces).all():
            raise np.linalg.LinAlgError("the force is not finite")
        return forces

    found = root(scaled, start * lengths, jac=differences(scaled, np.ones(len(start))), method="hybr")
    return found.x / lengths, float(np.abs(found.fun).max())
