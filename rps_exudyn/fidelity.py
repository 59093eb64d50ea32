"""What is modelled how: the presets, and every choice within them.

    full           what the paper models, all of it: general contact between the gear meshes, bush as a
                   chain of segments, plunger body, seat and yokenut contact, in Exudyn
    flank          analytic flank contact, bush condensed to its exact stiffness, the rest the same
    quasi-static   the same forces, in equilibrium at each pinion angle
    closed-form    formulas

Each part can be chosen alone, for instance `Fidelity.preset("flank").replace({"bush": "chain"})`.
"""

from collections.abc import Mapping
from typing import Any, Literal, Self

from rps_exudyn.declaration import Angle, Number, Table, parameter
from rps_exudyn.errors import InputError


class Fidelity(Table):
    """One way to model and solve the gear."""

    name: str = parameter("flank", "preset this came from, and what was changed in it", "estimate")
    mesh: Literal["general-contact", "flank", "ratio", "ratio-with-loss"] = parameter(
        "flank", "how the teeth touch", "estimate"
    )
    bush: Literal["chain", "adams-chain", "condensed", "rigid"] = parameter(
        "condensed", "how the bush is modelled", "estimate"
    )
    solver: Literal["generalized-alpha", "equilibrium", "closed-form"] = parameter(
        "generalized-alpha", "how the motion is found", "estimate"
    )
    step_angle: Angle = parameter(
        "0.3 deg", "pinion rotation per time step or equilibrium", "estimate", gt=0, lt=0.2
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

    @classmethod
    def preset(cls, name: str) -> Self:
        """A preset by its name.

        Raises:
            InputError: there is no such preset.
        """
        if name not in PRESETS:
            raise InputError(f"--fidelity is {name!r}; it must be one of {', '.join(PRESETS)}.")
        return cls.model_validate({"name": name, **PRESETS[name]})

    def replace(self, settings: Mapping[str, object]) -> Self:
        """The same with single choices changed; the name says so: "full with bush condensed".

        Raises:
            InputError: an unknown choice, or a value that is not allowed.
        """
        changes = ", ".join(f"{choice} {value}" for choice, value in settings.items())
        if not changes:
            return self
        separator = ", " if " with " in self.name else " with "
        return super().replace({**settings, "name": f"{self.name}{separator}{changes}"})


PRESETS: dict[str, dict[str, Any]] = {
    "full": {"mesh": "general-contact", "bush": "chain", "step_angle": "0.1 deg"},
    "flank": {},
    "quasi-static": {"solver": "equilibrium", "step_angle": "1 deg"},
    "closed-form": {"solver": "closed-form", "step_angle": "5 deg"},
}
