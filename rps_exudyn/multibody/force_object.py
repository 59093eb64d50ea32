"""A force element as an Exudyn object: an `ObjectGenericODE2`, massless but for modes of bending.

Unlike a connector between separated markers it carries its own lever arms, so moments balance exactly.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.forces.friction import TIME

if TYPE_CHECKING:
    import exudyn


def add_forces(
    mbs: "exudyn.MainSystem",
    nodes: Sequence[Any],
    size: int,
    force_of: Callable[[np.ndarray, np.ndarray], np.ndarray],
    tangent_of: Callable[[np.ndarray, np.ndarray, float, float], np.ndarray],
    *,
    memory: np.ndarray | None = None,
    mass: np.ndarray | None = None,
    applied: Callable[[float], np.ndarray] | None = None,
) -> Any:
    """Add an object with a law of forces, and its Jacobian, over the coordinates of some nodes.

    Args:
        mbs: the system.
        nodes: whose coordinates the law takes, one after the other.
        size: number of coordinates.
        force_of: (q, v) -> forces (size,).
        tangent_of: (q, v, factor_q, factor_v) -> factor_q dF/dq + factor_v dF/dv, shape (size, size).
        memory: state of the bristle friction, where the time at which a step ends is set.
        mass: of these coordinates besides that of their bodies, shape (size, size); none by default.
        applied: forces (size,) at a time [s] that act besides.
    """
    from exudyn.itemInterface import ObjectGenericODE2, VObjectGenericODE2

    def force(mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]) -> np.ndarray:
        if memory is not None:
            memory[1, TIME] = t
        return force_of(np.asarray(q), np.asarray(v))

    def force_with_applied(
        mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]
    ) -> np.ndarray:
        assert applied is not None
        return np.asarray(force(mbs, t, item, q, v) + applied(t))

    def jacobian(
        mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float], fq: float, fv: float
    ) -> np.ndarray:
        if memory is not None:
            memory[1, TIME] = t
        return -tangent_of(np.asarray(q), np.asarray(v), fq, fv)  # of the left-hand side

    return mbs.AddObject(
        ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((size, size)) if mass is None else mass,
            forceUserFunction=force if applied is None else force_with_applied,
            jacobianUserFunction=jacobian,
            visualization=VObjectGenericODE2(show=False),
        )
    )
