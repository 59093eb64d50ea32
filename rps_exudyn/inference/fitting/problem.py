"""Data against unknowns: levels of tests, and where a bow or an angle error is fitted, shapes of curves.

Every test gives half the difference of both directions, which depends on friction, and half their sum, which
depends on weights and on the sensor's zero (`level`). What remains of a curve (`shape`) would separate
preload from friction only as well as the contact law is true, which it is not (docs/measured-curves.md): it
counts for bow and angle error alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from rps_exudyn.inference.fitting.bench_tests import BenchTest, MeasuredPass, Measurement
from rps_exudyn.inference.fitting.level import CALIBRATION, REPEATABILITY, ZERO, LevelEstimate
from rps_exudyn.inference.fitting.noise import robust_deviation, white_deviation
from rps_exudyn.inference.fitting.prediction import CurveBlock, Prediction
from rps_exudyn.inference.fitting.unknowns import Unknown

SMALLEST_NOISE = 1e-3  # of a pass' level: below it the contact law's own ripple is the larger error
MODEL = 0.01  # of a level under a weight: what models of the mean differ by
OFFSET = 0.25  # of the angle's offset, of a tooth pitch
LINEAR_TO = 1.345  # in standard deviations: residuals up to here count fully


@dataclass(frozen=True, eq=False)
class LevelRows:
    """Measured levels as rows of least squares."""

    tests: tuple[BenchTest, ...]  # of the rows
    directions: np.ndarray  # weights of the means towards +X and -X that make each row, shape (rows, 2)
    values: np.ndarray  # shape (rows,)
    covariance: np.ndarray  # with calibration and what the model may be wrong by, shape (rows, rows)

    @property
    def scaled(self) -> np.ndarray:
        """Which rows are friction, so that a model's error is one of their size, shape (rows,)."""
        weighted = np.array([test.of_kind.weighted for test in self.tests])
        is_one_way = (self.directions == 0).any(axis=1)
        return (self.directions[:, 0] * self.directions[:, 1] < 0) | (is_one_way & ~weighted)

    def of_means(self, means: Mapping[BenchTest, Any]) -> np.ndarray:
        """The rows that means towards +X and -X of each test make, (2, ...) each: shape (rows, ...)."""
        rows = zip(self.tests, self.directions, strict=True)
        return np.array([direction @ means[test] for test, direction in rows])


_Row = tuple[BenchTest, tuple[float, float], float, float]  # test, direction, value, its own variance
ACROSS, ALONG = (0.5, -0.5), (0.5, 0.5)  # weights of both directions' means


def level_rows(levels: Sequence[LevelEstimate], runs: float = 1) -> LevelRows:
    """Return the rows of all tests; as if each run had been repeated `runs` times."""
    rows: list[_Row] = []
    for each in levels:
        if each.both_ways and each.half_sum is not None:
            along = float(np.hypot(ZERO * each.value / np.sqrt(each.runs), each.noise_sd))
            rows.append((each.test, ACROSS, each.value, each.data_sd**2 / runs))
            rows.append((each.test, ALONG, each.half_sum, along**2 / runs))
        else:
            direction = (1.0, 0.0) if each.directions[0] > 0 else (0.0, -1.0)
            rows.append((each.test, direction, each.value, each.data_sd**2 / runs))
    return _joined(rows)


def expected_rows(means: Mapping[BenchTest, Sequence[float]], runs: Mapping[BenchTest, int]) -> LevelRows:
    """Return the rows that tests would give, with the declared repeatability and zero, so many runs of each
    test both ways; `means` are those towards +X and -X."""
    rows: list[_Row] = []
    for test, count in runs.items():
        across, along = (means[test][0] - means[test][1]) / 2, (means[test][0] + means[test][1]) / 2
        rows.append((test, ACROSS, across, (REPEATABILITY * across) ** 2 / count))
        rows.append((test, ALONG, along, (ZERO * across) ** 2 / count))
    return _joined(rows)


def _joined(rows: Sequence[_Row]) -> LevelRows:
    """Rows with what they share: calibration of a sensor, and what a model of weights may be wrong by."""
    tests, directions, values, variances = zip(*rows, strict=True)
    y, pushed = np.array(values), np.array([test.pushed for test in tests])
    models = np.array([MODEL if test.of_kind.weighted else 0.0 for test in tests])
    same_sensor = pushed[:, None] == pushed[None, :]
    independent = np.diag(np.array(variances) + (models * y) ** 2)
    covariance = independent + CALIBRATION**2 * np.outer(y, y) * same_sensor
    return LevelRows(tests, np.array(directions), y, covariance)


@dataclass(frozen=True, eq=False)
class PassRows:
    """Residual and slopes of the shape of one pass at a state."""

    deviation: np.ndarray  # measured minus model, without the mean, shape (n,)
    weights: np.ndarray  # of the points, at most 1, shape (n,)
    shape: np.ndarray  # derivative of the model without its mean, shape (n, size)


_nothing = partial(np.zeros, 0)


@dataclass(frozen=True, eq=False)
class FitState:
    """What a search holds on its way, of the level or of the shape, and where it ended.

    Information and covariance are those of the unknowns, in a search of the shape beside the offset.
    """

    u: np.ndarray  # unknowns, shape (unknowns,)
    values: np.ndarray = field(default_factory=_nothing)  # of the model, all blocks, shape (m,)
    offset: float = 0.0  # of the measured angle [rad]
    slopes: np.ndarray = field(default_factory=_nothing)  # of the values by the unknowns, shape (m, unknowns)
    information: np.ndarray = field(default_factory=_nothing)  # shape (size, size)
    gradient: np.ndarray = field(default_factory=_nothing)  # of the next step, shape (size,)
    chi_squared: float = np.inf  # the loss of means, shapes and priors, in squares of standard deviations
    rows: Sequence[PassRows] = ()  # residuals of the shapes, of each pass
    converged: bool = False  # whether the search reached its minimum
    why: str = ""  # why not; "" where it did

    @property
    def covariance(self) -> np.ndarray:
        return np.asarray(np.linalg.inv(self.information))


@dataclass(frozen=True, eq=False)
class Problem:
    """Measured passes, what is predicted for them, and what is expected before."""

    measurement: Measurement
    levels: Sequence[LevelEstimate]
    rows: LevelRows
    prediction: Prediction
    unknowns: list[Unknown]
    pitch: float  # [rad]
    whites: list[float]  # white noise of a point, one a pass
    with_offset: bool = True

    @property
    def size(self) -> int:
        """Number of unknowns and offset together."""
        return len(self.unknowns) + 1

    def block_of(self, number: int) -> tuple[CurveBlock, int]:
        """The block of a pass, and its number."""
        tests = [block.test for block in self.prediction.blocks]
        at = tests.index(self.measurement.passes[number].test)
        return self.prediction.blocks[at], at

    def rows_of(self, values: np.ndarray) -> np.ndarray:
        """The level rows of predicted values (m, ...), shape (rows, ...)."""
        blocks, part = self.prediction.blocks, self.prediction.part
        return self.rows.of_means({each.test: each.means(part(i, values)) for i, each in enumerate(blocks)})

    @property
    def needs_shape_fit(self) -> bool:
        """Whether a bow or an angle error is fitted, for which there is a curve of free turning."""
        return self.with_offset and any(each.needs_shape_fit for each in self.unknowns)

    def moved(self, state: FitState, step: np.ndarray) -> FitState:
        """The state after a step (size,), its model's values by its slopes."""
        of_u, turned = step[:-1], float(step[-1])
        values = state.values + state.slopes @ of_u
        return replace(state, u=state.u + of_u, offset=state.offset + turned, values=values)


def linearised(problem: Problem, state: FitState) -> FitState:
    """Return the state with the normal equations of levels, shapes and priors.

    The loss of a shape is soft_l1, whose weights are w = 1 / sqrt(1 + z^2).
    """
    before = np.array([*(each.before for each in problem.unknowns), 0.0])
    free = OFFSET * problem.pitch if problem.with_offset else 1e-9
    prior_sd = np.array([*(each.sd for each in problem.unknowns), free])
    away = np.append(state.u, state.offset) - before
    left = problem.rows.values - problem.rows_of(state.values)
    slopes = np.hstack([problem.rows_of(state.slopes), np.zeros((left.size, 1))])
    weighted = np.linalg.solve(problem.rows.covariance, np.column_stack([slopes, left]))
    information = np.diag(prior_sd**-2.0) + slopes.T @ weighted[:, :-1]
    gradient = slopes.T @ weighted[:, -1] - away / prior_sd**2
    found = []
    for number, measured in enumerate(problem.measurement.passes):
        if measured.test.of_kind.by_angle:
            rows = pass_rows(problem, state, number)
            found.append(rows)
            weights = rows.weights / problem.whites[number] ** 2
            information += rows.shape.T @ (weights[:, None] * rows.shape)
            gradient += rows.shape.T @ (weights * rows.deviation)
    by_level = float(left @ weighted[:, -1] + np.sum((away / prior_sd) ** 2))
    by_shape = sum([2 * LINEAR_TO**2 * float(np.sum(1 / row.weights - 1)) for row in found])
    equations = {"information": information, "gradient": gradient, "chi_squared": by_level + by_shape}
    return replace(state, **equations, rows=found)


def pass_rows(problem: Problem, state: FitState, number: int) -> PassRows:
    measured = problem.measurement.passes[number]
    block, at = problem.block_of(number)
    values = problem.prediction.part(at, state.values)
    slopes = problem.prediction.part(at, state.slopes)
    angle, count = measured.angle - state.offset, len(problem.unknowns)
    left = measured.value - block.at(values, measured.direction, angle)
    weights = robust_weights(left, problem.whites[number])
    share = weights / weights.sum()
    by_u = block.at(slopes, measured.direction, angle)
    shape = np.zeros((angle.size, problem.size))
    shape[:, :count] = by_u - share @ by_u
    if problem.with_offset:
        turn = -_slope(block, values, measured.direction, angle)
        shape[:, count] = turn - share @ turn
    return PassRows(left - float(share @ left), weights, shape)


def robust_weights(left: np.ndarray, white: float) -> np.ndarray:
    """Return the weights of the loss soft_l1, 2 (sqrt(1 + z^2) - 1), about the median: shape (n,)."""
    z = (left - np.median(left)) / (LINEAR_TO * white)
    return 1 / np.sqrt(1 + z**2)


def _slope(block: CurveBlock, values: np.ndarray, direction: int, angle: np.ndarray) -> np.ndarray:
    half = np.radians(1.0)
    ahead, behind = (block.at(values, direction, angle + sign * half) for sign in (1, -1))
    return (ahead - behind) / (2 * half)


def white_noise(measured: MeasuredPass) -> float:
    """Return the white part of a pass' noise from second differences, robustly; at least `SMALLEST_NOISE`."""
    floor = SMALLEST_NOISE * float(np.abs(measured.value).mean()) + 1e-12
    few = measured.value.size < 7
    return max(floor, float(np.std(measured.value)) if few else white_deviation(measured.value))


# --- The angle's offset: where the ripple of the teeth fits best, beside the slow waves of rig and runout

SCANNED = 60  # offsets over a tooth pitch


def found_offset(problem: Problem, values: np.ndarray) -> tuple[float, float]:
    """Return the offset [rad] within half a pitch at which the ripple fits best, and its deviation."""
    numbers = [i for i, each in enumerate(problem.measurement.passes) if each.test.of_kind.by_angle]
    slows = [_slow(problem.measurement.passes[number].angle) for number in numbers]

    def cost(offsets: np.ndarray) -> np.ndarray:
        found = np.zeros(offsets.size)
        for number, slow in zip(numbers, slows, strict=True):
            each, (block, at) = problem.measurement.passes[number], problem.block_of(number)
            angle = each.angle - offsets[:, None]
            model = block.at(problem.prediction.part(at, values), each.direction, angle.ravel())
            left = each.value - model.reshape(angle.shape)
            scaled = (left - left @ slow @ slow.T) / (LINEAR_TO * problem.whites[number])
            found += 2 * LINEAR_TO**2 * np.sum(np.sqrt(1 + scaled**2), axis=1)
        return found

    def slopes(offset: float) -> tuple[float, float]:
        gradient, information = 0.0, 0.0
        for number, slow in zip(numbers, slows, strict=True):
            each, (block, at) = problem.measurement.passes[number], problem.block_of(number)
            block_values, angle = problem.prediction.part(at, values), each.angle - offset
            left = each.value - block.at(block_values, each.direction, angle)
            left = left - slow @ (slow.T @ left)
            white = max(problem.whites[number], robust_deviation(left))
            weights = robust_weights(left, white) / white**2
            turn = -_slope(block, block_values, each.direction, angle)
            turn = turn - slow @ (slow.T @ turn)
            gradient += float(turn @ (weights * left))
            information += float(turn @ (weights * turn))
        return gradient, information

    tried = np.linspace(-0.5, 0.5, SCANNED, endpoint=False) * problem.pitch
    offset = float(tried[int(np.argmin(cost(tried)))])
    prior = (OFFSET * problem.pitch) ** -2.0
    for _ in range(3):
        gradient, information = slopes(offset)
        step = gradient / (information + prior)
        offset += float(np.clip(step, -problem.pitch / SCANNED, problem.pitch / SCANNED))
    return offset, float((information + prior) ** -0.5)


def _slow(angle: np.ndarray) -> np.ndarray:
    """An orthonormal basis (n, p) of a constant, a slope and two waves of the turn."""
    columns = [np.ones_like(angle), angle, np.cos(angle), np.sin(angle), np.cos(2 * angle), np.sin(2 * angle)]
    kept = 6 if np.ptp(angle) > 0.8 * 2 * np.pi else 2
    return np.asarray(np.linalg.qr(np.column_stack(columns[:kept]))[0])
