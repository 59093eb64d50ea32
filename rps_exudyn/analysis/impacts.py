"""Impacts of the plunger on the yokenut: number, force, duration; the rattle of a gear.

An impact lasts from where the contact force rises from zero to where it has vanished again. A contact that
is closed when the record begins is no impact.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.curve import pieces_of
from rps_exudyn.analysis.passes import Signals


@dataclass(frozen=True)
class Impact:
    """One impact of the plunger on the yokenut."""

    start: float  # last instant before contact [s]
    duration: float  # until the first instant without it, or the record's end [s]
    peak_force: float  # [N]
    impulse: float  # integral of the force [N s]
    speed: float  # of the plunger before contact [m/s]


def find_impacts(time: np.ndarray, force: np.ndarray, displacement: np.ndarray) -> list[Impact]:
    """All impacts in the order of time: of a contact force, 0 without contact [N], and the plunger's
    displacement towards the yokenut [m] over a rising time [s], all of shape (n,)."""
    touching = np.concatenate([[True], force > 0, [False]]).astype(int)  # closed at first: no impact
    begins = np.flatnonzero(np.diff(touching) > 0)
    ends = np.flatnonzero(np.diff(touching) < 0)
    found = []
    for begin in begins.tolist():
        end = int(ends[ends > begin][0])
        span = slice(begin - 1, min(end, len(time) - 1) + 1)
        t, f = time[span], force[span]
        speed = (displacement[begin] - displacement[begin - 1]) / (time[begin] - time[begin - 1])
        impulse = float(np.trapezoid(f, t))
        found.append(Impact(float(t[0]), float(t[-1] - t[0]), float(f.max()), impulse, float(speed)))
    return found


def describe_impacts(signals: Signals) -> dict[str, float]:
    """Metrics: number, fraction of time in contact, largest impact; {} without the signals."""
    if not {"yokenut_force", "plunger_displacement"} <= set(signals) or len(signals["time"]) < 2:
        return {}
    time, force = signals["time"], signals["yokenut_force"]
    found = find_impacts(time, force, signals["plunger_displacement"])
    whole = float(time[-1] - time[0])
    metrics = {
        "impacts": float(len(found)),
        "impact_contact_share": float(np.trapezoid((force > 0).astype(float), time)) / whole,
        "impact_force_rms": float(np.sqrt(np.trapezoid(force**2, time) / whole)),
    }
    largest = ("peak_force", "impulse", "duration", "speed") if found else ()
    return metrics | {f"impact_{name}": max(getattr(impact, name) for impact in found) for name in largest}


# --- Rattle: impacts in each cycle of the force of a road
#
# Motions with impacts are chaotic: from start to start the number of impacts and the fastest of them differ,
# so that they are given with their scatter over the phases at which the force begins. Sums and root mean
# squares over cycles converge; what is left of their scatter from cycle to cycle is given as the standard
# uncertainty of the mean, by type A of the GUM (JCGM 100:2008, 4.2.3).


def split_at_repeats(signals: Signals) -> list[Signals]:
    """Split a record of joined maneuvers where an instant stands twice."""
    return [
        {name: values[piece] for name, values in signals.items()}
        for piece in pieces_of(signals["time"])
        if piece.stop - piece.start > 1
    ]


def describe_rattle(
    signals: Signals, period: float, plunger_mass: float, band: tuple[float, float]
) -> dict[str, float]:
    """Metrics of a record of whole cycles of a force, `period` long [s]; {} without a yokenut.

    The record may consist of several runs, one for each phase at which the force begins. `band` are the ends
    of that of the rack's acceleration [Hz].
    """
    if "yokenut_force" not in signals or len(signals["time"]) < 2:
        return {}
    runs = split_at_repeats(signals)
    each = [find_impacts(run["time"], run["yokenut_force"], run["plunger_displacement"]) for run in runs]
    cycles = sum(_duration(run) for run in runs) / period
    speeds = np.array([impact.speed for impacts in each for impact in impacts])
    rates = [len(impacts) * period / _duration(run) for impacts, run in zip(each, runs, strict=True)]
    fastest = [max((impact.speed for impact in impacts), default=0.0) for impacts in each]
    squares = sum(_integral(run, run["yokenut_force"] ** 2) for run in runs)
    rms = float(np.sqrt(squares / sum(_duration(run) for run in runs)))
    uncertain = {}
    if len(of_cycles := _by_cycle(runs, each, period, plunger_mass / 2)) > 1:
        impulse, square, energy = np.std(of_cycles, axis=0, ddof=1) / np.sqrt(len(of_cycles))
        uncertain = {
            "rattle_impulse_uncertainty": float(impulse),
            "rattle_force_rms_uncertainty": float(square) / (2 * rms) if rms else 0.0,
            "rattle_energy_uncertainty": float(energy),
        }
    return uncertain | {
        "rattle_impulse_per_cycle": sum(_integral(run, run["yokenut_force"]) for run in runs) / cycles,
        "rattle_force_rms": rms,
        "rattle_speed_rms": float(np.sqrt(np.mean(speeds**2))) if speeds.size else 0.0,
        "rattle_energy_per_cycle": sum(plunger_mass / 2 * speed**2 for speed in speeds.tolist()) / cycles,
        "rattle_acceleration_rms": float(np.sqrt(np.mean([_shaking(run, band) ** 2 for run in runs]))),
        "rattle_impacts_per_cycle": float(np.mean(rates)),
        "rattle_impacts_scatter": float(np.std(rates)),
        "rattle_fastest_impact": float(np.mean(fastest)),
        "rattle_fastest_scatter": float(np.std(fastest)),
    }


def _by_cycle(
    runs: Sequence[Signals], impacts: Sequence[Sequence[Impact]], period: float, half_mass: float
) -> np.ndarray:
    """Return the force's impulse [N s], mean square [N^2] and the impacts' energy [J] of each whole cycle of
    all runs, shape (cycles, 3)."""
    from scipy.integrate import cumulative_trapezoid  # a fifth of a second, which other scenes are spared

    cycles = []
    for run, found in zip(runs, impacts, strict=True):
        time, force = run["time"], run["yokenut_force"]
        ends = time[0] + period * np.arange(round(_duration(run) / period) + 1)
        sums = [
            np.interp(ends, time, cumulative_trapezoid(values, time, initial=0))
            for values in (force, force**2)
        ]
        begins = [impact.start for impact in found]
        energy = np.histogram(begins, ends, weights=[half_mass * impact.speed**2 for impact in found])[0]
        cycles.append(np.column_stack([np.diff(sums[0]), np.diff(sums[1]) / period, energy]))
    return np.concatenate(cycles)


def _duration(run: Signals) -> float:
    return float(run["time"][-1] - run["time"][0])


def _integral(run: Signals, values: np.ndarray) -> float:
    return float(np.trapezoid(values, run["time"]))


def _shaking(run: Signals, band: tuple[float, float]) -> float:
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
    inside = (frequency >= band[0]) & (frequency <= band[1])
    spectrum = np.fft.rfft(moved)[inside] * (2 * np.pi * frequency[inside]) ** 2
    return float(np.sqrt(2 * np.sum(np.abs(spectrum) ** 2) / len(even) / np.sum(window**2)))
