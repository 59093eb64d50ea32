"""The gear behind its steering column, reduced to one inertia on a spring, with the friction of its parts.

Pinion and rack turn together at the gear's gain. What each part takes is the closed form's; it slides with
its lever times the pinion's speed: the teeth with the levers of their friction along the path of contact,
evenly loaded, plunger and bush with the rack, the bearing with the shaft.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss

from rps_exudyn.analysis.stick_slip import Oscillator, Rubbing
from rps_exudyn.forces.friction import ELEMENT_TRAVELS
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.friction_law import RUBBING_PARTS, FrictionLaw
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import closed_form
from rps_exudyn.solvers.gear_forces import following_inertia

LEVERS = 5  # Gauss points along the path of contact


def reduced_gear(gear: SteeringGear) -> Oscillator:
    """Return the reduced model of a gear and its column; parts by law coulomb are no larger at rest."""
    gain, (pinion, rack) = float(GearPair.of(gear).gain), following_inertia(gear)
    parts = tuple(_part(law, torque, lever) for law, torque, lever in _parts(gear))
    column = gear.column
    return Oscillator(pinion + rack * gain**2, column.stiffness, column.damping, parts)


def reversal_angle(gear: SteeringGear) -> float:
    """Return the pinion angle after a turn over which one bristle would turn about [rad], twice that of its
    first loading; 0 without bristles."""
    return 2 * ELEMENT_TRAVELS[0][0] * presliding_angle(gear)


def presliding_angle(gear: SteeringGear) -> float:
    """Return the pinion angle of the bristles' travel [rad], the mean over the parts weighed with their
    friction; 0 without bristles."""
    if not any(getattr(gear, part).facts.has_state for part in RUBBING_PARTS):
        return 0.0
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
