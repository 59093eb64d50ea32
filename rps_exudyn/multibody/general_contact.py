"""The teeth in Exudyn's GeneralContact: spheres on the pinion's flanks against triangles on the rack's.

GeneralContact knows no contact of triangles with triangles, so one gear is sampled (`mesh_contact.spheres`).
Exudyn needs, each with a test in tests/upstream:

* drive and coast flanks in contacts of their own, one per tooth space: the implicit solver's active-set
  test compares numbers of contacts only, and a tooth that is out of mesh can be switched off;
* one triangle per rack flank, right-angled and larger than the flank: a sphere that crosses an inner edge
  keeps the old triangle for that step, one that meets an outer edge gets half the force;
* a Jacobian of our own: GeneralContact's misses the rotation of the triangles' body, and differencing the
  whole system sends the bush's 150 coordinates through the contact search.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar, RackFlank
from rps_exudyn.mesh_contact.sampled_contact import SampledContactData, angle_from_mesh, sampled_force
from rps_exudyn.mesh_contact.spheres import FLANK_MARGIN, SIDES, lowest_height
from rps_exudyn.multibody.force_object import add_forces
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_kernel import tangent

if TYPE_CHECKING:
    import exudyn

RIGID_SIDE = 1e6  # stiffness of the triangles over that of all spheres: GeneralContact puts both in series


@dataclass
class GeneralContacts:
    """The contacts of one mesh in an Exudyn system: `contacts[space][0 drive, 1 coast]`."""

    contacts: list[list[Any]]
    data: SampledContactData

    def gate(self, angle: float) -> None:
        """Switch off the tooth spaces that are away from the mesh; `angle` about the pinion's axis k."""
        spaces = len(self.contacts)
        for space, row in enumerate(self.contacts):
            near = bool(abs(angle_from_mesh(angle, space, spaces)) <= self.data.gate)
            for contact in row:
                contact.isActive = near

    def force(self) -> np.ndarray:
        """The contacts' latest part of the system's right-hand side, shape (n,)."""
        active = [contact for row in self.contacts for contact in row if contact.isActive]
        return np.sum([contact.GetSystemODE2RhsContactForces(copy=True) for contact in active], axis=0)


def add_general_contacts(
    mbs: "exudyn.MainSystem", gear: SteeringGear, data: SampledContactData, *, pinion: Any, rack: Any
) -> GeneralContacts:
    """Add spheres on the pinion body and triangles on the rack body, one contact per flank."""
    from exudyn.itemInterface import MarkerBodyRigid

    bar = RackBar.of(gear)
    rack_marker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=rack, localPosition=[0, 0, 0]))
    contacts = [[_new_contact(mbs, data, bar.pair) for _ in SIDES] for _ in data.centres]
    for space, row in enumerate(contacts):
        for flank, contact in enumerate(row):
            for centre, stiffness in zip(
                data.centres[space, flank], data.stiffness[space, flank], strict=True
            ):
                contact.AddSphereWithMarker(
                    markerIndex=mbs.AddMarker(MarkerBodyRigid(bodyNumber=pinion, localPosition=centre)),
                    radius=data.radius,
                    contactStiffness=stiffness,
                    contactDamping=stiffness * data.damping,
                    frictionMaterialIndex=0,
                )
            for tooth in bar.teeth:
                contact.AddTrianglesRigidBodyBased(
                    rigidBodyMarkerIndex=rack_marker,
                    contactStiffness=RIGID_SIDE * float(data.stiffness.sum()),
                    contactDamping=0.0,
                    frictionMaterialIndex=0,
                    pointList=flank_triangle(bar, bar.flank(tooth, SIDES[flank])),
                    triangleList=[[0, 1, 2]],
                )
    return GeneralContacts(contacts, data)


def _new_contact(mbs: "exudyn.MainSystem", data: SampledContactData, pair: GearPair) -> Any:
    contact = mbs.AddGeneralContact()
    contact.verboseMode = 0
    contact.frictionProportionalZone = data.zone
    contact.sphereSphereContact = False
    contact.keepContactWhilePenetrating = True  # one law in all solvers; where it is damped, spheres can pull
    contact.computeContactForces = True  # kept, for comparison with `sampled_contact`
    contact.SetFrictionPairings(data.friction * np.eye(1))
    reach, half = pair.tip_radius + 2e-3, pair.face_width / 2 + 4e-3
    contact.SetSearchTreeBox(pMin=[-reach, -reach, -half], pMax=[reach, reach, half])
    contact.SetSearchTreeCellSize(numberOfCells=[10, 10, 10])
    return contact


def flank_triangle(bar: RackBar, flank: RackFlank) -> np.ndarray:
    """A right-angled triangle over one flank, rack frame, counter-clockwise from outside, shape (3, 3).

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


def add_tangent(mbs: "exudyn.MainSystem", data: SampledContactData, nodes: list[Any]) -> None:
    """Add the contact's Jacobian, a massless object without forces; `nodes`: pinion, rack.

    It comes from the compiled samples. GeneralContact itself contributes none: without contact between
    spheres its own derivative is exactly zero (tests/upstream pins this).
    """
    add_forces(mbs, nodes, no_force, data, 7, tangent(sampled_force))


def no_force(q: np.ndarray, v: np.ndarray, data: SampledContactData) -> np.ndarray:
    """The force law of the object that only carries the Jacobian."""
    return np.zeros(7)
