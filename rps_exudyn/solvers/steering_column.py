"""The steering column: from the wheel through a universal joint and a torsion bar to the pinion.

Angles are in the sense of the pinion angle. With the wheel at theta, the joint's output at u(theta) and the
pinion at phi,

    twist x = u(theta) - phi,        torque on the pinion T = k x + c x',        torque at the wheel u' T.

A universal joint with the bend beta turns its output by tan u = tan theta / cos beta, theta counted from
where the wheel-side yoke's axis lies in the bend's plane.

The housing's mounts stand in series: what turns the pinion by T pushes the rack by T / g and the housing back
by T / (g k_m), which is a twist of T / (g^2 k_m). The rack's load, the gear's own friction among it, counts
as held by the vehicle.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.prescribed_motion import Drive, SetOff, Steady

Angle = np.ndarray | float


@dataclass(frozen=True)
class ColumnModel:
    """Inertia, joint and spring between hand and pinion; the housing's mounts yield with it."""

    inertia: float  # of the wheel [kg m^2]
    stiffness: float  # [N m/rad]
    damping: float  # [N m s/rad]
    bend: float  # of the joint [rad]
    phase: float  # of its wheel-side yoke at wheel angle 0 [rad]
    own_share: float = 1.0  # of the twist that is the column's; the rest is that of the mounts
    gain: float = 0.0  # of the gear: the housing's way along X over the mounts' twist [m/rad]

    @classmethod
    def of(cls, gear: SteeringGear) -> "ColumnModel":
        """Return the column of a gear in series with its housing's mounts, damped as in slow motion."""
        given, gain = gear.column, float(GearPair.of(gear).gain)
        mounts = gear.housing.mount_stiffness * gain**2
        share = mounts / (given.stiffness + mounts) if mounts else 1.0
        stiffness, damping = given.stiffness * share, given.damping * share**2
        return cls(given.wheel_inertia, stiffness, damping, given.joint_angle, given.joint_phase, share, gain)

    def output(self, angle: Angle) -> np.ndarray:
        """Return the angle u behind the joint [rad], 0 at wheel angle 0, of the shape of the angles."""
        return np.asarray(angle + self._lead(angle + self.phase) - self._lead(self.phase))

    def ratio(self, angle: Angle) -> np.ndarray:
        """Return du/dtheta, of the shape of the angles [rad]: cos beta / (1 - sin^2 beta cos^2 theta)."""
        yoke = np.asarray(angle) + self.phase
        return np.asarray(np.cos(self.bend) / (1 - (np.sin(self.bend) * np.cos(yoke)) ** 2))

    def ratio_slope(self, angle: Angle) -> np.ndarray:
        """Return d^2u/dtheta^2, of the shape of the angles [1/rad]."""
        yoke, bent = np.asarray(angle) + self.phase, np.sin(self.bend) ** 2
        return np.asarray(-np.cos(self.bend) * bent * np.sin(2 * yoke) / (1 - bent * np.cos(yoke) ** 2) ** 2)

    def torque(self, twist: Angle, rate: Angle) -> np.ndarray:
        """Return the torque on the pinion [N m] of a twist [rad] and its rate [rad/s]."""
        return np.asarray(self.stiffness * twist + self.damping * rate)

    def twisted(
        self, wheel: Sequence[Angle] | np.ndarray, coordinate: Angle, speed: Angle
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the joint's ratio, and the twist [rad] and its rate [rad/s] between a wheel, of angle and
        rate, and a pinion, of coordinate and speed, which count against its angle."""
        angle, rate = wheel
        ratio = self.ratio(angle)
        return ratio, self.output(angle) + coordinate, ratio * rate + speed

    def _lead(self, yoke: Angle) -> np.ndarray:
        """Angle by which the joint's output leads its input."""
        sine, cosine = np.sin(yoke), np.cos(yoke)
        return np.asarray(
            np.arctan(sine * cosine * (1 - np.cos(self.bend)) / (np.cos(self.bend) * cosine**2 + sine**2))
        )


@dataclass(frozen=True)
class BehindColumn(Drive):
    """The pinion's motion behind a column of constant twist: u(theta) - twist."""

    wheel: Drive
    column: ColumnModel
    twist: float = 0.0  # [rad]

    def place(self, time: np.ndarray | float) -> np.ndarray:
        return self.column.output(self.wheel.place(time)) - self.twist

    def rate(self, time: np.ndarray | float) -> np.ndarray:
        return self.column.ratio(self.wheel.place(time)) * self.wheel.rate(time)

    def acceleration(self, time: np.ndarray | float) -> np.ndarray:
        angle, rate = self.wheel.place(time), self.wheel.rate(time)
        return (
            self.column.ratio(angle) * self.wheel.acceleration(time)
            + self.column.ratio_slope(angle) * rate**2
        )


def pinion_at_start(wheel: Drive, column: ColumnModel, twist: float) -> Drive:
    """Return the pinion's motion at the start of the wheel's: behind a twist [rad], or at rest."""
    if isinstance(wheel, SetOff):
        return Steady("pinion", float(column.output(wheel.start)) - twist, 0.0)
    return BehindColumn("pinion", wheel, column, twist)


# --- A torque of the hand on the steering wheel, and the tyres' spring at the rack that restores it

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
        return np.full_like(np.asarray(time, dtype=float), self.start)

    def rate(self, time: Places) -> np.ndarray:
        return np.zeros_like(np.asarray(time, dtype=float))

    def acceleration(self, time: Places) -> np.ndarray:
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
        return np.asarray(self.growth * np.asarray(time))
