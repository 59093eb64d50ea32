"""The verdict on a row from E = S - D and u_val^2 = u_num^2 + u_input^2 + u_D^2 (ASME V&V 20)."""

from enum import StrEnum

import numpy as np

COVERAGE = 2.0  # standard uncertainties that are 95 %


class Verdict(StrEnum):
    """What a row says."""

    AGREES = "agrees"
    NOISE = "within noise"
    WEAK = "consistent, weak"
    DISAGREES = "disagrees"
    NOT_COMPARABLE = "not comparable"

    @property
    def meaning(self) -> str:
        """What may be concluded."""
        return _MEANINGS[self]


_MEANINGS = {
    Verdict.AGREES: "E is within the criterion, and the uncertainties are small enough to tell",
    Verdict.NOISE: "|E| is below u_val: what is not known of the inputs or the data hides any error smaller",
    Verdict.WEAK: "|E| is up to 2 u_val, or a limit is kept: only gross errors are excluded",
    Verdict.DISAGREES: "|E| is beyond the criterion and beyond 2 u_val",
    Verdict.NOT_COMPARABLE: "S and D do not mean the same, or one of them is missing",
}


def verdict(error: float, uncertainty: float, allowed: float) -> Verdict:
    """Judge a row that compares with a value or a range.

    Args:
        error: E = S - D.
        uncertainty: u_val, standard.
        allowed: |E| up to which the criterion calls it agreement.
    """
    if not np.isfinite(error + uncertainty):
        return Verdict.NOT_COMPARABLE
    size = abs(error)
    if size <= allowed and COVERAGE * uncertainty <= allowed:
        return Verdict.AGREES
    if size > max(allowed, COVERAGE * uncertainty):
        return Verdict.DISAGREES
    return Verdict.NOISE if size <= uncertainty else Verdict.WEAK


def verdict_on_limit(error: float, uncertainty: float, side: int) -> Verdict:
    """Judge a row that compares with a limit: S must be at most (`side` +1) or at least (-1) D."""
    if not np.isfinite(error + uncertainty):
        return Verdict.NOT_COMPARABLE
    beyond = side * error
    if abs(beyond) <= COVERAGE * uncertainty:
        return Verdict.NOISE
    return Verdict.DISAGREES if beyond > 0 else Verdict.WEAK
