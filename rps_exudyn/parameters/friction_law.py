"""How a part rubs: the friction law of the teeth, the plunger, the bush or the bearing, each chosen alone."""

from typing import Literal

from rps_exudyn.parameters.declaration import Length, Number, SlidingSpeed, Table, Time, parameter

LawName = Literal["coulomb", "stribeck", "bristle"]
RUBBING_PARTS = "mesh", "yoke", "bush", "bearing"  # of a gear, each with its law


class FrictionLaw(Table):
    """Friction of one part beyond its size; `friction_law` chooses what counts of the rest.

    `coulomb` knows the size alone. `stribeck` is larger at rest than in motion. `bristle` (LuGre) yields
    elastically before it slides and holds at rest; its static ratio of 1 leaves Stribeck's part out.
    """

    friction_law: LawName = parameter(
        "coulomb",
        "coulomb: size alone; stribeck: larger at rest; bristle: yields before it slides, remembers",
        "estimate",
    )
    static_ratio: Number = parameter(1.0, "static over kinetic friction", "estimate", ge=1, le=5)
    stribeck_speed: SlidingSpeed = parameter(
        "5 mm/s", "sliding speed at which most of the static surplus is gone", "estimate", gt=0, le=10
    )
    stribeck_exponent: Number = parameter(
        2.0, "exponent of the speed in Stribeck's curve", "estimate", ge=0.5, le=4
    )
    bristle_travel: Length = parameter(
        "5 um", "bristle: sliding over which friction turns about, its load over its stiffness", "estimate",
        gt=0, le=1e-3,
    )  # fmt: skip
    bristle_damping: Time = parameter(0.0, "bristle: damping over stiffness", "estimate", ge=0, le=1e-2)


class LoadedFrictionLaw(FrictionLaw):
    """Friction of a part that is pressed on by what the gear transmits."""

    load_exponent: Number = parameter(
        1.0,
        "exponent of the normal force in the friction, which is the coefficient's under the yoke's preload",
        "estimate",
        ge=0.5,
        le=1.5,
    )
