"""Constants of a gear's teeth for law "teeth", and their form over the tangent length."""

import numpy as np

from rps_exudyn.base.compiled import record, record_type
from rps_exudyn.gears.basic_rack import half_angle
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import EFFECTIVE_MODULUS, POISSON_RATIO, YOUNGS_MODULUS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.tooth_compliance import TOOTH, pinion_tooth, rack_tooth

DEGREE = 7  # of the polynomials: 1e-6 of the values
THINNEST = 1e-3  # of the module: a pointed tooth has no thickness left


TEETH = record_type(
    [
        ("pinion", TOOTH),
        ("rack", TOOTH),
        # polynomials in the tangent length between form and tip circle: cos(alpha), times y, times
        # tan(alpha), and h over the tangent length
        ("form", "f8", (4, DEGREE + 1)),
        ("middle", "f8"),  # of these tangent lengths [m]
        ("per_half", "f8"),  # 1 over half their range [1/m]
        ("sin_alpha", "f8"),  # of the normal pressure angle
        ("cos_alpha", "f8"),
        ("rack_half_thickness", "f8"),  # of its tooth at the reference line, normal section
        ("reference_depth", "f8"),  # the rack's reference line stands at y = -reference_depth
        ("cos_rack", "f8"),  # of the rack's tooth angle
        ("pinion_end", "f8"),  # exp(-a / l) in the middle of the pinion's tooth
        ("per_width", "f8"),  # pi E* cos(beta_b), E* = E / (2 (1 - nu^2)) [Pa]
        ("thinnest", "f8"),  # thickness of both teeth, squared over the tangent length, at least [m]
        ("torsion", "f8"),  # normal yield of a flank by the pinion's torsion under a unit load [m/N]
    ]
)
"""Record of a gear's teeth for law "teeth"; SI units."""


def teeth_data(gear: SteeringGear, flank: np.record) -> np.record:
    """Return the record of a gear's teeth; `flank` is that of its flanks.

    The pinion's core twists as a shaft of its root circle that takes the torque up evenly over the face and
    is held at one end.
    """
    pair = GearPair.of(gear)
    pinion, shear_modulus = pinion_tooth(pair), YOUNGS_MODULUS / (2 * (1 + POISSON_RATIO))
    core = np.pi / 2 * pair.root_radius**4 * shear_modulus / (pair.face_width / 2)
    arm = pair.base_radius * np.cos(pair.beta_b)  # of a normal force about the axis
    middle, half = (flank["q_tip"] + flank["q_form"]) / 2, (flank["q_tip"] - flank["q_form"]) / 2
    return record(
        TEETH,
        pinion=pinion,
        rack=rack_tooth(pair),
        form=_form_polynomials(pair, float(pinion["root"]), middle, half),
        middle=middle,
        per_half=1 / half,
        sin_alpha=np.sin(pair.alpha_n),
        cos_alpha=np.cos(pair.alpha_n),
        rack_half_thickness=np.pi * pair.module / 4,
        reference_depth=pair.reference_height,
        cos_rack=np.cos(pair.beta_r),
        pinion_end=np.exp(-pair.face_width / 2 / np.cos(pair.beta_b) / pinion["length"]),
        per_width=np.pi * EFFECTIVE_MODULUS * np.cos(pair.beta_b),
        thinnest=THINNEST * pair.module,
        torsion=arm**2 / core,
    )


def _form_polynomials(pair: GearPair, root: float, middle: float, half: float) -> np.ndarray:
    """Polynomials in the tangent length for `form`, through Chebyshev points."""
    x = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    q = middle + half * x
    radius = np.hypot(q, pair.base_radius)
    thick = half_angle(pair, radius)
    tan_x = np.tan(np.arctan(q / pair.base_radius) - thick)  # of the load against the tooth's middle
    tan = tan_x * np.cos(pair.beta_p)
    cos = 1 / np.sqrt(1 + tan**2)
    y = pair.base_radius * np.sqrt(1 + tan_x**2) - root
    h = radius * thick / np.sqrt(1 + (pair.twist * radius) ** 2) / np.cos(pair.alpha_n)
    rows = np.array([cos, cos * y, cos * tan, h / q / np.cos(pair.alpha_n)])
    return np.ascontiguousarray(np.polynomial.polynomial.polyfit(x, rows.T, DEGREE).T[:, ::-1])
