"""The picture and the exported solids show the gear."""

import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from rps_exudyn.gears.export import assembled, export_solids
from rps_exudyn.pages.animation.camera import UNCUT, Camera
from rps_exudyn.pages.animation.drawn import Triangles
from rps_exudyn.pages.animation.film import cutout
from rps_exudyn.pages.animation.geometry_figure import draw_geometry, geometry_figure
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()


def square(z: float, half: float, colour: tuple[float, float, float]) -> Triangles:
    """Two triangles that face +Z."""
    a, b, c, d = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    corners = np.array([[a, b, c], [a, c, d]])
    return corners, np.zeros((2, 3, 3)), np.array([colour] * 2), np.full(2, UNCUT)


def test_nearer_surfaces_hide_farther_ones() -> None:
    """A small red square in front of a large blue one, drawn in either order."""
    red, blue = square(1.0, 0.5, (1.0, 0.0, 0.0)), square(0.0, 1.0, (0.0, 0.0, 1.0))
    for bodies in ([red, blue], [blue, red]):
        image = np.asarray(cutout(bodies, Camera(np.zeros(3), 0.0, 0.0, 5.0), (40, 40)))
        assert image.shape == (40, 40, 4)
        assert image[20, 20, 0] > 0
        assert image[20, 20, 2] == 0
        assert image[8, 8, 2] > 0
        assert image[8, 8, 0] == 0


def test_picture_has_its_three_views_and_the_numbers(tmp_path: Path) -> None:
    figure = geometry_figure(GEAR)
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "around the mesh: pinion, rack, plunger",
        "transverse section of the pinion",
        "in mesh, transverse section at pinion angle 0",
    ]
    labels = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert "tip circle, 18.200 mm" in labels
    draw_geometry(GEAR, tmp_path / "gear.png")
    assert (tmp_path / "gear.png").stat().st_size > 50_000


def test_glb_holds_every_part_by_name_where_it_stands(tmp_path: Path) -> None:
    """Metres, housing frame; single precision of the format: 6e-8 of half a metre."""
    export_solids(GEAR, tmp_path / "gear.glb")
    scene = trimesh.load(tmp_path / "gear.glb")
    solids = assembled(GEAR)
    assert set(scene.geometry) == set(solids)
    for name, solid in solids.items():
        np.testing.assert_allclose(scene.geometry[name].bounds[0], solid.vertices.min(axis=0), atol=1e-7)
        np.testing.assert_allclose(scene.geometry[name].bounds[1], solid.vertices.max(axis=0), atol=1e-7)


def test_stl_holds_the_volume_of_all_parts_in_millimetres(tmp_path: Path) -> None:
    """Single precision at 470 mm is 3e-5 mm, on radii of 12 mm 3e-6 of the volume."""
    export_solids(GEAR, tmp_path / "gear.stl")
    volume = sum(solid.mass_properties.volume for solid in assembled(GEAR).values())
    assert trimesh.load(tmp_path / "gear.stl").volume == pytest.approx(1e9 * volume, rel=1e-5)


def test_step_without_the_extra_holds_the_volume_of_a_part_in_millimetres(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A closed shell of plane faces: the divergence theorem over its loops, read from the text."""
    import re

    import rps_exudyn.gears

    monkeypatch.delattr(rps_exudyn.gears, "brep", raising=False)
    monkeypatch.setitem(sys.modules, "rps_exudyn.gears.brep", None)
    (remark,) = export_solids(GEAR, tmp_path / "yokenut.step", part="yokenut")
    assert "rps-exudyn[cad]" in remark
    text = (tmp_path / "yokenut.step").read_text(encoding="ascii")
    points = {
        number: np.array(at.split(","), dtype=float)
        for number, at in re.findall(r"(#\d+)=CARTESIAN_POINT\('',\((.+?)\)\)", text)
    }
    loops = re.findall(r"POLY_LOOP\('',\((.+?)\)\)", text)
    corners = np.array([[points[number] for number in loop.split(",")] for loop in loops])
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    own = assembled(GEAR)["yokenut"].mass_properties.volume
    assert volume == pytest.approx(1e9 * own, rel=1e-9)
