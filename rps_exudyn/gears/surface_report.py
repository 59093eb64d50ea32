"""Surfaces of a gear beside its drawing: what the meshes show, what the parameters state."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import mm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.mesh_file import Surface, surface_in
from rps_exudyn.gears.mesh_frames import PinionPlacement, Placement, RackPlacement, place_pinion, place_rack
from rps_exudyn.gears.rack_bar import RackBar, pinion_reach
from rps_exudyn.parameters.gear import FLANK_DEVIATIONS, SteeringGear, surfaces_of
from rps_exudyn.parameters.named_file import named_content

ANGLE, LENGTH = np.deg2rad(0.02), 2e-6  # accuracy of frames and of what is measured in them [rad], [m]
HANDS = {-1: "right", 0: "none", 1: "left"}  # by the sense of the twist, or of a rack's tooth angle
SHOWN = {"mm": 1e3, "deg": 180 / np.pi, "": 1}


@dataclass(frozen=True)
class Comparison:
    """One quantity of a part; values are SI."""

    part: str
    name: str
    unit: str  # in which it is shown, or "" of a count
    drawing: float
    mesh: float
    lever: float = 1.0  # displacement of flanks by a difference of 1

    @property
    def differs(self) -> bool:
        """Whether the difference displaces flanks by more than the accuracy."""
        return bool(abs(self.lever * (self.mesh - self.drawing)) > LENGTH)

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Return them as text, with a mark at a difference."""
        drawing, mesh = (
            HANDS[int(each)] if self.name == "hand" else f"{each * SHOWN[self.unit]:.6g} {self.unit}".rstrip()
            for each in (self.drawing, self.mesh)
        )
        return f"{self.part}: {self.name}", drawing, mesh, "differs" if self.differs else ""


def placed_surfaces(gear: SteeringGear) -> dict[str, tuple[Surface, Placement]]:
    """Return part -> surface and its place in the part's frame, of the parts that have one."""
    texts = {"pinion": gear.pinion.surface, "rack": gear.rack.surface}
    height = gear.rack.reference_height
    return {part: _placed(part, text, height) for part, text in texts.items() if text}


@lru_cache(maxsize=4)
def _placed(part: str, text: str, height: float) -> tuple[Surface, Placement]:
    path, content = named_content(text, f"{part}.surface")
    try:
        surface = surface_in(content, path.suffix, part)
        surface.check_normals()
        return surface, place_pinion(surface) if part == "pinion" else place_rack(surface, height)
    except InputError as error:
        raise InputError(f"{part}.surface: {path} {error}.") from None


def compared(gear: SteeringGear) -> Iterator[Comparison]:
    """Yield what the surfaces show beside what the drawing states."""
    pair, bar = GearPair.of(gear), RackBar.of(gear)
    for part, (_, mesh) in placed_surfaces(gear).items():
        rows: list[tuple[str, str, float, float] | tuple[str, str, float, float, float]] = []
        if isinstance(mesh, PinionPlacement):
            hand = _hand(mesh.twist * mesh.face_width)
            rows += [("teeth", "", pair.teeth, mesh.teeth), ("hand", "", np.sign(pair.beta_p), hand)]
            if hand and pair.beta_p:
                lead, measured = (2 * np.pi / abs(each) for each in (pair.twist, mesh.twist))
                lever = 2 * np.pi * pair.face_width * pair.tip_radius / lead**2
                rows.append(("lead", "mm", lead, measured, lever))
            rows.append(("tip diameter", "mm", 2 * pair.tip_radius, mesh.tip_diameter))
            rows.append(("face width", "mm", pair.face_width, mesh.face_width))
        elif isinstance(mesh, RackPlacement):
            drive, coast = mesh.pressure_angles
            rows += [
                ("teeth", "", len(bar.teeth), mesh.teeth),
                ("hand", "", np.sign(pair.beta_r), _hand(mesh.tooth_angle)),
                ("pitch", "mm", pair.rack_pitch, mesh.pitch, mesh.teeth),
                ("tooth angle", "deg", pair.beta_r, mesh.tooth_angle, LENGTH / ANGLE),
                ("pressure angle, drive side", "deg", pair.alpha_n, drive, LENGTH / ANGLE),
                ("pressure angle, coast side", "deg", pair.alpha_n, coast, LENGTH / ANGLE),
                ("addendum", "mm", pair.rack_addendum, mesh.addendum),
            ]
            if mesh.bar_diameter is not None:
                rows.append(("bar diameter", "mm", 2 * pair.bar_radius, mesh.bar_diameter))
                rows.append(("reference height", "mm", pair.reference_height, mesh.reference_height))
        for row in rows:
            yield Comparison(part, *row)


def _hand(angle: float) -> int:
    """Sense of an angle, 0 within the accuracy."""
    return int(np.sign(angle)) if abs(angle) > ANGLE else 0


def contradictions(gear: SteeringGear) -> Iterator[str]:
    """Yield why surfaces cannot stand for the gear's parts, in sentences."""
    angles = {"pinion": "pinion.helix_angle", "rack": "rack.tooth_angle"}
    for each in compared(gear):
        name, drawing, mesh, _ = each.cells
        if each.differs and name == "pinion: teeth":
            yield f"pinion.surface has {mesh} teeth; pinion.teeth is {drawing}."
        if each.differs and each.name == "hand":
            yield (
                f"The hand of {each.part}.surface is {mesh} and that of the drawing {drawing}: the file is "
                f"mirrored, or {angles[each.part]} has the wrong sign."
            )
    for given in surfaces_of(gear):
        part = given.partition(".")[0]
        if own := [path for path in FLANK_DEVIATIONS if path.startswith(part) and gear.value_at(path)]:
            yield f"{own[0]} is given, but {given} has a form of its own: leave out one of them."
    for _, rack in placed_surfaces(gear).values():
        if isinstance(rack, RackPlacement):
            travel = 2 * ((rack.teeth - 1) // 2 * rack.pitch - pinion_reach(GearPair.of(gear)))
            if travel < gear.rack.travel - LENGTH:
                yield (
                    f"rack.surface has {rack.teeth} teeth, for a travel of {mm(max(travel, 0.0), 4)}; "
                    f"rack.travel is {mm(gear.rack.travel)}."
                )
