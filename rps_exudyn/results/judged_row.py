"""A number with its interval and the verdict on it: rows of requirements, of validations, and of fits."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite


class Verdict(StrEnum):
    """All verdicts on rows."""

    # on a requirement
    PASS = "pass"
    FAIL = "fail"
    UNDECIDED = "open"
    NOT_EVALUATED = "not evaluated"

    # on a comparison with data
    AGREES = "agrees"
    NOISE = "within noise"
    WEAK = "consistent, weak"
    DISAGREES = "disagrees"
    KEPT_BY_ANY = "kept by any gear"
    CALIBRATED = "calibrated"
    NOT_COMPARABLE = "not comparable"

    # on a fitted parameter
    FOUND = "found"
    BY_PRIOR = "follows from other priors"
    OPEN = "not separable"
    NOT_MOVED = "not identifiable (prior kept)"
    NOT_ZERO = "found, differs from zero"
    MAYBE_ZERO = "not different from zero"
    BY_RATIO = "drag without yoke, times an estimated ratio"
    UNEXPLAINED = "not identifiable: the residual exceeds the noise"

    @property
    def meaning(self) -> str:
        """What may be concluded; of a fitted parameter the verdict itself."""
        return _MEANINGS.get(self, str(self))


_MEANINGS = {
    Verdict.PASS: "enough of the gears keep the limit",
    Verdict.FAIL: "too few of the gears keep the limit",
    Verdict.UNDECIDED: "failed samples decide",
    Verdict.NOT_EVALUATED: "the number cannot be computed for this gear",
    Verdict.AGREES: "E is within the criterion, and so is 2 u_val",
    Verdict.NOISE: "|E| is below u_val, or only some gears keep a limit: the uncertainty is too large",
    Verdict.WEAK: "|E| is up to 2 u_val, or 95 % of the gears keep a limit: only gross errors are excluded",
    Verdict.DISAGREES: "|E| is beyond the criterion and beyond 2 u_val, or 95 % of the gears exceed a limit",
    Verdict.KEPT_BY_ANY: "every sampled gear stays below half of the limit: the row tests nothing",
    Verdict.CALIBRATED: "the inputs were fitted to this row, so it tests nothing",
    Verdict.NOT_COMPARABLE: "S and D are different quantities, or one is missing",
}
ON_COMPARISONS = (
    Verdict.AGREES,
    Verdict.NOISE,
    Verdict.WEAK,
    Verdict.DISAGREES,
    Verdict.KEPT_BY_ANY,
    Verdict.CALIBRATED,
    Verdict.NOT_COMPARABLE,
)


@dataclass(frozen=True, kw_only=True)
class JudgedRow:
    """A number that is judged, SI; nan where there is none.

    Attributes:
        name: what is judged.
        value: the number.
        low, high: 5 % and 95 % of its band, or the 95 % interval of a fit; the number itself without.
        verdict: on it.
        remark: cause or hint.
    """

    name: str
    value: float
    low: float
    high: float
    verdict: Verdict
    remark: str = ""

    @property
    def is_known(self) -> bool:
        """Whether there is a number."""
        return isfinite(self.value)

    def band_shown(self, show: Callable[[float], str]) -> str:
        """Return the band for a reader, "" without one; `show` turns a number into text."""
        if not self.is_known or self.low == self.high:
            return ""
        return f"{show(self.low)} to {show(self.high)}"
