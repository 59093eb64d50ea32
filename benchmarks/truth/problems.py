"""Four problems of dry friction with closed answers: block, wedge, screw, reversal.

Bodies move along a few freedoms, with feet (spheres) on plates (boxes). A spring drives one freedom; its
force k (x_d(t) - x) - c v is the answer, or the motion is. Contact is rigid, and Coulomb's friction has one
coefficient. The wedge weighs a tenth of its load: a lighter one on feet that yield by 2 um vibrates, fed by
friction. Sources: block and wedge, any book on statics (angle of friction phi = atan mu); screw with a square
thread, Shigley, Mechanical Engineering Design, "The mechanics of power screws"; reversal, Masing's spring and
slider.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

GRAVITY = 9.81  # [m/s^2]
ALONG, UP = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


class Freedom(NamedTuple):
    """A motion of a body along (`slide`) or about (`hinge`) an axis through its origin."""

    name: str
    kind: str
    axis: tuple[float, float, float]


class Box(NamedTuple):
    """A plate: place of its middle [m], its axes as columns (3, 3), half its edges [m]."""

    middle: np.ndarray
    axes: np.ndarray
    half: tuple[float, float, float]


@dataclass(frozen=True)
class Body:
    """A body with feet (places of their middles [m]) or plates, at a place [m]."""

    name: str
    mass: float  # [kg]
    freedoms: tuple[Freedom, ...]
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    feet: tuple[tuple[float, float, float], ...] = ()
    boxes: tuple[Box, ...] = ()
    foot_radius: float = 1e-3  # [m]
    inertia: float = 1e-3  # about each axis [kg m^2]


class Drive(NamedTuple):
    """A spring [N/m, N m/rad] with damping to the ground; points (t, x_d), joined by lines, move its end."""

    freedom: str
    stiffness: float
    damping: float
    times: tuple[float, ...]
    places: tuple[float, ...]

    def target(self, time: float) -> float:
        """Place of its end."""
        return float(np.interp(time, self.times, self.places))


@dataclass(frozen=True)
class Scene:
    """What is simulated, from rest with feet that touch."""

    name: str
    observed: str  # the freedom whose motion is recorded
    bodies: tuple[Body, ...]
    ground: tuple[Box, ...]
    friction: float
    seconds: float
    gravity: tuple[float, float, float] = (0.0, 0.0, -GRAVITY)
    drive: Drive | None = None


class Motion(NamedTuple):
    """A record: times [s], place and rate of the observed freedom, the drive's force on it, (n,) each."""

    time: np.ndarray
    place: np.ndarray
    rate: np.ndarray
    force: np.ndarray

    def at(self, time: float) -> tuple[float, float]:
        """Place and rate at a time."""
        return float(np.interp(time, self.time, self.place)), float(np.interp(time, self.time, self.rate))

    def mean_force(self, first: float, last: float) -> float:
        """Mean of the drive's force between two times."""
        inside = (self.time >= first) & (self.time <= last)
        return float(np.mean(self.force[inside]))


class Truth(NamedTuple):
    """A right value, its uncertainty (what the scene has beside the formula), and what counts as 100 %."""

    value: float
    uncertainty: float
    size: float
    unit: str


@dataclass(frozen=True)
class Problem:
    """Scenes, what is asked of their motions, and the answers."""

    name: str
    title: str
    scenes: tuple[Scene, ...]
    answers: Callable[[Mapping[str, Motion]], dict[str, float]]
    truths: Mapping[str, Truth] = field(default_factory=dict)


def _flat(half: tuple[float, float, float], top: float = 0.0) -> Box:
    return Box(np.array([0.0, 0.0, top - half[2]]), np.eye(3), half)


def _corners(x: float, y: float, z: float) -> tuple[tuple[float, float, float], ...]:
    return tuple((a, b, z) for a in (-x, x) for b in (-y, y))


# --- a block of 10 mm on an incline


def _incline() -> Problem:
    mu, steep, shallow = 0.2, np.deg2rad(20), np.deg2rad(8)
    block = Body(
        "block",
        7.85e-3,
        (Freedom("x", "slide", ALONG), Freedom("z", "slide", UP)),
        (0, 0, 5e-3),
        _corners(4e-3, 4e-3, -4e-3),
    )
    plate = (_flat((0.5, 0.05, 0.01)),)

    def scene(name: str, angle: float, seconds: float) -> Scene:
        pull = (GRAVITY * float(np.sin(angle)), 0.0, -GRAVITY * float(np.cos(angle)))
        return Scene(name, "x", (block,), plate, mu, seconds, pull)

    def answers(motions: Mapping[str, Motion]) -> dict[str, float]:
        down, rest = motions["steep"], motions["shallow"]
        return {
            "acceleration": (down.at(0.3)[1] - down.at(0.1)[1]) / 0.2,
            "creep": (rest.at(1.0)[0] - rest.at(0.5)[0]) / 0.5,
        }

    right = GRAVITY * float(np.sin(steep) - mu * np.cos(steep))
    truths = {"acceleration": Truth(right, 0.0, right, "m/s^2"), "creep": Truth(0.0, 0.0, 1e-3, "m/s")}
    scenes = scene("steep", steep, 0.3), scene("shallow", shallow, 1.0)
    return Problem("incline", "A block of 10 mm on an incline", scenes, answers, truths)


# --- a wedge under a guided load


def _wedge() -> Problem:
    mu, beta, load, own = 0.15, np.deg2rad(10), 10.0, 1.0
    normal = np.array([np.sin(beta), 0.0, np.cos(beta)])
    axes = np.column_stack([[np.cos(beta), 0, -np.sin(beta)], [0, 1, 0], normal])
    middle, r = np.array([0.0, 0.0, 12e-3]), 2e-3
    wedge = Body(
        "wedge",
        own,
        (Freedom("x", "slide", ALONG), Freedom("lift", "slide", UP)),
        (0, 0, 0),
        _corners(15e-3, 8e-3, r),
        (Box(middle, axes, (25e-3, 15e-3, 2e-3)),),
        foot_radius=r,
    )
    height = float(middle[2] + (2e-3 + r) / np.cos(beta))
    block = Body(
        "block",
        load,
        (Freedom("z", "slide", UP),),
        (0, 0, height),
        ((0, -5e-3, 0), (0, 5e-3, 0)),
        foot_radius=r,
    )
    drive = Drive("x", 1e5, 100.0, (0.0, 0.8, 1.6), (0.0, 8e-3, 0.0))
    scene = Scene("wedge", "x", (wedge, block), (_flat((0.1, 0.05, 0.01)),), mu, 1.6, drive=drive)

    def answers(motions: Mapping[str, Motion]) -> dict[str, float]:
        motion = motions["wedge"]
        return {"force_in": motion.mean_force(0.4, 0.8), "force_out": motion.mean_force(1.2, 1.6)}

    phi, weight = np.arctan(mu), load * GRAVITY
    below = mu * (load + own) * GRAVITY
    inwards = float(weight * np.tan(beta + phi) + below)
    outwards = float(weight * np.tan(beta - phi) - below)
    truths = {
        "force_in": Truth(inwards, 0.0, inwards, "N"),
        "force_out": Truth(outwards, 0.0, -outwards, "N"),
    }
    return Problem("wedge", "A wedge that lifts a guided load", (scene,), answers, truths)


# --- a screw at its self-locking angle


def _screw() -> Problem:
    mu, radius, load, starts, pieces, r = 0.15, 10e-3, 10.0, 3, 20, 1e-3
    step, lead = np.deg2rad(5.0), np.arctan(mu)

    def piece(angle: float, own: float) -> Box:
        """A plate tangent to the helix that rises by `own` [rad] from its start."""
        out, along = (np.array([np.cos(a), np.sin(a), 0.0]) for a in (angle, angle + np.pi / 2))
        rising = np.cos(lead) * along + np.sin(lead) * np.array(UP)
        normal = np.cross(out, rising)
        top = radius * out + radius * mu * own * np.array(UP)
        half = (2e-3, 0.55 * radius * step / float(np.cos(lead)), 0.5e-3)
        return Box(top - half[2] * normal, np.column_stack([out, rising, normal]), half)

    starting = [2 * np.pi * start / starts for start in range(starts)]
    thread = tuple(piece(start + i * step, i * step) for start in starting for i in range(pieces))
    first = np.deg2rad(20)
    feet = tuple(
        (radius * float(np.cos(s + first)), radius * float(np.sin(s + first)), 0.0) for s in starting
    )
    height = float(radius * mu * first + r / np.cos(lead))
    freedoms = Freedom("z", "slide", UP), Freedom("turn", "hinge", UP)
    nut = Body("nut", load, freedoms, (0, 0, height), feet, foot_radius=r)
    drive = Drive("turn", 20.0, 0.02, (0.0, 0.8, 1.6), (0.0, 0.8, 0.0))
    scene = Scene("screw", "turn", (nut,), thread, mu, 1.6, drive=drive)

    def answers(motions: Mapping[str, Motion]) -> dict[str, float]:
        motion = motions["screw"]
        return {"torque_raise": motion.mean_force(0.4, 0.8), "torque_lower": motion.mean_force(1.2, 1.6)}

    raising = float(load * GRAVITY * radius * np.tan(2 * lead))
    # plates stand for the helix (0.05 %), and feet touch beside their radius (0.02 %)
    truths = {
        "torque_raise": Truth(raising, 7e-4 * raising, raising, "N m"),
        "torque_lower": Truth(0.0, 7e-4 * raising, raising, "N m"),
    }
    return Problem("screw", "A screw at its self-locking angle", (scene,), answers, truths)


# --- a slider on a spring, to and fro


def _reversal() -> Problem:
    mu, mass, pull, stiffness, reach = 0.2, 0.05, 20 * GRAVITY, 2e4, 1e-3
    freedoms = Freedom("x", "slide", ALONG), Freedom("z", "slide", UP)
    slider = Body("slider", mass, freedoms, (0, 0, 5e-3), _corners(4e-3, 4e-3, -4e-3))
    times, places = (0.0, 2.0, 2.5, 6.5, 7.0, 11.0), (0.0, reach, reach, -reach, -reach, reach)
    drive = Drive("x", stiffness, 6.3, times, places)
    scene = Scene(
        "reversal", "x", (slider,), (_flat((0.05, 0.05, 0.01)),), mu, 11.0, (0.0, 0.0, -pull), drive
    )

    def answers(motions: Mapping[str, Motion]) -> dict[str, float]:
        motion = motions["reversal"]
        cycle = motion.time >= 2.5
        ends = np.interp(motion.time[cycle], times, places)
        return {
            "loop_area": float(np.trapezoid(motion.force[cycle], ends)),
            "drift": motion.at(2.5)[0] - motion.at(2.1)[0],
        }

    limit = mu * mass * pull
    area = 4 * limit * (reach - limit / stiffness)
    # the slider rings by 0.35 um where it begins to slip, and the damper's force is 0.16 % of the limit
    truths = {
        "loop_area": Truth(area, 5e-4 * area, area, "J"),
        "drift": Truth(0.0, 1e-3 * limit / stiffness, limit / stiffness, "m"),
    }
    return Problem("reversal", "A slider on a spring, to and fro, with stops", (scene,), answers, truths)


PROBLEMS = {each.name: each for each in (_incline(), _wedge(), _screw(), _reversal())}
