"""A force element as an Exudyn object: an `ObjectGenericODE2`, massless but for modes of bending.

Unlike a connector between separated markers it carries its own lever arms, so moments balance exactly.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.forces.memory import TIME

if TYPE_CHECKING:
    import exudyn


PLAIN_TANGENTS = 2  # in one time step, before the next ones are corrected
KEPT = 24  # evaluations of a time step that may correct them


class Secant:
    """Broyden's correction of the tangents in a time step that Newton's method does not solve at once.

    Where friction turns about within one iteration, tangents of both sides lead to and fro without end. With
    the change dF of force between the last place and an earlier one of the step, x apart, the tangent becomes

        T + (dF - T x) (W x)' / (x' W x),        W = |diag T|

    (C. G. Broyden, Math. Comp. 19 (1965), 577, in coordinates scaled by their own stiffnesses): with that one
    against which forces resist most, and only if they resist more than the tangent says.
    """

    def __init__(self) -> None:
        self.time, self.tangents = np.nan, 0
        self.rates: list[np.ndarray] = []
        self.forces: list[np.ndarray] = []

    def noted(self, time: float, rates: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Keep the forces (n,) at rates (n,) in the step that ends at a time [s]; return them."""
        if time != self.time:
            self.time, self.tangents = time, 0
            self.rates, self.forces = [], []
        self.rates, self.forces = [*self.rates[-KEPT:], rates], [*self.forces[-KEPT:], forces]
        return forces

    def corrected(self, tangent: np.ndarray, time: float, factor_v: float) -> np.ndarray:
        """Return the tangent (n, n) where the forces were found last, by the iteration's unknowns, of which
        one unit changes a rate by `factor_v`."""
        self.tangents += 1
        if self.tangents <= PLAIN_TANGENTS or time != self.time or len(self.rates) < 2:
            return tangent
        moves = (self.rates[-1] - np.array(self.rates[:-1])) / factor_v
        changes = self.forces[-1] - np.array(self.forces[:-1])
        sizes = moves**2 @ np.abs(np.diag(tangent))
        known = np.isfinite(changes).all(axis=1) & (sizes > 0) & (sizes < np.inf)
        if not known.any():
            return tangent
        moves, changes, sizes = moves[known], changes[known], sizes[known]
        k = int(np.argmin(np.einsum("ij,ij->i", moves, changes) / sizes))
        move, lacking = moves[k], changes[k] - tangent @ moves[k]
        if move @ lacking >= 0:
            return tangent
        return np.asarray(tangent + np.outer(lacking, np.abs(np.diag(tangent)) * move / sizes[k]))


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

    secant = Secant()

    def force(mbs: Any, t: float, item: int, q: Sequence[float], v: Sequence[float]) -> np.ndarray:
        if memory is not None:
            memory[1, TIME] = t
        rates = np.array(v)  # Exudyn uses its arrays again
        return secant.noted(t, rates, force_of(np.asarray(q), rates).copy())

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
        tangent = secant.corrected(tangent_of(np.asarray(q), np.asarray(v), fq, fv), t, fv)
        # an iteration may leave the law's range: Exudyn repeats such a step in a shorter one, but ends with
        # an error if the Jacobian before cannot be factorized
        return -tangent if np.isfinite(tangent.sum()) else np.zeros_like(tangent)  # of the left-hand side

    return mbs.AddObject(
        ObjectGenericODE2(
            nodeNumbers=list(nodes),
            massMatrix=np.zeros((size, size)) if mass is None else mass,
            forceUserFunction=force if applied is None else force_with_applied,
            jacobianUserFunction=jacobian,
            visualization=VObjectGenericODE2(show=False),
        )
    )
