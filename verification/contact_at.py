"""The wrench of a contact of the teeth at a pose, see `tooth_contact.wrench`; no gear around it."""

from functools import cache
from typing import Any

import numpy as np

from rps_exudyn.base.kernel_compiler import from_python
from rps_exudyn.forces.friction import reset
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.elastic_teeth import room_of_teeth
from rps_exudyn.tooth_contact.laws import KINDS, MESH, SCRATCH, fill_wrench
from rps_exudyn.tooth_contact.mesh_contact import pooled_meshes
from rps_exudyn.tooth_contact.sampled_contact import SampledContactData, pooled
from rps_exudyn.tooth_contact.teeth_data import teeth_data
from rps_exudyn.tooth_contact.teeth_stations import most_lines
from verification.area_contact import area_contact

NO_POOL = np.zeros(1)


def flank_contact(*at: Any, pool: np.ndarray = NO_POOL) -> np.ndarray:
    """The wrench of laws "line" and "area" at angle, rate, position, rotation, velocity, spin of a record
    `FLANK`, the last argument; the numbers of measured flanks stand in the pool."""
    *pose, flank = at
    if flank.line_stiffness > 0:
        return _wrench("line", pose, pool, flank=flank)
    angle, rate, *places = pose
    works = _work()
    _area()(float(angle), float(rate), *_rows(places), flank, works[0], 0.0, 0.0)
    return np.array(works[0]["wrench"])


def mesh_of_teeth(gear: SteeringGear, flank: np.record) -> np.void:
    """The record `MESH` of law "teeth"."""
    mesh = np.zeros(1, MESH)
    mesh["flank"], mesh["teeth"], mesh["most_lines"] = flank, teeth_data(gear, flank), most_lines(flank)
    return mesh[0]


def elastic_contact(*at: Any) -> np.ndarray:
    """The same of law "teeth", of a record `MESH`."""
    *pose, mesh = at
    parts = {name: mesh[name] for name in ("flank", "teeth", "most_lines")}
    return _wrench("teeth", pose, np.zeros(room_of_teeth(mesh["flank"])), **parts)


def sampled_wrench(*at: Any) -> np.ndarray:
    """The same of spheres."""
    *pose, spheres = at
    assert isinstance(spheres, SampledContactData)
    record, pool = pooled(spheres, 0)
    return _wrench("spheres", pose, pool, spheres=record)


def mesh_wrench(*at: Any, **values: Any) -> np.ndarray:
    """The same of two meshes, the last argument; numbers of their record by name."""
    *pose, meshes = at
    record, pool = pooled_meshes(meshes, 0, **values)
    return _wrench("triangles", pose, pool, triangles=record)


@cache
def _area() -> Any:
    return from_python(area_contact)


def _wrench(kind: str, pose: list[Any], pool: np.ndarray, **parts: Any) -> np.ndarray:
    angle, rate, *places = pose
    works, meshes = _work(), np.zeros(1, MESH)
    meshes["kind"] = KINDS[kind]
    for name, part in parts.items():
        meshes[name] = part
    fill_wrench(float(angle), float(rate), *_rows(places), meshes, pool, works)
    return np.array(works[0]["wrench"])


def _rows(places: list[Any]) -> list[np.ndarray]:
    return [np.ascontiguousarray(each, dtype=float) for each in places]


def _work() -> np.ndarray:
    works = np.zeros(1, SCRATCH)
    reset(works[0]["memory"])
    return works
