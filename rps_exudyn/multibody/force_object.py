"""A force element as an Exudyn object: an `ObjectGenericODE2`, massless but for modes of bending.

Unlike a connector between separated markers it carries its own lever arms, so moments balance exactly.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.forces.memory import NO_MEMORY

if TYPE_CHECKING:
    import exudyn


def add_forces(
    mbs: "exudyn.MainSystem",
    nodes: Sequence[Any],
    kernel: Callable[..., Any],
    data: Any,
    size: int,
    tangent: Callable[..., Any] | None = None,
    *,
    mass: np.ndarray | None = None,
    applied: Callable[[float], np.ndarray] | None = None,
    memory: np.ndarray = NO_MEMORY,
) -> Any:
    """Add an object with a compiled force law over the coordinates of some nodes.

    Args:
        kernel: (q, v, data) -> the forces (size,), and possibly more behind them.
        data: the law's constants; unpacking many takes long, a `Handle` on them does not.
        tangent: (q, v, data, factor_q, factor_v) -> factor_q dF/dq + factor_v dF/dv, shape (size, size);
            without it Exudyn takes differences through Python.
        mass: of these coordinates besides that of their bodies, shape (size, size); none by default.
        applied: forces (size,) at a time [s] that act besides.
        memory: of friction that remembers: told the time at which a step ends.
    """
    from exudyn.itemInterface import ObjectGenericODE2, VObjectGenericODE2

    def force(mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]) -> np.ndarray:
        memory[1, :1] = t
        return kernel(np.asarray(q), np.asarray(v), data)[:size]

    def force_with_applied(
        mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]
    ) -> np.ndarray:
        assert applied is not None
        return np.asarray(force(mbs, t, item, q, v) + applied(t))

    functions: dict[str, Any] = {"forceUserFunction": force if applied is None else force_with_applied}
    if tangent is not None:
        derivative = tangent

        def jacobian(
            mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float], fq: float, fv: float
        ) -> np.ndarray:
            memory[1, :1] = t
            return -derivative(np.asarray(q), np.asarray(v), data, fq, fv)  # of the left-hand side

        functions["jacobianUserFunction"] = jacobian
    return mbs.AddObject(
        ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((size, size)) if mass is None else mass,
            **functions,
            visualization=VObjectGenericODE2(show=False),
        )
    )
