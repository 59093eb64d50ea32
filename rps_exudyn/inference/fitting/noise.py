"""The noise of measured passes, from what a fit leaves: white, correlated, and what changes from run to run.

What repeats with the teeth or the turn is no noise but an error of the model, and is left out first. The rest
is white noise and noise that keeps its sign over some degrees (an Ornstein-Uhlenbeck process); their sizes
are those of the greatest restricted likelihood (REML), which accounts for the fitted means and waves. A shift
of a whole pass cannot be seen in that pass: three runs or more show it, else it is declared.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rps_exudyn.inference.fitting.bench_tests import MeasuredPass
from rps_exudyn.inference.fitting.problem import LINEAR_TO, Noise, PassRows

PARTS = 72  # of a pass, whose means the likelihood is made of
LENGTHS = np.radians([4.0, 8.0, 15.0, 25.0, 40.0, 70.0])
RATIOS = (0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0)  # correlated over white standard deviation, of a part's mean
SURE = 4.0  # of twice the logarithm of the likelihood's ratio, above which correlation is believed
REPEATABILITY = 0.02  # of a run's level, declared where it was not measured
SENSOR = 0.005  # of the level: calibration, between tests
UNLIKE = 1e-3  # probability below which a test's scatter is taken for its own
FEWEST_RUNS = 3  # that measure the repeatability


@dataclass(frozen=True)
class NoiseEstimate:
    """The noise of one pass as far as its residuals show it."""

    white: float
    correlated: float
    length: float
    drift: float  # over the pass, of the mean level
    drift_sd: float


def found_noise(measured: MeasuredPass, rows: PassRows, white: float, pitch: float) -> NoiseEstimate:
    """Return the noise of one pass; `white` is what its neighbouring points show."""
    if not measured.test.of_kind.by_angle:  # its mean alone is compared
        return NoiseEstimate(white, 0.0, 0.0, 0.0, np.inf)
    held = np.clip(rows.deviation, -3 * LINEAR_TO * white * 2, 3 * LINEAR_TO * white * 2)
    angle, mean, count = _parts(measured.angle, held)
    level = float(np.abs(measured.value).mean())
    fixed = _waves(angle, pitch)
    if angle.size < fixed.shape[1] + 12:
        return NoiseEstimate(white, 0.0, 0.0, 0.0, np.inf)
    plain, best = _likelihood(angle, mean, count, fixed, 0.0, 1.0), (-np.inf, 0.0, LENGTHS[0])
    for ratio in RATIOS[1:]:
        for length in LENGTHS:
            best = max(best, (_likelihood(angle, mean, count, fixed, ratio, length)[0], ratio, length))
    correlated = 2 * (best[0] - plain[0]) > SURE
    chosen = _likelihood(angle, mean, count, fixed, *best[1:]) if correlated else plain
    slope, slope_sd = chosen[2]
    span = float(np.ptp(angle))
    per_point = float(np.sqrt(np.median(count)))
    return NoiseEstimate(
        white=max(white, chosen[1] * per_point),
        correlated=best[1] * chosen[1] if correlated else 0.0,
        length=float(best[2]) if correlated else 0.0,
        drift=float(slope) * span / level,
        drift_sd=float(slope_sd) * span / level,
    )


def _parts(angle: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle, mean and number of points in equal parts of the range; empty parts are left out."""
    edges = np.linspace(angle[0], angle[-1], PARTS + 1)
    where = np.clip(np.searchsorted(edges, angle, side="right") - 1, 0, PARTS - 1)
    count = np.bincount(where, minlength=PARTS)
    full = count > 0
    sums = (np.bincount(where, weights=each, minlength=PARTS)[full] for each in (angle, values))
    places, means = (each / count[full] for each in sums)
    return places, means, count[full]


def _waves(angle: np.ndarray, pitch: float) -> np.ndarray:
    """A constant, a slope and the waves of turn and teeth, shape (n, columns)."""
    columns = [np.ones_like(angle), angle - angle.mean()]
    span = float(np.ptp(angle))
    for wave in (1.0, 2.0, 2 * np.pi / pitch, 4 * np.pi / pitch):
        if span * wave > 0.8 * 2 * np.pi:
            columns += [np.cos(wave * angle), np.sin(wave * angle)]
    return np.column_stack(columns)


def _likelihood(
    angle: np.ndarray, mean: np.ndarray, count: np.ndarray, fixed: np.ndarray, ratio: float, length: float
) -> tuple[float, float, tuple[float, float]]:
    """Restricted log likelihood, white deviation of a part, slope over the angle and its deviation."""
    apart = np.abs(angle[:, None] - angle[None, :])
    covariance = ratio**2 * np.exp(-apart / length) + np.diag(np.median(count) / count)
    lower = np.linalg.cholesky(covariance)
    x, y = np.linalg.solve(lower, fixed), np.linalg.solve(lower, mean)
    normal = x.T @ x
    coefficients = np.linalg.solve(normal, x.T @ y)
    left, freedom = y - x @ coefficients, angle.size - fixed.shape[1]
    variance = float(left @ left) / freedom
    _, determinant = np.linalg.slogdet(normal)
    value = -0.5 * freedom * np.log(max(variance, 1e-300)) - np.log(np.diag(lower)).sum() - 0.5 * determinant
    slope_sd = float(np.sqrt(variance * np.linalg.inv(normal)[1, 1]))
    return float(value), float(np.sqrt(variance)), (float(coefficients[1]), slope_sd)


@dataclass(frozen=True)
class Repeats:
    """Scatter of the levels of runs of one test."""

    runs: int
    sd: float  # of one run's level
    freedom: int  # degrees of freedom of the deviation


def repeats_of(passes: Sequence[MeasuredPass], rows: Sequence[PassRows]) -> dict[str, Repeats]:
    """Return by test the scatter of its runs' levels, half the difference of both directions where there are
    both; tests with fewer than three runs are left out. Several tests share one scatter, see `_pooled`."""
    runs: dict[str, dict[tuple[int, int], dict[int, float]]] = {}
    seen: dict[tuple[str, int, int], int] = {}
    for each, row in zip(passes, rows, strict=True):
        key = (each.test.title, each.run, each.direction)
        seen[key] = seen.get(key, -1) + 1
        runs.setdefault(each.test.title, {}).setdefault((each.run, seen[key]), {})[each.direction] = row.mean
    found = {}
    for title, levels in runs.items():
        values = [
            (level[1] - level[-1]) / 2 if len(level) == 2 else next(sense * v for sense, v in level.items())
            for level in levels.values()
            if len(level) == max(map(len, levels.values()))
        ]
        if len(values) >= FEWEST_RUNS:
            found[title] = Repeats(len(values), float(np.std(values, ddof=1)), len(values) - 1)
    frictions = {each.test.title: friction_part(passes, each) for each in passes}
    return _pooled(found, frictions)


def _pooled(found: dict[str, Repeats], frictions: dict[str, float]) -> dict[str, Repeats]:
    """Return the scatter of several tests as one of their friction, which all their runs tell together.

    Where a test scatters more than chance lets it, each keeps its own.
    """
    if len(found) < 2 or not all(frictions[title] > 0 for title in found):
        return found
    freedom = sum(each.freedom for each in found.values())
    parts = {title: each.sd / frictions[title] for title, each in found.items()}
    sums = {title: each.freedom * parts[title] ** 2 for title, each in found.items()}
    variance = sum(sums.values()) / freedom
    if any(sums[title] > _most(each.freedom) * variance for title, each in found.items()):
        return found
    return {
        title: Repeats(each.runs, float(np.sqrt(variance)) * frictions[title], freedom)
        for title, each in found.items()
    }


def _most(freedom: int) -> float:
    """The quantile 1 - `UNLIKE` of chi squared."""
    from scipy.special import chdtri

    return float(chdtri(freedom, UNLIKE))


def noises_of(
    passes: Sequence[MeasuredPass],
    found: Sequence[NoiseEstimate],
    repeats: dict[str, Repeats],
    several_tests: bool,
) -> list[Noise]:
    """Return the noise of each pass: from repeats where there are three, else with what is declared where
    tests are compared with each other, or where correlated noise says that a pass is not what another is."""
    noises = []
    paired = np.sqrt(2.0)  # of two directions whose half difference scatters by it
    for each, own in zip(passes, found, strict=True):
        if each.test.title in repeats:
            noises.append(Noise(own.white, 0.0, 0.0, max(paired * repeats[each.test.title].sd, 1e-9)))
            continue
        shift = paired * REPEATABILITY * friction_part(passes, each)
        shifts = several_tests or own.correlated > 0
        correlated = own.correlated if each.test.of_kind.by_angle else 0.0
        noises.append(Noise(own.white, correlated, own.length, shift if shifts else 0.0))
    return noises


def friction_part(passes: Sequence[MeasuredPass], of: MeasuredPass) -> float:
    """Return the part of a pass' level that friction makes: half the difference of both directions.

    Of a test that was measured one way it is all of the level.
    """
    means = {
        sense: [each.value.mean() for each in passes if each.test == of.test and each.direction == sense]
        for sense in (1, -1)
    }
    if not (means[1] and means[-1]):
        return float(np.abs(of.value.mean()))
    return float(abs(np.mean(means[1]) - np.mean(means[-1])) / 2)
