"""What is modelled how: the presets, and every choice within them.

    full           what the paper models, all of it: general contact between the gear meshes, bush as a
                   chain of segments, plunger body, seat and yokenut contact, in Exudyn
    flank          analytic flank contact, bush condensed to its exact stiffness, the rest the same
    quasi-static   the same forces, in equilibrium at each pinion angle
    closed-form    formulas

Each part can be chosen alone, for instance `Fidelity.preset("flank").replace({"bush": "chain"})`.
"""

from collections.abc import Iterator, Mapping
from typing import Any, Literal, Self

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.declaration import Angle, Declared, Number, Problem, Table, parameter

CHAINS = ("chain", "adams-chain")


class Fidelity(Table):
    """One way to model and solve the gear."""

    name: str = parameter("flank", "preset this came from, and what was changed in it", "estimate")
    mesh: Literal["general-contact", "flank", "flank-generators", "ratio", "ratio-with-loss"] = parameter(
        "flank", "how the teeth touch", "estimate"
    )
    bush: Literal["chain", "adams-chain", "condensed", "rigid"] = parameter(
        "condensed", "how the bush is modelled", "estimate"
    )
    yoke: Literal["body", "force"] = parameter(
        "body",
        "how the yoke presses: a plunger on its seat, or spring and stop on the rack itself",
        "estimate",
    )
    rack: Literal["free", "guided"] = parameter(
        "free", "how the rack moves: in all six freedoms, or along X and Y only", "estimate"
    )
    solver: Literal["generalized-alpha", "equilibrium", "closed-form"] = parameter(
        "generalized-alpha", "how the motion is found", "estimate"
    )
    step_angle: Angle = parameter(
        "1 deg",
        "largest pinion rotation per time step or equilibrium; a record has at least four",
        "estimate",
        gt=0,
        le=np.deg2rad(40),
    )
    torque_tolerance: Number = parameter(
        0.0,
        "equilibrium: angles are added until the torque is known between them to this share of its mean; "
        "0 keeps the even steps",
        "estimate",
        ge=0,
        lt=1,
    )
    tolerance: Number = parameter(
        1e-4,
        "time steps: unbalanced force at which Newton's method stops, over the yoke's preload",
        "estimate",
        gt=0,
        le=0.01,
    )
    strip_stations: int = parameter(
        4, "flank: Gauss points along each segment of a line of contact", "estimate", ge=1, le=12
    )
    strip_points: int = parameter(
        2, "flank: Gauss points across the strip of contact", "estimate", ge=1, le=12
    )
    generators: int = parameter(
        160,
        "flank-generators: lines across each flank over which the contact is integrated",
        "estimate",
        ge=4,
        le=100000,
    )
    profile_samples: int = parameter(
        27, "general contact: spheres along the profile of a flank", "estimate", ge=2, le=2000
    )
    axial_samples: int = parameter(
        18, "general contact: rows of spheres along the face width", "estimate", ge=2, le=2000
    )
    zone_ratio: Number = parameter(
        0.1, "friction zone over the smallest sliding speed of the teeth", "estimate", gt=0, le=1
    )

    def conflicts(self) -> Iterator[Problem]:
        return _conflicts(self)

    @classmethod
    def declared(cls) -> Iterator[Declared]:
        """All choices; the name follows from them."""
        return (item for item in super().declared() if item.path != "name")

    @classmethod
    def preset(cls, name: str) -> Self:
        """A preset by its name.

        Raises:
            InputError: there is no such preset.
        """
        if name not in PRESETS:
            raise InputError(unknown_preset(name))
        return cls.model_validate({"name": name, **PRESETS[name]})

    def replace(self, settings: Mapping[str, object]) -> Self:
        """The same with single choices changed; the name says so: "full with bush condensed".

        Raises:
            InputError: an unknown choice, or a value that is not allowed.
        """
        return self.from_tables(self.model_dump(), {**settings, "name": name_of(self.name, settings)})


def unknown_preset(name: str) -> str:
    """The sentence about it."""
    return f"--fidelity is {name!r}; it must be one of {', '.join(PRESETS)}."


def name_of(base: str, changes: Mapping[str, object]) -> str:
    """A fidelity's name after these choices were changed in the one called `base`."""
    if not changes:
        return base
    told = ", ".join(f"{choice} {value}" for choice, value in changes.items())
    return f"{base}{', ' if ' with ' in base else ' with '}{told}"


def _conflicts(chosen: Fidelity) -> Iterator[Problem]:
    """Choices that are each fine alone, but not together."""
    if chosen.rack == "guided" and chosen.bush != "condensed":
        yield Problem(
            ("rack", "bush"),
            f"fidelity.bush is {chosen.bush}, but fidelity.rack is guided, whose bush only drags: "
            "leave it condensed.",
        )
    for choice, solver, understood, reason in _SOLVER_LIMITS:
        value = getattr(chosen, choice)
        if chosen.solver == solver and value not in understood:
            yield Problem(
                ("solver", choice),
                f"fidelity.{choice} is {value}, but fidelity.solver is {solver}, {reason}.",
            )


# What a solver cannot do: choice, solver, what it understands, and why
_SOLVER_LIMITS = (
    ("mesh", "closed-form", ("flank",), "whose formulas are those of flank contact"),
    (
        "bush",
        "closed-form",
        ("condensed",),
        "whose formulas know of the bush only its drag: leave it condensed",
    ),
    (
        "bush",
        "equilibrium",
        ("condensed", "rigid"),
        "where nothing swings: condensed is the chain's exact static stiffness",
    ),
)

PRESETS: dict[str, dict[str, Any]] = {
    "full": {"mesh": "general-contact", "bush": "chain", "step_angle": "0.3 deg"},
    "flank": {},
    "quasi-static": {"solver": "equilibrium"},
    "closed-form": {"solver": "closed-form", "step_angle": "5 deg"},
}
