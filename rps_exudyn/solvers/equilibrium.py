"""Equilibrium of the gear while pinion, rack or steering wheel is moved, everything sliding.

Unknowns are the coordinates of rack, plunger and pinion but for the one that the rig drives. The forces are
those of the dynamic model (`gear_model`). The rates that friction needs are the path's own, by backward
differences, so that this is the limit of slow dynamics and not a model of its own. At the first instant they
are those of steady motion: rack and pinion move at the gear's gain, nothing else moves.

Steady motion is followed without inertia. Where the drive is not steady all masses are accelerated as the
path is, by backward differences of its rates: in long steps what swings fast is damped, and slow motion is
right. Behind a steering column the pinion is free, and the wheel's coordinate follows, given or turned by a
torque.
"""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from rps_exudyn.base.progress import reached
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, PINION, PLUNGER, RACK
from rps_exudyn.forces.friction import TIME, reset
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.solvers.balance import SIZE, Balance
from rps_exudyn.solvers.follower import NO_COLUMN, RIGID, add_column_to, follow, room_to_follow
from rps_exudyn.solvers.gear_model import OUTPUTS
from rps_exudyn.solvers.prescribed_motion import Drive, Steady
from rps_exudyn.solvers.rescue import JUMP, Settling, beginning, search
from rps_exudyn.solvers.settling import SETTLING_STEPS, TOLERANCE, TYPICAL_APPROACH
from rps_exudyn.solvers.steering_column import BehindColumn, ColumnModel, WheelTorque

PIECE = 2000  # instants followed at once: Ctrl-C is heard between them
MAX_RESCUES = 50  # or as many as instants are asked for
SHORTEST = 0.01  # of the steps asked for, that between an instant found and one that is not ...
SHORTEST_BEHIND_COLUMN = 1 / 256  # ... and where friction lets a column's end go
SNAP = 4  # times the fastest motion so far: behind a column the gear jumps to another equilibrium
RUNS_AWAY = 3  # steps, within one of those asked for, in which a part gets twice as fast before a jump
FOLD = 4  # instants over which ever more force is left: beyond a fold of the equilibria it grows with the way
WHEEL_LENGTH = 0.01  # turns the wheel's coordinate into a length [m]


@dataclass(frozen=True)
class Start:
    """How far the start of a path depends on how the gear came there."""

    unsettled: float  # by how much the drive's force depends on it, over its largest
    settles_in: float  # time of steady motion after which it does not any more [s]
    unsettled_behind: float = 0.0  # by how much the force over the first tooth pitch depends on it at most


SETTLED = Start(0.0, 0.0)


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria along a drive's motion; arrays have one row per instant, up to the first without one."""

    time: np.ndarray  # (n,) [s]
    coordinates: np.ndarray  # (n, 8 or more) pinion, rack, plunger, modes of bending, supports
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
    # (n, 2, .) state of the bristles at start and end of each step
    kept: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 0)))
    outputs: np.ndarray = field(default_factory=lambda: np.zeros((0, OUTPUTS)))  # of all parts
    wheel: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  # (n, 2) its coordinate, rate, if any
    jumps: str = ""  # what shows that the gear jumps where the path ends
    kinetic: np.ndarray | float = 0.0  # (n,) energy of what is accelerated behind a column [J]

    @property
    def converged(self) -> bool:
        """Return whether there is an equilibrium at all instants."""
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
            for name in ("time", "coordinates", "rates", "forces", "applied", "kept", "outputs", "wheel")
        }
        return replace(self, **rows, kinetic=0.0)


class PathInterrupted(KeyboardInterrupt):
    """Raised where Ctrl-C ends a path.

    Attributes:
        path: the part that was followed.
    """

    def __init__(self, path: EquilibriumPath) -> None:
        super().__init__("interrupted")
        self.path = path


def steady_rates(pair: GearPair, speed: float, size: int = SIZE, angle: float = 0.0) -> np.ndarray:
    """Return the rates of steady turning at pinion speed [rad/s] and angle [rad], shape (size,)."""
    rates = np.zeros(size)
    rates[COORDINATE_BLOCKS["pinion"]] = -speed
    rates[COORDINATE_BLOCKS["rack"].start] = pair.gain_at(angle) * speed
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
        pair.travel_at(angle) + swing,
        pair.axis_offset + runout - TYPICAL_APPROACH,
    )
    guess[COORDINATE_BLOCKS["plunger"]] = runout
    return guess


def rigid_motion(pair: GearPair, drive: Drive, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places of rigid bodies at times [s], by gain and runout, and their rates, shape (t, 8)."""
    angle, speed = drive.pinion_motion(pair, time)
    gain = pair.gain_at(angle)
    phase, share = angle + pair.runout_angle, np.cos(pair.beta_p) / np.cos(pair.beta_r)
    across, lift = pair.runout * share * np.sin(phase), pair.runout * np.cos(phase)
    places, rates = np.zeros((len(time), RIGID)), np.zeros((len(time), RIGID))
    if drive.body == "rack":
        places[:, RACK], rates[:, RACK] = pair.travel_at(angle), gain * speed
        places[:, PINION] = across / gain - angle
        rates[:, PINION] = (share * lift / gain - 1) * speed
    else:
        places[:, PINION], rates[:, PINION] = -angle, -speed
        places[:, RACK], rates[:, RACK] = pair.travel_at(angle) + across, (gain + share * lift) * speed
    places[:, RACK + 1] = places[:, PLUNGER] = lift
    rates[:, RACK + 1] = rates[:, PLUNGER] = -pair.runout * np.sin(phase) * speed
    return places, rates


def backward_difference(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Return base and factor of the difference factor (y - base) at the last of the instants (k + 1,), from
    rows (k, n) at those before it; the factor is 0 without any."""
    if len(values) == 0:
        return np.zeros(values.shape[1]), 0.0
    h = float(time[-1] - time[-2])
    if len(values) == 1:
        return values[-1].copy(), 1 / h
    g = float(time[-2] - time[-3])
    factor = (2 * h + g) / (h * (h + g))
    return ((h + g) / (h * g) * values[-1] - h / (g * (h + g)) * values[-2]) / factor, factor


def instants_per_pitch(teeth: int, speed: float, time: np.ndarray) -> int:
    """Return the even instants of steady motion at a speed [rad/s] in a tooth pitch; 0 if they are uneven or
    no whole number."""
    if len(time) < 3 or not speed:
        return 0
    steps = np.diff(time)
    if np.ptp(steps) > 1e-6 * steps[0]:
        return 0
    pitch = 2 * np.pi / teeth / abs(speed)
    whole = round(pitch / steps[0])
    return whole if whole and abs(pitch / steps[0] - whole) < 1e-6 * whole else 0


def equilibrium_path(
    balance: Balance,
    pair: GearPair,
    drive: Drive,
    time: np.ndarray,
    approach_path: EquilibriumPath | None = None,
    column: ColumnModel | None = None,
) -> EquilibriumPath:
    """Follow the equilibria at rising times [s] of a drive's motion.

    Where none is found from the instant before, one halfway to it is looked for. `approach_path` is a path
    along the first of these times, which is not followed again; what it cost is counted. With a column the
    drive is that of its upper end.

    Raises:
        PathInterrupted: Ctrl-C; it carries the path until then.
    """
    following = _Following.of(balance, pair, drive, np.asarray(time, dtype=float), approach_path, column)
    interrupted = False
    try:
        while not following.whole:
            end, arguments, ended, counts = following.piece()
            room = room_to_follow(end, len(following.lengths))
            follow(*arguments, ended, counts, room)
            if not following.took(end, ended, counts) and not following.rescued():
                break
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
    lengths: np.ndarray  # of all coordinates
    column: np.ndarray  # of `follower.Column`
    masses: np.ndarray  # mass matrix of what is accelerated as the path is
    approach_path: EquilibriumPath | None  # path along the first instants
    speed: float  # of the pinion at the first instant [rad/s]
    found: int = 0  # instants
    counts: np.ndarray = field(
        default_factory=lambda: np.zeros(3, dtype=int)
    )  # evaluations, iterations, tangents
    rescues: int = 0
    unbalanced: float = 0.0  # largest force left at the instants found [N]
    residual: float = 0.0  # at the last one looked for [N]
    left: dict[float, float] = field(default_factory=dict)  # at each instant searched, the least [s] -> [N]

    @classmethod
    def of(
        cls,
        balance: Balance,
        pair: GearPair,
        drive: Drive,
        time: np.ndarray,
        approach_path: EquilibriumPath | None,
        column: ColumnModel | None,
    ) -> "_Following":
        """Begin with the guess for the first instant, or behind a path that leads along the first ones."""
        rows = _Rows.along(balance, drive, time, column is not None)
        free, lengths, numbers = balance.free(drive.coordinate), balance.lengths, NO_COLUMN
        masses = balance.masses.copy()
        if column is not None:
            wheel = drive.wheel if isinstance(drive, BehindColumn) else drive
            tyre = wheel.tyre if isinstance(wheel, WheelTorque) else None
            masses = np.pad(masses, (0, 1)) if masses.size else masses
            masses[-1:, -1:] = 0.0 if tyre is None else column.inertia
            free = np.union1d(free, [PINION])
            free = np.append(free, balance.size) if tyre is not None else free
            lengths = np.append(lengths, WHEEL_LENGTH)
            springs = (tyre.stiffness, tyre.relaxed) if tyre is not None else (0.0, 0.0)
            given = column.stiffness, column.damping, column.bend, column.phase
            numbers = np.array([1.0, *given, *springs])
        angle, speed = (float(each) for each in drive.pinion_motion(pair, time[0]))
        following = cls(balance, pair, drive, rows, free, lengths, numbers, masses, approach_path, speed)
        memory, size = balance.memory, balance.size
        reset(memory)
        memory[1, TIME] = time[0]
        if approach_path is not None and (len(approach_path.time) > 1 or column is not None):
            following.found, following.unbalanced = rows.take_over(approach_path), approach_path.residual
            following.rescues = approach_path.rescues
            following.counts += approach_path.evaluations, approach_path.iterations, approach_path.tangents
            return following
        following.approach_path = None
        first = rows.coordinates[0].copy()
        first[:size] = starting_guess(pair, angle, size)
        first[RACK + 1] += TYPICAL_APPROACH - pair.axis_offset - balance.approach
        first[PLUNGER] -= float(balance.gears[0]["seat"]["back"]) * first[RACK]
        first[size - len(balance.supported) : size] = balance.supported
        steady = np.zeros(len(first))
        steady[:size] = steady_rates(pair, speed, size, angle)
        rows.coordinates[0, free], rows.rates[0, free] = first[free], steady[free]
        return following

    @property
    def whole(self) -> bool:
        """Return whether all instants are found."""
        return self.found == len(self.rows.time)

    def piece(self) -> tuple[int, tuple[Any, ...], np.ndarray, np.ndarray]:
        """Return the end of the next piece of the path, the arguments of `follow` for it, and the arrays that
        it fills: the instants found (1,) and its counts (1, 5)."""
        rows, balance, time = self.rows, self.balance, self.rows.time
        end = min(self.found + PIECE, len(time))
        known, known_rates = (each[None] for each in rigid_motion(self.pair, self.drive, time[:end]))
        state = rows.coordinates, rows.rates, rows.forces, rows.outputs, rows.kept
        arguments = (
            balance.law,
            self.found,
            time[:end],
            instants_per_pitch(self.pair.teeth, self.speed, time) if type(self.drive) is Steady else 0,
            known,
            known_rates,
            self.free,
            self.lengths,
            rows.applied[:end],
            self.column,
            rows.hand[:end],
            self.masses,
            TOLERANCE,
            *(each[None, :end] for each in state),
            balance.gears,
            balance.pool,
            balance.works,
        )
        return end, arguments, np.zeros(1, dtype=np.int64), np.zeros((1, 5))

    def took(self, end: int, ended: np.ndarray, counts: np.ndarray) -> bool:
        """Note how far `follow` came; return whether it found the whole piece."""
        time = self.rows.time
        self.found, self.residual = int(ended[0]), float(counts[0, 4])
        self.counts += counts[0, :3].astype(int)
        if self.found and time[-1] > 0:
            shown = self.drive.wheel if isinstance(self.drive, BehindColumn) else self.drive
            reached(time[self.found - 1] / time[-1], partial(shown.shown, time[self.found - 1]))
        self.unbalanced = max(self.unbalanced, float(counts[0, 3]))
        return self.found == end

    def settling(self, k: int, base: np.ndarray, per_time: float) -> Settling:
        """The search for a balance at instant k, its rates (place - base) per_time."""
        balance, rows, size = self.balance, self.rows, self.balance.size
        before, rate_factor = backward_difference(rows.time[: k + 1], rows.rates[:k])

        def evaluate(q: np.ndarray, v: np.ndarray, factor_v: float) -> tuple[np.ndarray, np.ndarray]:
            forces, slopes = balance.force_and_tangent(q[:size], v[:size], 1.0, factor_v)
            forces += rows.applied[k, :size]
            if not self.column[0] and not self.masses.size:
                return forces, slopes
            total, tangent = np.zeros(q.size), np.zeros((q.size, q.size))
            total[:size], tangent[:size, :size] = forces, slopes
            acting = self.column, rows.hand[k], self.masses, before, rate_factor
            add_column_to(q, v, *acting, factor_v, total, tangent)
            return total, tangent

        return Settling(
            evaluate, self.free, self.lengths, rows.coordinates[k], rows.rates[k], base[self.free], per_time
        )

    def rescued(self) -> bool:
        """Look further for the next instant; return whether there is something to go on from."""
        rows, k = self.rows, self.found
        most = max(MAX_RESCUES, int(rows.asked.sum())) * (4 if self.column[0] else 1)
        most += self.approach_path.rescues if self.approach_path is not None else 0
        if self.rescues == most or (k == 0 and self.rescues > 0):
            return False
        self.rescues += 1
        if k == 0:
            pitch = 2 * np.pi / self.pair.teeth / abs(self.speed) if self.speed else 0.0
            settling = self.settling(0, rows.coordinates[0], 0.0)
            memory = self.balance.memory if self.balance.has_bristles else None
            rows.coordinates[0], rows.rates[0] = beginning(settling, pitch, SETTLING_STEPS, memory)
            return True
        if self.searched(k) and not self.snaps(k):
            self.unbalanced = max(self.unbalanced, self.residual)
            self.found += 1
            return True
        shortest = SHORTEST_BEHIND_COLUMN if self.column[0] else SHORTEST
        return rows.halve(k, shortest, self.balance, self.drive, bool(self.column[0]))

    def snaps(self, k: int) -> bool:
        """Return whether the gear behind a column jumps in the step to instant k: no path of equilibria leads
        there, and shorter steps show it as a faster motion."""
        if not self.column[0]:
            return False
        fastest = np.abs(self.rows.rates[: k + 1] * self.lengths).max(axis=1)
        return bool(fastest[k] > SNAP * fastest[:k].max())

    def jumps(self) -> str:
        """Return what shows that the gear jumps where no next instant is found, "" where nothing does."""
        if self.whole or not self.found:
            return ""
        if self.residual <= TOLERANCE:
            return "the next equilibrium is far from the one before"
        if self.runs_away():
            return "no equilibrium is found, because a part slides away"
        return "no equilibrium leads on, beyond it ever more force is left over" if self.folds() else ""

    def folds(self) -> bool:
        """Return whether the equilibria end in a fold: the least force that is left grows from the last
        instant found, where some is left already, to those beyond it."""
        last = self.rows.time[self.found - 1]
        beyond = sorted((time, least) for time, least in self.left.items() if time >= last)[:FOLD]
        rises = bool((np.diff([least for _, least in beyond]) > 0).all())
        return self.left.get(last, 0.0) > TOLERANCE and len(beyond) == FOLD and rises

    def runs_away(self) -> bool:
        """Return whether the steps at the end are as short as makes sense, and within the last of those asked
        for the fastest part has become twice as fast, and far faster than the rack. Friction that grows with
        the load that it makes, or that falls, leaves no equilibrium ahead."""
        k, rows = self.found, self.rows
        if k <= RUNS_AWAY or self.column[0]:
            return False
        asked = np.diff(rows.time[rows.asked]).min()
        begun = min(int(np.searchsorted(rows.time[:k], rows.time[k - 1] - asked)), k - 1 - RUNS_AWAY)
        driven = np.abs(self.drive.pinion_motion(self.pair, rows.time[:k])[1]).max()
        fastest = np.abs(rows.rates[begun:k] * self.lengths).max(axis=1)
        shortened = rows.time[k] - rows.time[k - 1] < asked / 2
        runs_away = fastest[-1] > max(2 * fastest[0], SNAP * driven * self.pair.gain)
        return bool(shortened and runs_away)

    def searched(self, k: int) -> bool:
        """Let the gear creep to the equilibrium at instant k; return whether it was found."""
        rows, time, free = self.rows, self.rows.time, self.free
        balance, places = self.balance, rows.coordinates
        step, (base, per_time) = time[k] - time[k - 1], backward_difference(time[: k + 1], places[:k])
        ahead = places[k - 1] + step * rows.rates[k - 1]
        if k > 1:
            ahead = places[k - 1] + step / (time[k - 1] - time[k - 2]) * (places[k - 1] - places[k - 2])
        if balance.has_bristles:
            balance.memory[0], balance.memory[1, TIME] = rows.kept[k - 1, 1], time[k]
        settling = self.settling(k, base, per_time)
        place, self.residual = search(settling, [ahead[free], places[k - 1, free]])
        self.left[time[k]] = min(self.residual, self.left.get(time[k], np.inf))
        rows.coordinates[k], rows.rates[k] = settling.at(place)
        size = balance.size
        forces = balance.force(rows.coordinates[k, :size], rows.rates[k, :size])
        rows.forces[k, :size] = forces + rows.applied[k, :size]
        if self.masses.size:
            before, factor = backward_difference(time[: k + 1], rows.rates[:k])
            rows.forces[k, :size] -= (self.masses @ (rows.rates[k] - before) * factor)[:size]
        rows.outputs[k] = balance.works[0]["out"]
        if balance.has_bristles:
            rows.kept[k] = balance.memory
        return self.residual <= JUMP

    def path(self) -> EquilibriumPath:
        """Return what was found."""
        rows, size, found = self.rows, self.balance.size, self.found
        asked, (evaluations, iterations, tangents) = np.flatnonzero(rows.asked[:found]), self.counts.tolist()
        coordinates, rates, applied = rows.coordinates[asked], rows.rates[asked], rows.applied[asked, :size]
        if self.column[5]:  # the tyres
            applied[:, RACK] -= self.column[5] * (coordinates[:, RACK] - self.column[6])
        kinetic: np.ndarray | float = 0.0
        if self.masses.size:
            kinetic = 0.5 * np.einsum("ti,ij,tj->t", rates, self.masses, rates)
        return EquilibriumPath(
            rows.time[asked],
            coordinates[:, :size],
            rates[:, :size],
            rows.forces[asked, :size],
            applied,
            evaluations,
            iterations,
            tangents,
            self.rescues,
            self.unbalanced if self.whole else self.residual,
            None if self.whole else float(rows.time[found]),
            float(rows.time[0]),
            kept=rows.kept[asked],
            outputs=rows.outputs[asked],
            wheel=np.append(coordinates[:, size:], rates[:, size:], axis=1),
            jumps=self.jumps(),
            kinetic=kinetic,
        )


@dataclass
class _Rows:
    """Instants of a path, those asked for and those put between, and what is found there."""

    time: np.ndarray  # (n,) [s]
    asked: np.ndarray  # (n,)
    coordinates: np.ndarray  # one row each; the driven one is given
    rates: np.ndarray
    forces: np.ndarray
    applied: np.ndarray  # what acts besides the gear's forces, and counts among them
    outputs: np.ndarray  # of all parts
    kept: np.ndarray  # (n, 2, .) state of the bristles
    hand: np.ndarray  # torque on the wheel [N m]

    @classmethod
    def along(cls, balance: Balance, drive: Drive, time: np.ndarray, has_column: bool) -> "_Rows":
        """The driven coordinate at its places, all others at zero."""
        n, t = balance.size + has_column, len(time)
        coordinates, rates, forces, applied = (np.zeros((t, n)) for _ in range(4))
        hand, wheel = np.zeros(t), drive.wheel if isinstance(drive, BehindColumn) else None
        if not has_column or wheel is None:
            driven = drive.coordinate
            coordinates[:, driven], rates[:, driven] = drive.driven(time)
        else:
            coordinates[:, -1], rates[:, -1] = -wheel.place(time), -wheel.rate(time)
            hand = np.asarray(wheel.torque(time)) if isinstance(wheel, WheelTorque) else hand
        if balance.outside is not None:
            applied[:, : balance.size] += balance.outside(time)
        kept, outputs = np.zeros((t, 2, balance.kept)), np.zeros((t, OUTPUTS))
        asked = np.ones(t, dtype=bool)
        return cls(time, asked, coordinates, rates, forces, applied, outputs, kept, hand)

    def take_over(self, approach_path: EquilibriumPath) -> int:
        """Take over the instants of a path; return how many."""
        found, size = len(approach_path.time), approach_path.coordinates.shape[1]
        for name in ("coordinates", "rates", "forces"):
            getattr(self, name)[:found, :size] = getattr(approach_path, name)
        self.outputs[:found], self.kept[:found] = approach_path.outputs, approach_path.kept
        return found

    @property
    def filled(self) -> int:
        """Number of instants found, which have forces."""
        return int(self.forces.any(axis=1).sum())

    def halve(self, k: int, shortest: float, balance: Balance, drive: Drive, has_column: bool) -> bool:
        """Put an instant before the k-th; false where steps are `shortest` of those asked for already."""
        between = self.time[k] - self.time[k - 1]
        if between < shortest * np.diff(self.time[self.asked]).min():
            return False
        middle = np.array([self.time[k] - between / 2])
        new = _Rows.along(balance, drive, middle, has_column)
        new.asked[:] = False
        for name, values in vars(new).items():
            setattr(self, name, np.insert(getattr(self, name), k, values, axis=0))
        return True
