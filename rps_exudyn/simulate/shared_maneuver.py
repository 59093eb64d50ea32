"""What the gears of one table share over one maneuver, and the records of some of them.

The gears are followed over the first period of the maneuver, at the instants of single runs. Only gears that
pass all checks of a finished run well within their bounds count as found; all others are run singly.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from rps_exudyn.forces.force_element import RACK
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.scenes.checks.rules import IN_RECORD, RuleInput
from rps_exudyn.scenes.error_bar_terms import ROUNDING
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.run_maneuver import CYCLE_DRIFT_LIMIT
from rps_exudyn.scenes.scene_run import Signals
from rps_exudyn.solvers.equilibrium import Start
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.many_gears import (
    PITCH,
    RUNOUT,
    RUNOUT_ANGLE,
    YAW,
    GearSeries,
    MotionResponse,
    Table,
    Y,
    Z,
    packed,
    same_structure,
)
from rps_exudyn.solvers.prescribed_motion import Steady, travel_per_radian
from rps_exudyn.solvers.record import instant_signals, integrated, repeated
from rps_exudyn.solvers.settled_start import settled_path

LEAD = 1 / 4  # of a tooth pitch before the record: the error of the guess at its start has decayed
NEAR_LOCK = 0.99  # of the angle at the lock: teeth for that all gears have
SINGLE_OUT = (RUNOUT, "pinion.pitch_error")  # a tooth or a direction: the curve repeats with the turn
STEADY = 2e-3  # of torque and travel: what drifts more over a period is left to a single run
SAFE = 0.95  # of a bound, from which on a single run judges

Ends = tuple[tuple[str, tuple[float, float]], ...]
"""Paths, each with the values of the gear above the reference and of that below."""


@dataclass(frozen=True, eq=False)
class SharedManeuver:
    """What all gears of a table have in common over one maneuver."""

    gear: SteeringGear  # the reference
    fidelity: Fidelity
    series: GearSeries
    maneuver: Maneuver  # over one period
    periods: int
    nodes: np.ndarray  # pinion angles at which the gears are followed [rad]
    lead: int  # of them before the record
    per_pitch: int  # of them in a tooth pitch, 0 if no whole number
    response: MotionResponse
    start: Start  # of the reference: how far its force depends on where the motion began
    features: np.ndarray  # (n, f)

    @classmethod
    def of(
        cls,
        maneuver: Maneuver,
        gear: SteeringGear,
        fidelity: Fidelity,
        table: Table,
        ranges: Table | None = None,
    ) -> "SharedManeuver | None":
        """Follow the reference gear, and those that show what each parameter does to its motion.

        What follows from the ranges alone is found once for all parts of a table.

        The maneuver is the reference gear's, over as many periods as its pitches are alike. Table and ranges
        have path -> values, SI; without ranges the table is whole.
        """
        whole = table if ranges is None else ranges
        steps, features = _features(gear, table, whole)
        shared = cls._followed(maneuver, gear, fidelity, tuple(steps))
        return None if shared is None else replace(shared, features=features)

    @classmethod
    @lru_cache(maxsize=12)
    def _followed(
        cls, whole: Maneuver, gear: SteeringGear, fidelity: Fidelity, steps: tuple[tuple[Ends, float], ...]
    ) -> "SharedManeuver | None":
        """Learn from gears `steps` above and below the reference."""
        pair, maneuver, drive = GearPair.of(gear), whole.one_period(), whole.drive
        # pinion angles of the record, of a gear without errors
        places = np.asarray(drive.place(maneuver.time[maneuver.lead :]))
        record = places / travel_per_radian(drive.body, float(pair.gain))
        pitch = 2 * np.pi / gear.pinion.teeth
        lock = np.abs(pair.angle_at(np.array([-0.5, 0.5]) * gear.rack.travel)).min()
        lock *= 1 if gear.test.path == "lock-to-lock" else NEAR_LOCK
        if np.abs(record).max() > max(lock * (1 + 1e-9), largest_angle(gear) - pitch):
            return None
        step = record[1] - record[0]
        in_pitch = pitch / abs(step)
        before, per_pitch = int(np.ceil(in_pitch)), round(in_pitch)
        if abs(in_pitch - per_pitch) > 1e-9 * in_pitch:
            per_pitch = 0
        lead = max(2, int(np.ceil(LEAD * in_pitch)))
        angles = np.concatenate([record[0] + step * np.arange(-before - lead, 0), record])
        weighted = bool(maneuver.rack_load)
        ends = [{path: both[k] for path, both in settings} for settings, _ in steps for k in (0, 1)]
        gears = [gear, *(gear.replace(end) for end in ends)]
        records = packed(gears, fidelity, weighted)
        if not same_structure(records, records[:1]).all():
            return None
        forces = gear_forces(gear, fidelity, maneuver.rack_load)
        series = GearSeries(forces, pair, float(drive.pinion_motion(pair, 0.0)[1]), drive.body)
        first = _singly(maneuver, series, records[:1], angles)
        if first is None:
            return None
        alike = MotionResponse.of(first[0][None], maneuver.time_step)
        found = series.follow(records, angles, per_pitch, alike, np.zeros((len(records), 0)))
        motion = series.beside_rigid(found, records, angles)
        motion[0], start = first
        for i in np.flatnonzero(~found.found[1:]) + 1:  # as where a contact's quadrature jumps
            own = replace(
                series, forces=gear_forces(gears[i], fidelity, maneuver.rack_load), pair=GearPair.of(gears[i])
            )
            alone = _singly(maneuver, own, records[i : i + 1], angles)
            if alone is None:
                return None
            motion[i] = alone[0]
            motion[i, :, Y] -= found.resting[i] + forces.approach
        sizes = np.array([each for _, each in steps])[:, None, None]
        response = MotionResponse.of(
            np.concatenate([motion[:1], (motion[1::2] - motion[2::2]) / (2 * sizes)]), maneuver.time_step
        )
        nodes, response = angles[before:], response.since(before)
        given = gear, fidelity, series, maneuver, whole.periods, nodes, lead, per_pitch, response, start
        return cls(*given, np.zeros((0, len(steps))))

    @property
    def angles(self) -> np.ndarray:
        """Pinion angles of the record's first period, of a gear without errors [rad]."""
        return self.nodes[self.lead :]

    @property
    def time(self) -> np.ndarray:
        """Instants of the record's first period from its start [s]."""
        time = self.maneuver.time[self.maneuver.lead :]
        return np.asarray(time - time[0])


def is_alike(gear: SteeringGear, table: Table) -> bool:
    """Return whether all tooth pitches of all gears are alike."""
    return not any(np.any(table.get(path, gear.value_at(path))) for path in SINGLE_OUT)


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
    """A size to one digit, so that the parts of a study follow the same gears."""
    return float(f"{size:.0e}")


def _singly(
    maneuver: Maneuver, series: GearSeries, record: np.ndarray, angles: np.ndarray
) -> tuple[np.ndarray, Start] | None:
    """Places (k, m) at the mesh, beside what rigid bodies do, by the path of single runs from a settled
    start. How the gear's force depends on that start follows. None where the path is not found."""
    travel = travel_per_radian(series.body, float(series.pair.gain))
    drive = Steady(series.body, travel * angles[0], travel * series.speed)
    time = maneuver.time_step * np.arange(len(angles))
    path = settled_path(series.forces.statics, series.pair, drive, maneuver.approach, time)
    if not path.converged:
        return None
    places = path.coordinates[path.time >= 0]
    x = places[:, RACK].copy()
    places[:, Y] -= x * places[:, PITCH]
    places[:, Z] += x * places[:, YAW]
    return np.asarray(places - series.rigid(record, angles)[0][0]), path.start


# --- records of some gears -------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class FollowedGears:
    """Some gears of a table over one maneuver; arrays have one row for each gear."""

    shared: SharedManeuver  # what they have in common with all gears of the table
    records: np.ndarray  # their constants
    found: np.ndarray  # whether there is an equilibrium at all instants, (n,)
    period: Signals  # signals over the record's first period, (n, m), time (m,)
    counts: dict[str, np.ndarray]  # what it took to follow them, name -> (n,), by the names of `quantities`

    @classmethod
    def of(cls, shared: SharedManeuver, records: np.ndarray, chosen: np.ndarray) -> "FollowedGears":
        """Follow the chosen gears of a table's records."""
        some, features = records[chosen], shared.features[chosen]
        if not shared.maneuver.rack_load:  # in a table's records the weight may pull
            some["load"] = shared.series.forces.gears["load"]
            some["has_load"] = shared.series.forces.gears["has_load"]
        found = shared.series.follow(some, shared.nodes, shared.per_pitch, shared.response, features)
        signals = instant_signals(found.record)
        instants = {name: values[..., shared.lead :] for name, values in signals.items()}
        if shared.maneuver.drive.body == "pinion":
            instants["pinion_angle"] = shared.angles
        return cls(shared, some, found.found, integrated(instants, shared.time), found.counts)

    def whole(self, kept: np.ndarray) -> Signals:
        """Return the signals over all periods of those gears that a mask (n,) keeps."""
        period, periods = signals_of_some(self.period, kept), self.shared.periods
        return repeated(period, periods) if periods > 1 else period

    def surely_ok(self) -> np.ndarray:
        """Which gears were found and pass all checks of a finished run well within their bounds, (n,)."""
        shared, signals = self.shared, self.period
        force, offset = (
            signals[shared.maneuver.drive.signal],
            self.records["mesh"]["flank"]["axis_offset"][:, None],
        )
        given = RuleInput(
            shared.gear, signals=signals, axis_offset=offset, valid_to=shared.series.forces.valid_to
        )
        drift = np.abs(force[:, -1] - force[:, 0]) / np.maximum(np.abs(force).max(axis=-1), ROUNDING)
        steps = np.diff(signals["pinion_angle"]) * np.sign(shared.series.speed)
        allowed_drift = SAFE * CYCLE_DRIFT_LIMIT if shared.periods > 1 else STEADY
        checks = (
            self.found,
            *(rule.within(given, SAFE) for rule in IN_RECORD),
            (drift * shared.periods < allowed_drift) | (not shared.maneuver.closes),
            (steps > 0).all(axis=-1),  # the pinion never turns back
        )
        return np.asarray(np.logical_and.reduce(np.broadcast_arrays(*checks)))


def signals_of_some(signals: Signals, rows: np.ndarray | int) -> Signals:
    """Return the signals of one or some of many gears, by number or mask (n,), and those that all share."""
    return {name: each[rows] if each.ndim > 1 else each for name, each in signals.items()}
