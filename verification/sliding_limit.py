"""Where the whole gear's steady sliding behind its column loses its stability: measured by growth, bisected.

The wheel turns at a constant speed and the gear slides settled; then the wheel is nudged by a small angle,
and the vibration of the column's twist grows or decays. The damping between both is the limit that
`solvers.sliding_stability` predicts, of one inertia and of the whole gear.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.solvers.gear_forces import gear_forces, mass_matrix
from rps_exudyn.solvers.prescribed_motion import Steady
from rps_exudyn.solvers.settled_start import SteadyApproach, settled_path
from rps_exudyn.solvers.sliding_stability import PERIODS, reduced_gear
from rps_exudyn.solvers.steering_column import ColumnModel

PER_PERIOD = 60  # steps in a natural period; of the periods of a run ...
FIRST = 1  # ... those from this run on show the vibration
NUDGE = 0.02  # of the angle that the wheel turns in a natural period


@dataclass(frozen=True)
class Nudged(Steady):
    """A motion at constant rate, moved on by a small angle over a time from the start on."""

    angle: float = 0.0  # [rad]
    within: float = 1.0  # [s]

    def place(self, time: np.ndarray | float) -> np.ndarray:
        """Return start + speed t + angle (1 - cos(pi t / within)) / 2."""
        share = np.clip(np.asarray(time) / self.within, 0, 1)
        return super().place(time) + self.angle * (1 - np.cos(np.pi * share)) / 2

    def rate(self, time: np.ndarray | float) -> np.ndarray:
        """Return its time derivative."""
        share = np.clip(np.asarray(time) / self.within, 0, 1)
        return super().rate(time) + self.angle * np.pi / self.within * np.sin(np.pi * share) / 2

    @property
    def of_time(self) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """Place and rate of the driven coordinate as functions of an instant [s]."""
        return (lambda t: self.sign * float(self.place(t))), (lambda t: self.sign * float(self.rate(t)))


def growth(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the growth rate of a small vibration about steady sliding [1/s], below 0 where it decays.

    Raises:
        ArithmeticError: the run failed.
    """
    model, speed = reduced_gear(gear), gear.test.speed
    period = 2 * np.pi / model.frequency
    pitch = 2 * np.pi / gear.pinion.teeth / speed
    drive = Nudged("wheel", gear.test.start_angle, speed, NUDGE * speed * period, period / 2)
    approach = SteadyApproach(pitch, 4 * pitch)
    maneuver = Maneuver(drive, period / PER_PERIOD, 0, PERIODS * PER_PERIOD, approach=approach)
    run = run_maneuver(gear, fidelity, maneuver, options=RunOptions(check=lambda outcome, *checked: outcome))
    if not run.ok:
        raise ArithmeticError(run.outcome.message)
    vibration = _without_drift(run.signals["column_twist"][1:])
    periods = range(FIRST, PERIODS - 1)
    sizes = [float(np.std(vibration[at * PER_PERIOD : (at + 1) * PER_PERIOD])) for at in periods]
    return float(np.polyfit(np.array(periods) * period, np.log(sizes), 1)[0])


def measured_damping(gear: SteeringGear, fidelity: Fidelity, near: float, tolerance: float = 0.01) -> float:
    """Return the damping at which a small vibration neither grows nor decays [N m s/rad], by secants.

    Args:
        near: where to begin [N m s/rad].
        tolerance: share of it to which the limit is found.

    Raises:
        ArithmeticError: a run failed, or no limit is found between a third and three times `near`.
    """
    low, high = near / 3, 3 * near
    rates = [growth(gear.replace({"column.damping": each}), fidelity) for each in (low, high)]
    if not rates[0] > 0 > rates[1]:
        raise ArithmeticError(
            f"growth is {rates[0]:.3g} and {rates[1]:.3g} per s at {low:.3g} and {high:.3g}"
        )
    while high - low > tolerance * near:
        middle = low + (high - low) * float(np.clip(rates[0] / (rates[0] - rates[1]), 0.1, 0.9))
        rate = growth(gear.replace({"column.damping": middle}), fidelity)
        if rate > 0:
            low, rates[0] = middle, rate
        else:
            high, rates[1] = middle, rate
    return (low + high) / 2


STEP = 1e-6  # of motion that shows vibrations of teeth [s]
BEGUN, END = 4e-3, 16e-3  # of that motion, between which growth is measured [s]


def fast_growth(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the growth rate of the pinion's vibration against the teeth about steady sliding [1/s], from
    motion by classical Runge-Kutta after a push of a thousandth of the speed.

    Raises:
        ArithmeticError: there is no equilibrium to start from.
    """
    forces, speed = gear_forces(gear, fidelity), gear.test.speed
    pitch = 2 * np.pi / gear.pinion.teeth / speed
    drive, lead = Steady("pinion", gear.test.start_angle, speed), SteadyApproach(pitch, 4 * pitch)
    path = settled_path(forces.statics, GearPair.of(gear), drive, lead, np.linspace(0, pitch / 400, 5))
    if not path.converged:
        raise ArithmeticError("no equilibrium at the start")
    q, v, column = path.coordinates[-1].copy(), path.rates[-1].copy(), ColumnModel.of(gear)
    free = np.array([i for i in range(q.size) if i not in forces.locked])
    inverse, balance = np.linalg.inv(mass_matrix(gear, forces, q)[np.ix_(free, free)]), forces
    ahead = balance.force(q, v)[0] / column.stiffness - q[0]

    def acceleration(time: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        found, total = np.zeros(q.size), balance.force(q, v)
        total[0] -= column.torque(ahead + speed * time + q[0], speed + v[0])
        found[free] = inverse @ total[free]
        return found

    v[0] *= 1.001
    steps, rates = int(END / STEP), []
    for i in range(steps):
        time = i * STEP
        first = acceleration(time, q, v)
        second = acceleration(time + STEP / 2, q + STEP / 2 * v, v + STEP / 2 * first)
        third = acceleration(time + STEP / 2, q + STEP / 2 * v + STEP**2 / 4 * first, v + STEP / 2 * second)
        last = acceleration(time + STEP, q + STEP * v + STEP**2 / 2 * second, v + STEP * third)
        q = q + STEP * v + STEP**2 / 6 * (first + second + third)
        v = v + STEP / 6 * (first + 2 * second + 2 * third + last)
        rates.append(v[0])
    fast = np.diff(rates, 2)[int(BEGUN / STEP) :]  # slow vibration hardly bends
    sizes = [float(np.std(part)) for part in np.array_split(fast, 6)]
    return float(np.polyfit(np.arange(6) * (END - BEGUN) / 6, np.log(sizes), 1)[0])


def _without_drift(values: np.ndarray) -> np.ndarray:
    """The values less their mean over a natural period about each, which the torque's ripple hardly moves."""
    mean = np.convolve(np.pad(values, PER_PERIOD // 2, mode="edge"), np.ones(PER_PERIOD) / PER_PERIOD, "same")
    return np.asarray(values - mean[PER_PERIOD // 2 : PER_PERIOD // 2 + values.size])
