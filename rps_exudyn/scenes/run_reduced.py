"""Make a maneuver with the reduced gear: a pinion that turns as prescribed, or behind the steering column."""

from time import process_time

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import reached
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Outcome, Status
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
            "fidelity.solver is reduced, which has a pinion or a wheel steered to and fro or setting off; "
            "choose equilibrium or generalized-alpha."
        )
    start, gain = process_time(), float(GearPair.of(gear).gain)
    largest = max(abs(maneuver.rack_load), gear.yoke.preload, 1.0)
    if isinstance(drive, WheelTorque):
        largest = max(largest, ROOM * abs(drive.peak) / gain)
    signals: Signals = {}
    outcome = Outcome(Status.OK, settings={"name": "reduced"})
    try:
        table = table_of(follow, gear, fidelity, largest, options.level)
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
    return SceneRun(outcome, signals)


class _Stepped:
    """The reduced gear along a maneuver, and what is recorded."""

    def __init__(self, gear: SteeringGear, table: ReducedGear, maneuver: Maneuver) -> None:
        self.drive, drive = maneuver.drive, maneuver.drive
        tyre = drive.tyre if isinstance(drive, WheelTorque) else None
        end = RackEnd(maneuver.rack_load)
        if tyre is not None:
            end = RackEnd(maneuver.rack_load, tyre.stiffness, tyre.relaxed)
        self.tyre, self.column = tyre, ColumnModel.of(gear) if drive.body == "wheel" else None
        self.wheel, self.rate = float(drive.place(0.0)), float(drive.rate(0.0))
        self.motion = motion = ReducedMotion(table, end, self.wheel)
        self.work = self.held = self.damped = 0.0  # of drive, of the load, of the column
        if self.column is None:
            motion.speed = self.rate
            self._slide_on()
        else:
            self.wheel_output = float(self.column.output(self.wheel))
            motion.angle = self.wheel_output
            if not isinstance(drive, SetOff | WheelTorque):
                motion.speed = float(self.column.ratio(self.wheel)) * self.rate
                for _ in range(STARTS):  # sliding at its place, the column is twisted by its torque
                    self._slide_on()
                    motion.angle = self.wheel_output - motion.torque / self.column.stiffness
            else:
                motion.angle -= motion.torque / self.column.stiffness
        self.rows: list[tuple[float, ...]] = []
        self._record(0.0)

    def _slide_on(self) -> None:
        limits, sense = self.motion.limits(self.motion.angle, self.motion.speed), self.motion.speed
        self.motion.stretch = [up if sense > 0 else -down for up, down in limits]

    def step(self, before: float, after: float) -> None:
        """Go on from one instant to the next [s]."""
        for i in range(SUBSTEPS):
            h = (after - before) / SUBSTEPS
            self._substep(before + i * h, before + (i + 1) * h)
        self._record(after)

    def _substep(self, before: float, after: float) -> None:
        h, motion, column, drive = after - before, self.motion, self.column, self.drive
        travel = motion.travel
        if column is None:
            place, rate = float(drive.place(after)), float(drive.rate(after))
            change = motion.stored + motion.lost
            torque = motion.inertia * (rate - motion.speed) / h
            motion.follow(place - motion.angle, rate, h)
            self.held -= motion.end.load * (motion.travel - travel)
            # what the drive gives over a step is what is stored and lost, and the load's
            self.work += motion.stored + motion.lost - change + motion.end.load * (motion.travel - travel)
            self.last = torque
            return
        twist = self.wheel_output - motion.angle
        middle = float(column.ratio(self.wheel))
        half = column.stiffness / 2 + column.damping / h
        if not isinstance(drive, WheelTorque):
            wheel = float(drive.place(after))
            output = float(column.output(wheel)) - self.wheel_output
            turn = motion.push(Push(column.stiffness * twist + half * output, half), h)
            rate = float(drive.rate(after))
        else:
            # the wheel's own balance, linear in the turns of both
            hand = float(drive.torque((before + after) / 2))
            inert = column.inertia / (THETA * h)
            divisor = inert / h + middle**2 * half
            free = (hand + inert * self.rate - middle * column.stiffness * twist) / divisor
            along = middle * half / divisor
            turn = motion.push(
                Push(column.stiffness * twist + half * middle * free, half * (1 - middle * along)), h
            )
            wheel = self.wheel + free + along * turn
            rate = self.rate + ((wheel - self.wheel) / h - self.rate) / THETA
            output = float(column.output(wheel)) - self.wheel_output
            self.damped += (THETA - 0.5) * column.inertia * (rate - self.rate) ** 2
        torque = column.stiffness * twist + half * (output - turn)
        self.damped += column.damping / h * (output - turn) ** 2
        if isinstance(drive, WheelTorque):
            self.work += hand * (wheel - self.wheel)
        else:
            self.work += torque * output + column.inertia * (rate**2 - self.rate**2) / 2
        self.wheel, self.rate, self.wheel_output = wheel, rate, self.wheel_output + output
        self.held -= motion.end.load * (motion.travel - travel)

    def _record(self, time: float) -> None:
        motion, column = self.motion, self.column
        torque = motion.torque
        stored, twist, energy = motion.stored, 0.0, 0.0
        if column is not None:
            twist = self.wheel_output - motion.angle
            twisting = float(column.ratio(self.wheel)) * self.rate - motion.speed
            torque = float(column.torque(twist, twisting))
            energy = column.stiffness * twist**2 / 2
            stored += energy + column.inertia * self.rate**2 / 2
        else:
            torque += motion.inertia * float(self.drive.acceleration(time))
        pulled = 0.0
        if self.tyre is not None:
            pulled = float(self.tyre.force(motion.travel))
            stored += float(self.tyre.energy(motion.travel))
        self.rows.append(
            (time, motion.angle, torque, motion.travel, stored, motion.lost, self.work, self.held, self.wheel,
             self.rate, twist, energy, self.damped, pulled)
        )  # fmt: skip

    def signals(self, start: float) -> Signals:
        """Return the signals from an instant [s] on."""
        names = (
            *("time", "pinion_angle", "pinion_torque", "rack_displacement", "stored_energy"),
            *("work_gear_friction", "work_drive", "work_load", "wheel_angle", "rate", "column_twist"),
            *("column_energy", "work_column_damping", "tyre_force"),
        )
        rows = np.array(self.rows)
        rows = rows[rows[:, 0] >= rows[rows[:, 0] <= start, 0].max(initial=0.0)]
        columns = dict(zip(names, rows.T.copy(), strict=True))
        for name in ("time", "stored_energy", *(each for each in names if each.startswith("work_"))):
            columns[name] = columns[name] - columns[name][0]
        del columns["rate"]
        if self.column is None:
            for name in ("wheel_angle", "column_twist", "column_energy", "work_column_damping"):
                del columns[name]
        else:
            column, drive, time = self.column, self.drive, rows[:, 0]
            ratio = column.ratio(columns["wheel_angle"])
            columns["column_torque"] = ratio * columns["pinion_torque"]
            columns["column_twist"] *= column.own_share
            if isinstance(drive, WheelTorque):
                columns["wheel_torque"] = drive.torque(time)
            else:
                columns["wheel_torque"] = columns["column_torque"] + column.inertia * drive.acceleration(time)
        if self.tyre is None:
            del columns["tyre_force"]
        if not self.motion.end.load:
            del columns["work_load"]
        return columns
