"""The contact law of a gear whose `mesh.law` is by-scene: what its task needs.

Law line gives means of free motion; law teeth loads, impacts and ripple (`Scene.law`), the scatter of a
series, and flanks with deviations. A model without teeth that bend, and a gear of variable ratio, have line.
A result names the law that it was made with in the parameters of its gear.
"""

from collections.abc import Collection
from typing import Literal, TypeVar

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import (
    BY_SCENE,
    FLANK_DEVIATIONS,
    SteeringGear,
    check_constant_ratio,
    surfaces_of,
)

Gear = TypeVar("Gear", bound=SteeringGear)
ContactLaw = Literal["line", "teeth"]
LAW_OF_SERIES: ContactLaw = "teeth"
"""Law of bands, requirement sheets and studies of uncertain inputs: by `line` the quantiles of the torque's
variation over a series are a fifth too small."""


def with_meshes(fidelity: Fidelity, gear: SteeringGear) -> Fidelity:
    """Return the model of a gear: contact of triangles in place of lines where the gear has surfaces.

    Raises:
        InputError: a model that has no surfaces, or no variable ratio.
    """
    sampled = fidelity.mesh == "general-contact"
    by_parameters = fidelity.solver in ("closed-form", "reduced") or sampled
    if sampled:
        check_constant_ratio(gear, f"the fidelity {fidelity.name.partition(' ')[0]}")
    if not (given := surfaces_of(gear)):
        return fidelity
    if by_parameters:
        part = "mesh" if sampled else "solver"
        raise InputError(
            f"{given[0]} is given, but fidelity.{part} is {getattr(fidelity, part)}, which has only flanks "
            "by parameters: choose quasi-static or flank."
        )
    return fidelity.replace({"mesh": "triangles"})


def resolve_contact_law(
    gear: Gear, fidelity: Fidelity, needed: ContactLaw, varied: Collection[str] = ()
) -> Gear:
    """Return the gear with the contact law that is modelled in place of by-scene.

    Paths `varied` differ from gear to gear of a task, which has one law.
    """
    if gear.mesh.law != BY_SCENE:
        return gear
    deviates = needed == "teeth" or not set(FLANK_DEVIATIONS).isdisjoint(varied)
    can_bend = fidelity.bends_teeth and gear.rack.ratio.is_constant and not surfaces_of(gear)
    can_bend &= not any(path.startswith("rack.ratio.") for path in varied)
    teeth = can_bend and (deviates or gear.set_among(FLANK_DEVIATIONS))
    return gear.with_unchecked({"mesh.law": "teeth" if teeth else "line"})
