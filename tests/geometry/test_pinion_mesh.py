"""The ruled mesh of the pinion: closed, within its chord error, converging with order 2."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings

from geometry.random_gears import gear_pairs
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank, transverse_profile
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.polyhedron import Solid, defect
from rps_exudyn.parameters.gear import SteeringGear
from verification.flank_deviation import flank_deviation

PAPER = GearPair.of(SteeringGear())


@settings(max_examples=15)
@given(gear_pairs())
def test_any_gear_is_closed_and_within_the_chord_error(pair: GearPair) -> None:
    """No open edge, no inverted face, no sliver; flat strips lie inside the convex flank.

    The sagitta formula is the second-order term; the third, smaller by the angle between two generators
    (0.01 to 0.03 rad here), may add a hundredth and lift long diagonals a hundredth out of the flank.
    """
    chord_error = 1e-4 * pair.module
    mesh = pinion_mesh(pair, chord_error)
    assert defect(mesh.vertices, mesh.faces) is None
    deviation = flank_deviation(pair, mesh.vertices, mesh.faces)
    assert deviation.maximum <= 0.02 * chord_error
    assert -deviation.minimum <= 1.02 * chord_error


def test_chord_error_is_used_not_only_kept() -> None:
    """The coarsest strips allowed are taken: the largest deviation is close to the one wanted."""
    mesh = pinion_mesh(PAPER, 1e-7)
    deviation = flank_deviation(PAPER, mesh.vertices, mesh.faces)
    assert 0.95e-7 < -deviation.minimum < 1e-7


@pytest.mark.parametrize("tooth", [0, 4])
@pytest.mark.parametrize("side", [-1, 1])
def test_flanks_can_be_addressed_and_look_outwards(tooth: int, side: int) -> None:
    """The faces filed under a tooth and side lie on that flank, their normals along its normal."""
    mesh = pinion_mesh(PAPER, 1e-7)
    corners = mesh.vertices[mesh.flanks[tooth, side].faces]
    flank = Flank(PAPER, tooth, side)
    assert np.abs(flank.distance(corners)).max() < 1e-15  # vertices are on the helicoid, up to rounding
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    raised = flank.distance(corners.mean(axis=1) + 1e-5 * normals)
    assert raised.min() > 0.98e-5  # 1e-5 less the chord error and the tilt of a strip


def test_area_of_the_flank_is_the_integral_of_the_area_element() -> None:
    """dA = q / cos beta_b dpsi dZ; at fixed Z q runs from form to tip circle, dq = -+ r_b dpsi.

    A = b (q_a^2 - q_f^2) / (2 r_b cos beta_b). Chords are short by a relative 1 / 24 of the step squared:
    2e-6 for a chord error of 1e-8 m.
    """
    mesh, flank = pinion_mesh(PAPER, 1e-8), Flank(PAPER, 0, 1)
    corners = mesh.vertices[mesh.flanks[0, 1].faces]
    area = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )
    q_f, q_a = flank.form_tangent_length, flank.tip_tangent_length
    exact = PAPER.face_width * (q_a**2 - q_f**2) / (2 * PAPER.base_radius * np.cos(PAPER.beta_b))
    assert area == pytest.approx(exact, rel=1e-5)


def section_integrals(pair: GearPair) -> tuple[float, float]:
    """Area [m^2] and polar second moment [m^4] of the analytic section, from a 2e-13 m polygon."""
    x, y = transverse_profile(pair, 2e-13).T
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y1 - x1 * y
    return float(cross.sum() / 2), float(
        (cross * (x * x + x * x1 + x1 * x1 + y * y + y * y1 + y1 * y1)).sum() / 12
    )


def test_volume_and_inertia_converge_with_order_two() -> None:
    """To the analytic section's: V = A b, J_z = rho b I_p, J_x = rho (b I_p / 2 + A b^3 / 12).

    (A section with three or more equal teeth has the same moment about every diameter, so the helix's turn
    does not matter.) The order is fitted over a factor 8 of the step; parts of the mesh round their
    number of strips up, hence 2 within 0.1.
    """
    density, b = 7850.0, PAPER.face_width
    area, polar = section_integrals(PAPER)
    exact = np.array([area * b, density * b * polar, density * (b * polar / 2 + area * b**3 / 12)])
    chord_errors = 2.5e-7 / 4.0 ** np.arange(4)
    errors = []
    for chord_error in chord_errors:
        mesh = pinion_mesh(PAPER, chord_error)
        properties = Solid(mesh.vertices, mesh.faces, density).mass_properties
        found = [properties.volume, properties.inertia[2, 2], properties.inertia[0, 0]]
        errors.append(np.abs(found / exact - 1))
        assert np.abs(properties.centre_of_mass).max() < 1e-9  # the section's symmetry
    steps = np.sqrt(chord_errors)
    for error in np.transpose(errors):
        order = np.polyfit(np.log(steps), np.log(error), 1)[0]
        assert order == pytest.approx(2, abs=0.1)
    assert max(errors[-1]) < 4e-6


@pytest.mark.parametrize("helix", [0.0, -0.4, 0.4])
def test_modified_flanks_deviate_as_wanted_and_stay_closed(helix: float) -> None:
    """Tip relief, crowning and slope, measured back from the mesh's vertices.

    Displacing along e_t is exact for the helicoid's parallel surfaces; vertices are good to rounding.
    """
    pair = dataclasses.replace(PAPER, beta_p=helix, tip_radius=8e-3)
    form = FlankForm(tip_relief=8e-6, tip_relief_length=1e-3, crowning=5e-6, profile_slope=3e-6)
    mesh = pinion_mesh(pair, 1e-7, form)
    assert defect(mesh.vertices, mesh.faces) is None
    flank, patch = Flank(pair, 3, -1), mesh.flanks[3, -1]
    surplus = flank.distance(mesh.vertices) / np.cos(pair.beta_b)
    corner_tip, corner_form = patch.upper_edge[-1], patch.upper_edge[0]
    assert surplus[corner_tip] == pytest.approx(3e-6 - 8e-6 - 5e-6, abs=1e-15)
    assert surplus[corner_form] == pytest.approx(-5e-6, abs=1e-15)


@pytest.mark.parametrize("helix", [0.0, -0.4, 0.4])
@pytest.mark.parametrize("lead_error", [8e-6, -60e-6])
def test_lead_error_turns_the_sections_of_every_tooth(helix: float, lead_error: float) -> None:
    """Law (ISO 1328-1): over the face width the flanks part from the design by f_Hbeta along the line of
    action, in the sense of a larger helix angle if it is positive, both flanks of a tooth the same way.

    The distance from the designed helicoid is exact; what is left is rounding.
    """
    pair, form = dataclasses.replace(PAPER, beta_p=helix, tip_radius=8e-3), FlankForm(lead_error=lead_error)
    mesh = pinion_mesh(pair, 1e-7, form)
    assert defect(mesh.vertices, mesh.faces) is None
    larger = -1 if helix < 0 else 1  # a positive helix angle turns the sections by -Z twist
    for (tooth, side), patch in mesh.flanks.items():
        for edge, place in ((patch.lower_edge, -0.5), (patch.upper_edge, 0.5)):
            ahead = side * Flank(pair, tooth, side).distance(mesh.vertices[edge]) / np.cos(pair.beta_b)
            np.testing.assert_allclose(ahead, -larger * lead_error * place, rtol=0, atol=1e-14)


def test_pitch_error_displaces_one_tooth() -> None:
    """Tooth 0 stands f_pt along the reference circle, both flanks the same way; the others stay."""
    form = FlankForm(pitch_error=20e-6)
    mesh = pinion_mesh(PAPER, 1e-6, form)
    assert defect(mesh.vertices, mesh.faces) is None
    normal_shift = 20e-6 / PAPER.reference_radius * PAPER.base_radius * np.cos(PAPER.beta_b)
    for (tooth, side), patch in mesh.flanks.items():
        distance = Flank(PAPER, tooth, side).distance(mesh.vertices[patch.form_edge])
        expected = side * normal_shift if tooth == 0 else 0.0
        np.testing.assert_allclose(distance, expected, rtol=0, atol=1e-15)
