"""What is drawn over the bodies: forces as arrows, and the lines of contact with their loads."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rps_exudyn.analysis.load_distribution import LoadDistribution, load_distribution
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import plunger_ends
from rps_exudyn.pages.animation.motion import Motion
from rps_exudyn.pages.charts.style import COLOURS, PART_COLOURS
from rps_exudyn.parameters.gear import SteeringGear, surfaces_of
from rps_exudyn.parameters.retired import with_lines
from rps_exudyn.tooth_contact.line_loads import STATIONS

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
    yield Arrow("seat_force", "plunger on the rack", "plunger", back, -up, PART_COLOURS["seat"])
    nut = np.array([0.0, plunger_ends(gear)[1], 0.0])
    yield Arrow("yokenut_force", "yokenut on the plunger", "plunger", nut, -up, "#0B5F94")
    to_flank = np.array([0.0, -gear.rack.reference_height, 0.0])
    for side, name, colour in ((-1, "drive", "#5C3F00"), (1, "coast", "#8A5F00")):
        push = -pair.rack_flank_normal(side)  # of the pinion on the rack
        label = f"pinion on the rack, {name} flanks"
        yield Arrow(f"mesh_normal_force_{name}", label, "mesh", to_flank, push, colour)
    end, ink = np.array([bar.x_min, 0.0, 0.0]), COLOURS["torque"]
    yield Arrow("load_force", "load on the rack's end", "rack", end, np.array([-1.0, 0, 0]), ink)
    yield Arrow("rack_force", "drive of the rack", "rack", end, np.array([1.0, 0, 0]), ink)


# --- The lines on which the teeth touch, frame by frame, with the load along each
#
# A line of contact is a straight generator of the pinion's flank, so it is kept as two points in the pinion's
# frame and the loads at equally spaced stations between them.


@dataclass(frozen=True, eq=False)
class ContactLines:
    """All lines of all frames that carry a load, in the order of the frames; n of them."""

    frame: np.ndarray  # shape (n,)
    side: np.ndarray  # -1 drives the rack towards +X, shape (n,)
    rack_tooth: np.ndarray  # shape (n,)
    ends: np.ndarray  # first and last station, pinion frame, turning with it [m], shape (n, 2, 3)
    load: np.ndarray  # at the stations [N/m], shape (n, STATIONS)
    force: np.ndarray  # of the whole line, normal to the flank [N], shape (n,)


def contact_lines(motion: Motion) -> ContactLines | None:
    """The lines of a motion; None where the record has no deflections, nothing touches, or surfaces
    have no lines.

    With the law "area", which has pressures and no lines, their places and shares are those of "line";
    the sum of each side is the recorded force with every law.
    """
    gear = motion.gear
    if motion.rigid or surfaces_of(gear):
        return None
    loads = load_distribution(with_lines(gear), motion.signals)
    rows = np.arange(loads.load.size).reshape(-1, STATIONS)
    rows = rows[(loads.load[rows] > 0).any(axis=1)]
    if not rows.size:
        return None
    load = loads.load[rows]
    return ContactLines(
        frame=loads.instant[rows[:, 0]],
        side=loads.side[rows[:, 0]].astype(int),
        rack_tooth=loads.rack_tooth[rows[:, 0]].astype(int),
        ends=np.stack([_points(gear, loads, rows[:, at]) for at in (0, -1)], axis=1),
        load=load,
        force=(load * loads.length[rows]).sum(axis=1),
    )


def _points(gear: SteeringGear, loads: LoadDistribution, chosen: np.ndarray) -> np.ndarray:
    """Stations on the pinion's flanks in the pinion frame, runout included [m], shape (n, 3)."""
    pair, form = GearPair.of(gear), FlankForm.of(gear)
    points = np.empty((chosen.size, 3))
    teeth, sides = loads.tooth[chosen].astype(int), loads.side[chosen].astype(int)
    for tooth in np.unique(teeth):
        for side in (-1, 1):
            here = (teeth == tooth) & (sides == side)
            flank = Flank(pair, int(tooth) % pair.teeth, side, form)
            q, face = loads.roll[chosen][here], loads.face[chosen][here]
            points[here] = flank.point(flank.generator(q, face), face)
    return points + pair.eccentricity
