"""The gear's parts as solids of one material each: what the model weighs and what a picture shows.

Frames: pinion in the pinion frame, its axis of rotation on z; rack in the rack frame; plunger and yokenut
in a frame with axes parallel to the housing's and its origin on the bar's axis at the pitch point, at rest;
a bush segment around its own centre, axis X.
"""

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
    pair = GearPair.of(gear)
    teeth = pinion_mesh(pair, chord_error, FlankForm.of(gear))
    half = gear.pinion.shaft_length / 2
    shaft = _round_bar("Z", gear.pinion.shaft_diameter / 2, -half, half, chord_error)
    joined = to_manifold(teeth.vertices + pair.eccentricity, teeth.faces) + shaft
    return Solid(*from_manifold(joined), gear.pinion.density)


def rack_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Bar with teeth."""
    return Solid(*RackBar.of(gear).mesh(chord_error), gear.rack.density)


def plunger_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Round plunger with a cylindrical seat for the back of the bar; its density gives the declared mass.

    The seat spans +-seat_angle about +Y and seat_length along the rack; outside it the front is relieved.
    """
    yoke, bar = gear.yoke, gear.rack.bar_diameter / 2
    front, back = plunger_ends(gear)
    plunger = _round_bar("Y", yoke.plunger_diameter / 2, front, back, chord_error)
    plunger -= _round_bar("X", bar, -yoke.plunger_diameter, yoke.plunger_diameter, chord_error)
    for end in (-1, 1):
        start, stop = end * yoke.seat_length / 2, end * yoke.plunger_diameter
        plunger -= _round_bar("X", bar + SEAT_RELIEF, start, stop, chord_error)
    vertices, faces = from_manifold(plunger)
    volume = Solid(vertices, faces, 1.0).mass_properties.volume
    return Solid(vertices, faces, yoke.plunger_mass / volume)


def yokenut_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """Disc behind the plunger, the yoke clearance away from it."""
    yoke = gear.yoke
    start = plunger_ends(gear)[1] + yoke.clearance
    nut = _round_bar("Y", yoke.nut_diameter / 2, start, start + yoke.nut_thickness, chord_error)
    return Solid(*from_manifold(nut), STEEL)


def bush_segment_solid(gear: SteeringGear, chord_error: float = CHORD_ERROR) -> Solid:
    """One of the equal hollow cylinders that the bush is divided into."""
    bush = gear.bush
    half = bush.length / bush.segments / 2
    tube = _round_bar("X", bush.outer_diameter / 2, -half, half, chord_error)
    tube -= _round_bar("X", bush.inner_diameter / 2, -bush.length, bush.length, chord_error)
    return Solid(*from_manifold(tube), bush.density)


def plunger_ends(gear: SteeringGear) -> tuple[float, float]:
    """Y of the plunger's front, at the seat's edges, and of its back, above the bar's axis [m]."""
    front = gear.rack.bar_diameter / 2 * float(np.cos(gear.yoke.seat_angle))
    return front, front + gear.yoke.plunger_length


def _round_bar(axis: str, radius: float, start: float, stop: float, chord_error: float) -> Manifold:
    """A cylinder about one of the axes."""
    direction = np.eye(3)["XYZ".index(axis)]
    segments = arc_segments(radius, 2 * np.pi, chord_error)
    return cylinder(radius, start * direction, stop * direction, segments)
