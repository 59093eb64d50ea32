"""Stiffness of steel teeth by ISO 6336-1:2019, method B (clause 9): c' of a pair, c_gamma of the mesh.

The single stiffness is the load per face width over the deflection of one pair of teeth, both along the line
of action; one N/(mm um) is 1e9 N/m^2. A rack is a gear of infinitely many teeth. Left out are the standard's
reductions for thin rims, other materials and less than 100 N per mm of face width. Steering pinions lie at
the edge of what the series for q' was fitted to: an error of 10 % must be expected.
"""

from math import asin, cos, degrees, inf, pi, radians, sin, tan
from typing import TYPE_CHECKING

from rps_exudyn.parameters.gear import SteeringGear

if TYPE_CHECKING:  # `describe` prints the stiffness of a gear, and does without numpy
    from rps_exudyn.gears.gear_pair import GearPair

PER_MM_UM = 1e9  # [N/m^2] in one N/(mm um)
SERIES = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
"""C_1 to C_9 of q' [mm um/N]."""
MEASURED = 0.8
"""C_M: measured teeth are softer than the theory of solid ones."""
SOLID = 1.0
"""C_R of solid discs."""
LEAST_SHIFT, LARGEST_SHIFT = -0.5, 2.0  # of x_1 + x_2 in the series; beyond, the limit counts


def virtual_teeth(teeth: float, helix: float, base_helix: float) -> float:
    """Return the teeth of the spur gear in the normal section, z_n = z / (cos^2 beta_b cos beta)."""
    return teeth / (cos(base_helix) ** 2 * cos(helix))


def theoretical_stiffness(z_n1: float, z_n2: float, x_1: float = 0.0, x_2: float = 0.0) -> float:
    """Return c'_th = 1 / q' of a pair of solid standard teeth in the normal section [N/m^2].

    q' = C_1 + C_2 / z_n1 + C_3 / z_n2 + C_4 x_1 + C_5 x_1 / z_n1 + C_6 x_2 + C_7 x_2 / z_n2 + C_8 x_1^2 +
    C_9 x_2^2; above zero for every gear of three teeth and more within the limits of x_1 + x_2. z_n are
    virtual numbers of teeth, of a rack infinite, x profile shift coefficients of pinion (1) and wheel (2).
    """
    terms = (1, 1 / z_n1, 1 / z_n2, x_1, x_1 / z_n1, x_2, x_2 / z_n2, x_1**2, x_2**2)
    return float(PER_MM_UM / sum(c * term for c, term in zip(SERIES, terms, strict=True)))


def basic_rack_factor(dedendum: float, pressure_angle: float) -> float:
    """Return C_B = [1 + 0.5 (1.2 - h_fP / m_n)] [1 - 0.02 (20 - alpha_Pn)]: of h_fP / m_n and the pressure
    angle alpha_Pn [rad] of the basic rack."""
    return float((1 + 0.5 * (1.2 - dedendum)) * (1 - 0.02 * (20 - degrees(pressure_angle))))


def single_stiffness(theoretical: float, rack_factor: float, helix: float) -> float:
    """Return c' = c'_th C_M C_R C_B cos beta [N/m^2]."""
    return float(theoretical * MEASURED * SOLID * rack_factor * cos(helix))


def mesh_stiffness_transverse(single: float, contact_ratio: float) -> float:
    """Return c_gamma_alpha = c' (0.75 epsilon_alpha + 0.25), the mean over a mesh [N/m^2].

    Stated for transverse contact ratios from 1.2, and up to a tenth too high for spur gears of less.
    """
    return single * (0.75 * contact_ratio + 0.25)


def stiffness_of_pair(pair: "GearPair") -> float:
    """Return c' of the pinion with its rack [N/m^2]."""
    z_n = virtual_teeth(pair.teeth, pair.beta_p, asin(sin(pair.beta_p) * cos(pair.alpha_n)))
    shift = min(max(pair.profile_shift, LEAST_SHIFT), LARGEST_SHIFT)
    rack_factor = basic_rack_factor(pair.rack_dedendum / pair.module, pair.alpha_n)
    return single_stiffness(theoretical_stiffness(z_n, inf, shift), rack_factor, pair.beta_p)


# --- Load per length of line and depth, by law "line"

AT_REST = (26.5, -10.0, 9.1)  # [N/(mm um)]: constant, per profile shift, per tangent of the helix angle
SHIFTS, HELICES = (0.5, 1.0), (15.0, 36.0)  # of the gears it was fitted to [-, deg]; beyond, the end counts


def rest_stiffness(profile_shift: float, helix: float) -> float:
    """Return k = 26.5 - 10 x + 9.1 tan|beta_p| N/(mm um) of a pinion of helix angle `helix` [rad] [N/m^2].

    With it both flanks of a gear at rest under its preload yield as finite elements of whole teeth do, within
    6 % on fourteen gears, 9 % on each left out of the fit. The standard's c' is a third to a half less: it
    has one pair of flanks, where drive and coast flank bend the same tooth against each other.
    """
    constant, per_shift, per_tangent = AT_REST
    shift = min(max(profile_shift, SHIFTS[0]), SHIFTS[1])
    angle = min(max(degrees(abs(helix)), HELICES[0]), HELICES[1])
    return PER_MM_UM * (constant + per_shift * shift + per_tangent * tan(radians(angle)))


def line_stiffness(gear: SteeringGear) -> float:
    """Return the load per length of line and depth [N/m^2]: `mesh.line_stiffness`, or that at rest."""
    return gear.mesh.line_stiffness or rest_stiffness(gear.pinion.profile_shift, gear.pinion.helix_angle)


DERIVED = {"mesh.line_stiffness": line_stiffness}
"""Parameters that a gear itself has a value for where none is given: path -> that value (SI)."""


# --- The steel that the teeth are made of, and what its contact bears

YOUNGS_MODULUS, POISSON_RATIO = 206e9, 0.3  # as in ISO 6336-2
EFFECTIVE_MODULUS = YOUNGS_MODULUS / (2 * (1 - POISSON_RATIO**2))  # E* of two bodies of it [Pa]
HERTZ = 2 * (1 - POISSON_RATIO**2) / (pi * YOUNGS_MODULUS)  # K of a line's flattening [m^2/N]
FLATTENED = POISSON_RATIO / (1 - POISSON_RATIO)  # what its logarithm is less by
BEARABLE_PRESSURE = 1.5e9  # Hertzian, of case-hardened steel, ISO 6336-5, quality MQ [Pa]
