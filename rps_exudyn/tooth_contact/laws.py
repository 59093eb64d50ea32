"""The laws of the teeth's contact on the coordinates of pinion (1) and rack (6).

All are called alike:

    law(q, v, mesh, pool, work, factor_q, factor_v, out, tangent)

with coordinates and rates (7,), the record `MESH`, the pool that spheres stand in, a record `SCRATCH`. They
fill `out` (15,), forces, energy terms and `wrench.MESH_OUTPUTS`, and add factor_q dF/dq + factor_v dF/dv to
`tangent` (7, 7), to a few per cent of its largest entry or better, unless both factors are 0.
"""

from rps_exudyn.base.compiled import MATRIX, NUMBER, VECTOR, Array, entry, inline, record_type
from rps_exudyn.forces.friction import PATCH_SUMS, STATE_SIZE
from rps_exudyn.forces.rigid_motion import fill_rotation, minus, spin_of, turn_of, vector
from rps_exudyn.tooth_contact.contact_tangent import add_on_coordinates, pinion_axis
from rps_exudyn.tooth_contact.elastic_teeth import teeth_contact
from rps_exudyn.tooth_contact.flank_contact import line_contact
from rps_exudyn.tooth_contact.flank_data import FLANK
from rps_exudyn.tooth_contact.flank_line import SUMS
from rps_exudyn.tooth_contact.flank_strip import STRIP_SHAPE
from rps_exudyn.tooth_contact.mesh_contact import TRIANGLES, mesh_contact
from rps_exudyn.tooth_contact.sampled_contact import SPHERES, sphere_contact
from rps_exudyn.tooth_contact.strip_limits import BREAKS, LIMITS
from rps_exudyn.tooth_contact.teeth_data import TEETH
from rps_exudyn.tooth_contact.wrench import WRENCH_SIZE, on_coordinates

KINDS = {"line": 0, "teeth": 1, "spheres": 2, "triangles": 3}
"""Law of the teeth's contact -> its number in the record `MESH`."""

BY_LINE, BY_TEETH, BY_SPHERES = KINDS["line"], KINDS["teeth"], KINDS["spheres"]

MESH = record_type(
    [
        ("kind", "i8"),  # of the law
        ("flank", FLANK),
        ("teeth", TEETH),
        ("most_lines", "i8"),  # that law "teeth" has room for ...
        ("room", "i8"),  # ... from this place of the pool to its end
        ("spheres", SPHERES),
        ("triangles", TRIANGLES),
    ]
)
"""Constants of the laws; those of laws that are not used are zero."""


# --- Work space of the contact of the teeth: one record, which no evaluation needs to allocate

SCRATCH = record_type(
    [
        ("memory", "f8", (2, STATE_SIZE)),  # state of the bristle friction, see `forces.friction`
        ("rubbed", "f8", (PATCH_SUMS,)),  # sums over a patch of it
        # of each side, over the rack's motion: changes of its directions with the loads, of weight and slip
        ("by_direction", "f8", (2, 2, 6, 6)),
        ("by_weight", "f8", (2, 6)),  # without bristles of the load
        ("by_slip", "f8", (2, 2, 6)),
        ("sums", "f8", (SUMS,)),
        ("strip", "f8", STRIP_SHAPE),
        ("piece", "f8", STRIP_SHAPE),
        ("cuts", "f8", (LIMITS, 5)),
        ("breaks", "f8", (BREAKS,)),
        ("pose", "f8", (5, 3)),  # of the rack: rotation, position, angular velocity
        ("stiffness", "f8", (6, 6)),  # of the wrench over the rack's motion
        ("rubbing", "f8", (2, 6, 6)),  # the same of each side's friction without a state
        ("wrench", "f8", (WRENCH_SIZE,)),
    ]
)


DEEPEST = 0.055  # penetration over the module: the strip's half width is a sixth of the curvature's radius


@inline
def pose_of(q, v, reference, pose):  # type: ignore[no-untyped-def]
    """Fill the rack's rotation, position and angular velocity, the rows of `pose` (5, 3); return its turn."""
    turn = turn_of(q[4:7])
    fill_rotation(q[4:7], pose)
    spin = spin_of(turn, v[4:7])
    for i in range(3):
        pose[3, i], pose[4, i] = reference[i] + q[1 + i], spin[i]
    return turn


@inline
def on_flanks(q, turn, flank, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Turn the wrench of flanks, and its stiffness, into those on the coordinates."""
    if factor_q != 0 or factor_v != 0:
        axis, to_axis = pinion_axis(q[0], work.pose[3], flank)
        add_on_coordinates(work.wrench, q, turn, axis, to_axis, work.stiffness, factor_q, tangent)
    on_coordinates(work.wrench, turn, out)


@inline
def line_law(q, v, mesh, pool, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Load per length of line in proportion to the flanks' depth: law "line"."""
    turn, pose = pose_of(q, v, mesh.flank.rack_reference, work.pose), work.pose
    line_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], mesh.flank, pool, work, factor_q, factor_v)
    on_flanks(q, turn, mesh.flank, work, factor_q, factor_v, out, tangent)


@inline
def teeth_law(q, v, mesh, pool, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Teeth that bend together: law "teeth"."""
    turn, pose = pose_of(q, v, mesh.flank.rack_reference, work.pose), work.pose
    teeth_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], mesh, pool, work, factor_q, factor_v)
    on_flanks(q, turn, mesh.flank, work, factor_q, factor_v, out, tangent)


@inline
def sphere_law(q, v, mesh, pool, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Spheres on the pinion's flanks against the rack's planes, as in general contact."""
    spheres = mesh.spheres
    turn, pose = pose_of(q, v, spheres.rack_reference, work.pose), work.pose
    sphere_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], spheres, pool, work, factor_q, factor_v)
    _on_meshes(q, turn, spheres, work, factor_q, factor_v, out, tangent)


@inline
def triangle_law(q, v, mesh, pool, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Triangles of the pinion's flanks against faces of the rack."""
    meshes = mesh.triangles
    turn, pose = pose_of(q, v, meshes.rack_reference, work.pose), work.pose
    mesh_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], meshes, pool, work, factor_q, factor_v)
    _on_meshes(q, turn, meshes, work, factor_q, factor_v, out, tangent)


@inline
def _on_meshes(q, turn, data, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Turn the wrench of spheres or triangles, and its stiffness, into those on the coordinates."""
    if factor_q != 0 or factor_v != 0:
        axis = data.pinion_frame[0, 2], data.pinion_frame[1, 2], data.pinion_frame[2, 2]
        to_axis = minus(vector(data.pinion_origin), vector(work.pose[3]))
        add_on_coordinates(work.wrench, q, turn, axis, to_axis, work.stiffness, factor_q, tangent)
    on_coordinates(work.wrench, turn, out)


@entry(NUMBER, NUMBER, VECTOR, MATRIX, VECTOR, VECTOR, Array(MESH, 1), VECTOR, Array(SCRATCH, 1))
def fill_wrench(angle, rate, position, rotation, velocity, spin, meshes, pool, works):  # type: ignore[no-untyped-def]
    """Fill the wrench of a contact at a pose, see `wrench`, with no gear around it."""
    mesh, work = meshes[0], works[0]
    if mesh.kind == BY_LINE:
        line_contact(angle, rate, position, rotation, velocity, spin, mesh.flank, pool, work, 0.0, 0.0)
    elif mesh.kind == BY_TEETH:
        teeth_contact(angle, rate, position, rotation, velocity, spin, mesh, pool, work, 0.0, 0.0)
    elif mesh.kind == BY_SPHERES:
        sphere_contact(angle, rate, position, rotation, velocity, spin, mesh.spheres, pool, work, 0.0, 0.0)
    else:
        mesh_contact(angle, rate, position, rotation, velocity, spin, mesh.triangles, pool, work, 0.0, 0.0)
