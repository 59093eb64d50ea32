"""Forces between bodies as one compiled function, the same for Exudyn and for the equilibrium solver.

A force element reads the coordinates q and rates v of its bodies, stacked in the order of `bodies`, and
returns one array: the generalised forces, then the energy terms (stored energy and dissipated powers), then
values of its own, named in `outputs`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

# The energy terms, behind the generalised forces in every element's output [J, W, W]
ELASTIC_ENERGY, FRICTION_POWER, DAMPING_POWER = 0, 1, 2
ENERGY_TERMS = 3

COORDINATES = {"pinion": 1, "rack": 6, "plunger": 1, "segment": 6}


@dataclass(frozen=True)
class ForceElement:
    """A compiled force law over the coordinates of some bodies.

    Attributes:
        name: which force this is, as in the results.
        bodies: the bodies whose coordinates it reads, in the order in which they are stacked.
        kernel: (q, v, data) -> forces (n,), energy terms (3,), own outputs.
        data: the law's constants, a NamedTuple.
        outputs: names of the values behind the energy terms.
        valid_to: outputs above which the law does not hold any more, and their bounds.
        tangent: (q, v, data, factor_q, factor_v, tangent) -> the kernel's output; adds factor_q dF/dq +
            factor_v dF/dv to `tangent` (n, n), to a few per cent of its largest entry or better. A law
            without one is differentiated by differences.
    """

    name: str
    bodies: tuple[str, ...]
    kernel: Callable[[np.ndarray, np.ndarray, Any], np.ndarray]
    data: Any
    outputs: tuple[str, ...] = ()
    valid_to: Mapping[str, float] = field(default_factory=dict)
    tangent: Callable[..., np.ndarray] | None = None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(COORDINATES[body] for body in self.bodies)

    def evaluate(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces, energy terms and own outputs for one state (n,), (n,)."""
        return self.kernel(q, v, self.data)
