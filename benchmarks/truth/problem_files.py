"""Each problem as files for any program: MJCF, URDF and STL of its scenes, parameters, right answers."""

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import trimesh

from benchmarks.truth.problems import PROBLEMS, Body, Box, Problem, Scene
from rps_exudyn.base.files import replacing, write_json

FOLDER = Path(__file__).parent


def corners(box: Box) -> np.ndarray:
    """Return the corners of a plate's upper face (4, 3), against the clock as seen from above."""
    signs = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
    found: np.ndarray = box.middle + (signs * np.array(box.half)) @ box.axes.T
    return found


def _child(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, tag, attributes)


def _words(numbers: Any) -> str:
    return " ".join(f"{each:.9g}" for each in np.ravel(numbers))


def mjcf(scene: Scene) -> str:
    """Return a scene for MuJoCo: feet touch plates alone."""
    root = ElementTree.Element("mujoco", model=scene.name)
    _child(root, "compiler", angle="radian", autolimits="true")
    _child(root, "option", gravity=_words(scene.gravity), timestep="0.001")
    default = _child(root, "default")
    _child(default, "geom", friction=f"{scene.friction} 0 0", condim="3", mass="0")
    world = _child(root, "worldbody")
    for box in scene.ground:
        _mjcf_box(world, box)
    for body in scene.bodies:
        own = _child(world, "body", name=body.name, pos=_words(body.place))
        _child(own, "inertial", pos="0 0 0", mass=str(body.mass), diaginertia=_words([body.inertia] * 3))
        for freedom in body.freedoms:
            _child(own, "joint", name=freedom.name, type=freedom.kind, axis=_words(freedom.axis))
        for foot in body.feet:
            _child(
                own,
                "geom",
                type="sphere",
                pos=_words(foot),
                size=f"{body.foot_radius:g}",
                contype="1",
                conaffinity="2",
            )
        for box in body.boxes:
            _mjcf_box(own, box)
    if scene.drive:
        actuators = _child(root, "actuator")
        gains = {"kp": f"{scene.drive.stiffness:g}", "kv": f"{scene.drive.damping:g}"}
        _child(actuators, "position", name="drive", joint=scene.drive.freedom, **gains)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _mjcf_box(parent: ElementTree.Element, box: Box) -> None:
    axes = _words([*box.axes[:, 0], *box.axes[:, 1]])
    place = {"pos": _words(box.middle), "xyaxes": axes, "size": _words(box.half)}
    _child(parent, "geom", type="box", contype="2", conaffinity="1", **place)


def urdf(scene: Scene, stiffness: float = 0.0) -> str:
    """Return a scene for robotics programs; with a stiffness [N/m] also Drake's properties of its feet.

    A body of several freedoms hangs on links without geometry, a freedom each.
    """
    root = ElementTree.Element("robot", name=scene.name)
    _child(root, "link", name="world")
    ground = _child(root, "link", name="ground")
    for i, box in enumerate(scene.ground):
        _urdf_box(ground, f"ground_{i}", box, scene, stiffness)
    fixed = _child(root, "joint", name="fixed", type="fixed")
    _child(fixed, "parent", link="world")
    _child(fixed, "child", link="ground")
    for body in scene.bodies:
        _urdf_body(root, body, scene, stiffness)
    if scene.drive:
        transmission = _child(root, "transmission", name="drive_transmission")
        _child(transmission, "type").text = "transmission_interface/SimpleTransmission"
        _child(transmission, "joint", name=scene.drive.freedom)
        _child(transmission, "actuator", name="drive")
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _urdf_body(root: ElementTree.Element, body: Body, scene: Scene, stiffness: float) -> None:
    parent, place = "world", _words(body.place)
    for i, freedom in enumerate(body.freedoms):
        is_last = i == len(body.freedoms) - 1
        name = body.name if is_last else f"{body.name}_{freedom.name}"
        kind = {"slide": "prismatic", "hinge": "continuous"}[freedom.kind]
        joint = _child(root, "joint", name=freedom.name, type=kind)
        _child(joint, "parent", link=parent)
        _child(joint, "child", link=name)
        _child(joint, "origin", xyz=place)
        _child(joint, "axis", xyz=_words(freedom.axis))
        if kind == "prismatic":
            _child(joint, "limit", lower="-1", upper="1", effort="1e6", velocity="100")
        link = _child(root, "link", name=name)
        inertial = _child(link, "inertial")
        share = 1.0 if is_last else 1e-9
        _child(inertial, "mass", value=f"{share * body.mass:g}")
        about = dict.fromkeys(("ixx", "iyy", "izz"), f"{share * body.inertia:g}")
        _child(inertial, "inertia", **about, ixy="0", ixz="0", iyz="0")
        parent, place = name, "0 0 0"
    for i, foot in enumerate(body.feet):
        collision = _child(link, "collision", name=f"{body.name}_foot_{i}")
        _child(collision, "origin", xyz=_words(foot))
        geometry = _child(collision, "geometry")
        _child(geometry, "sphere", radius=f"{body.foot_radius:g}")
        _surface(collision, scene, stiffness)
    for i, box in enumerate(body.boxes):
        _urdf_box(link, f"{body.name}_plate_{i}", box, scene, stiffness)


def _urdf_box(link: ElementTree.Element, name: str, box: Box, scene: Scene, stiffness: float) -> None:
    from scipy.spatial.transform import Rotation

    collision = _child(link, "collision", name=name)
    angles = Rotation.from_matrix(box.axes).as_euler("xyz")
    _child(collision, "origin", xyz=_words(box.middle), rpy=_words(angles))
    geometry = _child(collision, "geometry")
    _child(geometry, "box", size=_words(2 * np.array(box.half)))
    _surface(collision, scene, stiffness)


def _surface(collision: ElementTree.Element, scene: Scene, stiffness: float) -> None:
    if not stiffness:
        return
    properties = _child(collision, "drake:proximity_properties")
    for name in ("mu_static", "mu_dynamic"):
        _child(properties, f"drake:{name}", value=f"{scene.friction:g}")
    _child(properties, "drake:point_contact_stiffness", value=f"{2 * stiffness:g}")
    _child(properties, "drake:relaxation_time", value="0.001")
    _child(properties, "drake:hunt_crossley_dissipation", value="10")


def solid_of(scene: Scene) -> trimesh.Trimesh:
    """Return all plates and feet of a scene at rest, one mesh [mm]."""
    parts = [_box_mesh(box, (0.0, 0.0, 0.0)) for box in scene.ground]
    for body in scene.bodies:
        parts += [_box_mesh(box, body.place) for box in body.boxes]
        for foot in body.feet:
            ball = trimesh.creation.icosphere(subdivisions=1, radius=body.foot_radius)
            parts.append(ball.apply_translation(np.add(foot, body.place)))
    whole: trimesh.Trimesh = trimesh.util.concatenate(parts)
    return whole.apply_scale(1e3)


def _box_mesh(box: Box, place: tuple[float, float, float]) -> trimesh.Trimesh:
    there = np.eye(4)
    there[:3, :3], there[:3, 3] = box.axes, box.middle + np.array(place)
    return trimesh.creation.box(2 * np.array(box.half), there)


def parameters(problem: Problem) -> dict[str, Any]:
    """Return what a program needs beside the geometry [SI]."""

    def of(scene: Scene) -> dict[str, Any]:
        driven = scene.drive._asdict() if scene.drive else None
        return {
            "friction": scene.friction,
            "gravity": scene.gravity,
            "seconds": scene.seconds,
            "observed": scene.observed,
            "drive": driven,
            "masses": {body.name: body.mass for body in scene.bodies},
        }

    return {scene.name: of(scene) for scene in problem.scenes}


def write(problem: Problem, folder: Path) -> None:
    """Write a problem's files into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for scene in problem.scenes:
        texts = {".xml": mjcf(scene), ".urdf": urdf(scene)}
        for ending, text in texts.items():
            with replacing(folder / f"{scene.name}{ending}") as partial:
                partial.write_text(text, encoding="utf-8")
        with replacing(folder / f"{scene.name}.stl") as partial:
            partial.write_bytes(solid_of(scene).export(file_type="stl"))
    write_json(folder / "parameters.json", parameters(problem))
    write_json(folder / "reference.json", {name: truth._asdict() for name, truth in problem.truths.items()})


if __name__ == "__main__":
    for each in PROBLEMS.values():
        write(each, FOLDER / each.name)
