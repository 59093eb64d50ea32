"""The teeth in Exudyn's GeneralContact: spheres on the pinion's flanks against triangles on the rack's.

GeneralContact has no contact of triangles with triangles, so one gear is sampled (`tooth_contact.spheres`).
Exudyn needs, each with a test in tests/upstream:

* drive and coast flanks in contacts of their own, one for each few degrees by which the pinion turns: the
  implicit solver's active-set test compares numbers of contacts only, and neighbours begin to touch at one
  time and end at another;
* only the spheres that can be reached: the others cost as much as they, active or not;
* one triangle per rack flank, right-angled and larger than the flank: a sphere that crosses an inner edge
  keeps the old triangle for that step, one that meets an outer edge gets half the force;
* a Jacobian of our own: GeneralContact's misses the rotation of the triangles' body, and differencing the
  whole system sends the bush's 150 coordinates through the contact search.
"""

from dataclasses import dataclass
from math import ceil, floor
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar, RackFlank
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData
from rps_exudyn.tooth_contact.spheres import FLANK_MARGIN, SIDES, gate_angle, lowest_height

CELLS = [2, 2, 2]  # of the search tree of one contact, which has a few dozen spheres
RIGID_SIDE = 1e6  # stiffness of the triangles over that of all spheres: GeneralContact puts both in series


@dataclass
class SphereBlock:
    """One contact: places for a group's spheres of one flank side, and for the rack's teeth near the mesh."""

    contact: Any
    side: int  # 0 drive, 1 coast
    markers: list[Any]  # of the spheres
    group: int | None = None  # whose spheres stand there, counted on over the turns


@dataclass
class GeneralContacts:
    """The contacts of one mesh in an Exudyn system; they hold what the pinion can touch at its angle.

    Spheres and triangles are moved on as the pinion turns: what is out of reach would cost as much in
    GeneralContact as what touches.
    """

    blocks: list[SphereBlock]  # two for each group that can be touched at a time: drive, coast
    data: SampledContactData
    bar: RackBar
    reach: float  # angle from the mesh within which a group must be held [rad]
    tooth: int | None = None  # of the rack, in the middle of those held

    def hold(self, mbs: exu.MainSystem, angle: float) -> None:
        """Hold what can be touched while the pinion stands at an angle about k [rad], or a step from it."""
        self._move_teeth(angle)
        groups, at_once = len(self.data.centres), len(self.blocks) // 2
        width = 2 * np.pi / groups
        first, last = ceil((-self.reach - angle) / width), floor((self.reach - angle) / width)
        for group in range(first, min(last, first + at_once - 1) + 1):
            for side in range(2):
                block = self.blocks[2 * (group % at_once) + side]
                if block.group != group:
                    self._fill(mbs, block, group)

    def update(self, mbs: exu.MainSystem, coordinates: np.ndarray) -> None:
        """Find what touches at all coordinates of the system, from which a step begins to iterate.

        GeneralContact would begin with what touched at the last step's end, under numbers that may stand for
        other spheres and triangles now, and need twice as many iterations.
        """
        here = np.array(mbs.systemData.GetODE2Coordinates())
        mbs.systemData.SetODE2Coordinates(coordinates)  # type: ignore[arg-type]
        for block in self.blocks:
            block.contact.UpdateContacts(mbs)
        mbs.systemData.SetODE2Coordinates(here)  # type: ignore[arg-type]

    def _fill(self, mbs: exu.MainSystem, block: SphereBlock, group: int) -> None:
        """Put a group's spheres in the place of those that stand there, which are out of reach."""
        place = group % len(self.data.centres), block.side
        centres, stiffness = self.data.centres[place], self.data.stiffness[place]
        for number, (marker, centre, k) in enumerate(zip(block.markers, centres, stiffness, strict=True)):
            mbs.SetMarkerParameter(marker, "localPosition", centre)
            block.contact.SetSphereMarkerBased(
                number, contactStiffness=k, contactDamping=k * self.data.damping
            )
        block.group = group

    def _move_teeth(self, angle: float) -> None:
        """Put the triangles on the teeth nearest the pinion."""
        tooth = round(self.bar.pair.gain * angle / self.bar.pair.rack_pitch)
        if tooth == self.tooth:
            return
        self.tooth = tooth
        for block in self.blocks:
            for number, corners in enumerate(_triangles(self.bar, tooth, block.side)):
                block.contact.SetTriangleRigidBodyBased(number, corners)

    def force(self) -> np.ndarray:
        """The contacts' latest part of the system's right-hand side, shape (n,)."""
        parts = [block.contact.GetSystemODE2RhsContactForces(copy=True) for block in self.blocks]
        return np.sum(parts, axis=0)


def add_general_contacts(
    mbs: exu.MainSystem,
    gear: SteeringGear,
    data: SampledContactData,
    *,
    pinion: Any,
    rack: Any,
    angle: float,
    step: float,
) -> GeneralContacts:
    """Add spheres on the pinion body and triangles on the rack body, held for a pinion's angle about k.

    `step` is the largest angle by which the pinion turns in a time step [rad].
    """
    bar, (groups, sides, count) = RackBar.of(gear), data.stiffness.shape
    rack_marker = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=rack, localPosition=[0, 0, 0]))
    reach = data.gate + step
    contacts = GeneralContacts([], data, bar, reach)
    at_once = min(groups, floor(reach * groups / np.pi) + 1)
    triangles = [_triangles(bar, 0, side) for side in range(sides)]
    for side in list(range(sides)) * at_once:
        contact = _new_contact(mbs, data, bar.pair)
        on_pinion = [items.MarkerBodyRigid(bodyNumber=pinion, localPosition=[0, 0, 0]) for _ in range(count)]
        block = SphereBlock(contact, side, [mbs.AddMarker(each) for each in on_pinion])
        for marker in block.markers:
            contact.AddSphereWithMarker(
                markerIndex=marker,
                radius=data.radius,
                contactStiffness=1.0,  # any: the group's spheres bring their own
                contactDamping=0.0,
                frictionMaterialIndex=0,
            )
        contact.AddTrianglesRigidBodyBased(
            rigidBodyMarkerIndex=rack_marker,
            contactStiffness=RIGID_SIDE * float(data.stiffness.sum()),
            contactDamping=0.0,
            frictionMaterialIndex=0,
            pointList=np.concatenate(triangles[side]),
            triangleList=np.arange(3 * len(triangles[side])).reshape(-1, 3),
        )
        contacts.blocks.append(block)
    contacts.hold(mbs, angle)
    return contacts


def _triangles(bar: RackBar, tooth: int, side: int) -> np.ndarray:
    """Triangles over the flanks of a side, 0 or 1, that can touch about the nearest tooth (m, 3, 3)."""
    either_way = ceil(gate_angle(bar.pair) * bar.pair.teeth / (2 * np.pi))
    places = bar.pair.rack_pitch * np.arange(tooth - either_way, tooth + either_way + 1)
    first = flank_triangle(bar, bar.flank(0, SIDES[side]))
    return first + np.multiply.outer(places, [[1.0, 0.0, 0.0]])


def _new_contact(mbs: exu.MainSystem, data: SampledContactData, pair: GearPair) -> Any:
    contact = mbs.AddGeneralContact()
    contact.verboseMode = 0
    contact.frictionProportionalZone = data.zone
    contact.sphereSphereContact = False
    contact.keepContactWhilePenetrating = True  # one law in all solvers; where it is damped, spheres can pull
    contact.computeContactForces = True  # kept, for comparison with `sampled_contact`
    contact.SetFrictionPairings(data.friction * np.eye(1))
    reach, half = pair.tip_radius + 2e-3, pair.face_width / 2 + 4e-3
    contact.SetSearchTreeBox(pMin=[-reach, -reach, -half], pMax=[reach, reach, half])
    contact.SetSearchTreeCellSize(numberOfCells=CELLS)
    return contact


def flank_triangle(bar: RackBar, flank: RackFlank) -> np.ndarray:
    """Return a right-angled triangle over one flank, counter-clockwise from outside, rack frame, (3, 3).

    Its legs follow the trace and the height; it starts in the air beyond the tooth's tip and ends inside
    the bar, so that only the samples decide where the contact ends.
    """
    rise = np.cross(flank.trace, flank.normal)
    rise /= rise[1]  # one metre of height
    low = lowest_height(bar.pair)
    margin = FLANK_MARGIN * bar.pair.module
    half_width = bar.pair.bar_radius + margin
    corner = flank.point + (low - flank.point[1]) * rise - half_width * flank.trace
    along = corner + 4 * half_width * flank.trace
    up = corner + 2 * (bar.root_height + margin - low) * rise
    outward = np.cross(along - corner, up - corner) @ flank.normal > 0
    return np.array([corner, along, up] if outward else [corner, up, along])
