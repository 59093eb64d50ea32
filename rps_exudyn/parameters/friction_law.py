"""How a part rubs: the friction law of the teeth, the plunger, the bush or the bearing, each chosen alone.

A new law is a name in `LawName` with its facts in `LAWS`, the parameters that it needs in `FrictionLaw`, and
its formula in `forces.friction`: other files ask for the facts.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.declaration import Length, Number, SlidingSpeed, Table, Time, parameter

LawName = Literal["coulomb", "stribeck", "bristle"]
RUBBING_PARTS = "mesh", "yoke", "bush", "bearing"  # of a gear, each with its law
MOST_ELEMENTS = 4  # elasto-plastic elements of a part with bristles
PLAIN_LAW: LawName = "coulomb"  # the size alone: of general contact, and of what rests after tapping


@dataclass(frozen=True)
class LawFacts:
    """What other files ask about a friction law."""

    falls: bool  # whether it may be larger at rest than in motion, by the static ratio
    # whether it depends on the motion before, by a state along the motion (`forces.friction`)
    has_state: bool
    at_speed: LawName  # the law that it becomes in steady sliding


LAWS: dict[LawName, LawFacts] = {
    "coulomb": LawFacts(falls=False, has_state=False, at_speed="coulomb"),
    "stribeck": LawFacts(falls=True, has_state=False, at_speed="stribeck"),
    "bristle": LawFacts(falls=True, has_state=True, at_speed="stribeck"),
}


class FrictionLaw(Table):
    """Friction of one part beyond its size; `friction_law` chooses what counts of the rest.

    `coulomb` has one size. `stribeck` is larger at rest than in motion. `bristle` (elasto-plastic elements)
    yields elastically before it slides and holds at rest; its static ratio of 1 leaves Stribeck's part out.
    """

    friction_law: LawName = parameter(
        "coulomb",
        "coulomb: constant coefficient; stribeck: larger at rest; bristle: elastic before it slides",
    )
    static_ratio: Number = parameter(1.0, "static over kinetic friction", ge=1, le=5)
    stribeck_speed: SlidingSpeed = parameter(
        "5 mm/s", "sliding speed at which the static surplus has fallen to 37 %", gt=0, le=10
    )
    stribeck_exponent: Number = parameter(2.0, "exponent of the speed in Stribeck's curve", ge=0.5, le=4)
    bristle_travel: Length = parameter(
        "5 um", "bristle: sliding distance of a first loading to 63 % of the friction", gt=0, le=1e-3
    )
    bristle_damping: Time = parameter(0.0, "bristle: damping over stiffness", ge=0, le=1e-2)

    @property
    def facts(self) -> LawFacts:
        """What other files ask about the law that is chosen."""
        return LAWS[self.friction_law]

    @property
    def surplus(self) -> float:
        """Static over kinetic friction, less 1."""
        return self.static_ratio - 1.0 if self.facts.falls else 0.0

    @property
    def varies_with_load(self) -> bool:
        """Whether it is not proportional to the normal force."""
        return False


def check_friction_laws(parts: Mapping[str, FrictionLaw], mesh: str) -> None:
    """Check that a model of the mesh has the laws of a gear's parts.

    Raises:
        InputError: it has not.
    """
    for part, law in parts.items():
        if law.facts.has_state and (mesh == "general-contact" or (part == "mesh" and mesh != "flank")):
            raise InputError(
                f"{part}.friction_law is {law.friction_law}, but fidelity.mesh = {mesh} has no "
                "bristles: choose fidelity.mesh = flank."
            )
    chosen = parts["mesh"].friction_law
    if chosen != PLAIN_LAW and mesh != "flank":
        raise InputError(
            f"mesh.friction_law is {chosen}, but fidelity.mesh = {mesh} has only {PLAIN_LAW}: "
            "choose fidelity.mesh = flank."
        )


def largest_surplus(gear: Any) -> float:
    """Return the largest static surplus of a gear's rubbing parts."""
    return max(getattr(gear, part).surplus for part in RUBBING_PARTS)


class LoadedFrictionLaw(FrictionLaw):
    """Friction of a part that is pressed on by what the gear transmits."""

    load_exponent: Number = parameter(
        1.0,
        "exponent of the normal force in the friction; the coefficient holds for the load under the yoke's "
        "preload",
        ge=0.5,
        le=1.5,
    )

    @property
    def varies_with_load(self) -> bool:
        """Whether it is not proportional to the normal force."""
        return self.facts.falls and self.load_exponent != 1.0


# --- files of earlier versions

SAME_REVERSAL = 0.687
"""Travel of one bristle's first loading over that of the law of earlier versions (LuGre) which turns about
over the same slip: ln 9 / 3.2, from -80 to 80 % of the friction; of four elements 0.514."""
TRAVEL_REMARK = (
    f"the file is of an earlier version: bristle_travel is {SAME_REVERSAL} times its value there, which "
    "keeps the angle of a reversal"
)


def of_this_version(
    gear: dict[str, Any], fidelity: Mapping[str, Any], message: str
) -> tuple[dict[str, Any], str]:
    """Return the tables of a gear that a file holds beside those of its model, and the file's message, with
    what replaces a travel of bristles whose meaning has changed since."""
    if "friction_elements" in fidelity:
        return gear, message
    with_state = [name for name, facts in LAWS.items() if facts.has_state]
    changed = {
        part: {**table, "bristle_travel": SAME_REVERSAL * table["bristle_travel"]}
        for part, table in gear.items()
        if isinstance(table, dict)
        and table.get("friction_law") in with_state
        and isinstance(table.get("bristle_travel"), float)
    }
    return gear | changed, "; ".join(filter(None, (message, TRAVEL_REMARK if changed else "")))
