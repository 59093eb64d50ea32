"""Two results compared: settings that differ, and how far their curves lie apart.

    from rps_exudyn.analysis.result_comparison import compare

    comparison = compare(rps.load("full.h5"), rps.load("flank.h5"))
    comparison.signals["pinion_torque"].rms  # [N m]

Signals are compared over the pinion angle that both results cover, at every angle that either of them
recorded; between its own angles a result is interpolated linearly. Differences are second minus first.
Where a pinion turns back, the longest passes in a direction of both results are compared, +X before -X.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rps_exudyn.analysis.passes import Signals, common_angles, interpolated, longest_pass
from rps_exudyn.analysis.torque import mean
from rps_exudyn.results.provenance import FIELDS
from rps_exudyn.results.quantities import SIGNALS, WORKS
from rps_exudyn.results.result import Result

Pair = tuple[Any, Any]
"""(first, second); None for what one of the results does not have."""


@dataclass(frozen=True, eq=False)
class SignalPair:
    """One signal of both results at the n common angles; SI units."""

    name: str
    first: np.ndarray  # shape (n,)
    second: np.ndarray  # shape (n,)
    mean: float  # of the first over the angle
    rms: float  # of the difference over the angle
    largest: float  # difference by magnitude, with its sign
    angle: float  # of the largest difference [rad]

    @property
    def difference(self) -> np.ndarray:
        """Second minus first, shape (n,)."""
        return self.second - self.first

    def shown(self, difference: float) -> str:
        """The difference as text: of a torque in % of its mean, else in the display unit."""
        if self.name == "pinion_torque" and self.mean:
            return f"{100 * difference / abs(self.mean):.3g} %"
        return SIGNALS[self.name].show(difference)


@dataclass(frozen=True, eq=False)
class ResultComparison:
    """Settings, summaries with their error bars, and signals of two results side by side."""

    settings: dict[str, Pair]  # those that differ: path such as yoke.preload, fidelity.mesh, solver.steps
    scene: Pair
    status: Pair
    summary: dict[str, Pair]  # every number that one of them has
    errors: dict[str, Pair]  # half widths of their bars; None: without one, nan: unknown
    angle: np.ndarray  # common pinion angles, rising [rad], shape (n,); empty if there are none
    signals: dict[str, SignalPair]  # those that both have, without the angle

    @property
    def joint_bars(self) -> dict[str, float]:
        """Half widths of the bars of differences where both numbers have one; biases, so that they add up."""
        return {name: sum(pair) for name, pair in self.errors.items() if None not in pair}

    @property
    def exceeding(self) -> list[str]:
        """Numbers whose difference exceeds its joint bar."""
        return [
            name
            for name, bar in self.joint_bars.items()
            if abs(self.summary[name][1] - self.summary[name][0]) > bar
        ]


def compare(first: Result, second: Result) -> ResultComparison:
    """Compare two results of any scenes and fidelities."""
    settings = _side_by_side(*(dict(_leaves(_settings(each))) for each in (first, second)))
    parts = _comparable_parts(first, second)
    angle = common_angles(*(part.get("pinion_angle", np.zeros(0)) for part in parts))
    common = [name for name in parts[0] if name in parts[1] and name != "pinion_angle"]
    return ResultComparison(
        settings={path: (a, b) for path, (a, b) in settings.items() if a != b},
        scene=(first.scene, second.scene),
        status=(first.status, second.status),
        summary=_side_by_side(first.summary, second.summary),
        errors=_side_by_side(first.errors, second.errors),
        angle=angle,
        signals={
            name: signal_pair(name, angle, *(_over(angle, part, name) for part in parts))
            for name in (common if angle.size else ())
        },
    )


def _settings(result: Result) -> dict[str, Any]:
    fidelity = {name: value for name, value in result.fidelity.items() if name != "based_on"}
    return {**result.gear.model_dump(), "fidelity": fidelity, "solver": result.solver}


def _side_by_side(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Pair]:
    return {name: (first.get(name), second.get(name)) for name in dict.fromkeys([*first, *second])}


def _leaves(tables: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in tables.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


def _comparable_parts(first: Result, second: Result) -> tuple[Signals, Signals]:
    """The parts of both records that can be compared over the angle; empty if there are none."""
    if turns_one_way(first) and turns_one_way(second):
        return first.signals, second.signals
    for direction in (+1, -1):
        a, b = (longest_pass(result.signals, direction) for result in (first, second))
        if a and b:
            return a.signals, b.signals
    return {}, {}


def turns_one_way(result: Result) -> bool:
    """Return whether the pinion angle only rises, or only falls."""
    angle = result.signals.get("pinion_angle", np.zeros(0))
    steps = np.diff(angle)
    return bool(steps.size and np.isfinite(angle).all() and ((steps > 0).all() or (steps < 0).all()))


def signal_pair(name: str, angle: np.ndarray, first: np.ndarray, second: np.ndarray) -> SignalPair:
    """Compare two curves over the same rising angles [rad]; all arrays have the shape (n,)."""
    difference = second - first
    at = int(np.argmax(np.abs(difference)))
    return SignalPair(
        name=name,
        first=first,
        second=second,
        mean=mean(angle, first),
        rms=float(np.sqrt(mean(angle, difference**2))),
        largest=float(difference[at]),
        angle=float(angle[at]),
    )


def _over(angle: np.ndarray, signals: Signals, name: str) -> np.ndarray:
    """A signal at given pinion angles; what counts from the start of recording counts from theirs."""
    sense = 1 if signals["pinion_angle"][-1] > signals["pinion_angle"][0] else -1
    values = interpolated(signals, name, angle, sense)
    return values - values[0 if sense > 0 else -1] if name == "time" or name in WORKS else values


# --- A result compared number by number with its repetition

VARYING = ("date",)  # of the provenance: has no effect on the numbers


def differing_numbers(old: Result, new: Result) -> dict[str, tuple[Any, Any]]:
    """Name -> (old, new): status, summary, signals (the first value that differs); {} if all are the same.

    Signals of a thinned record are not compared. If numbers differ, differing versions are listed too.
    """
    found: dict[str, tuple[Any, Any]] = {}
    if old.status is not new.status:
        found["status"] = (old.status.value, new.status.value)
    found |= {
        name: pair
        for name, pair in _side_by_side(old.summary, new.summary).items()
        if pair[0] != pair[1] and any(value == value for value in pair)  # nan is nan again
    }
    for name, values in old.signals.items():
        if name in new.signals and len(values) == len(new.signals[name]):
            differs = np.flatnonzero(~np.isclose(values, new.signals[name], rtol=0, atol=0, equal_nan=True))
            if differs.size:
                found[f"{name}[{differs[0]}]"] = (values[differs[0]], new.signals[name][differs[0]])
    if found:
        found |= {
            name: (old.provenance[name], new.provenance[name])
            for name in FIELDS
            if name not in VARYING and old.provenance[name] != new.provenance[name]
        }
    return found


def largest_difference(old: Result, new: Result) -> tuple[str, float]:
    """Return the signal or number that differs most, and its relative difference; ("", 0.0) if none.

    Signals of different length are not compared.
    """
    differences = {"": 0.0}
    for own, others in ((old.signals, new.signals), (old.summary, new.summary)):
        for name in (name for name in own if name in others):
            first, second = np.atleast_1d(own[name]), np.atleast_1d(others[name])
            if first.size == second.size:
                change, size = np.abs(first - second), np.nanmax(np.abs(first), initial=1e-300)
                differences[name] = float(np.nanmax(change, initial=0.0) / size)
    name = max(differences, key=differences.__getitem__)
    return name, differences[name]
