"""STEP files with true faces: their surfaces, volumes and torque are those of the gear."""

from collections import Counter
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rps_exudyn as rps
from rps_exudyn.gears.export import export_solids
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import gear_solids
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear

pytest.importorskip("OCP", reason="without the extra cad")
brep = pytest.importorskip("rps_exudyn.gears.brep")

PLAIN = SteeringGear()
LEFT = {"pinion.helix_angle": "-20 deg", "rack.tooth_angle": "-10 deg", "pinion.teeth": 7}
SPUR = {"pinion.helix_angle": 0.0, "rack.tooth_angle": 0.0, "pinion.teeth": 9, "pinion.profile_shift": 0.6}
MODIFIED = {
    "pinion.tip_relief": "20 um",
    "pinion.crowning": "10 um",
    "pinion.pitch_error": "15 um",
    "pinion.lead_error": "5 um",
    "pinion.runout": "30 um",
}
VARIABLE = {"rack.ratio.lock": "44 mm"}
GEARS = [{}, LEFT, SPUR, MODIFIED]
NAMES = ["default", "left", "spur", "modified"]


def faces_in(path: Path) -> list[tuple[str, np.ndarray]]:
    """Kind and points [m] of the surfaces of all faces in a STEP file, by OpenCASCADE's reader."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.TopAbs import TopAbs_FACE

    found, each = [], brep.TopExp_Explorer(solid_in(path), TopAbs_FACE)
    while each.More():
        face = brep.TopoDS.Face(each.Current())
        surface = BRepAdaptor_Surface(face)
        u, v = (
            low + (high - low) * np.linspace(0.013, 0.987, 15)
            for low, high in (
                (surface.FirstUParameter(), surface.LastUParameter()),
                (surface.FirstVParameter(), surface.LastVParameter()),
            )
        )
        points = [surface.Value(a, b).Coord() for a in u.tolist() for b in v.tolist()]
        found.append((surface.GetType().name.removeprefix("GeomAbs_"), np.array(points).reshape(-1, 3) / 1e3))
        each.Next()
    return found


def solid_in(path: Path) -> Any:
    """What a STEP file holds."""
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadStream(path.name, BytesIO(path.read_bytes()))
    reader.TransferRoots()
    return reader.OneShape()


def volume_in(path: Path) -> float:
    """Volume of a STEP file's solids [m^3]."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    BRepGProp.VolumeProperties_s(solid_in(path), found := GProp_GProps(), 1e-7)
    return float(found.Mass()) / 1e9


@pytest.mark.parametrize("settings", GEARS[:3], ids=NAMES[:3])
def test_flanks_of_the_file_are_helicoids_and_planes(settings: dict[str, Any], tmp_path: Path) -> None:
    """Within 0.1 um of the closed form of distance; 4 faces of a tooth are splines, all others plain."""
    gear = PLAIN.replace(settings)
    pair = GearPair.of(gear)
    assert export_solids(gear, tmp_path / "pinion.step", part="pinion") == ()
    faces = faces_in(tmp_path / "pinion.step")
    assert Counter(kind for kind, _ in faces)["BSplineSurface"] == 4 * pair.teeth
    flanks = [Flank(pair, m, side) for m in range(pair.teeth) for side in (-1, 1)]
    met = set()
    for kind, points in faces:
        inside = points @ pair.pinion_frame - pair.pinion_origin @ pair.pinion_frame
        radius = np.hypot(inside[:, 0], inside[:, 1])
        if kind == "BSplineSurface" and radius.max() > form_point(pair).radius * 1.02:
            off = [np.abs(flank.distance(inside)).max() for flank in flanks]
            assert min(off) < 1e-7
            met.add(int(np.argmin(off)))
    assert len(met) == len(flanks)
    assert export_solids(gear, tmp_path / "rack.step", part="rack") == ()
    kinds = Counter(kind for kind, _ in faces_in(tmp_path / "rack.step"))
    assert set(kinds) == {"Plane", "Cylinder"}


@pytest.mark.parametrize("settings", GEARS, ids=NAMES)
def test_parts_have_the_volumes_of_the_solids(settings: dict[str, Any], tmp_path: Path) -> None:
    """Within 1e-4 of triangles within 0.1 um; the file is small."""
    gear = PLAIN.replace(settings | {"bush.segments": 1})
    for name, solid in gear_solids(gear, 1e-7).items():
        part = name.removesuffix("_segment")
        assert export_solids(gear, tmp_path / "part.step", part=part) == ()
        assert volume_in(tmp_path / "part.step") == pytest.approx(solid.mass_properties.volume, rel=1e-4)
        assert (tmp_path / "part.step").stat().st_size < 3e6


def test_modified_flanks_have_their_form(tmp_path: Path) -> None:
    """Relief and crowning of one flank, measured as the distance from the helicoid, within 0.1 um."""
    gear = PLAIN.replace({"pinion.tip_relief": "20 um", "pinion.crowning": "10 um"})
    pair, form = GearPair.of(gear), FlankForm.of(gear)
    export_solids(gear, tmp_path / "pinion.step", part="pinion")
    flanks = [Flank(pair, m, side) for m in range(pair.teeth) for side in (-1, 1)]
    ends, checked = (flanks[0].form_tangent_length, flanks[0].tip_tangent_length), 0
    for kind, points in faces_in(tmp_path / "pinion.step"):
        inside = points @ pair.pinion_frame
        q = np.sqrt(np.maximum(np.hypot(inside[:, 0], inside[:, 1]) ** 2 - pair.base_radius**2, 0))
        if kind == "BSplineSurface" and q.max() > 1.1 * ends[0]:
            # the distance counts along the normal, the form at the tangent length before it was taken off
            wanted = form.deviation(q, inside[:, 2], ends, pair.face_width)
            wanted = form.deviation(q - wanted, inside[:, 2], ends, pair.face_width) * np.cos(pair.beta_b)
            off = min(np.abs(flank.distance(inside) - wanted).max() for flank in flanks)
            assert off < 1e-7
            checked += 1
    assert checked == len(flanks)


@pytest.mark.long
def test_rack_of_a_variable_ratio_has_the_flanks_of_its_course(tmp_path: Path) -> None:
    """Within 0.1 um of the envelope, between the places of the splines, and its volume."""
    gear = PLAIN.replace(VARIABLE)
    pair = GearPair.of(gear)
    rack, bar = GeneratedRack.of(pair), RackBar.of(gear)
    assert export_solids(gear, tmp_path / "rack.step", part="rack") == ()
    assert volume_in(tmp_path / "rack.step") == pytest.approx(
        gear_solids(gear, 3e-7)["rack"].mass_properties.volume, rel=1e-4
    )
    faces, met = faces_in(tmp_path / "rack.step"), 0
    assert len(faces) < 8 * len(bar.teeth)
    assert (tmp_path / "rack.step").stat().st_size < 15e6
    for kind, points in faces:
        X, H, Z = points.T  # the file is in the housing frame, with its origin on the pinion's axis
        middle = H.mean() - pair.bar_axis_height
        if (
            kind == "BSplineSurface"
            and bar.tip_height < middle < 0.8 * bar.root_height + 0.2 * bar.tip_height
        ):
            off = [np.abs(rack.flank(side, j, H, Z) - X).max() for j in bar.teeth for side in (-1, 1)]
            met += min(off) < 1.2e-7  # along X, of which the normal has cos(alpha) cos(beta_r)
    assert met >= 10


def test_what_splines_cannot_carry_has_plane_faces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(brep, "FINEST", 4)
    (remark,) = export_solids(PLAIN, tmp_path / "pinion.step", part="pinion", chord_error=1e-5)
    assert "the pinion has a surface" in remark
    assert "POLY_LOOP" in (tmp_path / "pinion.step").read_text(encoding="ascii")


def test_shape_of_the_rack_that_no_file_has_is_stated(tmp_path: Path) -> None:
    gear = PLAIN.replace({"rack.bow": "0.1 mm"})
    assert export_solids(gear, tmp_path / "gear.stl") == ("rack.bow: not part of the file.",)
    assert export_solids(gear, tmp_path / "pinion.stl", part="pinion") == ()


@pytest.mark.long
def test_whole_gear_written_and_read_back_has_its_torque(tmp_path: Path) -> None:
    """Mean within 0.3 %, peak to peak 3 % of triangles of the same chord error; parts by their names."""
    pytest.importorskip("cascadio", reason="without the extra step")
    gear = PLAIN.replace({"mesh.law": "line", "test.turns": 1 / 6})
    rps.export(gear, tmp_path / "gear.step")
    files = {f"{part}.surface": str(tmp_path / "gear.step") for part in ("pinion", "rack")}
    model = rps.Fidelity.preset("quasi-static").replace({"mesh": "triangles", "step_angle": "2 deg"})
    own, read = (
        rps.run("free-pinion-torque", each, fidelity=model).summary for each in (gear, gear.replace(files))
    )
    assert read["torque_mean"] == pytest.approx(own["torque_mean"], rel=3e-3)
    assert read["torque_peak_to_peak"] == pytest.approx(own["torque_peak_to_peak"], rel=0.03)
