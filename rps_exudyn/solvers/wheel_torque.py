"""A torque of the hand on the steering wheel, and the tyres' spring at the rack that restores it."""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.solvers.drive import Drive

Places = np.ndarray | float


@dataclass(frozen=True)
class TyreSpring:
    """A linear spring between the rack and the ground, along the rack's travel."""

    stiffness: float  # [N/m]
    relaxed: float  # place of the rack at which it carries nothing [m]

    def force(self, place: Places) -> np.ndarray:
        """Return the force on the rack along +X at its places [m], of their shape [N]."""
        return np.asarray(-self.stiffness * (place - self.relaxed))

    def energy(self, place: Places) -> np.ndarray:
        """Return the elastic energy at places of the rack [m], of their shape [J]."""
        return np.asarray(0.5 * self.stiffness * (place - self.relaxed) ** 2)


@dataclass(frozen=True)
class WheelTorque(Drive):
    """A sinusoidal torque on the wheel, which turns as it likes; its place is that where it starts."""

    start: float  # of the wheel [rad]
    peak: float  # in the sense of the first quarter [N m]
    period: float  # [s]
    tyre: TyreSpring

    def torque(self, time: Places) -> np.ndarray:
        """Return peak sin(omega t), of the shape of the times [s]."""
        return np.asarray(self.peak * np.sin(2 * np.pi / self.period * np.asarray(time)))

    def place(self, time: Places) -> np.ndarray:
        """Return the wheel's angle at the start [rad]."""
        return np.full_like(np.asarray(time, dtype=float), self.start)

    def rate(self, time: Places) -> np.ndarray:
        """Return zeros: the wheel rests at the start."""
        return np.zeros_like(np.asarray(time, dtype=float))

    def acceleration(self, time: Places) -> np.ndarray:
        """Return zeros."""
        return self.rate(time)

    def shown(self, time: float) -> str:
        """Return the torque at an instant [s] for a reader, for instance "1.2 N m at the wheel"."""
        return f"{float(self.torque(time)):.4g} N m at the wheel"


@dataclass(frozen=True)
class GrowingTorque(WheelTorque):
    """A torque on the wheel that grows at a constant rate, to its peak in a quarter of the period."""

    @property
    def growth(self) -> float:
        """Return the rate, in the sense of the peak [N m/s]."""
        return 4 * self.peak / self.period

    def torque(self, time: Places) -> np.ndarray:
        """Return growth t, of the shape of the times [s]."""
        return np.asarray(self.growth * np.asarray(time))
