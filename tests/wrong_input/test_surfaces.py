"""Files of surfaces that are none, are broken, or belong to another gear: one sentence each."""

import importlib.util
import os
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

import rps_exudyn as rps
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.mesh_file import MOST_TRIANGLES, Surface, surface_in
from rps_exudyn.gears.mesh_frames import place_pinion, place_rack
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.solids import pinion_solid, rack_solid
from rps_exudyn.gears.surface_report import compared, contradictions
from rps_exudyn.pages.animation.parts import picture_parts
from rps_exudyn.parameters.gear import SteeringGear
from shell import Command

GEAR = SteeringGear()
SOLID, RACK = pinion_solid(GEAR), rack_solid(GEAR)
PINION = SOLID.vertices[SOLID.faces] * 1e3


def stl(corners: np.ndarray) -> bytes:
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3), process=False)
    return bytes(mesh.export(file_type="stl"))


def inverted(corners: np.ndarray, share: float = 1.0) -> np.ndarray:
    """Triangles of which the first ones, by share, are turned inside out."""
    n = int(share * len(corners))
    return np.concatenate([corners[:n, ::-1], corners[n:]])


def with_nan(corners: np.ndarray) -> np.ndarray:
    corners = corners.copy()
    corners[5, 1, 2] = np.nan
    return corners


def glb(json: str) -> bytes:
    """A GLB of one block of JSON."""
    block = json.encode().ljust(-4 * (-len(json) // 4))
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(block)) + struct.pack("<I4s", len(block), b"JSON")
    return head + block


ZEROS_OF_GLB = glb(
    '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
    '"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
    '"accessors":[{"componentType":5126,"count":3000000000,"type":"VEC3"}]}'
)
PLY = (
    b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\n"
    b"property double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\n"
    b"end_header\n"
)
RANDOM = np.random.default_rng(0).bytes(200_000)
UNREADABLE = {
    "empty stl": ("stl", b"", "is no STL|holds no triangles"),
    "empty obj": ("obj", b"", "is no OBJ|holds no triangles"),
    "empty glb": ("glb", b"", "is no GLB"),
    "random stl": ("stl", RANDOM, "is no STL|holds no triangles"),
    "random ply": ("ply", RANDOM, "is no PLY"),
    "random obj": ("obj", RANDOM, "is no OBJ|holds no triangles"),
    "random glb": ("glb", RANDOM, "is no GLB"),
    "zeros": ("stl", bytes(10_000_000), "is no STL|holds no triangles"),
    "zeros with a head": (
        "stl",
        bytes(80) + struct.pack("<I", 100_000) + bytes(50 * 100_000),
        "holds no triangles",
    ),
    "zeros that a glb states": ("glb", ZEROS_OF_GLB, "is no GLB"),
    "vertices that a ply states": ("ply", PLY, "is no PLY"),
    "not a number": ("stl", stl(with_nan(PINION)), "no finite numbers"),
    "faces beyond the vertices": ("obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "is no OBJ|does not have"),
    "points alone": ("obj", b"v 0 0 0\nv 1 0 0\n", "is no OBJ|holds no triangles"),
    "other suffix": ("3mf", b"", "suffix must be one of"),
    "cut short": ("stl", stl(PINION)[:-7], "is no STL|holds no triangles"),
}


@pytest.mark.parametrize(("kind", "content", "said"), UNREADABLE.values(), ids=UNREADABLE)
def test_file_without_a_surface_is_refused(kind: str, content: bytes, said: str) -> None:
    with pytest.raises(rps.InputError, match=said) as caught:
        surface_in(content, kind)
    assert "\n" not in str(caught.value)


def test_too_many_triangles_are_refused_and_the_most_are_read() -> None:
    """A row of triangles, one more than are read, or as many."""
    for count in (MOST_TRIANGLES + 1, MOST_TRIANGLES):
        blob = np.zeros(count, dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
        x = np.arange(count, dtype=np.float32)[:, None] * np.array([1, 0, 0], dtype=np.float32)
        blob["v"] = x[:, None] + np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
        content = bytes(80) + struct.pack("<I", count) + blob.tobytes()
        if count > MOST_TRIANGLES:
            with pytest.raises(rps.InputError, match="more than 2000000 triangles"):
                surface_in(content, "stl")
        else:
            assert len(surface_in(content, "stl").corners) == count


def test_gigabyte_is_refused_before_it_is_read(tmp_path: Path) -> None:
    with (file := tmp_path / "large.stl").open("wb") as written:
        os.truncate(written.fileno(), 2**30)
    with pytest.raises(rps.InputError, match=r"pinion.surface names a file that cannot be read: .*limit"):
        GEAR.replace({"pinion.surface": str(file)})


@pytest.mark.parametrize(
    ("share", "said"),
    [(1.0, "inverted normals"), (0.3, "has mixed normals"), (1e-3, "has mixed normals")],
)
def test_inverted_and_mixed_normals(share: float, said: str) -> None:
    with pytest.raises(rps.InputError, match=said):
        Surface(inverted(PINION, share)).check_normals()


def test_inverted_flanks_of_a_pinion() -> None:
    mesh = pinion_mesh(GearPair.of(GEAR), 1e-6)
    flanks = mesh.vertices[np.concatenate([each.faces for each in mesh.flanks.values()])]
    Surface(flanks[:, ::-1]).check_normals()  # open: its edges do not state it
    with pytest.raises(rps.InputError, match="has inverted normals"):
        place_pinion(Surface(flanks[:, ::-1]))


@pytest.mark.parametrize("scale", [1.0, 1e6])
def test_size_of_no_gear(scale: float) -> None:
    """Metres are taken for metres, and a file in neither unit is refused."""
    assert place_pinion(Surface(PINION)).unit == "mm"
    assert place_pinion(Surface(PINION / 1e3)).unit == "m"
    with pytest.raises(rps.InputError, match=r"tip radius of .* must be from 2 to 60 mm"):
        place_pinion(Surface(PINION / 30 * scale))
    with pytest.raises(rps.InputError, match=r"pitch of .* must be from 2 to 60 mm"):
        place_rack(Surface(RACK.vertices[RACK.faces] * 50 * scale), 8e-3)


def test_bodies_without_teeth() -> None:
    bodies = [
        trimesh.creation.box((0.02, 0.03, 0.1)),
        trimesh.creation.icosphere(3, 0.01),
        trimesh.creation.cylinder(0.01, 0.2, sections=200),
    ]
    surfaces = [Surface(np.asarray(body.triangles)) for body in bodies]
    for surface in [*surfaces[1:], Surface(RACK.vertices[RACK.faces])]:
        with pytest.raises(rps.InputError, match=r"shows no equal teeth|tip radius"):
            place_pinion(surface)
    for surface in [*surfaces, Surface(PINION)]:
        with pytest.raises(rps.InputError, match="shows no teeth of a rack"):
            place_rack(surface, 8e-3)


def test_parts_of_another_gear_are_named(tmp_path: Path) -> None:
    """Mirrored parts, another number of teeth, a rack too short for the travel."""
    mirror = np.array([1.0, 1, -1])
    for part, solid in (("pinion", SOLID), ("rack", RACK)):
        (tmp_path / f"{part}.stl").write_bytes(stl(1e3 * (solid.vertices * mirror)[solid.faces][:, ::-1]))
    files = {f"{part}.surface": str(tmp_path / f"{part}.stl") for part in ("pinion", "rack")}
    sentences = list(contradictions(GEAR.replace(files)))
    assert [each.split()[3] for each in sentences] == ["pinion.surface", "rack.surface"]
    assert all("mirrored" in each for each in sentences)
    longer = {"rack.travel": "160 mm", "rack.length": "700 mm"}
    more_teeth = {"pinion.teeth": 7, "pinion.tip_diameter": "20 mm"}
    first, *_, last = contradictions(GEAR.replace(files | longer | more_teeth))
    assert first == "pinion.surface has 6 teeth; pinion.teeth is 7."
    assert last.startswith("rack.surface has 31 teeth, for a travel of")


def test_gear_with_a_surface_is_compared_and_has_only_triangles(tmp_path: Path, command: Command) -> None:
    (tmp_path / "pinion.stl").write_bytes(stl(PINION))
    setting = ["--set", f"pinion.surface={tmp_path / 'pinion.stl'}"]
    answer = command(["geometry", *setting])
    assert answer.status == 0
    assert "pinion: lead" in answer.out
    assert "read in mm" in answer.out
    gear = GEAR.replace({"pinion.surface": str(tmp_path / "pinion.stl")})
    drawn = {each.name: each for each in picture_parts(gear)}
    assert len(drawn["pinion"].faces) == len(PINION)
    for model, said in (("closed-form", "solver is closed-form"), ("full", "mesh is general-contact")):
        with pytest.raises(rps.InputError, match=rf"pinion\.surface is given.*{said}"):
            rps.run("free-pinion-torque", gear, fidelity=model)
    with pytest.raises(rps.InputError, match=r"pinion\.surface is given.*must be triangles"):
        rps.build_model(gear, rps.Fidelity.preset("flank"))
    with pytest.raises(rps.InputError, match=r"pinion\.surface is given.*leave it out"):
        rps.export(gear, tmp_path / "again.stl")
    for path, said in (("mesh.law", "only line"), ("pinion.crowning", "a form of its own")):
        other = gear.replace({path: "teeth" if path == "mesh.law" else 5e-6})
        with pytest.raises(rps.InputError, match=said):
            rps.run("free-pinion-torque", other, fidelity="quasi-static")
    (tmp_path / "pinion.stl").write_bytes(stl(PINION / 1e3))
    gear = gear.replace({"pinion.surface": str(tmp_path / "pinion.stl")})
    (tmp_path / "pinion.stl").write_bytes(stl(PINION))
    with pytest.raises(rps.InputError, match=r"set pinion\.surface again"):
        list(compared(gear))


@pytest.mark.skipif(bool(importlib.util.find_spec("cascadio")), reason="with the extra step")
def test_step_without_its_extra_states_what_to_install() -> None:
    with pytest.raises(rps.InputError, match=r"rps-exudyn\[step\]"):
        surface_in(b"ISO-10303-21;", "step")


@pytest.mark.skipif(not importlib.util.find_spec("cascadio"), reason="without the extra step")
@pytest.mark.parametrize(
    "content", [b"", RANDOM, bytes(1_000_000), b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=A(#1);\n"]
)
def test_step_that_is_none(content: bytes) -> None:
    with pytest.raises(rps.InputError, match=r"is no STEP|holds no triangles"):
        surface_in(content, "step")
