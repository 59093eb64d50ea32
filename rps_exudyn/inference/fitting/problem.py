"""The least squares of a fit: what the data say of the unknowns, row by row.

Every pass gives two kinds of rows. Its mean deviation from the model (`level`) tells of the parameters that
set the torque's level; what remains of the curve (`shape`) tells of the runout and of the angle's offset,
and of nothing else: the ripple's size would separate preload from friction only as well as the
contact law is true, which it is not (docs/measured-curves.md).
"""

from dataclasses import dataclass, field, replace

import numpy as np

from rps_exudyn.inference.fitting.bench_tests import MeasuredPass, Measurement
from rps_exudyn.inference.fitting.prediction import CurveBlock, Prediction
from rps_exudyn.inference.fitting.unknowns import Unknown

SMALLEST_NOISE = 1e-3  # of a pass' level: below it the contact law's own ripple is the larger error
ZERO = 0.05  # standard deviation of a sensor's zero, of the level of its file
OFFSET = 0.25  # of the angle's offset, of a tooth pitch
SMOOTH = 9  # points of a running median
LINEAR_TO = 1.345  # in standard deviations: residuals up to here count fully


@dataclass(frozen=True)
class Noise:
    """Noise of one pass; SI units of its values."""

    white: float  # standard deviation of a point
    correlated: float = 0.0  # of what keeps its sign over an angle ...
    length: float = 0.0  # ... of this size [rad]
    level: float = 0.0  # of the whole pass: repeatability

    def covariance(self, angle: np.ndarray) -> np.ndarray:
        """Covariance of the correlated part at rising angles (n,), shape (n, n)."""
        if not self.correlated:
            return np.zeros((angle.size, angle.size))
        apart = np.abs(angle[:, None] - angle[None, :])
        return self.correlated**2 * np.exp(-apart / self.length)


@dataclass(frozen=True, eq=False)
class State:
    """Values of the unknowns, of the rig's nuisances, and of the model there."""

    u: np.ndarray  # unknowns
    offset: float  # of the measured angle [rad]
    gain: float  # of the sensor: relative error of its calibration
    zeros: np.ndarray  # of the sensor, one a file
    values: np.ndarray  # of the model, all blocks, shape (m,)
    slopes: np.ndarray  # by the unknowns, shape (m, unknowns)


@dataclass(frozen=True, eq=False)
class Problem:
    """Measured passes, what is predicted for them, and what is believed before."""

    measurement: Measurement
    prediction: Prediction
    unknowns: list[Unknown]
    pitch: float  # [rad]
    noises: list[Noise]  # one a pass
    quiet: tuple[float, ...] = ()  # standard deviation of a zero, one a file
    with_offset: bool = True
    calibrated: float = 1e-9  # standard deviation of the sensor's gain
    trusted: bool = False  # the shape, for the level as well: to show what it would claim

    @property
    def shaped(self) -> np.ndarray:
        """Which unknowns the shape of a curve may tell of, shape (unknowns,)."""
        return np.array([self.trusted or not each.is_level for each in self.unknowns], dtype=bool)

    @property
    def size(self) -> int:
        """Number of unknowns, offset, gain and zeros together."""
        return len(self.unknowns) + 2 + len(self.quiet)

    def with_noises(self, noises: list[Noise]) -> "Problem":
        """The same with other noise."""
        return replace(self, noises=noises)

    def block_of(self, number: int) -> tuple[CurveBlock, int]:
        """The block of a pass, and its number."""
        tests = [block.test for block in self.prediction.blocks]
        at = tests.index(self.measurement.passes[number].test)
        return self.prediction.blocks[at], at

    def vector(self, state: State) -> np.ndarray:
        """Everything that is varied, shape (size,)."""
        return np.concatenate([state.u, [state.offset, state.gain], state.zeros])

    def moved(self, state: State, step: np.ndarray) -> State:
        """The state after a step (size,), its model's values by its slopes."""
        count = len(self.unknowns)
        return replace(
            state,
            u=state.u + step[:count],
            offset=state.offset + float(step[count]),
            gain=state.gain + float(step[count + 1]),
            zeros=state.zeros + step[count + 2 :],
            values=state.values + state.slopes @ step[:count],
        )


@dataclass(frozen=True, eq=False)
class PassRows:
    """What one pass says at a state."""

    deviation: np.ndarray  # measured minus model, without the mean, shape (n,)
    weights: np.ndarray  # of the points, at most 1, shape (n,)
    mean: float  # weighted mean of measured minus model
    level: np.ndarray  # derivative of the model's mean, shape (size,)
    shape: np.ndarray  # derivative of the rest, shape (n, size); no rows without shape
    level_sd: float


@dataclass(frozen=True, eq=False)
class Linearised:
    """Normal equations at a state: information H (size, size), gradient, sums of squares."""

    information: np.ndarray
    gradient: np.ndarray
    by_level: float  # of means and priors
    by_shape: float
    rows: list[PassRows] = field(default_factory=list)


def linearised(problem: Problem, state: State) -> Linearised:
    """Return the normal equations of data and priors at a state."""
    size, count = problem.size, len(problem.unknowns)
    before = np.array([each.before for each in problem.unknowns])
    believed = np.concatenate(
        [
            [each.sd for each in problem.unknowns],
            [OFFSET * problem.pitch if problem.with_offset else 1e-9, problem.calibrated],
            problem.quiet,
        ]
    )
    away = problem.vector(state) - np.concatenate([before, np.zeros(size - count)])
    information, gradient = np.diag(believed**-2.0), -away / believed**2
    by_level, by_shape, found = float(np.sum((away / believed) ** 2)), 0.0, []
    for number, measured in enumerate(problem.measurement.passes):
        rows = pass_rows(problem, state, number)
        found.append(rows)
        information += np.outer(rows.level, rows.level) / rows.level_sd**2
        gradient += rows.level * rows.mean / rows.level_sd**2
        by_level += (rows.mean / rows.level_sd) ** 2
        if measured.test.of_kind.by_angle:
            weighted = rows.weights / problem.noises[number].white ** 2
            information += rows.shape.T @ (weighted[:, None] * rows.shape)
            gradient += rows.shape.T @ (weighted * rows.deviation)
            by_shape += float(weighted @ rows.deviation**2)
    return Linearised(information, gradient, by_level, by_shape, found)


def pass_rows(problem: Problem, state: State, number: int) -> PassRows:
    """Return what one pass says at a state."""
    measured, noise = problem.measurement.passes[number], problem.noises[number]
    block, at = problem.block_of(number)
    values = problem.prediction.part(at, state.values)
    slopes = problem.prediction.part(at, state.slopes)
    angle, count = measured.angle - state.offset, len(problem.unknowns)
    free = measured.test.of_kind.by_angle
    model = block.at(values, measured.direction, angle)
    left = measured.value - (1 + state.gain) * model - state.zeros[measured.run]
    if not free:
        left = _without_ripple(left)
    weights = robust_weights(left, noise.white)
    share = weights / weights.sum()
    by_u = block.at(slopes, measured.direction, angle) if free else _mean_slopes(slopes, measured)
    mean = float(share @ left)
    level = np.zeros(problem.size)
    level[:count] = share @ by_u
    level[count + 1] = float(share @ model)
    level[count + 2 + measured.run] = 1.0
    shape = np.zeros((angle.size if free else 0, problem.size))
    if free:
        shape[:, :count] = np.where(problem.shaped, by_u - level[:count], 0.0)
        turn = -_slope(block, values, measured.direction, angle)
        shape[:, count] = (turn - share @ turn) if problem.with_offset else 0.0
    drifting = float(share @ noise.covariance(measured.angle) @ share) if free else 0.0
    level_sd = np.sqrt(noise.white**2 * float(share @ share) + drifting + noise.level**2)
    return PassRows(left - mean, weights, mean, level, shape, float(level_sd))


def robust_weights(left: np.ndarray, white: float) -> np.ndarray:
    """Return the weights of the loss soft_l1, 2 (sqrt(1 + z^2) - 1), about the median: shape (n,)."""
    z = (left - np.median(left)) / (LINEAR_TO * white)
    return 1 / np.sqrt(1 + z**2)


def _without_ripple(left: np.ndarray) -> np.ndarray:
    """Return deviations (n,) from a mean with what is smooth of them taken away, but for its mean.

    A test of which the mean alone is predicted still shows teeth and runout. They are no outliers: weights of
    the points that take them for such would move the mean by half a percent under a weight.
    """
    held = np.pad(left, SMOOTH // 2, mode="edge")
    smooth = np.median(np.lib.stride_tricks.sliding_window_view(held, SMOOTH), axis=1)
    return np.asarray(left - smooth + smooth.mean())


def _mean_slopes(slopes: np.ndarray, measured: MeasuredPass) -> np.ndarray:
    row = slopes[0 if measured.direction > 0 else 1]
    return np.broadcast_to(row, (measured.angle.size, row.size))


def _slope(block: CurveBlock, values: np.ndarray, direction: int, angle: np.ndarray) -> np.ndarray:
    half = np.radians(1.0)
    ahead, behind = (block.at(values, direction, angle + sign * half) for sign in (1, -1))
    return (ahead - behind) / (2 * half)


def white_noise(measured: MeasuredPass) -> float:
    """Return the white part of a pass' noise from second differences, robustly; at least `SMALLEST_NOISE`."""
    value = measured.value
    second = np.diff(value, 2)
    floor = SMALLEST_NOISE * float(np.abs(value).mean()) + 1e-12
    if second.size < 5:
        return max(floor, float(np.std(value)))
    return max(floor, float(1.4826 * np.median(np.abs(second)) / np.sqrt(6.0)))
