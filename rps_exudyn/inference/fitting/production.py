"""A production lot: one free torque of each gear, their scatter, end-of-line limits, and drift.

Levels are found without a model (`level`). Their logarithms are normal about the lot's mean, each measured
with its own deviation (a hierarchical model); the scatter's posterior follows from the restricted likelihood
on a grid. Limits have guard bands and both risks of JCGM 106:2012, 9: that a gear is accepted and does not
conform (consumer's), that it is rejected and conforms (producer's). Drift shows in the exponentially weighted
moving average (ISO 7870-6), whose limit is the quantile of lots of as many gears without drift.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.inference.fitting.bench_tests import BenchTest, measurement_of
from rps_exudyn.inference.fitting.fit import check_sizes
from rps_exudyn.inference.fitting.identifiability import logarithmic_slopes
from rps_exudyn.inference.fitting.level import CALIBRATION, Runout, levels_of, runout_of
from rps_exudyn.inference.fitting.noise import NORMAL
from rps_exudyn.inference.fitting.prediction import formula_means
from rps_exudyn.inference.fitting.unknowns import LEVEL
from rps_exudyn.inference.measured.reading import TORQUE, read_curve
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.limit import Limit
from rps_exudyn.simulate.cases.run_cases import run_cases
from rps_exudyn.simulate.cases.task import Task

FEWEST = 5  # gears of a lot
SUFFIXES = (".csv", ".txt", ".dat", ".tsv", ".mf4", ".tdms", ".mat")
SECONDS_A_GEAR = 0.1  # of CPU time
CELLS = 400  # of the grid of the scatter
GUARD = 1.645  # deviations of a measurement: a gear at the limit is accepted in 5 % (ISO 14253-1)
WEIGHT = 0.2  # of a new gear in the moving average
FALSE_ALARMS = 0.01  # of lots without drift
DRAWN = 4000  # lots without drift that show the quantile
FREE = BenchTest("free")


@dataclass(frozen=True, eq=False)
class MeasuredGear:
    name: str
    level: float  # [N m]
    sd: float  # of one run, with repeatability, without the calibration that all share [N m]
    runout: Runout | None

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the level, calibration included [N m]."""
        half = NORMAL * float(np.hypot(self.sd, CALIBRATION * self.level))
        return self.level - half, self.level + half


def accepted_within(tolerance: Limit, guard: float) -> Limit:
    """Return the limits of acceptance, a guard band [N m] inside the tolerance of the free torque."""
    return replace(tolerance, least=tolerance.least + guard, most=tolerance.most - guard)


@dataclass(frozen=True)
class Risks:
    """Probabilities of JCGM 106 for a gear of the lot."""

    limits: Limit  # of acceptance
    consumer: float  # accepted and out of tolerance
    producer: float  # rejected and within tolerance


@dataclass(frozen=True, eq=False)
class Drift:
    """Moving average of the gears in their order."""

    average: np.ndarray  # [N m], (n,)
    limit: np.ndarray  # by which it may differ from the mean [N m], (n,)
    mean: float

    @property
    def alarms(self) -> np.ndarray:
        return np.flatnonzero(np.abs(self.average - self.mean) > self.limit)


@dataclass(frozen=True, eq=False)
class ProductionLot:
    """What a lot of measured gears shows."""

    gears: tuple[MeasuredGear, ...]  # in the order of their names
    refused: tuple[str, ...]  # files that were not read, and why
    mean: float  # of the levels, with calibration [N m]
    mean_sd: float  # its deviation [N m]
    scatter: tuple[float, float, float]  # between gears: median and 95 % interval, of the mean
    expected: np.ndarray  # levels drawn towards the mean as far as they are uncertain [N m], (n,)
    parameters: dict[str, tuple[float, float]]  # path -> mean and deviation (logarithm)
    alone: dict[str, float]  # path -> its scatter if no other parameter scatters
    drift: Drift

    @property
    def sd(self) -> float:
        """Usual deviation of a gear's measurement [N m]."""
        return float(np.median([each.sd for each in self.gears]))

    def risks(self, tolerance: Limit, guard: float) -> Risks:
        """Return the risks of limits that lie a guard band [N m] inside the tolerance.

        Raises:
            InputError: the tolerance is smaller than the guard bands.
        """
        accepted = accepted_within(tolerance, guard)
        if not accepted.least < accepted.most:
            raise InputError(
                f"tolerance {tolerance.least:.4g} to {tolerance.most:.4g} N m is smaller than the guard "
                f"bands ({guard:.3g} N m each); widen it, or measure each gear more often."
            )
        from scipy.special import ndtr

        between = max(self.scatter[0] * self.mean, 1e-6 * self.mean)
        deviations = np.linspace(-8, 8, 8001)
        true = self.mean + between * deviations
        weights = np.exp(-(deviations**2) / 2)
        weights /= weights.sum()
        sd = np.hypot(self.sd, CALIBRATION * self.mean)
        taken = ndtr((accepted.most - true) / sd) - ndtr((accepted.least - true) / sd)
        good = tolerance.keeps(true)
        return Risks(accepted, float(weights @ (taken * ~good)), float(weights @ ((1 - taken) * good)))


def measured_gear(path: Path, gear: SteeringGear) -> MeasuredGear:
    """Return level and runout of a gear's free torque.

    Raises:
        InputError: the file holds no such curve.
    """
    gain = float(GearPair.of(gear).gain)
    measurement = measurement_of([(FREE, read_curve(path, TORQUE, None, gain))])
    check_sizes(measurement, gear)
    (level,) = levels_of(measurement.passes, gear.pinion.teeth, gain)
    runout = runout_of(level, gear.yoke.preload, LEVEL["yoke.preload"].sd)
    return MeasuredGear(path.stem, abs(level.value), level.data_sd, runout)


def judge_lot(folder: str | Path, gear: SteeringGear | None = None, *, jobs: int = 1) -> ProductionLot:
    """Return what the free torques of a folder's files (text, MDF, TDMS, MAT) show, one gear a file, in the
    order of their names; `gear` is what is expected of all.

    Raises:
        InputError: no such folder, or fewer than `FEWEST` files that can be read.
    """
    folder, gear = Path(folder), gear or SteeringGear()
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder; name one with a measured file for each gear.")
    files = sorted((each for each in folder.iterdir() if each.suffix.lower() in SUFFIXES), key=_in_order)
    tasks = {Task(partial(measured_gear, file, gear)): number for number, file in enumerate(files)}
    found: dict[int, MeasuredGear] = {}
    refused: dict[int, str] = {}
    for task, answer in run_cases(list(tasks), jobs, expected=SECONDS_A_GEAR * len(files)):
        number = tasks[task]
        try:
            found[number] = answer.returned()
        except InputError as error:
            refused[number] = " ".join(error.problems)
    if len(found) < FEWEST:
        why = f"; the first refusal: {refused[min(refused)]}" if refused else ""
        needed = f"{folder} holds {len(found)} curves that can be read; a batch needs at least {FEWEST}"
        raise InputError(f"{needed}{why}".removesuffix(".") + ".")
    gears = [found[number] for number in sorted(found)]
    return lot_of(gears, gear, tuple(refused[number] for number in sorted(refused)))


def _in_order(path: Path) -> tuple[list[int | str], ...]:
    """Key by which names with numbers are in the order of these numbers."""
    return tuple([int(part)] if part.isdigit() else [part] for part in re.split(r"(\d+)", path.name))


def lot_of(gears: Sequence[MeasuredGear], gear: SteeringGear, refused: tuple[str, ...] = ()) -> ProductionLot:
    levels, deviations = (np.array([getattr(each, name) for each in gears]) for name in ("level", "sd"))
    y, s = np.log(levels), deviations / levels
    taus = np.linspace(0.0, 3 * max(float(np.std(y, ddof=1)), float(np.median(s))), CELLS)
    variances = s**2 + taus[:, None] ** 2  # (cells, gears)
    weights = 1 / variances
    total = weights.sum(axis=1)
    centres = (weights @ y) / total
    left = (weights * (y - centres[:, None]) ** 2).sum(axis=1)
    likelihood = -0.5 * (np.log(variances).sum(axis=1) + np.log(total) + left)
    posterior = np.exp(likelihood - likelihood.max())
    posterior /= posterior.sum()
    low, middle, high = np.interp([0.025, 0.5, 0.975], np.cumsum(posterior), taus)
    centre = float(posterior @ centres)
    variance = float(posterior @ (1 / total + (centres - centre) ** 2)) + CALIBRATION**2
    share = middle**2 / (middle**2 + s**2)
    expected = np.exp(centre + share * (y - centre))
    slopes = logarithmic_slopes(gear, FREE, LEVEL)
    formula = formula_means(gear, FREE)
    level = (formula[0] - formula[1]) / 2
    gradient = (slopes[0] - slopes[1]) / 2 / level
    prior = np.diag([each.sd**2 for each in LEVEL.values()])
    gain = prior @ gradient / (gradient @ prior @ gradient + variance)
    moved = gain * (centre - np.log(level))
    after = np.sqrt(np.diag(prior - np.outer(gain, gradient @ prior)))
    parameters = {
        path: (float(gear.value_at(path)) * float(np.exp(change)), float(sd))
        for path, change, sd in zip(LEVEL, moved, after, strict=True)
    }
    alone = {path: float(middle / slope) for path, slope in zip(LEVEL, gradient, strict=True) if slope > 0}
    mean = float(np.exp(centre))
    mean_sd, scatter = mean * float(np.sqrt(variance)), (float(middle), float(low), float(high))
    drift = drift_of(levels)
    return ProductionLot(tuple(gears), refused, mean, mean_sd, scatter, expected, parameters, alone, drift)


def drift_of(values: np.ndarray, seed: int = 0) -> Drift:
    """Return the moving average of values (n,) and its limit: lots of as many normal values without drift
    are beyond it in 1 %, whose mean and deviation are estimated likewise."""
    random = np.random.default_rng(seed)
    average, deviation, mean = _moving(values[None, :])
    parts, deviations, means = _moving(random.standard_normal((DRAWN, values.size)))
    steps = np.arange(1, values.size + 1)  # the average's deviation over that of a value:
    spread = np.sqrt(WEIGHT / (2 - WEIGHT) * (1 - (1 - WEIGHT) ** (2 * steps)))
    farthest = np.max(np.abs(parts - means[:, None]) / (deviations[:, None] * spread), axis=1)
    factor = float(np.quantile(farthest, 1 - FALSE_ALARMS))
    return Drift(average[0], factor * float(deviation[0]) * spread, float(mean[0]))


def _moving(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moving averages of rows (m, n) from their means on, deviations by moving ranges (m,), means (m,)."""
    means = values.mean(axis=1)
    deviations = np.abs(np.diff(values, axis=1)).mean(axis=1) * np.sqrt(np.pi) / 2
    average = np.empty_like(values)
    last = means
    for i in range(values.shape[1]):
        last = (1 - WEIGHT) * last + WEIGHT * values[:, i]
        average[:, i] = last
    return average, np.maximum(deviations, 1e-9 * np.abs(means) + 1e-300), means
