"""The wrench of a contact of the teeth at a pose, see `tooth_contact.wrench`; no gear around it."""

from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.kernel_compiler import from_python
from rps_exudyn.forces.friction import reset
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.elastic_teeth import room_of_teeth, teeth_contact
from rps_exudyn.tooth_contact.flank_contact import line_contact
from rps_exudyn.tooth_contact.laws import MESH, SCRATCH
from rps_exudyn.tooth_contact.mesh_contact import mesh_contact, pooled_meshes
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData, pooled, sphere_contact
from rps_exudyn.tooth_contact.teeth_data import teeth_data
from rps_exudyn.tooth_contact.teeth_stations import most_lines
from verification.area_contact import area_contact

NO_POOL = np.zeros(1)


def flank_contact(*at: Any, pool: np.ndarray = NO_POOL) -> np.ndarray:
    """The wrench of laws "line" and "area" at angle, rate, position, rotation, velocity, spin of a record
    `FLANK`, the last argument; the numbers of measured flanks stand in the pool."""
    *pose, flank = at
    if flank.line_stiffness > 0:
        return _wrench(line_contact, pose, flank, pool)
    return _wrench(area_contact, pose, flank)


def mesh_of_teeth(gear: SteeringGear, flank: np.record) -> np.void:
    """The record `MESH` of law "teeth"."""
    mesh = np.zeros(1, MESH)
    mesh["flank"], mesh["teeth"], mesh["most_lines"] = flank, teeth_data(gear, flank), most_lines(flank)
    return mesh[0]


def elastic_contact(*at: Any) -> np.ndarray:
    """The same of law "teeth", of a record `MESH`."""
    *pose, mesh = at
    return _wrench(teeth_contact, pose, mesh, np.zeros(room_of_teeth(mesh["flank"])))


def sampled_wrench(*at: Any) -> np.ndarray:
    """The same of spheres."""
    *pose, spheres = at
    assert isinstance(spheres, SampledContactData)
    record, pool = pooled(spheres, 0)
    return _wrench(sphere_contact, pose, record, pool)


def mesh_wrench(*at: Any, **values: Any) -> np.ndarray:
    """The same of two meshes, the last argument; numbers of their record by name."""
    *pose, meshes = at
    record, pool = pooled_meshes(meshes, 0, **values)
    return _wrench(mesh_contact, pose, record[0], pool)


_from_python = cache(from_python)


def _wrench(contact: Any, pose: list[Any], *constants: Any) -> np.ndarray:
    angle, rate, *places = pose
    works = np.zeros(1, SCRATCH)
    reset(works[0]["memory"])
    rows = [np.ascontiguousarray(each, dtype=float) for each in places]
    _from_python(contact)(float(angle), float(rate), *rows, *constants, works[0], 0.0, 0.0)
    return np.array(works[0]["wrench"])
