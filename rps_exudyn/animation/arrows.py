"""The forces of a record as arrows: where each acts, in which part's frame, along which direction."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rps_exudyn.animation.motion import Motion
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import plunger_ends

LEAST = 1e-3  # of the largest force: a smaller one gets no arrow


@dataclass(frozen=True, eq=False)
class Arrow:
    """A force that follows a signal; its head is at the point where it acts."""

    signal: str
    label: str
    part: str  # in whose frame the point is; the direction is the housing's
    point: np.ndarray  # [m], shape (3,)
    direction: np.ndarray  # of the force where the signal is above zero, shape (3,)
    colour: str


def arrows(motion: Motion) -> list[Arrow]:
    """The arrows of the forces that the record has and that are above zero at some instant."""
    present = [each for each in _all(motion) if each.signal in motion.signals]
    sizes = {each.signal: float(np.abs(motion.signals[each.signal]).max()) for each in present}
    least = LEAST * max(sizes.values(), default=0.0)
    return [each for each in present if sizes[each.signal] > least]


def _all(motion: Motion) -> Iterator[Arrow]:
    gear = motion.gear
    pair, bar, up = GearPair.of(gear), RackBar.of(gear), np.array([0.0, 1.0, 0.0])
    back = np.array([0.0, gear.rack.bar_diameter / 2, 0.0])
    yield Arrow("seat_force", "plunger on the rack", "plunger", back, -up, "#7b3fa0")
    nut = np.array([0.0, plunger_ends(gear)[1], 0.0])
    yield Arrow("yokenut_force", "yokenut on the plunger", "plunger", nut, -up, "#b00020")
    to_flank = np.array([0.0, -gear.rack.reference_height, 0.0])
    for side, name, colour in ((-1, "drive", "#d9480f"), (1, "coast", "#1971c2")):
        push = -pair.rack_flank_normal(side)  # of the pinion on the rack
        label = f"pinion on the rack, {name} flanks"
        yield Arrow(f"mesh_normal_force_{name}", label, "mesh", to_flank, push, colour)
    end = np.array([bar.x_min, 0.0, 0.0])
    yield Arrow("load_force", "load on the rack's end", "rack", end, np.array([-1.0, 0, 0]), "#2b8a3e")
    yield Arrow("rack_force", "drive of the rack", "rack", end, np.array([1.0, 0, 0]), "#2b8a3e")
