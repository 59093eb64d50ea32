"""What gears of one table have in common for the loop: its angles, a reference gear, what others teach."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import Maneuver, largest_angle, steady_maneuver
from rps_exudyn.simulate.loop_legs import Leg
from rps_exudyn.solvers.drive import travel_per_radian
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.gear_rows import RUNOUT, RUNOUT_ANGLE, packed_rows
from rps_exudyn.solvers.many_gears import Between, Known, Loop, Rows, learned, motion_at_mesh, rising
from rps_exudyn.solvers.settled_start import settled_path

SPACING = np.deg2rad(2.0)  # of the loop's angles, at most
LEAD = 2  # of its instants before the record
PER_INSTANT, PER_SPACING = 3, 4  # instants of known gears, and of the reference gear, in one of the loop's
SINGLE_OUT = (RUNOUT, "pinion.pitch_error")  # a tooth or a direction: the curve repeats with the turn

Table = Mapping[str, np.ndarray]
"""Path of a parameter -> values, SI."""

Ends = tuple[tuple[str, tuple[float, float]], ...]
"""Paths, each with the values of the gear above the reference and of that below."""


@dataclass(frozen=True, eq=False)
class Design:
    """What all gears of a table have in common over one leg."""

    leg: Leg
    gear: SteeringGear  # the reference
    fidelity: Fidelity
    loop: Loop
    maneuver: Maneuver  # over one period
    periods: int
    nodes: np.ndarray  # angles of the loop [rad]
    per_pitch: int  # of them in a tooth pitch, 0 if no whole number
    known: Known
    between: Between
    features: np.ndarray  # (n, f)
    bound: float  # of the mesh's penetration [m]

    @classmethod
    def of(
        cls, leg: Leg, gear: SteeringGear, fidelity: Fidelity, table: Table, ranges: Table | None = None
    ) -> "Design | None":
        """Follow the reference gear, and those from which the others' motion is learned.

        What only the ranges tell is learned once for all parts of a table.

        Args:
            leg: the maneuver.
            gear: the reference.
            fidelity: how all are modelled.
            table: path -> values (n,) of the gears, SI.
            ranges: path -> values that tell over what the parameter varies; those of the table without it.
        """
        whole = table if ranges is None else ranges
        alike = not any(np.any(whole.get(path, gear.value_at(path))) for path in SINGLE_OUT)
        steps, features = _features(gear, table, whole)
        design = cls._learned(leg, gear, fidelity, tuple(steps), alike)
        return None if design is None else replace(design, features=features)

    @classmethod
    @lru_cache(maxsize=12)
    def _learned(
        cls,
        leg: Leg,
        gear: SteeringGear,
        fidelity: Fidelity,
        steps: tuple[tuple[Ends, float], ...],
        alike: bool,
    ) -> "Design | None":
        """Learn from gears `steps` above and below the reference; `alike` if all pitches are."""
        of_record = gear if alike else gear.replace({RUNOUT: 1e-6})
        whole, pair = leg.maneuver(of_record, fidelity.step_angle), GearPair.of(gear)
        maneuver = whole.one_period()
        record = _record(maneuver) / leg.travel(pair.gain)
        nodes, per_pitch = _nodes(gear, maneuver, record)
        if np.abs(nodes).max() > largest_angle(gear) - 2 * np.pi / gear.pinion.teeth:
            return None
        rows = packed_rows([gear, *_perturbed(gear, steps)], fidelity)
        forces = gear_forces(gear, fidelity, leg.load(gear))
        loop = Loop(forces, pair, leg.speed(gear), leg.body, leg.weighted)
        spacing = (nodes[1] - nodes[0]) / PER_INSTANT
        before = per_pitch or LEAD
        fine = nodes[0] + spacing * np.arange(-before * PER_INSTANT, (len(nodes) - 1) * PER_INSTANT + 1)
        first = _followed(gear, fidelity, loop, rows, fine)
        if first is None:
            return None
        taught = learned(
            loop, rows, np.array([each for _, each in steps]), fine, per_pitch * PER_INSTANT, first
        )
        if taught is None:
            return None
        known, columns, response = taught
        between = Between.of(columns, response, nodes, record)
        bound = next(iter(forces.mesh.valid_to.values()))
        given = leg, gear, fidelity, loop, maneuver, whole.periods, nodes, per_pitch, known, between
        return cls(*given, np.zeros((0, len(steps))), bound)

    @property
    def record(self) -> np.ndarray:
        """Angles of the record's first period [rad]."""
        return _record(self.maneuver) / self.leg.travel(self.loop.pair.gain)

    @property
    def time(self) -> np.ndarray:
        """Instants of the whole record [s]."""
        return np.abs(self.angle - self.angle[0]) / abs(self.loop.speed)

    @property
    def angle(self) -> np.ndarray:
        """Angles of the whole record [rad]."""
        turned = self.record[-1] - self.record[0]
        return np.append(
            np.concatenate([self.record[:-1] + turned * i for i in range(self.periods)]),
            self.record[0] + turned * self.periods,
        )


def _record(maneuver: Maneuver) -> np.ndarray:
    """Places of the drive over the record."""
    time = maneuver.time
    return np.asarray(maneuver.drive.place(time[maneuver.lead :]))


def _nodes(gear: SteeringGear, maneuver: Maneuver, record: np.ndarray) -> tuple[np.ndarray, int]:
    """Even angles of the loop [rad], from before the record to its end or beyond, and their number in a
    pitch."""
    pitch, sense = 2 * np.pi / gear.pinion.teeth, np.sign(record[-1] - record[0])
    spacing = max(SPACING, abs(record[1] - record[0]))
    per_pitch = int(np.ceil(pitch / spacing * (1 - 1e-9)))
    spacing = pitch / per_pitch
    steps = int(np.ceil(abs(record[-1] - record[0]) / spacing * (1 - 1e-9)))
    return record[0] + sense * spacing * np.arange(-LEAD, steps + 1), per_pitch


def _features(gear: SteeringGear, table: Table, ranges: Table) -> tuple[list[tuple[Ends, float]], np.ndarray]:
    """What the motion responds to: for each feature the parameters above and below the reference and half
    their distance, and its values (n, f)."""
    steps: list[tuple[Ends, float]] = []
    columns: list[np.ndarray] = []
    for path, values in ranges.items():
        if path in (RUNOUT, RUNOUT_ANGLE) or not np.ptp(values):
            continue
        here = float(gear.value_at(path))
        size = _rounded(float(np.std(values)))
        above, below = min(here + size, float(values.max())), max(here - size, float(values.min()))
        steps.append((((path, (above, below)),), (above - below) / 2))
        columns.append(table[path] - here)
    if RUNOUT in table or RUNOUT_ANGLE in table:
        count = len(next(iter(table.values())))
        e = np.asarray(table.get(RUNOUT, np.full(count, gear.pinion.runout)), dtype=float)
        angle = np.asarray(table.get(RUNOUT_ANGLE, np.full(count, gear.pinion.runout_angle)), dtype=float)
        usual = np.asarray(ranges.get(RUNOUT, gear.pinion.runout), dtype=float)
        if size := _rounded(float(np.sqrt(np.mean(usual**2) / 2))):
            for turn, share in ((0.0, np.cos(angle)), (np.pi / 2, np.sin(angle))):
                steps.append((((RUNOUT, (size, size)), (RUNOUT_ANGLE, (turn, turn + np.pi))), size))
                columns.append(e * share)
    return steps, np.column_stack(columns) if columns else np.zeros((len(next(iter(table.values()))), 0))


def _rounded(size: float) -> float:
    """A size to one digit, so that parts of a study learn from the same gears."""
    return float(f"{size:.0e}")


def _perturbed(gear: SteeringGear, steps: Sequence[tuple[Ends, float]]) -> list[SteeringGear]:
    """The gears above and below the reference, feature by feature."""
    return [
        gear.replace({path: ends[which] for path, ends in settings})
        for settings, _ in steps
        for which in (0, 1)
    ]


def _followed(
    gear: SteeringGear, fidelity: Fidelity, loop: Loop, rows: Rows, fine: np.ndarray
) -> Known | None:
    """The reference gear's motion from a settled start, by the path of single runs."""
    step = abs(fine[1] - fine[0]) * PER_INSTANT / PER_SPACING
    beyond = 2 * (fine[1] - fine[0])
    maneuver = steady_maneuver(gear, loop.body, fine[0] - beyond, fine[-1] + beyond, step)
    path = settled_path(loop.forces.statics, loop.pair, maneuver.drive, maneuver.approach, maneuver.time)
    if not path.converged:
        return None
    angles = np.asarray(maneuver.drive.place(path.time)) / travel_per_radian(loop.body, loop.pair.gain)
    inside = path.time >= 0
    at_mesh = motion_at_mesh(
        angles[inside], path.coordinates[None, inside], rows.of(np.array([0])), loop, np.zeros(1)
    )
    return Known(rising(angles[inside], at_mesh[0]))
