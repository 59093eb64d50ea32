"""Equilibria that Newton's method does not find: the gear settles, or creeps, to them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.path_follower import TOLERANCE, backward_difference, inverse_tangent_of
from rps_exudyn.solvers.settling import Tangent, differences, settled

At = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # free coordinates -> all, and their rates
Outside = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # coordinates -> forces (n,), tangent (n, n)

RESCUING_STEPS = 100  # most rescues take 30 to 80
CREEP_PARTS, CREEP_STEPS = 12, 3  # of a tooth pitch, of which a gear that finds no rest makes steps
JUMP = 0.5  # of the contact's forces where its quadrature changes [N]: an equilibrium may lie on one


@dataclass(frozen=True)
class Beginning:
    """The search for the first instant of a path where the guess is too far off."""

    balance: Balance
    free: np.ndarray
    guess: np.ndarray  # (8,)
    rates: np.ndarray  # (8,) of steady motion
    applied: np.ndarray  # (8,)

    def found(self, pitch: float) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and rates of a gear that rests beside its steady motion, or else creeps.

        `pitch` is the time in which a tooth pitch is turned [s], 0 of a gear that stands still.
        """
        place, residual = self.settled(self.guess[self.free], 0.0)
        if residual > TOLERANCE and pitch:
            return self.crept(pitch / CREEP_PARTS)
        return self.at(place, self.guess[self.free], 0.0)

    def crept(self, step: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the same after implicit Euler steps [s] from the guess, while the drive slides on the spot.

        A rack that is put somewhere askew need not rest anywhere near: friction lets it roll and creep away.
        What slides across damps it, the more the shorter the step, so that each step has a solution.
        """
        before = place = self.guess[self.free]
        for _ in range(CREEP_STEPS):
            before = place
            place, residual = self.settled(before, 1 / step)
            if residual > TOLERANCE:
                break
        return self.at(place, before, 1 / step)

    def settled(self, start: np.ndarray, per_time: float) -> tuple[np.ndarray, float]:
        """Return the free coordinates that balance, with the rates of coming there from the start, and the
        residual [N]."""
        levers, tangent = self.balance.lengths[self.free], self.tangent(start, per_time)
        return settled(lambda place: self.unbalanced(place, start, per_time), start, levers, tangent=tangent)

    def tangent(self, start: np.ndarray, per_time: float) -> Tangent:
        """Return the tangent of `unbalanced` by the free coordinates."""

        def at(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return self.at(place, start, per_time)

        base = start - self.rates[self.free] / per_time if per_time else start
        return _compiled_tangent(self.balance, self.free, base, per_time, self.applied, at)

    def unbalanced(self, place: np.ndarray, before: np.ndarray, per_time: float) -> np.ndarray:
        q, v = self.at(place, before, per_time)
        return np.asarray(self.balance.force(q, v, self.balance.data) + self.applied)[self.free]

    def at(self, place: np.ndarray, before: np.ndarray, per_time: float) -> tuple[np.ndarray, np.ndarray]:
        q, v = self.guess.copy(), self.rates.copy()
        q[self.free] = place
        v[self.free] += (place - before) * per_time
        return q, v


def _compiled_tangent(
    balance: Balance, free: np.ndarray, base: np.ndarray, per_time: float, applied: np.ndarray, at: At
) -> Tangent:
    """The tangent by free coordinates from differences in compiled code; from Python where it is singular,
    as of a gear that yields without resistance.

    `base` (m,) and `per_time` give the rates, see `path_follower.rates_from`; `at` coordinates and rates.
    """
    inverse_tangent, lengths = inverse_tangent_of(balance.force), balance.lengths
    bases = np.zeros(balance.size)
    bases[free] = base

    def force(place: np.ndarray) -> np.ndarray:
        return (np.asarray(balance.force(*at(place), balance.data)) + applied)[free]

    by_python = differences(force, lengths[free])

    def tangent(place: np.ndarray) -> np.ndarray:
        q, v = at(place)
        v, here = v.copy(), np.asarray(balance.force(q, v, balance.data)) + applied
        try:
            inverse = inverse_tangent(q, v, bases, per_time, free, lengths, balance.data, applied, here)
            return np.asarray(np.linalg.inv(inverse))
        except np.linalg.LinAlgError:
            return by_python(place)

    return tangent


def search(
    balance: Balance,
    free: np.ndarray,
    time: np.ndarray,
    k: int,
    coordinates: np.ndarray,
    rates: np.ndarray,
    forces: np.ndarray,
    applied: np.ndarray,
    outside: Outside | None = None,
) -> float:
    """Let the gear creep to the equilibrium that Newton's method did not find: from where the path leads, or
    else from where it was.

    Fills row k and returns the residual [N]. What acts from `outside`, such as a spring on the coordinate
    that is driven otherwise, is balanced too; the row's forces are those without it.
    """
    base, levers = coordinates[0].copy(), balance.lengths[free]
    per_time, ahead = 1 / (time[1] - time[0]), coordinates[0] + (time[1] - time[0]) * rates[0]
    if k > 1:
        per_time = backward_difference(time, coordinates, k, base)
        stretch = (time[k] - time[k - 1]) / (time[k - 1] - time[k - 2])
        ahead = coordinates[k - 1] + stretch * (coordinates[k - 1] - coordinates[k - 2])

    def at(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        coordinates[k, free], rates[k, free] = place, (place - base[free]) * per_time
        return coordinates[k], rates[k]

    def force(place: np.ndarray) -> np.ndarray:
        return np.asarray(balance.force(*at(place), balance.data)) + applied[k]

    def unbalanced(place: np.ndarray) -> np.ndarray:
        left = force(place)
        return (left if outside is None else left + outside(coordinates[k])[0])[free]

    own = _compiled_tangent(balance, free, base[free], per_time, applied[k], at)

    def tangent(place: np.ndarray) -> np.ndarray:
        slope = own(place)
        return slope if outside is None else slope + outside(coordinates[k])[1][np.ix_(free, free)]

    residual = np.inf
    for start in (ahead, coordinates[k - 1]):
        with np.errstate(all="ignore"):  # far from an equilibrium the forces may be of any size
            try:
                place, residual = settled(unbalanced, start[free], levers, RESCUING_STEPS, tangent)
            except np.linalg.LinAlgError:  # not finite there
                continue
        forces[k] = force(place)
        if residual <= JUMP:
            break
    return residual
