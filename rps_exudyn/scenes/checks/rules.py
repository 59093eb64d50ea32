"""The rules: limits of physics and of methods, before a run, in its record, and in what it prints.

    for breach in breaches(IN_RECORD, RuleInput(gear, signals=signals)):
        breach.rule.code, breach.rule.status     of the run; a status of ok makes the sentence a remark
        breach.sentence                          which quantity, its value, the limit, where, why
        breach.repair                            the choices of the fidelity that meet the limit

What discretisation misses of a metric is in its error bar, and no matter of rules.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

import numpy as np

from rps_exudyn.analysis.passes import Signals, first_angle
from rps_exudyn.forces.force_element import ENERGY_TERMS
from rps_exudyn.gears.flank_grid import measured_flanks
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import largest_lift
from rps_exudyn.gears.pitch_errors import rack_errors
from rps_exudyn.gears.tooth_stiffness import BEARABLE_PRESSURE
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import largest_surplus
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark, Status
from rps_exudyn.results.quantities import SIGNALS
from rps_exudyn.solvers.record import Record, contact_disagreement
from rps_exudyn.tooth_contact.mean_depth import mean_depth, rack_approach
from rps_exudyn.tooth_contact.spheres import sphere_radius

Motion = Literal["steady", "unsteady", "at rest"]
"""Whether everything slides at a constant speed, speeds change, or nothing moves."""

STEPS_PER_PITCH = 2  # fewer cannot show the tooth frequency
REPAIRED_STEPS_PER_PITCH = 20
DEEPEST = 1.5  # deepest contact over the mean one, measured on the paper's gear
LEAST_ROWS = 8  # of spheres along the face width
SPACING = 2.5  # of spheres along the profile, over the width of the strip that touches: 1 % of the torque
LEAST_TOUCHING = 15  # spheres of general contact, on an edge twice as many: fewer miss 8 % of the torque
OUT_OF_PLACE = 0.06  # of the path of contact: spheres end where the rack's tips are under the preload
AT_YOKENUT = 0.08  # of the force on the seat that the nut carries; means by spheres are up to 2 % off then
AGREEMENT = 1e-6  # of Exudyn's contact forces with the compiled samples; 1e-9 is usual
MOST_OF_WORK = 0.05  # that may be missing in the balance: more is no error, but another motion
MOST_OF_TERMS = 0.2  # of the scene's main metric that inertia may change: more is another motion, too
GROWN = 0.7  # power of e by which a vibration may grow over a way unseen
MOST_POWER = 20.0  # of e, that a sentence states


@dataclass(frozen=True, eq=False)
class RuleInput:
    """What rules measure: a plan, and of a run its record; of many gears signals are (n, t), numbers (n,)."""

    gear: SteeringGear  # the gear, or what many have in common
    fidelity: Fidelity | None = None  # of a plan
    motion: Motion = "steady"  # of a plan
    signals: Signals = field(default_factory=dict)  # of a run
    record: Record | None = None  # of a single run
    axis_offset: Any = None  # of the pinion's axis from its nominal place [m], by default the gear's
    # signals above which the contact's law does not hold, with their bounds
    valid_to: Mapping[str, float] = field(default_factory=dict)
    numbers: Mapping[str, Any] = field(default_factory=dict)  # of a run with error bars, by name

    @property
    def model(self) -> Fidelity:
        """The fidelity of a plan."""
        assert self.fidelity is not None
        return self.fidelity

    @property
    def run(self) -> Record:
        """The record of a single run."""
        assert self.record is not None
        return self.record

    @property
    def is_shaken(self) -> bool:
        """Whether pulses may part the teeth."""
        return self.record is not None and self.record.pulse_power is not None

    @property
    def has_spheres(self) -> bool:
        """Whether teeth touch by spheres."""
        return self.record is not None and self.record.forces.spheres is not None


@dataclass(frozen=True, eq=False)
class Rule:
    """One limit."""

    code: Code  # what its breach is about
    # the quantity, a number or over the instants (t,), of many gears (n,) or (n, t)
    measured: Callable[[RuleInput], Any]
    sentence: Callable[["Breach"], str]  # about a breach, without a full stop
    limit: Callable[[RuleInput], Any] = lambda given: 0.0  # the largest allowed value
    applies: Callable[[RuleInput], bool] = lambda given: True  # whether there is anything to measure
    # choices of the fidelity that meet the limit
    repair: Callable[["Breach"], dict[str, Any]] = lambda breach: {}
    status: Status = Status.INVALID  # of a run that breaks it; ok: its sentence is a remark

    def breach(self, given: RuleInput) -> "Breach | None":
        """Return what breaks the rule."""
        if not self.applies(given):
            return None
        found = Breach(self, given, np.asarray(self.measured(given)), self.limit(given))
        return found if found.beyond.any() else None

    def within(self, given: RuleInput, share: float = 1.0) -> Any:
        """Return which gears stay below a share of the limit, (n,)."""
        if not self.applies(given):
            return np.True_
        below = np.asarray(self.measured(given) <= share * self.limit(given))
        return below.all(axis=-1) if below.ndim > 1 else below


@dataclass(frozen=True, eq=False)
class Breach:
    """A rule that is broken: the measured values and their limit."""

    rule: Rule
    given: RuleInput
    measured: np.ndarray
    limit: Any

    @property
    def beyond(self) -> np.ndarray:
        """Whether each value is beyond the limit; what is no number is."""
        return np.asarray(~(self.measured <= self.limit))

    @property
    def value(self) -> float:
        """The largest value."""
        return float(self.measured.max())

    @property
    def where(self) -> str:
        """The pinion's angle at the first instant beyond the limit, as text."""
        return first_angle(self.given.signals, self.beyond)

    @property
    def sentence(self) -> str:
        """Sentence without a full stop."""
        return self.rule.sentence(self)

    @property
    def repair(self) -> dict[str, Any]:
        """Choices of the fidelity that meet the limit; {} if none does."""
        return self.rule.repair(self)


def breaches(rules: Iterable[Rule], given: RuleInput) -> Iterator[Breach]:
    """Yield what breaks each of the rules."""
    return (breach for rule in rules if (breach := rule.breach(given)))


def breaches_of_plan(gear: SteeringGear, fidelity: Fidelity, *, motion: Motion) -> Iterator[Breach]:
    """Yield the limits that a plan does not meet; formulas have none."""
    rules = OF_PLAN if fidelity.solver != "closed-form" else ()
    return breaches(rules, RuleInput(gear, fidelity, motion))


def refused(gear: SteeringGear, fidelity: Fidelity, *, motion: Motion) -> list[str]:
    """Return the sentences about them."""
    return [breach.sentence for breach in breaches_of_plan(gear, fidelity, motion=motion)]


def remarks(rules: Iterable[Rule], given: RuleInput) -> Iterator[Remark]:
    """Yield what breaks each of the rules as a remark."""
    for breach in breaches(rules, given):
        yield Remark(breach.rule.code, breach.sentence)


# --- Plans -----------------------------------------------------------------------------------------
# At rest a chain of segments yields as the condensed bush.


def _asks(quantity: str, why: str, show: str, scale: float = 1.0) -> Callable[[Breach], str]:
    def sentence(breach: Breach) -> str:
        value, limit = (show.format(abs(scale * each)) for each in (breach.value, breach.limit))
        side = "at least" if breach.limit < 0 else "at most"
        return f"{quantity} is {value}; {why} asks for {side} {limit}"

    return sentence


_plan = partial(Rule, Code.REFUSED)


def _of_spheres(given: RuleInput) -> bool:
    return given.model.mesh == "general-contact"


def _at_least(choice: str, least: Callable[[SteeringGear], int]) -> Rule:
    """The rule of the fewest spheres along one direction of a flank."""
    return _plan(
        lambda given: -getattr(given.model, choice),
        _asks(f"fidelity.{choice}", "the integral over the contact", "{:.0f}"),
        lambda given: -least(given.gear),
        _of_spheres,
        lambda breach: {choice: int(-breach.limit)},
    )


def _pitch(gear: SteeringGear) -> float:
    return 2 * np.pi / gear.pinion.teeth


def _coarse(breach: Breach) -> str:
    pitch = f"{np.degrees(_pitch(breach.given.gear)):.4g} deg"
    why = f"a tooth pitch of {pitch}, which needs {STEPS_PER_PITCH} steps,"
    return _asks("fidelity.step_angle", why, "{:.4g} deg", 180 / np.pi)(breach)


def _is_chain(given: RuleInput) -> bool:
    return given.model.bush == "chain" and given.motion != "at rest"


def _least_profile_samples(gear: SteeringGear) -> int:
    """Return the least spheres along the path of contact: two are at most `SPACING` strips apart."""
    pair = GearPair.of(gear)
    curvature_radius = float(pair.reference_radius * np.sin(pair.alpha_t) / np.cos(pair.beta_b))
    strip = 2 * np.sqrt(2 * curvature_radius * max(mean_depth(gear), 1e-9))
    path = abs(pair.active_path[1] - pair.active_path[0])
    return int(np.ceil(path / (SPACING * strip)))


def _bowed(breach: Breach) -> str:
    model = breach.given.model
    contact = model.mesh == "general-contact"
    part = "fidelity.mesh = general-contact" if contact else f"fidelity.bush = {model.bush}"
    return _asks("rack.bow", f"{part}, which holds for straight bars only,", "{:.4g} um", 1e6)(breach)


def _straightened(breach: Breach) -> dict[str, Any]:
    bush = {"bush": "condensed"} if _is_chain(breach.given) else {}
    return bush | ({"mesh": "flank"} if breach.given.model.mesh == "general-contact" else {})


def _of_perfect_rack(name: str, errors: Callable[[SteeringGear], np.ndarray], why: str) -> Rule:
    """The rule of errors of the rack [m] that general contact does not have."""
    reason = f"fidelity.mesh = general-contact, {why},"
    return _plan(
        lambda given: float(np.abs(errors(given.gear)).max()),
        _asks(f"the largest of rack.{name}", reason, "{:.4g} um", 1e6),
        applies=lambda given: _of_spheres(given) and bool(getattr(given.gear.rack, name)),
        repair=lambda breach: {"mesh": "flank"},
    )


def _rack_deviations(gear: SteeringGear) -> np.ndarray:
    grid = measured_flanks(gear).rack
    return np.zeros(1) if grid is None else grid.coefficients


OF_PLAN = (
    _plan(
        lambda given: given.model.step_angle,
        _coarse,
        lambda given: _pitch(given.gear) / STEPS_PER_PITCH * (1 + 1e-9),
        lambda given: given.motion == "steady",
        lambda breach: {"step_angle": float(_pitch(breach.given.gear) / REPAIRED_STEPS_PER_PITCH)},
    ),
    _plan(
        lambda given: abs(given.gear.rack.bow),
        _bowed,
        applies=lambda given: _of_spheres(given) or _is_chain(given),
        repair=_straightened,
    ),
    _of_perfect_rack("pitch_errors", rack_errors, "whose racks have teeth without errors"),
    _of_perfect_rack("deviation", _rack_deviations, "whose rack has plane flanks"),
    _at_least("profile_samples", lambda gear: max(LEAST_ROWS, _least_profile_samples(gear))),
    _at_least("axial_samples", lambda gear: LEAST_ROWS),
    _plan(
        lambda given: DEEPEST * mean_depth(given.gear),
        _asks(
            "the deepest contact predicted from yoke.preload and the teeth's stiffness",
            "general contact, through whose flanks a sphere passes that is deeper than its radius,",
            "{:.0f} um",
            1e6,
        ),
        lambda given: sphere_radius(GearPair.of(given.gear)),
        _of_spheres,
        lambda breach: {"mesh": "flank"},
    ),
)
"""Limits of methods, before a run."""


# --- Records ---------------------------------------------------------------------------------------


def _lift(given: RuleInput) -> Any:
    place = given.gear.installation.axis_offset if given.axis_offset is None else given.axis_offset
    return np.abs(given.signals["rack_y"] - place)


def _beyond_law(breach: Breach) -> str:
    signals, valid_to = breach.given.signals, breach.given.valid_to
    name = max(valid_to, key=lambda each: float(signals[each].max()) / valid_to[each])
    quantity, bound = SIGNALS[name], valid_to[name]
    return (
        f"{name} is {quantity.show(signals[name].max())}, first above the {quantity.show(bound)} to which "
        f"the contact's law holds at {first_angle(signals, signals[name] > bound)}"
    )


IN_RECORD = (
    Rule(
        Code.NOT_FINITE,
        lambda given: sum(~np.isfinite(values) for values in given.signals.values()),
        lambda breach: (
            next(name for name, each in breach.given.signals.items() if not np.isfinite(each).all())
            + " is not finite"
        ),
        status=Status.DIVERGED,
    ),
    Rule(
        Code.RACK_OUT_OF_MESH,
        _lift,
        lambda breach: (
            f"the rack is {1e6 * breach.value:.4g} um out of its place, first above "
            f"{1e6 * breach.limit:.4g} um at {breach.where}"
        ),
        lambda given: largest_lift(given.gear),
        status=Status.CONTACT_LOST,
    ),
    Rule(
        Code.TEETH_UNLOADED,
        lambda given: given.signals["mesh_normal_force"] <= 0,
        lambda breach: f"the teeth carry no load, first at {breach.where}",
        applies=lambda given: "mesh_normal_force" in given.signals and not given.is_shaken,
        status=Status.CONTACT_LOST,
    ),
    Rule(
        Code.BEYOND_LAW,
        lambda given: np.max([given.signals[name] / to for name, to in given.valid_to.items()], axis=0),
        _beyond_law,
        lambda given: 1.0,
        lambda given: bool(given.valid_to),
    ),
)
"""Limits of physics, in any record: why it may have ended early, too."""


def _touching(given: RuleInput) -> float:
    """Spheres that touch, half of those on an edge: shafts askew, or the yoke at its nut."""
    record = given.run
    mesh = next(part for part in record.forces.parts if part.name == "mesh")
    column = mesh.size + ENERGY_TERMS + mesh.outputs.index("mesh_touching")
    stopped = (given.signals.get("yokenut_force", np.zeros(1)) > 0).any()
    on_an_edge = bool(given.gear.installation.angle_error) or bool(stopped)
    return float(np.median(record.outputs(mesh)[:, column])) / (2 if on_an_edge else 1)


def _displaced(given: RuleInput) -> float:
    """How far the rack is displaced from teeth pressed in by the mean depth, over the path of contact."""
    pair = GearPair.of(given.gear)
    axis = pair.axis_offset + pair.runout * np.cos(given.signals["pinion_angle"] + pair.runout_angle)
    raised = float(np.mean(given.signals["rack_y"] - axis)) + rack_approach(pair, mean_depth(given.gear))
    return abs(raised) / float((pair.active_path[1] - pair.active_path[0]) * np.sin(pair.alpha_t))


def _on_yokenut(given: RuleInput) -> float:
    carried = float(given.signals["yokenut_force"].mean())
    return carried / float(given.signals["seat_force"].mean()) if carried > 0 else 0.0


OF_GENERAL_CONTACT = (
    Rule(
        Code.CONTACT_DISAGREES,
        lambda given: contact_disagreement(given.run),
        lambda breach: (
            f"two evaluations of the contact forces differ by {breach.value:.2g} (limit {AGREEMENT:.0g})"
        ),
        lambda given: AGREEMENT,
    ),
    Rule(
        Code.FEW_SPHERES,
        lambda given: -_touching(given),
        lambda breach: (
            f"{-breach.value:g} spheres touch, of which half count on an edge; {LEAST_TOUCHING} are needed: "
            "raise fidelity.profile_samples or axial_samples"
        ),
        lambda given: -LEAST_TOUCHING,
        lambda given: given.has_spheres,
    ),
    Rule(
        Code.SPHERES_OUT_OF_PLACE,
        _displaced,
        lambda breach: (
            f"the rack is displaced from its preloaded position by {breach.value:.1%} of the path of contact "
            f"(limit of general contact {OUT_OF_PLACE:.0%}): choose fidelity.mesh = flank"
        ),
        lambda given: OUT_OF_PLACE,
        lambda given: given.has_spheres,
    ),
    Rule(
        Code.SPHERES_AT_NUT,
        _on_yokenut,
        lambda breach: (
            f"the yokenut carries {breach.value:.0%} of the yoke's force on average, which spheres on a grid "
            f"show 8 % and more off (limit of general contact {AT_YOKENUT:.0%}): choose fidelity.mesh = flank"
        ),
        lambda given: AT_YOKENUT,
        lambda given: given.has_spheres and not given.is_shaken,
    ),
)
"""Limits of Exudyn's contact and of spheres, in a whole record."""

OF_BARS = (
    Rule(
        Code.WORK_MISSING,
        lambda given: given.numbers["work_missing"],
        lambda breach: (
            f"the error of the work balance is {breach.value:.1%} (limit {MOST_OF_WORK:.0%}); lower "
            "fidelity.step_angle"
        ),
        lambda given: MOST_OF_WORK,
    ),
    Rule(
        Code.TURN_TOO_FAST,
        lambda given: given.numbers["moved_by_inertia"],
        lambda breach: (
            f"the motion is too fast for equilibria: inertia may change the scene's main metric by "
            f"{breach.value:.0%} (limit {MOST_OF_TERMS:.0%}); choose generalized-alpha"
        ),
        lambda given: MOST_OF_TERMS,
        lambda given: "moved_by_inertia" in given.numbers,
    ),
)
"""Limits beyond which a run shows another motion: no level of the ladder shows the right one."""

VIBRATES = Rule(
    Code.PEAKS_UNRESOLVED,
    lambda given: given.numbers.get("vibration_grows", 0.0),
    lambda breach: (
        f"friction excites a vibration that grows {np.exp(min(breach.value, MOST_POWER)):.3g} times over a "
        "pass and that the steps damp: the errors of peak to peak values, ranges, largest and smallest "
        "values are unknown"
    ),
    lambda given: GROWN,
    status=Status.OK,
)
"""Eigenvalues along the path: no pair of levels shows a vibration that both damp."""


# --- Remarks ---------------------------------------------------------------------------------------


_remark = partial(Rule, status=Status.OK)


def _lifted(side: str, other: str) -> Rule:
    name = f"mesh_normal_force_{side}"
    return _remark(
        Code.FLANK_LIFTED,
        lambda given: given.signals[name] <= 0,
        lambda breach: (
            f"the {side} flanks carry no load in {breach.beyond.mean():.0%} of the record, first at "
            f"{breach.where}; all load is on the {other} flanks"
        ),
        applies=lambda given: name in given.signals,
    )


REMARKS = (
    _lifted("drive", "coast"),
    _lifted("coast", "drive"),
    _remark(
        Code.YOKE_STOPPED,
        lambda given: given.signals["yokenut_force"],
        lambda breach: (
            f"yoke.clearance = {1e6 * breach.given.gear.yoke.clearance:.4g} um is closed, first at "
            f"{breach.where}; the yokenut carries up to {breach.value:.4g} N; the error of the contact law "
            "is unknown there"
        ),
        applies=lambda given: "yokenut_force" in given.signals,
    ),
    _remark(
        Code.TEETH_OVERLOADED,
        lambda given: given.signals["mesh_pressure"],
        lambda breach: (
            f"the contact pressure is up to {1e-6 * breach.value:.4g} MPa (limit of case-hardened steel "
            f"{1e-6 * BEARABLE_PRESSURE:.4g} MPa, ISO 6336-5), first exceeded at {breach.where}; the model "
            "stays elastic"
        ),
        lambda given: BEARABLE_PRESSURE,
        lambda given: "mesh_pressure" in given.signals,
    ),
)
"""Limits of the gear that a run met."""

SHORT_BARS = (
    _remark(
        Code.BARS_SHORT,
        lambda given: largest_surplus(given.gear),
        lambda breach: (
            "friction is larger at rest, so that equilibria have more than one state: error bars may be too "
            "narrow"
        ),
        applies=lambda given: given.model.solver == "equilibrium",
    ),
    _remark(
        Code.BARS_SHORT,
        lambda given: float(_of_spheres(given)),
        lambda breach: "spheres of one gear share an error that no level shows: error bars may be too narrow",
    ),
)
"""Causes that levels share and no term of the bars carries; results/coverage has shares of metrics."""

CONTACT_LIMITS = frozenset({Code.FLANK_LIFTED, Code.YOKE_STOPPED})
"""Codes of a contact that opens or closes, beyond which numbers follow another law."""


def met_limit(codes: Iterable[str]) -> bool:
    """Return whether the remarks on a run are about a contact that opened or closed."""
    return not CONTACT_LIMITS.isdisjoint(codes)
