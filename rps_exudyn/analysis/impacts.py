"""Impacts of the plunger on the yokenut: number, force, duration; the rattle of a gear.

An impact lasts from where the contact force rises from zero to where it has vanished again. A contact that
is closed when the record begins is no impact.
"""

from dataclasses import dataclass

import numpy as np

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
    """All impacts in the order of time.

    Args:
        time: [s], shape (n,), rising.
        force: contact force, 0 without contact [N], shape (n,).
        displacement: of the plunger towards the yokenut [m], shape (n,).
    """
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
    """The summary's figures: number, fraction of time in contact, largest impact; {} without the signals."""
    if not {"yokenut_force", "plunger_displacement"} <= set(signals) or len(signals["time"]) < 2:
        return {}
    time, force = signals["time"], signals["yokenut_force"]
    found = find_impacts(time, force, signals["plunger_displacement"])
    whole = float(time[-1] - time[0])
    figures = {
        "impacts": float(len(found)),
        "impact_contact_share": float(np.trapezoid((force > 0).astype(float), time)) / whole,
        "impact_force_rms": float(np.sqrt(np.trapezoid(force**2, time) / whole)),
    }
    largest = ("peak_force", "impulse", "duration", "speed") if found else ()
    return figures | {f"impact_{name}": max(getattr(impact, name) for impact in found) for name in largest}
