"""The quick band of a free pinion torque: the closed form at many points, corrected by a few runs.

The formula is right to a few percent, and what it misses hardly depends on the inputs: the ratio of run to
formula, fitted over the runs by a plane in the inputs' quantiles, takes the formula's quantiles to those of
runs, with the scatter about the plane drawn anew at each point. All other metrics have the runs alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.inference.uncertainty import statistics
from rps_exudyn.inference.uncertainty.band import Band, Curves, OnProgress, nominal_result, runs_of
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.inference.uncertainty.statistics import LEVELS, SEED
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.free_pinion_torque import SCENE as FREE_PINION_TORQUE
from rps_exudyn.solvers.closed_form import mean_state, torque_per_preload
from rps_exudyn.solvers.temperature_and_wear import tested_gear
from rps_exudyn.solvers.yoke_stop import stop_stiffness

SCENE, METRIC = FREE_PINION_TORQUE.name, "torque_mean"
POINTS, RUNS = 1024, 64
ERRORS = (
    *("installation.angle_error", "installation.axis_offset", "pinion.runout", "pinion.runout_angle"),
    *("pinion.profile_slope", "pinion.pitch_error", "pinion.lead_error", "pinion.crowning"),
)
"""Inputs that the formula's mean is taken without: gears that differ in these share one field of contact."""
PHASES = np.linspace(0, 2 * np.pi, 72, endpoint=False)  # of the pinion over a turn [rad]


@dataclass(frozen=True, eq=False)
class _Correction:
    """Ratio of run to formula: a plane over quantiles of the inputs, and its residuals at the runs."""

    coefficients: np.ndarray  # (1 + inputs,)
    residuals: np.ndarray  # (runs,)

    @classmethod
    def fitted(cls, quantile: np.ndarray, ratio: np.ndarray) -> "_Correction":
        """Fit ratios (n,) at quantiles (n, inputs); the residuals are widened by what the fit took."""
        terms = _terms(quantile)
        if len(ratio) < 2 * terms.shape[1]:
            return cls(np.array([ratio.mean(), *np.zeros(quantile.shape[1])]), ratio - ratio.mean())
        coefficients, *_ = np.linalg.lstsq(terms, ratio, rcond=None)
        widened = np.sqrt(len(ratio) / (len(ratio) - terms.shape[1]))
        return cls(coefficients, widened * (ratio - terms @ coefficients))

    def drawn(self, quantile: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """Return ratios at other points, their residuals drawn from those at the runs."""
        return np.asarray(_terms(quantile) @ self.coefficients + rng.choice(self.residuals, len(quantile)))


def quick_band(
    gear: SteeringGear,
    fidelity: Fidelity,
    inputs: Mapping[str, Distribution],
    runs: int = RUNS,
    seed: int = 0,
    on_progress: OnProgress | None = None,
    jobs: int = 1,
    time_limit: float = float("inf"),
) -> Band:
    """Return the band of the free pinion torque from a few runs, in up to `jobs` processes, and the closed
    form.

    Raises:
        InputError: a nominal gear that fails, or too few runs that end ok.
        Interrupted: Ctrl-C before there is a band.
    """
    nominal, drawn = nominal_result(SCENE, gear, fidelity, inputs), Samples.drawn(inputs, runs, seed)
    done = runs_of(drawn, nominal, fidelity, on_progress, jobs, time_limit)
    points = Samples.drawn(inputs, POINTS, seed + 1)
    formula = formula_torques(gear, points)
    at_runs = done.drawn.numbers[METRIC] / formula_torques(gear, done.drawn.samples)
    means, resampled = _corrected(done.drawn.samples.quantile, at_runs, points.quantile, formula)
    band, of_mean = done.band(nominal, inputs), statistics.quantiles(means, resampled=resampled)
    polynomials = statistics.Polynomials.at(points.quantile, points.inputs.groups, points.values)
    mean = polynomials.contributions(means)
    return replace(
        band,
        method=f"closed form at {POINTS} points, corrected by {len(done.drawn.samples)} runs",
        metrics={**band.metrics, METRIC: _widened(of_mean, done.drawn.failed, runs)},
        contributions={**band.contributions, **({METRIC: mean} if mean is not None else {})},
        curves=_curves(means, done.curves, done.drawn.numbers[METRIC]),
    )


def formula_torques(gear: SteeringGear, points: Samples) -> np.ndarray:
    """Return the closed form's mean free torque at the points, (n,) [N m].

    Values that distributions draw are within their parameters' limits and not looked at again.
    """
    found, direction = np.empty(len(points)), gear.test.direction
    for i, settings in enumerate(points.settings()):
        known = gear.with_unchecked({path: value for path, value in settings.items() if path not in ERRORS})
        found[i] = mean_state(tested_gear(known), direction, 0.0).torque
        found[i] += direction * stop_torque(tested_gear(gear.with_unchecked(settings)))
    return found


def stop_torque(gear: SteeringGear) -> float:
    """Return what the yokenut adds to the mean free torque where a runout uses up the clearance [N m].

    The gear lifts the rack by e cos(phi); beyond the clearance nut, seat and flanks are compressed. The
    formula itself has no yokenut, and a seventh of the gears of the set `unknown` meet it.
    """
    yoke, lift = gear.yoke, gear.pinion.runout * np.cos(PHASES)
    beyond = float(np.maximum(0.0, lift - yoke.clearance).mean())
    return torque_per_preload(gear) * stop_stiffness(gear) * beyond if beyond else 0.0


def _corrected(
    at: np.ndarray, ratio: np.ndarray, points: np.ndarray, formula: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Means at the points (n,), and the same with runs and points drawn again, (resamples, n)."""
    ok = np.isfinite(ratio)
    at, ratio = at[ok], ratio[ok]
    rng = np.random.default_rng(SEED)
    means = formula * _Correction.fitted(at, ratio).drawn(points, rng)
    again = np.empty((statistics.RESAMPLES, len(formula)))
    for row in again:
        runs, chosen = rng.integers(0, len(ratio), len(ratio)), rng.integers(0, len(formula), len(formula))
        fitted = _Correction.fitted(at[runs], ratio[runs])
        row[:] = formula[chosen] * fitted.drawn(points[chosen], rng)
    return means, again


def _widened(of_mean: statistics.Quantiles, failed: int, runs: int) -> statistics.Quantiles:
    """Return the quantiles; where runs failed, none of the worst cases is known."""
    if not failed:
        return of_mean
    share = failed / runs
    low = np.where(np.array(LEVELS) < share, -np.inf, of_mean.lowest)
    high = np.where(1 - np.array(LEVELS) < share, np.inf, of_mean.highest)
    return replace(of_mean, lowest=low, highest=high)


def _curves(means: np.ndarray, curves: np.ndarray | None, of_runs: np.ndarray) -> Curves | None:
    """Quantiles of curves: every mean with the course of one of the runs, in parts of its own mean."""
    if curves is None:
        return None
    course = curves / of_runs[np.isfinite(of_runs)][:, None]
    chosen = np.random.default_rng(SEED).integers(0, len(course), len(means))
    return Curves("pinion_torque", np.quantile(means[:, None] * course[chosen], LEVELS, axis=0))


def _terms(quantile: np.ndarray) -> np.ndarray:
    return np.hstack([np.ones((len(quantile), 1)), 2 * quantile - 1])
