"""The ladder: what a level makes of everything that discretisation decides.

    model, gear, options = model_at(2, fidelity), gear_at(2, gear), options.at(2)

A level halves the steps, the friction zone and the tolerance of the level below. It doubles the stations on
a line of contact, the modes of the rack and the cycles before the record. Its spheres are closer by the root
of 2. Level 1 has what a model asks for. `Maneuver.halved` divides the steps, so that a level has all instants
of the levels below.
"""

from math import ceil, sqrt

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear

FINEST = 8
"""The last level: it takes 128 times the memory of a usual run."""


KNOBS = (
    *("step_angle", "swing_steps", "tolerance", "zone_ratio"),
    *("strip_stations", "strip_points", "profile_samples", "axial_samples", "chord_error"),
)
"""Choices of a model that a level decides."""


MOST_MODES = SteeringGear.declared_at("rack.modes")[0].most
_MOST = {name: Fidelity.declared_at(name)[0].most for name in KNOBS}


def valid_level(level: int, fidelity: Fidelity) -> int:
    """Return a level that may be asked of a model.

    Raises:
        InputError: no such level, a model that has none, or one whose discretisation is chosen beside.
    """
    if isinstance(level, bool) or not isinstance(level, int) or not 0 <= level <= FINEST:
        raise InputError(f"level is {level!r}; it must be a whole number from 0 to {FINEST}.")
    if fidelity.solver == "closed-form":
        raise InputError("fidelity is closed-form, which has no level; leave out level.")
    usual = Fidelity.preset(fidelity.based_on)
    if own := [name for name in KNOBS if getattr(fidelity, name) != getattr(usual, name)]:
        raise InputError(f"level decides fidelity.{own[0]}; leave out one of them.")
    return level


def model_at(level: int, fidelity: Fidelity) -> Fidelity:
    """Return a model with the stations, spheres, friction zone and tolerance of a level, not its steps."""
    if fidelity.solver == "closed-form":
        return fidelity
    finer = 2.0 ** (level - 1)
    changed = {
        "tolerance": fidelity.tolerance / finer,
        # at most half the widest at level 1, so that level 0 has twice as wide a one
        "zone_ratio": min(fidelity.zone_ratio, _MOST["zone_ratio"] / 2) / finer,
        "strip_stations": doubled(fidelity.strip_stations, level),
        "strip_points": doubled(fidelity.strip_points, level),
        "profile_samples": ceil(fidelity.profile_samples * sqrt(finer)),
        "axial_samples": ceil(fidelity.axial_samples * sqrt(finer)),
        "chord_error": fidelity.chord_error / finer**2,  # of strips half as wide
    }
    # within the limits of their declarations, as the model is
    return fidelity.model_copy(update={name: min(value, _MOST[name]) for name, value in changed.items()})


def gear_at(level: int, gear: SteeringGear) -> SteeringGear:
    """Return a gear whose rack, where it bends, has the modes of a level."""
    modes = min(doubled(gear.rack.modes, level), MOST_MODES)
    return gear if modes == gear.rack.modes else gear.with_unchecked({"rack.modes": modes})


def doubled(count: int, level: int) -> int:
    """Return a number at a level: its half, rounded up, at level 0, and twice as much at each next level."""
    return ceil(count / 2) * 2**level


def cycles_before(level: int) -> int:
    """Return the whole cycles of a swing before its record: 0, 1, 2, 4, 8."""
    return 2**level // 2
