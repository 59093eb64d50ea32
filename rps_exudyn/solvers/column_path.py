"""Equilibria of the gear behind a steering column: a spring in series, whose one end the wheel moves.

At each instant the pinion stands where the gear's torque, friction and all, is what the column's twist
gives. The gear's equilibria are followed from there as along any motion of the pinion (`path_follower`); its
place is the root of one function of one number, bracketed, because friction that sets in is steep.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Self

import numpy as np

from rps_exudyn.base.progress import reached
from rps_exudyn.forces.memory import begin_step
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.drive import Drive
from rps_exudyn.solvers.equilibrium import EquilibriumPath, PathInterrupted, inertia_forces
from rps_exudyn.solvers.path_follower import backward_difference, follower
from rps_exudyn.solvers.rescue import JUMP, search
from rps_exudyn.solvers.settled_start import Approach, settled_path
from rps_exudyn.solvers.steering_column import BehindColumn, SteeringColumn, pinion_at_start

CLOSE = 1e-4  # of the largest torque so far: how far the column's may be from the gear's ...
LEAST_TORQUE = 1e-3  # ... or that of a gear that takes none [N m]
TRIALS = 60  # of the pinion's place at an instant
WIDEST = 10.0  # steps of the column's upper end, as far as the pinion's place is looked for
STALLED = 9  # trials after which every third halves the bracket: about a corner secants shorten one side only
RETRIES, NEARER = 6, 0.8  # where the gear finds no equilibrium, and how much of a move is left each time
TWISTS = 3  # times that the start is found behind a column: the torque hardly changes with its twist
MOST_SEARCHES = 200  # of equilibria that Newton's method does not find, over a path
PARTS = 256  # of the shortest step, down to which one without an equilibrium is halved
STUCK = 0.1  # of what the column's end moves: a pinion that moves less is held by friction
MOST_PLACES = 1e-15  # of a bracket [rad]: a torque that jumps is not found any closer


def settled_behind(
    balance: Balance, pair: GearPair, wheel: Drive, column: SteeringColumn, approach: Approach | None
) -> EquilibriumPath:
    """Return the equilibrium at the start of a motion of the wheel, the column twisted by its torque.

    Raises:
        LinAlgError: the gear yields without resistance.
    """
    twist = 0.0
    for _ in range(TWISTS):
        followed = pinion_at_start(wheel, column, twist)
        start = settled_path(balance, pair, followed, approach, np.zeros(1)).last
        if not start.converged:
            break
        twist = -followed.sign * float(start.forces[-1, followed.coordinate]) / column.stiffness
    return start


def path_behind_column(
    balance: Balance,
    pair: GearPair,
    wheel: Drive,
    column: SteeringColumn,
    approach: Approach | None,
    time: np.ndarray,
) -> EquilibriumPath:
    """Follow the equilibria at times [s], the first of which is 0, of a motion of the wheel.

    Raises:
        PathInterrupted: Ctrl-C; it carries the path until then.
        LinAlgError: the gear yields without resistance.
    """
    start = settled_behind(balance, pair, wheel, column, approach)
    if not start.converged:
        return start
    return March.begun(balance, pair, BehindColumn("pinion", wheel, column), start, time).followed(start)


@dataclass(eq=False)
class March:
    """Instants found so far; arrays have one row per instant, as those of `path_follower`."""

    FILLED: ClassVar[tuple[str, ...]] = ("coordinates", "rates", "forces", "kept")
    """Arrays whose rows `find` fills, as `divided` must insert them."""

    balance: Balance
    ahead: BehindColumn  # the column's upper end
    time: np.ndarray
    free: np.ndarray
    coordinates: np.ndarray
    rates: np.ndarray
    forces: np.ndarray
    applied: np.ndarray
    kept: np.ndarray
    counts: np.ndarray  # evaluations, iterations, tangents
    largest: float = LEAST_TORQUE  # torque so far [N m]
    slope: float = 0.0  # of the gear's torque less the column's, where it was found last [N m/rad]
    residual: float = 0.0  # [N]
    searches: int = 0
    searching: bool = True  # at each place where Newton's method finds no equilibrium

    @classmethod
    def begun(
        cls, balance: Balance, pair: GearPair, ahead: BehindColumn, start: EquilibriumPath, time: np.ndarray
    ) -> Self:
        """The first row where the gear has settled."""
        free = balance.free(ahead.coordinate)
        coordinates, rates, forces = (np.zeros((len(time), balance.size)) for _ in range(3))
        kept = np.zeros((len(time), *balance.memory.shape))
        for rows, first in ((coordinates, start.coordinates), (rates, start.rates), (forces, start.forces)):
            rows[0] = first[-1]
        kept[0] = start.kept[-1] if start.kept.size else kept[0]
        applied = inertia_forces(balance, pair, ahead, time)
        counts = np.array([start.evaluations, start.iterations, start.tangents])
        return cls(balance, ahead, time, free, coordinates, rates, forces, applied, kept, counts)

    def followed(self, start: EquilibriumPath) -> EquilibriumPath:
        """Return the path, found instant by instant until there is no equilibrium.

        Raises:
            PathInterrupted: Ctrl-C; it carries the path until then.
        """
        found, end = 1, self.time[-1]
        shortest = float(np.diff(self.time).min(initial=np.inf)) / PARTS
        try:
            while found < len(self.time):
                if self.find(found):
                    reached(self.time[found] / end, partial(self.ahead.wheel.shown, self.time[found]))
                    found += 1
                elif not self.divided(found, shortest):
                    break
        except KeyboardInterrupt:
            raise PathInterrupted(self.path(start, found)) from None
        return self.path(start, found)

    def torque(self, k: int, place: float) -> float:
        """Return the gear's torque with the pinion at a place [rad] at instant k [N m]; nan without an
        equilibrium."""
        driven, sign = self.ahead.coordinate, self.ahead.sign
        self.coordinates[k, driven] = sign * place
        self.rates[k, driven] = self.rate(k, sign * place)
        found, *counts, self.residual = follower(self.balance.force)(
            k,
            self.time[: k + 1],
            driven,
            self.free,
            self.balance.lengths,
            self.coordinates,
            self.rates,
            self.forces,
            self.applied,
            self.kept,
            self.balance.memory,
            self.balance.data,
        )
        self.counts += counts
        return float(-sign * self.forces[k, driven]) if found > k or self.searched(k) else np.nan

    def searched(self, k: int) -> bool:
        """Look further for the equilibrium at instant k that Newton's method did not find."""
        if not self.searching or self.searches == MOST_SEARCHES:
            return False
        self.searches += 1
        begin_step(self.balance.memory, self.kept[k - 1, 1], self.time[k])
        rows = self.coordinates, self.rates, self.forces, self.applied
        self.residual = search(self.balance, self.free, self.time, k, *rows)
        self.kept[k] = self.balance.memory
        return self.residual <= JUMP

    def rate(self, k: int, coordinate: float) -> float:
        """Return the driven coordinate's rate at instant k by backward differences, as all others have it."""
        before = self.coordinates[:, self.ahead.coordinate]
        if k == 1:
            return float((coordinate - before[0]) / (self.time[1] - self.time[0]))
        base = np.empty(1)
        per_time = backward_difference(self.time, before[:, None], k, base)
        return float((coordinate - base[0]) * per_time)

    def find(self, k: int) -> bool:
        """Fill the row of instant k; false where there is no equilibrium near that before."""
        driven, sign, step = self.ahead.coordinate, self.ahead.sign, self.time[k] - self.time[k - 1]
        before, column = float(sign * self.coordinates[k - 1, driven]), self.ahead.column
        end, moving = float(self.ahead.place(self.time[k])), float(self.ahead.rate(self.time[k]))
        stiff = column.stiffness + column.damping / step

        def surplus(place: float) -> float:
            torque = self.torque(k, place)
            self.largest = max(self.largest, abs(torque)) if np.isfinite(torque) else self.largest
            return torque - float(column.torque(end - place, moving - (place - before) / step))

        guess = before + float(sign * self.rates[k - 1, driven]) * step
        reach = WIDEST * (abs(end - float(self.ahead.place(self.time[k - 1]))) + self.largest / stiff)
        slope = max(self.slope, stiff)
        for self.searching in (False, True):
            place, found = root(surplus, guess, slope, reach, lambda: CLOSE * self.largest)
            if np.isfinite(place):
                self.slope = found
                return True
            if self.sprung(k):
                return True
        return False

    def sprung(self, k: int) -> bool:
        """Find pinion and rack together, the column a spring on the pinion; false without an equilibrium, or
        with one for which the pinion would have to leave its place.

        Where all sticks, the torque changes so much over so little of the pinion's angle that it is no use as
        a function of that; its inverse is tame.
        """
        driven, sign, step = self.ahead.coordinate, self.ahead.sign, self.time[k] - self.time[k - 1]
        column, before = self.ahead.column, float(self.coordinates[k - 1, driven])
        end, moving = (
            sign * float(self.ahead.place(self.time[k])),
            sign * float(self.ahead.rate(self.time[k])),
        )
        tangent = np.zeros((self.balance.size, self.balance.size))
        tangent[driven, driven] = -(column.stiffness + column.damping / step)

        def spring(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            torque = np.zeros(self.balance.size)
            torque[driven] = column.torque(end - q[driven], moving - (q[driven] - before) / step)
            return torque, tangent

        begin_step(self.balance.memory, self.kept[k - 1, 1], self.time[k])
        rows = self.coordinates, self.rates, self.forces, self.applied
        free = np.union1d(self.free, [driven])
        self.residual = search(self.balance, free, self.time, k, *rows, spring)
        self.kept[k] = self.balance.memory
        moved = abs(float(self.coordinates[k, driven]) - before)
        stuck = moved <= STUCK * abs(end - sign * float(self.ahead.place(self.time[k - 1])))
        return stuck and self.residual <= CLOSE * self.largest / self.balance.lengths[driven]

    def divided(self, k: int, shortest: float) -> bool:
        """Put an instant halfway before instant k; false where the step [s] is as short as that already."""
        if self.time[k] - self.time[k - 1] < shortest:
            return False
        self.time = np.insert(self.time, k, (self.time[k - 1] + self.time[k]) / 2)
        self.applied = np.insert(self.applied, k, (self.applied[k - 1] + self.applied[k]) / 2, axis=0)
        for name in self.FILLED:
            rows = getattr(self, name)
            setattr(self, name, np.insert(rows, k, np.zeros(rows.shape[1:]), axis=0))
        return True

    def path(self, start: EquilibriumPath, found: int) -> EquilibriumPath:
        """Return the path of the instants found."""
        evaluations, iterations, tangents = self.counts.tolist()
        names = ("time", "coordinates", "rates", "forces", "applied", "kept")
        rows = {name: getattr(self, name)[:found] for name in names}
        return replace(
            start,
            **rows,
            evaluations=evaluations,
            iterations=iterations,
            tangents=tangents,
            residual=max(start.residual, self.residual),
            lost_at=None if found == len(self.time) else float(self.time[found]),
        )


def root(
    surplus: Callable[[float], float],
    guess: float,
    slope: float,
    reach: float,
    close: Callable[[], float],
) -> tuple[float, float]:
    """Return the root of a rising function and its slope there; nan where none is found within a reach.

    Secants from a guess and a slope, kept within the bracket as soon as there is one, halved where they leave
    it or hardly shorten it.
    """
    low, high, place, value = -np.inf, np.inf, guess, surplus(guess)
    for trial in range(TRIALS):
        if not np.isfinite(value):
            return np.nan, slope
        if abs(value) <= close() or high - low <= MOST_PLACES:
            return place, slope
        low, high = (place, high) if value < 0 else (low, place)
        new = place + float(np.clip(-value / slope, -reach, reach))
        stalled = trial >= STALLED and trial % 3 == 0 and np.isfinite(high - low)
        if stalled or not low < new < high:
            new = (low + high) / 2
        if abs(new - guess) > reach:
            return np.nan, slope
        before, place, value = (place, value), new, surplus(new)
        for _ in range(RETRIES):
            if np.isfinite(value):
                break
            place = NEARER * place + (1 - NEARER) * before[0]
            value = surplus(place)
        found = (value - before[1]) / (place - before[0]) if place != before[0] else slope
        slope = found if found > 0 else slope
    return np.nan, slope
