"""Inputs that vary together: pairs of a stated correlation, and the samples that a fit leaves.

    [correlation]                            # in a gear's file, or in a study's
    "mesh.friction, yoke.friction" = 0.5     # or "as one"

    [posterior]                              # as `fit` writes it, SI: the fitted value, then the samples;
    "yoke.preload" = [301.2, 288.7, ...]     # the values at one place of all lists are one sample

A correlation is that of the normal scores of both inputs (Gaussian copula), so that each keeps its own
distribution. Samples are drawn as they are, row by row.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import shown
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.gear import CORRELATION, POSTERIOR, SteeringGear

AS_ONE = "as one"
FEWEST_OF_POSTERIOR = 16  # samples
SAME = 1e-6  # of a value
LEAST_FRACTION = 1e-12  # below a quantile, of which there is a normal score
Pair = frozenset[str]


@dataclass(frozen=True)
class PosteriorValues(Distribution):
    """The values of one parameter in the samples of a posterior, in their order, SI; `first` is the fitted
    one."""

    values: tuple[float, ...] = ()

    @classmethod
    def of(cls, fitted: float, values: Sequence[float]) -> "PosteriorValues":
        """From the fitted value and those of all samples."""
        return cls("posterior", fitted, float(np.std(values)), tuple(values))

    def quantile(self, u: Any) -> Any:
        """Return the values below which the fractions `u` lie, between those of the samples."""
        count = len(self.values)
        return np.interp(u, (np.arange(count) + 0.5) / count, np.sort(self.values))

    @property
    def nominal(self) -> float:
        return self.first


@dataclass(frozen=True, eq=False)
class JointInputs(Mapping[str, Distribution]):
    """Path -> distribution of each input, and what they share."""

    each: Mapping[str, Distribution]
    pairs: Mapping[Pair, float] = field(default_factory=dict)  # both paths -> correlation
    parted: tuple[str, ...] = ()  # inputs of a posterior that are given instead, without what they share

    def __getitem__(self, path: str) -> Distribution:
        return self.each[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self.each)

    def __len__(self) -> int:
        return len(self.each)

    @classmethod
    def of(cls, inputs: Mapping[str, Distribution]) -> "JointInputs":
        """The inputs as they are, or independent ones of a plain mapping."""
        return inputs if isinstance(inputs, cls) else cls(inputs)

    @cached_property
    def posterior(self) -> dict[str, PosteriorValues]:
        """Inputs that are drawn from samples of a posterior."""
        return {path: each for path, each in self.each.items() if isinstance(each, PosteriorValues)}

    @cached_property
    def groups(self) -> dict[str, list[int]]:
        """Name -> numbers of the inputs that vary together; most inputs are alone."""
        return groups_of(list(self.each), self.pairs, list(self.posterior))

    def joined(self, unit: np.ndarray, seed: int) -> np.ndarray:
        """Return quantiles (n, inputs) of the inputs as they vary together, of independent ones."""
        names = list(self.each)
        quantile = correlated(unit, names, self.pairs)
        if self.posterior:
            at = [names.index(path) for path in self.posterior]
            quantile[:, at] = _rows([each.values for each in self.posterior.values()], len(unit), seed)
        return quantile


def groups_of(
    names: Sequence[str], pairs: Mapping[Pair, float], posterior: Sequence[str] = ()
) -> dict[str, list[int]]:
    """Return name -> numbers of the inputs that vary together, each input in one group."""
    owner = {name: {name} for name in names}
    for together in (*(pair for pair, value in pairs.items() if value), frozenset(posterior)):
        if together and together <= owner.keys():
            joined = set().union(*(owner[name] for name in together))
            owner.update(dict.fromkeys(joined, joined))
    found: dict[str, list[int]] = {}
    for name in names:
        group = [other for other in names if other in owner[name]]
        label = " with ".join(group) if len(group) < 3 else f"{group[0]} and {len(group) - 1} with it"
        found[label] = [names.index(other) for other in group]
    return found


def correlated(unit: np.ndarray, names: Sequence[str], pairs: Mapping[Pair, float]) -> np.ndarray:
    """Return quantiles (n, inputs) with correlated normal scores, of independent ones; inputs in no pair, and
    the first of each group, stay as they are.

    Raises:
        InputError: correlations that cannot be together.
    """
    found, used = unit.copy(), [name for name in names if any(name in pair for pair, r in pairs.items() if r)]
    if not used:
        return found
    from scipy.special import ndtr, ndtri  # for those who draw

    at = [names.index(name) for name in used]
    matrix = np.array([[1.0 if a == b else pairs.get(frozenset((a, b)), 0.0) for a in used] for b in used])
    if np.linalg.eigvalsh(matrix)[0] < -1e-9:
        pair = ", ".join(used)
        raise InputError(f"the correlations of {pair} cannot be together; make some of them smaller.")
    scores = ndtri(np.clip(unit[:, at], LEAST_FRACTION, 1 - LEAST_FRACTION))
    for j in range(1, len(used)):  # each by those before it, as Cholesky's factor, which may be singular
        weights = np.linalg.pinv(matrix[:j, :j], hermitian=True) @ matrix[:j, j]
        rest = max(0.0, 1.0 - float(weights @ matrix[:j, j]))
        if np.any(weights):
            scores[:, j] = scores[:, :j] @ weights + (rest**0.5 if rest > 1e-12 else 0.0) * scores[:, j]
            found[:, at[j]] = ndtr(scores[:, j])
    return found


def _rows(values: Sequence[Sequence[float]], count: int, seed: int) -> np.ndarray:
    """Quantiles (count, parameters) of rows of samples, all rows about equally often."""
    table = np.array(values).T
    ranks = np.argsort(np.argsort(table, axis=0), axis=0)
    rng = np.random.default_rng([seed, 1])
    chosen = np.concatenate([rng.permutation(len(table)) for _ in range(-(-count // len(table)))])[:count]
    return np.asarray((ranks[chosen] + 0.5) / len(table))


# --- The tables of a file


def read_pairs(table: Any, where: str, problems: list[str]) -> dict[Pair, float]:
    """Return both names -> correlation of a table; what is wrong is added to the problems."""
    if not isinstance(table, Mapping):
        problems.append(f'{where} is {shown(table)}; it must be a table of lines "A, B" = 0.5.')
        return {}
    found: dict[Pair, float] = {}
    for text, value in table.items():
        names = [name.strip() for name in text.split(",")]
        pair, number = frozenset(names), 1.0 if value == AS_ONE else value
        if len(names) != 2 or len(pair) != 2 or not all(names):
            problems.append(f'{where} has {shown(text)}; a correlation names two inputs, "A, B" = 0.5.')
        elif isinstance(number, bool) or not isinstance(number, int | float) or not -1 <= number <= 1:
            problems.append(f'{where}: {text} is {shown(value)}; it must be from -1 to 1, or "{AS_ONE}".')
        elif pair in found:
            problems.append(f"{where}: {text} is given twice.")
        else:
            found[pair] = float(number)
    return found


def check_posterior(each: PosteriorValues, item: Declared, value: float) -> list[str]:
    """Return a sentence if the gear's value is not the fitted one of the samples."""
    if abs(value - each.nominal) <= SAME * abs(each.nominal):
        return []
    return [
        f"{item.path} is {item.show(value)}, but {item.show(each.nominal)} in the table {POSTERIOR}; leave "
        "that table out, or give the value by --set."
    ]


def check_pairs(pairs: Mapping[Pair, float], inputs: Mapping[str, Distribution]) -> list[str]:
    """Return a sentence for each pair that names no input, or one of a posterior."""
    problems = []
    for name in (name for pair in pairs for name in sorted(pair)):
        if name not in inputs:
            varying = ", ".join(inputs)
            problems.append(f"{CORRELATION} names {name}, which does not vary; it must be one of {varying}.")
        elif isinstance(inputs[name], PosteriorValues):
            problems.append(f"{CORRELATION} names {name}, whose correlations are in the table {POSTERIOR}.")
    return problems


def read_posterior(table: Any, problems: list[str]) -> dict[str, PosteriorValues]:
    """Return path -> values of the table that a fit wrote; what is wrong is added to the problems."""
    if not isinstance(table, Mapping):
        problems.append(f"{POSTERIOR} is {shown(table)}; it must be the table that fit writes.")
        return {}
    found, counts = dict[str, PosteriorValues](), set()
    for path, values in table.items():
        listed = isinstance(values, list) and len(values) > FEWEST_OF_POSTERIOR
        if not listed or any(type(value) not in (int, float) or not np.isfinite(value) for value in values):
            problems.append(f"{POSTERIOR}: {path} must be a list of at least {FEWEST_OF_POSTERIOR} numbers.")
            continue
        fitted, *drawn = map(float, values)
        found[path] = PosteriorValues.of(fitted, drawn)
        counts.add(len(values))
    if len(counts) > 1:
        problems.append(
            f"{POSTERIOR} has lists of {' and '.join(map(str, sorted(counts)))} numbers; all must be as long."
        )
    return found


def posterior_table(gear: SteeringGear, samples: Mapping[str, np.ndarray]) -> str:
    """Return the table of samples, path -> (n,) in SI, as a gear's file holds it."""
    lines = []
    for path, values in samples.items():
        numbers = [repr(float(gear.value_at(path))), *(f"{value:.7g}" for value in values.tolist())]
        lines.append(f'"{path}" = [{", ".join(numbers)}]\n')
    head = f"[{POSTERIOR}]  # of the fit, for run --band and check: its value, then its samples, SI"
    return f"\n{head}\n{''.join(lines)}"
