"""A number with its interval and the verdict on it: rows of requirements, of validations, and of fits."""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite

from rps_exudyn.results.outcome import MeaningEnum


class Verdict(MeaningEnum):
    """All verdicts on rows; `meaning` is what may be concluded, of a fitted parameter the verdict itself."""

    # on a requirement
    PASS = "pass", "enough of the gears keep the limit"
    FAIL = "fail", "too few of the gears keep the limit"
    UNDECIDED = "open", "failed samples decide"
    NOT_EVALUATED = "not evaluated", "the number cannot be computed for this gear"

    # on a comparison with data
    AGREES = "agrees", "E is within the criterion, and so is 2 u_val"
    NOISE = (
        "within noise",
        "|E| is below u_val, or only some gears keep a limit: the uncertainty is too large",
    )
    WEAK = (
        "consistent, weak",
        "|E| is up to 2 u_val, or 95 % of the gears keep a limit: only gross errors are excluded",
    )
    DISAGREES = (
        "disagrees",
        "|E| is beyond the criterion and beyond 2 u_val, or 95 % of the gears exceed a limit",
    )
    KEPT_BY_ANY = (
        "kept by any gear",
        "every sampled gear stays below half of the limit: the row tests nothing",
    )
    CALIBRATED = "calibrated", "the inputs were fitted to this row, so it tests nothing"
    NOT_COMPARABLE = "not comparable", "S and D are different quantities, or one is missing"

    # on a fitted parameter
    FOUND = "found"
    BY_PRIOR = "follows from other priors"
    OPEN = "not separable"
    NOT_MOVED = "not identifiable (prior kept)"
    NOT_ZERO = "found, differs from zero"
    MAYBE_ZERO = "not different from zero"
    BY_RATIO = "drag without yoke, times an estimated ratio"
    UNEXPLAINED = "not identifiable: the residual exceeds the noise"


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
    """A number that is judged, SI; nan where there is none."""

    name: str
    value: float
    low: float  # 5 % of its band, or the begin of the 95 % interval of a fit; the number itself without ...
    high: float  # ... and 95 %, or the end
    verdict: Verdict
    remark: str = ""  # cause or hint

    @property
    def is_known(self) -> bool:
        return isfinite(self.value)

    def band_shown(self, show: Callable[[float], str]) -> str:
        """Return the band for a reader, "" without one; `show` turns a number into text."""
        if not self.is_known or self.low == self.high:
            return ""
        return f"{show(self.low)} to {show(self.high)}"
