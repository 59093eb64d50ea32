"""Make a maneuver with the reduced gear: a pinion that turns as prescribed, or behind the steering column."""

from time import process_time

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import reached
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Remark, Status
from rps_exudyn.results.quantities import LOSS_SHARES, SUMMARY, WANDERING
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.reduced_table import Follow, TableLost, table_of
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.prescribed_motion import SetOff, Steady
from rps_exudyn.solvers.reduced_gear import BeyondTable, ReducedGear
from rps_exudyn.solvers.reduced_motion import THETA, Push, RackEnd, ReducedMotion
from rps_exudyn.solvers.steering_column import ColumnModel, WheelTorque

SUBSTEPS = 4  # of a step of the maneuver: those of equilibria and of the dynamics are long for a column
ROOM = 1.5  # times the load that the torque's peak would hold: the wheel overshoots
TURNED_ABOUT = frozenset({"feel_angle_hysteresis", "reversal_angle"})
"""Angles over which friction turns about, which a reduced gear has from one swing without load."""
NOT_REDUCED = WANDERING | TURNED_ABOUT | LOSS_SHARES
"""Metrics that a reduced gear has no model error of: motions beside the travel, and who takes the work."""
STARTS = 5  # times that the twist of the column at a start is found


def by_reduced(
    follow: Follow, gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions
) -> SceneRun:
    """Step the reduced gear, whose equilibria `follow` finds, through a maneuver.

    Raises:
        InputError: a maneuver that it does not have.
    """
    drive = maneuver.drive
    steady = isinstance(drive, Steady) and not isinstance(drive, SetOff)
    if steady or drive.body == "rack" or maneuver.pulse is not None:
        raise InputError(
            "fidelity.solver is reduced, which computes pinion or wheel steered to and fro, or setting off; "
            "this maneuver does neither: choose quasi-static or flank."
        )
    start, gain = process_time(), GearPair.of(gear).least_gain
    largest = max(abs(maneuver.rack_load), gear.yoke.preload, 1.0)
    if isinstance(drive, WheelTorque):
        largest = max(largest, ROOM * abs(drive.peak) / gain)
    signals: Signals = {}
    on_nut = 0.0
    outcome = Outcome(Status.OK, settings={"name": "reduced"})
    try:
        table = table_of(follow, gear, fidelity, largest, options.level)
        on_nut = table.yokenut_force
        run = _Stepped(gear, table, maneuver)
        for number, (before, after) in enumerate(zip(maneuver.time, maneuver.time[1:], strict=False), 1):
            run.step(float(before), float(after))
            reached(number / maneuver.parts, lambda: drive.shown(float(after)))  # noqa: B023
        signals = run.signals(maneuver.record_start)
    except TableLost as lost:
        outcome = lost.run.outcome
        outcome = Outcome(outcome.status, lost.sentence, outcome.codes, settings={"name": "reduced"})
    except BeyondTable as beyond:
        outcome = Outcome(Status.INVALID, str(beyond), (Code.BEYOND_TABLE,), settings={"name": "reduced"})
    outcome.cpu_s = process_time() - start
    made = SceneRun(outcome, signals)
    if on_nut == 0:
        return made.unsure_of(NOT_REDUCED)
    text = f"without a load the yokenut carries {on_nut:.3g} N: the error of the reduced gear is not known"
    return made.noting(Remark(Code.YOKE_STOPPED, text)).unsure_of(SUMMARY)


class _Stepped:
    """The reduced gear along a maneuver, and what is recorded."""

    def __init__(self, gear: SteeringGear, table: ReducedGear, maneuver: Maneuver) -> None:
        self.drive, drive = maneuver.drive, maneuver.drive
        self.tyre = drive.tyre if isinstance(drive, WheelTorque) else None
        spring = (self.tyre.stiffness, self.tyre.relaxed) if self.tyre else ()
        self.column = ColumnModel.of(gear) if drive.body == "wheel" else None
        self.wheel, self.rate = float(drive.place(0.0)), float(drive.rate(0.0))
        self.output = self.wheel if self.column is None else float(self.column.output(self.wheel))
        self.motion = motion = ReducedMotion(table, RackEnd(maneuver.rack_load, *spring), self.output)
        self.work = self.held = self.damped = 0.0  # of drive, of the load, of the column
        slides = not isinstance(drive, SetOff | WheelTorque)
        ratio = 1.0 if self.column is None else float(self.column.ratio(self.wheel))
        motion.speed = ratio * self.rate if slides else 0.0
        for _ in range(STARTS):  # sliding at its place, the column is twisted by its torque
            if slides:
                limits = motion.limits(motion.angle, motion.speed)
                motion.stretch = [up if motion.speed > 0 else -down for up, down in limits]
            if self.column is not None:
                motion.angle = self.output - motion.torque / self.column.stiffness
        self.rows: list[tuple[float, ...]] = []
        self._record(0.0)

    def step(self, before: float, after: float) -> None:
        """Go on from one instant to the next [s]."""
        h = (after - before) / SUBSTEPS
        for i in range(SUBSTEPS):
            travel, load = self.motion.travel, self.motion.end.load
            turned = self._turn if self.column is None else self._push
            turned(before + i * h, before + (i + 1) * h)
            self.held -= load * (self.motion.travel - travel)
        self._record(after)

    def _turn(self, before: float, after: float) -> None:
        """Turn the pinion; what the drive gives is what is stored and lost, and the load's."""
        motion = self.motion
        had, travel = motion.stored + motion.lost, motion.travel
        rate = float(self.drive.rate(after))
        motion.follow(float(self.drive.place(after)) - motion.angle, rate, after - before)
        self.work += motion.stored + motion.lost - had + motion.end.load * (motion.travel - travel)

    def _push(self, before: float, after: float) -> None:
        """Push the pinion by the column, whose upper end moves as prescribed or by its own balance."""
        h, motion, column, drive = after - before, self.motion, self.column, self.drive
        assert column is not None
        twist, ratio = self.output - motion.angle, float(column.ratio(self.wheel))
        half = column.stiffness / 2 + column.damping / h
        if not isinstance(drive, WheelTorque):
            wheel, rate = float(drive.place(after)), float(drive.rate(after))
            output = float(column.output(wheel)) - self.output
            turn = motion.push(Push(column.stiffness * twist + half * output, half), h)
        else:  # linear in the turns of both
            hand, inert = float(drive.torque((before + after) / 2)), column.inertia / (THETA * h)
            divisor = inert / h + ratio**2 * half
            free = (hand + inert * self.rate - ratio * column.stiffness * twist) / divisor
            along = ratio * half / divisor
            torque = column.stiffness * twist + half * ratio * free
            turn = motion.push(Push(torque, half * (1 - ratio * along)), h)
            wheel = self.wheel + free + along * turn
            output = float(column.output(wheel)) - self.output
            rate = self.rate + ((wheel - self.wheel) / h - self.rate) / THETA
            self.damped += (THETA - 0.5) * column.inertia * (rate - self.rate) ** 2
            self.work += hand * (wheel - self.wheel)
        self.damped += column.damping / h * (output - turn) ** 2
        if not isinstance(drive, WheelTorque):
            given = column.stiffness * twist + half * (output - turn)
            self.work += given * output + column.inertia * (rate**2 - self.rate**2) / 2
        self.wheel, self.rate, self.output = wheel, rate, self.output + output

    def _record(self, time: float) -> None:
        motion, column, twist = self.motion, self.column, self.output - self.motion.angle
        stored, energy, pulled = motion.stored, 0.0, 0.0
        if column is None:
            torque = motion.torque + motion.inertia * float(self.drive.acceleration(time))
        else:
            twisting = float(column.ratio(self.wheel)) * self.rate - motion.speed
            torque, energy = float(column.torque(twist, twisting)), column.stiffness * twist**2 / 2
            stored += energy + column.inertia * self.rate**2 / 2
        if self.tyre is not None:
            pulled = float(self.tyre.force(motion.travel))
            stored += float(self.tyre.energy(motion.travel))
        places = time, motion.angle, torque, motion.travel, stored, motion.lost, self.work, self.held
        self.rows.append((*places, self.wheel, twist, energy, self.damped, pulled))

    def signals(self, start: float) -> Signals:
        """Return the signals from an instant [s] on."""
        rows = np.array(self.rows)
        rows = rows[rows[:, 0] >= rows[rows[:, 0] <= start, 0].max(initial=0.0)]
        columns = dict(zip(RECORDED, rows.T.copy(), strict=True))
        for name in columns:
            if name in ("time", "stored_energy") or name.startswith("work_"):
                columns[name] = columns[name] - columns[name][0]
        absent = [] if self.tyre else ["tyre_force"]
        absent += [] if self.motion.end.load else ["work_load"]
        if (column := self.column) is None:
            absent += ["wheel_angle", "column_twist", "column_energy", "work_column_damping"]
        else:
            drive, time = self.drive, rows[:, 0]
            columns["column_torque"] = column.ratio(columns["wheel_angle"]) * columns["pinion_torque"]
            columns["column_twist"] *= column.own_share
            if isinstance(drive, WheelTorque):
                columns["wheel_torque"] = drive.torque(time)
            else:
                inert = column.inertia * drive.acceleration(time)
                columns["wheel_torque"] = columns["column_torque"] + inert
        return {name: values for name, values in columns.items() if name not in absent}


RECORDED = (
    *("time", "pinion_angle", "pinion_torque", "rack_displacement", "stored_energy", "work_gear_friction"),
    *("work_drive", "work_load", "wheel_angle", "column_twist", "column_energy", "work_column_damping"),
    "tyre_force",
)
"""Signals of a row."""
