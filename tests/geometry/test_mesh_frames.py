"""Surfaces of own gears, moved at random, written, read and placed by themselves, come back."""

import importlib.util
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.masses import pinion_inertia, rack_masses, surface_masses
from rps_exudyn.gears.mesh_file import Surface, surface_in
from rps_exudyn.gears.mesh_frames import Placement, place_pinion, place_rack
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import pinion_solid, rack_solid
from rps_exudyn.gears.surface_report import compared, contradictions
from rps_exudyn.parameters.gear import SteeringGear

GEARS = {
    "default, crossed": {},
    "right hand, 5 teeth": {
        "pinion.teeth": 5,
        "pinion.helix_angle": "-30 deg",
        "rack.tooth_angle": "-12 deg",
    },
    "parallel axes, 7 teeth": {
        "pinion.teeth": 7,
        "pinion.helix_angle": "20 deg",
        "rack.tooth_angle": "20 deg",
    },
    "spur, 9 teeth": {
        "pinion.teeth": 9,
        "pinion.helix_angle": 0.0,
        "rack.tooth_angle": 0.0,
        "pinion.profile_shift": 0.6,
    },
    "hands opposite, 8 teeth": {
        "pinion.teeth": 8,
        "pinion.helix_angle": "-15 deg",
        "rack.tooth_angle": "8 deg",
        "pinion.profile_shift": 0.5,
    },
}
ANGLE, PLACE = np.deg2rad(0.02), 2e-6  # promised accuracy
WITH_STEP = pytest.mark.skipif(not importlib.util.find_spec("cascadio"), reason="without the extra step")


@cache
def gear_named(name: str) -> SteeringGear:
    return SteeringGear().replace(GEARS[name])


def moved(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A rotation and a shift [m], at random."""
    random = np.random.default_rng(seed)
    rotation, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return rotation * np.sign(np.linalg.det(rotation)), random.normal(size=3) * 0.1


def off_flanks(points: np.ndarray, gear: SteeringGear) -> float:
    """Largest distance of points, in the pinion frame, from the nearest flank [m]."""
    pair = GearPair.of(gear)
    flanks = [Flank(pair, tooth, side) for tooth in range(pair.teeth) for side in (-1, 1)]
    return float(np.min([np.abs(flank.distance(points)) for flank in flanks], axis=0).max())


def off_planes(points: np.ndarray, gear: SteeringGear) -> float:
    """Largest distance of points, in the rack frame, from the nearest flank's plane [m]."""
    bar = RackBar.of(gear)
    planes = [bar.flank(tooth, side) for tooth in bar.teeth for side in (-1, 1)]
    return float(np.min([np.abs((points - each.point) @ each.normal) for each in planes], axis=0).max())


def axis_error(placement: Placement, rotation: np.ndarray, axis: int) -> float:
    """Angle of an axis from where it was put, its sense apart [rad]."""
    return float(np.linalg.norm(np.cross(placement.axes[axis], rotation[:, axis])))


def check_pinion(surface: Surface, gear: SteeringGear, seed: int, unit: float) -> None:
    pair, (rotation, shift) = GearPair.of(gear), moved(seed)
    placed = place_pinion(surface)
    assert placed.teeth == pair.teeth
    assert axis_error(placed, rotation, 2) < ANGLE
    assert np.linalg.norm(placed.origin - shift) < PLACE
    patches = pinion_mesh(pair, 1e-6).flanks.values()
    points = np.concatenate([each.points for each in patches])
    assert off_flanks(placed.place((points @ rotation.T + shift) / unit), gear) < PLACE
    assert abs(placed.twist - pair.twist) * pair.face_width * pair.tip_radius < PLACE
    assert placed.tip_diameter == pytest.approx(2 * pair.tip_radius, abs=PLACE)
    assert placed.face_width == pytest.approx(pair.face_width, abs=PLACE)


def check_rack(surface: Surface, gear: SteeringGear, seed: int, unit: float, *, has_bar: bool = True) -> None:
    pair, bar, (rotation, shift) = GearPair.of(gear), RackBar.of(gear), moved(seed)
    placed = place_rack(surface, gear.rack.reference_height)
    assert placed.teeth == len(bar.teeth)
    assert (placed.bar_diameter is not None) == has_bar
    assert max(axis_error(placed, rotation, axis) for axis in range(3)) < ANGLE
    assert np.linalg.norm(placed.origin - shift) < PLACE
    corners = rack_flanks(gear).reshape(-1, 3)
    assert off_planes(placed.place((corners @ rotation.T + shift) / unit), gear) < PLACE
    assert placed.pitch == pytest.approx(pair.rack_pitch, abs=PLACE / len(bar.teeth))
    assert placed.tooth_angle == pytest.approx(pair.beta_r, abs=ANGLE)
    assert placed.pressure_angles == pytest.approx([pair.alpha_n] * 2, abs=ANGLE)
    assert placed.addendum == pytest.approx(pair.rack_addendum, abs=PLACE)
    assert placed.reference_height == pytest.approx(gear.rack.reference_height, abs=PLACE)


def rack_flanks(gear: SteeringGear) -> np.ndarray:
    """Triangles of the flanks of the rack's Boolean."""
    solid = rack_solid(gear)
    surface = Surface(solid.vertices[solid.faces])
    normals = [GearPair.of(gear).rack_flank_normal(side) for side in (-1, 1)]
    return surface.corners[(surface.normals @ np.transpose(normals) > 1 - 1e-9).any(axis=1)]


def written_and_read(corners: np.ndarray, kind: str, seed: int, unit: float) -> Surface:
    """Triangles [m] moved, written in a unit by another program's writer and read."""
    rotation, shift = moved(seed)
    points = ((corners @ rotation.T + shift) / unit).reshape(-1, 3)
    mesh = trimesh.Trimesh(points, np.arange(len(points)).reshape(-1, 3), process=False)
    return surface_in(mesh.export(file_type=kind), kind)


@pytest.mark.parametrize("name", GEARS)
def test_solids_come_back(name: str) -> None:
    """Closed meshes, the rack a Boolean with slivers, in mm and single precision."""
    gear, seed = gear_named(name), 10 + list(GEARS).index(name)
    for solid, check in ((pinion_solid(gear), check_pinion), (rack_solid(gear), check_rack)):
        surface = written_and_read(solid.vertices[solid.faces], "stl", seed, 1e-3)
        surface.check_normals()
        check(surface, gear, seed, 1e-3)


@pytest.mark.parametrize("name", GEARS)
def test_open_flanks_come_back(name: str) -> None:
    """Flanks alone, in metres; without a bar the drawing's height stands for its axis."""
    gear, seed = gear_named(name), 20 + list(GEARS).index(name)
    mesh = pinion_mesh(GearPair.of(gear), 1e-6)
    faces = np.concatenate([patch.faces for patch in mesh.flanks.values()])
    rotation, shift = moved(seed)
    pinion, rack = (
        Surface((each @ rotation.T + shift).astype(np.float32).astype(float))
        for each in (mesh.vertices[faces], rack_flanks(gear))
    )
    check_pinion(pinion, gear, seed, 1.0)
    check_rack(rack, gear, seed, 1.0, has_bar=False)


@pytest.mark.parametrize("kind", ["stl", pytest.param("step", marks=WITH_STEP)])
def test_exported_gear_is_that_of_its_drawing(kind: str, tmp_path: Path) -> None:
    gear, files = SteeringGear(), {}
    for part in ("pinion", "rack"):
        files[f"{part}.surface"] = str(tmp_path / f"{part}.{kind}")
        rps.export(gear, tmp_path / f"{part}.{kind}", part=part)
    rows = list(compared(gear.replace(files)))
    assert {each.part for each in rows} == {"pinion", "rack"}
    assert [each for each in rows if each.differs] == []


def test_whole_gear_as_glb_has_both_parts_by_name(tmp_path: Path) -> None:
    rps.export(SteeringGear(), file := tmp_path / "gear.glb")
    gear = SteeringGear().replace({"pinion.surface": str(file), "rack.surface": str(file)})
    assert not any(each.differs for each in compared(gear))


def test_masses_are_those_of_closed_surfaces(tmp_path: Path) -> None:
    """Those of the solids that were written, about the axis of rotation; an open surface has none."""
    plain, files = SteeringGear(), {}
    gear = plain.replace({"pinion.runout": "0.5 mm"})
    for part in ("pinion", "rack"):
        files[f"{part}.surface"] = str(tmp_path / f"{part}.stl")
        rps.export(plain, tmp_path / f"{part}.stl", part=part)
    given = gear.replace(files)
    solid, bar = pinion_solid(plain).mass_properties, rack_solid(plain).mass_properties
    about_axis = solid.inertia[2, 2] + solid.mass * 0.5e-3**2
    assert pinion_inertia(given) == pytest.approx(about_axis, rel=1e-4)
    own, read = rack_masses(gear), rack_masses(given)
    assert read.mass == pytest.approx(bar.mass, rel=1e-6)
    assert read.centre_of_mass == pytest.approx(bar.centre_of_mass, abs=PLACE)
    assert np.diag(read.inertia) == pytest.approx(np.diag(bar.inertia), rel=1e-4)
    heavier = given.replace({"rack.density": 2 * gear.rack.density})
    assert rack_masses(heavier).mass == pytest.approx(2 * read.mass)
    mesh = trimesh.load(tmp_path / "rack.stl")
    trimesh.Trimesh(mesh.vertices, mesh.faces[1:], process=False).export(tmp_path / "rack.stl")
    open_one = gear.replace({"rack.surface": files["rack.surface"]})
    assert surface_masses(open_one, "rack") is None
    assert rack_masses(open_one).mass == own.mass


def test_differences_are_marked(tmp_path: Path) -> None:
    """A drawing with another tip and tooth angle: these and the pitch, 2 um for a tooth, nothing else."""
    gear, files = SteeringGear(), {}
    for part in ("pinion", "rack"):
        files[f"{part}.surface"] = str(tmp_path / f"{part}.stl")
        rps.export(gear, tmp_path / f"{part}.stl", part=part)
    other = gear.replace(files | {"pinion.tip_diameter": "18.19 mm", "rack.tooth_angle": "10.1 deg"})
    marked = {f"{each.part} {each.name}" for each in compared(other) if each.differs}
    assert marked == {"pinion tip diameter", "rack tooth angle", "rack pitch"}
    assert list(contradictions(other)) == []


def test_shafts_with_flats_splines_and_flanges_do_not_matter() -> None:
    """The teeth alone are placed: what stands on the shaft is no part of them."""
    from rps_exudyn.gears.polyhedron import cylinder, from_manifold, to_manifold

    gear = SteeringGear()
    own = pinion_solid(gear)
    body = to_manifold(own.vertices.copy(), own.faces.copy())
    flange = cylinder(0.015, np.array([0, 0, 0.02]), np.array([0, 0, 0.03]), 200)
    flat = trimesh.creation.box((0.02, 0.006, 0.06))
    body += flange
    flat.apply_translation((0, 0.0065, 0.06))
    body -= to_manifold(np.asarray(flat.vertices), np.asarray(flat.faces))
    for k in range(24):
        rib = trimesh.creation.box((0.0006, 0.0012, 0.018))
        rib.apply_translation((0, 0.0058, -0.06))
        rib.apply_transform(trimesh.transformations.rotation_matrix(2 * np.pi * k / 24, [0, 0, 1]))
        body += to_manifold(np.asarray(rib.vertices), np.asarray(rib.faces))
    vertices, faces = from_manifold(body)
    check_pinion(written_and_read(vertices[faces], "stl", 30, 1e-3), gear, 30, 1e-3)


@pytest.mark.parametrize("noise", [1e-6, 5e-6])
def test_noise_of_a_scan_moves_frames_less_than_itself(noise: float) -> None:
    """Vertices 0.4 mm apart, displaced by white noise: 2000 corners of flanks average it. The ends of the
    face follow the vertices there, and with them the middle along the axis."""
    from rps_exudyn.gears.helicoid import transverse_profile

    gear, (rotation, shift) = SteeringGear(), moved(40)
    pair = GearPair.of(gear)
    profile = transverse_profile(pair, 1e-8)
    ring = np.concatenate([profile, profile[:1]])
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    at = np.linspace(0, length[-1], int(length[-1] / 4e-4) + 1)[:-1]
    x, y = (np.interp(at, length, ring[:, i])[:, None] for i in (0, 1))
    Z = np.linspace(-0.5, 0.5, 36) * pair.face_width
    c, s = np.cos(pair.twist * Z), np.sin(-pair.twist * Z)
    points = np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(Z, (len(at), len(Z)))], axis=-1)
    number = np.arange(points[..., 0].size).reshape(points.shape[:2])
    number = np.concatenate([number, number[:1]])
    a, b, e, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    faces = np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in ((a, b, e), (a, e, d))])
    scanned = points.reshape(-1, 3) + noise * np.random.default_rng(1).normal(size=(points[..., 0].size, 3))
    placed = place_pinion(Surface((scanned @ rotation.T + shift)[faces]))
    assert placed.teeth == pair.teeth
    assert axis_error(placed, rotation, 2) < noise / pair.face_width
    assert np.linalg.norm(((placed.origin - shift) @ rotation)[:2]) < noise


def test_wear_is_no_part_of_a_racks_frame() -> None:
    """10 um worn off within 30 mm about the middle of 185 mm: the frame stays within 2 um of the bar's."""
    gear, (rotation, shift) = SteeringGear(), moved(50)
    solid = rack_solid(gear)
    worn = solid.vertices[solid.faces]
    depth = 10e-6 * np.exp(-((worn[..., 0] / 0.015) ** 2)) * (worn[..., 1] < -6.3e-3)
    worn = worn + depth[..., None] * np.array([0.0, 1, 0])
    placed = place_rack(Surface(worn @ rotation.T + shift), gear.rack.reference_height)
    assert np.linalg.norm(placed.origin - shift) < PLACE
    assert max(axis_error(placed, rotation, axis) for axis in range(3)) < ANGLE


def test_heights_over_facets_are_those_of_spheres_and_cylinders() -> None:
    """Volume between a sphere and its facets (2 %); two thirds of the sagitta of strips; hollow below 0."""
    ball = trimesh.creation.icosphere(4, 0.01)
    surface = Surface(np.asarray(ball.triangles))
    between = 4 / 3 * np.pi * 0.01**3 - ball.volume
    assert surface.heights @ surface.areas == pytest.approx(between, rel=0.02)
    assert Surface(surface.corners[:, ::-1]).heights == pytest.approx(-surface.heights)
    round_bar = Surface(np.asarray(trimesh.creation.cylinder(0.01, 0.05, sections=100).triangles))
    on_mantle = np.abs(round_bar.normals[:, 2]) < 0.1
    sagitta = 0.01 * (1 - np.cos(np.pi / 100))
    assert round_bar.heights[on_mantle] == pytest.approx(2 / 3 * sagitta, rel=0.01)
