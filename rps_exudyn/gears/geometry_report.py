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
from rps_exudyn.gears.geometry_limits import Violation, violations
from rps_exudyn.gears.polyhedron import MassProperties
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.solids import gear_solids
from rps_exudyn.gears.tooth_stiffness import mesh_stiffness_of_pair, stiffness_of_pair
from rps_exudyn.gears.trochoid import form_point
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import GEOMETRY

GOOD_CREST = 0.2  # usual least width of a hardened tooth's crest, in modules


def check_gear(gear: SteeringGear, force: bool = False) -> None:
    """Refuse a gear that cannot exist or cannot run.

    Args:
        gear: the gear.
        force: build undercut gears all the same.

    Raises:
        InputError: one sentence per limit: quantity, value, limit, nearest admissible parameter value.
    """
    _forgiven(gear, force)


def _forgiven(gear: SteeringGear, force: bool) -> list[Violation]:
    """The limits that the gear does not keep and need not; raises as `check_gear` for the others."""
    found = violations(gear, force)
    if refused := [item for item in found if not (force and item.forgivable)]:
        raise InputError([item.sentence(gear) for item in refused])
    return found


class PartMasses(Mapping[str, MassProperties]):
    """Mass properties of the gear's parts, each in its own frame; solids are made when asked for."""

    def __init__(self, gear: SteeringGear) -> None:
        self._gear = gear

    @cached_property
    def _parts(self) -> dict[str, MassProperties]:
        return {name: solid.mass_properties for name, solid in gear_solids(self._gear).items()}

    def __getitem__(self, part: str) -> MassProperties:
        return self._parts[part]

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)


@dataclass(frozen=True)
class GeometryReport:
    """The gear's geometry in numbers; SI units, definitions in `quantities.GEOMETRY`."""

    reference_diameter: float
    base_diameter: float
    form_diameter: float
    root_diameter: float
    tip_diameter: float
    pointed_diameter: float
    crest_width: float
    travel_per_turn: float
    shaft_angle: float
    transverse_contact_ratio: float
    overlap_ratio: float
    total_contact_ratio: float
    contact_start: float
    contact_end: float
    undercut_limit: float
    undercut_margin: float
    pinion_root_clearance: float
    rack_root_clearance: float
    interference: float
    rack_face_width: float
    rack_tip_face_width: float
    toothed_length: float
    single_stiffness: float
    mesh_stiffness: float
    mass_properties: PartMasses
    warnings: tuple[str, ...]

    @property
    def numbers(self) -> dict[str, float]:
        """Numbers of the report by the names of `quantities.GEOMETRY`."""
        return {name: getattr(self, name) for name in GEOMETRY}

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
        return {**self.numbers, "mass_properties": masses, "warnings": list(self.warnings)}


def geometry_report(gear: SteeringGear, force: bool = False) -> GeometryReport:
    """The report of an admissible gear.

    Raises:
        InputError: the gear cannot be built, see `check_gear`.
    """
    forgiven = _forgiven(gear, force)
    pair, bar = GearPair.of(gear), RackBar.of(gear)
    start, end = limits.path_on_involute(pair)
    transverse = limits.transverse_contact_ratio(pair)
    limit = undercut_limit(pair)
    pitch_line = -pair.profile_shift * pair.module - pair.reference_height  # Y in the rack frame
    return GeometryReport(
        reference_diameter=2 * pair.reference_radius,
        base_diameter=2 * pair.base_radius,
        form_diameter=2 * form_point(pair).radius,
        root_diameter=2 * pair.root_radius,
        tip_diameter=2 * pair.tip_radius,
        pointed_diameter=2 * pointed_radius(pair),
        crest_width=crest_width(pair, pair.tip_radius),
        travel_per_turn=2 * np.pi * pair.gain,
        shaft_angle=pair.delta,
        transverse_contact_ratio=transverse,
        overlap_ratio=pair.overlap_ratio,
        total_contact_ratio=transverse + pair.overlap_ratio,
        contact_start=start,
        contact_end=end,
        undercut_limit=limit,
        undercut_margin=pair.profile_shift - limit,
        pinion_root_clearance=limits.pinion_root_clearance(pair),
        rack_root_clearance=limits.rack_root_clearance(pair),
        interference=max(limits.rack_tip_interference(pair), limits.pinion_tip_interference(pair), 0.0),
        rack_face_width=2 * float(bar.flank(0, 1).half_chord(pitch_line)),
        rack_tip_face_width=2 * float(bar.flank(0, 1).half_chord(bar.tip_height)),
        toothed_length=bar.toothed_ends[1] - bar.toothed_ends[0],
        single_stiffness=stiffness_of_pair(pair),
        mesh_stiffness=mesh_stiffness_of_pair(pair),
        mass_properties=PartMasses(gear),
        warnings=(*(f"{item.what}." for item in forgiven), *_warnings(gear, pair, bar)),
    )


def _warnings(gear: SteeringGear, pair: GearPair, bar: RackBar) -> Iterator[str]:
    crest = crest_width(pair, pair.tip_radius)
    if crest < GOOD_CREST * pair.module:
        yield (
            f"The crest is only {crest / pair.module:.2g} modules wide; hardened teeth usually have "
            f"at least {GOOD_CREST:g}."
        )
    chord = 2 * float(bar.flank(0, 1).half_chord(bar.tip_height))
    if chord < pair.face_width:
        total = limits.transverse_contact_ratio(pair) + pair.overlap_ratio * chord / pair.face_width
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
