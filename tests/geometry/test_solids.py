"""Mass properties against closed forms, and the guard against meshes that no contact search survives."""

import numpy as np
import pytest
import trimesh

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.export import assembled, rack_position
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.polyhedron import Solid, defect, refuse_defects, to_manifold
from rps_exudyn.gears.solids import (
    bush_segment_solid,
    gear_solids,
    pinion_solid,
    plunger_ends,
    plunger_solid,
    yokenut_solid,
)
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()
ROUNDING = 1e-13  # relative, of sums over some thousand faces


def brick(size: tuple[float, float, float], centre: tuple[float, float, float]) -> Solid:
    box = trimesh.creation.box(size)
    return Solid(box.vertices + centre, box.faces, 1000.0)


def test_brick_far_from_the_origin_is_exact() -> None:
    """m = rho a b c, J_x = m (b^2 + c^2) / 12; a kilometre away 1e-16 * 1e3 / 0.01 m are lost."""
    solid = brick((0.01, 0.02, 0.03), (1e3, -1e3, 0.5))
    properties = solid.mass_properties
    mass = 1000 * 6e-6
    assert properties.mass == pytest.approx(mass, rel=1e-10)
    np.testing.assert_allclose(properties.centre_of_mass, [1e3, -1e3, 0.5], rtol=1e-15)
    expected = mass / 12 * np.array([13e-4, 10e-4, 5e-4])
    np.testing.assert_allclose(np.diag(properties.inertia), expected, rtol=1e-10)
    assert np.abs(properties.inertia - np.diag(np.diag(properties.inertia))).max() < 1e-10 * expected.max()


@pytest.mark.parametrize("name", gear_solids(GEAR))
def test_every_part_is_sound_and_agrees_with_trimesh(name: str) -> None:
    """An independent implementation of the same integrals."""
    solid = gear_solids(GEAR)[name]
    assert defect(solid.vertices, solid.faces) is None
    other = trimesh.Trimesh(solid.vertices, solid.faces, process=False)
    other.density = solid.density
    properties = solid.mass_properties
    assert properties.mass == pytest.approx(other.mass, rel=ROUNDING)
    np.testing.assert_allclose(properties.centre_of_mass, other.center_mass, rtol=0, atol=1e-12)
    scale = np.abs(properties.inertia).max()
    np.testing.assert_allclose(properties.inertia, other.moment_inertia, rtol=0, atol=1e-11 * scale)


def test_round_parts_converge_to_cylinders_with_order_two() -> None:
    """Yokenut: V = pi r^2 h; an inscribed n-gon is short by sinc(2 pi / n), 4 times less per halving."""
    radius, height = GEAR.yoke.nut_diameter / 2, GEAR.yoke.nut_thickness
    exact = np.pi * radius**2 * height
    errors = [1 - yokenut_solid(GEAR, e).mass_properties.volume / exact for e in (4e-6, 1e-6, 2.5e-7)]
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4, rtol=0.05)


def test_bush_segments_make_up_the_bush() -> None:
    """25 segments weigh what a hollow cylinder of the bush's size does; 2e-4 for the inscribed polygons."""
    bush = GEAR.bush
    tube = np.pi / 4 * (bush.outer_diameter**2 - bush.inner_diameter**2) * bush.length * bush.density
    assert bush.segments * bush_segment_solid(GEAR).mass_properties.mass == pytest.approx(tube, rel=2e-4)


def test_plunger_has_its_declared_mass_and_a_seat_on_the_bar() -> None:
    """Seat points are on the bar's radius (up to the polygon, 1 um); nothing is closer than that."""
    plunger, radius = plunger_solid(GEAR), GEAR.rack.bar_diameter / 2
    assert plunger.mass_properties.mass == pytest.approx(GEAR.yoke.plunger_mass, rel=ROUNDING)
    in_front = np.abs(plunger.vertices[:, 0]) <= GEAR.yoke.seat_length / 2 + 1e-12
    distance = np.hypot(plunger.vertices[:, 1], plunger.vertices[:, 2])[in_front]
    assert distance.min() == pytest.approx(radius, abs=1e-6)
    front, back = plunger_ends(GEAR)
    assert plunger.vertices[:, 1].min() == pytest.approx(front, abs=1e-12)
    assert plunger.vertices[:, 1].max() == pytest.approx(back, abs=1e-12)


def test_gears_share_the_solids_that_do_not_differ() -> None:
    """A study over preload and friction makes no solid twice, and nobody can change a shared one."""
    solids = gear_solids(GEAR)
    pressed = gear_solids(GEAR.replace({"yoke.preload": "400 N", "mesh.friction": 0.05}))
    assert all(pressed[name] is solid for name, solid in solids.items())
    coarser = gear_solids(GEAR.replace({"pinion.normal_module": "1.84 mm"}))
    assert {name for name, solid in solids.items() if coarser[name] is not solid} == {"pinion", "rack"}
    for array in (solids["rack"].vertices, solids["rack"].faces, solids["rack"].mass_properties.inertia):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_runout_displaces_the_teeth_but_not_the_shaft() -> None:
    """Teeth outside the shaft move by e: their first moment is that of the whole section, V_gear e.

    The finer mesh makes the polygon of the shaft 3e-5 smaller than the circle; the gear is 1/6 of it.
    """
    pinion = GEAR.pinion
    still, eccentric = pinion_solid(GEAR, 1e-7), pinion_solid(GEAR.replace({"pinion.runout": "40 um"}), 1e-7)
    volume, moved = still.mass_properties.volume, eccentric.mass_properties.centre_of_mass
    shaft_outside = np.pi / 4 * pinion.shaft_diameter**2 * (pinion.shaft_length - pinion.face_width)
    assert moved[1] == pytest.approx(40e-6 * (1 - shaft_outside / volume), rel=5e-4)
    assert abs(moved[0]) < 1e-10


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_assembled_teeth_touch_but_do_not_overlap(angle: float) -> None:
    """Rigid pinion and rack, runout included: no common volume, but 2 um closer there is.

    The ruled meshes lie inside their flanks by at most the chord error, 0.1 um here; closing the centre
    distance by 2 um brings the flanks together by 2 sin(alpha_n) = 0.7 um.
    """
    gear = GEAR.replace({"pinion.runout": "40 um", "pinion.runout_angle": "30 deg"})
    solids = assembled(gear, angle, chord_error=1e-7)
    pinion = to_manifold(solids["pinion"].vertices, solids["pinion"].faces)
    rack = to_manifold(solids["rack"].vertices, solids["rack"].faces)
    assert (pinion ^ rack).volume() == pytest.approx(0, abs=1e-18)
    assert (pinion ^ rack.translate((0, -2e-6, 0))).volume() > 1e-14


def test_rack_follows_the_gain() -> None:
    pair = GearPair.of(GEAR)
    travel = rack_position(pair, 2 * np.pi) - rack_position(pair, 0.0)
    np.testing.assert_allclose(
        travel, [np.pi * 6 * 1.83e-3 / np.cos(np.radians(10)), 0, 0], rtol=1e-14, atol=1e-17
    )


def spoilt(kind: str) -> Solid:
    solid = brick((1e-2, 1e-2, 1e-2), (0, 0, 0))
    vertices, faces = solid.vertices.copy(), solid.faces.copy()
    if kind == "open":
        faces = faces[1:]
    elif kind == "inverted":
        faces[0] = faces[0, ::-1]
    elif kind == "inwards":
        faces = faces[:, ::-1]
    elif kind == "slivers":
        vertices[1] = vertices[0] + [0, 0, 1e-14]
    elif kind == "not finite":
        vertices[2, 1] = np.nan
    return Solid(vertices, faces, 1.0)


@pytest.mark.parametrize("kind", ["open", "inverted", "inwards", "slivers", "not finite"])
def test_spoilt_meshes_are_refused_in_words(kind: str) -> None:
    solid = spoilt(kind)
    with pytest.raises(InputError, match=rf"mesh of the brick is not usable: .*{kind}"):
        refuse_defects("brick", solid.vertices, solid.faces)


def test_sound_mesh_passes_the_guard() -> None:
    solid = brick((1e-2, 1e-2, 1e-2), (0, 0, 0))
    refuse_defects("brick", solid.vertices, solid.faces)


def test_flanks_spoilt_by_their_errors_never_become_a_mesh() -> None:
    """A deviation that is no number reaches every vertex; no contact code gets to see it."""
    with pytest.raises(InputError, match="mesh of the pinion is not usable"):
        pinion_mesh(GearPair.of(GEAR), 1e-6, FlankForm(profile_slope=np.nan))
