"""External forces on the rack: a load at its end, its weight, a pulse."""

from dataclasses import dataclass
from math import pi, sin
from typing import NamedTuple, Protocol

import numpy as np

from rps_exudyn.base.compiled import borrowing, kernel
from rps_exudyn.forces.force_element import ForceElement
from rps_exudyn.forces.rigid_motion import cross, dot, on_angles, plus, scaled, spin_of, turn_of, vector

STILL = (0.0, 0.0, 0.0)


class DeadForceData(NamedTuple):
    """A force that keeps its size and direction, on a point of the bar's axis."""

    force: tuple[float, float, float]  # in the housing [N]
    place: float  # along the bar's axis from the rack's reference point [m]


NO_FORCE = DeadForceData(STILL, 0.0)


@borrowing
def add_dead_force(total, q, data):  # type: ignore[no-untyped-def]
    """Add the force to the rack's generalised forces."""
    turn = turn_of(q[3:6])
    moment = on_angles(turn, cross(scaled(data.place, turn.axis), data.force))
    for i in range(3):
        total[i] += data.force[i]
        total[3 + i] += moment[i]


@kernel
def dead_force(q, v, data):  # type: ignore[no-untyped-def]
    """A constant force and its potential; q = rack (6)."""
    out = np.zeros(6 + 3 + 1)
    add_dead_force(out, q, data)
    out[6] = -dot(data.force, plus(vector(q), scaled(data.place, turn_of(q[3:6]).axis)))
    out[9] = -data.force[0]
    return out


def end_load(load: float, across: tuple[float, float], place: float) -> ForceElement:
    """A load [N] that pulls the bar's end at `place` [m] towards -X, and a force (along Y, Z) [N] across."""
    data = DeadForceData((-load, *across), place)
    return ForceElement("load", ("rack",), dead_force, data, ("load_force",))


def weight(mass: float, gravity: float, place: float) -> ForceElement:
    """The weight of the rack, its mass centre at `place` [m], under `gravity` along -Y [m/s^2]."""
    data = DeadForceData((0.0, -mass * gravity, 0.0), place)
    return ForceElement("weight", ("rack",), dead_force, data, ("weight_force",))


class TimedForce(Protocol):
    """A force over time on a point of the bar's axis, along one direction."""

    @property
    def peak(self) -> tuple[float, float, float]:
        """Largest force, in the housing [N]."""

    @property
    def place(self) -> float:
        """Along the bar's axis from the rack's reference point [m]."""

    def force(self, time: float) -> np.ndarray:
        """Force at a time [s], shape (3,), in the housing [N]."""

    def share(self, time: float) -> float:
        """Return the force at a time over its peak."""


@dataclass(frozen=True)
class Pulse:
    """Half sines of force on a point of the bar's axis, one per period."""

    peak: tuple[float, float, float]  # in the housing [N]
    place: float  # along the bar's axis from the rack's reference point [m]
    duration: float  # of a half sine [s]
    period: float  # from pulse to pulse [s]
    count: int

    def force(self, time: float) -> np.ndarray:
        """Force at a time from the first pulse on [s], shape (3,) [N]."""
        return np.multiply(self.share(time), self.peak)

    def share(self, time: float) -> float:
        """Return the force at a time over its peak."""
        number, since = divmod(time, self.period)
        if time < 0 or number >= self.count or since >= self.duration:
            return 0.0
        return sin(pi * since / self.duration)


@dataclass(frozen=True)
class RoadForce:
    """A force of the road along a tie rod, on a point of the bar's axis: a sine, or its positive halves."""

    peak: tuple[float, float, float]  # in the housing [N]
    place: float  # along the bar's axis from the rack's reference point [m]
    frequency: float  # [Hz]
    phase: float  # at time 0 [rad]
    halves: bool  # only the positive halves

    def force(self, time: float) -> np.ndarray:
        """Force at a time [s], shape (3,) [N]."""
        return np.multiply(self.share(time), self.peak)

    def share(self, time: float) -> float:
        """Return the force at a time over its peak."""
        wave = sin(2 * pi * self.frequency * time + self.phase)
        return max(wave, 0.0) if self.halves else wave


def axis_velocity(q: np.ndarray, v: np.ndarray, place: float) -> np.ndarray:
    """Velocity of a point of the bar's axis, from the rack's coordinates and rates (6,); shape (3,) [m/s]."""
    turn = turn_of(q[3:6])
    return v[:3] + np.cross(spin_of(turn, v[3:6]), scaled(place, turn.axis))
