"""What is modelled how: the presets, and every choice within them.

Each part can be chosen alone, for instance `Fidelity.preset("flank").replace({"bush": "chain"})`.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache, partial
from typing import Any, Literal, Self

from pydantic import computed_field, model_validator

from rps_exudyn.base.errors import InputError, check_kind
from rps_exudyn.parameters.declaration import (
    DEG,
    Angle,
    Declared,
    Length,
    Number,
    Table,
    all_declared,
    parameter,
)
from rps_exudyn.parameters.friction_law import MOST_ELEMENTS
from rps_exudyn.parameters.retired import PARAMETERS
from rps_exudyn.parameters.wrong_values import WrongValue

choice = partial(parameter, source="choice")
LEAST_SWING_STEPS = 5  # fewer do not see an impact
PresetName = Literal["full", "flank", "quasi-static", "reduced", "closed-form"]


class Fidelity(Table):
    """One way to model and solve the gear. Angles are rad, or text with a unit.

    Raises:
        InputError: choices that are unknown, out of their limits, or exclude each other.

    Examples:
        >>> rps.Fidelity.preset("quasi-static").replace({"step_angle": "2 deg"}).solver
        'equilibrium'
    """

    based_on: PresetName = choice("flank", "preset whose choices these are except for changed ones")
    mesh: Literal["general-contact", "triangles", "flank"] = choice("flank", "contact model of the teeth")
    bush: Literal["chain", "condensed", "rigid"] = choice(
        "condensed", "bush model: chain of segments, condensed stiffness, or rigid"
    )
    rack: Literal["by-scene", "free", "guided", "flexible"] = choice(
        "by-scene",
        "rack model: free (rigid), guided (rigid, X and Y only), flexible (bends), by-scene (flexible "
        "where the scene needs it, else free)",
    )
    pinion: Literal["by-scene", "rigid", "supported"] = choice(
        "by-scene",
        "pinion support: rigid (it only turns), supported (on two bearings), by-scene (supported where the "
        "scene needs it)",
    )
    solver: Literal["generalized-alpha", "equilibrium", "reduced", "closed-form"] = choice(
        "generalized-alpha",
        "solver: dynamics (generalized-alpha), equilibrium at each instant, a table of equilibria with one "
        "inertia (reduced), or formulas (closed-form)",
    )
    step_angle: Angle = choice(
        "1 deg",
        "largest pinion rotation per time step or equilibrium; a record has at least four steps",
        ge=0.001 * DEG,  # the rack's travel takes a million of them
        le=40 * DEG,
    )
    swing_steps: int = choice(
        0,
        "yoke-impact and rattle: time steps per vibration of the plunger between seat and yokenut, the "
        "fastest motion; 0: the scene's default",
        ge=0,
        le=1000,
    )
    tolerance: Number = choice(
        1e-4,
        "time steps: unbalanced force over the yoke's preload at which Newton's method stops",
        gt=0,
        le=0.01,
    )
    strip_stations: int = choice(
        8, "flank: Gauss points along each segment of a line of contact; law teeth adds one", ge=1, le=32
    )
    strip_points: int = choice(2, "flank: Gauss points across the strip of contact", ge=1, le=32)
    profile_samples: int = choice(27, "general contact: spheres along the profile of a flank", ge=2, le=2000)
    axial_samples: int = choice(18, "general contact: rows of spheres along the face width", ge=2, le=2000)
    chord_error: Length = choice(
        "0.1 um", "triangles: largest distance of the pinion's triangles from its flanks", gt=0, le=1e-5
    )
    zone_ratio: Number = choice(
        0.001, "width of the friction zone over the smallest sliding speed of the teeth", gt=0, le=1
    )

    friction_elements: int = choice(
        1,
        "bristle: elasto-plastic elements of each part; more elements give a smoother first loading",
        ge=1,
        le=MOST_ELEMENTS,
    )

    @computed_field  # type: ignore[prop-decorator]
    @property
    def name(self) -> str:
        """The preset and what was changed in it: "full with bush condensed"."""
        return self._named(all_declared(Fidelity).values())

    @property
    def model(self) -> str:
        """The preset and the parts that are others in it, without its numbers: "full with bush condensed"."""
        choices = all_declared(Fidelity).values()
        return self._named(item for item in choices if isinstance(getattr(self, item.path), str))

    def _named(self, choices: Iterable[Declared]) -> str:
        usual = Fidelity.preset(self.based_on)
        changes = [
            f"{item.path} {item.show(value)}"
            for item in choices
            if (value := getattr(self, item.path)) != getattr(usual, item.path)
        ]
        return f"{self.based_on} with {', '.join(changes)}" if changes else self.based_on

    @model_validator(mode="before")
    @classmethod
    def _from_stored(cls, tables: Any) -> Any:
        """Read what was stored: the name follows from the choices; in old files it names the preset."""
        if not isinstance(tables, Mapping):
            return tables
        if "name" not in tables:
            return {choice: value for choice, value in tables.items() if (choice, value) != ("yoke", "body")}
        preset = str(tables["name"]).partition(" ")[0]
        known = {"based_on": preset} if preset in PRESETS else {}
        gone = {"name", *(path.removeprefix("fidelity.") for path in PARAMETERS)}
        return known | {choice: value for choice, value in tables.items() if choice not in gone}

    def __repr__(self) -> str:
        return f"<Fidelity: {self.name}>"

    def conflicts(self) -> Iterator[WrongValue]:
        """Yield choices that are each fine alone, but not together."""
        if 0 < self.swing_steps < LEAST_SWING_STEPS:
            yield WrongValue(
                ("swing_steps",),
                f"fidelity.swing_steps is {self.swing_steps}; it must be 0, for the scene's own, or at least "
                f"{LEAST_SWING_STEPS}.",
            )
        for (other, needing), part, possible, reason in _LIMITS:
            value = getattr(self, part)
            if getattr(self, other) == needing and value not in possible.split():
                sentence = f"fidelity.{part} is {value}, but fidelity.{other} is {needing}, {reason}."
                yield WrongValue((other, part), sentence)

    @property
    def bends_teeth(self) -> bool:
        """Whether the model can have teeth that bend: neither formulas nor spheres do."""
        return self.mesh == "flank" and self.solver != "closed-form"

    def with_bending(self) -> Self:
        """Return the choices of a scene that needs a flexible rack: it bends unless another is chosen, or is
        part of a model that has rigid ones only."""
        can = self.mesh != "general-contact" and self.bush != "chain"
        return self.replace({"rack": "flexible"}) if self.rack == "by-scene" and can else self

    def with_condensed_chain(self) -> Self:
        """Return the choices of what nearly stands still: a chain yields as the condensed bush."""
        return self.replace({"bush": "condensed"}) if self.bush == "chain" else self

    def with_support(self, needed: bool) -> Self:
        """Return the choices of a scene with the pinion on bearings if it needs them and no other is chosen,
        nor a part of a model whose pinion is rigid."""
        can = self.mesh != "general-contact" and self.solver != "closed-form"
        return self.replace({"pinion": "supported"}) if self.pinion == "by-scene" and needed and can else self

    @classmethod
    def declared(cls) -> Iterator[Declared]:
        """Yield all choices; the preset is where they came from, and not one of them."""
        return (item for item in super().declared() if item.path != "based_on")

    @staticmethod
    def preset(name: str) -> "Fidelity":
        """Return the preset of that name.

        Raises:
            InputError: there is no such preset.
        """
        if not isinstance(name, str) or name not in PRESETS:
            raise InputError(unknown_preset(name))
        return _preset(name)


def check_fidelity(fidelity: object) -> None:
    """Check that an argument is a name or a `Fidelity`.

    Raises:
        InputError: it is something else.
    """
    check_kind("fidelity", fidelity, str | Fidelity, f"one of {', '.join(PRESETS)}, or a Fidelity")


def unknown_preset(name: str) -> str:
    """Return the sentence about a preset that does not exist."""
    return f"fidelity is {name!r}; it must be one of {', '.join(PRESETS)}."


def preset_table(name: str) -> dict[str, Any]:
    """Return the choices of a preset, as a table of a fidelity."""
    return {"based_on": name, **PRESETS[name]}


@cache
def _preset(name: str) -> Fidelity:
    return Fidelity.model_validate(preset_table(name))


_LIMITS = (
    (("rack", "guided"), "bush", "condensed", "which has only the drag of the bush: leave it condensed"),
    (
        ("rack", "flexible"), "bush", "condensed rigid",
        "whose bush is condensed to its exact stiffness: leave it condensed",
    ),
    (
        ("rack", "flexible"), "mesh", "flank triangles",
        "which has only rigid bodies: choose fidelity.mesh = flank",
    ),
    (
        ("pinion", "supported"), "mesh", "flank triangles",
        "which general contact does not offer: choose fidelity.mesh = flank",
    ),
    (("solver", "closed-form"), "mesh", "flank", "whose formulas are those of flank contact"),
    (
        ("solver", "closed-form"), "bush", "condensed",
        "whose formulas contain only the bush's drag: leave it condensed",
    ),
    (("solver", "closed-form"), "pinion", "by-scene rigid", "whose formulas let the pinion only turn"),
    (("solver", "closed-form"), "rack", "by-scene free guided", "whose formulas contain no bending"),
    (("solver", "reduced"), "mesh", "flank", "whose table is that of flank contact"),
    (
        ("solver", "reduced"), "bush", "condensed rigid",
        "whose table is one of equilibria: leave it condensed",
    ),
    (
        ("solver", "equilibrium"), "bush", "condensed rigid",
        "which needs no segments; condensed has the exact static stiffness of the chain",
    ),
)  # fmt: skip
"""A choice, another part, the choices of that one that go with it, and why others do not."""

PRESETS: dict[str, dict[str, Any]] = {
    "full": {"mesh": "general-contact", "bush": "chain"},
    "flank": {},
    "quasi-static": {"solver": "equilibrium"},
    "reduced": {"solver": "reduced"},
    "closed-form": {"solver": "closed-form", "step_angle": "5 deg"},
}

MEAN_STEP = 2 * DEG
"""Step of equilibria for bands, fits, comparisons [rad]: the mean to 0.001 %, the peak to peak to 0.1 %."""
FOR_MEANS = Fidelity.preset("quasi-static").replace({"step_angle": MEAN_STEP})
"""The model of bands, fits and comparisons where no other is chosen."""
