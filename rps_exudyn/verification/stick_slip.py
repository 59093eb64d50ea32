"""Stick-slip of gear and steering column reduced to one inertia (`analysis.stick_slip`), by events.

`event_based` sticks or slips, and finds where one ends, by an integrator of variable step; a mass on a belt
is the same motion seen from the mass. Own solutions: nothing of the package's kernels is in them.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from rps_exudyn.analysis.stick_slip import Oscillator

LEAST_SPEED = 0.01  # of the largest looked at
BEGUN = 1e-9  # of a slip's time, in periods: before it the speed is not looked at


@dataclass(frozen=True)
class Cycle:
    """A stick-slip cycle."""

    stick: float  # duration [s]
    slip: float  # duration [s]
    amplitude: float  # half the range of the twist [rad]


def event_based(model: Oscillator, drive: float, cycles: int = 6, rtol: float = 1e-9) -> Cycle | None:
    """Return the last of some cycles at a drive's speed above zero [rad/s], begun at rest; None where it goes
    on sliding."""
    release = (model.friction(0.0) - model.damping * drive) / model.stiffness
    twist, found = min(0.0, release), None
    for _ in range(cycles):
        stick = max(0.0, (release - twist) / drive)
        solved = solve_ivp(
            lambda time, state: _slipping(model, drive, state),
            (0.0, 80 * np.pi / model.frequency),
            [max(release, twist), 0.0],
            events=_stop(model),
            rtol=rtol,
            atol=1e-12,
            max_step=0.1 / model.frequency,
        )
        if not solved.t_events[0].size:
            return None
        twist, slip = float(solved.y_events[0][0, 0]), float(solved.t_events[0][0])
        found = Cycle(stick, slip, float(np.ptp(np.append(solved.y[0], twist))) / 2)
    return found


def largest_sticking_speed(model: Oscillator, upper: float, tolerance: float = 0.01) -> float:
    """Return the largest speed up to `upper` at which a start from rest ends in stick-slip [rad/s]; 0 where
    none does.

    Searched downwards over a grid of factors 1.3, then bisected. Where Stribeck's curve begins flat, slowest
    sliding is stable again.
    """
    speed = upper
    while event_based(model, speed, rtol=1e-7) is None:
        speed /= 1.3
        if speed < LEAST_SPEED * upper:
            return 0.0
    low, high = speed, min(1.3 * speed, upper)
    while high - low > tolerance * high:
        middle = (low + high) / 2
        low, high = (middle, high) if event_based(model, middle, rtol=1e-7) else (low, middle)
    return (low + high) / 2


def _slipping(model: Oscillator, drive: float, state: np.ndarray) -> list[float]:
    twist, speed = state
    torque = model.stiffness * twist + model.damping * (drive - speed) - model.friction(max(speed, 0.0))
    # at the release nothing is left over: the drive begins to pull
    pull = max(torque, 0.0) if speed <= 0 else torque
    return [drive - speed, pull / model.inertia]


def _stop(model: Oscillator):  # type: ignore[no-untyped-def]
    def stops(time: float, state: np.ndarray) -> float:
        return float(state[1]) if time * model.frequency > BEGUN else 1.0

    stops.terminal, stops.direction = True, -1  # type: ignore[attr-defined]
    return stops
