"""Masses and moments of inertia of the moving parts, by integrals over the exact shapes.

Pinion: the transverse section turns along the axis and keeps its shape but for the crowning, so that a few
sections along the face width give the volume's integrals. The section's boundary is a polygon of chords
within `CHORD_ERROR`.

Rack: the bar less what the cutter takes away. At height Y the cutter leaves intervals (a, b) of X at Z = 0,
which the tooth angle shifts by t Z, t = tan beta_r. With half the bar's chord h the integrals over one are

    2 h (b - a),   of X: h (b^2 - a^2),   of X^2: 2/3 h (b^3 - a^3) + 2/3 h^3 t^2 (b - a),
    of Z^2: 2/3 h^3 (b - a),   of X Z: 2/3 h^3 t (b - a)

and those over Y are Gauss's. A closed surface from a file stands for its part.
The solids of `solids` agree with them up to their chords; they take a hundred times as long and are left to
pictures and to booleans.
"""

from functools import lru_cache

import numpy as np
from numpy.polynomial.legendre import leggauss

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.basic_rack import cutter_tip_centre, straight_depth
from rps_exudyn.gears.flank_form import FlankForm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank, crest_profile
from rps_exudyn.gears.mesh_file import Surface
from rps_exudyn.gears.mesh_frames import Placement
from rps_exudyn.gears.polyhedron import MassProperties, Solid
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import pinion_solid, rack_solid
from rps_exudyn.gears.surface_report import placed_surfaces
from rps_exudyn.gears.trochoid import root_profile
from rps_exudyn.parameters.gear import SteeringGear, surfaces_of

CHORD_ERROR = 1e-8  # of the pinion's section [m]
MASS_CHORDS = 5e-6  # of a rack without a closed form; they leave 0.05 % of its mass [m]
_SECTIONS, _HEIGHTS = leggauss(5), leggauss(24)  # over the face width, over a piece of the rack's height
INVOLUTE = 200  # chords of a flank: within 3 nm for modules of some millimetres

_kept = lru_cache(maxsize=8)  # cases of a study share them


def surface_masses(gear: SteeringGear, part: str) -> MassProperties | None:
    """Return mass, centre and inertia of a pinion's or rack's closed surface in the part's frame without
    runout; None of an open one, or where no file gives one.
    """
    if f"{part}.surface" not in surfaces_of(gear):
        return None
    return _of_surface(*placed_surfaces(gear)[part], getattr(gear, part).density)


@_kept
def _of_surface(surface: Surface, placement: Placement, density: float) -> MassProperties | None:
    if not surface.is_closed:
        return None
    corners = placement.place(surface.corners).reshape(-1, 3)
    return Solid(corners, np.arange(len(corners)).reshape(-1, 3), density).mass_properties


# --- the pinion ------------------------------------------------------------------------------------
def pinion_inertia(gear: SteeringGear) -> float:
    """Return the pinion's moment of inertia about its axis of rotation [kg m^2]."""
    pinion = gear.pinion
    if surface := surface_masses(gear, "pinion"):
        x, y = (surface.centre_of_mass + GearPair.of(gear).eccentricity)[:2]
        return float(surface.inertia[2, 2] + surface.mass * (x * x + y * y))
    shaft = pinion.shaft_diameter / 2, pinion.shaft_length
    return pinion.density * _polar_moment(GearPair.of(gear), FlankForm.of(gear), *shaft)


@_kept
def _polar_moment(pair: GearPair, form: FlankForm, shaft: float, length: float) -> float:
    """Integral of the squared distance from the axis over toothed part and shaft [m^5]."""
    x, weight = _SECTIONS
    toothed = sum(
        w * _second_moment(section(pair, form, z), shaft)
        for w, z in zip(weight * pair.face_width / 2, x * pair.face_width / 2, strict=True)
    )
    return float(toothed) + np.pi / 2 * shaft**4 * max(length - pair.face_width, 0.0)


def pinion_on_supports(gear: SteeringGear) -> np.ndarray:
    """Return the mass matrix of the pinion along e, Y and k and about e and Y, of its axis in the middle of
    the mesh (5, 5) [kg, kg m, kg m^2]; that its mass centre turns with a runout is left out."""
    solid = surface_masses(gear, "pinion") or pinion_solid(gear).mass_properties
    m, z = solid.mass, float(solid.centre_of_mass[2])
    mass = np.diag([m, m, m, solid.inertia[0, 0] + m * z * z, solid.inertia[1, 1] + m * z * z])
    mass[0, 4] = mass[4, 0] = m * z
    mass[1, 3] = mass[3, 1] = -m * z
    return mass


def section(pair: GearPair, form: FlankForm, z: float) -> np.ndarray:
    """The section at Z: a closed polygon, counter-clockwise about the axis of rotation, shape (n, 2) [m].

    Raises:
        InputError: the errors of the flanks leave no tooth.
    """
    root, crest = root_profile(pair, CHORD_ERROR)[1:-1], crest_profile(pair, CHORD_ERROR)
    parts = []
    for tooth in range(pair.teeth):
        angle = 2 * np.pi * tooth / pair.teeth - form.twist(pair) * z
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        rising, falling = (_flank(Flank(pair, tooth, side, form), z) for side in (-1, 1))
        across = rising[:, 0] * falling[:, 1] - rising[:, 1] * falling[:, 0]  # at the same length of roll
        if not (across > 0).all():
            raise InputError(
                "The errors and modifications of the pinion's flanks leave no tooth; reduce them."
            )
        parts += [root @ turn, rising, crest @ turn, falling[::-1]]
    return np.concatenate(parts) + pair.eccentricity[:2]


def _flank(flank: Flank, z: float) -> np.ndarray:
    """Points of a flank's section at Z, from form to tip circle, shape (n, 2) [m]."""
    q = np.linspace(flank.form_tangent_length, flank.tip_tangent_length, INVOLUTE + 1)
    return flank.point(flank.generator(q, z), z)[:, :2]


def _second_moment(polygon: np.ndarray, least: float) -> float:
    """Polar moment of a polygon about the origin together with a disc of a radius [m^4]."""
    radius = np.hypot(polygon[:, 0], polygon[:, 1])
    a = polygon * np.maximum(least / radius, 1.0)[:, None]
    b = np.roll(a, -1, axis=0)
    across = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return float(across @ ((a * a).sum(axis=1) + (a * b).sum(axis=1) + (b * b).sum(axis=1)) / 12)


# --- the rack --------------------------------------------------------------------------------------
def rack_masses(gear: SteeringGear) -> MassProperties:
    """Return mass, centre and inertia of the bar with its teeth, rack frame."""
    if surface := surface_masses(gear, "rack"):
        return surface
    bar = RackBar.of(gear)
    first, last = bar.toothed_ends
    if first < bar.x_min or last > bar.x_max:  # the cutter runs out of the bar's end
        return rack_solid(gear).mass_properties
    if bar.pair.course is not None:
        return rack_solid(gear, MASS_CHORDS).mass_properties
    return _rack(bar, gear.rack.density)


@_kept
def _rack(bar: RackBar, density: float) -> MassProperties:
    radius = bar.pair.bar_radius
    length, middle = bar.x_max - bar.x_min, (bar.x_max + bar.x_min) / 2
    area, across = np.pi * radius**2, np.pi / 4 * radius**4 * length
    whole = area * length
    first = np.array([whole * middle, 0.0, 0.0])
    second = np.diag([whole * (middle**2 + length**2 / 12), across, across])
    for heights, weights, half_width in _pieces(bar):
        volume, moments, products = _cut(bar, heights, weights, half_width)
        whole, first, second = whole - volume, first - moments, second - products
    centre = first / whole
    about_centre = second - whole * np.outer(centre, centre)
    inertia = density * (np.trace(about_centre) * np.eye(3) - about_centre)
    centre.flags.writeable = inertia.flags.writeable = False  # gears share them
    return MassProperties(float(whole), float(density * whole), centre, inertia)


def _pieces(bar: RackBar) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Heights Y at which the cutter cuts, their weights, and half the width of the teeth there along X [m].

    Below the tips there is none; then come the straight flanks, and the rounding down to the roots.
    """
    pair = bar.pair
    form_height = -pair.reference_height + straight_depth(pair)
    x, weight = _HEIGHTS
    pieces = []
    for low, high in ((-pair.bar_radius, bar.tip_height), (bar.tip_height, form_height)):
        ends = np.arccos(np.clip(np.array([low, high]) / -pair.bar_radius, -1, 1))
        angle, step = ends.mean() + np.diff(ends) / 2 * x, np.diff(ends) / 2  # Y = -R cos angle
        heights = -pair.bar_radius * np.cos(angle)
        wide = np.pi * pair.module / 4 + (heights + pair.reference_height) * np.tan(pair.alpha_n)
        wide = np.where(heights < bar.tip_height, 0.0, wide)
        pieces.append((heights, weight * step * pair.bar_radius * np.sin(angle), wide / np.cos(pair.beta_r)))
    u, y = cutter_tip_centre(pair)
    eta = pair.alpha_n + (np.pi / 2 - pair.alpha_n) * (1 + x) / 2
    rounded = weight * (np.pi / 2 - pair.alpha_n) / 2 * pair.fillet_radius * np.cos(eta)
    wide = np.pi * pair.module / 2 - u - pair.fillet_radius * np.cos(eta)
    heights = -pair.reference_height - (y - pair.fillet_radius * np.sin(eta))
    pieces.append((heights, rounded, wide / np.cos(pair.beta_r)))
    return pieces


def _cut(
    bar: RackBar, heights: np.ndarray, weights: np.ndarray, half_width: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume, first (3,) and second moments (3, 3) of what the cutter takes at heights of the bar."""
    pair, t = bar.pair, np.tan(bar.pair.beta_r)
    reach = bar.reach
    teeth = len(bar.teeth)
    squares = pair.rack_pitch**2 * sum(j * j for j in bar.teeth)
    h = np.sqrt(np.maximum(pair.bar_radius**2 - heights**2, 0))
    wide = 2 * reach - teeth * 2 * half_width  # sum of b - a; that of b^2 - a^2 is zero by symmetry
    cubes = 2 * reach**3 - 6 * squares * half_width - teeth * 2 * half_width**3
    volumes, sideways = 2 * h * wide, 2 / 3 * h**3 * wide
    along = weights @ (2 / 3 * h * cubes + t**2 * sideways)
    xz, zz = t * (weights @ sideways), weights @ sideways
    first = np.array([0.0, weights @ (volumes * heights), 0.0])
    second = np.array([[along, 0.0, xz], [0.0, weights @ (volumes * heights**2), 0.0], [xz, 0.0, zz]])
    return float(weights @ volumes), first, second
