"""Spheres on the flanks against points on the real flanks, against the flank contact, and against their law.

Grids of 27 x 18 spheres are noisy: a line of contact touches one or two rows of them. Tolerances are that
noise; what the tests are about, limits out of place and loads that depend on the radius, is several times
larger.
"""

from typing import Any

import numpy as np
import pytest

from flank_points import wrench_by_points
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.run import run
from rps_exudyn.solvers.sphere_groups import standing_out
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.mean_depth import axial_reach, contact_ends, mean_depth, rack_approach
from rps_exudyn.tooth_contact.spheres import contact_data, sphere_radius, stiffness_per_area
from rps_exudyn.tooth_contact.wrench import NORMAL_COAST, NORMAL_DRIVE, TORQUE
from verification.contact_at import flank_contact, sampled_wrench
from verification.law_area import by_law

ZONE = 1e-5  # [m/s]
BOTH = [NORMAL_DRIVE, NORMAL_COAST]
PAPER: dict[str, Any] = {}
SMALL: dict[str, Any] = {  # teeth of half a millimetre
    "basic_rack.addendum": 0.9175,
    "basic_rack.dedendum": 1.1777,
    "basic_rack.fillet_radius": 0.3143,
    "pinion.teeth": 15,
    "pinion.normal_module": "0.5386 mm",
    "pinion.pressure_angle": 0.4645,
    "pinion.helix_angle": -0.1823,
    "pinion.profile_shift": -0.2377,
    "pinion.tip_diameter": "8.536 mm",
    "pinion.face_width": "7.806 mm",
    "pinion.shaft_diameter": "2.45 mm",
    "rack.tooth_angle": 0.4053,
    "rack.bar_diameter": "7.880 mm",
    "rack.reference_height": "2.562 mm",
    "bush.inner_diameter": "8.65 mm",
    "bush.outer_diameter": "9.34 mm",
    "yoke.preload": "100 N",
    "yoke.plunger_diameter": "8.47 mm",
}
SOFT: dict[str, Any] = {
    "mesh.stiffness": "2e12 N/m^3",
    "mesh.line_stiffness": "2 N/mm/um",
}  # the preload presses the rack in by 67 um


def gear_of(settings: dict[str, Any], law: str) -> SteeringGear:
    return by_law(SteeringGear().replace(settings), law)


def pressed(gear: SteeringGear, angle: float) -> Any:
    """A kernel's arguments: the rack pressed in as the preload does in the mean, moving with the pinion."""
    pair = GearPair.of(gear)
    height = pair.bar_axis_height - rack_approach(pair, mean_depth(gear))
    still = np.array([pair.gain * angle, height, 0]), np.eye(3), np.array([pair.gain, 0, 0]), np.zeros(3)
    return -angle, -1.0, *still


def spheres(gear: SteeringGear, profile: int = 27, axial: int = 18) -> Any:
    return contact_data(gear, profile=profile, axial=axial, friction_zone=ZONE)


@pytest.mark.parametrize("settings", [PAPER, SMALL, SOFT], ids=["paper", "small teeth", "soft teeth"])
def test_spheres_press_as_points_on_the_flanks_do(settings: dict[str, Any]) -> None:
    """The same law, summed over cells that end at the real rack's tips: 1.5 % of the load and of the torque
    without friction, which is the difference of two flanks. Ends laid for a rack that is not pressed in miss
    8 % of the soft teeth's load, planes longer than small teeth press on the next ones."""
    gear = gear_of(settings, "area")
    radius, data = GearPair.of(gear).base_radius, spheres(gear)
    for angle in (0.31, 0.93):
        args = pressed(gear, angle)
        expected = wrench_by_points(gear, *args, zone=ZONE, shape=(1500, 150))
        found = sampled_wrench(*args, data)
        load = expected[BOTH].sum()
        np.testing.assert_allclose(found[BOTH], expected[BOTH], atol=0.015 * load)
        assert found[TORQUE] == pytest.approx(expected[TORQUE], abs=0.015 * load * radius)


@pytest.mark.parametrize("law", ["area", "line"])
@pytest.mark.parametrize("settings", [PAPER, SMALL, SOFT], ids=["paper", "small teeth", "soft teeth"])
def test_mean_depth_carries_half_the_wedge_of_the_preload(settings: dict[str, Any], law: str) -> None:
    """Law: averaged over a tooth pitch, each side carries P / (2 sin alpha_n) at the mean depth. The mean of
    16 angles by the flank contact is off by 0.03 %; by 1.4 % on the small teeth, which touch near the base
    circle, where the strip is as wide as the radius of curvature allows and its parabola is crude."""
    gear = gear_of(settings, law)
    pair, data = GearPair.of(gear), pack(gear, zone=ZONE)
    angles = 2 * np.pi / pair.teeth * (np.arange(16) + 0.5) / 16
    loads = np.mean([flank_contact(*pressed(gear, angle), data)[BOTH] for angle in angles], axis=0)
    np.testing.assert_allclose(loads, gear.yoke.preload / (2 * np.sin(pair.alpha_n)), rtol=0.02)


def test_field_of_contact_ends_on_the_round_bar_pressed_in() -> None:
    """Or at the pinion's end faces: points of the flanks' common normal, 0.1 mm below their place."""
    pair, below = GearPair.of(SteeringGear()), 1e-4
    e, y, k = pair.pinion_frame[:, 0], np.array([0.0, 1, 0]), pair.pinion_frame[:, 2]
    q = np.linspace(*contact_ends(pair, below), 9)
    along = q - pair.reference_radius * np.sin(pair.alpha_t)
    for side in (-1, 1):
        normal = np.outer(along, np.sin(pair.alpha_t) * y - side * np.cos(pair.alpha_t) * e)
        for Z in axial_reach(pair, side, q, below):
            _, height, across = (pair.reference_radius * y + normal + np.outer(Z, k)).T
            radius = np.hypot(height - pair.bar_axis_height + below, across)
            inside = np.abs(Z) < pair.face_width / 2
            assert inside.any()
            assert radius[inside] == pytest.approx(pair.bar_radius)
            assert np.all(radius[~inside] <= pair.bar_radius)


STIFFNESS = {"mesh.line_stiffness": "13.8 N/mm/um"}  # mean depth 2.5 um


def test_weighted_spheres_press_as_the_line_law_does_at_the_mean_depth() -> None:
    """Law: load per length c' d_0 whatever the radius of curvature, so loads and moments are those of the
    line law. The chords of the pinion's triangles lie 0.05 um inside the flank in the mean, which is 3 %
    of the load at a depth of 2.5 um: 2 % of both sides' load for each. Moments compare the sides: 1 %."""
    gear = gear_of(PAPER | STIFFNESS, "line")
    data, reference = spheres(gear, 54, 36), pack(gear, zone=ZONE)
    for angle in (0.1, 0.31, 0.93):
        args = pressed(gear, angle)
        found, expected = sampled_wrench(*args, data), flank_contact(*args, reference)
        load = expected[BOTH].sum()
        np.testing.assert_allclose(found[BOTH], expected[BOTH], atol=0.02 * load)
        moment = 0.01 * load * GearPair.of(gear).base_radius
        np.testing.assert_allclose(found[4:7], expected[4:7], atol=moment)


@pytest.mark.parametrize(("share", "expected"), [(0.5, 1.089), (1.0, 1.0), (2.0, 1.076)])
def test_spheres_that_stand_out_follow_the_line_law_over_the_depth(share: float, expected: float) -> None:
    """Law: ((d + h) / (d_0 + h))^(3/2) d_0 / d of the line law's load with h = d_0 / 2. The chords of the
    triangles, 0.05 um, and the noise of 27 x 18 spheres: 4 %. Spheres on the flank bear 0.71 of it at half
    and 1.41 at twice the depth."""
    gear = gear_of(PAPER | STIFFNESS, "line")
    pair, reference = GearPair.of(gear), pack(gear, zone=ZONE)
    data = standing_out(spheres(gear), gear, profile=27, axial=18)
    found = wanted = 0.0
    for angle in np.linspace(0, 2 * np.pi / pair.teeth, 8, endpoint=False):
        args = list(pressed(gear, angle))
        height = pair.bar_axis_height - share * rack_approach(pair, mean_depth(gear))
        args[2] = np.array([pair.gain * angle, height, 0])
        found += sampled_wrench(*args, data)[BOTH].sum()
        wanted += flank_contact(*args, reference)[BOTH].sum()
    assert found / wanted == pytest.approx(expected, rel=0.04)


@pytest.mark.quick
def test_load_per_length_of_weighted_spheres_does_not_depend_on_the_radius() -> None:
    """Law: 4/3 k d sqrt(2 d) rho / sqrt(rho - r) = c' d at the mean depth, on the strip that spheres of
    radius r make of a flank of radius rho. Rounding only."""
    gear = gear_of(PAPER, "line")
    rho, depth = np.array([0.5e-3, 1e-3, 4e-3]), 2e-6
    k = stiffness_per_area(gear, depth, rho)
    per_length = (
        4 / 3 * k * depth * np.sqrt(2 * depth) * rho / np.sqrt(rho - sphere_radius(GearPair.of(gear)))
    )
    np.testing.assert_allclose(per_length, line_stiffness(gear) * depth, rtol=1e-12)


@pytest.mark.quick
def test_spheres_that_do_not_fit_into_the_flank_bear_nothing() -> None:
    """Their centres lie beyond the centre of curvature: they would touch where the flank does not."""
    gear = gear_of(PAPER, "area")
    radius = sphere_radius(GearPair.of(gear))
    found = stiffness_per_area(gear, 2e-6, radius * np.array([0.5, 1.0, 1e6]))
    np.testing.assert_allclose(found, [0.0, 0.0, gear.mesh.stiffness], rtol=1e-6)


@pytest.mark.quick
def test_spheres_grow_with_the_module() -> None:
    """Law: similar gears have similar spheres."""
    small, paper = (GearPair.of(gear_of(settings, "area")) for settings in (SMALL, PAPER))
    ratio = sphere_radius(small) / sphere_radius(paper)
    assert ratio == pytest.approx(small.module / paper.module)


@pytest.mark.quick
def test_spheres_have_no_law_of_teeth() -> None:
    gear = gear_of(PAPER, "line")
    other = gear.model_copy(update={"mesh": gear.mesh.model_copy(update={"law": "teeth"})})
    with pytest.raises(InputError, match=r"mesh\.law is teeth, but .* has only line"):
        stiffness_per_area(other, 2e-6, np.ones(1))


@pytest.mark.parametrize("law", ["area", "line"])
@pytest.mark.parametrize("preload", ["150 N", "600 N"])
def test_mean_torque_of_spheres_is_that_of_the_flank_contact(law: str, preload: str) -> None:
    """The same law by two methods over a tooth pitch: 0.3 %. Between the laws are 2.4 %."""
    gear = gear_of({"test.turns": 1 / 6, "yoke.preload": preload}, law)
    still = Fidelity.preset("quasi-static")
    sampled = still.replace({"mesh": "general-contact", "step_angle": "2 deg"})
    found, expected = (
        run("free-pinion-torque", gear, fidelity=fidelity).summary for fidelity in (sampled, still)
    )
    assert found["torque_mean"] == pytest.approx(expected["torque_mean"], rel=3e-3)
