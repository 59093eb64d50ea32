"""Error of the contact laws themselves, measured against finite elements of whole teeth.

    error = law_error(gear, result.fidelity)
    error.sentence, error.elastic_range(mean_torque)

It is what stays when all numerical errors are gone. The reference is an elastic model of the whole mesh: six
helical pinion teeth on their core and a round rack bar with seven teeth of quadratic hexahedra, flattening of
each line by Hertz, loads of all lines found together under unilateral contact. Compared were the default gear
at 150 to 1500 N of preload, at friction 0.05 to 0.2 and at 5, 10 and 30 N m of load, and three gears of other
profile shift and tip diameter, with the rack guided and free. docs/accuracy.md has the same for users.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rps_exudyn.base.errors import as_sentence
from rps_exudyn.parameters.gear import SteeringGear

Range = tuple[float, float]


@dataclass(frozen=True)
class LawError:
    """Error of a contact law, as fractions: (least, largest) of law / elastic reference - 1."""

    law: str
    mean_torque: Range  # of the mean free torque
    efficiency: Range  # of the efficiency under load
    ripple: str  # of the free torque, in words

    @property
    def largest(self) -> float:
        """Largest error of the mean free torque either way, as a fraction."""
        return max(abs(each) for each in self.mean_torque)

    @property
    def sentence(self) -> str:
        """The error as a sentence."""
        return as_sentence(self.clause)

    @property
    def clause(self) -> str:
        """The error as the end of a sentence, without a full stop."""
        return (
            f"the contact law {self.law} is good to {100 * self.largest:.1g} %: against finite elements of "
            f"whole teeth its mean free torque is off by {_shown(self.mean_torque)}, its efficiency "
            f"under load by {_shown(self.efficiency)}; {self.ripple}"
        )

    def elastic_range(self, torque: float) -> Range:
        """Return between which values the elastic reference has a torque that the law gives [N m]."""
        low, high = sorted(torque / (1 + error) for error in self.mean_torque)
        return low, high


MEASURED = {
    "line": LawError("line", (-0.010, 0.011), (0.0015, 0.003), "it has 55 to 70 % of their ripple"),
    "area": LawError("area", (0.012, 0.053), (-0.003, 0.0005), "it has 50 to 85 % of their ripple"),
    "teeth": LawError("teeth", (-0.004, 0.004), (-0.001, 0.001), "it has their ripple"),
}
"""Law -> its error. Constants of law "teeth" were fitted to the same reference; 0.4 % is what they keep."""


def law_error(gear: SteeringGear, fidelity: Mapping[str, Any]) -> LawError | None:
    """Return the error of the contact law that a model takes; None for one without a law of contact.

    Args:
        gear: its `mesh.law` is taken where the model has it.
        fidelity: choices of the model by name, as `Result.fidelity` has them.
    """
    mesh = fidelity.get("mesh", "flank")
    if mesh.startswith("ratio"):
        return None
    law = "area" if mesh == "flank-generators" else gear.mesh.law
    return MEASURED[law_of_formulas(law) if fidelity.get("solver") == "closed-form" else law]


def law_of_formulas(law: str) -> str:
    """Return the law by which the closed form distributes the load, which has no bending teeth."""
    return "line" if law == "teeth" else law


def _shown(errors: Range) -> str:
    low, high = (100 * each for each in errors)
    return f"{low:+.2g} to {high:+.2g} %"
