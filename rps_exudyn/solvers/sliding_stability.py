"""The damping of the column below which steady sliding is unstable, of one inertia and of the whole gear.

The limits of `analysis.friction_oscillator` hold for one inertia. A rack yields sideways and rolls as it
vibrates, and friction across the sliding damps that: less damping of the column is enough. How much less
follows from the forces of the whole gear, linearised about steady sliding; nothing is integrated. Bristles
count as Stribeck's law in this difference, and by their own margin in the limit itself.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq

from rps_exudyn.analysis.friction_oscillator import Oscillator, Rubbing
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.forces.rigid_motion import rotation_matrix, spin_map
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS, FrictionLaw
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import SIZE, eigenvalues, slopes
from rps_exudyn.solvers.closed_form import closed_form
from rps_exudyn.solvers.drive import Steady
from rps_exudyn.solvers.gear_forces import GearForces, following_inertia, gear_forces
from rps_exudyn.solvers.settled_start import SteadyApproach, settled_path

PERIODS = 9  # natural periods over which the gear is linearised
PITCHES = 4  # that lead there
NEAR = 0.3  # of the column's natural frequency, within which its vibration is looked for
TOLERANCE = 1e-3  # of the damping sought


def one_inertia_damping(gear: SteeringGear) -> float:
    """Return the damping of the column at which the reduced gear's vibration about steady sliding neither
    grows nor decays [N m s/rad]; nan where it is stable without any."""
    model, presliding, speed = reduced_gear(gear), presliding_angle(gear), gear.test.speed
    if not presliding:
        return model.linear_limit(speed) or np.nan
    damping = np.linspace(0, 1.2 * max(model.linear_limit(speed), 1e-9), 121)
    margins = np.array([replace(model, damping=each).bristle_margin(speed, presliding) for each in damping])
    unstable = np.flatnonzero(margins < 0)
    if not unstable.size or unstable[-1] + 1 == damping.size:
        return float("nan")
    last = slice(unstable[-1], unstable[-1] + 2)
    return float(np.interp(0.0, margins[last], damping[last]))


def sliding_damping(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the same of the whole gear; 0 where one inertia is stable without any, nan where the gear finds
    no equilibrium about which it could be linearised."""
    falling, alone = reduced_gear(gear).linear_limit(gear.test.speed), one_inertia_damping(gear)
    return 0.0 if np.isnan(alone) else max(0.0, alone + linearised_damping(gear, fidelity) - falling)


def linearised_damping(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the same with friction that depends on speed alone, up to three times what one inertia needs; 0
    where the gear is stable without any, nan without an equilibrium."""
    laws = {f"{part}.friction_law": getattr(gear, part).facts.at_speed for part in RUBBING_PARTS}
    gear = gear.replace(laws)
    vibration = Vibration.of(gear, fidelity)
    if vibration is None:
        return float("nan")
    most = 3 * reduced_gear(gear).linear_limit(gear.test.speed)
    if not vibration.growth(0.0) > 0:
        return 0.0
    if vibration.growth(most) > 0:
        return most
    return float(brentq(vibration.growth, 0.0, most, xtol=TOLERANCE * most))


@dataclass(frozen=True, eq=False)
class Vibration:
    """A gear behind its column, linearised at instants of steady sliding.

    Attributes:
        mass: of all coordinates, (n, n).
        by_place: forces by coordinates at the instants, (PERIODS + 1, n, n), the column's spring among them.
        by_rate: forces by rates, the column's damping not among them.
        frequency: of gear and column as one inertia [rad/s].
    """

    mass: np.ndarray
    by_place: np.ndarray
    by_rate: np.ndarray
    frequency: float

    @classmethod
    def of(cls, gear: SteeringGear, fidelity: Fidelity) -> "Vibration | None":
        """Linearise over natural periods from the test's start on; None without an equilibrium there."""
        model, test = reduced_gear(gear), gear.test
        forces = gear_forces(gear, _condensed(fidelity))
        time = np.linspace(0, PERIODS * 2 * np.pi / model.frequency, PERIODS + 1)
        bar, pitch = RackBar.of(gear), 2 * np.pi / gear.pinion.teeth / test.speed
        behind = bar.largest_displacement / bar.pair.gain + test.direction * test.start_angle
        approach = SteadyApproach(pitch, min(PITCHES * pitch, max(0.0, float(behind)) / test.speed))
        drive = Steady("pinion", test.start_angle, test.direction * test.speed)
        path = settled_path(forces.statics, GearPair.of(gear), drive, approach, time)
        if not path.converged:
            return None
        by_place, by_rate = slopes(forces.dynamics, path.coordinates, path.rates)
        by_place[:, 0, 0] -= model.stiffness
        free = np.array([i for i in range(by_place.shape[1]) if i not in forces.locked])
        mass, at = masses(gear, forces, path.coordinates[0]), np.ix_(free, free)
        by_place, by_rate = (np.array([each[at] for each in every]) for every in (by_place, by_rate))
        return cls(mass[at], by_place, by_rate, model.frequency)

    def growth(self, damping: float) -> float:
        """Return the growth rate of a vibration near the natural frequency [1/s], its mean over the instants,
        with a damping of the column [N m s/rad]."""
        damped = self.by_rate.copy()
        damped[:, 0, 0] -= damping
        values = eigenvalues(self.mass, self.by_place, damped)
        near = np.abs(np.abs(values.imag) / self.frequency - 1) < NEAR
        return float(np.mean(np.where(near, values.real, -self.frequency).max(axis=1)))


def masses(gear: SteeringGear, forces: GearForces, place: np.ndarray) -> np.ndarray:
    """Return the mass matrix of pinion, rack, plunger and modes at a place (n,), shape (n, n)."""
    mass = np.eye(place.size)
    mass[0, 0], bar = following_inertia(gear)[0], rack_masses(gear)
    angles = place[COORDINATE_BLOCKS["rack"]][3:]
    turn, spin = rotation_matrix(angles), spin_map(angles)
    x, y, z = turn @ bar.centre_of_mass
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    about_point = turn @ bar.inertia @ turn.T - bar.mass * cross @ cross
    beside = -bar.mass * cross @ spin
    rack = COORDINATE_BLOCKS["rack"]
    mass[rack, rack] = np.block([[bar.mass * np.eye(3), beside], [beside.T, spin.T @ about_point @ spin]])
    mass[SIZE - 1, SIZE - 1] = gear.yoke.plunger_mass
    return mass


def _condensed(fidelity: Fidelity) -> Fidelity:
    """The same with a bush that has no coordinates of its own, and teeth whose contact is smooth."""
    coarse = {"bush": "condensed"} if "chain" in fidelity.bush else {}
    return fidelity.replace(coarse | ({"mesh": "flank"} if fidelity.mesh == "general-contact" else {}))


# --- The gear behind its steering column, reduced to one inertia on a spring, with the friction of its parts.
# Pinion and rack turn together at the gear's gain. What each part takes is the closed form's; it slides with
# its lever times the pinion's speed: the teeth with the levers of their friction along the path of contact,
# evenly loaded, plunger and bush with the rack, the bearing with the shaft.

LEVERS = 5  # Gauss points along the path of contact


def reduced_gear(gear: SteeringGear) -> Oscillator:
    """Return the reduced model of a gear and its column; parts by law coulomb are no larger at rest."""
    gain, (pinion, rack) = float(GearPair.of(gear).gain), following_inertia(gear)
    parts = tuple(_part(law, torque, lever) for law, torque, lever in _parts(gear))
    column = gear.column
    return Oscillator(pinion + rack * gain**2, column.stiffness, column.damping, parts)


def presliding_angle(gear: SteeringGear) -> float:
    """Return the pinion angle over which bristles turn about [rad], the mean over the parts weighed with
    their friction; 0 without bristles."""
    parts = [(law, torque, lever) for law, torque, lever in _parts(gear) if torque > 0 and lever > 0]
    yielding = [torque * law.bristle_travel / lever for law, torque, lever in parts if law.facts.has_state]
    whole = sum(torque for _, torque, _ in parts)
    return float(np.sum(yielding) / whole) if whole else 0.0


def _parts(gear: SteeringGear) -> list[tuple[FrictionLaw, float, float]]:
    """Law, torque [N m] and lever [m] of what rubs."""
    formulas, pair = closed_form(gear), GearPair.of(gear)
    mean, gain = formulas.towards(gear.test.direction), float(pair.gain)
    node, weight = leggauss(LEVERS)
    first, last = pair.active_path
    levers = friction_levers(pair, first + (last - first) * (1 + node) / 2)
    shares = weight * levers / (weight @ levers)
    return [
        *(
            (gear.mesh, mean.mesh_loss * float(f), float(lever))
            for f, lever in zip(shares, levers, strict=True)
        ),
        (gear.yoke, mean.plunger_loss, gain),
        (gear.bush, mean.bush_loss, gain),
        (gear.bearing, mean.bearing_loss, gear.pinion.shaft_diameter / 2),
    ]


def friction_levers(pair: GearPair, place: np.ndarray) -> np.ndarray:
    """Return sliding speed over pinion speed at places on the path of contact, from the pitch point (n,) [m]:
    l^2 = l_s^2 + q^2 + 2 q l_s sin(alpha_t) sin(beta_p), as in `closed_form.mean_lever`."""
    along = -pair.reference_radius * np.sin(pair.delta) / np.cos(pair.beta_r)
    turned = np.sin(pair.alpha_t) * np.sin(pair.beta_p)
    return np.asarray(np.sqrt(along**2 + place**2 + 2 * place * along * turned))


def _part(law: FrictionLaw, torque: float, lever: float) -> Rubbing:
    ratio = law.static_ratio if law.facts.falls else 1.0
    return Rubbing(max(torque, 0.0), ratio, law.stribeck_speed / max(lever, 1e-9), law.stribeck_exponent)
