"""The largest step of explicit integration: predicted from the linearised gear, and seen in disturbed runs.

    driven = DrivenGear.of("rack", "mesh.stiffness", 1e14)
    driven.predicted                                # stable_step(state_matrix(driven.motion), runge_kutta_4)
    bisected(driven.calms, 0.5 * driven.predicted, 2 * driven.predicted)

In each step a method multiplies every mode exp(lambda t) of the linearised system by its growth factor
R(h lambda): it is stable as long as it lets none grow that does not grow by itself (Hairer & Wanner, Solving
Ordinary Differential Equations II, IV.2).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import CHARACTERISTIC_LENGTHS
from rps_exudyn.solvers.prescribed_motion import DrivenBody, Steady, travel_per_radian
from verification.law_area import by_law
from verification.runge_kutta import FreeMotion, runge_kutta

GEAR = by_law(SteeringGear(), "area")  # whose stiffness is varied

SEARCHED = np.geomspace(0.05, 5.0, 2000)  # h |lambda|; the bounds of both methods lie between 2 and 3
KICK = 1e-3  # of a speed below which nothing changes its nature: that of the friction zone
TENFOLD = 10.0
STEPS = 400

Growth = Callable[[np.ndarray], np.ndarray]


def explicit_euler(z: np.ndarray) -> np.ndarray:
    """Growth factor of explicit Euler per step over z = h lambda."""
    return 1 + z


def runge_kutta_4(z: np.ndarray) -> np.ndarray:
    """Growth factor of RK4 per step: stable to 2.83 for pure oscillation, to 2.79 for pure damping."""
    return 1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)))


def state_matrix(motion: FreeMotion) -> np.ndarray:
    """Return A (2n, 2n) of d/dt (displacements, rates) = A (displacements, rates) where a motion starts."""
    stiffness, damping = _by_inertia(motion)
    n = len(stiffness)
    return np.block([[np.zeros((n, n)), np.eye(n)], [stiffness, damping]])


def largest_frequency(motion: FreeMotion) -> float:
    """Return omega_max of masses and stiffnesses alone [rad/s]."""
    stiffness, _ = _by_inertia(motion)
    return float(np.sqrt(np.abs(np.linalg.eigvals(stiffness)).max()))


def largest_damping(motion: FreeMotion) -> float:
    """Return c_max of masses and dampers alone [1/s], with friction's mu N / (m_eff v) by Coulomb's law."""
    _, damping = _by_inertia(motion)
    return float(np.abs(np.linalg.eigvals(damping)).max())


def _by_inertia(motion: FreeMotion) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations over displacements and over rates of what moves, (n, n) each."""
    inverse = np.linalg.inv(motion.moving_mass(motion.place))
    by_place, by_rate = motion.moving_slopes(motion.place, motion.rate)
    return inverse @ by_place, inverse @ by_rate


def stable_step(matrix: np.ndarray, growth: Growth) -> float:
    """Largest step [s] at which a method lets no mode of a system grow that does not grow by itself."""
    steps = [np.inf]
    for mode in np.linalg.eigvals(matrix):
        if mode == 0:
            continue
        h = SEARCHED / abs(mode)
        grows = np.abs(growth(h * mode)) > np.maximum(1.0, np.exp(h * mode.real)) * (1 + 1e-6)
        if grows.any():
            steps.append(float(h[grows.argmax()]))
    return min(steps)


def disturbance_dies(motion: FreeMotion, step: float, speed: float, steps: int = STEPS) -> bool:
    """Return whether a kick of a thousandth of `speed` [m/s] to all that moves grows less than tenfold in a
    run of classical Runge-Kutta with that step [s]."""
    kick = np.zeros(motion.rate.size)
    kick[motion.moving] = KICK * speed / CHARACTERISTIC_LENGTHS[motion.moving]
    with np.errstate(all="ignore"):
        (_, _, usual), (_, _, kicked) = (
            runge_kutta(motion, rate, step, steps, steps) for rate in (motion.rate, motion.rate + kick)
        )
        apart = np.abs((kicked[-1] - usual[-1]) * CHARACTERISTIC_LENGTHS)[motion.moving].max()
    return bool(apart <= TENFOLD * KICK * speed)


# --- of a driven gear --------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class DrivenGear:
    """A gear driven from its centre at the test's speed, or held there, for RK4."""

    gear: SteeringGear
    fidelity: Fidelity
    motion: FreeMotion

    @classmethod
    def of(
        cls, driven: str, path: str, value: float, choices: Mapping[str, Any] = MappingProxyType({})
    ) -> "DrivenGear":
        """Change one parameter; `choices` are those of the fidelity besides."""
        choice = path.removeprefix("fidelity.")
        varied = {choice: value} if choice != path else {}
        fidelity = Fidelity().replace({"zone_ratio": 0.1} | dict(choices) | varied)
        gear = GEAR.replace({path: value} if choice == path else {})
        return cls(gear, fidelity, FreeMotion.of(gear, fidelity, _drive(gear, driven)))

    @property
    def zone(self) -> float:
        """Friction zone [m/s]."""
        sliding = GearPair.of(self.gear).least_sliding * self.gear.test.speed
        return float(self.fidelity.zone_ratio * sliding)

    @property
    def predicted(self) -> float:
        """Largest stable step of RK4 [s]."""
        return stable_step(state_matrix(self.motion), runge_kutta_4)

    def calms(self, step: float, steps: int = STEPS) -> bool:
        """Return whether a disturbance dies at that step [s]."""
        return disturbance_dies(self.motion, step, self.zone, steps)


def _drive(gear: SteeringGear, driven: str) -> Steady:
    body: DrivenBody = "rack" if driven == "rack" else "pinion"
    speed = 0.0 if driven == "nothing" else gear.test.speed
    return Steady(body, 0.0, travel_per_radian(body, float(GearPair.of(gear).gain)) * speed)


def simple_limits(motion: FreeMotion) -> tuple[float, float]:
    """Stable steps of RK4 for omega_max and for c_max alone [s]: an oscillator, a damper."""
    frequency, damping = largest_frequency(motion), largest_damping(motion)
    oscillator = np.array([[0.0, 1.0], [-(frequency**2), 0.0]])
    return stable_step(oscillator, runge_kutta_4), stable_step(np.array([[-damping]]), runge_kutta_4)
