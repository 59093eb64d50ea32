"""Records of the contact of the teeth: the constants of all laws, and the work space of an evaluation."""

from rps_exudyn.base.compiled import record_type
from rps_exudyn.forces.friction import PATCH_SUMS, STATE_SIZE
from rps_exudyn.tooth_contact.flank_data import FLANK
from rps_exudyn.tooth_contact.flank_line import SUMS
from rps_exudyn.tooth_contact.flank_strip import STRIP_SHAPE
from rps_exudyn.tooth_contact.sampled_contact import SPHERES
from rps_exudyn.tooth_contact.strip_limits import BREAKS, LIMITS
from rps_exudyn.tooth_contact.teeth_data import TEETH
from rps_exudyn.tooth_contact.wrench import WRENCH_SIZE

MESH = record_type([("flank", FLANK), ("teeth", TEETH), ("spheres", SPHERES)])
"""Constants of the laws; those of laws that are not used are zero."""


# --- Work space of the contact of the teeth: one record, which no evaluation needs to allocate

SCRATCH = record_type(
    [
        ("memory", "f8", (2, STATE_SIZE)),  # state of the bristle friction, see `forces.friction`
        ("rubbed", "f8", (PATCH_SUMS,)),  # sums over a patch of it
        # of each side: changes of its directions with the loads, and of its weight, over the rack's motion
        ("by_direction", "f8", (2, 2, 6, 6)),
        ("by_weight", "f8", (2, 6)),
        ("sums", "f8", (SUMS,)),
        ("strip", "f8", STRIP_SHAPE),
        ("cuts", "f8", (LIMITS, 5)),
        ("breaks", "f8", (BREAKS,)),
        ("pose", "f8", (5, 3)),  # of the rack: rotation, position, angular velocity
        ("stiffness", "f8", (6, 6)),  # of the wrench over the rack's motion
        ("wrench", "f8", (WRENCH_SIZE,)),
    ]
)
