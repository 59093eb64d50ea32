"""The noise of turned passes: resolution of the sensor, spikes, means of parts, and an averaged noise law.

The torque of a run to and fro is compared in parts of five degrees: half sum and half difference of both
directions. Noise that is independent in both directions has one law in both halves; friction that is locked
to the angle is in the half difference alone. The law is

    V = diag(median(n) / n) + r^2 exp(-|a - a'| / L) + t^2 x x'

with n points in a part, angles a and places x from -1/2 to 1/2 along the travel. The scale follows from the
restricted likelihood (REML); r, L and t are averaged over a grid by likelihood and prior, not chosen: one
turn does not show how long noise keeps its sign.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

PART = np.radians(5.0)  # a lag of a degree or two between both directions does no harm within it
MOST_PARTS, LEAST_PARTS = 144, 36
RATIOS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # r: correlated over white standard deviation of a part's mean
LENGTHS = np.radians([4.0, 8.0, 15.0, 25.0, 40.0, 70.0, 130.0, 360.0, 1000.0])  # L
TILTS = np.array([0.0, 2.0, 6.0, 20.0])  # t
LAWS = ((0.0, 1.0), *((ratio, float(length)) for ratio in RATIOS for length in LENGTHS))
WHITE_PRIOR, LEVEL_PRIOR = 0.8, 0.8  # of r = 0, and of t = 0; the others share the rest evenly
SMALLEST = 1e-4  # of the level: least standard deviation of a part
NORMAL = 1.959964  # quantile of 97.5 %

WINDOW = 9  # points of the running median that spikes are compared with
SPIKE = 5.0  # robust standard deviations
LONGEST_SPIKE, ABRUPT = 2, 0.4  # points, and what its neighbours are of it: edges of teeth rise less abruptly
ROUGH = 2e-3  # of the mean: what the teeth of a curve without noise deviate from its running median
COMB = 0.02  # of a step, by which values may miss a multiple of it


# --- Resolution and spikes, from the values as they were recorded


def resolution_of(values: np.ndarray) -> float:
    """Return the step of a sensor whose values (n,) are multiples of one; 0 if they are not.

    One value alone has the largest round step of which it is a multiple: 1, 2, 2.5 or 5 times a power of ten,
    or a power of two.
    """
    unique = np.unique(values)
    span = float(np.ptp(unique))
    unique = unique[np.append(True, np.diff(unique) > 1e-9 * span)] if span else unique[:1]
    if unique.size == 1:
        return _round_step(float(unique[0]))
    step = float(np.diff(unique).min())
    step = span / round(span / step)
    steps = (unique - unique[0]) / step
    return step if float(np.abs(steps - np.round(steps)).max()) < COMB else 0.0


def _round_step(value: float) -> float:
    if value == 0:
        return 0.0
    steps = [digit * 10.0**-power for power in range(7) for digit in (5.0, 2.5, 2.0, 1.0)]
    steps += [2.0**-power for power in range(20)]
    steps = [step for step in steps if step <= abs(value) and abs(value / step - round(value / step)) < 1e-6]
    return max(steps, default=0.0)


def robust_deviation(values: np.ndarray) -> float:
    """Return the standard deviation about zero of normal values (n,), by their median size."""
    return 1.4826 * float(np.median(np.abs(values)))


def white_deviation(values: np.ndarray) -> float:
    """Return the standard deviation of white noise that second differences of values (n,) show, robustly."""
    second = np.diff(values, 2)
    return float(robust_deviation(second) / np.sqrt(6.0)) if second.size > 4 else 0.0


def is_regular(values: np.ndarray, resolution: float) -> np.ndarray:
    """Return which values (n,) are no spikes, seen from their running median: shape (n,), bool."""
    if values.size < WINDOW:
        return np.ones(values.size, dtype=bool)
    held = np.pad(values, WINDOW // 2, mode="reflect")  # an outlier may be the first row
    smooth = np.median(np.lib.stride_tricks.sliding_window_view(held, WINDOW), axis=1)
    away = np.abs(values - smooth)
    rough = ROUGH * float(np.abs(values).mean())
    far = away > SPIKE * max(robust_deviation(away), resolution / np.sqrt(12.0), rough)
    begins = np.flatnonzero(far & ~np.append(False, far[:-1]))
    ends = np.flatnonzero(far & ~np.append(far[1:], False))
    regular = ~far
    for begin, end in zip(begins, ends, strict=True):
        beside = away[[i for i in (begin - 1, end + 1) if 0 <= i < away.size]]
        is_spike = end - begin < LONGEST_SPIKE and beside.max() < ABRUPT * away[begin : end + 1].min()
        regular[begin : end + 1] = not is_spike
    return regular


# --- Parts


@dataclass(frozen=True, eq=False)
class Parts:
    """Values of a run in parts of its travel; rows of `values` are compared, for instance both halves."""

    angle: np.ndarray  # mean angle of the points in each part [rad], shape (k,)
    place: np.ndarray  # the same along the travel, from -1/2 to 1/2
    points: np.ndarray  # values of a pass in each part
    values: np.ndarray  # shape (rows, k)

    @property
    def span(self) -> float:
        """Travel that the parts cover [rad]."""
        return float(np.ptp(self.angle)) * (1 + 1 / max(self.angle.size - 1, 1))

    @property
    def laws(self) -> "Laws":
        """All laws without tilt; parts of the same angles share them, as tests and gears of a bench do."""
        return _laws(self.angle.tobytes(), (np.median(self.points) / self.points).tobytes())


class Laws(NamedTuple):
    """Covariances of the parts over s^2 by all laws without tilt."""

    covariance: np.ndarray  # (laws, k, k)
    precision: np.ndarray  # the inverses
    logs: np.ndarray  # of the determinants, (laws,)


@lru_cache(maxsize=4)
def _laws(angles: bytes, white: bytes) -> Laws:
    angle = np.frombuffer(angles)
    apart = np.abs(angle[:, None] - angle[None, :])
    correlated = [ratio**2 * np.exp(-apart / length) for ratio, length in LAWS]
    covariance = np.diag(np.frombuffer(white)) + np.array(correlated)
    return Laws(covariance, np.linalg.inv(covariance), np.linalg.slogdet(covariance)[1])


def parts_of(passes: Sequence[tuple[np.ndarray, np.ndarray]], low: float, high: float) -> Parts:
    """Return the means of passes, each angles and values (n,), in equal parts from `low` to `high` [rad].

    Parts in which a pass has no point are left out.
    """
    count = int(np.clip(round((high - low) / PART), LEAST_PARTS, MOST_PARTS))
    count = max(1, min(count, *(angle.size for angle, _ in passes)))
    edges = np.linspace(low, high, count + 1)
    points, means, angles = [], [], []
    for angle, value in passes:
        inside = (angle >= low - 1e-9) & (angle <= high + 1e-9)
        where = np.clip(np.searchsorted(edges, angle[inside], side="right") - 1, 0, count - 1)
        counts = np.bincount(where, minlength=count)
        points.append(counts)
        angles.append(np.bincount(where, weights=angle[inside], minlength=count) / np.maximum(counts, 1))
        means.append(np.bincount(where, weights=value[inside], minlength=count) / np.maximum(counts, 1))
    full = np.min(points, axis=0) > 0
    middle = np.mean(angles, axis=0)
    place = (middle - (low + high) / 2) / (high - low)
    inverse = np.mean([1 / np.maximum(counts, 1) for counts in points], axis=0)
    return Parts(middle[full], place[full], 1 / inverse[full], np.array(means)[:, full])


def waves(angle: np.ndarray, span: float, orders: Sequence[float]) -> np.ndarray:
    """Return cosines and sines of these orders of a turn, as far as the travel covers them: (k, columns)."""
    kept = [each for each in orders if covers(span, each) and angle.size > 2.5 * each * span / (2 * np.pi)]
    columns = [np.column_stack([np.cos(order * angle), np.sin(order * angle)]) for order in kept]
    return np.hstack([np.empty((angle.size, 0)), *columns])


def covers(span: float, order: float) -> bool:
    """Return whether a travel [rad] shows a wave of this order of a turn."""
    return span * order > 0.8 * 2 * np.pi


# --- The averaged law


@dataclass(frozen=True, eq=False)
class Regression:
    """Columns of values on fixed effects, over the parts of one or several runs alike."""

    parts: Parts  # of the runs
    effects: np.ndarray  # shape (k, p)
    values: np.ndarray  # shape (k, runs)

    @property
    def freedom(self) -> int:
        return self.values.shape[1] * (self.effects.shape[0] - self.effects.shape[1])


@dataclass(frozen=True, eq=False)
class _Solved:
    """A regression by each law; all but `inverse` (cells, k, ...) per cell."""

    regression: Regression
    log: np.ndarray  # determinants' part of the likelihood
    squares: np.ndarray  # weighted sum of squares that is left
    coefficients: np.ndarray  # (cells, p, runs)
    normal: np.ndarray  # (cells, p, p)
    left: np.ndarray  # V^-1 (y - X b), (cells, k, runs)
    by_place: np.ndarray  # V^-1 x, (cells, k)


def _solved(regression: Regression, tilted: bool) -> _Solved:
    """Solve by all laws, `tilted` with all tilts: each adds t^2 x x' to a law, of rank 1 (Sherman and
    Morrison)."""
    parts, x, y = regression.parts, regression.effects, regression.values
    joined = np.hstack([x, y, parts.place[:, None]])
    laws = parts.laws
    inverse, logs = laws.precision @ joined, laws.logs
    if tilted:
        along = parts.place @ inverse  # x' V^-1 of all columns, (laws, columns)
        growth = 1 + TILTS**2 * along[:, -1:]  # of the determinant, (laws, tilts)
        taken = (TILTS**2 / growth)[:, :, None] * along[:, None, :]
        inverse = inverse[:, None] - inverse[:, None, :, -1:] * taken[:, :, None, :]
        inverse, logs = inverse.reshape(-1, *joined.shape), (logs[:, None] + np.log(growth)).ravel()
    size = x.shape[1]
    by_effects, by_values = inverse[:, :, :size], inverse[:, :, size:-1]
    normal, moments = x.T @ by_effects, x.T @ by_values
    coefficients = np.linalg.solve(normal, moments)
    squares = np.einsum("kr,ckr->c", y, by_values) - np.einsum("cpr,cpr->c", coefficients, moments)
    logs = logs + np.linalg.slogdet(normal)[1]
    left = by_values - by_effects @ coefficients
    log, squares = y.shape[1] * logs, np.maximum(squares, 0.0)
    return _Solved(regression, log, squares, coefficients, normal, left, inverse[:, :, -1])


@dataclass(frozen=True, eq=False)
class AveragedLaw:
    """The noise of half sums and half differences: weights of all laws of the grid, and the estimate by each.

    Cells are laws times tilts, tilts last. Half differences have a slope of their own and need no tilt.
    """

    weights: np.ndarray  # (cells,)
    variance: np.ndarray  # s^2 by cell
    freedom: int
    sums: Sequence[_Solved]  # by cell
    differences: Sequence[_Solved]  # by law

    @property
    def correlated(self) -> float:
        """Probability that noise keeps its sign from part to part."""
        return float(1 - self.weights[: TILTS.size].sum())

    def half_interval(self, variances: np.ndarray) -> float:
        """Half of the 95 % interval of a number whose variance by law is s^2 times `variances` (laws,)."""
        from scipy.optimize import brentq
        from scipy.special import stdtr, stdtrit

        deviations = np.sqrt(self.variance * np.repeat(variances, TILTS.size))
        if not deviations.max() > 0:
            return 0.0
        top = float(stdtrit(self.freedom, 0.975) * deviations.max())

        def beyond(half: float) -> float:
            return float(self.weights @ stdtr(self.freedom, half / deviations)) - 0.975

        return float(brentq(beyond, 0.0, top * (1 + 1e-9), xtol=1e-6 * top))

    def effect(self, solved: _Solved, column: int) -> tuple[np.ndarray, np.ndarray]:
        """Mean over the grid of two neighbouring effects of each run (runs, 2), and their variances (2,),
        within the laws and between them."""
        tilts = self.weights.size // solved.log.size
        weights = self.weights.reshape(solved.log.size, tilts)
        variance = (weights * self.variance.reshape(weights.shape)).sum(axis=1)
        found = solved.coefficients[:, column : column + 2]
        inverse = np.linalg.inv(solved.normal)
        within = np.stack([inverse[:, j, j] for j in range(column, column + 2)], axis=1)
        mean = np.einsum("c,cpr->rp", weights.sum(axis=1), found)
        between = np.einsum("c,cpr->p", weights.sum(axis=1), (found - mean.T) ** 2) / found.shape[2]
        return mean, variance @ within + between

    def square_of_tilt(self) -> float:
        """Mean square of the half sum's slope over the whole travel: of all runs, over the grid."""
        squares, runs = 0.0, 0
        for each in self.sums:
            place, x = each.regression.parts.place, each.regression.effects
            tilt = np.tile(TILTS, len(LAWS)) ** 2
            slope = tilt[:, None] * np.einsum("k,ckr->cr", place, each.left)
            moment = np.einsum("kp,ck->cp", x, each.by_place)
            explained = np.linalg.solve(each.normal, moment[:, :, None])[:, :, 0]
            spread = each.by_place @ place - np.einsum("cp,cp->c", moment, explained)
            variance = self.variance * np.maximum(tilt - tilt**2 * spread, 0.0)
            of_slopes = float(self.weights @ (slope**2).sum(axis=1))
            squares += of_slopes + slope.shape[1] * float(self.weights @ variance)
            runs += slope.shape[1]
        return squares / max(runs, 1)


def averaged_law(sums: Sequence[Regression], differences: Sequence[Regression], level: float) -> AveragedLaw:
    """Return the noise law of half sums and half differences, with one scale in all of them; `level` bounds
    the scale from below, `SMALLEST` of it."""
    by_cell = [_solved(each, True) for each in sums]
    by_law = [_solved(each, False) for each in differences]
    parts = [(each.squares, each.log) for each in by_cell]
    parts += [(each.squares.repeat(TILTS.size), each.log.repeat(TILTS.size)) for each in by_law]
    squares, logs = sum(part[0] for part in parts), sum(part[1] for part in parts)
    freedom = max(1, sum(each.freedom for each in (*sums, *differences)))
    variance = np.maximum(squares / freedom, (SMALLEST * level) ** 2)
    likelihood = -0.5 * freedom * np.log(variance) - 0.5 * logs
    of_laws, of_tilts = (
        [first, *[(1 - first) / (count - 1)] * (count - 1)]
        for first, count in ((WHITE_PRIOR, len(LAWS)), (LEVEL_PRIOR, TILTS.size))
    )
    prior = np.outer(of_laws, of_tilts).ravel()
    weights = prior * np.exp(likelihood - likelihood.max())
    return AveragedLaw(weights / weights.sum(), variance, freedom, by_cell, by_law)
