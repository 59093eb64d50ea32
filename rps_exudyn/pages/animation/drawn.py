"""One instant of a motion as triangles, drawn into an image: bodies, arrows and lines of contact."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import matplotlib as mpl
import numpy as np
from matplotlib.colors import to_rgb

from rps_exudyn.base.compiled import CUBE, MATRIX, VECTOR, entry
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.animation.camera import UNCUT, Camera, in_front
from rps_exudyn.pages.animation.motion import Motion, Pose, exploded
from rps_exudyn.pages.animation.overlays import Arrow, ContactLines, arrows
from rps_exudyn.pages.animation.page_data import SECTIONED
from rps_exudyn.pages.animation.parts import COLOURS, PicturePart

LONGEST = 2.6  # arrow of the strongest force, over the pinion's tip radius
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
        self.draw_bodies(image, np.full(image.shape[:2], np.inf), camera, frame)
        if over := [mesh for arrow in self.arrows for mesh in self._arrow(arrow, frame)]:
            _paint(image, None, camera, *(np.concatenate(each) for each in zip(*over, strict=True)))
        if self.lines is not None and not self.explode:
            _paint(image, None, camera, *self._ribbons(self.lines, frame, poses["pinion"], camera))

    def draw_bodies(self, image: np.ndarray, depth: np.ndarray, camera: Camera, frame: int = 0) -> None:
        """Draw the bodies of one instant where `depth` (height, width) is larger than theirs; change both."""
        poses, away = self._places(frame)
        bodies = [
            self._body(part, poses[part.name], away[part.name], camera.shaft_cut) for part in self.parts
        ]
        _paint(image, depth, camera, *(np.concatenate(each) for each in zip(*bodies, strict=True)))

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

    def _body(
        self, part: PicturePart, pose: Pose, away: np.ndarray, shaft_cut: float
    ) -> tuple[np.ndarray, ...]:
        turn, origin = pose
        world = part.vertices @ turn.T + origin + away
        normals = part.normals @ turn.T
        count = len(part.faces)
        colours = np.broadcast_to(COLOURS[part.name], (count, 3))
        cut = shaft_cut if part.name == "pinion" else 0.0 if part.name in SECTIONED else UNCUT
        cuts = np.full(count, cut)
        return world[part.faces], normals[part.faces], colours, cuts

    def _arrow(self, arrow: Arrow, frame: int) -> list[tuple[np.ndarray, ...]]:
        size = GearPair.of(self.motion.gear).tip_radius
        length = LONGEST * size * float(self.motion.signals[arrow.signal][frame]) / self.strongest
        if abs(length) < 0.02 * LONGEST * size:
            return []
        head, way = self.acts_at(arrow, frame), np.sign(length) * arrow.direction
        thick = 0.1 * size
        tip = min(3.2 * thick, 0.6 * abs(length))
        neck, tail = head - tip * way, head - abs(length) * way
        colour = np.array(to_rgb(arrow.colour))
        return [
            _cone(tail, neck, 0.5 * thick, 0.5 * thick, colour),
            _cone(neck, head, 1.3 * thick, 0.0, colour),
        ]

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

    def _ribbons(self, lines: ContactLines, frame: int, pose: Pose, camera: Camera) -> tuple[np.ndarray, ...]:
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


def _paint(
    image: np.ndarray,
    depth: np.ndarray | None,
    camera: Camera,
    world: np.ndarray,
    normals: np.ndarray,
    colours: np.ndarray,
    cuts: np.ndarray,
) -> None:
    """Draw triangles over the image, with a depth buffer of their own unless there is one."""
    height, width = image.shape[:2]
    depth = np.full((height, width), np.inf) if depth is None else depth
    weights, of, world = in_front(camera, world)
    lit = weights @ normals[of]
    seen = camera.seen(world, width, height)
    arrays = (np.ascontiguousarray(each, dtype=float) for each in (seen, world, lit, colours[of], cuts[of]))
    paint(image, depth, *arrays, camera.eye, SUN, FILL)


def _cone(
    start: np.ndarray, end: np.ndarray, radius: float, end_radius: float, colour: np.ndarray
) -> tuple[np.ndarray, ...]:
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
    normals = np.concatenate(
        [np.stack([m, n, m], 1), np.stack([m, n, n], 1), np.stack([flat, flat, flat], 1)]
    )
    count = len(world)
    return world, normals, np.broadcast_to(colour, (count, 3)), np.full(count, UNCUT)


# --- A depth buffer in compiled form: which triangle each pixel sees, and the light on it
#
# The page's shader (viewer/gl.js) and this kernel light bodies alike; hatched faces are those of a section.

SUN = np.array([-0.35, 0.75, 0.6]) / np.sqrt(0.35**2 + 0.75**2 + 0.6**2)
FILL = np.array([0.8, -0.35, 0.5]) / np.sqrt(0.8**2 + 0.35**2 + 0.5**2)
HATCHES = 45.0  # of a section, down a picture: flat on the picture, however deep the face lies


@entry(CUBE, MATRIX, CUBE, CUBE, CUBE, MATRIX, VECTOR, VECTOR, VECTOR, VECTOR)
def paint(image, depth, seen, world, normals, colours, cuts, eye, sun, fill):  # type: ignore[no-untyped-def]
    """Draw triangles over what is there.

    Args:
        image, depth: red, green, blue (height, width, 3), and depth (height, width), changed in place.
        seen: corners in pixels and depth, shape (n, 3, 3).
        world, normals: corners in the housing frame and unit normals there, shape (n, 3, 3); normals of
            length 0 are lit evenly.
        colours: shape (n, 3).
        cuts: largest Z that is drawn, shape (n,) [m].
        eye, sun, fill: place of the eye, directions towards both lights, shape (3,).
    """
    height, width = depth.shape
    for t in range(seen.shape[0]):
        ax, ay, az = seen[t, 0, 0], seen[t, 0, 1], seen[t, 0, 2]
        bx, by, bz = seen[t, 1, 0], seen[t, 1, 1], seen[t, 1, 2]
        cx, cy, cz = seen[t, 2, 0], seen[t, 2, 1], seen[t, 2, 2]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0.0:
            continue
        front = area < 0  # counter-clockwise from outside; pixels count downwards
        first = max(int(min(ax, bx, cx)), 0)
        last = min(int(max(ax, bx, cx)) + 1, width - 1)
        for row in range(max(int(min(ay, by, cy)), 0), min(int(max(ay, by, cy)) + 1, height - 1) + 1):
            y = row + 0.5
            for column in range(first, last + 1):
                x = column + 0.5
                v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
                w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
                u = 1.0 - v - w
                if u < 0.0 or v < 0.0 or w < 0.0:
                    continue
                z = 1.0 / (u / az + v / bz + w / cz)
                if z >= depth[row, column]:
                    continue
                p, q, r = u * z / az, v * z / bz, w * z / cz
                wz = p * world[t, 0, 2] + q * world[t, 1, 2] + r * world[t, 2, 2]
                if wz > cuts[t]:
                    continue
                depth[row, column] = z
                wx = p * world[t, 0, 0] + q * world[t, 1, 0] + r * world[t, 2, 0]
                wy = p * world[t, 0, 1] + q * world[t, 1, 1] + r * world[t, 2, 1]
                nx = p * normals[t, 0, 0] + q * normals[t, 1, 0] + r * normals[t, 2, 0]
                ny = p * normals[t, 0, 1] + q * normals[t, 1, 1] + r * normals[t, 2, 1]
                nz = p * normals[t, 0, 2] + q * normals[t, 1, 2] + r * normals[t, 2, 2]
                size = np.sqrt(nx * nx + ny * ny + nz * nz)
                extra = 0.0
                if size < 0.1:
                    light = 1.0
                elif not front:
                    light = 0.84 + 0.12 * (((column + row) * HATCHES / height) % 1.0 > 0.5)
                else:
                    nx, ny, nz = nx / size, ny / size, nz / size
                    ex, ey, ez = eye[0] - wx, eye[1] - wy, eye[2] - wz
                    far = np.sqrt(ex * ex + ey * ey + ez * ez)
                    to_sun = nx * sun[0] + ny * sun[1] + nz * sun[2]
                    to_fill = nx * fill[0] + ny * fill[1] + nz * fill[2]
                    to_eye = (nx * ex + ny * ey + nz * ez) / far
                    light = 0.34 + 0.14 * ny + 0.55 * max(to_sun, 0.0) + 0.22 * max(to_fill, 0.0)
                    # the sun's mirror image along the eye: 2 (n.s)(n.e) - s.e
                    along = (sun[0] * ex + sun[1] * ey + sun[2] * ez) / far
                    mirrored = max(2 * to_sun * to_eye - along, 0.0)
                    extra = 0.32 * mirrored**28 + 0.12 * (1.0 - max(to_eye, 0.0)) ** 3
                for k in range(3):
                    shade = min(max(colours[t, k] * light + extra, 0.0), 1.0)
                    image[row, column, k] = shade**0.85
