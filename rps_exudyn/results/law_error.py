"""Error of the contact laws themselves, measured against finite elements of whole teeth.

    error = law_error(gear, result.fidelity)
    error.sentence, error.elastic_range(mean_torque)

It is what stays when all numerical errors are gone. The reference takes the compliance of whole teeth from
finite elements, flattening of each line by Hertz, and the loads of all lines together under unilateral
contact (`benchmarks/tooth_compliance.py`, eleven gears). The error of law "line" on plain flanks follows the
truncation t of the pinion's tips,

    T_line / T = 1 + (1.41 - 5.44 t) / 100 +- 0.75 %,    t = (r_p + (x + 1) m - r_a) / m.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.errors import as_sentence
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.parameters.retired import contact_law_of
from rps_exudyn.results.outcome import Code, Status

if TYPE_CHECKING:
    from rps_exudyn.results.result import Result

Range = tuple[float, float]


@dataclass(frozen=True)
class LawError:
    """Error of a contact law, as fractions: (least, largest) of law / elastic reference - 1."""

    law: str
    mean_torque: Range  # of the mean free torque
    efficiency: Range  # of the efficiency under load
    ripple: str  # of the free torque, in words
    expected: float | None = None  # of the mean free torque of the gear at hand

    @property
    def largest(self) -> float:
        """Largest error of the mean free torque either way, as a fraction."""
        return max(abs(each) for each in self.mean_torque)

    @property
    def sentence(self) -> str:
        return as_sentence(self.clause)

    @property
    def clause(self) -> str:
        """The error as the end of a sentence, without a full stop."""
        here = "" if self.expected is None else f", expected {100 * self.expected:+.2f} % on this gear"
        return (
            f"the contact law {self.law} is good to {100 * self.largest:.1g} %: compared with finite "
            f"elements of whole teeth its mean free torque deviates by {_shown(self.mean_torque)}{here}, its "
            f"efficiency under load by {_shown(self.efficiency)}; {self.ripple}"
        )

    def elastic_range(self, torque: float) -> Range:
        """Return between which values the elastic reference has a torque that the law gives [N m]."""
        low, high = sorted(torque / (1 + error) for error in self.mean_torque)
        return low, high


FOUND = "of the ripple found by finite elements"
MEASURED = {
    "line": LawError("line", (-0.014, 0.0195), (0.0, 0.0042), f"its ripple is 40 to 130 % {FOUND}"),
    "area": LawError("area", (0.012, 0.060), (-0.003, 0.0005), f"its ripple is 50 to 85 % {FOUND}"),
    "teeth": LawError("teeth", (-0.006, 0.006), (-0.001, 0.0022), f"its ripple is 70 to 115 % {FOUND}"),
}
"""Law -> its error on eleven gears, plain and with tip relief and crowning."""
BY_TRUNCATION, WITHIN = (0.0141, -0.0544), 0.0075  # of law "line" on plain flanks: at no truncation, per t


def law_error(gear: SteeringGear, fidelity: Mapping[str, Any]) -> LawError | None:
    """Return the error of the contact law that a model takes; None for one without a law of contact.

    `fidelity` has the choices of the model by name, as `Result.fidelity`.
    """
    law = contact_law_of(fidelity.get("mesh", "flank"), gear.mesh.contact_law)
    if law is None:
        return None
    taken, pinion = law_of_formulas(law) if fidelity.get("solver") == "closed-form" else law, gear.pinion
    if taken != "line" or pinion.tip_relief or pinion.crowning or pinion.profile_slope or pinion.deviation:
        return MEASURED[taken]
    expected = BY_TRUNCATION[0] + BY_TRUNCATION[1] * tip_truncation(gear)
    return replace(MEASURED["line"], expected=expected, mean_torque=(expected - WITHIN, expected + WITHIN))


def error_of_law(result: "Result") -> LawError | None:
    """Return the error of the contact law in a run that ended ok; None where the yoke touches its nut.

    There the force on the teeth follows from their stiffness, not from the preload, and the laws differ by up
    to a third (`benchmarks/law_on_gears.py`).
    """
    if result.status is not Status.OK or Code.YOKE_STOPPED in result.codes:
        return None
    return law_error(result.gear, result.fidelity)


def tip_truncation(gear: SteeringGear) -> float:
    """Return t = (r_p + (x + 1) m - r_a) / m: by how much the tips are shorter than standard, in modules."""
    pinion = gear.pinion
    module = pinion.normal_module
    reference = pinion.teeth * module / (2 * cos(pinion.helix_angle))
    return (reference + (pinion.profile_shift + 1) * module - pinion.tip_diameter / 2) / module


def law_of_formulas(law: str) -> str:
    """Return the law by which the closed form distributes the load, which has no bending teeth."""
    return "line" if law == "teeth" else law


def _shown(errors: Range) -> str:
    low, high = (100 * each for each in errors)
    return f"{low:+.2g} to {high:+.2g} %"
