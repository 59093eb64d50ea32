"""Errors of a curve and its cost: references with uncertainty, errors, Pareto fronts.

    reference = agreed_reference({"equilibria by generators": first, "slow dynamics by strips": second})
    reference.uncertainty             # the methods' largest difference, RMS in % of the mean
    curve_errors(record, reference)   # of another record of the same motion

Errors are in % of the reference's mean size, over the time that both curves cover. Between its own instants a
record is interpolated by a cubic spline (`rms`) and by straight lines (`rms_linear`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from rps_exudyn.analysis.curve import Curve
from rps_exudyn.analysis.harmonics import order_amplitude

EVEN_POINTS = 3601  # of a piece, at which curves are compared
UNEVEN = 1.5  # of neighbouring steps, from which on a cubic spline may overshoot


def smoothly_over(curve: Curve, grids: Sequence[np.ndarray]) -> np.ndarray:
    """Values of a curve at given times [s], a grid for each piece, by cubic splines; between uneven steps,
    where these overshoot, by a monotone interpolant."""
    found = []
    for (time, values), grid in zip(curve.pieces, grids, strict=True):
        steps = np.diff(time)
        if time.size <= 3:
            found.append(np.interp(grid, time, values))
        elif (np.maximum(steps[1:], steps[:-1]) <= UNEVEN * np.minimum(steps[1:], steps[:-1])).all():
            found.append(CubicSpline(time, values)(grid))
        else:
            found.append(PchipInterpolator(time, values)(grid))
    return np.concatenate(found)


def size_of(curve: Curve) -> float:
    """Return the mean magnitude over time, to which errors are related."""
    area = sum(float(np.trapezoid(np.abs(values), time)) for time, values in curve.pieces)
    return area / sum(float(time[-1] - time[0]) for time, _ in curve.pieces)


def both_over_time(record: Curve, reference: Curve, smooth: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Return values of both at even times that both cover, piece by piece."""
    grids = []
    for (own, _), (true, _) in zip(record.pieces, reference.pieces, strict=True):
        grids.append(np.linspace(max(own[0], true[0]), min(own[-1], true[-1]), EVEN_POINTS))
    values = smoothly_over(record, grids) if smooth else record.over(grids)
    return values, smoothly_over(reference, grids)


def rms_difference(first: np.ndarray, second: np.ndarray, size: float) -> float:
    """Return the RMS of the difference of values, in % of a size."""
    return 100 * float(np.sqrt(np.mean((first - second) ** 2))) / size


@dataclass(frozen=True, eq=False)
class Reference:
    """A curve on which methods agree."""

    curve: Curve
    uncertainty: float  # largest RMS difference of the methods, % of the mean size
    differences: dict[str, float]  # the same, pair by pair of methods


@dataclass(frozen=True)
class Errors:
    """Errors of a record, in % of the reference's mean size."""

    rms: float
    rms_linear: float
    bias: float  # of the mean
    peak_to_peak: float
    tooth_order: float | None = None  # of the amplitude; None if it is unknown
    first_order: float | None = None

    @property
    def either_way(self) -> float:
        """Larger RMS of both interpolations."""
        return max(self.rms, self.rms_linear)


def agreed_reference(methods: Mapping[str, Curve]) -> Reference:
    """The first method's curve, with the differences of all methods.

    Raises:
        ValueError: fewer than two methods.
    """
    if len(methods) < 2:
        raise ValueError("a reference needs two methods")
    curve = next(iter(methods.values()))
    size = size_of(curve)
    differences = {
        f"{a} - {b}": rms_difference(*both_over_time(methods[b], methods[a]), size)
        for a, b in combinations(methods, 2)
    }
    return Reference(curve, max(differences.values()), differences)


def curve_errors(
    record: Curve, reference: Reference, turned: float | None = None, teeth: int | None = None
) -> Errors:
    """Errors of a record; of orders too if the pinion turned steadily, by `turned` [rad] in one piece."""
    own, true = both_over_time(record, reference.curve)
    linear, _ = both_over_time(record, reference.curve, smooth=False)
    size = size_of(reference.curve)
    orders: dict[str, float | None] = {}
    if turned is not None and teeth is not None:
        ends = reference.curve.time[[0, -1]]
        covered = (min(record.time[-1], ends[1]) - max(record.time[0], ends[0])) / (ends[1] - ends[0])
        angle = np.linspace(0.0, turned * covered, own.size)
        for name, order in (("tooth_order", teeth), ("first_order", 1)):
            amplitudes = [order_amplitude(angle, values, order) for values in (own, true)]
            if None not in amplitudes:
                orders[name] = 100 * (amplitudes[0] - amplitudes[1]) / size
    return Errors(
        rms=rms_difference(own, true, size),
        rms_linear=rms_difference(linear, true, size),
        bias=100 * float(np.mean(own) - np.mean(true)) / size,
        peak_to_peak=100 * float(np.ptp(own) - np.ptp(true)) / size,
        **orders,
    )


# --- many of them ----------------------------------------------------------------------------------
def pareto_front(cost: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Mask (n,) of the points that no other beats in both; points that are not finite never count."""
    cost, error = np.asarray(cost, dtype=float), np.asarray(error, dtype=float)
    finite = np.isfinite(cost) & np.isfinite(error)
    beaten = np.array(
        [
            bool((finite & (cost <= c) & (error <= e) & ((cost < c) | (error < e))).any())
            for c, e in zip(cost, error, strict=True)
        ],
        dtype=bool,
    )
    return finite & ~beaten


def power_law(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Return p and c of y ~ c x^p, by least squares in the logarithms."""
    slope, constant = np.polyfit(np.log(x), np.log(y), 1)
    return float(slope), float(np.exp(constant))
