"""Surfaces of a gear beside its drawing: what the meshes show, what the parameters state.

A difference is marked from the accuracy of the frames on (`ANGLE`, `LENGTH`), as displacement of flanks.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.units import mm
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.mesh_file import Surface, read_surface
from rps_exudyn.gears.mesh_frames import PinionPlacement, Placement, RackPlacement, place_pinion, place_rack
from rps_exudyn.gears.rack_bar import RackBar, pinion_reach
from rps_exudyn.gears.solids import gear_solids
from rps_exudyn.parameters.gear import SteeringGear

ANGLE, LENGTH = np.deg2rad(0.02), 2e-6  # accuracy of frames and of what is measured in them [rad], [m]
HANDS = {-1: "right", 0: "none", 1: "left"}  # by the sense of the twist, or of a rack's tooth angle
SHOWN = {"mm": 1e3, "deg": 180 / np.pi, "g": 1e3, "": 1}


@dataclass(frozen=True)
class Comparison:
    """One quantity of a part.

    Attributes:
        part, name: of the quantity.
        unit: in which it is shown, or "" of a count.
        drawing, mesh: values, SI; None where a surface does not show it.
        differs: whether the difference is larger than the accuracy.
    """

    part: str
    name: str
    unit: str
    drawing: float
    mesh: float | None
    differs: bool

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Return them as text, with a mark at a difference."""
        drawing, mesh = map(self._shown, (self.drawing, self.mesh))
        return f"{self.part}: {self.name}", drawing, mesh, "differs" if self.differs else ""

    def _shown(self, value: float | None) -> str:
        if value is None:
            return "not shown"
        if self.name == "hand":
            return HANDS[int(value)]
        return f"{value * SHOWN[self.unit]:.6g} {self.unit}".rstrip()


def placed_surfaces(gear: SteeringGear) -> dict[str, tuple[Surface, Placement]]:
    """Return part -> surface and its place in the part's frame, of the parts that have one.

    Raises:
        InputError: a file that cannot be used, or shows no such part.
    """
    placed: dict[str, tuple[Surface, Placement]] = {}
    for part in ("pinion", "rack"):
        if text := getattr(gear, part).surface:
            surface = read_surface(text, part)
            try:
                placement = (
                    place_pinion(surface)
                    if part == "pinion"
                    else place_rack(surface, gear.rack.reference_height)
                )
            except InputError as error:
                raise InputError(f"{part}.surface: {text.rpartition(' sha256:')[0]} {error}.") from None
            placed[part] = surface, placement
    return placed


def compared(gear: SteeringGear) -> Iterator[Comparison]:
    """Yield what the surfaces show beside what the drawing states.

    Raises:
        InputError: as of `placed_surfaces`.
    """
    for part, (surface, placement) in placed_surfaces(gear).items():
        rows = _of_pinion if isinstance(placement, PinionPlacement) else _of_rack
        for name, unit, drawing, mesh, displacement in rows(gear, placement):  # type: ignore[arg-type]
            yield Comparison(part, name, unit, drawing, mesh, bool(abs(displacement) > LENGTH))
        solid = gear_solids(gear)[part].mass_properties
        mass = solid.mass / solid.volume * surface.volume * placement.scale**3 if surface.is_closed else None
        area = surface.areas.sum() * placement.scale**2
        yield Comparison(
            part, "mass", "g", solid.mass, mass,
            mass is not None and bool(abs(mass / solid.mass - 1) * solid.volume > LENGTH * area),
        )  # fmt: skip


Row = tuple[str, str, float, float | None, float]
"""Name, unit, drawing, mesh, displacement of flanks by the difference [m]."""


def _of_pinion(gear: SteeringGear, mesh: PinionPlacement) -> Iterator[Row]:
    pair, hand = GearPair.of(gear), _hand(mesh.twist * mesh.face_width)
    yield "teeth", "", pair.teeth, mesh.teeth, mesh.teeth - pair.teeth
    yield "hand", "", np.sign(pair.beta_p), hand, hand - np.sign(pair.beta_p)
    turn = (abs(mesh.twist) - abs(pair.twist)) * pair.face_width
    if hand and pair.beta_p:
        drawing, measured = (2 * np.pi / abs(each) for each in (pair.twist, mesh.twist))
        yield "lead", "mm", drawing, measured, turn * pair.tip_radius
    yield (
        "tip diameter",
        "mm",
        2 * pair.tip_radius,
        mesh.tip_diameter,
        mesh.tip_diameter - 2 * pair.tip_radius,
    )
    yield "face width", "mm", pair.face_width, mesh.face_width, mesh.face_width - pair.face_width


def _of_rack(gear: SteeringGear, mesh: RackPlacement) -> Iterator[Row]:
    pair, bar = GearPair.of(gear), RackBar.of(gear)
    yield "teeth", "", len(bar.teeth), mesh.teeth, mesh.teeth - len(bar.teeth)
    yield (
        "hand",
        "",
        np.sign(pair.beta_r),
        _hand(mesh.tooth_angle),
        _hand(mesh.tooth_angle) - np.sign(pair.beta_r),
    )
    yield "pitch", "mm", pair.rack_pitch, mesh.pitch, (mesh.pitch - pair.rack_pitch) * mesh.teeth
    angles = {"tooth angle": (pair.beta_r, mesh.tooth_angle)}
    sides = ("pressure angle, drive side", "pressure angle, coast side")
    angles |= {name: (pair.alpha_n, each) for name, each in zip(sides, mesh.pressure_angles, strict=True)}
    for name, (drawing, measured) in angles.items():
        yield name, "deg", drawing, measured, (measured - drawing) * LENGTH / ANGLE
    yield "addendum", "mm", pair.rack_addendum, mesh.addendum, mesh.addendum - pair.rack_addendum
    shown = mesh.bar_diameter is not None
    for name, drawing, value in (
        ("bar diameter", 2 * pair.bar_radius, mesh.bar_diameter or 0.0),
        ("reference height", pair.reference_height, mesh.reference_height),
    ):
        yield name, "mm", drawing, value if shown else None, shown * (value - drawing)


def _hand(angle: float) -> int:
    """Sense of an angle, 0 within the accuracy."""
    return int(np.sign(angle)) if abs(angle) > ANGLE else 0


def contradictions(gear: SteeringGear) -> Iterator[str]:
    """Yield why surfaces cannot stand for the gear's parts, in sentences.

    Raises:
        InputError: as of `placed_surfaces`.
    """
    for each in compared(gear):
        name, drawing, mesh, _ = each.cells
        if each.differs and name == "pinion: teeth":
            yield f"pinion.surface has {mesh} teeth; pinion.teeth is {drawing}."
        if each.differs and each.name == "hand":
            angle = {"pinion": "pinion.helix_angle", "rack": "rack.tooth_angle"}[each.part]
            yield (
                f"The hand of {each.part}.surface is {mesh} and that of the drawing {drawing}: the file is "
                f"mirrored, or {angle} has the wrong sign."
            )
    for _, placement in placed_surfaces(gear).values():
        if isinstance(placement, RackPlacement):
            reach = (placement.teeth - 1) // 2 * placement.pitch - pinion_reach(GearPair.of(gear))
            if 2 * reach < gear.rack.travel - LENGTH:
                yield (
                    f"rack.surface has {placement.teeth} teeth, for a travel of {mm(max(2 * reach, 0.0), 4)};"
                    f" rack.travel is {mm(gear.rack.travel)}."
                )
