"""Contact of triangulated meshes against closed forms, brute force, other cuts of the meshes, and lines."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import rps_exudyn as rps
from flank_points import wrench_by_points
from flank_poses import POSES, difference, state
from measured_grids import pinion_axes, rack_axes, write_grid
from rps_exudyn.analysis.touched_triangles import POSES as POSES_SHOWN
from rps_exudyn.analysis.touched_triangles import touched_triangles
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.mesh_file import Surface
from rps_exudyn.pages.report.write_report import write_report
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.tooth_contact.mesh_contact import MOST_CORNERS, MeshData
from rps_exudyn.tooth_contact.mesh_search import in_groups, mesh_data
from rps_exudyn.tooth_contact.triangles import convex_faces, facet_height, own_corners, own_polygons
from rps_exudyn.tooth_contact.wrench import ELASTIC_ENERGY, FORCE, MOMENT
from verification.contact_at import mesh_wrench
from verification.faceted import FACETED, cut_rack, faceted_run, flanks, meshed, shaped
from verification.law_area import by_law

K = 2e13  # pressure per depth [N/m^3]
EVEN = {
    "by_curvature": K,
    "least_rho": 1.0,
    "cos_beta_b": 1.0,
    "deepest": 1e-3,
    "pinion_frame": np.eye(3),
    "zone": 1e-5,
}
GEAR = SteeringGear().replace({"mesh.law": "line", "mesh.friction": 0.0, "mesh.damping": 0.0})
PAIR = GearPair.of(GEAR)
OF_GEAR = EVEN | {
    "by_curvature": GEAR.mesh.stiffness,
    "deepest": PAIR.module / 8,
    "pinion_origin": PAIR.pinion_origin,
    "pinion_frame": PAIR.pinion_frame,
}


def box(low: tuple[float, ...], high: tuple[float, ...]) -> trimesh.Trimesh:
    """A box between two corners."""
    return trimesh.creation.box(bounds=(low, high))


def pressed(upper: trimesh.Trimesh, lower: trimesh.Trimesh, **values: Any) -> np.ndarray:
    """The wrench on a lower body at rest from an upper one, that of the pinion."""
    meshes = mesh_data(upper.triangles, convex_faces(np.asarray(lower.triangles)))
    return mesh_wrench(0.0, 0.0, np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3), meshes, **EVEN | values)


def own(gear: SteeringGear = GEAR, chord_error: float = 1e-7) -> MeshData:
    """The flanks of a gear."""
    return mesh_data(own_corners(gear, chord_error), own_polygons(gear, chord_error))


def test_two_boxes_press_by_area_and_depth() -> None:
    """k A d, in the middle of the area that both share; a face that is a polygon of its triangles is one."""
    depth, upper = 3e-6, box((-2e-3, -3e-6, -1e-3), (1e-3, 2e-3, 4e-3))
    wrench = pressed(upper, box((-1e-3, -2e-3, 0), (5e-3, 0, 2e-3)))
    load = K * 2e-3 * 2e-3 * depth
    assert wrench[FORCE] == pytest.approx([0, -load, 0], rel=1e-9, abs=1e-9 * load)
    assert wrench[MOMENT] == pytest.approx(np.cross([0, 0, 1e-3], [0, -load, 0]), rel=1e-9, abs=1e-12)
    assert wrench[ELASTIC_ENERGY] == pytest.approx(load * depth / 2)


def test_cylinder_on_a_plane_presses_as_its_chord() -> None:
    """4/3 k d sqrt(2 rho d) over the length, and the round prism's own chord error."""
    rho, depth, length = 5e-3, 4e-6, 2e-3
    cylinder = trimesh.creation.cylinder(1e3 * rho, 1e3 * length, sections=20_000).apply_scale(1e-3)
    cylinder.apply_translation([0, rho - depth, 0])
    load = -pressed(cylinder, box((-4e-3, -2e-3, -4e-3), (4e-3, 0, 4e-3)))[FORCE][1]
    assert load == pytest.approx(4 / 3 * K * depth * np.sqrt(2 * rho * depth) * length, rel=1e-3)


def test_faces_that_do_not_oppose_do_not_touch() -> None:
    """A prism reaches through a body: its flank must not press on the face beside it."""
    upper = box((-1e-3, -5e-5, -1e-3), (1e-3, 2e-3, 1e-3))
    assert pressed(upper, box((-3e-3, -2e-3, -3e-3), (-1e-3 + 1e-6, 0, 3e-3)), deepest=1e-4)[FORCE][0] == (
        pytest.approx(-K * 5e-5 * 2e-3 * 1e-6)
    )


@pytest.mark.parametrize("pose", POSES)
def test_flanks_press_as_points_on_the_analytic_ones(pose: str) -> None:
    """0.3 % of the load by chords of 0.01 um at depths of 10 um, where lines end at tips and faces too."""
    area, meshes = by_law(GEAR.replace({"mesh.friction": 0.1}), "area"), own(chord_error=1e-8)
    for angle in (0.1, 0.45, 0.8):
        at = state(area, angle, **POSES[pose])
        found = mesh_wrench(*at, meshes, **OF_GEAR, friction=0.1)
        assert difference(found, wrench_by_points(area, *at, zone=1e-5, shape=(1500, 200)), area) < 3e-3


def test_wrench_does_not_depend_on_how_meshes_are_cut() -> None:
    """Triangles in another order and in four, faces in triangles: 1e-9."""
    corners, polygons, rng = own_corners(GEAR, 3e-7), own_polygons(GEAR, 3e-7), np.random.default_rng(3)
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    split = np.concatenate(
        [np.stack(each, axis=1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    )
    fans = [
        np.concatenate(
            [np.stack([each[:, 0], each[:, i], each[:, i + 1]], axis=1) for i in range(1, each.shape[1] - 1)]
        )
        for each in polygons
    ]
    at = state(GEAR, 0.45, **POSES["skewed"])
    expected = mesh_wrench(*at, mesh_data(corners, polygons), **OF_GEAR)
    for meshes in (
        mesh_data(rng.permutation(corners), polygons),
        mesh_data(rng.permutation(split), polygons),
        mesh_data(corners, fans),
    ):
        assert difference(mesh_wrench(*at, meshes, **OF_GEAR), expected, GEAR) < 1e-9


@pytest.mark.parametrize("size", [1, 4, 16])
def test_groups_hold_all_points_and_lie_close_together(size: int) -> None:
    """Boxes round groups of points at random in a square are as long as those of a grid of such groups."""
    points = np.random.default_rng(1).uniform(size=(4096, 3)) * [1, 1, 0]
    order = in_groups(points, size)
    assert sorted(order) == list(range(4096))
    extents = np.ptp(points[order].reshape(-1, size, 3), axis=1).max(axis=1)
    assert extents.mean() < 1.5 * np.sqrt(size / 4096)


def test_bent_flanks_are_no_plane_faces() -> None:
    """Facets that bend by under a degree each, and by 10 um together, stay apart; flat ones are a face."""
    z, height = np.meshgrid(np.linspace(-9e-3, 9e-3, 11), [0, 1e-3])
    for crown, faces in ((0.0, 1), (1e-5, 10)):
        points = np.stack([height, -crown * (z / 9e-3) ** 2, z], axis=-1)
        found = convex_faces(triangles_of_grid(points))
        assert sum(map(len, found)) == faces
        assert sum(map(polygon_areas, found)) == pytest.approx(1.8e-5, rel=1e-3)


def triangles_of_grid(points: np.ndarray) -> np.ndarray:
    """Triangles (n, 3, 3) between rows of points."""
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    return np.concatenate([np.stack(each, axis=2).reshape(-1, 3, 3) for each in ((a, b, c), (a, c, d))])


def polygon_areas(polygons: np.ndarray) -> float:
    """Sum of the areas of polygons (m, c, 3)."""
    out = polygons - polygons[:, :1]
    return float(np.linalg.norm(np.cross(out, np.roll(out, -1, axis=1)).sum(axis=1), axis=1).sum() / 2)


@pytest.mark.parametrize("settings", [{}, {"pinion.crowning": 1e-5, "pinion.tip_relief": 5e-6}])
def test_triangles_lie_about_their_flanks(settings: dict[str, float]) -> None:
    """Means over the triangles, by Gauss' three points, of the distance from the flank as built: 2 % of the
    chords' height. Of chords inside the flank it is up to two thirds."""
    gear, chord = SteeringGear().replace(settings), 1e-6
    flank = Flank(GearPair.of(gear), 0, 1, FlankForm.of(gear))
    corners = own_corners(gear, chord)
    corners = corners[: len(corners) // 6].reshape(2, -1, 3, 3)[1]  # tooth 0: both sides
    places = np.einsum("pk,nkj->npj", (1 + 3 * np.eye(3)) / 6, corners).reshape(-1, 3)
    q = np.sqrt(places[:, 0] ** 2 + places[:, 1] ** 2 - flank.pair.base_radius**2)
    psi = flank.generator(q, places[:, 2])
    off = np.einsum("ij,ij->i", places - flank.point(psi, places[:, 2]), flank.normal(psi))
    assert np.abs(off).max() > 0.1 * chord
    assert abs(off.reshape(-1, 3).mean(axis=1)).mean() < 0.02 * chord


def test_single_precision_is_enough() -> None:
    corners, polygons = own_corners(GEAR, 1e-7), own_polygons(GEAR, 1e-7)
    coarse = [each.astype(np.float32).astype(float) for each in (corners, *polygons)]
    at = state(GEAR, 0.45)
    expected = mesh_wrench(*at, mesh_data(corners, polygons), **OF_GEAR)
    assert difference(mesh_wrench(*at, mesh_data(coarse[0], coarse[1:]), **OF_GEAR), expected, GEAR) < 3e-4


def test_energy_is_conserved_round_a_loop() -> None:
    """Work round a closed path of the rack, over the energy that it stores: 1e-3, lost at ends of lines."""
    meshes, turn = own(), np.linspace(0, 2 * np.pi, 721)
    rack = state(GEAR, 0.3)
    work, energies = 0.0, []
    path = rack[2] + 2e-6 * np.stack([np.sin(turn), np.cos(turn), 0 * turn], axis=1)
    for at, before, after in zip(path[:-1], np.roll(path[:-1], 1, axis=0), path[1:], strict=True):
        wrench = mesh_wrench(rack[0], 0.0, at, rack[3], np.zeros(3), np.zeros(3), meshes, **OF_GEAR)
        work += wrench[FORCE] @ (after - before) / 2
        energies.append(wrench[ELASTIC_ENERGY])
    assert abs(work) < 1e-3 * np.ptp(energies)


def test_solid_of_many_slivers_is_as_good_as_its_planes() -> None:
    """A Boolean cut leaves sixty slivers on a flank: they are merged, and press as the flank does."""
    polygons = cut_rack(GEAR)
    flank_corners = max(each.shape[1] for each in polygons)
    assert 4 < flank_corners < MOST_CORNERS
    at, corners = state(GEAR, 0.45), own_corners(GEAR, 1e-7)
    expected = mesh_wrench(*at, mesh_data(corners, own_polygons(GEAR, 1e-7)), **OF_GEAR)
    assert difference(mesh_wrench(*at, mesh_data(corners, polygons), **OF_GEAR), expected, GEAR) < 2e-3


GEARS: dict[str, dict[str, Any]] = {
    "default": {},
    "left, parallel": {
        "pinion.helix_angle": "-20 deg",
        "rack.tooth_angle": "-20 deg",
        "pinion.crowning": 4e-6,
    },
    "eight teeth": {"pinion.teeth": 8, "pinion.runout": 2e-5, "pinion.tip_relief": 3e-6},
}


@pytest.mark.long  # compiles the law of the reference
@pytest.mark.parametrize("name", GEARS)
def test_torque_is_that_of_pressure_on_analytic_flanks(name: str) -> None:
    """Mean within 0.1 % and peak to peak within 1.5 % by chords of 0.1 um, at equal pressure per depth."""
    gear = by_law(SteeringGear().replace({**GEARS[name], "test.turns": 1 / 6}), "area")
    strips = {"strip_stations": 16, "strip_points": 8, "step_angle": "2 deg"}
    expected, _ = torque_of(gear, rps.Fidelity.preset("quasi-static").replace(strips))
    found = faceted_run(gear, FACETED.replace({"step_angle": "2 deg"}), flanks(1e-7)).signals["pinion_torque"]
    assert found.mean() == pytest.approx(expected.mean(), rel=1e-3)
    assert np.ptp(found) == pytest.approx(np.ptp(expected), rel=0.015)


def torque_of(gear: SteeringGear, fidelity: rps.Fidelity) -> tuple[np.ndarray, Any]:
    """The torque over the test's turns in equilibria."""
    from rps_exudyn.scenes.maneuver import maneuvers_of_test
    from verification.equilibria import equilibria

    run = equilibria(
        gear, gear_forces(gear, fidelity), maneuvers_of_test(gear, "pinion", fidelity.step_angle)[0]
    )
    return run.signals["pinion_torque"], run


@pytest.mark.parametrize(("surface", "more"), [(meshed(1e-7), -0.0018), (shaped(100), 0.0079)])
def test_solids_change_the_torque_as_their_facets_do(surface: Any, more: float) -> None:
    """A closed pinion has its fillet, which half a strip stands on; 100 cuts leave 3 um of material."""
    gear = by_law(SteeringGear().replace({"test.turns": 1 / 6}), "area")
    model = FACETED.replace({"step_angle": "2 deg"})
    smooth, found = (
        faceted_run(gear, model, each).signals["pinion_torque"].mean() for each in (flanks(1e-8), surface)
    )
    assert found / smooth - 1 == pytest.approx(more, abs=5e-4)


WORN: dict[str, tuple[str, Any]] = {
    "rack, worn at the middle": ("rack", lambda u, w: -8e-6 * np.exp(-((w / 5e-3) ** 2)) + 0 * u),
    "pinion, hollow": ("pinion", lambda u, w: -4e-6 * np.cos(2 * np.pi * (u - 2e-3) / 9e-3) + 0 * w),
    "pinion, twisted": ("pinion", lambda u, w: 0.1 * (u - 3e-3) * w),
}


@pytest.mark.parametrize("name", WORN)
def test_worn_flanks_turn_as_grids_on_lines_of_contact_do(name: str, tmp_path: Path) -> None:
    """1 % of the mean torque. Where a flank bears on its corners alone, the laws differ by more: the load of
    a line grows with its depth, that of triangles with the power 3/2 of it."""
    part, surface = WORN[name]
    gear = SteeringGear().replace({"test.turns": 1 / 6, "mesh.law": "line"})
    axes = (pinion_axes if part == "pinion" else rack_axes)(gear)
    gear = gear.replace({f"{part}.deviation": write_grid(tmp_path / "worn.csv", axes, surface)})
    model = rps.Fidelity.preset("quasi-static").replace({"step_angle": "2 deg"})
    lines, triangles = (
        rps.run("free-pinion-torque", gear, fidelity=model.replace({"mesh": mesh}))
        for mesh in ("flank", "triangles")
    )
    assert lines.status == triangles.status == "ok"
    assert triangles.summary["torque_mean"] == pytest.approx(lines.summary["torque_mean"], rel=0.01)


def test_dynamics_move_as_equilibria_do() -> None:
    model = {"mesh": "triangles", "step_angle": "2 deg"}
    gear = SteeringGear().replace({"test.turns": 1 / 6})
    still, moving = (
        rps.run("free-pinion-torque", gear, fidelity=rps.Fidelity.preset(preset).replace(model))
        for preset in ("quasi-static", "flank")
    )
    assert moving.summary["torque_mean"] == pytest.approx(still.summary["torque_mean"], rel=1e-3)
    assert moving.summary["torque_peak_to_peak"] == pytest.approx(
        still.summary["torque_peak_to_peak"], rel=0.02
    )


@pytest.mark.parametrize(
    "settings",
    [{}, {"pinion.helix_angle": "-20 deg", "rack.tooth_angle": "-10 deg", "pinion.teeth": 7}],
    ids=["default", "left"],
)
def test_gear_written_and_read_back_has_its_torque(settings: dict[str, Any], tmp_path: Path) -> None:
    """Mean within 0.3 %, peak to peak 3 %: both parts as single-precision STL, without a hint."""
    gear = SteeringGear().replace({"mesh.law": "line", "test.turns": 1 / 6, **settings})
    files = {f"{part}.surface": str(tmp_path / f"{part}.stl") for part in ("pinion", "rack")}
    for path, file in files.items():
        rps.export(gear, file, part=path.partition(".")[0], chord_error=1e-7)
    model = rps.Fidelity.preset("quasi-static").replace({"mesh": "triangles", "step_angle": "2 deg"})
    own, read = (
        rps.run("free-pinion-torque", each, fidelity=model).summary for each in (gear, gear.replace(files))
    )
    assert read["torque_mean"] == pytest.approx(own["torque_mean"], rel=3e-3)
    assert read["torque_peak_to_peak"] == pytest.approx(own["torque_peak_to_peak"], rel=0.03)


def test_rack_from_a_file_is_followed_along_all_its_teeth(tmp_path: Path) -> None:
    """A tooth worn by 10 um on its drive flank takes the rack back by up to as much in a turn about it."""
    flanks = [each.copy() for each in own_polygons(GEAR, 1e-7)]
    flanks[len(flanks) // 2 - 1] -= 1e-5 * PAIR.rack_flank_normal(-1)
    fans = [
        np.stack([each[:, [0] * (each.shape[1] - 2)], each[:, 1:-1], each[:, 2:]], axis=2) for each in flanks
    ]
    corners = np.concatenate([each.reshape(-1, 3, 3) for each in fans])
    Surface(corners).check_normals()
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    mesh.export(tmp_path / "rack.stl")
    test = {"test.path": "one-way", "test.start_angle": -np.pi, "test.turns": 1.0, "mesh.law": "line"}
    gear = SteeringGear().replace({**test, "rack.surface": str(tmp_path / "rack.stl")})
    model = rps.Fidelity.preset("quasi-static").replace({"mesh": "triangles", "step_angle": "5 deg"})
    worn, own = (
        rps.run("free-pinion-torque", each, fidelity=model) for each in (gear, gear.replace(OWN_RACK))
    )
    assert "periods_alike" in own.findings
    assert "periods_alike" not in worn.findings
    error = "transmission_error_peak_to_peak"
    assert 5e-6 < worn.summary[error] - own.summary[error] < 15e-6


OWN_RACK = {"rack.surface": ""}


@pytest.mark.parametrize("chord_error", [1e-6, 3e-6])
def test_error_bars_hold_what_facets_change(chord_error: float, tmp_path: Path) -> None:
    """Each metric of a pinion with coarse facets against that of the same pinion by parameters."""
    gear = SteeringGear().replace({"mesh.law": "line", "test.turns": 1 / 6, "test.path": "one-way"})
    rps.export(gear, tmp_path / "pinion.stl", part="pinion", chord_error=chord_error)
    coarse = gear.replace({"pinion.surface": str(tmp_path / "pinion.stl")})
    assert 0.2 * chord_error < facet_height(coarse) < 2 / 3 * chord_error
    model = rps.Fidelity.preset("quasi-static").replace({"mesh": "triangles"})
    fine, found = (rps.run("free-pinion-torque", each, fidelity=model) for each in (gear, coarse))
    off = {name: abs(found.summary[name] - fine.summary[name]) for name in found.errors}
    assert {name for name, each in off.items() if each > found.errors[name] + fine.errors[name]} == set()
    assert off["torque_mean"] > 10 * fine.errors["torque_mean"] / 4  # far more than the levels show


def test_triangles_that_touch_carry_the_recorded_forces(tmp_path: Path) -> None:
    """Their forces sum to those of the record in each pose; they lie on the rack's flanks; pages have it."""
    gear = SteeringGear().replace({"test.path": "one-way", "test.turns": 1 / 6, "pinion.runout": "20 um"})
    model = rps.Fidelity.preset("quasi-static").replace({"mesh": "triangles", "step_angle": "2 deg"})
    result = rps.run("free-pinion-torque", gear, fidelity=model)
    found = touched_triangles(result.gear, model, result.signals)
    poses = min(POSES_SHOWN, len(result.signals["time"]))
    recorded = sum(result.signals[f"mesh_normal_force_{side}"] for side in ("drive", "coast"))
    assert found.load_on_rack.sum() / poses == pytest.approx(recorded.mean(), rel=0.01)  # other instants
    planes = np.array([PAIR.rack_flank_normal(side) for side in (-1, 1)])
    normals = np.cross(*(found.on_rack[:, k] - found.on_rack[:, 0] for k in (1, 2)))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert (normals @ planes.T).min(axis=1).max() < -0.98  # they oppose one of the rack's flanks
    result.save(tmp_path / "result.h5")
    write_report([tmp_path / "result.h5"], tmp_path / "page.html", contact=True)
    assert "Where the surfaces touch" in (tmp_path / "page.html").read_text()
