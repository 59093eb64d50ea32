"""Tangents for Newton's method where friction turns about within a time step: Broyden's correction."""

import numpy as np

PLAIN_TANGENTS = 2  # in one time step, before the next ones are corrected
KEPT = 24  # evaluations of a time step that may correct them


class Secant:
    """Broyden's correction of the tangents in a time step that Newton's method does not solve at once.

    Where friction turns about within one iteration, tangents of both sides lead to and fro without end. With
    the change dF of force between the last place and an earlier one of the step, x apart, the tangent becomes

        T + (dF - T x) (W x)' / (x' W x),        W = |diag T|

    (C. G. Broyden, Math. Comp. 19 (1965), 577, in coordinates scaled by their own stiffnesses): with that one
    against which forces resist most, and only if they resist more than by the tangent.
    """

    def __init__(self) -> None:
        self.time, self.tangents = np.nan, 0
        self.rates: list[np.ndarray] = []
        self.forces: list[np.ndarray] = []

    def recorded(self, time: float, rates: np.ndarray, forces: np.ndarray) -> np.ndarray:
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
