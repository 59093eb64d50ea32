"""Numbers of a design that goals and constraints are about: metrics of scenes, requirements, parameters."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from rps_exudyn.assessment.requirements.judging import (
    BY_GEOMETRY,
    BY_RUNS,
    RATED_TORQUE,
    borne_under,
    settings_of_test,
)
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.tooth_strength import (
    RootTeeth,
    flank_stress,
    pinion_teeth,
    rack_teeth,
    root_load_factor,
    root_stress,
    weakest,
)
from rps_exudyn.parameters.gear import BY_SCENE, SteeringGear
from rps_exudyn.results.limit import Limit
from rps_exudyn.results.quantities import SUMMARY, Quantity
from rps_exudyn.results.requirements import REQUIRED


def _root(teeth_of: Callable[[SteeringGear], RootTeeth]) -> Callable[[SteeringGear, float], float]:
    """Return the root's stress over gear and face load factor, as the requirement sheet has it."""

    def stress(gear: SteeringGear, factor: float) -> float:
        local, form = weakest(teeth_of(gear), RATED_TORQUE)
        return root_load_factor(GearPair.of(local), form, factor) * root_stress(local, form, RATED_TORQUE)

    return stress


STRESSES: Mapping[str, Callable[[SteeringGear, float], float]] = {
    "rated_root_pinion": _root(pinion_teeth),
    "rated_root_rack": _root(rack_teeth),
    "rated_flank": lambda gear, factor: float(np.sqrt(factor)) * flank_stress(gear, RATED_TORQUE),
}
"""Requirement -> its number at the rated torque, from the gear and its face load factor."""


@dataclass(frozen=True)
class Number:
    """One number of a design.

    Attributes:
        name: in the file.
        of: metric, requirement or path of a parameter.
        scene: that has the metric; "" where no run is needed.
        settings: (path, value) of the test, beside the file's own.
        quantile: of the series, 0 to 1; None: of the gear without errors.
    """

    name: str
    of: str
    scene: str = ""
    settings: tuple[tuple[str, Any], ...] = ()
    quantile: float | None = None

    @property
    def metric(self) -> str:
        """Name of the metric in the scene's summary."""
        return BY_RUNS[self.of][1] if self.of in BY_RUNS else self.of

    @property
    def quantity(self) -> Quantity:
        """Its unit and meaning."""
        if self.of in SUMMARY or self.of in REQUIRED:
            return {**REQUIRED, **SUMMARY}[self.of]
        (declared,) = SteeringGear.declared_at(self.of)
        unit = declared.unit
        return Quantity(unit.si if unit else "", unit.display if unit else "", declared.meaning)

    @property
    def words(self) -> str:
        """What it is, for a reader."""
        where = (
            f"{100 * self.quantile:g} % quantile of the series" if self.quantile is not None else "nominal"
        )
        return f"{self.name} ({where})" if self.scene else self.name

    def is_at_most(self, other: "Number") -> bool:
        """Return whether this number is no larger than the other one in every series."""
        if (self.of, self.scene, self.settings) != (other.of, other.scene, other.settings):
            return False
        mine, its = self.quantile, other.quantile
        return mine == its or (mine is not None and its is not None and mine <= its)

    def settings_of(self, gear: SteeringGear) -> dict[str, Any]:
        """Return what is set for its run."""
        own = settings_of_test(gear, self.scene, RATED_TORQUE) if self.of in BY_RUNS else {}
        return own | dict(self.settings)

    def by_formula(self, gear: SteeringGear, face_load_factor: float) -> float | None:
        """Return the number of a gear that needs no run of the series; None of a metric.

        Raises:
            InputError: the gear does not let it compute.
        """
        if self.of in STRESSES:
            return STRESSES[self.of](gear, face_load_factor)
        if self.of in BY_GEOMETRY:
            return float(BY_GEOMETRY[self.of](gear))
        return None if self.scene else float(gear.value_at(self.of))


@lru_cache(maxsize=4)  # three stresses of one gear ask for it
def face_load_factor(gear: SteeringGear) -> float:
    """Return how unevenly the face bears the rated torque: by a run that costs more than a series."""
    return borne_under(gear.replace({"mesh.law": BY_SCENE}), RATED_TORQUE).factor  # as the sheet's


@dataclass(frozen=True)
class Objective:
    """A number that is to be least, or most."""

    number: Number
    sense: int  # +1: least, -1: most


@dataclass(frozen=True)
class Constraint:
    """A number that is to keep a limit."""

    number: Number
    limit: Limit

    def excess(self, value: float) -> float:
        """Return by how much a value misses the limit, over the limit's size; below 0: it keeps it."""
        size = max(self.limit.finite, 1e-30)
        return float(max(value - self.limit.most, self.limit.least - value) / size)
