"""Stick-slip of a gear behind a steering column: where it sticks, and what a record of it shows.

Reduced to one inertia J [kg m^2]: the wheel turns at a constant speed Omega; the gear follows through k
[N m/rad] and c [N m s/rad] against the friction of its parts, T_i g_i(omega). With the column's twist x,

    x' = Omega - omega,        J omega' = k x + c (Omega - omega) - sum T_i g_i(omega).

Each time the gear has stuck it starts in the same state, at rest under static friction; so one slip decides:
if it comes to rest again, it sticks for ever, else it goes on sliding. `Oscillator.linear_limit` is the
damping below which steady sliding is unstable.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

Speeds = np.ndarray | float
Signals = Mapping[str, np.ndarray]

PER_PERIOD = 100  # Runge-Kutta steps in a natural period: the limit to 0.2 %
PERIODS = 60  # natural periods for which a slip is followed at most
SLOWEST, SPEEDS = 5e-4, 64  # of the fastest speed looked at, and how many are looked at together
LEAST_PULL = 1e-6  # of the static surplus, by which a gear that is released begins to move
STUCK = 0.02  # of the wheel's speed: a pinion that turns more slowly sticks
SETTLED = 0.5  # of a record's time, after which it is taken for settled


@dataclass(frozen=True)
class Rubbing:
    """Friction of one part, reduced to the pinion."""

    torque: float  # kinetic [N m]
    ratio: float = 1.0  # static over kinetic
    stribeck_speed: float = 1.0  # [rad/s]
    exponent: float = 2.0

    def at(self, speed: Speeds) -> Any:
        """Return the friction at speeds from zero on [N m], of their shape."""
        if self.ratio == 1:
            return self.torque
        share = (speed / self.stribeck_speed) ** self.exponent
        return self.torque * (1 + (self.ratio - 1) * np.exp(-share))

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
    def surplus(self) -> float:
        """Static less kinetic friction [N m]."""
        return sum(part.torque * (part.ratio - 1) for part in self.parts)

    @property
    def frequency(self) -> float:
        """Undamped angular frequency [rad/s]."""
        return float(np.sqrt(self.stiffness / self.inertia))

    def friction(self, speed: Speeds) -> Any:
        """Return the friction of all parts at speeds from zero on [N m], of their shape."""
        return sum(part.at(speed) for part in self.parts)

    def linear_limit(self, speed: float) -> float:
        """Return the damping below which sliding at a speed is unstable, by falling friction [N m s/rad]."""
        return max(0.0, -sum(part.slope(speed) for part in self.parts))

    def sliding_margin(self, speed: float) -> float:
        """Return what is above zero where steady sliding at a speed is stable: damping less `linear_limit`,
        over that of k / omega0. Bristles change nothing there: all slide at their limit."""
        return (self.damping - self.linear_limit(speed)) * self.frequency / self.stiffness


def sticks(model: Oscillator, drive: np.ndarray) -> np.ndarray:
    """Return at which speeds of the wheel (n,) [rad/s] a gear that has stuck comes to rest again.

    In the plane of twist and speed paths do not cross: minima of the speed fall from one to the next until it
    is at rest, or rise for ever, which two of them show.
    """
    release = (float(model.friction(0.0)) - model.damping * drive) / model.stiffness
    step = 2 * np.pi / model.frequency / PER_PERIOD
    state, stuck = np.stack([release, np.zeros_like(drive)]), np.zeros(drive.shape, dtype=bool)
    before, lowest, sliding = np.zeros((2, drive.size)), np.full(drive.size, np.nan), stuck.copy()
    for i in range(PER_PERIOD * PERIODS):
        state = _stepped(model, drive, state, step)
        if i > 1:
            stuck |= (state[1] <= 0) & ~sliding
            low = (before[1] < before[0]) & (before[1] <= state[1])
            sliding |= low & (before[1] > lowest) & ~stuck
            lowest = np.where(low, before[1], lowest)
            if (stuck | sliding).all():
                break
        before = np.stack([before[1], state[1]])
    return stuck


def _stepped(model: Oscillator, drive: np.ndarray, state: np.ndarray, step: float) -> np.ndarray:
    """Classical Runge-Kutta's step."""
    first = _slipping(model, drive, state)
    second = _slipping(model, drive, state + step / 2 * first)
    third = _slipping(model, drive, state + step / 2 * second)
    last = _slipping(model, drive, state + step * third)
    return np.asarray(state + step / 6 * (first + 2 * second + 2 * third + last))


def _slipping(model: Oscillator, drive: np.ndarray, state: np.ndarray) -> np.ndarray:
    twist, speed = state
    torque = model.stiffness * twist + model.damping * (drive - speed)
    torque = torque - model.friction(np.maximum(speed, 0.0))
    # at the release nothing is left over: the drive begins to pull
    pull = np.where(speed <= 0, np.maximum(torque, LEAST_PULL * model.surplus), torque)
    return np.stack([drive - speed, pull / model.inertia])


def sticking_speed(model: Oscillator, fastest: float = 100.0) -> float:
    """Return the largest speed of the wheel at which the gear goes on sticking [rad/s], from rest on; 0 where
    it never does, `fastest` where it does at all speeds up to that."""
    if not model.surplus > 0:
        return 0.0
    speeds = np.geomspace(SLOWEST * fastest, fastest, SPEEDS)
    for _ in range(2):
        last = np.flatnonzero(sticks(model, speeds))
        if not last.size:
            return 0.0
        if last[-1] == SPEEDS - 1:
            return float(speeds[-1])
        low, high = speeds[last[-1]], speeds[last[-1] + 1]
        speeds = np.linspace(low, high, SPEEDS)
    return float((low + high) / 2)


def describe_stick_slip(signals: Signals, speed: float) -> dict[str, float]:
    """Metrics of a gear behind a wheel that turns at a speed [rad/s] from rest on.

    Amplitudes and frequency are those of the record's later half, the frequency where the gear sticks there;
    the breakaway is that of its beginning.
    """
    time, twist, torque = (signals[name] for name in ("time", "column_twist", "column_torque"))
    later = time >= time[-1] * SETTLED
    if later.sum() < 3:
        return {}
    turning = np.gradient(signals["pinion_angle"], time) * np.sign(speed)
    still = np.trapezoid((turning[later] < STUCK * abs(speed)).astype(float), time[later])
    running = float(np.mean(np.sign(speed) * torque[later]))
    peak = float((np.sign(speed) * torque).max())
    metrics = {
        "stick_slip_amplitude": float(np.ptp(twist[later])) / 2,
        "stick_slip_torque": float(np.ptp(torque[later])) / 2,
        "stick_share": float(still / np.ptp(time[later])),
        "breakaway_torque": peak,
        "breakaway_ratio": peak / running,
    }
    starts = _rising(turning[later] - np.mean(turning[later]))
    if still > 0 and starts.size > 1:  # vibration without sticking has no frequency that steps agree on
        metrics["stick_slip_frequency"] = (starts.size - 1) / float(np.ptp(time[later][starts]))
    return metrics


def _rising(values: np.ndarray) -> np.ndarray:
    """Indices at which values rise through zero, after they were below it by a tenth of their range."""
    low, starts, below = -0.1 * float(np.ptp(values)), [], False
    for i, value in enumerate(values):
        if value < low:
            below = True
        elif value > 0 and below:
            starts.append(i)
            below = False
    return np.array(starts, dtype=int)
