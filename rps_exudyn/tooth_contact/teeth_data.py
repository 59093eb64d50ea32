"""Constants of a gear's teeth for law "teeth", and their form over the tangent length."""

from functools import lru_cache

import numpy as np

from rps_exudyn.base.compiled import record, record_type
from rps_exudyn.gears.basic_rack import half_angle
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS, POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.gears.trochoid import form_point, root_section, trochoid
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.tooth_compliance import (
    MODES,
    RACK_YIELD,
    TOOTH,
    pinion_tooth,
    plane_yield,
    rack_tooth,
)

DEGREE = 7  # of the polynomials: 1e-6 of the values
POINTS = 200  # of the tooth's section, on fillet and involute each
THINNEST = 1e-3  # of the module: a pointed tooth has no thickness left
STIFFER_CORE = 0.5  # torsion of the toothed part over that of its root circle: teeth stiffen it; +-0.1
# Rows of the form: zeta, 1 / cos(beta_R), h over q cos(alpha_n), the coast flank's offset along the tooth,
# and of each mode phi over sqrt(2 l), exp(-half length / l) and exp(offset / l)
ZETA, PER_COS, THICK, OFFSET, PHI, BY_HALF, BY_OFFSET = 0, 1, 2, 3, 4, 4 + MODES, 4 + 2 * MODES
FORMS = 4 + 3 * MODES

TEETH = record_type(
    [
        ("pinion", TOOTH),
        ("rack", TOOTH),
        ("form", "f8", (FORMS, DEGREE + 1)),  # polynomials in the tangent length from form to tip circle
        ("middle", "f8"),  # of these tangent lengths [m]
        ("per_half", "f8"),  # 1 over half their range [1/m]
        ("tan_alpha", "f8"),  # of the normal pressure angle
        ("rack_scale", "f8"),  # of the rack's phi [sqrt(m^2/N)]
        ("rack_half_thickness", "f8"),  # of its tooth at the reference line, normal section
        ("reference_depth", "f8"),  # the rack's reference line stands at y = -reference_depth
        ("cos_rack", "f8"),  # of the rack's tooth angle
        ("tan_rack", "f8"),
        ("per_width", "f8"),  # pi E* cos(beta_b), E* = E / (2 (1 - nu^2)) [Pa]
        ("thinnest", "f8"),  # thickness of both teeth, squared over the tangent length, at least [m]
        ("torsion", "f8"),  # normal yield of a flank by the pinion's torsion under a unit load [m/N]
    ]
)
"""Record of a gear's teeth for law "teeth"; SI units."""


def teeth_data(gear: SteeringGear, flank: np.record) -> np.record:
    """Return the record of a gear's teeth; `flank` is that of its flanks.

    The pinion's core twists as a shaft of its root circle that takes the torque up evenly over the face and
    is held at one end; its teeth stiffen it.
    """
    return _teeth(GearPair.of(gear).design, float(flank["q_form"]), float(flank["q_tip"]))


@lru_cache(maxsize=64)
def _teeth(pair: GearPair, q_form: float, q_tip: float) -> np.record:
    shear_modulus = YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO))
    core = np.pi / 2 * pair.root_radius**4 * shear_modulus / (pair.face_width / 2)
    arm = pair.base_radius * np.cos(pair.beta_b)  # of a normal force about the axis
    pinion, middle, half = pinion_tooth(pair), (q_tip + q_form) / 2, (q_tip - q_form) / 2
    return record(
        TEETH,
        pinion=pinion,
        rack=rack_tooth(pair),
        form=_form_polynomials(pair, pinion, middle, half),
        middle=middle,
        per_half=1 / half,
        tan_alpha=np.tan(pair.alpha_n),
        rack_scale=np.cos(pair.alpha_n) * RACK_YIELD,
        rack_half_thickness=np.pi * pair.module / 4,
        reference_depth=pair.reference_height,
        cos_rack=np.cos(pair.beta_r),
        tan_rack=np.tan(pair.beta_r),
        per_width=np.pi * EFFECTIVE_MODULUS * np.cos(pair.beta_b),
        thinnest=THINNEST * pair.module,
        torsion=STIFFER_CORE * arm**2 / core,
    )


def pinion_section(pair: GearPair) -> tuple[np.ndarray, np.ndarray]:
    """Return heights above the root's section, ascending, and the tooth's thickness there, normal section
    [m]: the fillet from that section on, and the involute."""
    root, _ = root_section(pair)
    form, turn = form_point(pair), np.pi / pair.teeth
    fillet = trochoid(pair, np.linspace(form.eta, np.pi / 2, POINTS))
    along, across = np.array([np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), -np.sin(turn)])
    radius = np.linspace(form.radius, pair.tip_radius, POINTS)
    thick = half_angle(pair, radius)
    height = np.concatenate([fillet @ along, radius * np.cos(thick)])
    half = np.concatenate([np.abs(fillet @ across), radius * np.sin(thick)])
    order = np.argsort(height, kind="stable")
    height, half = height[order], half[order]
    return height - root, 2 * half * np.cos(np.arctan(pair.twist * np.hypot(height, half)))


def pinion_form(pair: GearPair, pinion: np.record, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return zeta and kappa [m^2/N] of the pinion's tooth at tangent lengths q (n,) [m]."""
    thick = half_angle(pair, np.hypot(q, pair.base_radius))
    tan_x = np.tan(np.arctan(q / pair.base_radius) - thick)  # of the load against the tooth's middle
    lever = pair.base_radius * np.sqrt(1 + tan_x**2) - pinion.root
    kappa = plane_yield(lever, tan_x * np.cos(pair.beta_p), pinion.root_width, *pinion_section(pair))
    return lever / pinion.root_width, kappa


def _form_polynomials(pair: GearPair, pinion: np.record, middle: float, half: float) -> np.ndarray:
    """Polynomials in the tangent length for `form`, through Chebyshev points."""
    x = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    q = middle + half * x
    radius = np.hypot(q, pair.base_radius)
    thick = half_angle(pair, radius)
    tan_beta = pair.twist * radius
    per_cos = np.sqrt(1 + tan_beta**2)
    zeta, kappa = pinion_form(pair, pinion, q)
    offset = -radius * thick * tan_beta / per_cos
    rows = np.empty((FORMS, q.size))
    rows[PHI : PHI + MODES] = np.sqrt(kappa) * (pinion.terms @ [np.ones_like(zeta), zeta, zeta**2])
    rows[ZETA], rows[PER_COS] = zeta, per_cos
    rows[THICK] = radius * thick / per_cos / np.cos(pair.alpha_n) / q / np.cos(pair.alpha_n)
    rows[OFFSET] = offset
    rows[BY_HALF : BY_HALF + MODES] = np.exp(-pair.face_width / 2 * per_cos / pinion.length[:, None])
    rows[BY_OFFSET : BY_OFFSET + MODES] = np.exp(offset / pinion.length[:, None])
    return np.ascontiguousarray(np.polynomial.polynomial.polyfit(x, rows.T, DEGREE).T[:, ::-1])
