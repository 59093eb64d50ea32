"""Constants of a gear for the flank contact, and the rules by which it is integrated."""

from functools import lru_cache
from math import gamma

import numpy as np

from rps_exudyn.base.compiled import record, record_type
from rps_exudyn.forces.friction import LAW, Patches, law_of
from rps_exudyn.gears.course import MOST_PIECES
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.helicoid import Flank, root_angle
from rps_exudyn.gears.pitch_errors import MOST_TEETH, rack_errors
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.measured_flank import GRID, pooled_grids

ALONG, ACROSS = 4, 2  # Gauss points: stations in each segment of a line, nodes across the strip
TOWARDS_ENDS = -0.13  # power that suits the loads of teeth that bend: on eleven gears 5 stations leave 0.05 %
TURNS_ABOUT = 0.25  # smallest over mean sliding below which the friction turns within the stations' distance
MOST_POINTS = 33  # of a rule, as `fidelity.strip_stations` and `strip_points` allow

IN_PIECE = 2  # stations in each piece of a measured line: on a piece the depth is a parabola

MOST_PINION_TEETH = 40  # as `pinion.teeth` allows

FLANK = record_type(
    [
        # pinion
        ("teeth", "i8"),
        ("base_radius", "f8"),
        ("twist", "f8"),
        ("cos_base_helix", "f8"),
        ("theta", "f8"),  # Theta of tooth 0, side +1
        ("theta_coast_to_drive", "f8"),  # Theta(side -1) - Theta(side +1)
        ("q_form", "f8"),  # tangent lengths between which the involute is a flank
        ("q_tip", "f8"),
        ("half_face", "f8"),
        ("eccentric_e", "f8"),  # gear centre in the turning pinion frame
        ("eccentric_y", "f8"),
        # surplus of the flank along the transverse tangent, see gears.flank_form
        ("slope", "f8"),  # per tangent length from q_form on
        ("relief_start", "f8"),  # tangent length where the tip relief begins
        ("relief", "f8"),  # taken off per squared tangent length from there on
        ("crowning", "f8"),  # taken off per squared axial length
        ("turns", "f8", (MOST_PINION_TEETH,)),  # of the pinion's teeth by their pitch errors [rad]
        ("has_rack_errors", "i8"),
        ("rack_middle", "i8"),  # place of the rack's tooth 0 among ...
        ("rack_shifts", "f8", (MOST_TEETH,)),  # ... displacements of its teeth along X [m]
        ("pinion_grid", GRID),  # flanks as measured
        ("rack_grid", GRID),
        ("highest", "f8"),  # that these add to a depth at most [m]
        ("pieces", "i8"),  # in which a line on measured flanks is taken
        # how the pinion stands
        ("cos_delta", "f8"),
        ("sin_delta", "f8"),
        ("axis_offset", "f8"),
        # rack, in its own frame (origin on the bar's axis)
        ("rack_reference", "f8", (3,)),  # that origin in the housing at displacement 0
        ("normal_x", "f8"),  # |components| of the flank's normal: side normal_x, -normal_y, -side normal_z
        ("normal_y", "f8"),
        ("normal_z", "f8"),
        ("flank_offset", "f8"),  # distance of flank 0 from the origin along its normal
        ("normal_base_pitch", "f8"),
        ("gain", "f8"),  # rack's travel per radian of the pinion
        # of a variable ratio, see gears.course: its pieces (0: constant), where each begins and what it is
        ("course_pieces", "i8"),
        ("course_starts", "f8", (MOST_PIECES,)),
        ("course", "f8", (MOST_PIECES, 5)),
        ("sine_per_gain", "f8"),  # A and B of S = A / g + B
        ("sine_offset", "f8"),
        ("kappa", "f8"),  # angle from the middle of a pinion's space to its tooth on the base circle
        # tan delta and tau / cos delta: the normal has N_z = -N_x (trace + g trace_per_gain)
        ("trace", "f8"),
        ("trace_per_gain", "f8"),
        ("cos_design", "f8"),  # of the shaft angle as designed
        ("sin_design", "f8"),
        ("tip_depth", "f8"),  # the teeth's tips stand at y = -tip_depth
        ("bar_radius", "f8"),
        # contact law
        ("stiffness", "f8"),
        ("damping", "f8"),
        ("friction", "f8"),
        ("zone", "f8"),
        ("law", LAW),
        ("breaks_sliding", "i8"),  # whether lines are integrated in two pieces where sliding turns about
        ("line_stiffness", "f8"),  # > 0: this law instead of the pressure
        # integration
        ("stations", "i8"),  # along a segment of a line
        ("points", "i8"),  # across a strip
        ("along", "f8", (4, 2, MOST_POINTS)),  # rules along a segment of a line
        ("across", "f8", (4, 2, MOST_POINTS)),  # and across a strip
        ("ease_along", "f8", (4,)),  # for each rule, the stiffness's weights over the load's
        ("ease_across", "f8", (4,)),
        ("generators", "i8"),  # > 0: over n generators instead of strips
    ]
)
"""Record of one gear for the laws of flank contact; SI units."""


def pack(
    gear: SteeringGear,
    *,
    zone: float | None = None,
    along: int = ALONG,
    across: int = ACROSS,
    generators: int = 0,
    patches: Patches | None = None,
) -> np.record:
    """Return the record `FLANK`; the gear's `mesh.law` chooses the contact law. The numbers of measured
    flanks are those of `pooled_grids`, at the beginning of a pool.

    Args:
        zone: sliding speed below which friction falls linearly to zero [m/s]; default `sliding_zone`.
        along: Gauss points along each segment of a contact line, or along each generator.
        across: Gauss points across the contact strip.
        generators: number of generators to integrate over; 0 integrates over strips.
        patches: of the gear's bristles.

    Raises:
        ValueError: no involute is left between form and tip circle.
        InputError: pitch errors that the rack's teeth do not have, or flanks that no grid describes.
    """
    pair, form, mesh = GearPair.of(gear), FlankForm.of(gear), gear.mesh
    contact_law = mesh.contact_law
    of_rack, turns, shifts = rack_errors(gear), np.zeros(MOST_PINION_TEETH), np.zeros(MOST_TEETH)
    turns[: pair.teeth] = form.turns(pair)
    shifts[: len(of_rack)] = of_rack
    coast, theta = Flank(pair, 0, +1, form), root_angle(pair, 0, +1)
    measured = measured_flanks(gear)
    of_pinion, on_rack, _ = pooled_grids(measured)
    # law "line" has as many stations on a measured line, two in each piece
    stations = IN_PIECE if measured.are_given and contact_law == "line" else along
    q_form, q_tip = form_point(pair).tangent_length, pair.design_mesh.tip_length
    half_face = pair.face_width / 2
    if q_form >= q_tip:
        raise ValueError("the tip circle lies inside the form circle: the pinion has no flank")
    normal = pair.rack_flank_normal(+1)
    return record(
        FLANK,
        teeth=pair.teeth,
        base_radius=pair.base_radius,
        twist=coast.twist,
        cos_base_helix=np.cos(coast.beta_b),
        theta=theta,
        theta_coast_to_drive=root_angle(pair, 0, -1) - theta,
        q_form=q_form,
        q_tip=q_tip,
        half_face=half_face,
        eccentric_e=pair.eccentricity[0],
        eccentric_y=pair.eccentricity[1],
        slope=form.profile_slope / (q_tip - q_form),
        relief_start=q_tip - form.tip_relief_length if form.tip_relief else np.inf,
        relief=form.tip_relief / form.tip_relief_length**2,
        crowning=form.crowning / half_face**2,
        turns=turns,
        has_rack_errors=int(bool(len(of_rack))),
        rack_middle=len(of_rack) // 2,
        rack_shifts=shifts,
        pinion_grid=of_pinion[0],
        rack_grid=on_rack[0],
        highest=measured.highest,
        pieces=max(along // IN_PIECE, 1),
        cos_delta=np.cos(pair.delta),
        sin_delta=np.sin(pair.delta),
        axis_offset=pair.axis_offset,
        rack_reference=np.array([0.0, pair.bar_axis_height, 0.0]),
        normal_x=normal[0],
        normal_y=-normal[1],
        normal_z=-normal[2],
        flank_offset=pair.normal_base_pitch / 4 + np.sin(pair.alpha_n) * pair.reference_height,
        normal_base_pitch=pair.normal_base_pitch,
        gain=float(pair.gain),
        **course_fields(pair),
        tip_depth=pair.reference_height + pair.rack_addendum,
        bar_radius=pair.bar_radius,
        stiffness=mesh.stiffness,
        damping=mesh.damping,
        friction=mesh.friction,
        zone=sliding_zone(gear) if zone is None else zone,
        # half the preload on each side of the teeth
        law=law_of(
            mesh, patches or Patches(), mesh.friction, gear.yoke.preload / abs(2 * normal[1]), count=2
        ),
        breaks_sliding=pair.friction_levers.min() / pair.friction_levers.mean() < TURNS_ABOUT,
        line_stiffness=line_stiffness(gear) if contact_law == "line" else 0.0,
        stations=stations,
        points=across,
        generators=generators,
        **_rules(stations, across, contact_law == "teeth"),
    )


def course_fields(pair: GearPair) -> dict[str, np.ndarray | float]:
    """Return the fields of the record `FLANK` of a course; a constant ratio has no pieces."""
    mesh, starts, pieces = pair.design_mesh, np.zeros(MOST_PIECES), np.zeros((MOST_PIECES, 5))
    count = 0 if pair.course is None else len(pair.course.starts)
    if pair.course is not None:
        starts[:count], pieces[:count] = pair.course.starts, pair.course.pieces
    return {
        "course_pieces": count,
        "course_starts": starts,
        "course": pieces,
        "sine_per_gain": mesh.A,
        "sine_offset": mesh.B,
        "kappa": GeneratedRack.of(pair).kappa,
        "trace": np.tan(mesh.delta),
        "trace_per_gain": pair.twist / np.cos(mesh.delta),
        "cos_design": np.cos(mesh.delta),
        "sin_design": np.sin(mesh.delta),
    }


@lru_cache(maxsize=64)
def _rules(along: int, across: int, of_teeth: bool) -> dict[str, np.ndarray]:
    """The rules of the record `FLANK`, with room for `MOST_POINTS`."""
    rules = {"along": rules_of_teeth(along) if of_teeth else jacobi_rules(along, 1.5)}
    rules["across"] = jacobi_rules(across, 1.0)
    for name, each in rules.items():
        rules[name] = np.pad(each, ((0, 0), (0, 0), (0, MOST_POINTS - each.shape[2])))
    return rules | {"ease_along": eased(along, 1.5, 0.5), "ease_across": eased(across, 1.0, 0.0)}


def sliding_zone(gear: SteeringGear) -> float:
    """Speed zone of the friction: 1 % of the mean sliding speed at the test's speed [m/s]. So the law is
    Coulomb's except where sliding nearly vanishes, as on the pitch line of parallel axes."""
    pair = GearPair.of(gear)
    lever = np.mean(pair.friction_lever(np.linspace(*pair.active_path, 33)))
    return float(0.01 * gear.test.speed * lever)


def rules_of_teeth(n: int) -> np.ndarray:
    """Rules as `jacobi_rules`, the first for loads that rise towards both ends of a line with the power
    `TOWARDS_ENDS` of the distance: beyond the ends nothing yields along."""
    rules = jacobi_rules(n, 1.5)
    x, w = gauss_jacobi(n, TOWARDS_ENDS, TOWARDS_ENDS)
    w /= (1 - x * x) ** TOWARDS_ENDS
    rules[0] = (1 + x) / 2, w / w.sum()
    return rules


def jacobi_rules(n: int, exponent: float) -> np.ndarray:
    """Gauss-Jacobi rules on [0, 1] for loads that vanish at no end, the low, the high, at both ends.

    Where the pressure ends by itself it vanishes linearly, where a line ends by itself its load does so with
    the power 3/2: this `exponent` goes into the weight function, and only the smooth rest is approximated.
    Nodes and weights, the factor divided out of the weights; shape (4, 2, n).
    """
    rules = np.empty((4, 2, n))
    for rule, low, high in zip(rules, (0, exponent, 0, exponent), (0, 0, exponent, exponent), strict=True):
        x, w = gauss_jacobi(n, high, low)  # weight function (1 - x)^high (1 + x)^low
        rule[:] = (1 + x) / 2, w / ((1 - x) ** high * (1 + x) ** low) / 2
    return rules


def gauss_jacobi(n: int, high: float, low: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes in [-1, 1] and weights of the rule for the weight function (1 - x)^high (1 + x)^low, both (n,).

    G. H. Golub, J. H. Welsch, Mathematics of Computation 23 (1969) 221: the nodes are the eigenvalues of the
    symmetric matrix of the polynomials' recurrence, the weights the squared first components of its vectors.
    `scipy.special.roots_jacobi` gives the same and takes a fifth of a second to load, in each run.
    """
    k = np.arange(n)
    j, total = k[1:], 2.0 * k[1:] + high + low
    mean = np.empty(n)
    mean[0] = (low - high) / (high + low + 2)
    mean[1:] = (low**2 - high**2) / (total * (total + 2))
    square = 4 * j * (j + high) * (j + low) * (j + high + low) / (total**2 * (total + 1) * (total - 1))
    beside = np.sqrt(square)
    x, vectors = np.linalg.eigh(np.diag(mean) + np.diag(beside, 1) + np.diag(beside, -1))
    whole = 2 ** (high + low + 1) * gamma(high + 1) * gamma(low + 1) / gamma(high + low + 2)
    w = whole * vectors[0] ** 2
    return x, w


def eased(n: int, exponent: float, of_stiffness: float) -> np.ndarray:
    """Weights of the stiffness over those of `jacobi_rules`, which suit the load, for each rule.

    Where the load vanishes with an exponent, its derivative by the depth does so with one less: the rule's
    sum over u^of_stiffness, u the distances to the ends where the load vanishes, is set right.
    """
    factors = np.ones(4)
    for rule, (x, w) in enumerate(jacobi_rules(n, exponent)):
        ends = ((), (0,), (1,), (0, 1))[rule]
        low, high = (of_stiffness * (end in ends) for end in (0, 1))
        exact = gamma(1 + low) * gamma(1 + high) / gamma(2 + low + high)
        factors[rule] = exact / np.sum(w * x**low * (1 - x) ** high)
    return factors
