"""Forces of a gear that are to be balanced, over coordinates of pinion, rack, plunger and bending modes."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.forces.memory import NO_MEMORY
from rps_exudyn.solvers.newton_path import NewtonLaw

SIZE = 8  # coordinates of pinion, rack and plunger; modes of a flexible rack follow
CHARACTERISTIC_LENGTHS = np.array([0.01, 1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 1.0])  # coordinates to lengths [m]


class Balance(NamedTuple):
    """Forces to be balanced."""

    force: Callable[..., Any]  # (q, v, data) -> (n,), a kernel of `gear_kernel` or `flexible_kernel`
    data: Any
    locked: tuple[int, ...] = ()  # coordinates that are held at zero
    inertia: tuple[float, float] = (0.0, 0.0)  # of what follows the drive: pinion [kg m^2] and rack [kg]
    memory: np.ndarray = NO_MEMORY  # of friction that remembers, see `forces.memory`
    outside: Callable[[np.ndarray], np.ndarray] | None = None  # times (t,) -> generalised forces (t, 8)
    modes: int = 0  # of the rack's bending
    newton: NewtonLaw | None = None  # the same forces with their tangent

    @property
    def size(self) -> int:
        """Return the number of coordinates n, with those of the modes."""
        return SIZE + self.modes

    def free(self, driven: int) -> np.ndarray:
        """Return the coordinates that are unknown where the rig drives one, shape (m,)."""
        return np.array([i for i in range(self.size) if i not in {driven, *self.locked}])

    @property
    def lengths(self) -> np.ndarray:
        """Return what turns the coordinates into lengths, shape (n,) [m]; a mode moves a bar of one kilogram
        by about its coordinate."""
        return np.append(CHARACTERISTIC_LENGTHS, np.ones(self.modes))
