"""The limit of steady sliding behind a column of a gear whose rack yields in its guides, by eigenvalues.

The limits of `analysis.stick_slip` know one inertia. A rack yields sideways and rolls as it vibrates, and
friction across the sliding damps that: less damping of the column is enough. How much less, the whole gear
says, its forces linearised about steady sliding; nothing is integrated. Bristles count as Stribeck's law in
this difference, and by their own margin in the limit itself.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.drive import Steady
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.solvers.reduced_gear import reduced_gear
from rps_exudyn.solvers.settled_start import SteadyApproach, settled_path
from rps_exudyn.verification.plan_reference import NotFoundError
from rps_exudyn.verification.runge_kutta import FreeMotion
from rps_exudyn.verification.sliding_limit import PERIODS, predicted_damping

NEAR = 0.3  # of the column's natural frequency, within which its vibration is looked for
TOLERANCE = 1e-3  # of the damping sought
PARTS = ("mesh", "yoke", "bush", "bearing")


def damping_with_guides(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the damping of the column at which small vibrations neither grow nor decay [N m s/rad]; nan
    where one inertia is stable without any.

    Raises:
        NotFoundError: the gear finds no equilibrium.
    """
    falling = reduced_gear(gear).linear_limit(gear.test.speed)
    return predicted_damping(gear) + linearised_damping(gear, fidelity) - falling


def linearised_damping(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the same of the whole gear with friction that knows the speed alone, bisected up to three times
    what one inertia needs; 0 where it is stable without any.

    Raises:
        NotFoundError: the gear finds no equilibrium.
    """
    bristles = [part for part in PARTS if getattr(gear, part).friction_law == "bristle"]
    gear = gear.replace({f"{part}.friction_law": "stribeck" for part in bristles})
    vibration = Vibration.of(gear, fidelity)
    low, high = 0.0, 3 * reduced_gear(gear).linear_limit(gear.test.speed)
    while high - low > TOLERANCE * high:
        middle = (low + high) / 2
        low, high = (middle, high) if vibration.growth(middle) > 0 else (low, middle)
    return (low + high) / 2


@dataclass(frozen=True, eq=False)
class Vibration:
    """A gear behind its column, linearised at instants of steady sliding.

    Attributes:
        mass: of all coordinates, (8, 8).
        by_place: forces by coordinates at the instants, (n, 8, 8), the column's spring among them.
        by_rate: forces by rates, the column's damping not among them.
        frequency: of gear and column as one inertia [rad/s].
    """

    mass: np.ndarray
    by_place: np.ndarray
    by_rate: np.ndarray
    frequency: float

    @classmethod
    def of(cls, gear: SteeringGear, fidelity: Fidelity) -> "Vibration":
        """Linearise over as many natural periods as `sliding_limit.growth` measures.

        Raises:
            NotFoundError: the gear finds no equilibrium.
        """
        forces, speed, model = gear_forces(gear, fidelity), gear.test.speed, reduced_gear(gear)
        time = np.linspace(0, PERIODS * 2 * np.pi / model.frequency, PERIODS + 1)
        pitch = 2 * np.pi / gear.pinion.teeth / speed
        drive, approach = Steady("pinion", gear.test.start_angle, speed), SteadyApproach(pitch, 4 * pitch)
        path = settled_path(forces.statics, GearPair.of(gear), drive, approach, time)
        if not path.converged:
            raise NotFoundError(f"no equilibrium at {path.lost_at:.4g} s")
        tangent, (_, data) = forces.dynamics_tangent, forces.dynamics
        by_place, by_rate = (
            np.array(
                [tangent(q, v, data, *factors) for q, v in zip(path.coordinates, path.rates, strict=True)]
            )
            for factors in ((1.0, 0.0), (0.0, 1.0))
        )
        by_place[:, 0, 0] -= model.stiffness
        mass = FreeMotion.of(gear, fidelity, Steady("pinion", 0.0, 0.0)).mass
        return cls(mass, by_place, by_rate, model.frequency)

    def growth(self, damping: float) -> float:
        """Return the growth rate of a vibration near the natural frequency [1/s], its mean over the instants,
        with a damping of the column [N m s/rad]."""
        n = len(self.mass)
        rates = []
        for by_place, by_rate in zip(self.by_place, self.by_rate, strict=True):
            damped = by_rate.copy()
            damped[0, 0] -= damping
            accelerations = np.linalg.solve(self.mass, np.hstack([by_place, damped]))
            system = np.vstack([np.eye(n, 2 * n, n), accelerations])
            values = np.linalg.eigvals(system)
            near = np.abs(np.abs(values.imag) / self.frequency - 1) < NEAR
            rates.append(values.real[near].max())
        return float(np.mean(rates))
