"""Time steps of a reduced gear that make no energy, whatever their length.

Over a step of length h the pinion turns by D = h (w_0 + theta (w_1 - w_0)), with the balance of mean torques

    J (w_1 - w_0) / h + (P(phi_1) - P(phi_0)) / D + friction + c D / h = torque,

P being the potential of table and load (Gonzalez, J. Nonlinear Sci. 6, 1996: the discrete gradient). Friction
of an element that slides on a part of the step is its work over D. So the work of the torque is what is
stored more plus what is lost, and no loss is negative; theta above a half damps what is faster than the step.
"""

from collections.abc import Callable
from dataclasses import dataclass

from rps_exudyn.solvers.reduced_gear import ReducedGear, Tables

THETA = 0.6
SAME = 1e-6  # turn over which the mean of a slope is that in the middle [rad]
PRECISE = 1e-10  # of the torques, that a step's balance leaves
MOST_TRIALS = 60
LOAD_STEPS = 30  # of Newton's method for the load at the rack
Conservative = tuple[float, float, float]


@dataclass(frozen=True)
class Push:
    """Torque on the pinion over a step: `torque` less `resistance` times its turn."""

    torque: float
    resistance: float = 0.0


@dataclass(frozen=True)
class RackEnd:
    """What holds the rack: a load towards -X, or a spring that carries nothing at `relaxed`."""

    load: float = 0.0  # [N]
    stiffness: float = 0.0  # of the spring [N/m]; 0 where there is none
    relaxed: float = 0.0  # [m]


class ReducedMotion:
    """A reduced gear in motion.

    Attributes:
        angle, speed: of the pinion [rad, rad/s].
        stretch: of the elements [rad].
        load: at the rack [N].
        lost: work lost to friction so far [J].
    """

    def __init__(self, gear: ReducedGear, end: RackEnd, angle: float, speed: float = 0.0) -> None:
        self.gear, self.end, self.tables = gear, end, Tables(gear)
        self.angle, self.speed, self.lost, self.load = angle, speed, 0.0, end.load
        self.share, self.stiffness = gear.shares.tolist(), gear.stiffness.tolist()
        self.stretch = [0.0] * len(self.share)
        self.damping, self.inertia, self.drag = gear.damping, gear.inertia, gear.drag
        self.speeds, self.factors = gear.speeds.tolist(), gear.speed_factor.tolist()
        self.load = self.conservative(angle)[2]

    # --- conservative part ------------------------------------------------------------------------
    def conservative(self, angle: float) -> Conservative:
        """Return the potential of gear and load [J], its slope [N m], and the load [N]."""
        load, end = self.load, self.end
        if not end.stiffness:
            energy, torque, _, _ = self.tables.potential(angle, end.load)
            return energy, torque, end.load
        for _ in range(LOAD_STEPS):
            energy, torque, travel, bend = self.tables.potential(angle, load)
            change = (travel - end.relaxed - load / end.stiffness) / (1 / end.stiffness - bend)
            load += change
            if abs(change) < 1e-9 * (1 + abs(load)):
                break
        energy, torque, _, _ = self.tables.potential(angle, load)
        return energy - load * end.relaxed - load**2 / (2 * end.stiffness), torque, load

    @property
    def travel(self) -> float:
        """Displacement of the rack [m]."""
        return self.tables.potential(self.angle, self.load)[2]

    @property
    def stored(self) -> float:
        """Energy of the gear [J]: kinetic, of the table and of the elements."""
        energy, _, travel, _ = self.tables.potential(self.angle, self.load)
        elastic = sum(k * x * x for k, x in zip(self.stiffness, self.stretch, strict=True)) / 2
        return energy - self.load * travel + elastic + self.inertia * self.speed**2 / 2

    @property
    def torque(self) -> float:
        """Torque of the table, the elements and the drag, without inertia [N m]."""
        held = sum(k * x for k, x in zip(self.stiffness, self.stretch, strict=True))
        return self.conservative(self.angle)[1] + held + self.drag * self.speed

    # --- friction ---------------------------------------------------------------------------------
    def limits(self, angle: float, speed: float) -> list[tuple[float, float]]:
        """Return the stretch at which each element slides, either way [rad]."""
        factor = interpolated(abs(speed), self.speeds, self.factors)
        up, down = self.tables.limits(angle, self.load)
        return [
            (factor * s * up / k, factor * s * down / k)
            for s, k in zip(self.share, self.stiffness, strict=True)
        ]

    def relax(self, limits: list[tuple[float, float]]) -> None:
        """Let go what the elements hold beyond their limits."""
        for i, (up, down) in enumerate(limits):
            held = min(max(self.stretch[i], -down), up)
            self.lost += self.stiffness[i] * (self.stretch[i] ** 2 - held**2) / 2
            self.stretch[i] = held

    def resisting(self, turn: float, damped: float, limits: list[tuple[float, float]]) -> tuple[float, float]:
        """Return the mean torque of the elements over a turn [N m], and its slope [N m/rad]; `damped` is
        their damping over the time of the step."""
        torque = slope = 0.0
        for k, x, (up, down) in zip(self.stiffness, self.stretch, limits, strict=True):
            end = x + turn
            if -down <= end <= up:
                torque += k * (x + turn / 2 + damped * turn)
                slope += k * (0.5 + damped)
                continue
            limit = k * (up if end > up else -down)
            yielded = limit / k - x
            mean = (k * yielded * (x + yielded / 2) + limit * (turn - yielded)) / turn
            torque += mean + k * damped * yielded
            slope += (limit - mean) / turn
        return torque, slope

    def slide(self, turn: float, damped: float, limits: list[tuple[float, float]]) -> None:
        """Turn the elements."""
        for i, (up, down) in enumerate(limits):
            k, x = self.stiffness[i], self.stretch[i]
            held = min(max(x + turn, -down), up)
            slid = x + turn - held
            self.lost += k * (held * slid if slid else 0.0) + k * damped * (held - x) * turn
            self.stretch[i] = held

    # --- steps ------------------------------------------------------------------------------------
    def follow(self, turn: float, speed: float, h: float) -> None:
        """Turn the pinion as prescribed."""
        self.load = self.conservative(self.angle + turn)[2]
        limits = self.limits(self.angle + turn, speed)
        self.relax(limits)
        self.slide(turn, 0.0, limits)
        self.lost += self.drag * turn**2 / h
        self.angle, self.speed = self.angle + turn, speed

    def push(self, push: Push, h: float) -> float:
        """Turn the pinion by a torque over a step; return its turn [rad]."""
        before, _slope_before, self.load = self.conservative(self.angle)
        limits = self.limits(self.angle + h * self.speed, self.speed)
        self.relax(limits)
        mass, damped = self.inertia / (THETA * h), self.damping / h
        straight = mass / h + self.drag / h + push.resistance

        def left(turn: float) -> tuple[float, float, float]:
            held, slope = self.resisting(turn, damped, limits)
            if abs(turn) < SAME:
                mean = self.conservative(self.angle + turn / 2)[1]
            else:
                mean = (self.conservative(self.angle + turn)[0] - before) / turn
            inert = straight * turn - mass * self.speed
            size = abs(held) + abs(mean) + abs(push.torque) + abs(mass * self.speed)
            return inert + mean + held - push.torque, straight + slope, size

        turn = root(left, h * self.speed)
        self.slide(turn, damped, limits)
        self.lost += self.drag * turn**2 / h
        change = (turn / h - self.speed) / THETA
        self.lost += (THETA - 0.5) * self.inertia * change**2
        self.angle, self.speed = self.angle + turn, self.speed + change
        self.load = self.conservative(self.angle)[2]
        return turn


def root(left: Callable[[float], tuple[float, float, float]], guess: float) -> float:
    """Return where what is left of a balance is none; it rises but for the table's ripple.

    Newton's method within the bracket found so far; its middle, where that leads out of it or does not halve
    what is left.
    """
    low, high, x, last = -float("inf"), float("inf"), guess, float("inf")
    for _ in range(MOST_TRIALS):
        value, slope, size = left(x)
        if abs(value) <= PRECISE * size:
            break
        low, high = (x, high) if value < 0 else (low, x)
        x -= value / slope
        if not low < x < high or (abs(value) > last / 2 and high - low < float("inf")):
            x = (low + high) / 2
        last = abs(value)
        if high - low < 1e-15 * (1 + abs(x)):
            break
    return x


def interpolated(x: float, places: list[float], values: list[float]) -> float:
    """Return a value on straight lines between rising places, the last one beyond them."""
    for i in range(1, len(places)):
        if x < places[i]:
            part = (x - places[i - 1]) / (places[i] - places[i - 1])
            return values[i - 1] + part * (values[i] - values[i - 1])
    return values[-1]
