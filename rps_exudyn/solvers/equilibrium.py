"""Equilibrium of the gear while pinion or rack is moved, everything sliding.

Unknowns are the coordinates of rack, plunger and pinion but for the one that the rig drives. The forces are
those of the dynamic model (`gear_kernel`), and of inertia only what the drive prescribes: that of pinion and
rack where they follow a drive that is not steady. The rates that friction needs are the path's own,
by backward differences, so that this is the limit of slow dynamics and not a model of its own. At the first
instant they are those of steady motion: rack and pinion move at the gear's gain, nothing else moves.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.base.progress import reached
from rps_exudyn.forces.memory import NO_MEMORY, begin_step, forget
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.drive import Drive, Steady, travel_per_radian
from rps_exudyn.solvers.gear_kernel import COORDINATE_BLOCKS
from rps_exudyn.solvers.newton_path import LONGEST, Found, NewtonLaw, newton_path
from rps_exudyn.solvers.path_follower import follower
from rps_exudyn.solvers.rescue import JUMP, Beginning, search
from rps_exudyn.solvers.settling import TYPICAL_APPROACH

SIZE = 8  # coordinates of pinion, rack and plunger; modes of a flexible rack follow
CHARACTERISTIC_LENGTHS = np.array([0.01, 1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 1.0])  # coordinates to lengths [m]

PIECE = 2000  # instants followed at once: Ctrl-C is heard between them
MAX_RESCUES = 50
SHORTEST = 0.01  # of the steps asked for, that between an instant found and one that is not


class Balance(NamedTuple):
    """Forces to be balanced."""

    force: Callable[..., Any]  # (q, v, data) -> (n,), a kernel of `gear_kernel` or `flexible_kernel`
    data: Any
    locked: tuple[int, ...] = ()  # coordinates that are held at zero
    inertia: tuple[float, float] = (0.0, 0.0)  # of what follows the drive: pinion [kg m^2] and rack [kg]
    memory: np.ndarray = NO_MEMORY  # of friction that remembers, see `forces.memory`
    outside: Callable[[np.ndarray], np.ndarray] | None = None  # times (t,) -> generalised forces (t, 8)
    modes: int = 0  # of the rack's bending
    newton: NewtonLaw | None = None  # the same forces with their tangent

    @property
    def size(self) -> int:
        """Return the number of coordinates n, with those of the modes."""
        return SIZE + self.modes

    @property
    def lengths(self) -> np.ndarray:
        """Return what turns the coordinates into lengths, shape (n,) [m]; a mode moves a bar of one kilogram
        by about its coordinate."""
        return np.append(CHARACTERISTIC_LENGTHS, np.ones(self.modes))


@dataclass(frozen=True)
class Start:
    """What the start of a path remembers of how the gear came there."""

    unsettled: float  # by how much the drive's force depends on it, over its largest
    settles_in: float  # time of steady motion after which it does not any more [s]
    led_over: float  # time of steady motion that the rack's teeth allow before the start [s]


SETTLED = Start(0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria along a drive's motion; arrays have one row per instant, up to the first without one."""

    time: np.ndarray  # (n,) [s]
    coordinates: np.ndarray  # (n, 8 or more) pinion, rack, plunger, modes of the rack's bending
    rates: np.ndarray  # the same
    forces: np.ndarray  # generalised forces; that on the driven coordinate the drive overcomes
    applied: np.ndarray  # the part of them that is inertia
    evaluations: int  # of the gear's forces
    iterations: int
    tangents: int
    rescues: int  # instants that Newton's method did not find by itself
    residual: float  # largest unbalanced force, of instants found; or at the first one not found [N]
    lost_at: float | None  # the first instant without an equilibrium [s]
    begun: float  # the first instant of all [s]
    start: Start = SETTLED
    # (n, 2, .) what friction remembered at the begin and the end of each step
    kept: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 0)))
    outputs: np.ndarray | None = None  # (n, 73) of the force elements, where all are known

    @property
    def converged(self) -> bool:
        """Tell whether there is an equilibrium at all instants."""
        return self.lost_at is None

    @property
    def counters(self) -> dict[str, int]:
        """Return what it cost, by the names of `quantities`."""
        return {
            "steps": len(self.time),
            "newton_iterations": self.iterations,
            "jacobians": self.tangents,
            "force_evaluations": self.evaluations,
        }

    @property
    def last(self) -> "EquilibriumPath":
        """The path's last instant alone."""
        rows = {
            name: getattr(self, name)[-1:]
            for name in ("time", "coordinates", "rates", "forces", "applied", "kept")
        }
        return replace(self, **rows, outputs=None)


class PathInterrupted(KeyboardInterrupt):
    """Raised where Ctrl-C ends a path.

    Attributes:
        path: the part that was followed.
    """

    def __init__(self, path: EquilibriumPath) -> None:
        super().__init__("interrupted")
        self.path = path


def steady_rates(pair: GearPair, speed: float, size: int = SIZE) -> np.ndarray:
    """Return the rates of steady turning at pinion speed [rad/s], shape (size,)."""
    rates = np.zeros(size)
    rates[COORDINATE_BLOCKS["pinion"]] = -speed
    rates[COORDINATE_BLOCKS["rack"].start] = pair.gain * speed
    return rates


def starting_guess(pair: GearPair, angle: float, size: int = SIZE) -> np.ndarray:
    """Return coordinates near the equilibrium at pinion angle `angle` [rad], shape (size,): the rack follows
    the runout, pressed a little into the mesh, and does not bend; the plunger, which is adjusted to where the
    axis is, follows it as well."""
    phase = angle + pair.runout_angle
    runout = pair.runout * np.cos(phase)
    swing = pair.runout * np.sin(phase) * np.cos(pair.beta_p) / np.cos(pair.beta_r)
    guess = np.zeros(size)
    guess[COORDINATE_BLOCKS["pinion"]] = -angle
    guess[COORDINATE_BLOCKS["rack"]][:2] = (
        pair.gain * angle + swing,
        pair.axis_offset + runout - TYPICAL_APPROACH,
    )
    guess[COORDINATE_BLOCKS["plunger"]] = runout
    return guess


def inertia_forces(balance: Balance, pair: GearPair, drive: Drive, time: np.ndarray) -> np.ndarray:
    """Return the inertia forces on the coordinates, of a pinion and a rack that follow the drive, (t, n).

    To first order both follow at the gear's gain: what their elastic deflection changes in that is left out.
    """
    turning = drive.acceleration(time) / travel_per_radian(drive.body, pair.gain)
    forces = np.zeros((len(time), balance.size))
    forces[:, COORDINATE_BLOCKS["pinion"].start] = balance.inertia[0] * turning
    forces[:, COORDINATE_BLOCKS["rack"].start] = -balance.inertia[1] * pair.gain * turning
    return forces


def equilibrium_path(
    balance: Balance, pair: GearPair, drive: Drive, time: np.ndarray, led: EquilibriumPath | None = None
) -> EquilibriumPath:
    """Follow the equilibria at rising times [s] of a drive's motion.

    Where none is found from the instant before, one halfway to it is looked for first. `led` is a path along
    the first of these times, which is not followed again; what it cost is counted.

    Raises:
        PathInterrupted: Ctrl-C; it carries the path until then.
    """
    fixed = {drive.coordinate, *balance.locked}
    free = np.array([i for i in range(balance.size) if i not in fixed])
    rows = _Rows.along(balance, pair, drive, np.asarray(time, dtype=float))
    angle, speed = drive.pinion_angle(pair.gain, time[0]), drive.pinion_speed(pair.gain, time[0])
    guess, steady = starting_guess(pair, angle, balance.size), steady_rates(pair, speed, balance.size)
    guess[list(balance.locked)] = 0.0
    rows.coordinates[0, free], rows.rates[0, free] = guess[free], steady[free]

    forget(balance.memory)
    balance.memory[1, :1] = time[0]
    counts, rescues, unbalanced, found = np.zeros(3, dtype=int), 0, 0.0, 0
    if led is not None and len(led.time) > 1:
        found, unbalanced, rescues = rows.follow(led), led.residual, led.rescues
        counts += led.evaluations, led.iterations, led.tangents
    interrupted, residual, outputs = False, 0.0, None
    try:
        if balance.newton is not None and _is_plain(balance, drive, rows):
            by_newton = _by_newton(balance, pair, drive, rows, found, free)
            outputs = _joined_outputs(led if found else None, found, by_newton)
            counts, found = counts + by_newton.costs, by_newton.rows
            unbalanced = max(unbalanced, by_newton.residual) if found == len(rows.time) else unbalanced
        while found < len(rows.time):
            state = rows.coordinates, rows.rates, rows.forces, rows.applied
            end = min(found + PIECE, len(rows.time))
            found, *more, residual = follower(balance.force)(
                found,
                rows.time[:end],
                drive.coordinate,
                free,
                balance.lengths,
                *state,
                rows.kept,
                balance.memory,
                balance.data,
            )
            counts += more
            if found and rows.time[-1] > 0:
                reached(rows.time[found - 1] / rows.time[-1], partial(drive.shown, rows.time[found - 1]))
            if found == end < len(rows.time):
                continue
            unbalanced = max(unbalanced, residual if found == len(rows.time) else 0.0)
            if found == len(rows.time) or rescues == MAX_RESCUES or (found == 0 and rescues > 0):
                break
            rescues += 1
            if found == 0:
                begin = Beginning(balance, free, rows.coordinates[0], rows.rates[0], rows.applied[0])
                rows.coordinates[0], rows.rates[0] = begin.found(
                    2 * np.pi / pair.teeth / abs(speed) if speed else 0
                )
                continue
            begin_step(balance.memory, rows.kept[found - 1, 1], rows.time[found])
            residual = search(balance, free, rows.time, found, *state)
            rows.kept[found] = balance.memory
            if residual <= JUMP:
                unbalanced = max(unbalanced, residual)
                found += 1
            elif not rows.halve(found, balance, pair, drive):
                break
    except KeyboardInterrupt:
        interrupted, found = True, max(found, rows.filled)
        if found < 2:
            raise
    path = rows.path(found, counts, rescues, residual if found < len(rows.time) else unbalanced)
    if outputs is not None and len(outputs) == len(path.time):
        path = replace(path, outputs=outputs)
    if interrupted:
        raise PathInterrupted(path)
    return path


def _is_plain(balance: Balance, drive: Drive, rows: "_Rows") -> bool:
    """Tell whether a path is steady motion under the gear's own forces."""
    moves = type(drive) is Steady and drive.body != "wheel" and drive.speed != 0
    return moves and balance.outside is None and not any(balance.inertia) and len(rows.time) <= LONGEST


def _by_newton(
    balance: Balance, pair: GearPair, drive: Drive, rows: "_Rows", first: int, free: np.ndarray
) -> Found:
    """Fill rows from the first on by Newton's method; where it does not begin, their guess stays."""
    assert balance.newton is not None
    guess, state = rows.coordinates[0].copy(), (rows.coordinates, rows.rates, rows.forces)
    found = newton_path(
        balance.newton, pair, drive, rows.time, first, free, balance.lengths, state, balance.data
    )
    if found.rows == 0:
        rows.coordinates[0] = guess
    return found


def _joined_outputs(led: EquilibriumPath | None, first: int, by_newton: Found) -> np.ndarray | None:
    """The outputs of all instants, those of a path that led there too; None where some are not known."""
    outputs = by_newton.outputs[: by_newton.rows]
    if led is None or not first:
        return outputs
    if led.outputs is None or len(led.outputs) != first:
        return None
    outputs[:first] = led.outputs
    return outputs


@dataclass
class _Rows:
    """Instants of a path, those asked for and those put between, and what is found there."""

    time: np.ndarray  # (n,) [s]
    asked: np.ndarray  # (n,)
    coordinates: np.ndarray  # one row each; the driven one is given
    rates: np.ndarray
    forces: np.ndarray
    applied: np.ndarray  # what acts besides the gear's forces, and counts among them
    kept: np.ndarray  # (n, 2, .) what friction remembers

    @classmethod
    def along(cls, balance: Balance, pair: GearPair, drive: Drive, time: np.ndarray) -> "_Rows":
        """The driven coordinate at its places, all others at zero."""
        coordinates, rates, forces = (np.zeros((len(time), balance.size)) for _ in range(3))
        coordinates[:, drive.coordinate] = drive.sign * drive.place(time)
        rates[:, drive.coordinate] = drive.sign * drive.rate(time)
        applied = inertia_forces(balance, pair, drive, time)
        if balance.outside is not None:
            applied += balance.outside(time)
        kept = np.zeros((len(time), *balance.memory.shape))
        return cls(time, np.ones(len(time), dtype=bool), coordinates, rates, forces, applied, kept)

    def follow(self, led: EquilibriumPath) -> int:
        """Take over the instants of a path; return how many."""
        found = len(led.time)
        for name in ("coordinates", "rates", "forces", "kept"):
            getattr(self, name)[:found] = getattr(led, name)
        return found

    @property
    def filled(self) -> int:
        """Number of instants found, known from the forces there."""
        return int(self.forces.any(axis=1).sum())

    def path(self, found: int, counts: np.ndarray, rescues: int, residual: float) -> EquilibriumPath:
        """Return the path up to instant `found`; `counts` are evaluations, iterations and tangents."""
        evaluations, iterations, tangents = counts.tolist()
        asked = np.flatnonzero(self.asked[:found])
        return EquilibriumPath(
            self.time[asked],
            self.coordinates[asked],
            self.rates[asked],
            self.forces[asked],
            self.applied[asked],
            evaluations,
            iterations,
            tangents,
            rescues,
            residual,
            float(self.time[found]) if found < len(self.time) else None,
            float(self.time[0]),
            kept=self.kept[asked],
        )

    def halve(self, k: int, balance: Balance, pair: GearPair, drive: Drive) -> bool:
        """Put an instant before the k-th; false if those there are as close as makes sense."""
        between = self.time[k] - self.time[k - 1]
        if between < SHORTEST * np.diff(self.time[self.asked]).min():
            return False
        new = _Rows.along(balance, pair, drive, np.array([self.time[k] - between / 2]))
        new.asked[:] = False
        for name, values in vars(new).items():
            setattr(self, name, np.insert(getattr(self, name), k, values, axis=0))
        return True
