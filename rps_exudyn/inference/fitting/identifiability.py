"""What the means of all tests determine: single parameters, combinations, and the test that would help.

What the data determine of each parameter by itself is its standard deviation with very weak priors of all
others, and with the nuisances as they are declared. What is narrowed with the help of the declared deviations
of others follows from them, and is named so.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from rps_exudyn.inference.fitting.bench_tests import BenchTest
from rps_exudyn.inference.fitting.level import CALIBRATION, REPEATABILITY, ZERO
from rps_exudyn.inference.fitting.noise import NORMAL
from rps_exudyn.inference.fitting.prediction import formula_means, gear_in
from rps_exudyn.inference.fitting.problem import MODEL
from rps_exudyn.inference.fitting.unknowns import LEVEL, NUISANCES
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.load_test import SCENE as LOAD_TEST
from rps_exudyn.scenes.rack_on_rollers import SCENE as RACK_ON_ROLLERS
from rps_exudyn.solvers.closed_form import GRAVITY, unloading_force

NARROWED = 0.5  # of the declared deviation
ANYTHING = 1.0  # deviation of a logarithm about which nothing is known: a factor of 2.7 either way
LEAST_SHARE = 0.08  # of the largest exponent of a combination that is worth naming
SIMPLE = ("yoke-out", "bearing")
SEPARATING = ("yoke.preload", "mesh.friction")


@dataclass(frozen=True, eq=False)
class LevelData:
    """What means determine of the logarithms of all level parameters, freed or not, and of nuisances."""

    paths: tuple[str, ...]  # nuisances last
    information: np.ndarray  # (n, n)

    def from_data(self) -> dict[str, float]:
        """Standard deviation of each logarithm from the data, without priors."""
        prior_sd = np.array([NUISANCES.get(path, ANYTHING) for path in self.paths])
        covariance = np.linalg.inv(self.information + np.diag(prior_sd**-2.0))
        return dict(zip(self.paths, np.sqrt(np.diag(covariance)).tolist(), strict=True))

    def with_test(self, gear: SteeringGear, test: BenchTest) -> "LevelData":
        """The same after one more test, both ways, with the declared repeatability."""
        means = np.array(formula_means(gear, test))
        slopes = logarithmic_slopes(gear, test, self.paths)
        friction = abs(means[0] - means[1]) / 2
        across, along = (slopes[0] - slopes[1]) / 2, (slopes[0] + slopes[1]) / 2
        model = MODEL if test.of_kind.weighted else 0.0
        across = across / (np.sqrt(REPEATABILITY**2 + CALIBRATION**2 + model**2) * friction)
        along = along / np.hypot(ZERO * friction, np.hypot(CALIBRATION, model) * (means[0] + means[1]) / 2)
        return LevelData(self.paths, self.information + np.outer(across, across) + np.outer(along, along))


def logarithmic_slopes(gear: SteeringGear, test: BenchTest, paths: Iterable[str]) -> np.ndarray:
    """Return derivatives of both means with respect to the logarithms, by the closed form, shape (2, n)."""
    base, columns = np.array(formula_means(gear, test)), []
    for path in paths:
        step = LEVEL[path].step if path in LEVEL else 0.02
        if path in NUISANCES:
            moved = gear_in(test, gear, {path: step})
        else:
            moved = gear.replace({path: gear.value_at(path) * np.exp(step)})
        columns.append((np.array(formula_means(moved, test)) - base) / step)
    return np.array(columns).T


@dataclass(frozen=True)
class Combination:
    """A product of powers of parameters that the data determine although they leave each of them open."""

    exponents: dict[str, float]  # path -> exponent; the largest is 1
    sd: float  # relative
    prior_sd: float

    @property
    def words(self) -> str:
        """The product in words."""
        parts = [path if power == 1 else f"{path}^{power:.2g}" for path, power in self.exponents.items()]
        return " x ".join(parts)


def combination_of(paths: Sequence[str], posterior: np.ndarray, prior_sd: np.ndarray) -> Combination | None:
    """Return the best determined product of parameters; None if it is not narrowed either.

    `posterior` is the covariance of their logarithms (n, n): the product's exponents are the direction in
    which it is smallest beside the prior's.
    """
    if len(paths) < 2:
        return None
    scaled = posterior / np.outer(prior_sd, prior_sd)
    values, vectors = np.linalg.eigh(scaled)
    if values[0] > NARROWED**2:
        return None
    exponents = vectors[:, 0] / prior_sd
    exponents = exponents / exponents[np.argmax(np.abs(exponents))]
    kept = np.abs(exponents) > LEAST_SHARE
    shown = {path: float(power) for path, power, ok in zip(paths, exponents, kept, strict=True) if ok}
    order = dict(sorted(shown.items(), key=lambda item: -item[1]))
    direction = np.where(kept, exponents, 0.0)
    sd, before = np.sqrt(exponents @ posterior @ exponents), np.sqrt(direction**2 @ prior_sd**2)
    return Combination(order, float(sd), float(before))


@dataclass(frozen=True)
class Advice:
    """Tests that would separate what is not separated, and how well."""

    tests: tuple[BenchTest, ...]
    reached: dict[str, float]  # path -> relative standard deviation after them


def candidates(gear: SteeringGear) -> list[BenchTest]:
    """Return tests that a bench may add: without yoke, without rack, on rollers, and weights."""
    lifting = unloading_force(gear) / GRAVITY
    masses = [max(10.0, 10.0 * ceil(part * lifting / 10)) for part in (0.3, 0.6, 1.15)]
    weights = [BenchTest(LOAD_TEST.name, mass * GRAVITY) for mass in dict.fromkeys(masses)]
    return [BenchTest("yoke-out"), BenchTest("bearing"), BenchTest(RACK_ON_ROLLERS.name), *weights]


def advice_of(gear: SteeringGear, data: LevelData, done: Sequence[BenchTest]) -> Advice | None:
    """Return further tests, chosen one after the other until preload and friction of the teeth are separated;
    None where they are already."""
    kinds = {test.kind for test in done if test.kind in SIMPLE}
    left = [test for test in candidates(gear) if test.kind not in kinds and test not in done]

    def worst(after: LevelData) -> float:
        from_data = after.from_data()
        apart = sum(np.log(max(from_data[path] / LEVEL[path].sd, NARROWED)) for path in SEPARATING)
        return apart + 0.01 * sum(np.log(from_data[path]) for path in LEVEL)

    def separated(after: LevelData) -> bool:
        return all(after.from_data()[path] < NARROWED * LEVEL[path].sd for path in SEPARATING)

    if separated(data):
        return None
    chosen = [test for test in left if test.kind in SIMPLE]  # whatever else follows, they take minutes
    left = [test for test in left if test.kind not in SIMPLE]
    for test in chosen:
        data = data.with_test(gear, test)
    while left and not separated(data):
        best = min(left, key=lambda test: worst(data.with_test(gear, test)))
        data = data.with_test(gear, best)
        chosen.append(best)
        left.remove(best)
    return Advice(tuple(chosen), {path: sd for path, sd in data.from_data().items() if path in LEVEL})


# --- How often tests must be run until preload and friction of the teeth are known as well as is wanted
#
# Repeats make the scatter of a mean smaller, not what all of them share: calibration, nuisances, the model.

WANTED = {"yoke.preload": 0.05, "mesh.friction": 0.15}
"""Path -> half of the 95 % interval that is wanted, of the value."""

MOST_RUNS = 30  # that a bench may be asked for


@dataclass(frozen=True)
class MoreRuns:
    """What repeats of all tests would reach."""

    now: Mapping[str, float]  # path -> half of the 95 % interval, of the value, as it is
    runs: Mapping[str, int | None]  # path -> runs of each test that reach it; None: more than `MOST_RUNS`


def more_runs(
    halves: Mapping[str, float], runs: int, deviations: Callable[[int], Mapping[str, float]]
) -> MoreRuns | None:
    """Return what repeats would reach beyond the `runs` of each test that there are; None where all that is
    wanted is reached. `halves` are path -> half of the 95 % interval as it is, of the value; `deviations` are
    those of the logarithms after so many runs of each test."""
    missed = {path: half for path, half in halves.items() if half > WANTED[path]}
    if not missed:
        return None
    needed: dict[str, int | None] = dict.fromkeys(missed)
    for count in range(runs + 1, MOST_RUNS + 1):
        expected = deviations(count)
        for path in missed:
            if needed[path] is None and NORMAL * expected[path] <= WANTED[path]:
                needed[path] = count
        if all(needed.values()):
            break
    return MoreRuns(missed, needed)
