"""The gear in operation: what temperature and wear make of the parameters of a new gear at 20 degC.

    clearance     c = c_20 + dT (a_h (L_s + L_p) - a_s L_s - a_p L_p) + w     from rack's axis to yokenut
    preload       P = P_20 (1 - set) (1 - 2.9e-4/K dT) - k (c - c_20)
    wear          dw/dn = kappa P, hence w = P / k (1 - exp(-kappa k n))      Archard, n cycles
    liner         mu = mu_20 exp(E_a / R (1 / T - 1 / 293.15 K))              PTFE
    bush          E = E_20 E_POM(T) / E_POM(20 degC);  clearance c = c_20 + r dT, r of a tube that the housing
                  holds outside and at its ends; drag F = F_20 (i - r dT) / i where it presses by i at 20 degC
    base oil      nu = a exp(b / (T - T_0)) (Vogel), or log log (nu + 0.7) = A - B log T (Walther)
    grease drag   F = f nu rho v A / h                                        on the rack, of bush and seat

dT is the temperature less 20 degC; L_s reaches from the pinion's axis through the rack to its back, L_p is
the plunger's thickness. Sources: friction of PTFE McCook et al. 2005; modulus of POM data sheets of Delrin
500P and Hostaform C 9021; spring EN 13906-1; Walther ASTM D341; wear Archard 1953. Each coefficient is an
estimate unless a source is named; docs/conditions.md has their ranges.
"""

import math
from typing import NamedTuple

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.conditions import REFERENCE_TEMPERATURE
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.closed_form import mean_lever

GAS_CONSTANT = 8.314  # R [J/(mol K)]
PTFE_ACTIVATION = 3.7e3  # E_a [J/mol]
SPRING_SOFTENING = 2.9e-4  # of the spring's shear modulus [1/K]
STEEL_EXPANSION = 11.5e-6  # of pinion and rack [1/K]
POM_MODULUS = np.array([[233.15, 3450e6], [296.15, 3250e6], [373.15, 700e6]])  # T [K], E [Pa]
OIL_DENSITY = 850.0  # [kg/m^3]
LARGEST_SHEAR = 0.2e6  # stress up to which the viscosity holds [Pa]


class Oil(NamedTuple):
    """A mineral base oil of an ISO 3448 grade, viscosity index 95."""

    at_40: float  # kinematic viscosity at 40 degC [mm^2/s]
    at_100: float
    pour_point: float  # [K]


MINERAL_OILS = {
    "VG 68": Oil(68.0, 8.7, 240.15),
    "VG 100": Oil(100.0, 11.1, 240.15),
    "VG 150": Oil(150.0, 14.7, 246.15),
}
VOGEL_PAO_32 = 0.0584, 1009.5, 152.65  # a [mm^2/s], b [K], T_0 [K]
POUR_POINT_PAO_32 = 216.15  # [K]


class Wear(NamedTuple):
    """Depths that the life behind a gear has worn off [m]."""

    liner: float  # of the plunger's seat, along the yoke's axis
    teeth: float  # of the flanks, as the rack's approach to the pinion

    @property
    def closing(self) -> float:
        """What both add to the yoke's clearance [m]."""
        return self.liner + self.teeth


class OperatingGear(NamedTuple):
    """A gear in operation, and what its conditions made."""

    gear: SteeringGear  # with new conditions: its parameters hold as they are
    wear: Wear

    @property
    def numbers(self) -> dict[str, float]:
        """Metrics of the conditions."""
        yoke = self.gear.yoke
        return {
            "operating_preload": yoke.preload,
            "operating_clearance": yoke.clearance,
            "operating_yoke_friction": yoke.friction,
            "operating_viscous_drag": self.gear.bush.viscous_drag,
            "operating_bush_clearance": self.gear.bush.clearance,
            "operating_bush_drag": self.gear.bush.drag,
            "wear_liner": self.wear.liner,
            "wear_teeth": self.wear.teeth,
        }


def operating_gear(gear: SteeringGear) -> OperatingGear | None:
    """Return the gear at its temperature, after its cycles; None where both are those of a new gear at
    20 degC without viscous drag.

    Raises:
        InputError: conditions for which a law does not hold, or that leave no preload.
    """
    if is_new(gear):
        return None
    conditions, yoke, bush = gear.conditions, gear.yoke, gear.bush
    warmer = conditions.temperature - REFERENCE_TEMPERATURE
    moved = warmer * clearance_per_kelvin(gear)
    preload = yoke.preload * (1 - conditions.spring_set) * (1 - SPRING_SOFTENING * warmer)
    preload -= yoke.spring_rate * moved
    if preload < 0:
        raise InputError(
            f"conditions leave no preload: the force of the yoke's spring would be {-preload:.4g} N; lower "
            "conditions.temperature or yoke.spring_rate."
        )
    worn, (room, drag) = wear(gear, preload), bush_in_operation(gear)
    in_operation = gear.replace(
        {
            "yoke.preload": max(preload - yoke.spring_rate * worn.closing, 0.0),
            "yoke.clearance": yoke.clearance + moved + worn.closing,
            "yoke.friction": min(yoke.friction * friction_factor(gear), 1.0),
            "bush.youngs_modulus": bush.youngs_modulus * float(pom_modulus(conditions.temperature)),
            "bush.viscous_drag": bush.viscous_drag + grease_drag(gear),
            "bush.clearance": room,
            "bush.interference": 0.0,
            "bush.drag": drag,
            "conditions.temperature": REFERENCE_TEMPERATURE,
            "conditions.steering_cycles": 0.0,
            "conditions.spring_set": 0.0,
            "grease.base_oil": "none",
        },
        "gear in operation",
    )
    return OperatingGear(in_operation, worn)


def is_new(gear: SteeringGear) -> bool:
    """Return whether a gear is new, at 20 degC, without a base oil: its parameters hold as they are."""
    conditions = gear.conditions
    aged = conditions.steering_cycles or conditions.spring_set
    return conditions.temperature == REFERENCE_TEMPERATURE and not aged and gear.grease.base_oil == "none"


def tested_gear(gear: SteeringGear) -> SteeringGear:
    """Return the gear that a scene tests: in operation, or itself where it is new."""
    return in_operation.gear if (in_operation := operating_gear(gear)) else gear


def clearance_per_kelvin(gear: SteeringGear) -> float:
    """Return the growth of the yoke's clearance over temperature [m/K]."""
    steel = GearPair.of(gear).bar_axis_height + gear.rack.bar_diameter / 2
    plunger = gear.yoke.plunger_thickness
    housing = gear.housing.expansion * (steel + plunger)
    return float(housing - STEEL_EXPANSION * steel - gear.yoke.plunger_expansion * plunger)


def bush_clearance_per_kelvin(gear: SteeringGear) -> float:
    """Return the growth of the bar's diametral clearance in the bush over temperature [m/K].

    The housing holds the tube outside and at its ends: Lame's solution in generalised plane strain.
    """
    bush, held = gear.bush, gear.housing.expansion
    inner, outer, nu = bush.inner_diameter / 2, bush.outer_diameter / 2, bush.poisson_ratio
    free = bush.expansion + nu * (bush.expansion - held)  # as the housing holds the length
    plane = nu / (1 - nu)
    passed_on = 2 * inner / ((1 - plane) * outer + (1 + plane) * inner**2 / outer)
    bore = free * inner - passed_on * (free - held) * outer
    return 2 * bore - STEEL_EXPANSION * gear.rack.bar_diameter


def bush_in_operation(gear: SteeringGear) -> tuple[float, float]:
    """Return the bar's diametral clearance in the bush [m] and its Coulomb drag [N] at its temperature.

    Raises:
        InputError: a clearance that the temperature closes.
    """
    bush = gear.bush
    grown = (gear.conditions.temperature - REFERENCE_TEMPERATURE) * bush_clearance_per_kelvin(gear)
    if bush.interference:
        pressed = bush.interference - grown
        return max(-pressed, 0.0), bush.drag * max(pressed, 0.0) / bush.interference
    if not bush.clearance:
        return 0.0, bush.drag
    if bush.clearance + grown < 0:
        raise InputError(
            f"conditions.temperature is {gear.conditions.temperature - 273.15:.4g} degC; it closes "
            f"bush.clearance = {1e6 * bush.clearance:.4g} um by {-1e6 * grown:.4g} um: the bar jams."
        )
    return bush.clearance + grown, bush.drag


def friction_factor(gear: SteeringGear) -> float:
    """Return the friction of the plunger's liner over that at 20 degC."""
    if gear.yoke.liner != "ptfe":
        return 1.0
    colder = 1 / gear.conditions.temperature - 1 / REFERENCE_TEMPERATURE
    return math.exp(PTFE_ACTIVATION / GAS_CONSTANT * colder)


def pom_modulus(temperature: float) -> float:
    """Return Young's modulus of POM over that at 20 degC, at a temperature [K]."""
    here, usual = (np.interp(t, *POM_MODULUS.T) for t in (temperature, REFERENCE_TEMPERATURE))
    return float(here / usual)


def viscosity(base_oil: str, temperature: float) -> float:
    """Return the kinematic viscosity [m^2/s] of a base oil at a temperature [K].

    Raises:
        InputError: below its pour point.
    """
    oil = MINERAL_OILS.get(base_oil)
    pour_point = oil.pour_point if oil else POUR_POINT_PAO_32
    if temperature < pour_point:
        raise InputError(
            f"conditions.temperature is {temperature - 273.15:.4g} degC; it must be at least "
            f"{pour_point - 273.15:.4g} degC, the pour point of grease.base_oil = {base_oil}."
        )
    if oil is None:
        a, b, zero = VOGEL_PAO_32
        return a * math.exp(b / (temperature - zero)) * 1e-6

    def log_log(nu: float) -> float:
        return math.log10(math.log10(nu + 0.7))

    slope = (log_log(oil.at_40) - log_log(oil.at_100)) / math.log10(373.15 / 313.15)
    value = log_log(oil.at_40) + slope * math.log10(313.15 / temperature)
    return (10 ** (10**value) - 0.7) * 1e-6


def grease_drag(gear: SteeringGear) -> float:
    """Return the viscous drag of the grease in bush and seat on the rack [N s/m].

    Raises:
        InputError: an oil below its pour point, or sheared harder than its viscosity holds for.
    """
    grease, rack = gear.grease, gear.rack
    if grease.base_oil == "none":
        return 0.0
    eta = OIL_DENSITY * viscosity(grease.base_oil, gear.conditions.temperature)
    stress = eta * gear.test.speed * abs(float(GearPair.of(gear).gain)) / grease.film
    if stress > LARGEST_SHEAR:
        raise InputError(
            f"grease.base_oil = {grease.base_oil} has a shear stress of {stress / 1e6:.3g} MPa at "
            f"test.speed; its viscosity is known up to {LARGEST_SHEAR / 1e6:g} MPa: raise "
            f"conditions.temperature or grease.film, "
            "or lower test.speed."
        )
    area = np.pi * rack.bar_diameter * gear.bush.length
    area += gear.yoke.seat_angle * rack.bar_diameter * gear.yoke.seat_length
    return float(grease.thickening * eta * area / grease.film)


def wear(gear: SteeringGear, preload: float) -> Wear:
    """Return what the gear's cycles wear off, by Archard's law, while the yoke's spring relaxes.

    The preload [N] is that of the new yoke at the gear's temperature.
    """
    liner, teeth = wear_per_cycle(gear)
    kappa, k, n = liner + teeth, gear.yoke.spring_rate, gear.conditions.steering_cycles
    if not kappa * n:
        return Wear(0.0, 0.0)
    closing = preload / k * -math.expm1(-kappa * k * n) if k else kappa * preload * n
    return Wear(closing * liner / kappa, closing * teeth / kappa)


def wear_per_cycle(gear: SteeringGear) -> tuple[float, float]:
    """Return the growth of the clearance per cycle and preload [m/N], by the liner and by the teeth.

    The liner: k s / A, over the seat's projected area A = 2 R sin(theta) L and the rack's way s of a cycle.
    The teeth: friction works over the mean lever l, so that each side of the teeth takes the volume
    V = k l / (2 sin(alpha_n)) per preload and angle off the flanks in use, those of pinion and rack each;
    worn by h, two sides let the rack approach by 2 h / sin(alpha_n) for pinion and rack together.
    """
    pair, rack, yoke, amplitude = GearPair.of(gear), gear.rack, gear.yoke, gear.conditions.cycle_angle
    turned = 4 * amplitude
    seat = rack.bar_diameter * math.sin(yoke.seat_angle) * yoke.seat_length
    liner = yoke.liner_wear * turned * abs(float(pair.gain)) / seat

    teeth_in_use = gear.pinion.teeth * min(1.0, amplitude / np.pi)
    volume = gear.mesh.tooth_wear * turned * mean_lever(pair) / (2 * math.sin(pair.alpha_n))
    depth = volume / (teeth_in_use * flank_area(pair))
    return liner, float(2 * depth / math.sin(pair.alpha_n))


def flank_area(pair: GearPair) -> float:
    """Return the area of one flank of the pinion along the active path of contact [m^2].

    The involute between two lengths of roll g is (g_1^2 - g_0^2) / (2 r_b) long in the transverse section.
    """
    pitch = pair.reference_radius * np.sin(pair.alpha_t)
    g_0, g_1 = (max(pitch + q, 0.0) for q in pair.active_path)
    base = pair.reference_radius * np.cos(pair.alpha_t)
    return float((g_1**2 - g_0**2) / (2 * base) * pair.face_width / np.cos(pair.beta_p))
