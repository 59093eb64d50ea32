"""Rattle: what the plunger does to the yokenut in each cycle of a road's force, and what the rack shakes by.

Motions with impacts are chaotic: from start to start the number of impacts and the fastest of them differ, so
that they are given with their scatter over the phases at which the force begins. Sums and root mean squares
over cycles converge.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.impacts import Impact, find_impacts
from rps_exudyn.analysis.passes import Signals


@dataclass(frozen=True)
class FrequencyBand:
    """A band of frequencies [Hz]."""

    low: float
    high: float


def split_at_repeats(signals: Signals) -> list[Signals]:
    """Split a record of joined maneuvers where an instant stands twice."""
    time = signals["time"]
    cuts = np.flatnonzero(np.diff(time) <= 0) + 1
    pieces = zip([0, *cuts], [*cuts, len(time)], strict=True)
    return [{name: values[a:b] for name, values in signals.items()} for a, b in pieces if b - a > 1]


def describe_rattle(
    signals: Signals, period: float, plunger_mass: float, band: FrequencyBand
) -> dict[str, float]:
    """The summary's figures of a record of whole cycles of a force, `period` long [s]; {} without a yokenut.

    The record may consist of several runs, one for each phase at which the force begins.
    """
    if "yokenut_force" not in signals or len(signals["time"]) < 2:
        return {}
    runs = split_at_repeats(signals)
    each = [find_impacts(run["time"], run["yokenut_force"], run["plunger_displacement"]) for run in runs]
    cycles = sum(_duration(run) for run in runs) / period
    found = [impact for impacts in each for impact in impacts]
    rates = [len(impacts) * period / _duration(run) for impacts, run in zip(each, runs, strict=True)]
    fastest = [max((impact.speed for impact in impacts), default=0.0) for impacts in each]
    return {
        "rattle_impulse_per_cycle": sum(_integral(run, run["yokenut_force"]) for run in runs) / cycles,
        "rattle_force_rms": _rms(runs, "yokenut_force"),
        "rattle_speed_rms": _speed_rms(found),
        "rattle_energy_per_cycle": sum(plunger_mass / 2 * impact.speed**2 for impact in found) / cycles,
        "rattle_acceleration_rms": float(np.sqrt(np.mean([_shaking(run, band) ** 2 for run in runs]))),
        "rattle_impacts_per_cycle": float(np.mean(rates)),
        "rattle_impacts_scatter": float(np.std(rates)),
        "rattle_fastest_impact": float(np.mean(fastest)),
        "rattle_fastest_scatter": float(np.std(fastest)),
    }


def first_hit(run: Signals) -> float | None:
    """Return when the yokenut is first hit, from the beginning of a run [s]; None if it never is."""
    hit = np.flatnonzero(run["yokenut_force"] > 0)
    return float(run["time"][hit[0]] - run["time"][0]) if hit.size else None


def _speed_rms(found: Sequence[Impact]) -> float:
    """Root mean square of the plunger's speed before contact over all impacts [m/s]; 0 without any."""
    return float(np.sqrt(np.mean([impact.speed**2 for impact in found]))) if found else 0.0


def _duration(run: Signals) -> float:
    return float(run["time"][-1] - run["time"][0])


def _integral(run: Signals, values: np.ndarray) -> float:
    return float(np.trapezoid(values, run["time"]))


def _rms(runs: Sequence[Signals], name: str) -> float:
    """Root mean square of a signal over the time of all runs."""
    squares = sum(_integral(run, run[name] ** 2) for run in runs)
    return float(np.sqrt(squares / sum(_duration(run) for run in runs)))


def _shaking(run: Signals, band: FrequencyBand) -> float:
    """Root mean square in a band of the rack's acceleration along Y at the pitch point [m/s^2], by Parseval.

    The spectrum is that of the displacement times omega^2; a Hann window keeps the ends of the record out.
    """
    time, lift = run["time"], run["rack_y"]
    even = np.linspace(time[0], time[-1], len(time))
    window = np.hanning(len(even))
    moved = np.interp(even, time, lift)
    moved = (moved - moved.mean()) * window
    step = even[1] - even[0]
    frequency = np.fft.rfftfreq(len(even), step)
    inside = (frequency >= band.low) & (frequency <= band.high)
    spectrum = np.fft.rfft(moved)[inside] * (2 * np.pi * frequency[inside]) ** 2
    return float(np.sqrt(2 * np.sum(np.abs(spectrum) ** 2) / len(even) / np.sum(window**2)))
