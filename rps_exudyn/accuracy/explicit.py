"""The gear's motion by Runge and Kutta's explicit method of fourth order: a witness independent of Exudyn's.

The forces are those of the model, the masses those of its Exudyn system; step, method and code are others.
The step must be short against the fastest motion, that of the plunger between its contacts (3e-5 s), so a
revolution takes hundreds of times the force evaluations of implicit steps: for references, not for work.
"""

from collections.abc import Callable

import numpy as np

from rps_exudyn.drive import Drive
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.gear_kernel import STACK
from rps_exudyn.gears.polyhedron import MassProperties
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.model import build_model
from rps_exudyn.parameters import SteeringGear
from rps_exudyn.parts.load import DeadForceData, Pulse, dead_force
from rps_exudyn.parts.motion import rotation_matrix, spin_map
from rps_exudyn.record import Record, signals_of
from rps_exudyn.scenes.scene_run import Signals
from rps_exudyn.solve import SolverPlan, solve


def explicit_motion(
    gear: SteeringGear,
    fidelity: Fidelity,
    drive: Drive,
    *,
    step: float,
    steps: int,
    keep: int = 1,
    pulse: Pulse | None = None,
) -> Signals:
    """Signals of a steadily driven or held gear from its equilibrium; every `keep`-th step [s] is kept.

    The bush must be condensed. Nothing is judged here.
    """
    model = build_model(gear, fidelity, drive, pulse=pulse)
    force, data = model.forces.dynamics
    q, v = model.start.coordinates[0].copy(), model.start.rates[0].copy()
    model.mbs.Assemble()
    solve(model.mbs, SolverPlan(end_time=1e-6, steps=1))  # so that the masses are there
    mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
    moving = np.array([i for i in range(q.size) if i not in (drive.coordinate, *model.forces.locked)])
    model.release()
    rack = STACK["rack"]
    bar = rack_solid(gear).mass_properties

    def inverse_mass(q: np.ndarray) -> np.ndarray:
        """The rack's masses turn with it."""
        turned = mass.copy()
        turned[rack, rack] = rigid_mass(q[rack][3:], bar)
        return np.asarray(np.linalg.inv(turned[np.ix_(moving, moving)]))

    def acceleration(t: float, q: np.ndarray, v: np.ndarray, inverse: np.ndarray) -> np.ndarray:
        forces = np.array(force(q, v, data))
        if pulse is not None and (shake := pulse.force(t)).any():
            dead = DeadForceData((shake[0], shake[1], shake[2]), pulse.place)
            forces[rack] += dead_force(q[rack], v[rack], dead)[:6]
        forces[rack] -= centrifugal(q[rack][3:], v[rack][3:], bar)
        a = np.zeros(q.size)
        a[moving] = inverse @ forces[moving]
        return a

    times, places, rates = _runge_kutta(acceleration, inverse_mass, q, v, step, steps, keep)
    driven = np.array([force(*state, data)[drive.coordinate] for state in zip(places, rates, strict=True)])
    no_energy = np.zeros(times.size)  # kinetic: not asked for
    record = Record(model.forces.elements, times, places, rates, -drive.sign * driven, drive.body, no_energy)
    return signals_of(record)


def rigid_mass(angles: np.ndarray, body: MassProperties) -> np.ndarray:
    """Mass matrix (6, 6) of a rigid body over the rates of its reference point and of its rotation angles."""
    turn, spin = rotation_matrix(angles), spin_map(angles)
    arm = turn @ body.centre_of_mass
    cross = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
    about_point = turn @ body.inertia @ turn.T - body.mass * cross @ cross
    beside = -body.mass * cross @ spin
    return np.block([[body.mass * np.eye(3), beside], [beside.T, spin.T @ about_point @ spin]])


def centrifugal(angles: np.ndarray, rates: np.ndarray, body: MassProperties) -> np.ndarray:
    """What goes with the squares of the angles' rates in the equations of `rigid_mass`, (6,)."""
    turn, spin, short = rotation_matrix(angles), spin_map(angles), 1e-6
    arm, omega = turn @ body.centre_of_mass, spin @ rates
    bent = (spin_map(angles + short * rates) - spin) @ rates / short
    about_point = turn @ body.inertia @ turn.T + body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    pull = body.mass * (np.cross(bent, arm) + np.cross(omega, np.cross(omega, arm)))
    return np.concatenate([pull, spin.T @ (about_point @ bent + np.cross(omega, about_point @ omega))])


def _runge_kutta(
    acceleration: Callable[[float, np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    inverse_mass: Callable[[np.ndarray], np.ndarray],
    q: np.ndarray,
    v: np.ndarray,
    step: float,
    steps: int,
    keep: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (n,), places and rates (n, size)."""
    kept = [(0.0, q, v)]
    for k in range(steps):
        t, half, inverse = k * step, step / 2, inverse_mass(q)
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
