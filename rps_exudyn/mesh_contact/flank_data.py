"""What the flank contact kernels know of a gear: one flat array, packed once per gear.

The entries are named by the constants below; the quadrature tables stand behind them.
"""

import numpy as np
from scipy.special import roots_jacobi

from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.parameters.gear import SteeringGear

(
    # pinion
    TEETH,
    BASE_RADIUS,
    TWIST,
    SIN_BASE_HELIX,
    COS_BASE_HELIX,
    THETA,  # Theta of tooth 0, side +1
    THETA_COAST_TO_DRIVE,  # Theta(side -1) - Theta(side +1)
    Q_FORM,  # tangent lengths between which the involute is a flank
    Q_TIP,
    HALF_FACE,
    ECCENTRIC_E,  # gear centre in the turning pinion frame
    ECCENTRIC_Y,
    # surplus of the flank along the transverse tangent, see gears.flank_form
    SLOPE,  # per tangent length from Q_FORM on
    RELIEF_START,  # tangent length where the tip relief begins
    RELIEF,  # taken off per squared tangent length from there on
    CROWNING,  # taken off per squared axial length
    PITCH_ERROR,  # turn of tooth 0
    # how the pinion stands
    COS_DELTA,
    SIN_DELTA,
    AXIS_OFFSET,
    # rack, in its own frame (origin on the bar's axis)
    NORMAL_X,  # |components| of the flank's normal: side NORMAL_X, -NORMAL_Y, -side NORMAL_Z
    NORMAL_Y,
    NORMAL_Z,
    FLANK_OFFSET,  # distance of flank 0 from the origin along its normal
    NORMAL_BASE_PITCH,
    TIP_DEPTH,  # the teeth's tips stand at y = -TIP_DEPTH
    BAR_RADIUS,
    # contact law
    STIFFNESS,
    DAMPING,
    FRICTION,
    ZONE,
    LINE_STIFFNESS,  # > 0: this law instead of the pressure
    # quadrature
    N_ALONG,
    N_ACROSS,
    N_FIXED,
) = range(35)

ALONG, ACROSS = 4, 2  # Gauss points: stations in each segment of a line, nodes across the strip


def pack(
    gear: SteeringGear, *, zone: float | None = None, along: int = ALONG, across: int = ACROSS
) -> np.ndarray:
    """The array for the flank contact kernels.

    Args:
        gear: the steering gear; its `mesh.law` chooses the contact law.
        zone: sliding speed below which friction falls linearly to zero [m/s]; default `sliding_zone`.
        along: Gauss points along each segment of a contact line.
        across: Gauss points across the contact strip.

    Raises:
        ValueError: no involute is left between form and tip circle.
    """
    pair = GearPair.of(gear)
    form = FlankForm.of(gear)
    coast, drive = Flank(pair, 0, +1), Flank(pair, 0, -1)
    if coast.form_tangent_length >= coast.tip_tangent_length:
        raise ValueError("the tip circle lies inside the form circle: the pinion has no flank")
    data = np.zeros(N_FIXED)
    data[TEETH] = pair.teeth
    data[BASE_RADIUS] = pair.base_radius
    data[TWIST] = pair.twist
    data[SIN_BASE_HELIX], data[COS_BASE_HELIX] = np.sin(pair.beta_b), np.cos(pair.beta_b)
    data[THETA], data[THETA_COAST_TO_DRIVE] = coast.theta, drive.theta - coast.theta
    data[Q_FORM], data[Q_TIP] = coast.form_tangent_length, coast.tip_tangent_length
    data[HALF_FACE] = pair.face_width / 2
    data[ECCENTRIC_E], data[ECCENTRIC_Y] = pair.eccentricity[:2]
    data[SLOPE] = form.profile_slope / (data[Q_TIP] - data[Q_FORM])
    data[RELIEF_START] = data[Q_TIP] - form.tip_relief_length if form.tip_relief else np.inf
    data[RELIEF] = form.tip_relief / form.tip_relief_length**2
    data[CROWNING] = form.crowning / data[HALF_FACE] ** 2
    data[PITCH_ERROR] = form.turn(0, pair)
    data[COS_DELTA], data[SIN_DELTA] = np.cos(pair.delta), np.sin(pair.delta)
    data[AXIS_OFFSET] = pair.axis_offset
    data[NORMAL_X], y, z = pair.rack_flank_normal(+1)
    data[NORMAL_Y], data[NORMAL_Z] = -y, -z
    data[FLANK_OFFSET] = pair.normal_base_pitch / 4 + np.sin(pair.alpha_n) * pair.reference_height
    data[NORMAL_BASE_PITCH] = pair.normal_base_pitch
    data[TIP_DEPTH] = pair.reference_height + pair.rack_addendum
    data[BAR_RADIUS] = pair.bar_radius
    data[STIFFNESS], data[DAMPING] = gear.mesh.stiffness, gear.mesh.damping
    data[FRICTION] = gear.mesh.friction
    data[ZONE] = sliding_zone(gear) if zone is None else zone
    data[LINE_STIFFNESS] = gear.mesh.line_stiffness if gear.mesh.law == "line" else 0.0
    data[N_ALONG], data[N_ACROSS] = along, across
    return np.concatenate([data, _tables(along, _ALONG_END), _tables(across, _ACROSS_END)])


def pack_generators(
    gear: SteeringGear, *, zone: float | None = None, generators: int = 640, along: int = 4
) -> np.ndarray:
    """The array for `flank_quadrature`: number of generators, and Gauss points on each."""
    data = pack(gear, zone=zone, along=along)
    data[N_ACROSS] = generators
    return data


def sliding_zone(gear: SteeringGear, share: float = 0.01) -> float:
    """Speed zone of the friction: `share` of the mean sliding speed at the test's speed [m/s].

    At 1 % the law is Coulomb's except where sliding nearly vanishes, as on the pitch line of parallel axes.
    """
    pair = GearPair.of(gear)
    lever = np.mean(pair.friction_lever(np.linspace(*pair.active_path, 33)))
    return float(share * gear.test.speed * lever)


# --- quadrature ----------------------------------------------------------------------------------
# Where the pressure ends by itself it vanishes linearly, where a line ends by itself its load does so
# with the power 3/2: these factors go into the weight function of Gauss-Jacobi rules, so that only the
# smooth rest is approximated. Tables 0..3: the factor at no end, at the low, at the high, at both ends.
_ACROSS_END = 1.0
_ALONG_END = 1.5


def _tables(n: int, exponent: float) -> np.ndarray:
    """Nodes in [0, 1] and weights of the four rules, the factor divided out of the weights; shape (8 n,)."""
    rules = []
    for low, high in ((0.0, 0.0), (exponent, 0.0), (0.0, exponent), (exponent, exponent)):
        x, w = roots_jacobi(n, high, low)  # weight function (1 - x)^high (1 + x)^low
        rules += [(1 + x) / 2, w / ((1 - x) ** high * (1 + x) ** low) / 2]
    return np.concatenate(rules)
