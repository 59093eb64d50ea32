"""Stresses of the teeth by ISO 6336: printed factors, the generated root, and laws of similarity."""

import dataclasses

import numpy as np
import pytest

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import transverse_contact_ratio
from rps_exudyn.gears.tooth_strength import (
    ToothForm,
    bearing_face,
    flank_stress,
    pinion_form,
    rack_form,
    root_load_factor,
    root_of,
    root_stress,
)
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()
ALPHA = np.deg2rad(20.0)


@pytest.mark.parametrize(
    ("teeth", "form", "correction"),
    [
        (17, 2.97, 1.52),
        (20, 2.80, 1.55),
        (30, 2.52, 1.625),
        (50, 2.32, 1.70),
        (100, 2.18, 1.79),
        (1e6, 2.06, 1.97),
    ],
)
def test_factors_of_the_standard_profile(teeth: float, form: float, correction: float) -> None:
    """Y_Fa and Y_Sa of the basic rack A without shift, as textbooks of machine elements print them, read off
    a chart to 0.8 %."""
    root = root_of(ToothForm(teeth, 0.0, 1.0, ALPHA, 1.25, 0.38))
    assert root.form_factor == pytest.approx(form, rel=8e-3)
    assert root.stress_correction == pytest.approx(correction, rel=8e-3)


def test_root_of_a_rack_is_that_of_its_straight_profile() -> None:
    """The 30 degree tangent of a rack's fillet, by hand: the circle of radius rho about its centre."""
    dedendum, rho = 1.25, 0.38
    centre_height = dedendum - rho
    half_space = np.pi / 4 - centre_height * np.tan(ALPHA) - rho / np.cos(ALPHA)  # to the circle's centre
    half_tooth = np.pi / 2 - half_space - rho * np.cos(np.pi / 6)
    root = root_of(rack_form(GearPair.of(GEAR)))
    assert root.thickness == pytest.approx(2 * half_tooth, rel=1e-5)
    assert root.radius == pytest.approx(rho, rel=1e-4)


def test_root_stress_of_a_rack_is_that_of_a_calculation_by_hand() -> None:
    """ISO 6336-3 with the load at the tip: the line of the force, its lever and both factors of a straight
    tooth need no generated root; that is taken as infinitely many teeth to 1e-4."""
    pair = GearPair.of(GEAR)
    module = pair.module
    addendum, dedendum, rho = 2.0, 2.5, 0.76  # [mm] of the module 2 below; the default rack's parts of it
    assert (pair.rack_addendum, pair.rack_dedendum, pair.fillet_radius) == pytest.approx(
        tuple(each / 2 * module for each in (addendum, dedendum, rho))
    )
    tip = np.pi / 2 - addendum * np.tan(ALPHA)  # half the thickness at the tip
    meets = addendum - tip * np.tan(ALPHA)  # height at which the force crosses the tooth's middle
    lever = meets + dedendum - rho / 2
    half_space = np.pi / 2 - (dedendum - rho) * np.tan(ALPHA) - rho / np.cos(ALPHA)
    chord = 2 * (np.pi - half_space - rho * np.cos(np.pi / 6))
    form = 6 * (lever / 2) * np.cos(ALPHA) / ((chord / 2) ** 2 * np.cos(ALPHA))
    slender, notch = chord / lever, chord / (2 * rho)
    correction = (1.2 + 0.13 * slender) * notch ** (1 / (1.21 + 2.3 / slender))
    beta, face = abs(pair.beta_r), 2 * np.sqrt(0.012**2 - (0.0085 + pair.rack_addendum) ** 2)
    assert face == pytest.approx(12.21e-3, abs=0.02e-3)  # of a bar of 24 mm, reference line 8.5 mm high
    assert transverse_contact_ratio(pair) < 1  # one pair bears all: Y_epsilon is 1
    overlap = min(face * np.sin(abs(pair.beta_p)) / (np.pi * module), 1.0)
    inclined = 1 - overlap * beta / np.deg2rad(120)
    force = 30.0 / pair.reference_radius
    by_hand = force / (face * module) * form * correction * inclined
    assert root_stress(GEAR, rack_form(pair), 30.0) == pytest.approx(by_hand, rel=1e-4)


def test_teeth_scale() -> None:
    """Twice as large in all lengths: eight times the torque for the same stresses."""
    pair = GearPair.of(GEAR)
    lengths = {
        "pinion.normal_module": 2 * pair.module,
        "pinion.tip_diameter": 4 * pair.tip_radius,
        "pinion.face_width": 2 * pair.face_width,
        "pinion.shaft_diameter": 2 * GEAR.pinion.shaft_diameter,
        "rack.bar_diameter": 2 * GEAR.rack.bar_diameter,
        "rack.reference_height": 2 * GEAR.rack.reference_height,
        "bush.inner_diameter": "50 mm",
        "bush.outer_diameter": "60 mm",
        "yoke.plunger_diameter": "60 mm",
        "yoke.nut_diameter": "72 mm",
    }
    larger = GEAR.replace(lengths)
    for form in (pinion_form, rack_form):
        small, large = form(pair), form(GearPair.of(larger))
        assert root_stress(larger, large, 8 * 30.0) == pytest.approx(root_stress(GEAR, small, 30.0), rel=1e-9)
    assert flank_stress(larger, 8 * 30.0) == pytest.approx(flank_stress(GEAR, 30.0), rel=1e-9)


def test_bending_grows_with_the_torque_and_pressure_with_its_root() -> None:
    form = pinion_form(GearPair.of(GEAR))
    assert root_stress(GEAR, form, 40.0) == pytest.approx(2 * root_stress(GEAR, form, -20.0))
    assert flank_stress(GEAR, 40.0) == pytest.approx(np.sqrt(2) * flank_stress(GEAR, 20.0))


def test_contact_stress_is_hertz_at_the_pitch_point_of_spur_teeth() -> None:
    """A cylinder of radius r sin(alpha) on a plane under F_t / cos(alpha): Hertz's line contact. With a
    contact ratio of 1 and no overlap the standard's factors are 1."""
    spur = GEAR.replace({"pinion.helix_angle": "0.001 deg", "rack.tooth_angle": 0.0, "pinion.teeth": 12})
    pair = GearPair.of(spur)
    line_load = 30.0 / pair.reference_radius / np.cos(pair.alpha_n) / bearing_face(pair)
    modulus = 206e9 / (2 * (1 - 0.3**2))
    hertz = np.sqrt(line_load * modulus / np.pi / (pair.reference_radius * np.sin(pair.alpha_n)))
    ratio = transverse_contact_ratio(pair)
    assert flank_stress(spur, 30.0) == pytest.approx(hertz * np.sqrt((4 - ratio) / 3), rel=1e-5)


def test_a_contact_ratio_below_1_raises_the_pressure() -> None:
    """Fewer lines bear: of spur teeth Z_epsilon is sqrt((4 - eps) / 3), above 1 below a contact ratio of "
    "1."""
    pair = GearPair.of(GEAR)
    ratio, overlap = transverse_contact_ratio(pair), bearing_face(pair) * np.sin(abs(pair.beta_p))
    overlap /= np.pi * pair.module
    sharing = np.sqrt((4 - ratio) / 3 * (1 - overlap) + overlap / ratio)
    wide = GEAR.replace({"rack.reference_height": "6 mm"})  # the bar leaves the pinion's whole face
    assert bearing_face(GearPair.of(wide)) == pair.face_width
    assert sharing > 1.05
    assert flank_stress(GEAR, 30.0) == pytest.approx(sharing / 1.0 * _unshared(GEAR, 30.0), rel=1e-9)


def _unshared(gear: SteeringGear, torque: float) -> float:
    """Z_H Z_E Z_beta sqrt(F_t / (d_1 b)), the modulus over 2 pi (1 - nu^2)."""
    pair = GearPair.of(gear)
    zone = np.sqrt(2 * np.cos(pair.beta_b) / (np.cos(pair.alpha_t) * np.sin(pair.alpha_t)))
    square = torque / pair.reference_radius / (2 * pair.reference_radius * bearing_face(pair))
    return float(zone * np.sqrt(206e9 / (2 * np.pi * 0.91) * square / np.cos(pair.beta_p)))


def test_a_sharper_fillet_bears_less() -> None:
    pair = GearPair.of(GEAR)
    sharp = dataclasses.replace(rack_form(pair), fillet=0.1)
    assert root_stress(GEAR, sharp, 30.0) > 1.1 * root_stress(GEAR, rack_form(pair), 30.0)


def test_load_along_the_face_raises_the_root_s_stress_less_than_the_flank_s_load() -> None:
    """ISO 6336-1: K_F-beta = K_H-beta^N_F, N_F = 9/13 where the face is at most three tooth depths."""
    pair = GearPair.of(GEAR)
    for form in (pinion_form(pair), rack_form(pair)):
        assert root_load_factor(pair, form, 1.0) == 1.0
        depth = (form.tip + form.dedendum - form.shift) * pair.module
        assert depth == pytest.approx(4.1e-3, rel=0.15)
        x = max(3.0, bearing_face(pair) / depth)
        assert 2 ** (9 / 13) <= root_load_factor(pair, form, 2.0) < 2.0
        assert root_load_factor(pair, form, 2.0) == pytest.approx(2 ** (1 / (1 + 1 / x + 1 / x**2)))
