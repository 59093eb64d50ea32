"""Stick-slip of gear and steering column reduced to one inertia (`analysis.friction_oscillator`), by events.

`event_based` sticks or slips, and finds where one ends, by an integrator of variable step; a mass on a belt
is the same motion seen from the mass. Own solutions: nothing of the package's kernels is in them.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

from rps_exudyn.analysis.friction_oscillator import Oscillator

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


# --- maps, and methods that know no events --------------------------------------------------------------
def on_bristles(
    model: Oscillator, presliding: float, speed: np.ndarray, damping: np.ndarray, periods: int = 40
) -> np.ndarray:
    """Return how the gear moves on bristles, from just before it breaks away on: the least speed over the
    last third, over the wheel's, of the shape of the speeds [rad/s] and dampings [N m s/rad].

    Near 1 it slides, near 0 it sticks. One bristle follows each step of even slip up to the limit of its
    speed, the motion goes by leaps between.
    """
    step = 2 * np.pi / model.frequency / BRISTLE_STEPS
    kinetic, static = sum(part.torque for part in model.parts), float(model.friction(0.0))
    bent = np.full(speed.shape, BEFORE_BREAKAWAY * static / kinetic)
    twist, omega, least = kinetic * bent / model.stiffness, np.zeros(speed.shape), np.ones(speed.shape)
    for i in range(periods * BRISTLE_STEPS):
        curve = model.friction(np.abs(omega)) / kinetic
        bent = np.clip(bent + omega * step / (FIRST_LOADING * presliding), -curve, curve)
        pull = model.stiffness * twist + damping * (speed - omega) - kinetic * bent
        omega = omega + step * pull / model.inertia
        twist = twist + step * (speed - omega)
        if i > periods * BRISTLE_STEPS * 2 // 3:
            least = np.minimum(least, omega / speed)
    return least


BRISTLE_STEPS = 200  # in a natural period
FIRST_LOADING = 2.0  # slip of a first loading of one bristle, over its travel
BEFORE_BREAKAWAY = 0.95  # of static friction


def regularised(
    model: Oscillator, drive: float, zone: float, step: float, end: float, implicit: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return instants [s] and twists [rad] of motion from rest on, friction linear below a speed `zone`
    [rad/s], by classical Runge-Kutta or by the implicit trapezoidal rule."""
    method = _trapezoid if implicit else _runge_kutta
    state = np.zeros(2)
    states = np.empty((int(end / step) + 1, 2))
    for i in range(len(states)):
        states[i] = state
        state = method(model, drive, zone, step, state)
    return step * np.arange(len(states)), states[:, 0]


def _rates(model: Oscillator, drive: float, zone: float, state: np.ndarray) -> np.ndarray:
    twist, speed = state
    rubbing = float(model.friction(abs(speed))) * speed / max(abs(speed), zone)
    torque = model.stiffness * twist + model.damping * (drive - speed) - rubbing
    return np.array([drive - speed, torque / model.inertia])


def _runge_kutta(model: Oscillator, drive: float, zone: float, step: float, state: np.ndarray) -> np.ndarray:
    first = _rates(model, drive, zone, state)
    second = _rates(model, drive, zone, state + step / 2 * first)
    third = _rates(model, drive, zone, state + step / 2 * second)
    last = _rates(model, drive, zone, state + step * third)
    return np.asarray(state + step / 6 * (first + 2 * second + 2 * third + last))


def _trapezoid(model: Oscillator, drive: float, zone: float, step: float, state: np.ndarray) -> np.ndarray:
    """Newton's method on the speed at the end, with a difference for its slope."""
    begin = _rates(model, drive, zone, state)

    def left(speed: float) -> float:
        twist = state[0] + step * (drive - (state[1] + speed) / 2)
        end = _rates(model, drive, zone, np.array([twist, speed]))
        return speed - state[1] - step / 2 * float(begin[1] + end[1])

    speed = float(state[1])
    for _ in range(NEWTONS):
        value = left(speed)
        if abs(value) < 1e-10 * drive:
            break
        small = 1e-3 * zone
        speed -= value / ((left(speed + small) - value) / small)
    return np.array([state[0] + step * (drive - (state[1] + speed) / 2), speed])


NEWTONS = 25


# --- the limit of steady sliding ------------------------------------------------------------------------
NUDGED = 1e-3  # of the speed, by which steady sliding is disturbed
DECIDED = 30.0  # times that, at which it has grown; a tenth: decayed
MOST_PERIODS = 200  # natural periods for which it is followed


def sliding_limit(model: Oscillator, drive: float, tolerance: float = 0.01) -> float:
    """Return the largest damping at which a small disturbance of steady sliding at a speed [rad/s] grows
    [N m s/rad], by integration and bisection to a share of it; 0 where it never grows."""
    low, high = 0.0, 0.5 * np.sqrt(model.stiffness * model.inertia)
    if not _grows(replace(model, damping=0.0), drive):
        return 0.0
    while _grows(replace(model, damping=high), drive):
        low, high = high, 2 * high
    while high - low > tolerance * high:
        middle = (low + high) / 2
        low, high = (middle, high) if _grows(replace(model, damping=middle), drive) else (low, middle)
    return (low + high) / 2


def _grows(model: Oscillator, drive: float) -> bool:
    """Return whether a disturbed motion leaves steady sliding; undecided, whether its energy grew."""
    rest = (model.friction(drive)) / model.stiffness
    begin = [rest, drive * (1 - NUDGED)]

    def size(state: np.ndarray) -> float:
        twist = (state[0] - rest) * model.frequency
        return float(np.hypot(twist, state[1] - drive) / drive)

    def leaves(time: float, state: np.ndarray) -> float:
        return size(state) - DECIDED * NUDGED

    def settles(time: float, state: np.ndarray) -> float:
        return size(state) - 0.1 * NUDGED

    leaves.terminal = settles.terminal = True  # type: ignore[attr-defined]
    solved = solve_ivp(
        lambda time, state: _slipping(model, drive, state),
        (0.0, MOST_PERIODS * 2 * np.pi / model.frequency),
        begin,
        events=(leaves, settles),
        rtol=1e-7,
        atol=1e-9 * drive / model.frequency,
    )
    if solved.t_events[1].size:
        return False
    return bool(solved.t_events[0].size) or size(solved.y[:, -1]) > NUDGED
