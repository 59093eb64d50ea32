"""The flank contact compared with mechanics, symmetry, and two slower ways to the same integral.

Poses are near the aligned one, pressed by 10 um, with the rack turned by up to 1 mrad: what the teeth see
in use. Where two evaluators are compared, the tolerance is 1e-4 of the sum of normal forces (times the base
radius for moments), the accuracy that the kernel promises.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from flank_points import wrench_by_points
from flank_poses import ANGLES, FINE, PAPER, POSES, PRESS, ZONE, changed, difference, state
from rps_exudyn.base.compiled import changed as changed_record
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pitch_errors import class_tolerances, pinion_errors, rack_errors
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.wrench import (
    DAMPING_POWER,
    ELASTIC_ENERGY,
    FORCE,
    FRICTION_POWER,
    MOMENT,
    NORMAL_COAST,
    NORMAL_DRIVE,
    PENETRATION,
    TORQUE,
)
from verification.contact_at import flank_contact

PAIR = GearPair.of(PAPER)


# --- three ways to one integral ----------------------------------------------------------------
@pytest.mark.long
@pytest.mark.parametrize("pose", POSES)
def test_strip_agrees_with_fine_quadrature(pose: str) -> None:
    """Six stations per segment: 1e-4; the three of the default: 4e-4 at the worst angle of a rolled rack."""
    fast, fine, reference = (
        pack(PAPER, zone=ZONE),
        pack(PAPER, zone=ZONE, along=6, across=3),
        pack(PAPER, zone=ZONE, generators=FINE),
    )
    for angle in ANGLES:
        args = state(PAPER, angle, **POSES[pose])
        expected = flank_contact(*args, reference)
        assert difference(flank_contact(*args, fine), expected, PAPER) < 1e-4
        assert difference(flank_contact(*args, fast), expected, PAPER) < 4e-4


@pytest.mark.long
@pytest.mark.parametrize("pose", POSES)
def test_quadrature_agrees_with_points_on_the_flanks(pose: str) -> None:
    """900 000 points per flank, each an independent spring with its own exact position and normal."""
    args = state(PAPER, 0.31, **POSES[pose])
    found = flank_contact(*args, pack(PAPER, zone=ZONE, generators=FINE))
    assert difference(found, wrench_by_points(PAPER, *args, zone=ZONE), PAPER) < 1.5e-4


@pytest.mark.parametrize("lead_error", ["10 um", pytest.param("-10 um", marks=pytest.mark.long)])
def test_lead_error_agrees_with_points_on_the_flanks(lead_error: str) -> None:
    """The same points on the wrong helix; the load lies at one end of the teeth, which changes it by far more
    than the tolerance. Strips, with the stations of the default, at their own 4e-4."""
    gear = changed(pinion__lead_error=lead_error)
    args = state(gear, 0.31)
    expected = wrench_by_points(gear, *args, zone=ZONE)
    assert difference(flank_contact(*args, pack(gear, zone=ZONE, generators=FINE)), expected, gear) < 1.5e-4
    assert difference(flank_contact(*args, pack(gear, zone=ZONE)), expected, gear) < 4e-4
    assert difference(flank_contact(*args, pack(PAPER, zone=ZONE)), expected, gear) > 1e-2


@pytest.mark.parametrize(
    ("settings", "tolerance"),
    [
        ({"pinion__tip_relief": "20 um"}, 3e-4),
        ({"pinion__profile_slope": "5 um"}, 3e-4),
        ({"pinion__pitch_error": "3 um"}, 3e-4),
        ({"mesh__damping": "1e-3 s"}, 3e-4),
        ({"rack__reference_height": "10 mm"}, 1.2e-3),  # the bar's surface cuts most of the teeth away
        ({"pinion__helix_angle": 0.0, "rack__tooth_angle": 0.0}, 5e-4),
        (
            {"pinion__profile_shift": 0.65, "pinion__tip_diameter": "17.6 mm"},
            2e-3,
        ),  # strips at the form circle
        ({"pinion__crowning": "5 um"}, 5e-3),  # a kink between stations at one angle
    ],
)
def test_strip_agrees_with_fine_quadrature_for_other_gears(
    settings: dict[str, object], tolerance: float
) -> None:
    gear = changed(**settings)
    fast, reference = pack(gear, zone=ZONE), pack(gear, zone=ZONE, generators=FINE)
    for angle in ANGLES[::2]:
        args = state(gear, angle, press=12e-6)
        expected = flank_contact(*args, reference)
        assert difference(flank_contact(*args, fast), expected, gear) < tolerance


# --- mechanics -----------------------------------------------------------------------------------
def test_power_of_all_forces_is_stored_or_dissipated() -> None:
    """Law: the power of the forces on both bodies is minus (friction + damping + d energy / dt).

    Central differences over 2e-5 s, bodies moving arbitrarily. Where material leaves the contact at an edge
    of the rack, what it stored is lost; so the gear here has only edges of the pinion. The line law has no
    such balance: its line wanders over the flank, fully deep at its ends.
    """
    gear = inner_contact()
    data = pack(gear, zone=ZONE, along=8, across=4)
    a, w, p, r, v, s = state(gear, 0.2, turn=(2e-4, 0, 1e-4))
    v, s = v + np.array([1e-4, -2e-4, 3e-4]), np.array([0.01, -0.02, 0.015])

    def at(time: float) -> np.ndarray:
        turned = Rotation.from_rotvec(s * time).as_matrix() @ r
        return flank_contact(a + w * time, w, p + v * time, turned, v, s, data)

    out, dt = at(0.0), 1e-5
    stored = (at(dt)[ELASTIC_ENERGY] - at(-dt)[ELASTIC_ENERGY]) / (2 * dt)
    power = out[TORQUE] * w + out[FORCE] @ v + out[MOMENT] @ s
    assert power == pytest.approx(-(out[FRICTION_POWER] + out[DAMPING_POWER] + stored), rel=1e-4)


def inner_contact(**more: object) -> SteeringGear:
    """Narrow pinion in a wide rack with high teeth: only the pinion's own limits end the contact."""
    return changed(
        pinion__face_width="6 mm",
        rack__bar_diameter="30 mm",
        bush__inner_diameter="31 mm",
        bush__outer_diameter="36 mm",
        basic_rack__addendum=1.3,
        yoke__plunger_diameter="34 mm",
        **more,
    )


def test_frictionless_force_is_minus_the_gradient_of_the_energy() -> None:
    """Law: virtual work. Central differences of the energy over 2e-8 m (2e-6 rad); gear as above."""
    gear = inner_contact(mesh__friction=0.0)
    data = pack(gear, along=8, across=4)
    a, w, p, r, v, s = state(gear, 0.2, turn=(2e-4, 0, 1e-4))
    out = flank_contact(a, w, p, r, v, s, data)
    normal = out[NORMAL_DRIVE] + out[NORMAL_COAST]

    def energy(angle: float, shift: np.ndarray, turn: np.ndarray) -> float:
        turned = Rotation.from_rotvec(turn).as_matrix() @ r
        return float(flank_contact(a + angle, w, p + shift, turned, v, s, data)[ELASTIC_ENERGY])

    none = np.zeros(3)
    gradient = [(energy(1e-6, none, none) - energy(-1e-6, none, none)) / 2e-6]
    gradient += [(energy(0, 1e-8 * e, none) - energy(0, -1e-8 * e, none)) / 2e-8 for e in np.eye(3)]
    gradient += [(energy(0, none, 1e-6 * e) - energy(0, none, -1e-6 * e)) / 2e-6 for e in np.eye(3)]
    scale = normal * np.array([6e-3, 1, 1, 1, 1e-2, 1e-2, 1e-2])
    np.testing.assert_allclose(out[:7] / scale, -np.array(gradient) / scale, atol=1e-4)


def test_moment_and_force_balance_between_the_bodies() -> None:
    """Law: a common rigid motion of pinion and rack takes no power. Rounding only."""
    pair = GearPair.of(PAPER)
    a, w, p, r, _, _ = state(PAPER, 0.37, turn=(5e-4, 2e-4, 0))
    k = pair.pinion_frame[:, 2]
    rotates_together = flank_contact(a, w, p, r, np.cross(w * k, p), w * k, pack(PAPER, zone=ZONE))
    power = rotates_together[TORQUE] * w + rotates_together[FORCE] @ np.cross(w * k, p)
    power += rotates_together[MOMENT] @ (w * k)
    assert abs(power) < 1e-12
    assert rotates_together[FRICTION_POWER] == pytest.approx(0, abs=1e-12)


def test_friction_is_linear_in_the_zone_and_coulomb_outside() -> None:
    """Law: force = mu N v / max(v, zone). The whole field slides faster than 1e-5 and slower than 1 m/s."""
    args = state(PAPER, 0.2)
    coulomb, viscous = (
        flank_contact(*args, pack(PAPER, zone=1e-5)),
        flank_contact(*args, pack(PAPER, zone=1.0)),
    )
    softer = flank_contact(*args, pack(PAPER, zone=2.0))
    no_friction = flank_contact(*args, pack(changed(mesh__friction=0.0)))
    assert coulomb[FRICTION_POWER] > 50 * viscous[FRICTION_POWER]
    np.testing.assert_allclose(
        viscous[:7] - no_friction[:7], 2 * (softer - no_friction)[:7], rtol=1e-9, atol=1e-12
    )


def test_damping_never_pulls() -> None:
    """Law: pressure >= 0. Parting at 1 m/s with a long damping time leaves no force."""
    gear = changed(mesh__damping="1e-3 s")
    a, w, p, r, v, s = state(gear, 0.2)
    out = flank_contact(a, w, p, r, v + np.array([0, 1.0, 0]), s, pack(gear))
    assert out[NORMAL_DRIVE] == out[NORMAL_COAST] == 0


def test_out_of_mesh_is_no_contact() -> None:
    a, w, p, r, v, s = state(PAPER, 0.2)
    assert not flank_contact(a, w, p + np.array([0, 0.02, 0]), r, v, s, pack(PAPER)).any()


# --- symmetry ------------------------------------------------------------------------------------
def test_tooth_numbers_do_not_matter() -> None:
    """Law: one pinion tooth and one rack pitch further on everything repeats. Rounding of angle and place,
    which decides whether a limit at the very edge of a strip breaks the integration: 2e-7."""
    pair, data = GearPair.of(PAPER), pack(PAPER, zone=ZONE)
    a, w, p, r, v, s = state(PAPER, 0.2, turn=(5e-4, 0, 0))
    here = flank_contact(a, w, p, r, v, s, data)
    teeth, shift = 5 * 2 * np.pi / pair.teeth, 5 * pair.rack_pitch * r[:, 0]
    there = flank_contact(a - teeth, w, p + shift, r, v, s, data)
    there[MOMENT] += np.cross(shift, there[FORCE])
    assert difference(there, here, PAPER) < 3e-7


@pytest.mark.parametrize("lead_error", ["0 um", "5 um"])
def test_mirrored_gear_mirrors_the_forces(lead_error: str) -> None:
    """Law: with both helix angles reversed and the state mirrored in Z, forces and torque are mirrored.

    A lead error counts with the amount of the helix angle, and so is its own mirror image.
    """
    gear = changed(pinion__lead_error=lead_error)
    mirrored = gear.replace({"pinion.helix_angle": "-25 deg", "rack.tooth_angle": "-10 deg"})
    mirror = np.diag([1.0, 1.0, -1.0])
    a, w, p, r, v, s = state(gear, 0.2, turn=(5e-4, 2e-4, 0))
    p = p + np.array([0, 0, 1e-4])
    out = flank_contact(a, w, p, r, v, s, pack(gear, zone=ZONE))
    image = flank_contact(
        a, w, mirror @ p, mirror @ r @ mirror, mirror @ v, -mirror @ s, pack(mirrored, zone=ZONE)
    )
    image[FORCE], image[MOMENT] = mirror @ image[FORCE], -mirror @ image[MOMENT]
    assert difference(image, out, gear) < 1e-8


def test_reversed_motion_reverses_friction_only() -> None:
    """Law: Coulomb friction is odd in the motion; normal forces do not depend on it."""
    a, w, p, r, v, s = state(PAPER, 0.2)
    data, free = pack(PAPER, zone=ZONE), pack(changed(mesh__friction=0.0))
    forward, backward = flank_contact(a, w, p, r, v, s, data), flank_contact(a, -w, p, r, -v, s, data)
    np.testing.assert_allclose(
        (forward + backward)[:7] / 2, flank_contact(a, w, p, r, v, s, free)[:7], atol=1e-9
    )


# --- other views ----------------------------------------------------------------------------------
def test_line_law_is_stiffness_times_depth_times_length() -> None:
    """Law: an aligned line is equally deep all along, between the limits of flank and rack. The lengths are
    counted here on 20 000 sections of the face: 1e-3."""
    gear = changed(mesh__law="line")
    for angle in ANGLES[:4]:
        out = flank_contact(*state(gear, angle), pack(gear))
        for side, total in ((-1, out[NORMAL_DRIVE]), (+1, out[NORMAL_COAST])):
            force = line_stiffness(gear) * out[PENETRATION] * line_length(gear, angle, side)
            assert total == pytest.approx(force, rel=1e-3)


def line_length(gear: SteeringGear, angle: float, side: int) -> float:
    """Length of all lines of contact of one side at a steering angle, the rack aligned [m]."""
    pair, flank = GearPair.of(gear), Flank(GearPair.of(gear), 0, side)
    along_normal = -side * (pair.pinion_frame.T @ pair.rack_flank_normal(side))
    psi = np.arctan2(-along_normal[0], along_normal[1])
    z = pair.face_width * (np.linspace(0, 1, 20_001)[1:] - 0.5 - 1 / 40_000)
    c, s = np.cos(psi), np.sin(psi)
    touching = 0
    for tooth in range(-pair.teeth, pair.teeth):
        turned = -angle + 2 * np.pi * tooth / pair.teeth
        q = flank.tangent_length(psi, z) + side * pair.base_radius * turned
        x, y = pair.base_radius * c - side * q * s, pair.base_radius * s + side * q * c
        _, high, across = pair.pinion_frame @ [x, y, z]
        high -= pair.bar_axis_height - PRESS
        on_flank = (q > flank.form_tangent_length) & (q < flank.tip_tangent_length)
        on_rack = (high > -pair.reference_height - pair.rack_addendum) & (
            np.hypot(high, across) < pair.bar_radius
        )
        touching += np.count_nonzero(on_flank & on_rack)
    return float(touching / z.size * pair.face_width / np.cos(pair.beta_b))


# --- deviations of the gear -----------------------------------------------------------------------
def test_eccentric_gear_carries_the_rack_along() -> None:
    """Law: with the rack displaced as the gear's centre is, normal forces are those without runout. Friction
    is not: the centre moves, so the flanks slide otherwise."""
    e, angle = 40e-6, 0.7
    gear = changed(pinion__runout=e)
    a, w, p, r, v, s = state(gear, angle)
    centre = GearPair.of(gear).pinion_frame @ (e * np.array([np.sin(angle), np.cos(angle), 0]))
    plain = flank_contact(*state(PAPER, angle), pack(PAPER))
    out = flank_contact(a, w, p + centre, r, v, s, pack(gear))
    normal = [NORMAL_DRIVE, NORMAL_COAST]
    np.testing.assert_allclose(out[normal], plain[normal], rtol=1e-9)


def test_pitch_error_is_a_turn_of_one_tooth() -> None:
    """Law: tooth 0 carries what it would carry on a pinion turned by the error, the others what they did.

    What tooth 0 carries is what is missing with an error that takes it out of contact.
    """
    gear, angle = changed(pinion__pitch_error="3 um"), 0.2
    plain, wrong = pack(PAPER, zone=ZONE), pack(gear, zone=ZONE)
    turn = FlankForm.of(gear).turns(GearPair.of(gear))[0]
    assert turn == wrong.turns[0] != 0
    gone = np.eye(1, len(plain.turns))[0]
    a, w, p, r, v, s = state(PAPER, angle)
    for normal, away in ((NORMAL_DRIVE, 0.01), (NORMAL_COAST, -0.01)):

        def of_tooth_0(angle: float, normal: int = normal, away: float = away) -> float:
            data = plain, changed_record(plain, turns=away * gone)
            every, others = (flank_contact(angle, w, p, r, v, s, one)[normal] for one in data)
            return float(every - others)

        assert of_tooth_0(a) > 1
        change = (
            flank_contact(a, w, p, r, v, s, wrong)[normal] - flank_contact(a, w, p, r, v, s, plain)[normal]
        )
        assert change == pytest.approx(of_tooth_0(a + turn) - of_tooth_0(a), rel=1e-9)


def test_pitch_errors_of_the_rack_are_shifts_of_its_teeth() -> None:
    """Law: all teeth shifted by d are the rack shifted by d; each tooth by itself makes a part of that
    change, and the parts add up where each line carries its own load."""
    shift, angle = 2e-6, 0.2
    teeth = len(RackBar.of(PAPER).teeth)
    plain = pack(PAPER, zone=ZONE)
    a, w, p, r, v, s = state(PAPER, angle)
    before = flank_contact(a, w, p, r, v, s, plain)[:7]

    def change(errors: np.ndarray) -> np.ndarray:
        wrong = pack(changed(rack__pitch_errors=errors.tolist()), zone=ZONE)
        return np.asarray(flank_contact(a, w, p, r, v, s, wrong)[:7] - before)

    whole = change(np.full(teeth, shift))
    along = np.array([shift, 0.0, 0.0])
    of_rack = flank_contact(a, w, p + along, r, v, s, plain)[:7]
    of_rack[4:] += np.cross(along, of_rack[1:4])  # about the same point
    size = np.abs(before).max()
    assert np.abs(whole - (of_rack - before)).max() < 1e-3 * np.abs(whole).max()
    parts = [change(row) for row in shift * np.eye(teeth)]
    assert np.abs(sum(parts) - whole).max() < 1e-9 * size
    touched = [i - teeth // 2 for i, part in enumerate(parts) if np.abs(part).max() > 0]
    pitches = -PAIR.gain * angle / PAIR.rack_pitch  # the tooth opposite the pinion's axis
    assert 2 <= len(touched) <= 4
    assert max(abs(tooth - pitches) for tooth in touched) < 2


def test_a_list_with_one_error_is_the_single_pitch_error() -> None:
    one, listed = changed(pinion__pitch_error="3 um"), changed(pinion__pitch_errors=[3e-6, 0, 0, 0, 0, 0])
    assert (pack(one).turns == pack(listed).turns).all()


@pytest.mark.quick
@pytest.mark.parametrize("accuracy", [5, 8])
def test_drawn_errors_are_as_large_as_their_class_allows(accuracy: int) -> None:
    """ISO 1328-1:2013; class 8 of the default gear has f_pt 16.2 and F_p 43.0 um."""
    text = f"ISO 1328 class {accuracy}, seed 3"
    gear = SteeringGear().replace({"pinion.pitch_errors": text, "rack.pitch_errors": text})
    single, whole = class_tolerances(GearPair.of(gear), accuracy)
    if accuracy == 8:
        assert (1e6 * single, 1e6 * whole) == pytest.approx((16.25, 43.05), abs=0.01)
    pinion, rack = pinion_errors(gear), rack_errors(gear)
    for errors, steps in ((pinion, np.diff(np.append(pinion, pinion[0]))), (rack, np.diff(rack))):
        shares = np.abs(steps).max() / single, np.ptp(errors) / whole
        assert max(shares) == pytest.approx(1.0)
        assert errors.mean() == pytest.approx(0.0, abs=1e-12)
    assert (rack_errors(gear) == rack).all()
    other = gear.replace({"rack.pitch_errors": f"ISO 1328 class {accuracy}, seed 4"})
    assert (rack_errors(other) != rack).any()


@pytest.mark.quick
def test_rack_has_an_error_of_each_tooth() -> None:
    with pytest.raises(InputError, match="has 2 numbers; it must have 31, one for each tooth"):
        rack_errors(SteeringGear().replace({"rack.pitch_errors": [1e-6, 2e-6]}))


def test_axis_offset_is_an_opposite_shift_of_the_rack() -> None:
    """Law: only the distance between the bodies matters."""
    offset = 20e-6
    gear = changed(installation__axis_offset=offset)
    a, w, p, r, v, s = state(PAPER, 0.2, turn=(2e-4, 3e-4, -2e-4))
    out = flank_contact(a, w, p, r, v, s, pack(gear, zone=ZONE))
    shifted = flank_contact(a, w, p - np.array([0, offset, 0]), r, v, s, pack(PAPER, zone=ZONE))
    assert difference(out, shifted, PAPER) < 1e-9


def test_angle_error_is_an_opposite_yaw_of_the_rack() -> None:
    """Law: a pinion askew about Y is a straight one with the rack, and its round bar, turned back."""
    error = 1e-3
    gear = changed(installation__angle_error=error)
    frames = GearPair.of(gear).pinion_frame, GearPair.of(PAPER).pinion_frame
    back = frames[1] @ frames[0].T
    assert np.arccos((np.trace(back) - 1) / 2) == pytest.approx(error, rel=1e-6)
    a, w, p, r, v, s = state(PAPER, 0.2)
    out = flank_contact(a, w, p, r, v, s, pack(gear, zone=ZONE))
    turned = flank_contact(a, w, back @ p, back @ r, back @ v, s, pack(PAPER, zone=ZONE))
    turned[FORCE], turned[MOMENT] = back.T @ turned[FORCE], back.T @ turned[MOMENT]
    assert difference(out, turned, PAPER) < 1e-7
