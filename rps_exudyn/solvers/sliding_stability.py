"""The damping of the column below which steady sliding is unstable, of one inertia and of the whole gear.

The limits of `analysis.friction_oscillator` are those of one inertia. A rack yields sideways and rolls as it
vibrates, and friction across the sliding damps that; the pinion vibrates against the teeth too, and friction
that falls feeds that. The limit of the whole gear follows from the eigenvalues of its forces, linearised
about steady sliding over a tooth pitch; nothing is integrated. Bristles count as Stribeck's law, which they
follow in steady sliding.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.friction_oscillator import Oscillator
from rps_exudyn.forces.friction import ELEMENT_TRAVELS
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.masses import pinion_inertia, rack_masses
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import slopes, state_matrix
from rps_exudyn.solvers.closed_form import friction_over_speed, sliding_parts
from rps_exudyn.solvers.gear_forces import gear_forces, mass_matrix
from rps_exudyn.solvers.prescribed_motion import Steady
from rps_exudyn.solvers.settled_start import SteadyApproach, settled_path
from rps_exudyn.solvers.steering_column import ColumnModel

PERIODS = 9  # natural periods over which growth is averaged
INSTANTS = 64  # of a tooth pitch at which the gear is linearised
PITCHES = 4  # that lead there
RANGE = 3.0  # times the damping that one inertia needs, over which that of the gear is sought ...
TRIED = 13  # ... at so many dampings, and at as many between two of them
QUICK = 6.0  # times in the natural period over 2 pi that bristles turn about across the sliding
CURED = 0.5  # of the growth that damping takes from one inertia: it takes so much from what it cures


def one_inertia_damping(gear: SteeringGear) -> float:
    """Return the damping of the column at which the reduced gear's vibration about steady sliding neither
    grows nor decays [N m s/rad]; nan where it is stable without any."""
    return reduced_gear(gear).linear_limit(gear.test.speed) or np.nan


def sliding_damping(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the same of the whole gear; 0 where one inertia is stable without any, nan where there is no
    equilibrium about which the gear could be linearised, and on bristles that turn about too slowly across
    the sliding to damp the guides as Stribeck's law does."""
    if np.isnan(one_inertia_damping(gear)):
        return 0.0
    over_travel = ELEMENT_TRAVELS[0][0] * presliding_angle(gear) / gear.test.speed  # [s]
    slow = over_travel * reduced_gear(gear).frequency * QUICK > 1
    return float("nan") if slow else linearised_damping(gear, fidelity)


def linearised_damping(gear: SteeringGear, fidelity: Fidelity) -> float:
    """Return the same with friction that depends on speed alone: the largest damping at which a vibration
    grows that more damping cures; 0 where the gear is stable without any, nan without an equilibrium."""
    laws = {f"{part}.friction_law": getattr(gear, part).facts.at_speed for part in RUBBING_PARTS}
    gear = gear.replace({**laws, "pinion.axial_friction": 0.0, "yoke.bore_friction": 0.0})
    model = reduced_gear(gear)
    most = RANGE * model.linear_limit(gear.test.speed)
    vibration = SlidingVibration.of(gear, fidelity) if most else None
    if vibration is None:
        return float("nan") if most else 0.0
    low, high, root = 0.0, most, 0.0
    while high - low > most / TRIED**2:
        tried = np.linspace(low, high, TRIED)
        least = CURED / (2 * model.inertia)
        roots = np.array([vibration.cured_at(damping, least) for damping in tried])
        unstable = np.flatnonzero(roots > tried)
        if not unstable.size:
            break
        last = int(unstable[-1])
        root = float(roots[last])
        if last == TRIED - 1:
            low, high, most = high, 2 * high, 2 * high
        else:
            low, high, root = tried[last], tried[last + 1], min(root, tried[last + 1])
    return root


@dataclass(frozen=True, eq=False)
class SlidingVibration:
    """A gear behind its column, linearised at instants of steady sliding over a tooth pitch."""

    mass: np.ndarray  # of all coordinates, (n, n)
    by_place: np.ndarray  # forces by coordinates at the instants, (k, n, n), the column's spring among them
    by_rate: np.ndarray  # forces by rates, the column's damping not among them
    averaged: int  # instants of `PERIODS` natural periods, at most all

    @classmethod
    def of(cls, gear: SteeringGear, fidelity: Fidelity) -> "SlidingVibration | None":
        """Linearise over a tooth pitch from the test's start on; None without an equilibrium there."""
        model, test = reduced_gear(gear), gear.test
        forces = gear_forces(gear, _condensed(fidelity))
        bar, pitch = RackBar.of(gear), 2 * np.pi / gear.pinion.teeth / test.speed
        farthest, start = bar.pair.angle_at(bar.largest_displacement), test.direction * test.start_angle
        behind, ahead = (
            max(0.0, float(angle)) / test.speed for angle in (farthest + start, farthest - start)
        )
        time = np.linspace(0, min(pitch, ahead), INSTANTS)
        approach = SteadyApproach(pitch, min(PITCHES * pitch, behind))
        drive = Steady("pinion", test.start_angle, test.direction * test.speed)
        path = settled_path(forces.statics, GearPair.of(gear), drive, approach, time)
        if not path.converged:
            return None
        after = path.time >= 0
        by_place, by_rate = slopes(forces, path.coordinates[after], path.rates[after])
        by_place[:, 0, 0] -= model.stiffness
        free = np.array([i for i in range(by_place.shape[1]) if i not in forces.locked])
        mass, at = mass_matrix(gear, forces, path.coordinates[-1]), np.ix_(free, free)
        by_place, by_rate = (np.array([each[at] for each in every]) for every in (by_place, by_rate))
        averaged = PERIODS * 2 * np.pi / model.frequency / max(time[1], 1e-300)
        return cls(mass[at], by_place, by_rate, int(np.clip(np.ceil(averaged), 1, INSTANTS)))

    def cured_at(self, damping: float, least: float) -> float:
        """Return the damping of the column [N m s/rad] at which what grows with one near it no longer does;
        the same where nothing does.

        What counts is the growth of each vibration, fast ones and those without an imaginary part too: the
        mean over `PERIODS` natural periods from each instant on. Eigenvalues of one instant and the next are
        the same vibration's if as many others are smaller. One that damping of the column slows by less than
        `least` [1/s per N m s/rad] is the rack's own, and is left out.
        """
        damped = self.by_rate.copy()
        damped[:, 0, 0] -= damping
        values, right = np.linalg.eig(state_matrix(self.mass, self.by_place, damped))
        n = len(self.mass)
        push = np.zeros(2 * n)
        push[n:] = np.linalg.inv(self.mass)[:, 0]
        slowed = (np.linalg.inv(right) @ push) * right[:, n]
        order = np.argsort(np.abs(values), axis=1)
        growth, slowing = (
            self._averaged(np.take_along_axis(each, order, 1)) for each in (values.real, slowed.real)
        )
        counts = (growth > 0) & (slowing > least)
        return damping + float(np.max(growth[counts] / slowing[counts], initial=0.0))

    def _averaged(self, values: np.ndarray) -> np.ndarray:
        """Return means (.,) of values (k, m) over `averaged` instants from each on."""
        sums = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), values]), axis=0)
        return np.asarray((sums[self.averaged :] - sums[: -self.averaged]) / self.averaged).ravel()


def _condensed(fidelity: Fidelity) -> Fidelity:
    """The same with a bush that has no coordinates of its own, and teeth whose contact is smooth."""
    condensed = fidelity.with_condensed_chain()
    return condensed.replace({"mesh": "flank"}) if condensed.mesh != "flank" else condensed


# --- The gear behind its steering column, reduced to one inertia on a spring, with the friction of its parts.
# Pinion and rack turn together at the gear's gain.


def reduced_gear(gear: SteeringGear) -> Oscillator:
    """Return the reduced model of a gear and its column; parts by law coulomb are no larger at rest."""
    gain, pinion, rack = float(GearPair.of(gear).gain), pinion_inertia(gear), rack_masses(gear).mass
    parts = tuple(friction_over_speed(*part) for part in sliding_parts(gear))
    column = ColumnModel.of(gear)
    return Oscillator(pinion + rack * gain**2, column.stiffness, column.damping, parts)


def bristle_reversal_angle(gear: SteeringGear) -> float:
    """Return the pinion angle after a turn over which one bristle would turn about [rad], twice that of its
    first loading; 0 without bristles."""
    return 2 * ELEMENT_TRAVELS[0][0] * presliding_angle(gear)


def presliding_angle(gear: SteeringGear) -> float:
    """Return the pinion angle of the bristles' travel [rad], weighed with the friction; 0 without."""
    if not any(getattr(gear, part).facts.has_state for part in RUBBING_PARTS):
        return 0.0
    parts = [(law, torque, lever) for law, torque, lever in sliding_parts(gear) if torque > 0 and lever > 0]
    yielding = [torque * law.bristle_travel / lever for law, torque, lever in parts if law.facts.has_state]
    whole = sum(torque for _, torque, _ in parts)
    return float(np.sum(yielding) / whole) if whole else 0.0
