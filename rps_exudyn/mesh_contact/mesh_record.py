"""The record of a gear's mesh: the constants of all laws of its teeth's contact."""

from rps_exudyn.base.compiled import record_type
from rps_exudyn.mesh_contact.flank_data import FLANK
from rps_exudyn.mesh_contact.sampled_contact import SPHERES
from rps_exudyn.mesh_contact.teeth_data import TEETH

MESH = record_type([("flank", FLANK), ("teeth", TEETH), ("spheres", SPHERES)])
"""Constants of the laws; those of laws that are not used are zero."""
