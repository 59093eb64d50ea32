"""Equilibria of the gear behind a column whose upper end carries a given torque, against the tyres.

The pinion stands where the gear's torque is what the column passes on; the tyres' force counts among the
forces applied to the rack. Inertia is left out.
"""

from dataclasses import dataclass, field
from typing import ClassVar, cast

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.column_path import CLOSE, WIDEST, March, root, settled_behind
from rps_exudyn.solvers.equilibrium import EquilibriumPath
from rps_exudyn.solvers.gear_kernel import COORDINATE_BLOCKS
from rps_exudyn.solvers.steering_column import BehindColumn, SteeringColumn
from rps_exudyn.solvers.wheel_torque import WheelTorque

RACK = COORDINATE_BLOCKS["rack"].start
TRIALS, SAME = 50, 1e-14  # of the wheel's angle behind a joint, and how close they come [rad]


def path_under_torque(
    balance: Balance, pair: GearPair, drive: WheelTorque, column: SteeringColumn, time: np.ndarray
) -> EquilibriumPath:
    """Follow the equilibria at times [s], the first of which is 0, under a torque on the wheel.

    Raises:
        PathInterrupted: Ctrl-C; it carries the path until then.
        LinAlgError: the gear yields without resistance.
    """
    start = settled_behind(balance, pair, drive, column, None)
    if not start.converged:
        return start
    march = TorqueMarch.begun(balance, pair, BehindColumn("pinion", drive, column), start, time)
    march.angle = np.full(len(time), drive.start)
    march.gain = float(pair.gain)
    return march.followed(start)


@dataclass(eq=False)
class TorqueMarch(March):
    """Instants found so far; the wheel's angles beside those of `March`."""

    FILLED: ClassVar[tuple[str, ...]] = (*March.FILLED, "angle")

    angle: np.ndarray = field(default_factory=lambda: np.zeros(0))  # of the wheel [rad]
    gain: float = 0.0  # of the gear [m]

    @property
    def drive(self) -> WheelTorque:
        """The torque on the wheel."""
        return cast(WheelTorque, self.ahead.wheel)

    def torque(self, k: int, place: float) -> float:
        """Return the gear's torque with the pinion at a place [rad] at instant k [N m]; nan without an
        equilibrium.

        The tyres act where the rack follows the pinion at the gear's gain from the instant before: what it
        yields within a step moves them by less than a millionth.
        """
        turned = place - self.ahead.sign * self.coordinates[k - 1, self.ahead.coordinate]
        self.applied[k, RACK] = self.drive.tyre.force(self.coordinates[k - 1, RACK] + self.gain * turned)
        return super().torque(k, place)

    def find(self, k: int) -> bool:
        """Fill the row of instant k; false where there is no equilibrium near that before."""
        driven, sign, step = self.ahead.coordinate, self.ahead.sign, self.time[k] - self.time[k - 1]
        before = float(sign * self.coordinates[k - 1, driven])
        hand, angle = float(self.drive.torque(self.time[k])), float(self.angle[k - 1])
        twisted = angle, float(self.ahead.column.output(angle)) - before

        def surplus(place: float) -> float:
            self.angle[k], passed_on = upper_end(self.ahead.column, hand, place, twisted, step)
            torque = self.torque(k, place)
            self.largest = max(self.largest, abs(torque)) if np.isfinite(torque) else self.largest
            return torque - passed_on

        guess = before + float(sign * self.rates[k - 1, driven]) * step
        restoring = self.drive.tyre.stiffness * self.gain**2
        reach = WIDEST * (self.largest + abs(self.drive.peak)) / restoring
        slope = max(self.slope, restoring)
        place, self.slope = root(surplus, guess, slope, reach, lambda: CLOSE * self.largest)
        return bool(np.isfinite(place))


def wheel_angles(
    drive: WheelTorque, column: SteeringColumn, time: np.ndarray, places: np.ndarray
) -> np.ndarray:
    """Return the wheel's angles (n,) [rad] at times [s], the pinion at places (n,) [rad]."""
    angles = np.full(time.size, drive.start)
    for k in range(1, time.size):
        hand, step = float(drive.torque(time[k])), float(time[k] - time[k - 1])
        before = float(angles[k - 1]), float(column.output(angles[k - 1]) - places[k - 1])
        angles[k], _ = upper_end(column, hand, float(places[k]), before, step)
    return angles


def upper_end(
    column: SteeringColumn, hand: float, place: float, before: tuple[float, float], step: float
) -> tuple[float, float]:
    """Return the wheel's angle [rad] and the torque on the pinion [N m], the pinion at a place [rad].

    The hand's torque [N m] acts on the wheel; `before` are its angle and the twist a step [s] ago.
    """
    (angle, twisted), damped = before, column.damping / step
    for _ in range(TRIALS):
        ratio = float(column.ratio(angle))
        twist = (hand / ratio + damped * twisted) / (column.stiffness + damped)
        move = (float(column.output(angle)) - place - twist) / ratio
        angle -= move
        if abs(move) < SAME:
            break
    return angle, hand / float(column.ratio(angle))
