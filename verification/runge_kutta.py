"""The gear's motion by classical Runge-Kutta (RK4): a method independent of Exudyn's solvers.

The forces are those of the model, the masses those of its Exudyn system; step, method and code are others.
The step must be short compared with the fastest motion, that of the plunger between its contacts (3e-5 s), so
a revolution takes hundreds of times the force evaluations of implicit steps: for references, not for work.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.forces.external_load import TimedForce
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.forces.rigid_motion import rotation_matrix, spin_map
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.gears.polyhedron import MassProperties
from rps_exudyn.multibody.model import build_model
from rps_exudyn.multibody.solve import SolverPlan, solve
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.scene_run import Signals
from rps_exudyn.solvers.balance import SIZE, Balance, slopes
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.prescribed_motion import Drive, Steady
from rps_exudyn.solvers.record import Record, signals_of


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A driven gear for integration: where it starts, which coordinates move freely, masses and forces.

    Coordinates and rates are those of all coordinate blocks and modes, (n,); prescribed ones follow their
    rate.
    """

    forces: GearForces
    drive: Drive
    place: np.ndarray  # at time 0, in equilibrium
    rate: np.ndarray
    moving: np.ndarray  # coordinates that nothing prescribes
    mass: np.ndarray  # (n, n) at the start
    balance: Balance
    bar: MassProperties
    pulse: TimedForce | None = None

    @classmethod
    def of(
        cls, gear: SteeringGear, fidelity: Fidelity, drive: Drive, pulse: TimedForce | None = None
    ) -> "FreeMotion":
        """Take a gear in its equilibrium; the bush must be condensed.

        Raises:
            LinAlgError: there is none where the drive starts.
        """
        model = build_model(gear, fidelity, drive, pulse=pulse)
        if not model.start.converged:
            raise np.linalg.LinAlgError("the gear finds no equilibrium in which its masses could be taken")
        forces = model.forces
        q, v = model.start.coordinates[0].copy(), model.start.rates[0].copy()
        model.mbs.Assemble()
        solve(model.mbs, SolverPlan(end_time=1e-6, steps=1))  # so that the masses are there
        mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
        moving = np.array([i for i in range(q.size) if i not in (drive.coordinate, *forces.locked)])
        model.release()
        return cls(forces, drive, q, v, moving, mass, forces, rack_masses(gear), pulse)

    def moving_mass(self, q: np.ndarray) -> np.ndarray:
        """Mass matrix of the moving coordinates, (m, m); the rack's masses turn with it."""
        turned, rack = self.mass.copy(), COORDINATE_BLOCKS["rack"]
        turned[rack, rack] = rigid_mass(q[rack][3:], self.bar)
        return turned[np.ix_(self.moving, self.moving)]

    def moving_slopes(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Slopes of the forces on the moving coordinates by their places and by their rates, (m, m) each."""
        moving = np.ix_(self.moving, self.moving)
        by_place, by_rate = (each[0][moving] for each in slopes(self.balance, q[None], v[None]))
        return by_place, by_rate

    def acceleration(self, t: float, q: np.ndarray, v: np.ndarray, inverse: np.ndarray) -> np.ndarray:
        """Accelerations of all coordinates, (n,); those of the drive for the prescribed ones."""
        forces, rack = self.balance.force(q, v), COORDINATE_BLOCKS["rack"]
        if self.pulse is not None and (shake := self.pulse.force(t)).any():
            forces[rack] += on_axis(shake, self.pulse.place, q[rack][3:])
            if self.forces.bar is not None:
                forces[SIZE:] += self.forces.bar.on_modes(self.pulse.place) @ shake
        forces[rack] -= centrifugal(q[rack][3:], v[rack][3:], self.bar)
        a, short = np.zeros(q.size), 1e-6  # [s]
        if not isinstance(self.drive, Steady):
            turn = (self.drive.rate(t + short) - self.drive.rate(t - short)) / (2 * short)
            a[self.drive.coordinate] = self.drive.sign * turn
        a[self.moving] = inverse @ forces[self.moving]
        return a

    def recorded(self, times: np.ndarray, places: np.ndarray, rates: np.ndarray) -> Record:
        """Record of a motion with the drive's torque or force."""
        states = zip(places, rates, strict=True)
        driven = np.array([self.balance.force(*state)[self.drive.coordinate] for state in states])
        no_energy = np.zeros(times.size)  # kinetic energy is not needed
        overcome = -self.drive.sign * driven
        return Record(self.forces, times, places, rates, overcome, self.drive.body, no_energy)


def explicit_motion(
    gear: SteeringGear,
    fidelity: Fidelity,
    drive: Drive,
    *,
    step: float,
    steps: int,
    keep: int = 1,
    pulse: TimedForce | None = None,
) -> Signals:
    """Signals of a steadily driven or held gear from its equilibrium; every `keep`-th `step` [s] is kept.

    The bush must be condensed. The run is not checked.
    """
    motion = FreeMotion.of(gear, fidelity, drive, pulse)
    return signals_of(motion.recorded(*runge_kutta(motion, motion.rate, step, steps, keep)))


def on_axis(force: np.ndarray, place: float, angles: np.ndarray) -> np.ndarray:
    """Generalised forces (6,) on a rigid bar of a force (3,) [N] on a point of its axis [m]."""
    lever = place * rotation_matrix(angles)[:, 0]
    return np.concatenate([force, spin_map(angles).T @ np.cross(lever, force)])


def rigid_mass(angles: np.ndarray, body: MassProperties) -> np.ndarray:
    """Mass matrix (6, 6) of a rigid body over the rates of its reference point and of its rotation angles."""
    turn, spin = rotation_matrix(angles), spin_map(angles)
    arm = turn @ body.centre_of_mass
    cross = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
    about_point = turn @ body.inertia @ turn.T - body.mass * cross @ cross
    beside = -body.mass * cross @ spin
    return np.block([[body.mass * np.eye(3), beside], [beside.T, spin.T @ about_point @ spin]])


def centrifugal(angles: np.ndarray, rates: np.ndarray, body: MassProperties) -> np.ndarray:
    """Forces quadratic in the angles' rates in the equations of `rigid_mass`, (6,)."""
    turn, spin, short = rotation_matrix(angles), spin_map(angles), 1e-6
    arm, omega = turn @ body.centre_of_mass, spin @ rates
    bent = (spin_map(angles + short * rates) - spin) @ rates / short
    about_point = turn @ body.inertia @ turn.T + body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    pull = body.mass * (np.cross(bent, arm) + np.cross(omega, np.cross(omega, arm)))
    return np.concatenate([pull, spin.T @ (about_point @ bent + np.cross(omega, about_point @ omega))])


def runge_kutta(
    motion: FreeMotion, rate: np.ndarray, step: float, steps: int, keep: int = 1
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (n,), places and rates (n, .) from the motion's place and a `rate`; every `keep`-th step [s]."""
    acceleration, q, v = motion.acceleration, motion.place, rate
    kept = [(0.0, q, v)]
    for k in range(steps):
        t, half, inverse = k * step, step / 2, np.linalg.inv(motion.moving_mass(q))
        a1 = acceleration(t, q, v, inverse)
        v2 = v + half * a1
        a2 = acceleration(t + half, q + half * v, v2, inverse)
        v3 = v + half * a2
        a3 = acceleration(t + half, q + half * v2, v3, inverse)
        v4 = v + step * a3
        a4 = acceleration(t + step, q + step * v3, v4, inverse)
        q = q + step / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        if (k + 1) % keep == 0:
            kept.append(((k + 1) * step, q, v))
    times, places, rates = (np.array(column) for column in zip(*kept, strict=True))
    return times, places, rates
