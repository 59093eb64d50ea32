"""A force element as an Exudyn object: an `ObjectGenericODE2`, massless but for modes of bending.

Unlike a connector between separated markers it carries its own lever arms, so moments balance exactly.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.forces.memory import TIME
from rps_exudyn.solvers.balance import Balance

if TYPE_CHECKING:
    import exudyn


def add_forces(
    mbs: "exudyn.MainSystem",
    nodes: Sequence[Any],
    balance: Balance,
    size: int,
    *,
    jacobian_of: Balance | None = None,
    mass: np.ndarray | None = None,
    applied: Callable[[float], np.ndarray] | None = None,
) -> Any:
    """Add an object with the forces of a gear, and their Jacobian, over the coordinates of some nodes.

    Args:
        mbs: the system.
        nodes: whose coordinates are those of the gear's stack.
        balance: the forces.
        size: number of coordinates.
        jacobian_of: other forces, of which the Jacobian is.
        mass: of these coordinates besides that of their bodies, shape (size, size); none by default.
        applied: forces (size,) at a time [s] that act besides.
    """
    from exudyn.itemInterface import ObjectGenericODE2, VObjectGenericODE2

    memory = balance.memory

    def force(mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]) -> np.ndarray:
        memory[1, TIME] = t
        return balance.force(np.asarray(q), np.asarray(v))

    def force_with_applied(
        mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]
    ) -> np.ndarray:
        assert applied is not None
        return np.asarray(force(mbs, t, item, q, v) + applied(t))

    of_tangent = jacobian_of or balance

    def jacobian(
        mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float], fq: float, fv: float
    ) -> np.ndarray:
        memory[1, TIME] = t
        tangent = of_tangent.force_and_tangent(np.asarray(q), np.asarray(v), fq, fv)[1]
        return -tangent  # of the left-hand side

    return mbs.AddObject(
        ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((size, size)) if mass is None else mass,
            forceUserFunction=force if applied is None else force_with_applied,
            jacobianUserFunction=jacobian,
            visualization=VObjectGenericODE2(show=False),
        )
    )
