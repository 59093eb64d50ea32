"""Nominal stresses of the teeth by ISO 6336: contact at the pitch point (part 2), bending at the root (3).

The stresses here have factors K of 1: a steering gear turns slowly, and the rated torque is what it bears now
and then. How the face bears (K_H-beta) is for the contact forces to say: the requirement sheet does. A rack
is a gear of infinitely many teeth. The root is judged with all load at the tip of one tooth (factors Y_Fa and
Y_Sa), at the tangent of 30 degrees; sharing between pairs counts by Y_epsilon where the transverse contact
ratio is above 1. The standard asks for contact ratios above 1. The default pinion has 0.83: its numbers are
beyond what the standard was written for. Of a variable ratio each stress is the largest of the gears of
constant ratio along its travel. Choices are on the safe side:

* the face is what the round bar leaves at the tips of the rack's teeth, where it is less than the pinion's;
* each part's Y_beta has the inclination of its own teeth: the rack's 10 degrees, not the pinion's 25;
* Z_epsilon holds below a contact ratio of 1 as well, where it is above 1: the lines of contact are shorter.
"""

from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import involute
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.geometry_limits import transverse_contact_ratio
from rps_exudyn.gears.local_gear import local_gear_at, turn_of_test
from rps_exudyn.gears.tooth_stiffness import POISSON_RATIO, YOUNGS_MODULUS, virtual_teeth
from rps_exudyn.parameters.gear import SteeringGear

MANY_TEETH = 1e6  # of a rack: the form factor is that of infinitely many to 1e-5
PLACES = 25  # along the travel, of a variable ratio
STEEPEST_HELIX = np.deg2rad(30)  # up to which Y_beta falls


@dataclass(frozen=True)
class ToothForm:
    """A tooth in the normal section by its cutter; lengths in modules."""

    teeth: float  # virtual number z_n
    shift: float
    tip: float  # height of the tip above the reference circle
    pressure_angle: float  # [rad]
    dedendum: float  # h_fP of the cutter
    fillet: float  # rho_fP of the cutter
    helix: float = 0.0  # of its teeth to the axis, or to the rack's cross direction [rad]


RootTeeth = list[tuple[SteeringGear, ToothForm]]
"""Teeth of one part, each with the gear of constant ratio that it is in."""


@dataclass(frozen=True)
class Root:
    """The critical section at the tangent of 30 degrees, and the load at the tip; lengths in modules."""

    thickness: float  # s_Fn
    arm: float  # h_Fa
    radius: float  # rho_F
    load_angle: float  # alpha_Fan [rad]
    pressure_angle: float

    @property
    def form_factor(self) -> float:
        """Return Y_Fa = 6 h cos(alpha_Fan) / (s^2 cos(alpha_n))."""
        return float(6 * self.arm * np.cos(self.load_angle) / self.thickness**2 / np.cos(self.pressure_angle))

    @property
    def stress_correction(self) -> float:
        """Return Y_Sa = (1.2 + 0.13 L) q_s^(1 / (1.21 + 2.3 / L)), L = s / h, q_s = s / (2 rho_F)."""
        slender, notch = self.thickness / self.arm, self.thickness / (2 * self.radius)
        return float((1.2 + 0.13 * slender) * notch ** (1 / (1.21 + 2.3 / slender)))


def root_of(form: ToothForm) -> Root:
    """Return the critical section of a tooth (ISO 6336-3, clause on Y_F, load at the tip).

    Raises:
        ValueError: the tooth has no tangent of 30 degrees, or nothing of it is left there.
    """
    z, alpha = form.teeth, form.pressure_angle
    middle = np.pi / 4 - form.dedendum * np.tan(alpha) - (1 - np.sin(alpha)) * form.fillet / np.cos(alpha)
    g = form.fillet - form.dedendum + form.shift
    h = 2 / z * (np.pi / 2 - middle) - np.pi / 3
    theta = np.pi / 6
    for _ in range(100):
        theta, before = 2 * g / z * np.tan(theta) - h, theta
        if abs(theta - before) < 1e-12:
            break
    else:
        raise ValueError("no tangent of 30 degrees touches the root of this tooth")
    thickness = z * np.sin(np.pi / 3 - theta) + np.sqrt(3) * (g / np.cos(theta) - form.fillet)
    radius = form.fillet + 2 * g**2 / (np.cos(theta) * (z * np.cos(theta) ** 2 - 2 * g))
    tip_diameter = z + 2 * form.tip
    at_tip = np.arccos(min(1.0, z * np.cos(alpha) / tip_diameter))
    half = (np.pi / 2 + 2 * form.shift * np.tan(alpha)) / z + involute(alpha) - involute(at_tip)
    load_angle = at_tip - half
    above = (np.cos(half) - np.sin(half) * np.tan(load_angle)) * tip_diameter
    arm = (above - z * np.cos(np.pi / 3 - theta) - g / np.cos(theta) + form.fillet) / 2
    if min(thickness, arm, radius) <= 0:
        raise ValueError("the tangents of 30 degrees leave no tooth, no arm of the load or no fillet")
    return Root(float(thickness), float(arm), float(radius), float(load_angle), alpha)


def pinion_form(pair: GearPair) -> ToothForm:
    """Return the pinion's tooth in its normal section."""
    return ToothForm(
        virtual_teeth(pair.teeth, pair.beta_p, pair.beta_b),
        pair.profile_shift,
        (pair.tip_radius - pair.reference_radius) / pair.module,
        pair.alpha_n,
        pair.rack_dedendum / pair.module,
        pair.fillet_radius / pair.module,
        abs(pair.beta_p),
    )


def rack_form(pair: GearPair) -> ToothForm:
    """Return the rack's tooth, as one of very many teeth."""
    lengths = (pair.rack_addendum, pair.rack_dedendum, pair.fillet_radius)
    addendum, dedendum, fillet = (length / pair.module for length in lengths)
    return ToothForm(MANY_TEETH, 0.0, addendum, pair.alpha_n, dedendum, fillet, abs(pair.beta_r))


def pinion_teeth(gear: SteeringGear) -> RootTeeth:
    """Return the pinion's tooth; along a variable ratio it stays the same."""
    return [(gear, pinion_form(GearPair.of(gear)))]


def rack_teeth(gear: SteeringGear) -> RootTeeth:
    """Return the gears of constant ratio along the travel with their racks' teeth; of a constant ratio the
    gear itself.

    The roots that the pinion's round generates are taken as full rounds as deep. That is on the safe side:
    Y_Fa Y_Sa is 1.3 to 1.9 times that of the generated section, which is less curved at the tangent.
    """
    pair = GearPair.of(gear)
    if pair.course is None:
        return [(gear, rack_form(pair))]
    root, found = GeneratedRack.of(pair).root, []
    for local, _ in places_along(gear):
        own = GearPair.of(local)
        depth = (root.centre + root.radius - own.reference_line_height) / own.module
        room = (np.pi / 4 - depth * np.tan(own.alpha_n)) * np.cos(own.alpha_n)
        fillet = float(room / (1 - np.sin(own.alpha_n)))
        found.append((local, replace(rack_form(own), dedendum=float(depth), fillet=fillet)))
    return found


def places_along(gear: SteeringGear) -> list[tuple[SteeringGear, float]]:
    """Return gears of constant ratio from lock to lock, and 1 / |Q| there [1/m]; the gear itself and 0 of a
    constant ratio."""
    pair = GearPair.of(gear)
    if pair.course is None:
        return [(gear, 0.0)]
    first, last = turn_of_test(gear.with_unchecked({"test.path": "lock-to-lock"}))
    angles = np.linspace(first, last, PLACES)
    bends = np.abs(pair.design_mesh.bend(pair.gain_at(angles), pair.course.slope(angles)))
    return [
        (local_gear_at(gear, angle), bend)
        for angle, bend in zip(angles.tolist(), bends.tolist(), strict=True)
    ]


def weakest(teeth: RootTeeth, torque: float) -> tuple[float, SteeringGear, ToothForm]:
    """Return the largest stress at a root [Pa] under a torque on the pinion [N m], and its tooth."""
    return max(((root_stress(*tooth, torque), *tooth) for tooth in teeth), key=lambda found: found[0])


def bearing_face(pair: GearPair) -> float:
    """Return the face that bears [m]: the pinion's, or what the round bar leaves at the rack's tips."""
    height = pair.reference_height + pair.rack_addendum
    left = 2 * np.sqrt(max(pair.bar_radius**2 - height**2, 0.0))
    return float(min(pair.face_width, left)) if left else pair.face_width


def root_stress(gear: SteeringGear, form: ToothForm, torque: float) -> float:
    """Return sigma_F0 = F_t / (b m_n) Y_Fa Y_Sa Y_epsilon Y_beta under a torque on the pinion [Pa].

    Raises:
        InputError: a root without the section that the standard judges.
    """
    pair = GearPair.of(gear)
    try:
        root = root_of(form)
    except ValueError as error:
        raise InputError(f"ISO 6336 has no stress of such a root: {error}.") from None
    ratio = transverse_contact_ratio(pair)
    shared = 0.25 + 0.75 / ratio if ratio > 1 else 1.0
    helix = min(form.helix, STEEPEST_HELIX)
    inclined = 1 - min(_overlap(pair), 1.0) * helix / np.deg2rad(120)
    load = abs(torque) / pair.reference_radius / (bearing_face(pair) * pair.module)
    return float(load * root.form_factor * root.stress_correction * shared * inclined)


def flank_stress(gear: SteeringGear, torque: float) -> float:
    """Return sigma_H0 = Z_H Z_E Z_epsilon Z_beta sqrt(F_t / (d_1 b)) under a torque on the pinion [Pa].

    The wheel is a rack: (u + 1) / u = 1, and the working pressure angle is alpha_t. Where the ratio varies
    the relative radius at the pitch point is smaller by 1 - q / |Q|.
    """
    return max(_pressed(local, torque, bend) for local, bend in places_along(gear))


def _pressed(gear: SteeringGear, torque: float, bend: float) -> float:
    pair = GearPair.of(gear)
    pitch_length = pair.reference_radius * np.sin(pair.alpha_t)
    zone = np.sqrt(2 * np.cos(pair.beta_b) / (np.cos(pair.alpha_t) * np.sin(pair.alpha_t)))
    elastic = np.sqrt(YOUNGS_MODULUS / (2 * np.pi * (1 - POISSON_RATIO**2)))
    helix = 1 / np.sqrt(np.cos(pair.beta_p))
    force = abs(torque) / pair.reference_radius
    pressed = force / (2 * pair.reference_radius * bearing_face(pair))
    pressed /= 1 - pitch_length * bend
    return float(zone * elastic * flank_sharing(pair) * helix * np.sqrt(pressed))


def root_load_factor(pair: GearPair, form: ToothForm, face_load_factor: float) -> float:
    """Return K_F-beta = K_H-beta^N_F, N_F = x^2 / (1 + x + x^2), x = face over tooth depth, at least 3."""
    depth = (form.tip + form.dedendum - form.shift) * pair.module
    x = max(3.0, bearing_face(pair) / depth)
    return float(face_load_factor ** (x**2 / (1 + x + x**2)))


def flank_sharing(pair: GearPair) -> float:
    """Return Z_epsilon, by which the length of the lines of contact changes the contact stress."""
    ratio, overlap = transverse_contact_ratio(pair), min(_overlap(pair), 1.0)
    return float(np.sqrt((4 - ratio) / 3 * (1 - overlap) + overlap / ratio))


def _overlap(pair: GearPair) -> float:
    return abs(bearing_face(pair) * np.sin(pair.beta_p)) / (np.pi * pair.module)
