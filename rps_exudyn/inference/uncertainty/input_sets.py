"""Distributions of the inputs where a user has none of his own: each with its source.

`unknown`  a gear of which nothing but its teeth is known: what service manuals, tables of friction and usual
           practice allow; the gear's own values are not used
`series`   gears of one drawing: scatter about the gear's own values

A parameter that carries a distribution of its own keeps it. `own` takes these alone. In both sets teeth and
plunger share a grease: their friction is correlated, unless the gear's file says otherwise.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from operator import ge, gt, le, lt
from typing import Any

from annotated_types import Ge, Gt, Le, Lt

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.inference.uncertainty import joint
from rps_exudyn.inference.uncertainty.joint import JointInputs, Pair
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.distribution import Distribution, is_distribution
from rps_exudyn.parameters.gear import CORRELATION, POSTERIOR, SteeringGear


@dataclass(frozen=True)
class Input:
    """A distribution of one parameter.

    `about` names what it is a distribution of: the `value` itself, a `factor` on the gear's own value, a
    `shift` added to it, or the value of a gear that has none of its own, which by default is an `error` of 0.
    """

    path: str
    text: str
    source: str
    about: str = "value"

    def of(self, gear: SteeringGear) -> Distribution | None:
        """Return the distribution of the gear's parameter [SI]; None where it does not vary."""
        item = SteeringGear.declared_at(self.path)[0]
        value = gear.value_at(self.path)
        if self.path == "mesh.line_stiffness":
            value = line_stiffness(gear)
        unit = item.unit.si if item.unit else ""
        drawn = Distribution.read(self.text, "" if self.about == "factor" else unit)
        if self.about == "factor":
            return drawn.scaled(value) if value > 0 else None
        if self.about == "error" and value:
            return None
        return drawn.moved(value) if self.about == "shift" else drawn


MANUAL = "workshop manuals"
PRACTICE = "usual practice, no source found"
TABLES = "bearing makers' tables of greased and dry liners"
SPRING = "retainer spring of the Datsun 280Z, unassisted (196 N at 16.3 mm, 59.4 N/mm, wire 2.9 mm)"
STANDARD = "ISO 6336-1 against measured stiffness"

UNKNOWN = (
    Input(
        "yoke.preload",
        "uniform(120 N, 600 N)",
        SPRING + ": 119 N when 1.3 mm longer, a turn of its plug; 400 N when solid, with 4.4 coils assumed; "
        "another gear's is up to half stronger",
    ),
    Input("yoke.friction", "uniform(0.03, 0.20)", TABLES),
    Input("mesh.friction", "uniform(0.05, 0.15)", "general engineering knowledge of greased steel"),
    Input("bush.drag", "uniform(10 N, 40 N)", PRACTICE),
    Input("bearing.friction_torque", "uniform(20 N*mm, 60 N*mm)", PRACTICE),
    Input("pinion.runout", "uniform(0 um, 40 um)", "the paper's study of a runout of 40 um"),
    Input("pinion.runout_angle", "uniform(0 deg, 360 deg)", "any"),
    Input("yoke.clearance", "uniform(13 um, 76 um)", "a workshop manual: 0.5 to 3 thousandths of an inch"),
    Input("yoke.spring_rate", "uniform(30 N/mm, 90 N/mm)", SPRING + ", half less and half more"),
    Input("installation.angle_error", "0 deg +- 0.05 deg", PRACTICE),
    Input("installation.axis_offset", "0 um +- 20 um", PRACTICE),
    Input("pinion.profile_slope", "0 um +- 4 um", "ISO 1328-1, quality 6 to 7"),
    Input("pinion.pitch_error", "0 um +- 4 um", "ISO 1328-1, quality 6 to 7"),
    Input("mesh.line_stiffness", "uniform(0.7, 1.4)", STANDARD, "factor"),
)

SERIES = (
    Input("yoke.preload", "1 +- 7 %", "usual tolerance of coil springs, EN 15800", "factor"),
    Input("yoke.friction", "1 +- 15 %", PRACTICE, "factor"),
    Input("mesh.friction", "1 +- 10 %", PRACTICE, "factor"),
    Input("bush.drag", "1 +- 20 %", PRACTICE, "factor"),
    Input("bearing.friction_torque", "1 +- 20 %", PRACTICE, "factor"),
    Input("yoke.bore_friction", "1 +- 30 %", PRACTICE, "factor"),
    Input("pinion.axial_float", "1 +- 30 %", PRACTICE, "factor"),
    Input("bush.clearance", "1 +- 30 %", PRACTICE, "factor"),
    Input("pinion.runout", "uniform(0 um, 15 um)", "ISO 1328-1, quality 6 to 7", "error"),
    Input("pinion.runout_angle", "uniform(0 deg, 360 deg)", "any"),
    Input("yoke.clearance", "uniform(-15 um, 15 um)", MANUAL + ": back off by 10 to 20 deg", "shift"),
    Input("yoke.spring_rate", "1 +- 5 %", "usual tolerance of coil springs, EN 15800", "factor"),
    Input("installation.angle_error", "0 deg +- 0.03 deg", PRACTICE, "shift"),
    Input("installation.axis_offset", "0 um +- 10 um", PRACTICE, "shift"),
    Input("pinion.profile_slope", "0 um +- 2 um", "ISO 1328-1, quality 6", "shift"),
    Input("pinion.pitch_error", "0 um +- 2 um", "ISO 1328-1, quality 6", "shift"),
    Input("mesh.line_stiffness", "1 +- 10 %", STANDARD, "factor"),
)

SETS = {"unknown": UNKNOWN, "series": SERIES, "own": ()}
"""Name -> inputs; `own` has none but those that the gear carries."""

GREASE: dict[Pair, float] = {frozenset(("mesh.friction", "yoke.friction")): 0.5}
"""Correlation of the sets: one grease, but steel on steel and steel on plastic; an estimate."""


def uncertain_inputs(
    gear: SteeringGear, inputs: str | None, own: Mapping[str, Distribution], may_be_none: bool = False
) -> JointInputs:
    """Return path -> distribution: the gear's own, and those of a set for all other parameters.

    Args:
        gear: its values are those about which a set scatters.
        inputs: name of the set; None or "" for `own` where something varies without one, else `series`.
        own: distributions that the gear's parameters carry.
        may_be_none: something else varies.

    Raises:
        InputError: no such set, nothing that varies, a distribution that leaves its parameter's limits, or
            correlations of what does not vary.
    """
    inputs = inputs or ("own" if own or may_be_none else "series")
    if inputs not in SETS:
        raise InputError(f"the set of inputs is {inputs!r}; it must be one of {', '.join(SETS)}.")
    given, found = JointInputs.of(own), dict(own)
    for each in SETS[inputs]:
        if each.path not in own and (drawn := each.of(gear)) is not None:
            found[each.path] = drawn
    if not found and not may_be_none:
        raise InputError(
            "no parameter carries a distribution; give one, for instance "
            '--set yoke.preload="300 N +- 30 N", or take the inputs of a set, series or unknown.'
        )
    declared = {item.path: item for item in SteeringGear.declared()}
    problems = [line for path, each in found.items() for line in outside(declared[path], each)]
    for path, samples in given.posterior.items():
        problems += joint.check_posterior(samples, declared[path], gear.value_at(path))
    if problems := problems + joint.check_pairs(given.pairs, found):
        raise InputError(problems)
    shared = GREASE if SETS[inputs] else {}
    usual = {pair: each for pair, each in shared.items() if not joint.check_pairs({pair: each}, found)}
    return JointInputs(found, usual | dict(given.pairs))


# --- The distributions that the parameters of a gear carry, in its file or in settings

_HOLDS = ((Gt, "gt", gt), (Ge, "ge", ge), (Lt, "lt", lt), (Le, "le", le))


def carried(tables: Mapping[str, Any], settings: Mapping[str, Any]) -> JointInputs:
    """Return path -> distribution of the gear's parameters that have one, or samples of a posterior; settings
    come before tables.

    Raises:
        InputError: distributions that cannot be, or that leave what their parameters allow (all at once).
    """
    found: dict[str, Distribution] = {}
    problems: list[str] = []
    pairs = joint.read_pairs(tables.get(CORRELATION, {}), CORRELATION, problems)
    fixed = {path for path, value in settings.items() if not is_distribution(value)}
    pairs = {pair: each for pair, each in pairs.items() if not pair & fixed}  # one value varies with nothing
    samples = joint.read_posterior(tables.get(POSTERIOR, {}), problems)
    if unknown := samples.keys() - {item.path for item in SteeringGear.declared() if item.unit is not None}:
        problems.append(f"{POSTERIOR} has {', '.join(sorted(unknown))}, which is no parameter with a number.")
    for item in SteeringGear.declared():
        value = settings.get(item.path, _at(tables, item.path))
        if item.unit is None or not is_distribution(value):
            if item.path in samples and item.path not in settings:
                found[item.path] = samples[item.path]
            continue
        try:
            found[item.path] = Distribution.read(value, item.unit.si)
        except ValueError as error:
            problems.append(f"{item.path} {error}.")
            continue
        problems += outside(item, found[item.path])
    if problems:
        raise InputError(problems)
    rest = [path for path in samples if path not in settings]
    parted = tuple(path for path in samples if path in settings) if rest else ()
    return JointInputs(found, pairs, parted)


def outside(item: Declared, distribution: Distribution) -> list[str]:
    """Return a sentence if an end of the distribution is not allowed for the parameter; none otherwise."""
    limits = [
        (holds, getattr(limit, attribute))
        for kind, attribute, holds in _HOLDS
        for limit in item.field.metadata
        if isinstance(limit, kind)
    ]
    return [
        f"the distribution of {item.path} reaches {item.show(end)}; {item.path} must be {item.allowed}."
        for end in distribution.ends
        if not all(holds(end, limit) for holds, limit in limits)
    ][:1]


def _at(tables: Mapping[str, Any], path: str) -> Any:
    """Return what nested tables have at a dotted path, None without it."""
    value: Any = tables
    for name in path.split("."):
        value = value.get(name) if isinstance(value, Mapping) else None
    return value
