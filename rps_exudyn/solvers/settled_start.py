"""The settled start: equilibria before the start of a motion, until where they began has no effect.

Friction lets go of what the gear came with only as it slides: over a part of a tooth pitch where seat and
bush are stiff, over ten pitches or some cycles of steering where they are soft. So the motion begins further
and further back until two beginnings in a row lead to the same start: the same force of the drive, and the
same place in every coordinate.
"""

from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS, Balance
from rps_exudyn.solvers.equilibrium import EquilibriumPath, Start, equilibrium_path
from rps_exudyn.solvers.prescribed_motion import Drive
from rps_exudyn.solvers.steering_column import ColumnModel, pinion_at_start

DISTANCES = (1, 2, 4, 8, 16, 32)  # tooth pitches before the start at which equilibria begin
COARSE, FINE = 12, 48  # equilibria in a tooth pitch
LAST, FINEST = 1 / 4, 120  # of a pitch before the start, in steps of the motion; at most so many in a pitch
FINE_FROM, FINE_PITCHES = 4, 3  # beginnings this far back come in fine steps over the last pitches
ALIKE = 5e-4  # of the force and of a pitch's travel: how far two coarse beginnings may differ ...
ALIKE_FINE = 2e-3  # ... and two of which one is twice as far back: what is left is less than that
ROLLING = 0.02  # of the rack's travel: a rack that rolls more needs fine steps
MOST_LOST = 4  # beginnings from which no equilibria lead to the start, until no more are tried
HALF_CYCLES = (1, 2, 4, 8, 16)  # before the start of a swing at which equilibria begin
SHORT = 1e-3  # of a pitch: last steps before motion with inertia, for the rates there ...
SHARE = 1 / 16  # ... and of its own steps: over shorter ones what an equilibrium is off by would be a rate
TWISTS = 3  # times that the start is found behind a column: the torque hardly changes with its twist
ODD_PARTS = (0.0, 0.3, 0.6)  # of a pitch further back, where no rest is found at the phase of the start


@dataclass(frozen=True)
class SteadyApproach:
    """Steady motion before its start, in tooth pitches, for as long as it takes to settle.

    Attributes:
        unit: time in which distances before the start are counted, here that of a tooth pitch [s].
        toothed: time for which the rack has teeth before the start [s].
        step: of the motion [s]: rates are half a step late, so that the last steps are as long.
        distances: before the start at which equilibria begin, one after the other, in units.
    """

    unit: float
    toothed: float
    step: float = 0.0
    distances = DISTANCES

    def instants(self, distance: float) -> np.ndarray:
        """Return the instants, below 0 [s], of a beginning so far back; the last of a far one are fine."""
        fine = min(distance, FINE_PITCHES) if distance >= FINE_FROM else 0.0
        far = np.linspace(-distance, -fine, max(round(COARSE * (distance - fine)), 1), endpoint=False)
        near = np.linspace(-fine, 0.0, round(FINE * fine), endpoint=False)
        instants = self.unit * np.concatenate([far, near])
        if not self.step:
            return instants
        step = max(self.step, self.unit / FINEST)
        last = -step * np.arange(np.ceil(LAST * self.unit / step), 0, -1)
        return np.concatenate([instants[instants < last[0] - self.unit / FINE], last])

    def allowed(self, distance: float, rolling: float) -> float:
        """Return how far two beginnings that agree may differ, of the force and of a pitch's travel.

        The later began so far before the start; a rack that rolls, by `rolling` of its travel, needs fine
        steps.
        """
        if distance > FINE_FROM:
            return ALIKE_FINE
        return ALIKE if rolling <= ROLLING else 0.0


@dataclass(frozen=True)
class SwingApproach:
    """Motion to and fro, in half cycles; a beginning lies where the motion is fastest."""

    unit: float  # half a cycle [s]
    per_half_cycle: int  # equilibria
    distances = HALF_CYCLES
    toothed = np.inf

    def instants(self, distance: float) -> np.ndarray:
        return np.linspace(-distance * self.unit, 0.0, round(self.per_half_cycle * distance), endpoint=False)

    def allowed(self, distance: float, rolling: float) -> float:
        return ALIKE  # a rack that turns about rolls


Approach = SteadyApproach | SwingApproach


def settled_path(
    balance: Balance, pair: GearPair, drive: Drive, approach: Approach | None, time: np.ndarray
) -> EquilibriumPath:
    """Follow the equilibria at times [s], the first of which is 0 or just before, from a settled start.

    `start` of the path states what is left of its beginning, and whether the rack has teeth enough before the
    start to settle. If no equilibria lead to the start, the gear starts where it rests without them, which
    may be far from where it will slide. Without an approach the start itself is such a place of rest.
    """
    approach_path = settled_start(balance, pair, drive, approach, time[:1])
    path = equilibrium_path(balance, pair, drive, joined_instants(approach_path, time), approach_path)
    return path if approach_path is None else replace(path, start=approach_path.start)


def joined_instants(approach_path: EquilibriumPath | None, time: np.ndarray) -> np.ndarray:
    """Return the instants of a path, if there is one, and of what follows its last one [s]."""
    return time if approach_path is None else np.concatenate([approach_path.time, time[1:]])


def start_of_motion(
    balance: Balance, pair: GearPair, drive: Drive, approach: Approach | None, step: float
) -> EquilibriumPath:
    """Return the settled start at time 0 of a motion with inertia, the last instant of a path.

    `step` is the angle by which the pinion will turn in a time step at most [rad].

    Short steps lead steady motion there: rates by backward differences over longer ones are those of half a
    step earlier, and what they lack at a corner of the path the gear would vibrate with.
    """
    steady = isinstance(approach, SteadyApproach)
    last = max(SHORT, SHARE * step * pair.teeth / (2 * np.pi)) * np.arange(-4, 1)
    time = approach.unit * last if steady and approach is not None else np.zeros(1)
    return settled_path(balance, pair, drive, approach, time).last


def settled_start(
    balance: Balance, pair: GearPair, drive: Drive, approach: Approach | None, start: np.ndarray
) -> EquilibriumPath | None:
    """Return the equilibria that lead to the instant `start`, shape (1,) [s]; None where the gear rests."""
    return None if approach is None else _Search(balance, pair, drive, approach, start).settled()


def settled_behind(
    balance: Balance, pair: GearPair, wheel: Drive, column: ColumnModel, approach: Approach | None
) -> EquilibriumPath:
    """Return the equilibrium at the start of a motion of the wheel, the column twisted by its torque."""
    twist = 0.0
    for _ in range(TWISTS):
        followed = pinion_at_start(wheel, column, twist)
        start = settled_path(balance, pair, followed, approach, np.zeros(1)).last
        if not start.converged:
            break
        twist = float(followed.overcome(start.forces)[-1]) / column.stiffness
    return start


@dataclass(frozen=True, eq=False)
class _Search:
    """The search for a beginning that is far enough back."""

    balance: Balance
    pair: GearPair
    drive: Drive
    approach: Approach
    start: np.ndarray  # the time of the start alone [s]

    def settled(self) -> EquilibriumPath | None:
        """Return the path to the start from the nearest beginning with which the one before it agrees; or
        from the farthest that leads there; None if only the start itself does."""
        found: list[EquilibriumPath] = []
        lost, differ = 0, 0.0
        for distance in (0, *self.approach.distances):
            path = self.begun(distance)
            if path is not None and path.converged:
                found.append(path)
                if len(found) > 1:
                    differ = _difference(found[-2], path, self.drive)
                    if self.alike(found[-2], path, distance):
                        settled = self.with_teeth(path, distance)
                        left = replace(
                            settled.start, unsettled_behind=max(differ, settled.start.unsettled_behind)
                        )
                        return replace(settled, start=left)
            elif (lost := lost + 1) == MOST_LOST:
                break
        if len(found) < 2:
            return None
        if lost and len(found) == 2 and _rolling(found[-1]) <= ROLLING:  # only the start to compare it with
            return found[-1]
        return replace(found[-1], start=Start(differ, np.inf))

    def begun(self, distance: float) -> EquilibriumPath | None:
        """Return the path to the start from so far before it, or from a part of a unit more; None where the
        gear yields without resistance."""
        path = None
        for more in ODD_PARTS if distance else ODD_PARTS[:1]:
            instants = self.approach.instants(distance + more) if distance else np.zeros(0)
            before = instants < self.start - 1e-9 * self.approach.unit
            time = np.concatenate([instants[before], self.start])
            try:
                path = equilibrium_path(self.balance, self.pair, self.drive, time)
            except np.linalg.LinAlgError:
                continue
            if path.converged or path.lost_at != path.begun:
                break
        return path

    def with_teeth(self, path: EquilibriumPath, distance: float) -> EquilibriumPath:
        """Return a settled path with the difference to what the rack's teeth before the start allow."""
        needed, toothed = distance * self.approach.unit, self.approach.toothed
        if needed <= toothed * (1 + 1e-9):
            return path
        real = self.begun(toothed / self.approach.unit)
        unsettled = behind = 0.0
        if real is not None and real.converged:
            unsettled = _difference(path, real, self.drive)
            on, real_on = (self.gone_on(each) for each in (path, real))
            if on.converged and real_on.converged:
                behind = _apart(on.forces[-FINE:], real_on.forces[-FINE:], self.drive, FINE)
        return replace(path, start=Start(unsettled, needed, behind))

    def gone_on(self, path: EquilibriumPath) -> EquilibriumPath:
        """Return a path to the start for a unit of time more: the force may be the same at the start and not
        behind it, where the rack still lies otherwise."""
        time = self.start[0] + self.approach.unit * np.linspace(0, 1, FINE + 1)
        time = joined_instants(path, time)
        return equilibrium_path(self.balance, self.pair, self.drive, time, path)

    def alike(self, a: EquilibriumPath, b: EquilibriumPath, distance: float) -> bool:
        """Return whether two paths, b from so far back, end at the same place under the same force."""
        travel = self.pair.gain * 2 * np.pi / self.pair.teeth
        apart = np.abs((a.coordinates[-1] - b.coordinates[-1]) * self.balance.lengths).max() / travel
        differ = max(_difference(a, b, self.drive), float(apart))
        return differ <= self.approach.allowed(distance, _rolling(b))


def _difference(a: EquilibriumPath, b: EquilibriumPath, drive: Drive) -> float:
    """Difference of the drive's force at the ends of two paths, over its largest along them."""
    return _apart(a.forces, b.forces, drive, 1)


def _apart(a: np.ndarray, b: np.ndarray, drive: Drive, last: int) -> float:
    """Largest difference between the last instants of two rows of forces (n, .), over the drive's largest."""
    first, second = (forces[:, drive.coordinate] for forces in (a, b))
    largest = max(np.abs(first).max(), np.abs(second).max())
    return float(np.abs(first[-last:] - second[-last:]).max() / largest) if largest else 0.0


def _rolling(path: EquilibriumPath) -> float:
    """Roll of the bar's surface to and fro over the later half of a path, over its travel."""
    rack = path.coordinates[len(path.time) // 2 :, COORDINATE_BLOCKS["rack"]]
    lever = CHARACTERISTIC_LENGTHS[COORDINATE_BLOCKS["rack"]][3]
    return float(np.ptp(rack[:, 3]) * lever / np.ptp(rack[:, 0]))
