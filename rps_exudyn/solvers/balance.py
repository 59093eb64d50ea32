"""Forces of a gear that are to be balanced, over coordinates of pinion, rack, plunger, bending modes and the
pinion's supports."""

from collections.abc import Callable
from ctypes import c_double
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np

from rps_exudyn.base.compiled import Entry
from rps_exudyn.forces.friction import STATE_SIZE, reset
from rps_exudyn.solvers.gear_model import WORK

SIZE = 8  # coordinates of pinion, rack and plunger; modes of a flexible rack and the supports follow
CHARACTERISTIC_LENGTHS = np.array([0.01, 1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 1.0])  # coordinates to lengths [m]
NOTHING_ACCELERATED = np.zeros((0, 0))
SUPPORT_LENGTHS = np.array([1.0, 1.0, 1.0, 0.01, 0.01])


def new_work() -> np.ndarray:
    """Return work space for a law of `gear_model`, shape (1,)."""
    works = np.zeros(1, WORK)
    reset(works[0]["contact"]["memory"])
    return works


@dataclass(frozen=True, eq=False)
class Balance:
    """Forces to be balanced."""

    law: Any  # of `gear_model`
    gears: np.ndarray  # record of the gear, in an array (1,)
    pool: np.ndarray  # numbers that the record points to
    locked: tuple[int, ...] = ()  # coordinates of the rack that are held at zero
    approach: float = 0.0  # of the rack under the preload at rest [m]
    # of what is accelerated, mass matrix (n, n); (0, 0) in steady motion
    masses: np.ndarray = field(default_factory=NOTHING_ACCELERATED.copy)
    # times (t,) -> generalised forces (t, n) that act besides
    outside: Callable[[np.ndarray], np.ndarray] | None = None
    # coordinates of a supported pinion under the preload at rest; none of a rigid one
    supported: np.ndarray = field(default_factory=partial(np.zeros, 0))
    works: np.ndarray = field(default_factory=new_work)
    _evaluations: dict[int, "_Evaluation"] = field(default_factory=dict, init=False)

    @cached_property
    def modes(self) -> int:
        """Return the number of modes in which the rack bends."""
        gear = self.gears[0]
        return int(gear["bar"]["modes"]) if gear["is_bent"] else 0

    @cached_property
    def size(self) -> int:
        """Return the number of coordinates n, with those of modes and supports."""
        return SIZE + self.modes + len(self.supported)

    def free(self, driven: int) -> np.ndarray:
        """Return the coordinates that are unknown where the rig drives one, shape (m,)."""
        return np.array([i for i in range(self.size) if i not in {driven, *self.locked}])

    @property
    def lengths(self) -> np.ndarray:
        """Return what turns the coordinates into lengths, shape (n,) [m]; of modes 1."""
        on_supports = SUPPORT_LENGTHS[: len(self.supported)]
        return np.concatenate([CHARACTERISTIC_LENGTHS, np.ones(self.modes), on_supports])

    @property
    def has_bristles(self) -> bool:
        """Return whether friction has a state."""
        return bool(self.gears[0]["has_bristles"])

    @property
    def memory(self) -> np.ndarray:
        """Return the state of the bristle friction over the present step, shape (2, STATE_SIZE)."""
        return np.asarray(self.works[0]["contact"]["memory"])

    @property
    def kept(self) -> int:
        """Return the number of columns of that state that a path keeps: none without bristles."""
        return STATE_SIZE if self.has_bristles else 0

    def force(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return the generalised forces (n,) at coordinates and rates (n,)."""
        return self._evaluated(q, v, 0.0, 0.0).total.copy()

    def tangent(self, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float) -> np.ndarray:
        """Return factor_q dF/dq + factor_v dF/dv, shape (n, n)."""
        return self._evaluated(q, v, factor_q, factor_v).tangent.copy()

    def force_and_tangent(
        self, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the forces, and factor_q dF/dq + factor_v dF/dv (n, n) unless both factors are 0."""
        found = self._evaluated(q, v, factor_q, factor_v)
        return found.total.copy(), found.tangent.copy()

    def _evaluated(self, q: np.ndarray, v: np.ndarray, factor_q: float, factor_v: float) -> "_Evaluation":
        made = self._evaluations.get(q.size)
        if made is None:
            made = self._evaluations[q.size] = _Evaluation(self, q.size)
        made.q[:], made.v[:] = q, v
        made.factor_q.value, made.factor_v.value = factor_q, factor_v
        made.call()
        return made


class _Evaluation:
    """A law's call at n coordinates, with places for what goes in and comes out."""

    def __init__(self, balance: Balance, n: int) -> None:
        self.q, self.v, self.total, self.tangent = np.empty(n), np.empty(n), np.empty(n), np.zeros((n, n))
        self.factor_q, self.factor_v = c_double(), c_double()
        constants = balance.gears, 0, balance.pool, balance.works
        factors, results = (self.factor_q, self.factor_v), (self.total, self.tangent)
        law: Entry = balance.law
        self.call = law.bound(self.q, self.v, *constants, *factors, *results)


# --- The motion of a gear linearised at places that it passes: slopes of its forces, and eigenvalues
#
# An eigenvalue's real part is the rate at which its vibration grows, its imaginary part the angular
# frequency.


def slopes(balance: Balance, places: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces' slopes by places and by rates, (k, n, n) each, at k places and rates (k, n)."""
    by_place, by_rate = (
        np.array([balance.tangent(q, v, *factors) for q, v in zip(places, rates, strict=True)])
        for factors in ((1.0, 0.0), (0.0, 1.0))
    )
    return by_place, by_rate


def eigenvalues(mass: np.ndarray, by_place: np.ndarray, by_rate: np.ndarray) -> np.ndarray:
    """Return the eigenvalues [1/s] of masses (n, n) under forces with such slopes (k, n, n), (k, 2n)."""
    return np.asarray(np.linalg.eigvals(state_matrix(mass, by_place, by_rate)))


def state_matrix(mass: np.ndarray, by_place: np.ndarray, by_rate: np.ndarray) -> np.ndarray:
    """Return what makes rates and accelerations of places and rates, (k, 2n, 2n), of the same arguments."""
    k, n = by_place.shape[:2]
    accelerations = np.linalg.solve(mass, np.concatenate([by_place, by_rate], axis=2))
    moved = np.broadcast_to(np.eye(n, 2 * n, n), (k, n, 2 * n))
    return np.concatenate([moved, accelerations], axis=1)
