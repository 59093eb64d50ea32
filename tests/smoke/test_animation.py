"""What is shown of a motion is what was recorded: poses, lines of contact, forces; its files are whole."""

import base64
import dataclasses
import hashlib
import json
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import rps_exudyn as rps
from rps_exudyn.analysis.rack_motion import rack_poses
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.polyhedron import Solid
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import gear_solids
from rps_exudyn.pages.animation import film
from rps_exudyn.pages.animation.animation_page import page
from rps_exudyn.pages.animation.camera import VIEWS, Camera, in_front
from rps_exudyn.pages.animation.camera import view as camera_of
from rps_exudyn.pages.animation.depth_buffer import FILL, SUN, paint
from rps_exudyn.pages.animation.motion import MOST_FRAMES, Factors, Motion
from rps_exudyn.pages.animation.overlays import ContactLines, contact_lines
from rps_exudyn.pages.animation.page_data import page_data
from rps_exudyn.pages.animation.parts import CHORD_ERROR, picture_parts
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result
from shell import Command, refusal_of

SIDES = {"drive": -1, "coast": +1}


@pytest.fixture(scope="module")
def pitch() -> Result:
    """One tooth pitch with runout, away from the centre: every motion of the rack."""
    gear = rps.SteeringGear().replace({"pinion.runout": "20 um"})
    return rps.run("free-pinion-torque", gear, fidelity="quasi-static", turns=1 / 6, start_angle=2.0)


@pytest.fixture(scope="module")
def lines(pitch: Result) -> ContactLines:
    found = contact_lines(Motion.of(pitch))
    assert found is not None
    return found


def test_lines_of_contact_lie_on_both_flanks(pitch: Result, lines: ContactLines) -> None:
    """A line that is kept on the pinion's flank lies, at the recorded pose, on the plane of the rack's.

    It is pressed in by no more than the deepest penetration; the 3 um above the plane are unloaded ends.

    With the pinion turned the other way they would be millimetres apart.
    """
    motion, bar = Motion.of(pitch), RackBar.of(pitch.gear)
    distances = []
    for frame, side, tooth, ends in zip(lines.frame, lines.side, lines.rack_tooth, lines.ends, strict=True):
        poses = motion.poses(int(frame))
        (turn, origin), (rack_turn, rack_origin) = poses["pinion"], poses["rack"]
        flank = bar.flank(int(tooth), int(side))
        on_rack = (ends @ turn.T + origin - rack_origin) @ rack_turn
        distances.append((on_rack - flank.point) @ flank.normal)
    deepest = pitch["mesh_penetration"].max()
    assert -1.05 * deepest < np.min(distances) < -0.5 * deepest
    assert np.max(distances) < 3e-6


def decoded(item: dict[str, Any]) -> np.ndarray:
    """The values of an array of the page, flat."""
    kinds = {"uint16": "<u2", "int8": "i1", "float32": "<f4"}
    return item["scale"] * np.frombuffer(base64.b64decode(item["data"]), kinds[item["kind"]]).astype(float)


@pytest.mark.parametrize("name", SIDES)
def test_lines_carry_the_recorded_force(name: str, pitch: Result, lines: ContactLines) -> None:
    data = page_data(Motion.of(pitch), picture_parts(pitch.gear), lines)["lines"]
    begins, side = decoded(data["begins"]).astype(int), decoded(data["side"])
    force = decoded(data["force"]) * (side == SIDES[name])
    sums = [force[first:last].sum() for first, last in pairwise(begins)]
    recorded = pitch[f"mesh_normal_force_{name}"]
    np.testing.assert_allclose(sums, recorded, rtol=1e-6)  # single precision


def test_poses_are_the_recorded_ones(pitch: Result) -> None:
    motion, pair = Motion.of(pitch), GearPair.of(pitch.gear)
    points, _, turns = rack_poses(pair, pitch.signals)
    for frame in (0, motion.frames // 2):
        turn, origin = motion.poses(frame)["rack"]
        np.testing.assert_allclose(origin, points[frame], atol=1e-15)
        np.testing.assert_allclose(turn, turns[frame], atol=1e-15)


def test_magnified_deflections_keep_their_mean(pitch: Result) -> None:
    motion = Motion.of(pitch)
    for name in ("rack_y", "rack_roll"):
        large = motion.magnified(name, 300.0)
        assert large.mean() == pytest.approx(pitch[name].mean(), rel=1e-9)
        assert np.ptp(large) == pytest.approx(300 * np.ptp(pitch[name]), rel=1e-9)
    assert motion.largest_factors != Factors()
    assert motion.largest_factors.displacement * np.abs(motion.deviation("rack_y")).max() < 0.5e-3


def test_extremes_of_a_long_record_are_shown(made_up_result: Result) -> None:
    time = np.linspace(0, 1, 20_000)
    peak = np.where(np.arange(time.size) == 12_345, 7.0, 0.0)
    signals = {"time": time, "pinion_angle": time, "rack_displacement": time, "pinion_torque": peak}
    motion = Motion.of(dataclasses.replace(made_up_result, signals=signals))
    assert motion.signals["pinion_torque"].max() == 7.0
    assert motion.frames <= MOST_FRAMES + 2 * len(signals)
    assert motion.rigid


def test_bodies_are_those_of_the_model(pitch: Result) -> None:
    """Normals are of length 1, and the meshes have the volume of those that the model weighs.

    A chord's error over a body changes its volume by chord error times surface, of which a body of 10 mm has
    some 1e3 / m of its volume; the plunger is bored.
    """
    exact = gear_solids(pitch.gear)
    for part in picture_parts(pitch.gear):
        np.testing.assert_allclose(np.linalg.norm(part.normals, axis=1), 1, atol=1e-9)
        if part.name in ("pinion", "rack", "yokenut"):
            shown = Solid(part.vertices, part.faces, 1.0).mass_properties.volume
            assert shown == pytest.approx(exact[part.name].mass_properties.volume, rel=1e3 * CHORD_ERROR)


def test_page_is_whole_and_small(pitch: Result, tmp_path: Path, command: Command) -> None:
    pitch.save(tmp_path / "r.h5")
    assert command(["animate", "r.h5"]).out == "written: r-animation.html\n"
    text = (tmp_path / "r-animation.html").read_text(encoding="utf-8")
    assert len(text) < 500_000
    (script,) = re.findall(r"<script>(.*?)</script>", text, re.S)
    expected = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{expected}'" in text
    assert re.findall(r"https?://(?!www\.w3\.org/2000/svg)", text) == []
    (data,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)
    assert json.loads(data)["frames"] == len(pitch["time"])


def test_nothing_of_a_file_becomes_markup(pitch: Result) -> None:
    hostile = "</script><img src=x onerror=alert(1)>"
    named = dataclasses.replace(
        pitch, scene=hostile, message=hostile, status=Status.DIVERGED, fidelity={"name": hostile}
    )
    assert "<img src=x" not in page(named)


def test_gear_without_deflections_says_so() -> None:
    result = rps.run("free-pinion-torque", fidelity="closed-form")
    assert "has no deflections and no lines of contact" in page(result)


def test_film_of_a_pitch_repeats_itself(
    pitch: Result, tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    turn = np.linspace(0, 1.2, 25) * 2 * np.pi / 6
    signals = {"time": turn, "pinion_angle": turn, "rack_displacement": GearPair.of(pitch.gear).gain * turn}
    motion = Motion.of(dataclasses.replace(pitch, signals=signals))
    last = film.film_frames(motion)[-1]
    assert turn[last] < 2 * np.pi / 6 <= turn[last + 1] * (1 + 1e-9)
    monkeypatch.setattr(film, "FILM_FRAMES", 3)
    monkeypatch.setattr(film, "SIZE", (200, 120))
    pitch.save(tmp_path / "r.h5")
    assert command(["animate", "r.h5", "--out", "r.gif"]).status == 0
    with Image.open(tmp_path / "r.gif") as picture:
        assert (picture.n_frames, picture.size) == (3, (200, 120))
    assert command(["animate", "r.h5", "--out", "r.png", "--apart", "--view", "gear"]).status == 0
    with Image.open(tmp_path / "r.png") as picture:
        assert (np.ptp(np.asarray(picture), axis=2) > 60).sum() > 500  # bodies and arrows have colours
    monkeypatch.setenv("PATH", "")
    assert "needs the program ffmpeg" in refusal_of(command(["animate", "r.h5", "--out", "r.mp4"]))


def test_motion_that_is_not_there(failed_result: Result, tmp_path: Path, command: Command) -> None:
    dataclasses.replace(failed_result, signals={}).save(tmp_path / "r.h5")
    assert "There is no motion to show: NaN at t = 0.1 s." in refusal_of(command(["animate", "r.h5"]))


def test_nearer_triangle_hides_the_farther_one_and_the_section_opens_it() -> None:
    """Of two squares behind each other a pixel has the colour of the first that is not cut away."""
    camera = Camera(np.zeros(3), 0.0, 0.0, 1.0)
    square = np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0]], [[-1, -1, 0], [1, 1, 0], [-1, 1, 0]]]) * 0.1
    world = np.concatenate([square + np.array([0, 0, z]) for z in (0.0, 0.1)])
    colours = np.repeat([[1.0, 0, 0], [0, 1.0, 0]], 2, axis=0)
    seen, flat = camera.seen(world, 20, 20), np.zeros((4, 3, 3))
    found = []
    for cut in (1.0, 0.05):
        image, depth = np.zeros((20, 20, 3)), np.full((20, 20), np.inf)
        paint(image, depth, seen, world, flat, colours, np.full(4, cut), camera.eye, SUN, FILL)
        found.append(image[10, 10].tolist())
    assert found == [[0, 1, 0], [1, 0, 0]]


def test_triangles_behind_the_eye_are_cut_off() -> None:
    """A strip that passes the eye is drawn as far as it is in front; its plane stays the same."""
    camera = Camera(np.zeros(3), 0.0, 0.0, 1.0)
    strip = np.array([[[-1.0, -1, 0], [1, -1, 0], [0, -1, 5]], [[0, 0, 3], [1, 0, 3], [0, 1, 3]]])
    weights, numbers, corners = in_front(camera, strip)
    assert set(numbers.tolist()) == {0}
    assert (corners[..., 2] < 1).all()
    np.testing.assert_allclose(corners[..., 1], -1, atol=1e-12)
    np.testing.assert_allclose(weights.sum(axis=2), 1)


@pytest.mark.parametrize("view", VIEWS)
def test_camera_frames_what_it_names(view: str, pitch: Result) -> None:
    """Whole bodies are within the picture, and as large as it allows; nothing stands before the mesh."""
    width, height = film.SIZE
    camera = camera_of(view, pitch.gear)
    motion, parts = Motion.of(pitch), {part.name: part for part in picture_parts(pitch.gear)}
    poses = motion.poses(0)
    named = {"gear": ("plunger", "yokenut", "spring"), "whole-rack": ("rack", "bush")}
    if view in named:
        points = [parts[each].vertices @ poses[each][0].T + poses[each][1] for each in named[view]]
        seen = camera.seen(np.concatenate(points), width, height)[:, :2] / film.SIZE
        assert ((seen > 0) & (seen < 1)).all()
        assert np.ptp(seen, axis=0).max() > 0.4
        return
    pair = GearPair.of(pitch.gear)
    half = pitch.gear.pinion.face_width / 2
    turn = 2 * np.pi * np.arange(24)[:, None] / 24
    across, up, along = pair.pinion_frame.T
    circle = pair.pinion_origin + pair.tip_radius * (np.cos(turn) * across + np.sin(turn) * up)
    teeth = np.concatenate([circle - half * along, circle + half * along])
    seen = camera.seen(teeth, width, height)[:, :2] / film.SIZE
    assert ((seen > 0) & (seen < 1)).all()
    assert np.ptp(seen, axis=0).max() > 0.35
    if view == "along-the-pinion":
        assert camera.shaft_cut < 1.2 * half


def test_still_is_not_cut_and_not_empty(pitch: Result) -> None:
    """Of each view: bodies of several colours, and ground at both upper corners or above the rack."""
    motion, parts = Motion.of(pitch), picture_parts(pitch.gear)
    for view in VIEWS:
        pixels = np.asarray(film.still(motion, parts, None, film.SIZE, view)).astype(int)
        spread = pixels.max(axis=2) - pixels.min(axis=2)
        orange = (pixels[..., 0] > pixels[..., 2] + 60).mean()
        assert orange > (0.001 if view == "whole-rack" else 0.02)
        assert 0.002 < (spread > 40).mean() < 0.9
