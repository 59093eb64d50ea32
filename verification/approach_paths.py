"""The passes of a steady test, and equilibria along them that come from far before.

The gear moves from many tooth pitches before a course, until the start does not matter or as far as its teeth
allow, through all of it: no settled start of `solvers.settled_start`, no period that stands for others.
"""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.solvers.balance import NOTHING_ACCELERATED
from rps_exudyn.solvers.equilibrium import EquilibriumPath, equilibrium_path
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.prescribed_motion import Drive, DrivenBody, Steady, travel_per_radian
from verification.refined_steps import NotFoundError
from verification.stability import ScenePlan

PITCHES_BEFORE = (4, 8, 16, 32)  # until two in a row lead to the same force ...
SETTLED = 0.01  # ... up to that part of the largest on the course
STEPS_BEFORE = 12  # per pitch, on the course to the record ...
STEPS = 60  # ... and of the record ...
LEAST_STEPS, MOST_STEPS = 24, 400  # ... fewer of a long one, but no fewer than that; and of all of it
LAST_STEPS, LAST_STEP = 4, 1e-3  # of a pitch, before inertia sets in: for exact rates


@dataclass(frozen=True)
class Pass:
    """One course of a steady test: the body that the rig moves, and pinion angles [rad]."""

    body: DrivenBody
    first: float
    last: float

    @property
    def sense(self) -> int:
        """+1 where the rack moves along +X."""
        return 1 if self.last > self.first else -1

    @property
    def length(self) -> float:
        """Pinion angle turned [rad]."""
        return abs(self.last - self.first)

    def drive(self, gear: SteeringGear) -> Steady:
        """The rig's motion, which passes the course's beginning at time 0."""
        scale = travel_per_radian(self.body, float(GearPair.of(gear).gain))
        return Steady(self.body, scale * self.first, scale * self.sense * gear.test.speed)


def passes_of(plan: ScenePlan) -> list[Pass]:
    """The passes of a test, one after the other."""
    test, gear = plan.gear.test, plan.gear
    body: DrivenBody = "rack" if plan.scene == "rack-push" else "pinion"
    first, last = test.start_angle, test.start_angle + test.direction * 2 * np.pi * test.turns
    if test.path == "lock-to-lock":
        lock = float(gear.rack.travel / 2 / GearPair.of(gear).gain)
        first, last = -test.direction * lock, test.direction * lock
    there_and_back = test.path != "one-way"
    return [Pass(body, first, last), *([Pass(body, last, first)] if there_and_back else [])]


def followed(
    gear: SteeringGear, forces: GearForces, course: Pass, pitches: float, finer: int
) -> tuple[np.ndarray, EquilibriumPath]:
    """Instants of a course, and equilibria from so many pitches before it to its end in steps of which
    `finer` make one."""
    before = instants_before(gear, pitches, 0.0, finer)
    long = course.length * gear.pinion.teeth / (2 * np.pi)
    steps = ceil(finer * long * max(LEAST_STEPS, min(STEPS, MOST_STEPS / long))) + 8
    along = np.linspace(0, course.length / gear.test.speed, steps + 1)
    return along, equilibria_at(gear, forces, course.drive(gear), np.concatenate([before[:-1], along]))


def room_before(gear: SteeringGear, course: Pass) -> float:
    """Pinion angle before a course over which the rack has teeth [rad]."""
    return max(0.0, largest_angle(gear) + course.sense * course.first)


def pitches_before(gear: SteeringGear, forces: GearForces, course: Pass) -> float:
    """Pitches before a course from which the gear moves so that the start does not matter, or all that the
    rack has teeth for.

    Raises:
        NotFoundError: it is not settled from any tried, or no equilibria lead from there.
    """
    drive, room = course.drive(gear), room_before(gear, course) * gear.pinion.teeth / (2 * np.pi)
    left = np.inf
    for pitches in PITCHES_BEFORE:
        if pitches >= room:
            return room
        force = _force_of_approach(gear, forces, drive, instants_before(gear, pitches, 0.0))
        if abs(force[-1] - left) <= SETTLED * np.abs(force).max():
            return pitches
        left = force[-1]
    raise NotFoundError(f"the start still matters after {PITCHES_BEFORE[-1]} pitches")


def _force_of_approach(gear: SteeringGear, forces: GearForces, drive: Drive, time: np.ndarray) -> np.ndarray:
    """The drive's force at equilibria at these instants."""
    return np.asarray(equilibria_at(gear, forces, drive, time).forces[:, drive.coordinate])


def instants_before(gear: SteeringGear, pitches: float, end: float, finer: int = 1) -> np.ndarray:
    """Instants of equilibria from so many pitches before a course to the instant `end` [s], both below or at
    0."""
    pitch = 2 * np.pi / gear.pinion.teeth / gear.test.speed
    begin = -pitches * pitch
    if begin >= end:
        return np.array([end])
    approach = np.linspace(
        begin, end, max(2, ceil((end - begin) / pitch * STEPS_BEFORE * finer)), endpoint=False
    )
    last = end - LAST_STEP * pitch * np.arange(LAST_STEPS, -1, -1)
    return np.concatenate([approach[approach < last[0] - LAST_STEP * pitch], last[last >= begin]])


def equilibria_at(
    gear: SteeringGear,
    forces: GearForces,
    drive: Drive,
    time: np.ndarray,
    masses: np.ndarray = NOTHING_ACCELERATED,
) -> EquilibriumPath:
    """Follow the equilibria at these instants [s], with the inertia of masses (n, n).

    Raises:
        NotFoundError: there is none at one of them.
    """
    balance = replace(forces.statics, masses=masses)
    path = equilibrium_path(balance, GearPair.of(gear), drive, time)
    if not path.converged:
        raise NotFoundError(f"no equilibrium at {path.lost_at:.4g} s, {path.residual:.3g} N remain")
    return path
