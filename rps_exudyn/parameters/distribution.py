"""Distributions that a parameter may carry instead of one value, written as text.

    "300 N +- 30 N"            normal: mean and standard deviation; also "300 N +- 10 %", of the mean
    "normal(300 N, 30 N)"      the same
    "uniform(200 N, 400 N)"    least and most
    "loguniform(1 N, 100 N)"   likewise, even in the logarithm
    "lognormal(0.1, 1.3)"      median and factor: 68 % lie within median / factor and median * factor

Normal and log-normal distributions end at three standard deviations, so that every one has ends that can be
compared with what the parameter allows.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from rps_exudyn.base.units import difference_to_si, shown, to_si

CUT = 3.0  # standard deviations at which normal distributions end
_PLUS_MINUS = re.compile(r"\s*(?P<first>.+?)\s*(?:\+-|\+/-|±)\s*(?P<second>.*\S)?\s*")
_CALL = re.compile(r"\s*(?P<kind>[A-Za-z-]+)\s*\(\s*(?P<first>[^(),]+?)\s*,\s*(?P<second>[^(),]+?)\s*\)\s*")


class _Kind(NamedTuple):
    """What the two numbers of a kind are, and which of them can be drawn from."""

    numbers: str
    drawable: Callable[[float, float], bool]


KINDS = {
    "uniform": _Kind("[least, most] with least below most", lambda least, most: least < most),
    "loguniform": _Kind(
        "[least, most], both above 0, with least below most", lambda least, most: 0 < least < most
    ),
    "normal": _Kind(
        "[mean, standard deviation] with a deviation above 0", lambda mean, deviation: deviation > 0
    ),
    "lognormal": _Kind(
        "[median, factor] with a median above 0 and a factor above 1",
        lambda median, factor: median > 0 and factor > 1,
    ),
}


@dataclass(frozen=True)
class Distribution:
    """A distribution by its kind and two numbers in SI, see `KINDS`."""

    kind: str
    first: float
    second: float

    @classmethod
    def read(cls, text: str, si_unit: str) -> "Distribution":
        """Return the distribution that a text writes, its numbers in `si_unit`.

        Raises:
            ValueError: the text is none, or one that cannot be: "is ..., which ...", without a full stop.
        """
        found = _CALL.fullmatch(text)
        kind = found["kind"].lower().replace("-", "") if found else "normal"
        found = found or _PLUS_MINUS.fullmatch(text)
        if found is None or kind not in KINDS:
            raise ValueError(f"is {shown(text)}; a distribution is written {_EXAMPLES}")
        first, number = to_si(found["first"], si_unit), found["second"] or "nothing"
        if kind == "normal" and number.endswith("%") and not found["first"].endswith("%"):
            second = abs(first) * to_si(number, "")
        else:
            unit = "" if kind == "lognormal" else si_unit
            second = difference_to_si(number, unit) if kind == "normal" else to_si(number, unit)
        if not (math.isfinite(first) and math.isfinite(second) and KINDS[kind].drawable(first, second)):
            raise ValueError(f"is {shown(text)}; the numbers of {kind} must be {KINDS[kind].numbers}")
        return cls(kind, first, second)

    @property
    def nominal(self) -> float:
        """The median, which a run without a band takes."""
        if self.kind == "uniform":
            return (self.first + self.second) / 2
        return math.sqrt(self.first * self.second) if self.kind == "loguniform" else self.first

    @property
    def ends(self) -> tuple[float, float]:
        """Least and greatest value that can be drawn."""
        low, high = self.quantile(0.0), self.quantile(1.0)
        return float(low), float(high)

    def quantile(self, u: Any) -> Any:
        """Return the values below which the fractions `u` (0 to 1, any shape) lie."""
        first, second = self.first, self.second
        if self.kind == "uniform":
            return first + u * (second - first)
        if self.kind == "loguniform":
            return first * (second / first) ** u
        deviations = _normal_quantile(u)
        return first + second * deviations if self.kind == "normal" else first * second**deviations

    def quantiles(self, fractions: Any) -> list[float]:
        """Return the quantile of each of many fractions (an array), as `quantile` finds it alone, to the bit.

        Powers are taken one by one: over an array they may round otherwise, and values name a study's cases.
        """
        first, second = self.first, self.second
        if self.kind not in ("normal", "lognormal"):
            return [float(self.quantile(u)) for u in fractions.tolist()]
        deviations = _normal_quantile(fractions).tolist()
        if self.kind == "normal":
            return [first + second * deviation for deviation in deviations]
        return [float(first * second**deviation) for deviation in deviations]

    def density(self, x: Any) -> Any:
        """Return the probability density at values (any shape), 0 beyond the ends."""
        import numpy as np
        from scipy.special import ndtr

        low, high = self.ends
        at = np.clip(x, low, high)
        inverse = 1 / at if self.kind.startswith("log") else 1.0
        first, second = (
            np.log([self.first, self.second]) if self.kind.startswith("log") else (self.first, self.second)
        )
        if self.kind.endswith("uniform"):
            found = np.full(np.shape(at), 1 / (second - first))
        else:
            deviations = ((np.log(at) if self.kind == "lognormal" else at) - first) / second
            inside = second * math.sqrt(2 * math.pi) * (ndtr(CUT) - ndtr(-CUT))
            found = np.exp(-(deviations**2) / 2) / inside
        return np.where(at == x, found * inverse, 0.0)

    def scaled(self, value: float) -> "Distribution":
        """Return the distribution of this one times a value above 0."""
        width = 1.0 if self.kind == "lognormal" else value
        return Distribution(self.kind, self.first * value, self.second * width)

    def moved(self, value: float) -> "Distribution":
        """Return the distribution of a uniform or normal one plus a value."""
        most = value if self.kind == "uniform" else 0.0
        return Distribution(self.kind, self.first + value, self.second + most)


def is_distribution(value: object) -> bool:
    """Return whether a value is text that writes a distribution, right or wrong."""
    return isinstance(value, str) and bool(_CALL.fullmatch(value) or _PLUS_MINUS.fullmatch(value))


_EXAMPLES = '"300 N +- 30 N", "300 N +- 10 %", "uniform(200 N, 400 N)" or "lognormal(300 N, 1.2)"'


def _normal_quantile(u: Any) -> Any:
    """Deviations from the mean of a normal distribution that ends at `CUT`, in standard deviations."""
    import numpy as np  # with scipy for those who draw, not for each command that reads parameters
    from scipy.special import ndtr, ndtri

    within = ndtr(-CUT) + np.asarray(u) * (ndtr(CUT) - ndtr(-CUT))
    return np.clip(ndtri(within), -CUT, CUT)
