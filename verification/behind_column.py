"""The gear behind its steering column, integrated by a method of its own: references for plans of the wheel.

    right = metrics_of_wheel(plan, 1)         # 2: in steps half as long

Both stages of Alexander's singly diagonally implicit Runge-Kutta method (SIAM J. Numer. Anal. 14 (1977),
1006), of second order and L-stable, are solved by Newton's method; a step that it does not solve is halved.
The wheel is prescribed; start, balance and metrics are written anew: of what the package does, the forces of
gear and column are taken, integrated finely and with a friction zone of a thousandth of the speed. Two
lengths of steps say how far the metrics can be trusted.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil
from typing import Any, NamedTuple

import numpy as np

from rps_exudyn.forces.friction import PLACES, TIME
from rps_exudyn.forces.pinion_support import with_float
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.contact_law import resolve_contact_law
from rps_exudyn.scenes.stick_slip import set_off
from rps_exudyn.solvers.balance import Balance
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.prescribed_motion import Steady, Swing
from rps_exudyn.solvers.sliding_stability import reduced_gear
from rps_exudyn.solvers.steering_column import ColumnModel
from verification.refined_steps import NotFoundError
from verification.runge_kutta import FreeMotion
from verification.stability import ScenePlan, cpu_time_limit

GAMMA = 1 - np.sqrt(0.5)
FINE = {
    "solver": "equilibrium", "bush": "condensed", "strip_stations": 12, "strip_points": 6, "zone_ratio": 1e-3
}  # fmt: skip
CLOSE = 1e-4  # residual left [N], moments over 10 mm: a tenth of the equilibria's
ITERATIONS, SLOW = 12, 0.3  # of Newton's method, and the share left above which it takes a new tangent
HALVINGS = 14
FINER = (1, 2, 4)  # times that steps are shorter, until two in a row ...
ALIKE = 0.01  # ... differ by no more of the metrics
LENGTHS = np.array([0.01, 1, 1, 1, 0.01, 0.01, 0.01, 1])


class Wheel(NamedTuple):
    """A motion of the wheel: angle [rad] and rate [rad/s] at times [s]."""

    place: Callable[[Any], np.ndarray]
    rate: Callable[[Any], np.ndarray]


@dataclass(eq=False)
class Behind:
    """The gear's state while it is integrated behind a moved wheel; coordinates as in `gear_model`."""

    wheel: Wheel
    column: ColumnModel
    balance: Balance
    mass: np.ndarray  # (m, m) of the moving coordinates
    moving: np.ndarray
    time: float
    place: np.ndarray  # (8,)
    rate: np.ndarray

    @classmethod
    def at_rest(cls, plan: ScenePlan, wheel: Wheel) -> "Behind":
        """Begin in the equilibrium of a gear that rests behind an untwisted column.

        Raises:
            NotFoundError: there is none.
        """
        gear, fidelity = plan.gear, plan.fidelity.replace(FINE)
        forces, column = gear_forces(gear, fidelity), ColumnModel.of(gear)
        still = Steady("pinion", float(column.output(wheel.place(0.0))), 0.0)
        path = equilibrium_path(forces.statics, GearPair.of(gear), still, np.zeros(1))
        if not path.converged:
            raise NotFoundError("no equilibrium at the start")
        motion = FreeMotion.of(gear, fidelity, Steady("pinion", float(still.start), 0.0))
        moving = np.array([i for i in range(8) if i not in forces.locked])
        balance = forces
        if balance.has_bristles:
            balance.memory[0] = balance.memory[1]
            balance.memory[0, TIME] = 0.0
            balance.memory[0, PLACES : PLACES + 8] = path.coordinates[0]
        return cls(
            wheel,
            column,
            balance,
            motion.mass[np.ix_(moving, moving)],
            moving,
            0.0,
            path.coordinates[0].copy(),
            np.zeros(8),
        )

    def torque(self, time: float, place: np.ndarray, rate: np.ndarray) -> float:
        """Return the column's torque on the pinion [N m]."""
        angle = self.wheel.place(time)
        turning = self.column.ratio(angle) * self.wheel.rate(time)
        return float(self.column.torque(self.column.output(angle) + place[0], turning + rate[0]))

    def wheel_torque(self) -> float:
        """Return the torque with which the column resists the wheel [N m]: a joint turns the pinion faster or
        more slowly than the wheel, and the work is the same."""
        ratio = float(self.column.ratio(self.wheel.place(self.time)))
        return ratio * self.torque(self.time, self.place, self.rate)

    def _forces(self, time: float, place: np.ndarray, rate: np.ndarray) -> np.ndarray:
        self.balance.memory[1, TIME] = time
        total = self.balance.force(place, rate)
        total[0] -= self.torque(time, place, rate)
        return total[self.moving]

    def _slope(self, time: float, h: float, place: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Derivative of a stage's residual by its rates."""
        self.balance.memory[1, TIME] = time
        by_rate = self.balance.tangent(place, rate, h, 1.0)
        by_rate[0, 0] -= h * self.column.stiffness + self.column.damping
        return np.asarray(self.mass / h - by_rate[np.ix_(self.moving, self.moving)])

    def _stage(
        self, time: float, h: float, place: np.ndarray, rate: np.ndarray, guess: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Solve M (v - rate) / h = F(place + h v, v) for place and rate at a time; None where it fails."""
        m, lengths = self.moving, LENGTHS[self.moving]
        v = guess.copy()

        def left(v: np.ndarray) -> np.ndarray:
            return self.mass @ (v - rate)[m] / h - self._forces(time, place + h * v, v)

        residual = left(v)
        size, inverse = float(np.abs(residual / lengths).max()), None
        for _ in range(ITERATIONS):
            if size <= CLOSE:
                return place + h * v, v
            if inverse is None:
                inverse = np.linalg.inv(self._slope(time, h, place + h * v, v))
            fraction, move = 1.0, inverse @ residual
            while True:
                trial = v.copy()
                trial[m] -= fraction * move
                new = left(trial)
                new_size = float(np.abs(new / lengths).max())
                if new_size < (1 - 0.1 * fraction) * size or fraction < 0.05:
                    break
                fraction *= 0.5
            if not np.isfinite(new_size):
                return None
            if new_size > SLOW * size:
                inverse = None
            v, residual, size = trial, new, new_size
        return None

    def step(self, h: float) -> bool:
        """Go on by a step [s]; false where no stage solves it, the state left as it was."""
        begin, place, rate = self.time, self.place, self.rate
        first = self._stage(begin + GAMMA * h, GAMMA * h, place, rate, rate)
        if first is None:
            return False
        # the second stage starts from what the first added
        share = (1 - GAMMA) / GAMMA
        led = place + share * (first[0] - place), rate + share * (first[1] - rate)
        last = self._stage(begin + h, GAMMA * h, *led, first[1])
        if last is None:
            return False
        self.time, self.place, self.rate = begin + h, *last
        if self.balance.has_bristles:
            self._forces(self.time, self.place, self.rate)
            self.balance.memory[0] = self.balance.memory[1]
        return True

    def go(self, end: float, halvings: int = HALVINGS) -> None:
        """Go on to a time [s].

        Raises:
            NotFoundError: no step is short enough.
        """
        if self.step(end - self.time):
            return
        if not halvings:
            raise NotFoundError(f"no step at {self.time:.5g} s")
        self.go((self.time + end) / 2, halvings - 1)
        self.go(end, halvings - 1)


# --- metrics -----------------------------------------------------------------------------------------
@dataclass(frozen=True)
class WheelMetrics:
    """What a plan of the wheel must show: its main metric, and the largest torque at the wheel [N m]."""

    main_metric: float  # work of a cycle [J], or half the range of the torque over the later half [N m]
    peak: float


def metrics_of_wheel(plan: ScenePlan, finer: int) -> WheelMetrics:
    """Return the metrics of a plan of `steering-feel` or `stick-slip`, in steps divided by a number.

    Raises:
        NotFoundError: it has no start, or steps that nothing solves.
        InputError: the test leaves the rack's teeth.
    """
    if plan.scene == "stick-slip":
        time, torque = _set_off(plan, finer)
        later = torque[time >= time[-1] / 2]
        return WheelMetrics(float(np.ptp(later)) / 2, float(np.abs(torque).max()))
    angle, torque = _swung(plan, finer)
    work = float(np.sum((torque[1:] + torque[:-1]) / 2 * np.diff(angle)))
    return WheelMetrics(work, float(np.abs(torque).max()))


def settled_metrics(plan: ScenePlan, seconds: float) -> tuple[WheelMetrics, int]:
    """Return the first metrics with which those in shorter steps agree, and how much shorter these steps are
    than the longest; each may take so much CPU time [s].

    Raises:
        NotFoundError: there are none, or they go on changing.
        TimeoutError: one takes too long.
    """
    if with_float(plan.gear, plan.fidelity).pinion == "supported":
        raise NotFoundError("the pinion is supported")
    law = scene_named(plan.scene).law
    plan = replace(plan, gear=resolve_contact_law(plan.gear, plan.fidelity, law))
    with cpu_time_limit(seconds):
        before = metrics_of_wheel(plan, FINER[0])
    for finer in FINER[1:]:
        with cpu_time_limit(seconds):
            here = metrics_of_wheel(plan, finer)
        moved = (
            abs(here.main_metric - before.main_metric) / size_of(plan, here),
            abs(here.peak / before.peak - 1),
        )
        if max(moved) <= ALIKE:
            return here, finer
        before = here
    raise NotFoundError("two lengths of its steps differ")


def size_of(plan: ScenePlan, right: WheelMetrics) -> float:
    """Return what an error is counted by: the work of a cycle itself, or the peak of stick-slip's torque."""
    return abs(right.main_metric) if plan.scene == "steering-feel" else right.peak


def _set_off(plan: ScenePlan, finer: int) -> tuple[np.ndarray, np.ndarray]:
    """Time and torque of a wheel that sets off."""
    maneuver = set_off(plan.gear)
    end, period = maneuver.steps * maneuver.time_step, 2 * np.pi / reduced_gear(plan.gear).frequency
    time = np.linspace(0.0, end, ceil(finer * PER_PERIOD * end / period) + 1)
    return time, _torques(plan, Wheel(maneuver.drive.place, maneuver.drive.rate), time)


def _swung(plan: ScenePlan, finer: int) -> tuple[np.ndarray, np.ndarray]:
    """Wheel angle and torque over the second cycle of a swing that begins at rest at one end."""
    test = plan.gear.test
    swing = Swing("wheel", test.start_angle, test.amplitude, test.direction * test.speed)
    before = swing.period / 4
    from_end = Wheel(lambda time: swing.place(time - before), lambda time: swing.rate(time - before))
    # steps are shorter near its ends, where friction turns about
    quarter = before * np.linspace(0, 1, finer * PER_QUARTER + 1) ** 1.5
    half = np.concatenate([quarter, 2 * before - quarter[-2::-1]])
    cycle = np.concatenate([half, 2 * before + half[1:]])
    torque = _torques(plan, from_end, np.concatenate([cycle, swing.period + cycle[1:]]))
    return np.asarray(from_end.place(cycle)), torque[cycle.size - 1 :]


PER_PERIOD, PER_QUARTER = 60, 300  # steps in a natural period, and in a quarter of a swing


def _torques(plan: ScenePlan, wheel: Wheel, time: np.ndarray) -> np.ndarray:
    """The column's torque on the wheel at times from rest on [N m]."""
    state = Behind.at_rest(plan, wheel)
    torques = [state.wheel_torque()]
    for end in time[1:]:
        state.go(float(end))
        torques.append(state.wheel_torque())
    return np.array(torques)
