"""One instant of a motion as triangles, drawn into an image: bodies, arrows and lines of contact."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import matplotlib as mpl
import numpy as np
from matplotlib.colors import to_rgb

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.animation.camera import UNCUT, Camera, in_front
from rps_exudyn.pages.animation.depth_buffer import FILL, SUN, paint
from rps_exudyn.pages.animation.motion import Motion, Pose, exploded
from rps_exudyn.pages.animation.overlays import Arrow, ContactLines, arrows
from rps_exudyn.pages.animation.page_data import SECTIONED
from rps_exudyn.pages.animation.parts import COLOURS, PicturePart

LONGEST = 2.6  # arrow of the strongest force, over the pinion's tip radius
Triangles = tuple[np.ndarray, ...]  # corners and normals (n, 3, 3), colours (n, 3), largest Z drawn (n,)
RIBBON = 0.005  # width of a line of contact over the eye's distance


@dataclass(frozen=True, eq=False)
class Drawing:
    """What is drawn of a motion; `explode` from 0 (in place) to 1 takes the parts apart."""

    motion: Motion
    parts: Sequence[PicturePart]
    lines: ContactLines | None
    explode: float = 0.0

    def draw(self, image: np.ndarray, camera: Camera, frame: int) -> None:
        """Draw one instant, deflections magnified, over an image (height, width, 3) in 0..1."""
        poses, _ = self._places(frame)
        paint_over(image, camera, self.bodies(camera, frame))
        if over := [mesh for arrow in self.arrows for mesh in self._arrow(arrow, frame)]:
            paint_over(image, camera, over)
        if self.lines is not None and not self.explode:
            paint_over(image, camera, [self._ribbons(self.lines, frame, poses["pinion"], camera)])

    def bodies(self, camera: Camera, frame: int = 0) -> list[Triangles]:
        """The bodies of one instant."""
        poses, away = self._places(frame)
        found = []
        for part in self.parts:
            turn, origin = poses[part.name]
            cut = camera.shaft_cut if part.name == "pinion" else 0.0 if part.name in SECTIONED else UNCUT
            found.append(triangles_of(part, (turn, origin + away[part.name]), cut))
        return found

    def _places(self, frame: int) -> tuple[dict[str, Pose], dict[str, np.ndarray]]:
        """Pose of each part, and how far it stands from its place."""
        away = {name: self.explode * step for name, step in exploded(self.motion.gear).items()}
        return self.motion.poses(frame, self.motion.largest_factors), away

    @cached_property
    def arrows(self) -> list[Arrow]:
        """The forces."""
        return arrows(self.motion)

    @cached_property
    def strongest(self) -> float:
        """The largest force of the record [N]."""
        return max(float(np.abs(self.motion.signals[each.signal]).max()) for each in self.arrows)

    def _arrow(self, arrow: Arrow, frame: int) -> list[Triangles]:
        size = GearPair.of(self.motion.gear).tip_radius
        length = LONGEST * size * float(self.motion.signals[arrow.signal][frame]) / self.strongest
        if abs(length) < 0.02 * LONGEST * size:
            return []
        head, way = self.acts_at(arrow, frame), np.sign(length) * arrow.direction
        thick = 0.1 * size
        tip = min(3.2 * thick, 0.6 * abs(length))
        neck, tail = head - tip * way, head - abs(length) * way
        colour = np.array(to_rgb(arrow.colour))
        shaft = _cone(tail, neck, 0.5 * thick, 0.5 * thick, colour)
        return [shaft, _cone(neck, head, 1.3 * thick, 0.0, colour)]

    def acts_at(self, arrow: Arrow, frame: int = 0) -> np.ndarray:
        """Point at which a force acts [m]; forces of the teeth in the middle of their lines, by load."""
        poses, away = self._places(frame)
        if arrow.part != "mesh":
            turn, origin = poses[arrow.part]
            return turn @ arrow.point + origin + away[arrow.part]
        turn, origin = poses["pinion"]
        if self.lines is not None:
            side = -1 if arrow.signal.endswith("drive") else 1
            here = (self.lines.frame == frame) & (self.lines.side == side)
            if here.any():
                load, ends = self.lines.load[here], self.lines.ends[here]
                share = np.linspace(0, 1, load.shape[1])
                first, last = (load * (1 - share)).sum(axis=1), (load * share).sum(axis=1)
                middle = (first @ ends[:, 0] + last @ ends[:, 1]) / load.sum()
                return turn @ middle + origin + away["pinion"]
        return np.array([0.0, GearPair.of(self.motion.gear).bar_axis_height + arrow.point[1], 0.0])

    def _ribbons(self, lines: ContactLines, frame: int, pose: Pose, camera: Camera) -> Triangles:
        """Lines of contact as bands turned to the eye, coloured by their load."""
        turn, origin = pose
        here = lines.frame == frame
        ends = lines.ends[here] @ turn.T + origin
        share = np.linspace(0, 1, lines.load.shape[1])[None, :, None]
        points = (1 - share) * ends[:, :1] + share * ends[:, 1:]
        across = np.cross(ends[:, 1] - ends[:, 0], camera.towards_eye)
        across *= RIBBON / 2 * camera.distance / np.linalg.norm(across, axis=1, keepdims=True)
        left, right = points - across[:, None], points + across[:, None]
        a, b, c, d = left[:, :-1], right[:, :-1], left[:, 1:], right[:, 1:]
        triangles = np.stack([np.stack([a, b, c], 2), np.stack([c, b, d], 2)], 2).reshape(-1, 3, 3)
        share_of_load = lines.load[here] / lines.load.max()
        middle = (share_of_load[:, 1:] + share_of_load[:, :-1]) / 2
        colours = np.repeat(mpl.colormaps["inferno"](0.18 + 0.8 * middle.ravel())[:, :3], 2, axis=0)
        count = len(triangles)
        return triangles, np.zeros((count, 3, 3)), colours, np.full(count, UNCUT)


def triangles_of(part: PicturePart, pose: Pose, cut: float) -> Triangles:
    """A body in its place; nothing of it is drawn beyond Z = `cut` [m]."""
    turn, origin = pose
    count = len(part.faces)
    colours = np.broadcast_to(COLOURS[part.name], (count, 3))
    world, normals = part.vertices @ turn.T + origin, part.normals @ turn.T
    return world[part.faces], normals[part.faces], colours, np.full(count, cut)


def paint_over(
    image: np.ndarray, camera: Camera, bodies: Sequence[Triangles], depth: np.ndarray | None = None
) -> None:
    """Draw triangles over the image, with a depth buffer of their own unless there is one."""
    world, normals, colours, cuts = (np.concatenate(each) for each in zip(*bodies, strict=True))
    height, width = image.shape[:2]
    depth = np.full((height, width), np.inf) if depth is None else depth
    weights, of, world = in_front(camera, world)
    lit = weights @ normals[of]
    seen = camera.seen(world, width, height)
    arrays = (np.ascontiguousarray(each, dtype=float) for each in (seen, world, lit, colours[of], cuts[of]))
    paint(image, depth, *arrays, camera.eye, SUN, FILL)


def _cone(
    start: np.ndarray, end: np.ndarray, radius: float, end_radius: float, colour: np.ndarray
) -> Triangles:
    """A round shaft or a cone between two points, closed at its start."""
    axis = (end - start) / np.linalg.norm(end - start)
    u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    u /= np.linalg.norm(u)
    angle = 2 * np.pi * np.arange(13) / 12
    out = np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * np.cross(axis, u)
    low, high = start + radius * out, end + end_radius * out
    a, b, c, d = low[:-1], low[1:], high[:-1], high[1:]
    m, n = out[:-1], out[1:]
    middle = np.broadcast_to(start, a.shape)
    world = np.concatenate([np.stack([a, b, c], 1), np.stack([c, b, d], 1), np.stack([middle, b, a], 1)])
    flat = np.broadcast_to(-axis, a.shape)
    normals = np.concatenate([np.stack([m, n, m], 1), np.stack([m, n, n], 1), np.stack([flat] * 3, 1)])
    count = len(world)
    return world, normals, np.broadcast_to(colour, (count, 3)), np.full(count, UNCUT)
