"""The contact law "area", pressure in proportion to depth: a reference that no user chooses.

Its integral is known in independent ways, over strips and over generators, and by the spheres of general
contact; the laws of lines and of teeth have none of these. Importing this module adds it to the laws of the
solvers.
"""

from collections.abc import Mapping

from rps_exudyn.base.compiled import entry, inline
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.gear_model import LAW, LAWS, begin, finish, rates_of
from rps_exudyn.tooth_contact.laws import on_flanks, pose_of
from verification.area_contact import area_contact

NAME = "mesh.law"


def by_law(gear: SteeringGear, law: str) -> SteeringGear:
    """Return the gear with the contact law "area" or another one."""
    return gear.model_copy(update={"mesh": gear.mesh.model_copy(update={"law": law})})


def replaced(gear: SteeringGear, settings: Mapping[str, object]) -> SteeringGear:
    """Return the gear with single parameters changed, of which the contact law may be "area"."""
    other = gear.replace({path: value for path, value in settings.items() if path != NAME})
    return by_law(other, str(settings.get(NAME, gear.mesh.law)))


@inline
def area_law(q, v, mesh, work, factor_q, factor_v, out, tangent):  # type: ignore[no-untyped-def]
    """Pressure in proportion to the flanks' depth, see `tooth_contact.laws`."""
    turn, pose = pose_of(q, v, mesh.flank.rack_reference, work.pose), work.pose
    area_contact(q[0], v[0], pose[3], pose[0:3], v[1:4], pose[4], mesh.flank, work, factor_q, factor_v)
    on_flanks(q, turn, mesh.flank, work, factor_q, factor_v, out, tangent)


@entry(*LAW)
def area_gear(q, v, gears, g, pool, works, factor_q, factor_v, total, tangent):  # type: ignore[no-untyped-def]
    """A gear with this law."""
    gear, work = gears[g], works[0]
    by_rate = begin(q, v, gear, pool, work, factor_q, factor_v)
    at = work.place, rates_of(gear.mesh.flank.law, work), gear.mesh, work.contact
    by_sliding = by_rate if gear.mesh.flank.law.has_state else factor_v
    area_law(*at, factor_q, by_sliding, work.out, work.near)
    finish(q, v, gear, pool, work, factor_q, factor_v, by_rate, total, tangent)


LAWS["area"] = area_gear
