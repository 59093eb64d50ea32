"""The gear at the head of a page: a still with labels, and on a click the same in three dimensions."""

import base64
import gzip
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rps_exudyn.analysis.passes import passes
from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import pretty
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.solids import plunger_ends
from rps_exudyn.pages.animation.animation_page import rendered
from rps_exudyn.pages.animation.camera import FIELD, Camera
from rps_exudyn.pages.animation.drawn import Drawing
from rps_exudyn.pages.animation.film import cutout, image_bytes
from rps_exudyn.pages.animation.motion import Motion
from rps_exudyn.pages.animation.parts import bearing_rings, picture_parts
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.results.result import Result
from rps_exudyn.results.rounding import rounded
from rps_exudyn.scenes.free_pinion_torque import SCENE
from rps_exudyn.simulate.run import simulate

SIZE = (760, 420)  # [pixels]
AZIMUTH, ELEVATION = 0.9, -0.35  # from below: teeth, yoke and bush in one picture [rad]
MARGINS = np.array([0.2, 0.09]), np.array([0.04, 0.1])  # left and top, right and bottom, for the labels
DISTANCES = np.geomspace(0.1, 20, 120)  # of the eye [m]
CENTRINGS = 4
LONGEST, DRAG = 2.6, 7.0  # arrows of the strongest force and of the bush, over the pinion's tip radius
SHAFT_END = 22e-3  # of the shaft beyond its bearings [m]
BENT, ROUND = (-0.75 * np.pi, 0.6 * np.pi), 40  # arc of the torque's arrow [rad], and its points
RADIUS = 1.9  # of this arc, over the shaft's
HEAD = (14.0, 10.0)  # length and width of an arrow's head [pixels]
ALT = (
    "The gear from below: pinion (orange) in mesh with the rack (grey), the yoke with plunger, spring and "
    "nut (blue) cut open above it, the bush (green) along the rack. Rings show the bearings, where the model "
    "has a friction torque and no body. Arrows end where a force acts."
)
PART_OF_BODY = {"plunger": "seat", "mesh": "mesh"}


@dataclass(frozen=True)
class Label:
    """A label of a part in the gear's picture, at a place [%]."""

    name: str
    value: str
    part: str
    side: str  # of the label on which it ends
    left: float = 0.0
    top: float = 0.0


@dataclass(frozen=True)
class ForceArrow:
    """An arrow over the gear's picture: points of its line and of its head "x,y x,y" [pixels]."""

    part: str
    line: str
    head: str


@dataclass(frozen=True)
class GearPicture:
    """The gear as a still with labels and arrows of forces; in three dimensions a page (gzip in base 64)."""

    image: str
    size: tuple[int, int]  # [pixels]
    alt: str
    labels: Sequence[Label]
    arrows: Sequence[ForceArrow]
    page: str


def gear_picture(gear: SteeringGear, result: Result | None = None) -> GearPicture | None:
    """Return the picture of a gear; None of one that cannot be built. Mean forces, and the motion in three
    dimensions, are those of `result`; without one those of the free turning gear by its closed form."""
    try:
        still = simulate(SCENE.name, gear.replace({"test.path": "one-way"}), "closed-form")
        parts = picture_parts(gear)
        short = picture_parts(gear.replace({"pinion.shaft_length": _shown_shaft(gear)}))
        motion = Motion.of(still)
        drawing = Drawing(motion, [*short, bearing_rings(gear)], None)
        moves = result is not None and {"pinion_angle", "rack_displacement"} <= result.signals.keys()
        shown = result if result is not None and moves else still
        moving = Motion.of(shown)
    except InputError:
        return None
    anchors = list(_anchors(gear, moving))
    camera = _camera(np.stack([point for point, *_ in anchors]))
    image = image_bytes(cutout(drawing.bodies(camera), camera, SIZE), "webp")
    played = rendered(shown, moving, parts, None, image)
    return GearPicture(
        image=f"data:image/webp;base64,{base64.b64encode(image).decode('ascii')}",
        size=SIZE,
        alt=ALT,
        labels=[_placed(camera, *each) for each in anchors],
        arrows=[_bent(gear, camera), *_straight(gear, drawing, camera)],
        page=base64.b64encode(gzip.compress(played.encode(), mtime=0)).decode("ascii"),
    )


def _shown_shaft(gear: SteeringGear) -> float:
    """Length of the shaft that is drawn [m]: a longer one hides the teeth."""
    ends = (gear.bearing.upper_position, -gear.bearing.lower_position)
    return min(gear.pinion.shaft_length, max(gear.pinion.face_width, 2 * (max(ends) + SHAFT_END)))


def _anchors(gear: SteeringGear, motion: Motion) -> Iterator[tuple[np.ndarray, tuple[int, int], Label]]:
    """Of each label the point that it names [m], shape (3,), the way from there [pixels], and itself."""
    pair = GearPair.of(gear)
    axis, half, along = pair.bar_axis_height, _shown_shaft(gear) / 2, pair.pinion_frame[:, 2]
    found = passes(motion.signals) if "pinion_angle" in motion.signals else []
    # Of the first pass: the mean torque of both directions together is next to nothing
    first = replace(motion, signals=found[0].signals) if len(found) > 1 else motion
    nut = axis + plunger_ends(gear)[1] + gear.yoke.clearance + gear.yoke.nut_thickness
    drag, friction = (_shown(gear, path) for path in ("bush.drag", "bearing.friction_torque"))
    yoke, torque = _mean(motion, "seat_force"), _mean(first, "pinion_torque")
    sides = [_mean(motion, f"mesh_normal_force_{side}") for side in ("drive", "coast")]
    teeth = " and ".join(each for each in sides if each).replace(" N and", " and")
    pressing = Label("yoke", f"{'presses with ' * bool(yoke)}{yoke}", "seat", "right")
    yield np.array([0.0, nut, 0.0]), (45, -4), pressing
    tips = pair.pinion_origin - np.array([0.0, pair.tip_radius, 0.0])
    yield tips, (-66, -40), Label("teeth", teeth, "mesh", "left")
    lower = pair.pinion_origin + gear.bearing.lower_position * along
    yield lower, (-10, 48), Label("bearings", friction, "bearing", "middle")
    bush = np.array([gear.bush.distance, axis - gear.bush.outer_diameter / 2, 0.0])
    yield bush, (-30, 36), Label("bush", f"drags with {drag}", "bush", "left")
    yield pair.pinion_origin + half * along, (52, -34), Label("torque", torque, "torque", "right")


def _mean(motion: Motion, signal: str) -> str:
    """The mean of a signal in its display unit, in two or three digits; "" of one that the record lacks."""
    if signal not in motion.signals:
        return ""
    return rounded(SIGNALS[signal], float(motion.signals[signal].mean()))


def _shown(gear: SteeringGear, path: str) -> str:
    """The value of a parameter with three digits."""
    number, _, unit = gear.declared_at(path)[0].show(gear.value_at(path)).partition(" ")
    return f"{float(number):.3g} {pretty(unit)}"


# --- Arrows over the still, in its pixels


def _straight(gear: SteeringGear, drawing: Drawing, camera: Camera) -> Iterator[ForceArrow]:
    """The forces on the rack: of yoke and teeth as long as they are large, of the bush against its motion."""
    size = GearPair.of(gear).tip_radius
    for each in drawing.arrows:
        if each.part in PART_OF_BODY and each.signal != "yokenut_force":
            force = float(drawing.motion.signals[each.signal].mean())
            tip = drawing.acts_at(each)
            tail = tip - LONGEST * size * force / drawing.strongest * each.direction
            yield _arrow(camera, np.stack([tail, tip]), PART_OF_BODY[each.part])
    low = GearPair.of(gear).bar_axis_height - gear.bush.outer_diameter / 2
    tip = np.array([gear.bush.distance, low, 0.0])
    yield _arrow(camera, np.stack([tip + np.array([DRAG * size, 0.0, 0.0]), tip]), "bush")


def _bent(gear: SteeringGear, camera: Camera) -> ForceArrow:
    pair = GearPair.of(gear)
    across, up, along = pair.pinion_frame.T
    angle = np.linspace(*BENT, ROUND)[:, None]
    circle = RADIUS * gear.pinion.shaft_diameter / 2 * (np.cos(angle) * across + np.sin(angle) * up)
    return _arrow(camera, pair.pinion_origin + _shown_shaft(gear) / 2 * along + circle, "torque")


def _arrow(camera: Camera, points: np.ndarray, part: str) -> ForceArrow:
    """Points from tail to tip, shape (n, 3) [m], as a line that ends in a head."""
    seen = camera.seen(points, *SIZE)[:, :2]
    tip, length, width = seen[-1], *HEAD
    far = np.linalg.norm(seen - tip, axis=1) > length
    line = seen[: max(1, int(np.flatnonzero(far)[-1]) + 1 if far.any() else 1)]
    way = (tip - line[-1]) / max(float(np.linalg.norm(tip - line[-1])), 1e-9)
    foot, side = tip - length * way, width / 2 * np.array([-way[1], way[0]])
    return ForceArrow(part, _text([*line, foot]), _text([tip, foot + side, foot - side]))


def _text(points: Iterable[np.ndarray]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _camera(points: np.ndarray) -> Camera:
    """The nearest eye that sees all points, shape (n, 3) [m]."""
    for distance in DISTANCES:
        target = (points.min(axis=0) + points.max(axis=0)) / 2
        for _ in range(CENTRINGS):
            camera = Camera(target, AZIMUTH, ELEVATION, float(distance))
            seen = camera.seen(points, *SIZE)
            places = seen[:, :2] / SIZE
            middle = (MARGINS[0] + 1 - MARGINS[1]) / 2
            beside, below = (places.min(axis=0) + places.max(axis=0)) / 2 - middle
            height = 2 * distance * np.tan(FIELD / 2)
            right, up, _ = camera.axes
            target = target + height * (beside * SIZE[0] / SIZE[1] * right - below * up)
        if (seen[:, 2] > 0).all() and (places > MARGINS[0]).all() and (places < 1 - MARGINS[1]).all():
            break
    return camera


def _placed(camera: Camera, point: np.ndarray, off: tuple[int, int], label: Label) -> Label:
    left, top = (100 * (camera.seen(point, *SIZE)[:2] + off) / SIZE).tolist()
    return replace(label, left=left, top=top)
