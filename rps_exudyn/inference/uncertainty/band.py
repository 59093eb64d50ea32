"""Band of a scene: the result of one gear, and between which values it lies for what is not known of it.

    band = band_of_runs("free-pinion-torque", gear, fidelity, inputs, samples=256)
    band.metrics["torque_mean"].values      # quantiles at LEVELS [N m]

Beside the band stand what it is made of (contributions) and what it does not contain: the numerical error, by
the error bars of its runs, and the error of the contact law.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import astuple, dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import Signals
from rps_exudyn.base.errors import InputError
from rps_exudyn.inference.uncertainty import statistics
from rps_exudyn.inference.uncertainty.samples import Samples, runs_at
from rps_exudyn.inference.uncertainty.statistics import LEVELS, Contributions, Quantiles
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.retired import with_former_names
from rps_exudyn.results.law_error import LawError, error_of_law
from rps_exudyn.results.outcome import Interrupted, Status, alike
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import LAW_OF_SERIES, resolve_contact_law
from rps_exudyn.simulate.batch import Batch
from rps_exudyn.simulate.run import simulate

LEAST_OK = 8  # samples with a number, for quantiles
FEWEST, MOST = LEAST_OK, 100_000  # samples that may be asked for
LEFT_OUT = ("energy_residual",)  # metrics that are no property of the gear
OnProgress = Callable[[int, int], None]
"""Called with the number of samples that are done, and of all."""


@dataclass(frozen=True, eq=False)
class Curves:
    """Quantiles of the scene's signal at each instant of the nominal run."""

    signal: str
    quantiles: np.ndarray  # at LEVELS, shape (5, n)


@dataclass(frozen=True, eq=False)
class Drawn:
    """Numbers of samples, in the order of the points; nan where a sample failed."""

    samples: Samples
    numbers: Mapping[str, np.ndarray]  # metric -> shape (n,)
    bars: Mapping[str, np.ndarray]  # metric that has error bars -> half widths (n,), nan: unknown
    failures: Mapping[str, int]  # cause, of its first sample -> number of samples

    @cached_property
    def failed(self) -> int:
        """Samples that gave no numbers."""
        return sum(self.failures.values())

    @cached_property
    def numerical(self) -> dict[str, statistics.NumericalError]:
        """Numerical errors of the metrics that have bars."""
        known = {name: np.isfinite(self.numbers[name]) for name in self.bars}
        return {
            name: statistics.numerical_error(self.numbers[name][some], self.bars[name][some])
            for name, some in known.items()
            if some.any()
        }


@with_former_names(figures="metrics")
@dataclass(frozen=True, eq=False)
class Band:
    """A nominal result and its uncertainty; all values are SI. The former name of `metrics` is `figures`."""

    nominal: Result
    inputs: Mapping[str, Distribution]
    method: str  # in words
    drawn: Drawn
    metrics: Mapping[str, Quantiles]
    contributions: Mapping[str, Contributions]
    curves: Curves | None
    interrupted: bool = False

    @property
    def law(self) -> LawError | None:
        """Error of the contact law, which the band does not contain; see `error_of_law`."""
        return error_of_law(self.nominal)

    def as_dict(self) -> dict[str, Any]:
        """Return the band for a JSON file, without its nominal result; every sample is there."""
        values = {**self.drawn.samples.values, **self.drawn.numbers}
        return {
            "scene": self.nominal.scene,
            "method": self.method,
            "interrupted": self.interrupted,
            "levels": list(LEVELS),
            "inputs": {
                path: {"kind": each.kind, "numbers": [each.first, each.second]}
                for path, each in self.inputs.items()
            },
            "correlation": {
                ", ".join(sorted(pair)): value for pair, value in self.drawn.samples.inputs.pairs.items()
            },
            "samples": len(self.drawn.samples),
            "failures": dict(self.drawn.failures),
            "figures": {
                name: {
                    "nominal": self.nominal.summary.get(name),
                    "nominal_error": self.nominal.errors.get(name),
                    "quantiles": each.values.tolist(),
                    "standard_errors": each.errors.tolist(),
                    **self._numerical(name),
                }
                for name, each in self.metrics.items()
            },
            "contributions": {
                name: {**each.fractions, "together": each.together}
                for name, each in self.contributions.items()
            },
            "effects": {
                name: {
                    path: dict(zip(("slope", "error", "elasticity"), astuple(effect), strict=True))
                    for path, effect in each.effects.items()
                }
                for name, each in self.contributions.items()
            },
            "law_error": self.law.mean_torque if self.law else None,
            "curves": self.curves
            and {
                "pinion_angle": self.nominal.signals.get("pinion_angle", np.zeros(0)).tolist(),
                self.curves.signal: self.curves.quantiles.tolist(),
            },
            "values": {path: column.tolist() for path, column in values.items()},
        }

    def _numerical(self, name: str) -> dict[str, Any]:
        if (found := self.drawn.numerical.get(name)) is None:
            return {}
        of_quantiles = found.of_quantiles.tolist()
        return {"numerical_error": found.of_sample, "numerical_errors_of_quantiles": of_quantiles}


def band_of_runs(
    scene: str,
    gear: SteeringGear,
    fidelity: Fidelity,
    inputs: Mapping[str, Distribution],
    samples: int,
    seed: int = 0,
    on_progress: OnProgress | None = None,
    jobs: int = 1,
    time_limit: float = float("inf"),
) -> Band:
    """Run the scene at `samples` points of the inputs, in up to `jobs` processes, and at their medians.

    A sample that takes longer than the time limit [s] is one that failed.

    Ctrl-C ends it with the band of what is done, if that is enough for one.

    Raises:
        InputError: a number of samples beyond the limits, a nominal gear that fails, or too few samples that
            end ok.
        Interrupted: Ctrl-C before there is a band.
    """
    if not FEWEST <= samples <= MOST:
        raise InputError(f"the band has {samples} samples; it needs {FEWEST} to {MOST}.")
    points = Samples.drawn(inputs, samples, seed)
    nominal = nominal_result(scene, gear, fidelity, inputs)
    return runs_of(points, nominal, fidelity, on_progress, jobs, time_limit).band(nominal, inputs)


def nominal_result(
    scene: str, gear: SteeringGear, fidelity: Fidelity, inputs: Mapping[str, Distribution]
) -> Result:
    """Run the scene on the gear at the medians of its inputs.

    Raises:
        InputError: that run fails.
    """
    gear = resolve_contact_law(gear, fidelity, LAW_OF_SERIES, inputs)
    medians = gear.replace({path: each.nominal for path, each in inputs.items()})
    result = simulate(scene, medians, fidelity)
    if result.status is not Status.OK:
        raise InputError(
            f"a band needs a run at the medians of its inputs, which ends {result.status}: {result.message}."
        )
    return result


@dataclass(frozen=True, eq=False)
class Runs:
    """What became of the points: metrics, and the signal's curves of those that ended ok."""

    drawn: Drawn
    curves: np.ndarray | None  # (ok samples, n) over the nominal instants; None where they do not compare
    interrupted: bool

    def band(self, nominal: Result, inputs: Mapping[str, Distribution]) -> Band:
        """The band of the metrics and curves."""
        drawn, curves = self.drawn, None
        if self.curves is not None and len(self.curves) >= LEAST_OK:
            signal = scene_named(nominal.scene).signal
            curves = Curves(signal, np.quantile(self.curves, LEVELS, axis=0))
        method = f"{len(drawn.samples)} runs at points of a Latin hypercube"
        metrics, contributions = metric_quantiles(drawn), contributions_of(drawn)
        return Band(nominal, inputs, method, drawn, metrics, contributions, curves, self.interrupted)


def runs_of(
    points: Samples,
    nominal: Result,
    fidelity: Fidelity,
    on_progress: OnProgress | None,
    jobs: int,
    time_limit: float,
) -> Runs:
    """Run the scene at all points, or until Ctrl-C.

    Raises:
        Interrupted: Ctrl-C before `LEAST_OK` samples ended ok.
        InputError: fewer end ok.
    """
    names = [name for name in nominal.summary if name not in LEFT_OUT]
    seen = _Seen(nominal, fidelity, names)
    interrupted = False
    try:
        with closing(runs_at(nominal.scene, nominal.gear, fidelity, points, jobs, time_limit)) as parts:
            for rows, part in parts:
                seen.add(rows, part)
                if on_progress is not None:
                    on_progress(len(seen.rows), len(points))
    except KeyboardInterrupt as interrupt:
        if seen.ok < LEAST_OK:
            raise Interrupted(nominal) from interrupt
        interrupted = True
    causes = seen.causes()
    if seen.ok < LEAST_OK:
        raise InputError(
            f"{causes.total()} of {len(seen.rows)} samples failed, too many for a band; most often "
            f"{causes.most_common(1)[0][0]}."
        )
    done = sorted(seen.rows)
    numbers = dict(zip(names, np.array([seen.rows[row] for row in done]).T, strict=True))
    bars = {name: np.array([seen.bars[row].get(name, np.nan) for row in done]) for name in nominal.errors}
    bars = {name: each for name, each in bars.items() if name in numbers}
    drawn = Drawn(replace(points, quantile=points.quantile[done]), numbers, bars, dict(causes.most_common()))
    curves = [seen.curves[row] for row in done if row in seen.curves] if seen.curves else []
    return Runs(drawn, np.array(curves) if curves else None, interrupted)


@dataclass(eq=False)
class _Seen:
    """What the samples so far gave, by their numbers."""

    nominal: Result
    fidelity: Fidelity
    names: list[str]  # of the metrics
    rows: dict[int, list[float]] = field(default_factory=dict)
    bars: dict[int, Mapping[str, float]] = field(default_factory=dict)
    curves: dict[int, np.ndarray] | None = field(default_factory=dict)
    failures: dict[int, tuple[tuple[str, ...], str]] = field(default_factory=dict)  # kind, and cause

    @property
    def ok(self) -> int:
        return len(self.rows) - len(self.failures)

    @cached_property
    def grid(self) -> list[np.ndarray]:
        """Times of the nominal curve, by its pieces."""
        scene, nominal = scene_named(self.nominal.scene), self.nominal
        return [time for time, _ in scene.curve(nominal.signals, nominal.gear, self.fidelity).pieces]

    def causes(self) -> Counter[str]:
        """Number of samples of each cause of failure, in the words of the first of them."""
        causes: Counter[str] = Counter()
        examples: dict[tuple[str, ...], str] = {}
        for _, (kind, cause) in sorted(self.failures.items()):
            causes[examples.setdefault(kind, cause)] += 1
        return causes

    def add(self, rows: Sequence[int], part: Batch) -> None:
        summary, errors = part.summary, part.errors
        ended = zip(rows, part.results, part.statuses, part.messages, strict=True)
        for i, (row, result, status, message) in enumerate(ended):
            self.bars[row] = {name: float(column[i]) for name, column in errors.items()}
            if status is not Status.OK:
                self.rows[row] = [np.nan] * len(self.names)
                kind = alike(status, () if result is None else result.codes, message)
                self.failures[row] = kind, f"{status}: {message}"
            elif result is None:
                figures = {name: float(column[i]) for name, column in summary.items()}
                self.rows[row] = [figures.get(name, np.nan) for name in self.names]
                assert part.found is not None
                self._add_curve(row, part.found.signals_of(i), self.nominal.gear)
            else:
                self.rows[row] = [result.summary.get(name, np.nan) for name in self.names]
                self._add_curve(row, result.signals, result.gear)

    def _add_curve(self, row: int, signals: Signals, gear: SteeringGear) -> None:
        """Add a curve at the nominal run's times; no sample has one as soon as one's motion is another."""
        if self.curves is None:
            return
        try:
            curve = scene_named(self.nominal.scene).curve(signals, gear, self.fidelity)
            self.curves[row] = curve.over(self.grid)
        except ValueError:  # another number of maneuvers
            self.curves = None


def metric_quantiles(drawn: Drawn) -> dict[str, Quantiles]:
    """Return the quantiles of every metric that enough samples have."""
    known = {name: numbers[np.isfinite(numbers)] for name, numbers in drawn.numbers.items()}
    count = len(drawn.samples)
    enough = {name: numbers for name, numbers in known.items() if numbers.size >= LEAST_OK}
    return {name: statistics.quantiles(numbers, count - numbers.size) for name, numbers in enough.items()}


def contributions_of(drawn: Drawn) -> dict[str, Contributions]:
    """Return the contributions to every metric for which there are enough samples."""
    found, groups = {}, drawn.samples.inputs.groups
    fitted: dict[bytes, statistics.Polynomials] = {}  # most metrics are known of the same samples
    for name, numbers in drawn.numbers.items():
        known = np.isfinite(numbers)
        if not known.any():
            continue
        key = known.tobytes()
        if key not in fitted:
            values = {path: column[known] for path, column in drawn.samples.values.items()}
            fitted[key] = statistics.Polynomials.at(drawn.samples.quantile[known], groups, values)
        if each := fitted[key].contributions(numbers[known]):
            found[name] = each
    return found
