"""Racks of variable ratio: their course, flanks against the pinion and a cutting simulation, solids.

The course of most tests is that of the theory page: 5.40 to 6.48 mm/rad between 40 and 150 degrees.
"""

import numpy as np
import pytest

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.geometry_limits import violations
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.masses import rack_masses
from rps_exudyn.gears.polyhedron import defect
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.parameters.gear import SteeringGear
from verification.planar_cutting import cut_space

PLAIN = SteeringGear()
TURN = 2 * np.pi
COURSE = {"rack.ratio.centre": TURN * 5.4e-3, "rack.ratio.lock": TURN * 6.48e-3, "rack.ratio.to": "150 deg"}
GEAR = PLAIN.replace(COURSE)
PAIR = GearPair.of(GEAR)
RACK = GeneratedRack.of(PAIR)
MESH = PAIR.design_mesh
LISTED = {
    "rack.ratio.angle": ["-200 deg", "-60 deg", "0 deg", "100 deg", "220 deg"],
    "rack.ratio.travel_per_turn": ["39 mm", "36 mm", "35 mm", "37 mm", "40 mm"],
}


# --- the course ------------------------------------------------------------------------------------
@pytest.mark.parametrize("settings", [COURSE, LISTED, COURSE | {"rack.ratio.from": 0.0}])
def test_gain_and_slope_are_derivatives_and_the_angle_is_the_inverse(settings: dict[str, object]) -> None:
    course = GearPair.of(PLAIN.replace(settings)).course
    assert course is not None
    angle, h = np.linspace(-5, 5, 1003), 1e-5
    rate = (course.travel(angle + h) - course.travel(angle - h)) / (2 * h)
    np.testing.assert_allclose(rate, course.gain(angle), atol=1e-9)
    slope = (course.gain(angle + h) - course.gain(angle - h)) / (2 * h)
    assert np.median(np.abs(slope - course.slope(angle))) < 1e-9  # but for corners of the slope
    np.testing.assert_allclose(course.angle(course.travel(angle)), angle, atol=1e-13)
    assert float(course.travel(0.0)) == pytest.approx(0.0, abs=1e-17)


def test_scalars_give_constant_steepness_and_lists_their_points() -> None:
    at = np.radians(np.linspace(45, 145, 60))
    steepness = MESH.tip_length * MESH.bend(PAIR.gain_at(at), RACK.course.slope(at))
    np.testing.assert_allclose(steepness, RACK.steepest, rtol=1e-3)
    listed = GearPair.of(PLAIN.replace(LISTED))
    angles = np.radians([-400, -200, -60, 0, 100, 220, 500])
    np.testing.assert_allclose(TURN * listed.gain_at(angles), np.array([39, 39, 36, 35, 37, 40, 40]) / 1e3)


def test_least_turn_is_that_of_the_closed_form() -> None:
    turns = [np.degrees(MESH.least_turn(5.4e-3, share * 5.4e-3)) for share in (1.1, 1.2, 1.27)]
    np.testing.assert_allclose(turns, [50, 68, 75], atol=0.5)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"rack.ratio.centre": "30 mm"}, "rack.ratio.centre leads to .* nearest admissible value is 32.9 mm"),
        ({"rack.ratio.lock": "80 mm"}, "rack.ratio.lock leads to .* nearest admissible value is 44.069 mm"),
        ({"rack.ratio.lock": "37 mm", "rack.ratio.to": "40 deg"}, "must be smaller than rack.ratio.to"),
        ({"rack.ratio.angle": "0, 1, 2, 3"}, "rack.ratio.travel_per_turn must be given with it"),
        ({**LISTED, "rack.ratio.lock": "37 mm"}, "give either of them"),
        ({**LISTED, "rack.ratio.angle": "0, 1, 2"}, "as many, 4 to 60"),
        ({**COURSE, "mesh.law": "teeth"}, "set mesh.law = line"),
        ({**COURSE, "housing.mount_stiffness": "1e7 N/m"}, "for a rack of constant ratio"),
    ],
)
def test_courses_that_cannot_be_are_refused_in_a_sentence(settings: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        GearPair.of(PLAIN.replace(settings))
    assert len(refused.value.problems) == 1


# --- flanks ----------------------------------------------------------------------------------------
def test_constant_course_is_the_rack_of_a_constant_ratio() -> None:
    """To a thousandth of a nanometre: planes of the same pressure and tooth angle."""
    rack = GeneratedRack.of(GearPair.of(PLAIN.replace({"rack.ratio.centre": TURN * GearPair.of(PLAIN).gain})))
    H, Z = np.linspace(6.1e-3, 8e-3, 7), np.linspace(-6e-3, 6e-3, 7)
    for tooth in (-3, 0, 2):
        for side in (-1, 1):
            flank = RackBar.of(PLAIN).flank(tooth, side)
            points = np.stack([rack.flank(side, tooth, H, Z), H - PAIR.bar_axis_height, Z], axis=-1)
            np.testing.assert_allclose((points - flank.point) @ flank.normal, 0, atol=1e-15)


@pytest.mark.parametrize("settings", [COURSE, LISTED])
def test_pinion_that_turns_by_the_course_touches_and_does_not_cut(settings: dict[str, object]) -> None:
    """Law of gearing: at points of its generator a flank's gap is zero; at all others it is not negative."""
    pair = GearPair.of(PLAIN.replace(settings))
    rack, mesh = GeneratedRack.of(pair), pair.design_mesh
    for phi in np.radians(np.linspace(-230, 230, 24)):
        for side in (-1, 1):
            S = float(mesh.sine(pair.gain_at(phi)))
            line = np.pi / 2 - side * np.arccos(S)  # the generator psi* in the housing
            near = round(phi * pair.teeth / TURN)
            flank = Flank(pair, near - (side > 0), side)
            q = np.linspace(flank.form_tangent_length, flank.tip_tangent_length, 40)
            touching = (flank.theta - phi - line - side * q / pair.base_radius) / pair.twist  # Z there
            for Z, least in ((touching, None), (np.linspace(-7e-3, 7e-3, 31)[:, None], 0.0)):
                x, y, z = flank.point(
                    flank.generator(q, Z), np.broadcast_to(Z, np.broadcast_shapes(Z.shape, q.shape))
                ).T
                c, s = np.cos(phi), np.sin(phi)
                X, H, across = np.tensordot(pair.pinion_frame, [c * x + s * y, c * y - s * x, z], axes=1)
                tooth = -near
                on = rack.tip_height < H
                chi = rack.generator(side, tooth, H[on], across[on])
                gap = X[on] - pair.travel_at(phi) - rack.flank(side, tooth, H[on], across[on])
                gap = gap * rack.plane(side, chi).normal[..., 0]
                assert gap.min() > -1e-11
                if least is None:
                    assert np.abs(gap).max() < 1e-11


@pytest.mark.parametrize("side", [-1, 1])
def test_flank_is_what_planar_sections_of_the_pinion_cut(side: int) -> None:
    """The simulation's steps of 0.1 degrees leave 2 nm."""
    chi, tooth = np.radians(95), -2
    H = np.linspace(6.2e-3, 7.6e-3, 5)
    Z = -RACK._flank(side, tooth, chi, H, 0.0)[1] * np.cos(MESH.delta) / PAIR.twist
    cut = cut_space(PAIR, -tooth - (side > 0), H, Z, chi + np.radians(np.arange(-15, 15, 0.1)))
    exact = RACK.flank(side, tooth, H, Z)
    np.testing.assert_allclose(cut.low if side > 0 else cut.high, exact, atol=5e-9)


@pytest.mark.parametrize(("steepness", "undercut"), [(0.95, False), (1.05, True)])
def test_undercut_begins_where_it_is_predicted(steepness: float, undercut: bool) -> None:
    """From 5 % beyond the limit on the simulation cuts 10 nm deeper than the form, close to the tips."""
    least = np.degrees(MESH.least_turn(5.4e-3, 6.48e-3))
    gear = PLAIN.replace(COURSE | {"rack.ratio.to": f"{40 + least / steepness} deg"})
    pair = GearPair.of(gear)
    rack, chi = GeneratedRack.of(pair), np.radians(40 + least / steepness / 2)
    assert rack.steepest == pytest.approx(steepness, rel=1e-3)
    S = float(MESH.sine(pair.gain_at(chi)))
    q = np.array([0.8, 0.98 / max(steepness, 1)]) * MESH.tip_length
    H = pair.base_radius * S + q * np.sqrt(1 - S**2)
    X, E, _ = rack._flank(1, -2, chi, H, 0.0)
    Z = -E * np.cos(MESH.delta) / pair.twist
    X = rack._flank(1, -2, chi, H, Z)[0]
    deeper = X - cut_space(pair, 1, H, Z, chi + np.radians(np.arange(-25, 25, 0.1))).low
    assert abs(deeper[0]) < 5e-9
    assert (deeper[1] > 5e-9) == undercut
    refusals = [item.sentence for item in violations(gear)]
    assert bool(refusals) == undercut
    if undercut:
        assert f"nearest admissible value is {40 + least:.1f}"[:-1] in refusals[0]


# --- the body --------------------------------------------------------------------------------------
def test_solid_is_closed_and_its_surface_is_the_exact_one() -> None:
    solid = rack_solid(GEAR, 5e-6)
    assert defect(solid.vertices, solid.faces) is None
    x, y, z = solid.vertices.T
    H, near = y + PAIR.bar_axis_height, np.abs(x) < 3e-3
    on = near & (H < 7.4e-3) & (RACK.tip_height + 1e-6 < H) & (np.hypot(y, z) < PAIR.bar_radius - 2e-5)
    assert np.count_nonzero(on) > 20
    beside = [np.abs(RACK.flank(side, 0, H[on], z[on]) - x[on]) for side in (-1, 1)]
    np.testing.assert_allclose(np.min(beside, axis=0), 0, atol=5e-6)  # where it meets the bar it has chords


def test_mass_of_the_bar_lies_between_those_of_its_ends() -> None:
    mass = rack_masses(GEAR)
    assert mass.mass == pytest.approx(2.258, rel=2e-3)  # the prototype's solid of a similar course: 2.2566 kg
    np.testing.assert_allclose(mass.centre_of_mass, [0.1482, 0.00022, 0.0], atol=2e-4)


def test_crests_and_root_are_those_of_the_envelope() -> None:
    lands = RACK.tip_land(np.arange(-6, 7))
    assert 1.45e-3 < lands.min() < lands.max() < 1.65e-3
    section = RACK.tooth(0, 2e-3, 12, 24)
    assert (np.diff(section[:, 0]) > 0).all()
    assert section[:, 1].max() == pytest.approx(RACK.root_height, rel=1e-12)
    assert RACK.root_height > PAIR.tip_radius
