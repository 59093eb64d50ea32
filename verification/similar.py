"""Similar gears, which must give similar results: mirrored hands, other units, the other direction first.

    twin = in_units(gear, length=2.0, force=4.0, time=1.5)    # every parameter by its own dimension
    summary_in_units(result.summary, 2.0, 4.0, 1.5)           # what its result must be
    twin = mirrored(gear)                                     # the other hand, Z -> -Z
    twin = begun_otherwise(gear, "reversal")                  # the same motion from its other end
    for twin in twins(gear, "reversal"):                      # all of them

They need no reference: a length, force or time that stands in the code and is no parameter shows as a
difference. Steel's modulus stands there by intention (`gears.tooth_stiffness`), so that force must go with
length^2; where a weight pulls or gravity acts, time^2 with length.
"""

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.quantities import SUMMARY
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named

BASE = {  # unit -> powers of length, force and time
    "m": (1, 0, 0),
    "N": (0, 1, 0),
    "s": (0, 0, 1),
    "kg": (-1, 1, 2),
    "Pa": (-2, 1, 0),
    "J": (1, 1, 0),
    "W": (1, 1, -1),
    "Hz": (0, 0, -1),
    "rad": (0, 0, 0),
    "K": (0, 0, 0),
    "1": (0, 0, 0),
    "": (0, 0, 0),
}
TURNED_OVER = (  # by a mirror across the rack's travel and the pinion's axis
    "pinion.helix_angle",
    "rack.tooth_angle",
    "installation.angle_error",
    "installation.gravity_angle",
    "rack.bow_angle",
    "rack.side_angle",
)
LOADED = ("load-test",)  # against the direction of the test: the other one loads the other flanks
LOADED = ("load-test",)  # against the direction of the test: the other one loads the other flanks
UNITS = {"length": 2.0, "force": 4.0, "time": 2**0.5}  # moduli of steel and the acceleration of gravity stay
NO_UNITS = {  # of a name or a list, from which numbers with units follow
    **dict.fromkeys(("rack.pitch_errors", "pinion.pitch_errors", "housing.seat_stiffness"), "none"),
    "grease.base_oil": "none",
}
LEAST_SHARE = 1e-3  # of a gear's largest metric of a unit: below it a metric is rounding


def size_of(unit: str, length: float, force: float, time: float) -> float:
    """Return by what a number in a unit of the SI grows where those of length, force and time do."""
    size = 1.0
    for sign, name, power in re.findall(r"(^|[*/])([A-Za-z1]*)(?:\^(\d))?", unit):
        powers = BASE[name]
        share = length ** powers[0] * force ** powers[1] * time ** powers[2]
        size *= share ** (int(power or 1) * (-1 if sign == "/" else 1))
    return float(size)


def in_units(gear: SteeringGear, length: float, force: float, time: float) -> SteeringGear:
    """Return the gear of which every length, force and time is so many times as large.

    Raises:
        InputError: a parameter leaves the range that is allowed.
    """
    scaled = {
        item.path: gear.value_at(item.path) * size_of(item.unit.si, length, force, time)
        for item in SteeringGear.declared()
        if item.unit is not None and item.unit.si not in ("", "rad", "K", "1/K")
    }
    return gear.replace(scaled)


def mirrored(gear: SteeringGear) -> SteeringGear:
    """Return the gear of the other hand: Z -> -Z."""
    known = {item.path for item in SteeringGear.declared()}
    return gear.replace({path: -gear.value_at(path) for path in TURNED_OVER if path in known})


def begun_otherwise(gear: SteeringGear, scene: str) -> SteeringGear | None:
    """Return the gear that makes the same motion from its other end: a path there and back, two cycles of a
    swing. None where the scene has another motion than that, or a load that pulls against its beginning."""
    test, chosen = gear.test, scene_named(scene)
    if scene in LOADED:
        return None
    if chosen.swings:
        return gear.replace({"test.direction": -test.direction}) if test.cycles > 1 else None
    if chosen.test is None or test.path == "one-way":
        return None
    turned = 2 * np.pi * test.turns * test.direction if test.path == "there-and-back" else 0.0
    return gear.replace({"test.direction": -test.direction, "test.start_angle": test.start_angle + turned})


@dataclass(frozen=True)
class Twin:
    """A gear that is similar to another one, and by which units its results differ."""

    kind: str
    gear: SteeringGear
    units: Mapping[str, float] = field(default_factory=dict)

    def differences(self, result: Result, found: Result) -> dict[str, float]:
        """Return the `differences` of a gear's result and that of this twin."""
        if self.kind == "mirrored":
            own = {SIDES.get(name, name): value for name, value in found.summary.items()}
            found = replace(found, summary=own | {name: -own[name] for name in ALONG_Z & own.keys()})
        return differences(result, found, **self.units)


def twins(gear: SteeringGear, scene: str) -> Iterator[Twin]:
    """Yield the gears that must give similar results; one that leaves the range of a parameter is left
    out."""
    yield Twin("mirrored", mirrored(gear))
    with suppress(InputError):
        yield Twin("in other units", in_units(gear, **UNITS), UNITS)
    if (other := begun_otherwise(gear, scene)) is not None:
        yield Twin("begun otherwise", other)


def summary_in_units(
    summary: Mapping[str, float], length: float = 1.0, force: float = 1.0, time: float = 1.0
) -> dict[str, float]:
    """Return the metrics that a similar gear must have."""
    return {name: value * size_of(SUMMARY[name].unit, length, force, time) for name, value in summary.items()}


def differences(result: Result, twin: Result, **units: float) -> dict[str, float]:
    """Return by which share each metric of a similar gear differs from what it must be; nan where only one
    has it. Metrics that are a rounding beside others of their unit are left out."""
    right, found = summary_in_units(result.summary, **units), dict(twin.summary)
    largest: dict[str, float] = {}
    for name, value in right.items():
        unit = SUMMARY[name].unit
        largest[unit] = max(largest.get(unit, 0.0), abs(value))
    shares: dict[str, float] = {}
    for name in sorted({*right, *found} - LEFT_OUT):
        if name not in right or name not in found:
            shares[name] = float("nan")
        elif abs(right[name]) > LEAST_SHARE * largest[SUMMARY[name].unit]:
            shares[name] = found[name] / right[name] - 1
    return shares


LEFT_OUT = {"energy_residual"}  # whose size is that of rounding
SIDES = {"radial_play_side": "radial_play_other_side", "radial_play_other_side": "radial_play_side"}
ALONG_Z = {"load_centre"}  # which change their sign where Z does
