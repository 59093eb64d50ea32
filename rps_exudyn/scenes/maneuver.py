"""A maneuver: one motion of the rig under one load. What every scene is made of."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from rps_exudyn.forces.external_load import TimedForce
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.local_gear import turn_of_test
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.before_run import check_travel
from rps_exudyn.solvers.prescribed_motion import Drive, DrivenBody, SetOff, Steady, Swing, travel_per_radian
from rps_exudyn.solvers.settled_start import Approach, SteadyApproach, SwingApproach
from rps_exudyn.solvers.sliding_stability import bristle_reversal_angle
from rps_exudyn.solvers.steering_column import WheelTorque

LEAST_PER_CYCLE = 200  # steps of a swing
YIELDING = 3e-3  # pinion angle after a turn over which friction turns about, in most gears less [rad]
STEPS_OF_YIELDING = 25  # steps over that angle: the angle at which the gear runs again to 0.5 %
LEAST_BEFORE, PER_PITCH_BEFORE = 48, 20  # equilibria over half a cycle that leads to a swing's start
RUN_IN = np.deg2rad(0.5)  # pinion angle turned before the record starts, at least


@dataclass(frozen=True)
class StepLimits:
    """Steps that a steady maneuver gets at least, however large the fidelity's step."""

    per_period: int = 4  # four show the torque of most gears to a percent
    of_part: int = 8  # of a record that is not made of whole periods: they cost little


Division = tuple[tuple[int, int], ...]
"""Stretches of steps one after the other: how many, and into how many parts each of them is divided."""


@dataclass(frozen=True)
class Piece:
    """Consecutive steps of a maneuver, each divided into as many parts."""

    before: int  # steps of the maneuver before it
    steps: int
    parts: int

    @property
    def instants(self) -> np.ndarray:
        """Ends of the parts, in steps of the maneuver from its start."""
        return self.before + np.arange(1, self.steps * self.parts + 1) / self.parts


@dataclass(frozen=True)
class Maneuver:
    """A motion in time steps, recorded after a run-in, so that what the start stirs up has died.

    It begins settled, whatever the gear came with (`solvers.settled_start`). Steps are even but where some
    are divided.
    """

    drive: Drive
    time_step: float  # [s]
    lead: int  # steps of the run-in
    steps: int  # steps recorded
    periods: int = 1  # of the gear, all alike, that the record covers
    rack_load: float = 0.0  # pulls the rack's end towards -X [N]
    pulse: TimedForce | None = None
    approach: Approach | None = None  # None: the gear rests where it starts
    closes: bool = False  # its record covers whole periods of the gear or whole cycles
    divided: Division = ()  # of the steps of run-in and record; (): none is

    @property
    def parts(self) -> int:
        """Steps of run-in and record, each part of a divided one counted."""
        return sum(piece.steps * piece.parts for piece in self.pieces())

    @property
    def time(self) -> np.ndarray:
        """Instants from the start of the run-in to the end of the record [s]."""
        ends = np.concatenate([[0.0], *(piece.instants for piece in self.pieces())])
        return self.time_step * ends

    def pieces(self) -> Iterator[Piece]:
        """Yield the stretches of even steps, one after the other."""
        done = 0
        for steps, parts in self.divided or ((self.lead + self.steps, 1),):
            yield Piece(done, steps, parts)
            done += steps

    @property
    def record_start(self) -> float:
        """Instant at which the record starts [s]."""
        return self.lead * self.time_step * (1 + 1e-9)

    @property
    def is_steady(self) -> bool:
        """True if everything slides at a constant speed."""
        drive = self.drive
        return isinstance(drive, Steady) and not isinstance(drive, SetOff) and drive.speed != 0

    def under(self, load: float) -> "Maneuver":
        """Return the same with a load that pulls the rack's end towards -X [N]."""
        return replace(self, rack_load=load)

    def begun_earlier(self, cycles: int) -> "Maneuver":
        """Return the same swing with so many more cycles before its record."""
        assert isinstance(self.drive, Swing | WheelTorque)
        steps = round(self.drive.period / self.time_step)
        last_cycle = first_of(self.divided[::-1], steps)[::-1]
        divided = merged(self.divided + cycles * last_cycle)
        return replace(self, lead=self.lead + cycles * steps, divided=divided)

    def halved(self, times: int) -> "Maneuver":
        """Return the same in steps halved so many times; -1 doubles them, of which there are even numbers."""
        parts, approach = 2.0**times, self.approach

        def scaled(steps: int) -> int:
            return round(steps * parts)

        if isinstance(approach, SteadyApproach):
            approach = replace(approach, step=approach.step / parts)
        elif isinstance(approach, SwingApproach):
            approach = replace(approach, per_half_cycle=scaled(approach.per_half_cycle))
        return replace(
            self,
            approach=approach,
            time_step=self.time_step / parts,
            lead=scaled(self.lead),
            steps=scaled(self.steps),
            divided=tuple((scaled(steps), each) for steps, each in self.divided),
        )

    def one_period(self) -> "Maneuver":
        """Return its first period."""
        return replace(self, steps=self.steps // self.periods, periods=1)


def steady_maneuver(
    gear: SteeringGear,
    body: DrivenBody,
    first: float,
    last: float,
    step_angle: float,
    least: StepLimits = StepLimits(),
) -> Maneuver:
    """Return the motion between two pinion angles [rad] at the test's speed.

    Steps are of at most `step_angle` [rad]. `body` is the one that the rig moves; the rack moves as far and
    as fast as it would with the pinion. Each of the gear's whole periods gets the same steps.
    """
    swept = f"a test from {np.degrees(first):.6g} deg to {np.degrees(last):.6g} deg"
    allowed, whole = check_travel(gear, (first, last), swept), whole_periods(gear, abs(last - first))
    periods, at_least = (whole, least.per_period) if whole else (1, least.of_part)
    piece = abs(last - first) / periods
    per_piece = max(at_least, even(piece / step_angle * (1 - 1e-12)))
    step, speed = piece / per_piece, gear.test.speed
    lead, sense = even(RUN_IN / step), float(np.sign(last - first))
    start = first - sense * lead * step
    pair = GearPair.of(gear)
    scale = travel_per_radian(body, float(pair.gain))
    drive = Steady(body, scale * start, scale * sense * speed)
    if body == "rack" and pair.course is not None:  # at the mean ratio between the angles
        begin, end = float(pair.travel_at(first)), float(pair.travel_at(last))
        scale = (end - begin) / (last - first)
        drive = Steady(body, begin - scale * sense * lead * step, scale * sense * speed)
    pitch, toothed = 2 * np.pi / gear.pinion.teeth, max(0.0, allowed + sense * start)
    approach = SteadyApproach(pitch / speed, toothed / speed, step=step / speed)
    steps, closes = per_piece * periods, whole is not None
    return Maneuver(drive, step / speed, lead, steps, periods, approach=approach, closes=closes)


def even(steps: float) -> int:
    """Return the least even number of steps that are no fewer: half as many are as long together."""
    return 2 * int(np.ceil(steps / 2))


def maneuvers_of_test(
    gear: SteeringGear, body: DrivenBody, step_angle: float, least: StepLimits = StepLimits()
) -> list[Maneuver]:
    """Return the maneuvers that `test.path` asks for."""
    first, last = turn_of_test(gear)
    forth = steady_maneuver(gear, body, first, last, step_angle, least)
    if gear.test.path == "one-way":
        return [forth]
    return [forth, steady_maneuver(gear, body, last, first, step_angle, least)]


def swing_maneuver(
    gear: SteeringGear, step_angle: float, body: DrivenBody = "pinion", yielding: float = YIELDING
) -> Maneuver:
    """Return sinusoidal steering about the test's start angle.

    Steps are of `step_angle` [rad] where it is fastest. They are divided after each turn, where friction
    turns about: over the travel of bristles, and over an angle `yielding` [rad] that hardly depends on the
    steering.
    """
    test = gear.test
    ends = test.start_angle - test.amplitude, test.start_angle + test.amplitude
    amplitude, middle = np.degrees([test.amplitude, test.start_angle])
    check_travel(gear, ends, f"test.amplitude = {amplitude:.6g} deg about {middle:.6g} deg")
    drive = Swing(body, test.start_angle, test.amplitude, test.direction * test.speed)
    per_cycle = 8 * int(np.ceil(max(drive.period * test.speed / step_angle, LEAST_PER_CYCLE) / 8))
    time_step = drive.period / per_cycle
    lead = min(even(RUN_IN / test.speed / time_step), per_cycle)
    steps = per_cycle * test.cycles
    divided = _divided_after_turns(drive, per_cycle, lead + steps, yielding + bristle_reversal_angle(gear))
    pitches = 2 * test.amplitude * gear.pinion.teeth / (2 * np.pi)  # in half a cycle
    before = even(max(LEAST_BEFORE, PER_PITCH_BEFORE * pitches))
    approach = SwingApproach(drive.period / 2, before)
    return Maneuver(drive, time_step, lead, steps, approach=approach, closes=True, divided=divided)


def _divided_after_turns(drive: Swing, per_cycle: int, steps: int, yielding: float) -> Division:
    """Return how the steps of a swing are divided; a turn lies at the end of a step."""
    part = float(np.sqrt(2 * yielding / drive.amplitude))  # phase from a turn, about which A phase^2 / 2
    phase = 2 * np.pi / per_cycle
    parts = max(1, int(np.ceil(STEPS_OF_YIELDING * phase / part)))
    near = even(min(part, np.pi / 2) / phase)
    turns = int(np.ceil(2 * steps / per_cycle))  # as many half cycles as the steps need, and more
    whole = ((per_cycle // 4, 1), *turns * ((near, parts), (per_cycle // 2 - near, 1)))
    return merged(first_of(whole, steps))


def first_of(divided: Division, steps: int) -> Division:
    """Return the first steps of a division."""
    ends = np.minimum(np.cumsum([each for each, _ in divided]), steps)
    lengths = np.diff(ends, prepend=0).tolist()
    return tuple((length, parts) for length, (_, parts) in zip(lengths, divided, strict=True) if length)


def merged(divided: Division) -> Division:
    """Return the same division, neighbours with equal parts as one stretch."""
    alike = groupby(divided, key=lambda stretch: stretch[1])
    return tuple((sum(steps for steps, _ in stretches), parts) for parts, stretches in alike)


def whole_periods(gear: SteeringGear, angle: float) -> int | None:
    """Return how many periods of the gear an angle [rad] covers; None if not a whole number.

    Every tooth is alike, so that the curve repeats with the tooth pitch; errors that single out a tooth
    or a direction of the pinion, or a surface from a file, make it repeat with the turn. It does not where
    the rack changes along the travel.
    """
    if changes_along_travel(gear):
        return None
    pinion, grid = gear.pinion, measured_flanks(gear).pinion
    alike = pinion.runout == 0 and pinion.pitch_error == 0 and not pinion.pitch_errors and not pinion.surface
    alike &= grid is None or not grid.is_of_each_tooth
    periods = angle / (2 * np.pi) * (gear.pinion.teeth if alike else 1)
    return round(periods) if periods > 0.5 and abs(periods - round(periods)) < 1e-9 * periods else None


def changes_along_travel(gear: SteeringGear) -> bool:
    """Return whether a gear's rack is not the same from tooth to tooth: its bar is not straight, its teeth
    have errors or come from a file, its ratio varies, or its back slopes."""
    rack = gear.rack
    listed = rack.bow or rack.pitch_errors or rack.back_parallelism or rack.surface
    return bool(listed) or not rack.ratio.is_constant or measured_flanks(gear).change_along_travel
