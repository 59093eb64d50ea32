"""Equilibrium of the gear while pinion or rack is moved, everything sliding.

Unknowns are the coordinates of rack, plunger and pinion but for the one that the rig drives. The forces are
those of the dynamic model (`gear_kernel`), and of inertia only what the drive prescribes: that of pinion and
rack where they follow a drive that is not steady. The rates that friction needs are the path's own,
by backward differences, so that this is the limit of slow dynamics and not a model of its own. At the first
instant they are those of steady motion: rack and pinion move at the gear's gain, nothing else moves.
"""

from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from rps_exudyn.base.progress import reached
from rps_exudyn.forces.memory import begin_step, forget
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.balance import SIZE, Balance
from rps_exudyn.solvers.drive import Drive, Steady, travel_per_radian
from rps_exudyn.solvers.gear_kernel import COORDINATE_BLOCKS
from rps_exudyn.solvers.newton_path import LONGEST, Found, newton_path
from rps_exudyn.solvers.path_follower import follower
from rps_exudyn.solvers.rescue import JUMP, Beginning, search
from rps_exudyn.solvers.settling import TYPICAL_APPROACH

PIECE = 2000  # instants followed at once: Ctrl-C is heard between them
MAX_RESCUES = 50
SHORTEST = 0.01  # of the steps asked for, that between an instant found and one that is not


@dataclass(frozen=True)
class Start:
    """What the start of a path remembers of how the gear came there."""

    unsettled: float  # by how much the drive's force depends on it, over its largest
    settles_in: float  # time of steady motion after which it does not any more [s]
    led_over: float  # time of steady motion that the rack's teeth allow before the start [s]
    unsettled_behind: float = 0.0  # by how much the force over the first tooth pitch depends on it at most


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
    following = _Following.of(balance, pair, drive, np.asarray(time, dtype=float), led)
    interrupted = False
    try:
        following.to_the_end()
    except KeyboardInterrupt:
        interrupted, following.found = True, max(following.found, following.rows.filled)
        if following.found < 2:
            raise
    path = following.path()
    if interrupted:
        raise PathInterrupted(path)
    return path


@dataclass
class _Following:
    """A path while it is followed: up to which instant, at what cost, how well it balances."""

    balance: Balance
    pair: GearPair
    drive: Drive
    rows: "_Rows"
    free: np.ndarray  # coordinates that are unknown
    led: EquilibriumPath | None  # path along the first instants
    found: int = 0  # instants
    counts: np.ndarray = field(
        default_factory=lambda: np.zeros(3, dtype=int)
    )  # evaluations, iterations, tangents
    rescues: int = 0
    unbalanced: float = 0.0  # largest force left at the instants found [N]
    residual: float = 0.0  # at the last one looked for [N]
    outputs: np.ndarray | None = None  # of the force elements, where all are known

    @classmethod
    def of(
        cls, balance: Balance, pair: GearPair, drive: Drive, time: np.ndarray, led: EquilibriumPath | None
    ) -> "_Following":
        """Begin with the guess for the first instant, or behind a path that leads along the first ones."""
        free = balance.free(drive.coordinate)
        rows = _Rows.along(balance, pair, drive, time)
        following = cls(balance, pair, drive, rows, free, led if led and len(led.time) > 1 else None)
        guess = starting_guess(pair, drive.pinion_angle(pair.gain, time[0]), balance.size)
        guess[list(balance.locked)] = 0.0
        steady = steady_rates(pair, following.speed, balance.size)
        rows.coordinates[0, free], rows.rates[0, free] = guess[free], steady[free]
        forget(balance.memory)
        balance.memory[1, :1] = time[0]
        if led := following.led:
            following.found, following.unbalanced, following.rescues = (
                rows.follow(led),
                led.residual,
                led.rescues,
            )
            following.counts += led.evaluations, led.iterations, led.tangents
        return following

    @property
    def speed(self) -> float:
        """Speed of the pinion at the first instant [rad/s]."""
        return self.drive.pinion_speed(self.pair.gain, self.rows.time[0])

    @property
    def whole(self) -> bool:
        """Tell whether all instants are found."""
        return self.found == len(self.rows.time)

    @property
    def state(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Coordinates, rates, forces and what is applied, one row per instant."""
        return self.rows.coordinates, self.rows.rates, self.rows.forces, self.rows.applied

    def to_the_end(self) -> None:
        """Find what can be found."""
        if self.balance.newton is not None and _is_plain(self.balance, self.drive, self.rows):
            self.by_newton()
        while not self.whole and (self.advance() or self.whole or self.rescued()):
            pass

    def by_newton(self) -> None:
        """Go as far as Newton's method leads; where it does not begin, the guess stays."""
        balance, rows, guess = self.balance, self.rows, self.rows.coordinates[0].copy()
        assert balance.newton is not None
        by_newton = newton_path(
            balance.newton,
            self.pair,
            self.drive,
            rows.time,
            self.found,
            self.free,
            balance.lengths,
            self.state[:3],
            balance.data,
        )
        if by_newton.rows == 0:
            rows.coordinates[0] = guess
        self.outputs = _joined_outputs(self.led, self.found, by_newton)
        self.counts, self.found = self.counts + by_newton.costs, by_newton.rows
        if self.whole:
            self.unbalanced = max(self.unbalanced, by_newton.residual)

    def advance(self) -> bool:
        """Follow one piece of the path; tell whether all of it was found."""
        time = self.rows.time
        end = min(self.found + PIECE, len(time))
        self.found, *more, self.residual = follower(self.balance.force)(
            self.found,
            time[:end],
            self.drive.coordinate,
            self.free,
            self.balance.lengths,
            *self.state,
            self.rows.kept,
            self.balance.memory,
            self.balance.data,
        )
        self.counts += more
        if self.found and time[-1] > 0:
            reached(time[self.found - 1] / time[-1], partial(self.drive.shown, time[self.found - 1]))
        if self.whole:
            self.unbalanced = max(self.unbalanced, self.residual)
        return self.found == end

    def rescued(self) -> bool:
        """Look further for the next instant; tell whether there is something to go on from."""
        if self.rescues == MAX_RESCUES or (self.found == 0 and self.rescues > 0):
            return False
        self.rescues += 1
        balance, rows, k = self.balance, self.rows, self.found
        if k == 0:
            begin = Beginning(balance, self.free, rows.coordinates[0], rows.rates[0], rows.applied[0])
            pitch = 2 * np.pi / self.pair.teeth / abs(self.speed) if self.speed else 0
            rows.coordinates[0], rows.rates[0] = begin.found(pitch)
            return True
        begin_step(balance.memory, rows.kept[k - 1, 1], rows.time[k])
        self.residual = search(balance, self.free, rows.time, k, *self.state)
        rows.kept[k] = balance.memory
        if self.residual <= JUMP:
            self.unbalanced = max(self.unbalanced, self.residual)
            self.found += 1
            return True
        return rows.halve(k, balance, self.pair, self.drive)

    def path(self) -> EquilibriumPath:
        """Return what was found."""
        path = self.rows.path(
            self.found, self.counts, self.rescues, self.unbalanced if self.whole else self.residual
        )
        if self.outputs is not None and len(self.outputs) == len(path.time):
            return replace(path, outputs=self.outputs)
        return path


def _is_plain(balance: Balance, drive: Drive, rows: "_Rows") -> bool:
    """Tell whether a path is steady motion under the gear's own forces."""
    moves = type(drive) is Steady and drive.body != "wheel" and drive.speed != 0
    return moves and balance.outside is None and not any(balance.inertia) and len(rows.time) <= LONGEST


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
