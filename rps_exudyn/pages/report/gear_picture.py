"""The gear at the head of a page: a still with labels, and on a click the same in three dimensions."""

import base64
import gzip
from collections.abc import Iterator

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import pretty
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.solids import plunger_ends
from rps_exudyn.pages.animation.animation_page import rendered
from rps_exudyn.pages.animation.camera import FIELD, Camera
from rps_exudyn.pages.animation.drawn import Drawing
from rps_exudyn.pages.animation.film import cutout, image_bytes
from rps_exudyn.pages.animation.motion import Motion
from rps_exudyn.pages.animation.parts import picture_parts
from rps_exudyn.pages.report.html import GearPicture, Label
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.simulate.run import simulate

SIZE = (760, 420)  # [pixels]
AZIMUTH, ELEVATION = 0.9, -0.35  # from below: teeth, yoke and bush in one picture [rad]
MARGIN = 0.1  # of the picture, around everything that has a label
DISTANCES = np.geomspace(0.1, 20, 120)  # of the eye [m]
CENTRINGS = 4
ALT = (
    "The gear from below: pinion (orange) in mesh with the rack (grey), the yoke with plunger, spring and "
    "nut (blue) cut open above it, the bush (green) along the rack. The bearings are not bodies but a "
    "friction torque on the pinion's shaft."
)

Anchors = dict[str, tuple[np.ndarray, str, str]]


def gear_picture(gear: SteeringGear, result: Result | None = None) -> GearPicture | None:
    """Return the picture of a gear; None of one that cannot be built.

    Args:
        gear: what is shown.
        result: whose motion the view in three dimensions plays; without one the rack only travels.
    """
    try:
        still = simulate(SCENE.name, gear.replace({"test.path": "one-way"}), "closed-form")
        motion = Motion.of(still)
        parts = picture_parts(gear)
        drawing = Drawing(motion, parts, None)
        shown = still if result is None or not _moves(result) else result
        moving = Motion.of(shown)
    except InputError:
        return None
    anchors = {text: (point, way, part) for text, point, way, part in _anchors(gear)}
    camera = _camera(np.stack([point for point, *_ in anchors.values()]))
    image = image_bytes(cutout(drawing, camera, SIZE), "webp")
    played = rendered(shown, moving, parts, None, image)
    return GearPicture(
        image=f"data:image/webp;base64,{base64.b64encode(image).decode('ascii')}",
        size=SIZE,
        alt=ALT,
        labels=[_label(camera, text, *anchor) for text, anchor in anchors.items()],
        page=base64.b64encode(gzip.compress(played.encode(), mtime=0)).decode("ascii"),
    )


def _moves(result: Result) -> bool:
    return "pinion_angle" in result.signals and "rack_displacement" in result.signals


def _anchors(gear: SteeringGear) -> Iterator[tuple[str, np.ndarray, str, str]]:
    """Text of each label, the point that it names [m], the side on which it stands, and the part."""
    pair = GearPair.of(gear)
    axis, half = pair.bar_axis_height, gear.pinion.shaft_length / 2
    nut = axis + plunger_ends(gear)[1] + gear.yoke.clearance + gear.yoke.nut_thickness
    bush = gear.bush.distance + gear.bush.length / 2
    value = {path: _shown(gear, path) for path in LABELLED}
    yield f"yoke {value['yoke.preload']}", np.array([0.0, nut, 0.0]), "right", "seat"
    yield "teeth", pair.pinion_origin - np.array([0.0, pair.tip_radius, 0.0]), "below", "mesh"
    end = pair.pinion_origin - half * pair.pinion_frame[:, 2]
    yield f"bearings {value['bearing.friction_torque']}", end, "below", "bearing"
    low = np.array([bush, axis - gear.bush.outer_diameter / 2, 0.0])
    yield f"bush {value['bush.drag']}", low, "below", "bush"


def _shown(gear: SteeringGear, path: str) -> str:
    """The value of a parameter with three digits."""
    number, _, unit = gear.declared_at(path)[0].show(gear.value_at(path)).partition(" ")
    return f"{float(number):.3g} {pretty(unit)}"


LABELLED = ("yoke.preload", "bearing.friction_torque", "bush.drag")


def _camera(points: np.ndarray) -> Camera:
    """The nearest eye that sees all points, shape (n, 3) [m]."""
    for distance in DISTANCES:
        target = (points.min(axis=0) + points.max(axis=0)) / 2
        for _ in range(CENTRINGS):
            camera = Camera(target, AZIMUTH, ELEVATION, float(distance))
            seen = camera.seen(points, *SIZE)
            places = seen[:, :2] / SIZE
            beside, below = (places.min(axis=0) + places.max(axis=0)) / 2 - 0.5
            height = 2 * distance * np.tan(FIELD / 2)
            right, up, _ = camera.axes
            target = target + height * (beside * SIZE[0] / SIZE[1] * right - below * up)
        if (seen[:, 2] > 0).all() and (places > MARGIN).all() and (places < 1 - MARGIN).all():
            break
    return camera


def _label(camera: Camera, text: str, point: np.ndarray, side: str, part: str) -> Label:
    x, y, _ = camera.seen(point, *SIZE).tolist()
    name, _, value = text.partition(" ")
    return Label(name, value, part, side, 100 * x / SIZE[0], 100 * y / SIZE[1])
