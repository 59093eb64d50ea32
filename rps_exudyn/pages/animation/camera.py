"""Where the eye is: an orbit around the mesh, perspective projection. The page's script has the same."""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import plunger_ends
from rps_exudyn.parameters.gear import SteeringGear

VIEWS = ("gear", "mesh", "along-the-pinion", "whole-rack")
FIELD = 0.5  # vertical field of view [rad]
UNCUT = 1e3  # [m]
NEAR = 5e-3  # nothing nearer to the eye is drawn [m]


@dataclass(frozen=True, eq=False)
class Camera:
    """An eye that looks at a target; azimuth about Y from +Z towards -X, elevation upwards."""

    target: np.ndarray  # [m], shape (3,)
    azimuth: float
    elevation: float
    distance: float  # [m]
    shaft_cut: float = UNCUT  # largest Z at which the pinion is drawn [m]

    @property
    def towards_eye(self) -> np.ndarray:
        """Unit vector from the target to the eye, shape (3,)."""
        flat = np.cos(self.elevation)
        return np.array([-flat * np.sin(self.azimuth), np.sin(self.elevation), flat * np.cos(self.azimuth)])

    @property
    def eye(self) -> np.ndarray:
        """Place of the eye [m], shape (3,)."""
        return self.target + self.distance * self.towards_eye

    @property
    def axes(self) -> np.ndarray:
        """Rows: right, up, towards the eye; shape (3, 3)."""
        forward = self.towards_eye
        right = np.array([np.cos(self.azimuth), 0.0, np.sin(self.azimuth)])
        return np.stack([right, np.cross(forward, right), forward])

    def seen(self, points: np.ndarray, width: int, height: int) -> np.ndarray:
        """Pixels from the left and from the top, and depth in front of the eye [m], shape (..., 3)."""
        local = (points - self.eye) @ self.axes.T
        depth = -local[..., 2]
        scale = height / 2 / np.tan(FIELD / 2) / depth
        return np.stack([width / 2 + local[..., 0] * scale, height / 2 - local[..., 1] * scale, depth], -1)


def view(name: str, gear: SteeringGear, explode: float = 0.0) -> Camera:
    """The eye of one of `VIEWS`, as near as the gear's size allows; farther for parts taken apart."""
    pair, bar, yoke = GearPair.of(gear), RackBar.of(gear), gear.yoke
    pitch_point = np.array([0.0, pair.reference_radius, 0.0])
    if name == "mesh":
        return Camera(pitch_point, -0.8, -0.12, 7.5 * pair.tip_radius)
    if name == "along-the-pinion":
        teeth = 0.51 * gear.pinion.face_width  # the shaft before them hides them
        return Camera(pitch_point, 0.2, -0.06, 9 * pair.tip_radius, teeth)
    if name == "whole-rack":
        middle = np.array([(bar.x_min + bar.x_max) / 2, pair.bar_axis_height, 0.0])
        return Camera(middle, -0.3, 0.25, _distance(0.68 * gear.rack.length))
    low = -pair.tip_radius
    high = pair.bar_axis_height + plunger_ends(gear)[1] + yoke.clearance + yoke.nut_thickness
    apart = 1 + 1.3 * explode
    return Camera(np.array([0.0, (low + apart * high) / 2, 0.0]), -0.72, 0.2, _distance(apart * (high - low)))


def _distance(height: float) -> float:
    """Distance from which a height [m] fills most of the picture [m]."""
    return 0.6 * height / np.tan(FIELD / 2)


def in_front(camera: Camera, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cut triangles (n, 3, 3) [m] off where they are nearer to the eye than `NEAR`. Return the weights of the
    three corners at each corner of what is left (m, 3, 3), the triangle's number (m,), and the corners
    (m, 3, 3) [m]."""
    ahead = (camera.eye - corners) @ camera.towards_eye - NEAR
    inside = ahead > 0
    whole = np.flatnonzero(inside.all(axis=1))
    weights, numbers = [np.broadcast_to(np.eye(3), (whole.size, 3, 3))], [whole]
    for number in np.flatnonzero(inside.any(axis=1) & ~inside.all(axis=1)):
        polygon = _cut(ahead[number])
        for at in range(1, len(polygon) - 1):
            weights.append(np.array([[polygon[0], polygon[at], polygon[at + 1]]]))
            numbers.append(np.array([number]))
    every, of = np.concatenate(weights), np.concatenate(numbers)
    return every, of, every @ corners[of]


def _cut(ahead: np.ndarray) -> list[np.ndarray]:
    """Corners, as weights of the triangle's three, of the part with `ahead` above 0 (Sutherland, Hodgman)."""
    polygon, corner = [], np.eye(3)
    for i in range(3):
        j = (i + 1) % 3
        if ahead[i] > 0:
            polygon.append(corner[i])
        if (ahead[i] > 0) != (ahead[j] > 0):
            share = ahead[i] / (ahead[i] - ahead[j])
            polygon.append((1 - share) * corner[i] + share * corner[j])
    return polygon
