"""What the rig prescribes: the motion of the pinion, of the rack or of the steering wheel over time.

Places and rates are angles [rad] of pinion or wheel, or displacements [m] of the rack, positive where the
rack moves along +X.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.gears.gear_pair import GearPair

DrivenBody = Literal["pinion", "rack", "wheel"]
OVERCOME = {"pinion": "pinion_torque", "rack": "rack_force", "wheel": "wheel_torque"}


def travel_per_radian(body: DrivenBody, gain: float) -> float:
    """Return a body's travel for one radian of the pinion [rad or m]; `gain` is the rack's [m]."""
    return gain if body == "rack" else 1.0


@dataclass(frozen=True)
class Drive(ABC):
    """A motion of one body."""

    body: DrivenBody

    @abstractmethod
    def place(self, time: np.ndarray | float) -> np.ndarray:
        """Return the place at given times [s], of their shape."""

    @abstractmethod
    def rate(self, time: np.ndarray | float) -> np.ndarray:
        """Return the place's time derivative at given times [s], of their shape."""

    @abstractmethod
    def acceleration(self, time: np.ndarray | float) -> np.ndarray:
        """Return the rate's time derivative at given times [s], of their shape."""

    @property
    def of_time(self) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """Place and rate of the driven coordinate as functions of an instant [s]."""
        sign = self.sign
        return (lambda t: sign * float(self.place(t))), (lambda t: sign * float(self.rate(t)))

    def shown(self, time: float) -> str:
        """Return the place at an instant [s] for a reader, for instance "123 deg"."""
        place = float(self.place(time))
        if self.body == "rack":
            return f"{1e3 * place:.4g} mm of rack travel"
        return f"{np.degrees(place):.4g} deg"

    @property
    def coordinate(self) -> int:
        """Number of the driven coordinate of pinion or rack, counted over the coordinate blocks."""
        return COORDINATE_BLOCKS[self.body].start

    @property
    def sign(self) -> int:
        """The coordinate over the place: those of pinion and wheel count against the steering angle."""
        return +1 if self.body == "rack" else -1

    @property
    def signal(self) -> str:
        """Name of the torque or force that the drive overcomes."""
        return OVERCOME[self.body]

    def driven(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the driven coordinate and its rate at times [s], of their shape."""
        return self.sign * self.place(time), self.sign * self.rate(time)

    def overcome(self, forces: np.ndarray) -> np.ndarray:
        """Return the torque or force (n,) that the drive overcomes, from the generalised forces (n, .)."""
        return np.asarray(-self.sign * forces[:, self.coordinate])

    def pinion_motion(self, pair: GearPair, time: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Return the pinion's angle [rad], up to elasticity, and its speed at times [s], of their shape."""
        angle, speed = self.place(time), self.rate(time)
        if self.body == "rack":
            angle = np.asarray(pair.angle_at(angle))
            speed = speed / pair.gain_at(angle)
        return angle, speed


@dataclass(frozen=True)
class Steady(Drive):
    """A motion at constant rate; at rate zero the body is held."""

    start: float
    speed: float

    def place(self, time: np.ndarray | float) -> np.ndarray:
        return self.start + self.speed * np.asarray(time)

    def rate(self, time: np.ndarray | float) -> np.ndarray:
        return np.full_like(np.asarray(time, dtype=float), self.speed)

    @property
    def of_time(self) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """Place and rate of the driven coordinate as functions of an instant [s], of plain numbers."""
        start, speed = self.sign * float(self.start), self.sign * float(self.speed)
        return (lambda t: start + speed * t), (lambda t: speed)

    def acceleration(self, time: np.ndarray | float) -> np.ndarray:
        return np.zeros_like(np.asarray(time, dtype=float))


@dataclass(frozen=True)
class SetOff(Steady):
    """A motion at constant rate that sets off from rest: all that follows the driven body rests at first."""


@dataclass(frozen=True)
class Swing(Drive):
    """A sinusoidal motion about a place, which it passes at time 0 at its largest rate."""

    middle: float
    amplitude: float
    speed: float  # largest, in the sense of the first quarter

    @property
    def period(self) -> float:
        """Duration of a full cycle [s]."""
        return 2 * np.pi * self.amplitude / abs(self.speed)

    def place(self, time: np.ndarray | float) -> np.ndarray:
        phase = abs(self.speed) / self.amplitude * np.asarray(time)
        return self.middle + np.sign(self.speed) * self.amplitude * np.sin(phase)

    def rate(self, time: np.ndarray | float) -> np.ndarray:
        return self.speed * np.cos(abs(self.speed) / self.amplitude * np.asarray(time))

    def acceleration(self, time: np.ndarray | float) -> np.ndarray:
        omega = abs(self.speed) / self.amplitude
        return -(omega**2) * (self.place(time) - self.middle)
