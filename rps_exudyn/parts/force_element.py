"""Forces between bodies as one compiled function, the same for Exudyn and for the equilibrium solver.

A force element reads the coordinates q and rates v of its bodies, stacked in the order of `bodies`, and
returns one array: the generalised forces, then the ledger (what it stores and what it dissipates),
then values of its own, named in `outputs`. In Exudyn it is a massless `ObjectGenericODE2`: unlike a
connector between separated markers it carries its own lever arms, so moments balance exactly.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import exudyn

# The ledger, behind the generalised forces in every element's output
ELASTIC_ENERGY, FRICTION_POWER, DAMPING_POWER = 0, 1, 2
LEDGER_SIZE = 3

COORDINATES = {"pinion": 1, "rack": 6, "plunger": 1, "segment": 6}


@dataclass(frozen=True)
class ForceElement:
    """A compiled force law over the coordinates of some bodies.

    Attributes:
        name: which force this is, as in the results.
        bodies: the bodies whose coordinates it reads, in the order in which they are stacked.
        kernel: (q, v, data) -> forces (n,), ledger (3,), own outputs.
        data: the law's constants, a NamedTuple.
        outputs: names of the values behind the ledger.
        valid_to: outputs above which the law does not hold any more, and their bounds.
    """

    name: str
    bodies: tuple[str, ...]
    kernel: Callable[[np.ndarray, np.ndarray, Any], np.ndarray]
    data: Any
    outputs: tuple[str, ...] = ()
    valid_to: Mapping[str, float] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(COORDINATES[body] for body in self.bodies)

    def evaluate(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return self.kernel(q, v, self.data)

    def add_to(self, mbs: "exudyn.MainSystem", nodes: Mapping[str, Any]) -> Any:
        """Put the element into an Exudyn system; `nodes` maps body names to node numbers."""
        return add_forces(mbs, [nodes[body] for body in self.bodies], self.kernel, self.data, self.size)


def add_forces(
    mbs: "exudyn.MainSystem",
    nodes: Sequence[Any],
    kernel: Callable[..., Any],
    data: Any,
    size: int,
    tangent: Callable[..., Any] | None = None,
) -> Any:
    """A massless object with a compiled force law over the coordinates of some nodes.

    Args:
        kernel: (q, v, data) -> the forces (size,), and possibly more behind them.
        tangent: (q, v, data, factor_q, factor_v) -> factor_q dF/dq + factor_v dF/dv, shape (size, size);
            without it Exudyn takes differences through Python.
    """
    from exudyn.itemInterface import ObjectGenericODE2, VObjectGenericODE2

    def force(mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]) -> np.ndarray:
        return kernel(np.asarray(q), np.asarray(v), data)[:size]

    functions: dict[str, Any] = {"forceUserFunction": force}
    if tangent is not None:
        derivative = tangent

        def jacobian(
            mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float], fq: float, fv: float
        ) -> np.ndarray:
            return -derivative(np.asarray(q), np.asarray(v), data, fq, fv)  # of the left-hand side

        functions["jacobianUserFunction"] = jacobian
    return mbs.AddObject(
        ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((size, size)),
            **functions,
            visualization=VObjectGenericODE2(show=False),
        )
    )
