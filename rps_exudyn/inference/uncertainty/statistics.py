"""Statistics of drawn numbers: quantiles with their errors, and the contribution of each input."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial.legendre import legval

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Fractions below the quantiles: the band of 90 %, that of 50 %, and the median."""

MEDIAN = LEVELS.index(0.5)
RESAMPLES, SEED = 200, 0


@dataclass(frozen=True, eq=False)
class Quantiles:
    """Quantiles of one number at `LEVELS`, in its SI unit, shape (5,) each."""

    values: np.ndarray
    errors: np.ndarray  # standard errors, by bootstrap
    lowest: np.ndarray  # what they would be with every failed sample below all others, -inf: unknown
    highest: np.ndarray  # likewise above, inf: unknown

    @property
    def low(self) -> float:
        """Lower end of the band of 90 %."""
        return float(self.values[0])

    @property
    def median(self) -> float:
        return float(self.values[MEDIAN])

    @property
    def high(self) -> float:
        """Upper end of the band of 90 %."""
        return float(self.values[-1])

    @property
    def half_width(self) -> float:
        """Half the width of the band of 90 %."""
        return (self.high - self.low) / 2

    @property
    def standard(self) -> float:
        """Standard uncertainty of a normal distribution with the same band of 90 %."""
        return self.half_width / 1.6449


def quantiles(numbers: np.ndarray, failed: int = 0, resampled: np.ndarray | None = None) -> Quantiles:
    """Return the quantiles of finite numbers of shape (n,), beside which `failed` samples gave none.

    `resampled` are the numbers drawn again, shape (resamples, n), where they depend on each other; by default
    they are drawn with replacement.
    """
    if resampled is None:
        rng = np.random.default_rng(SEED)
        resampled = numbers[rng.integers(0, numbers.size, (RESAMPLES, numbers.size))]
    values = np.quantile(numbers, LEVELS)
    errors = np.quantile(resampled, LEVELS, axis=1).std(axis=1)
    whole, known = numbers.size + failed, np.sort(numbers)
    below = (np.array(LEVELS) * (whole - 1) - failed) / max(numbers.size - 1, 1)
    above = np.array(LEVELS) * (whole - 1) / max(numbers.size - 1, 1)
    return Quantiles(values, errors, _at(known, below, -np.inf), _at(known, above, np.inf))


@dataclass(frozen=True, eq=False)
class NumericalError:
    """Numerical error of drawn numbers, as half widths of bars; inf: unknown.

    Attributes:
        of_sample: the median of the samples' bars; the largest is that of one gear alone.
        of_quantiles: by how far the quantiles move if all samples are wrong by their bars to the same side,
            shape (5,): neighbouring gears have the same bias, so that it does not average out.
    """

    of_sample: float
    of_quantiles: np.ndarray


def numerical_error(numbers: np.ndarray, bars: np.ndarray) -> NumericalError:
    """Return the numerical error of finite numbers (n,) from their bars (n,), nan where unknown."""
    bars = np.where(np.isfinite(bars), bars, np.inf)
    moved = [numbers - bars, numbers, numbers + bars]
    down, as_is, up = np.quantile(moved, LEVELS, axis=1, method="nearest").T
    return NumericalError(float(np.quantile(bars, 0.5, method="nearest")), np.fmax(as_is - down, up - as_is))


def _at(known: np.ndarray, levels: np.ndarray, beyond: float) -> np.ndarray:
    """Quantiles at levels of which those outside 0 to 1 are not known."""
    inside = (levels >= -1e-9) & (levels <= 1 + 1e-9)
    return np.where(inside, np.quantile(known, np.clip(levels, 0, 1)), beyond)


# --- Which input makes a number uncertain: fractions of its variance, from random or Latin-hypercube points
#
# The number is fitted by a sum of polynomials of one input each, in the input's own quantile u; the variance
# of each polynomial over u is the input's contribution (its first-order Sobol index), what no sum explains is
# due to inputs acting together, and to what the polynomials cannot follow. Legendre polynomials are
# orthogonal over u, so that variances are sums of squared coefficients; what chance adds to them is taken
# off. Inputs that vary together have one contribution, the variance of the sum of their polynomials.

POINTS_PER_TERM = 8  # least
FEWEST_PER_TERM = 2  # up to parabolas: a number may be as large for both signs of an error
PARABOLA, HIGHEST_DEGREE = 2, 3


@dataclass(frozen=True)
class Effect:
    """What an input does to a number: the slope of the straight line through its polynomial, SI."""

    slope: float
    error: float  # standard error of the slope
    elasticity: (
        float  # per cent of the number for a per cent of the input; nan where one of them changes sign
    )

    @property
    def is_clear(self) -> bool:
        """Whether chance does not explain its sign."""
        return abs(self.slope) > 2 * self.error

    @property
    def words(self) -> str:
        """Its sign, with the elasticity where there is one; "" of an effect that chance explains."""
        if not self.is_clear:
            return ""
        if np.isnan(self.elasticity):
            return "+" if self.slope > 0 else "−"
        return f"{self.elasticity:+.2g}".replace("-", "−")


@dataclass(frozen=True, eq=False)
class Contributions:
    """Fractions of the variance, most first."""

    fractions: dict[str, float]  # input -> its own
    together: float  # not explained by single inputs
    error: float  # standard error of a fraction, by the number of points
    effects: Mapping[str, Effect] = field(default_factory=dict)  # of each input, also of those in a group

    def effect_of(self, group: str) -> str:
        """Return the effects of a group's inputs, one after the other, "" where none is clear."""
        paths = [path for path in self.effects if path in group.split(" with ")]
        shown = [self.effects[path].words for path in paths]
        return ", ".join(each or "?" for each in shown) if any(shown) else ""


def legendre_terms(u: np.ndarray, degree: int) -> np.ndarray:
    """Return 1 and the polynomials of each input at quantiles (n, inputs), shape (n, 1 + inputs degree)."""
    columns = [  # of mean 0 and variance 1 over 0 to 1
        np.sqrt(2 * d + 1) * legval(2 * each - 1, np.eye(d + 1)[d])
        for each in u.T
        for d in range(1, degree + 1)
    ]
    return np.stack([np.ones(len(u)), *columns], axis=1)


@dataclass(frozen=True, eq=False)
class Polynomials:
    """Polynomials of single inputs at some points, to which any number of metrics is fitted."""

    groups: Mapping[str, Sequence[int]]  # name -> numbers of its inputs
    degree: int  # 0 where there are too few points
    terms: np.ndarray  # (n, 1 + inputs degree)
    inverse: np.ndarray  # of the terms, (1 + inputs degree, n)
    values: Mapping[str, np.ndarray]  # input -> its values (n,), SI

    @classmethod
    def at(
        cls,
        u: np.ndarray,
        groups: Mapping[str, Sequence[int]],
        values: Mapping[str, np.ndarray] | None = None,
    ) -> "Polynomials":
        """From quantiles of the inputs, shape (n, inputs), even over 0 to 1, of independent groups; with the
        values of all inputs contributions have effects."""
        count, inputs = u.shape
        degree = min(HIGHEST_DEGREE, count // (POINTS_PER_TERM * inputs))
        degree = max(degree, min(PARABOLA, (count // FEWEST_PER_TERM - 1) // inputs))
        terms = legendre_terms(u, degree)
        return cls(groups, degree, terms, np.linalg.pinv(terms), values or {})

    def contributions(self, numbers: np.ndarray) -> Contributions | None:
        """Return what each group contributes to the variance of finite numbers at the points, shape (n,);
        None if they do not vary, or are too few."""
        if not np.ptp(numbers) > 1e-9 * np.abs(numbers).max():
            return None
        if self.degree < 1:  # one group: nothing else varies
            return Contributions(dict.fromkeys(self.groups, 1.0), 0.0, 0.0) if len(self.groups) == 1 else None
        count = len(numbers)
        scaled = (numbers - numbers.mean()) / numbers.std()
        coefficients = self.inverse @ scaled
        left = scaled - self.terms @ coefficients
        noise = float(left @ left) / max(count - self.terms.shape[1], 1)
        effects = self._effects(numbers, np.sqrt(noise) * numbers.std())
        if len(self.groups) == 1:
            return Contributions(dict.fromkeys(self.groups, 1.0), 0.0, 0.0, effects)
        chance = noise * (self.inverse[1:] ** 2).sum(axis=1)
        single = (coefficients[1:] ** 2 - chance).reshape(-1, self.degree).sum(axis=1)
        found = [
            single[group[0]] if len(group) == 1 else self._together(group, coefficients, noise)
            for group in self.groups.values()
        ]
        each = np.maximum(found, 0.0)
        whole = float(each.sum()) + noise  # not the sample's variance, which chance correlations change
        shares = zip(self.groups, (each / whole).tolist(), strict=True)
        fractions = dict(sorted(shares, key=lambda pair: -pair[1]))
        error = float(2 * np.sqrt(self.degree * chance.mean()))
        return Contributions(fractions, noise / whole, error, effects)

    def _effects(self, numbers: np.ndarray, noise: float) -> dict[str, Effect]:
        """The straight line through each input's polynomial over its values; `noise` is the standard
        deviation of what the polynomials leave."""
        found = {}
        for i, (path, values) in enumerate(self.values.items()):
            columns = slice(1 + i * self.degree, 1 + (i + 1) * self.degree)
            centred = values - values.mean()
            if not (variance := float(centred @ centred)):
                continue
            weights = (centred @ self.terms[:, columns]) @ self.inverse[columns] / variance
            slope, changes_sign = float(weights @ numbers), values.min() * values.max() < 0
            changes_sign |= bool(numbers.min() * numbers.max() <= 0)
            elasticity = np.nan if changes_sign else slope * float(values.mean() / numbers.mean())
            found[path] = Effect(slope, noise * float(np.linalg.norm(weights)), elasticity)
        return found

    def _together(self, group: Sequence[int], coefficients: np.ndarray, noise: float) -> float:
        """Variance of the sum of a group's polynomials, without what chance adds."""
        columns = [1 + i * self.degree + d for i in group for d in range(self.degree)]
        terms, inverse = self.terms[:, columns], self.inverse[columns]
        chance = noise * float(np.sum((terms.T @ terms) * (inverse @ inverse.T))) / len(terms)
        return float(np.var(terms @ coefficients[columns])) - chance
