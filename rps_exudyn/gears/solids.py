"""The gear's parts as solids of one material each: what the model weighs and what a picture shows.

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
    """Round plunger with a cylindrical seat for the back of the bar; its density gives the declared mass.

    The seat spans +-seat_angle about +Y and seat_length along the rack; outside it the front is relieved.
    """
    yoke = gear.yoke
    seat = gear.rack.bar_diameter / 2, yoke.seat_length
    return _plunger(plunger_ends(gear), yoke.plunger_diameter, *seat, yoke.plunger_mass, chord_error)


@_kept
def _plunger(
    ends: tuple[float, float], diameter: float, bar: float, length: float, mass: float, chord_error: float
) -> Solid:
    plunger = _round_bar("Y", diameter / 2, *ends, chord_error)
    plunger -= _round_bar("X", bar, -diameter, diameter, chord_error)
    for side in (-1, 1):
        plunger -= _round_bar("X", bar + SEAT_RELIEF, side * length / 2, side * diameter, chord_error)
    unit = _solid(plunger, 1.0)
    return replace(unit, density=mass / unit.mass_properties.volume)


def yokenut_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Disc behind the plunger, the yoke clearance away from it."""
    yoke = gear.yoke
    start = plunger_ends(gear)[1] + yoke.clearance
    return _disc(yoke.nut_diameter / 2, start, start + yoke.nut_thickness, chord_error)


@_kept
def _disc(radius: float, start: float, stop: float, chord_error: float) -> Solid:
    return _solid(_round_bar("Y", radius, start, stop, chord_error), STEEL)


def bush_segment_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """One of the equal hollow cylinders that the bush is divided into."""
    bush = gear.bush
    half = bush.length / bush.segments / 2
    radii = bush.outer_diameter / 2, bush.inner_diameter / 2
    return _tube(*radii, half, bush.length, bush.density, chord_error)


@_kept
def _tube(
    outer: float, inner: float, half: float, beyond: float, density: float, chord_error: float
) -> Solid:
    tube = _round_bar("X", outer, -half, half, chord_error)
    tube -= _round_bar("X", inner, -beyond, beyond, chord_error)
    return _solid(tube, density)


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
