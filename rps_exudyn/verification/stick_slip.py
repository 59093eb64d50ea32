"""Stick-slip of one inertia behind a spring and a damper, reduced from gear and steering column.

The wheel turns at a constant speed Omega; the gear, of inertia J [kg m^2], follows through k [N m/rad] and c
[N m s/rad] against the friction of its parts, T_i g_i(omega). With x the twist of the column,

    x' = Omega - omega,        J omega' = k x + c (Omega - omega) - sum T_i g_i(omega).

A mass on a belt is the same motion seen from the mass. `event_based` sticks or slips, and finds where one
ends; `Oscillator.linear_limit` and `bristle_margin` say where steady sliding loses its stability. Own
solutions: nothing of the package's kernels is in them.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

LEAST_SPEED = 0.01  # of the largest looked at
BEGUN = 1e-9  # of a slip's time, in periods: before it the speed is not looked at


@dataclass(frozen=True)
class Rubbing:
    """Friction of one part, reduced to the pinion."""

    torque: float  # kinetic [N m]
    ratio: float = 1.0  # static over kinetic
    stribeck_speed: float = 1.0  # [rad/s]
    exponent: float = 2.0

    def at(self, speed: float) -> float:
        """Return the friction at a speed from zero on [N m]."""
        share = (speed / self.stribeck_speed) ** self.exponent
        return float(self.torque * (1 + (self.ratio - 1) * np.exp(-share)))

    def slope(self, speed: float) -> float:
        """Return its derivative by the speed, above zero [N m s/rad]."""
        share = (speed / self.stribeck_speed) ** self.exponent
        return float(-self.torque * (self.ratio - 1) * np.exp(-share) * self.exponent * share / speed)


@dataclass(frozen=True)
class Oscillator:
    """Inertia, column and friction of the reduced model."""

    inertia: float  # [kg m^2]
    stiffness: float  # [N m/rad]
    damping: float  # [N m s/rad]
    parts: tuple[Rubbing, ...]

    @property
    def frequency(self) -> float:
        """Undamped angular frequency [rad/s]."""
        return float(np.sqrt(self.stiffness / self.inertia))

    def friction(self, speed: float) -> float:
        """Return the friction of all parts at a speed from zero on [N m]."""
        return sum(part.at(speed) for part in self.parts)

    def linear_limit(self, speed: float) -> float:
        """Return the damping below which sliding at a speed is unstable, that of falling friction
        [N m s/rad]."""
        return max(0.0, -sum(part.slope(speed) for part in self.parts))

    def bristle_margin(self, speed: float, presliding: float) -> float:
        """Return what is above zero where sliding at a speed is stable with bristles (one presliding angle).

        About steady sliding a bristle's friction follows T g by the lag tau = delta g / omega, so that
        J tau s^3 + (J + c tau) s^2 + (c + k tau + T g') s + k must be Hurwitz:
        (J + c tau)(c + k tau + T g') > J tau k, divided here by J k / omega0.
        """
        kinetic = sum(part.torque for part in self.parts)
        tau = presliding * self.friction(speed) / kinetic / speed
        falling = self.linear_limit(speed)
        second, first = self.inertia + self.damping * tau, self.damping + self.stiffness * tau - falling
        if first <= 0:
            return first * self.frequency / self.stiffness
        lag = self.inertia * tau * self.stiffness
        return (second * first - lag) * self.frequency / (self.inertia * self.stiffness)


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
