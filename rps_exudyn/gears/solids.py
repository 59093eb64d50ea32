"""The gear's parts as solids of one material each: for pictures, files, booleans and the masses of a report.

Frames: pinion in the pinion frame, its axis of rotation on z; rack in the rack frame; plunger and yokenut
in a frame with axes parallel to the housing's and its origin on the bar's axis at the pitch point, at rest;
a bush segment around its own centre, axis X.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from manifold3d import Manifold

from rps_exudyn.gears.basic_rack import arc_segments
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.pinion_mesh import pinion_mesh
from rps_exudyn.gears.polyhedron import Solid, cylinder, from_manifold, to_manifold
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.gear import SteeringGear

CHORD_ERROR = 1e-6  # of the meshes unless wanted otherwise [m]
STEEL = 7850.0  # density of the yokenut, which is fixed and only shown [kg/m^3]
SEAT_RELIEF = 0.5e-3  # clearance of the plunger's front outside its seat [m]

RoundBar = tuple[str, float, float, float]  # axis, radius, from, to [m]

# Solids depend on few of a gear's parameters: the cases of a study share them, with their mass properties
_kept = lru_cache(maxsize=8)


def gear_solids(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> dict[str, Solid]:
    """All parts by name, each in its own frame."""
    return {
        "pinion": pinion_solid(gear, chord_error),
        "rack": rack_solid(gear, chord_error),
        "plunger": plunger_solid(gear, chord_error),
        "yokenut": yokenut_solid(gear, chord_error),
        "bush_segment": bush_segment_solid(gear, chord_error),
    }


def pinion_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Toothed part, displaced by the runout, and the shaft through its middle."""
    pinion = gear.pinion
    shaft = pinion.shaft_diameter, pinion.shaft_length
    return _pinion(GearPair.of(gear), FlankForm.of(gear), *shaft, pinion.density, chord_error)


@_kept
def _pinion(
    pair: GearPair, form: FlankForm, diameter: float, length: float, density: float, chord_error: float
) -> Solid:
    teeth = pinion_mesh(pair, chord_error, form)
    shaft = _round_bar("Z", diameter / 2, -length / 2, length / 2, chord_error)
    return _solid(to_manifold(teeth.vertices + pair.eccentricity, teeth.faces) + shaft, density)


def rack_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Bar with teeth."""
    return _rack(RackBar.of(gear), gear.rack.density, chord_error)


@_kept
def _rack(bar: RackBar, density: float, chord_error: float) -> Solid:
    return _solid(bar.solid(chord_error), density)


def plunger_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Plunger; its density gives the declared mass."""
    return _weighing(gear.yoke.plunger_mass, *plunger_bars(gear), chord_error)


def yokenut_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Yokenut."""
    return _drilled(STEEL, *yokenut_bars(gear), chord_error)


def bush_segment_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """One of the equal hollow cylinders that the bush is divided into."""
    return _drilled(gear.bush.density, *bush_segment_bars(gear), chord_error)


def plunger_bars(gear: SteeringGear) -> tuple[RoundBar, tuple[RoundBar, ...]]:
    """Round plunger, and the holes that are its cylindrical seat for the back of the bar.

    The seat spans +-seat_angle about +Y and seat_length along the rack; outside it the front is relieved.
    """
    yoke, bar, beyond = gear.yoke, gear.rack.bar_diameter / 2, gear.yoke.plunger_diameter
    seat = ("X", bar, -beyond, beyond)
    low, high = sorted((yoke.seat_length / 2, beyond))
    reliefs = [("X", bar + SEAT_RELIEF, *ends) for ends in ((-high, -low), (low, high))]
    return ("Y", beyond / 2, *plunger_ends(gear)), (seat, *reliefs)


def yokenut_bars(gear: SteeringGear) -> tuple[RoundBar, tuple[RoundBar, ...]]:
    """Disc behind the plunger, the yoke clearance away from it."""
    yoke = gear.yoke
    start = plunger_ends(gear)[1] + yoke.clearance
    return ("Y", yoke.nut_diameter / 2, start, start + yoke.nut_thickness), ()


def bush_segment_bars(gear: SteeringGear) -> tuple[RoundBar, tuple[RoundBar, ...]]:
    """A segment of the bush, and its hole."""
    bush = gear.bush
    half = bush.length / bush.segments / 2
    hole = ("X", bush.inner_diameter / 2, -bush.length, bush.length)
    return ("X", bush.outer_diameter / 2, -half, half), (hole,)


@_kept
def _drilled(density: float, bar: RoundBar, holes: tuple[RoundBar, ...], chord_error: float) -> Solid:
    """A round bar from which others are taken away."""
    body = _round_bar(*bar, chord_error)
    for hole in holes:
        body -= _round_bar(*hole, chord_error)
    return _solid(body, density)


@_kept
def _weighing(mass: float, bar: RoundBar, holes: tuple[RoundBar, ...], chord_error: float) -> Solid:
    """Solid of a given mass [kg]."""
    unit = _drilled(1.0, bar, holes, chord_error)
    return replace(unit, density=mass / unit.mass_properties.volume)


def plunger_ends(gear: SteeringGear) -> tuple[float, float]:
    """Y of the plunger's front, at the seat's edges, and of its back, above the bar's axis [m]."""
    front = gear.rack.bar_diameter / 2 * float(np.cos(gear.yoke.seat_angle))
    return front, front + gear.yoke.plunger_length


def _round_bar(axis: str, radius: float, start: float, stop: float, chord_error: float) -> Manifold:
    """A cylinder about one of the axes."""
    direction = np.eye(3)["XYZ".index(axis)]
    segments = arc_segments(radius, 2 * np.pi, chord_error)
    return cylinder(radius, start * direction, stop * direction, segments)


def _solid(body: Manifold, density: float) -> Solid:
    """A boolean's result, which nobody may change: it is shared."""
    vertices, faces = from_manifold(body)
    vertices.flags.writeable = faces.flags.writeable = False
    return Solid(vertices, faces, density)
