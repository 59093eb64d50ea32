"""The geometry report: whether a gear can be built, its numbers, and warnings for its designer."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears import geometry_limits as limits
from rps_exudyn.gears.basic_rack import crest_width, pointed_radius, undercut_limit
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.generated_rack import GeneratedRack
from rps_exudyn.gears.geometry_limits import Violation, violations
from rps_exudyn.gears.masses import surface_masses
from rps_exudyn.gears.polyhedron import MassProperties
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import gear_solids
from rps_exudyn.gears.tooth_stiffness import mesh_stiffness_transverse, stiffness_of_pair
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import GEOMETRY, Quantity

ALONG_TRAVEL = 15  # angles of the table of a variable ratio
COURSE_TABLE = {
    "pinion_angle": Quantity("rad", "deg", "pinion angle"),
    "rack_displacement": Quantity("m", "mm", "travel"),
    "travel_per_turn": Quantity("m", "mm", "travel per turn"),
    "pressure_angle": Quantity("rad", "deg", "pressure angle"),
    "tooth_angle": Quantity("rad", "deg", "tooth angle"),
    "contact_ratio": Quantity("", "", "contact ratio"),
    "sliding_at_start": Quantity("m", "mm", "sliding, start"),
    "sliding_at_tip": Quantity("m", "mm", "sliding, tip"),
    "steepness": Quantity("", "", "q_a/Q"),
    "pressure_factor": Quantity("", "", "Hertz pressure"),
}
"""Columns along the travel of a variable ratio. Sliding is the speed over the pinion's, at the start of the
contact and at the pinion's tips; the rack is undercut where q_a/Q reaches 1; the last one is the pressure at
the tips on the side that the rack's curvature sharpens, over that of a plane flank."""
GOOD_CREST = 0.2  # usual least width of a hardened tooth's crest, in modules


def check_gear(gear: SteeringGear, force: bool = False) -> list[Violation]:
    """Refuse a gear that cannot exist or cannot run, but for undercut ones with `force`; return the limits
    that it does not keep and need not.

    Raises:
        InputError: one sentence per limit: quantity, value, limit, nearest admissible parameter value.
    """
    found = violations(gear, force)
    if refused := [item for item in found if not (force and item.forgivable)]:
        raise InputError([item.sentence for item in refused])
    return found


@dataclass(frozen=True, eq=False)
class GeometryReport:
    """The gear's geometry in numbers, which are attributes, too; SI units, definitions in `GEOMETRY`."""

    gear: SteeringGear
    numbers: Mapping[str, float]  # by the names of `quantities.GEOMETRY`
    warnings: tuple[str, ...]

    def __getattr__(self, name: str) -> float:
        if name in GEOMETRY:
            return self.numbers[name]
        raise AttributeError(name)

    @cached_property
    def mass_properties(self) -> dict[str, MassProperties]:
        """Of the gear's parts, each in its own frame; solids are made when asked for."""
        found = {name: solid.mass_properties for name, solid in gear_solids(self.gear).items()}
        surfaces = {part: surface_masses(self.gear, part) for part in ("pinion", "rack")}
        return found | {part: each for part, each in surfaces.items() if each}

    @cached_property
    def along_travel(self) -> dict[str, np.ndarray]:
        """Name -> values from lock to lock of a variable ratio (`COURSE_TABLE`); {} of a constant one."""
        pair = GearPair.of(self.gear)
        if pair.course is None:
            return {}
        rack, mesh = GeneratedRack.of(pair), pair.design_mesh
        first, last = (float(pair.angle_at(side * self.gear.rack.travel / 2)) for side in (-1, 1))
        angle = np.linspace(first, last, ALONG_TRAVEL)
        gain, slope = pair.gain_at(angle), pair.course.slope(angle)
        steepness = mesh.tip_length * np.abs(mesh.bend(gain, slope))
        start = rack.first_contact(angle)
        return {
            "pinion_angle": angle,
            "rack_displacement": pair.travel_at(angle),
            "travel_per_turn": 2 * np.pi * gain,
            "pressure_angle": mesh.pressure_angle(gain),
            "tooth_angle": mesh.tooth_angle(gain),
            "contact_ratio": rack.contact_ratio(angle) + pair.overlap_ratio,
            "sliding_at_start": rack.sliding(angle, start),
            "sliding_at_tip": rack.sliding(angle, mesh.tip_length),
            "steepness": steepness,
            "pressure_factor": 1 / np.sqrt(np.maximum(1 - steepness, 0)),
        }

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain numbers, lists and text (SI)."""
        masses = {
            part: {
                "volume": item.volume,
                "mass": item.mass,
                "centre_of_mass": item.centre_of_mass.tolist(),
                "inertia": item.inertia.tolist(),
            }
            for part, item in self.mass_properties.items()
        }
        along = {name: values.tolist() for name, values in self.along_travel.items()}
        course = {"along_travel": along} if along else {}
        return {**self.numbers, "mass_properties": masses, **course, "warnings": list(self.warnings)}


def geometry_report(gear: SteeringGear, force: bool = False) -> GeometryReport:
    """The report of an admissible gear.

    Raises:
        InputError: the gear cannot be built, see `check_gear`.
    """
    forgiven = check_gear(gear, force)
    bar = RackBar.of(gear)
    pair, toothed = bar.pair, bar.toothed_ends
    start, end = limits.path_on_involute(pair)
    transverse, limit = limits.transverse_contact_ratio(pair), undercut_limit(pair)
    single = stiffness_of_pair(pair)
    pitch_line = -pair.profile_shift * pair.module - pair.reference_height  # Y in the rack frame
    heights = np.array([pitch_line, bar.tip_height])
    face_width, tip_face_width = (2 * bar.flank(0, 1).half_chord(heights)).tolist()
    numbers = {
        "reference_diameter": 2 * pair.reference_radius,
        "base_diameter": 2 * pair.base_radius,
        "form_diameter": 2 * form_point(pair).radius,
        "root_diameter": 2 * pair.root_radius,
        "tip_diameter": 2 * pair.tip_radius,
        "pointed_diameter": 2 * pointed_radius(pair),
        "crest_width": crest_width(pair, pair.tip_radius),
        "travel_per_turn": 2 * np.pi * pair.gain,
        "shaft_angle": pair.delta,
        "transverse_contact_ratio": transverse,
        "overlap_ratio": pair.overlap_ratio,
        "total_contact_ratio": transverse + pair.overlap_ratio,
        "contact_start": start,
        "contact_end": end,
        "undercut_limit": limit,
        "undercut_margin": pair.profile_shift - limit,
        "pinion_root_clearance": limits.pinion_root_clearance(pair),
        "rack_root_clearance": limits.rack_root_clearance(pair),
        "interference": max(limits.rack_tip_interference(pair), limits.pinion_tip_interference(pair), 0.0),
        "rack_face_width": face_width,
        "rack_tip_face_width": tip_face_width,
        "toothed_length": toothed[1] - toothed[0],
        "single_stiffness": single,
        "mesh_stiffness": mesh_stiffness_transverse(single, transverse),
    }
    own = (f"{item.what}." for item in forgiven)
    return GeometryReport(gear, numbers, (*own, *_warnings(gear, bar, numbers)))


def _warnings(gear: SteeringGear, bar: RackBar, numbers: Mapping[str, float]) -> Iterator[str]:
    pair = bar.pair
    crest, chord = numbers["crest_width"], numbers["rack_tip_face_width"]
    if crest < GOOD_CREST * pair.module:
        yield (
            f"The crest is only {crest / pair.module:.2g} modules wide; hardened teeth usually have "
            f"at least {GOOD_CREST:g}."
        )
    if chord < pair.face_width:
        total = numbers["transverse_contact_ratio"] + pair.overlap_ratio * chord / pair.face_width
        yield (
            f"The round bar is narrower at the rack's tips ({chord * 1e3:.3g} mm) than the pinion's face "
            f"({pair.face_width * 1e3:.3g} mm); with that width the total contact ratio is {total:.3g}."
        )
    if gear.pinion.shaft_diameter > 2 * pair.root_radius:
        yield "The pinion's shaft is thicker than the root circle and fills the bottom of the tooth spaces."
    if pair.angle_error != 0:
        yield "The angle error moves the contact from lines across the flanks to their edges."
    if pair.runout > 0 and gear.yoke.clearance < pair.runout:
        yield "The runout exceeds the yoke clearance: the plunger meets the yokenut once per turn."
    if bar.toothed_ends[1] + gear.rack.travel / 2 > gear.bush.distance:
        yield "The rack's teeth enter the bush before the end of the travel."
