"""One part of a gear alone: what its law returns at coordinates of its bodies."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rps_exudyn.forces.force_element import Part
from rps_exudyn.solvers.coordinates import stacked
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.gear_model import COLUMNS


@dataclass(frozen=True)
class PartLaw:
    """A part of a gear whose rack is straight; all other bodies rest at zero."""

    forces: GearForces
    part: Part

    @classmethod
    def of(cls, forces: GearForces, name: str) -> "PartLaw":
        return cls(forces, next(part for part in forces.parts if part.name == name))

    @property
    def size(self) -> int:
        return self.part.size

    @property
    def columns(self) -> np.ndarray:
        """The places of its coordinates in the stack."""
        return stacked(self.part.bodies)

    def evaluate(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces, energy terms and own outputs at coordinates and rates (n,) of its bodies."""
        balance = self.forces.statics
        place, rate = np.zeros(balance.size), np.zeros(balance.size)
        place[self.columns], rate[self.columns] = q, v
        balance.force(place, rate)
        return np.array(balance.works[0]["out"][COLUMNS[self.part.name]])


def with_records(forces: GearForces, **records: Any) -> GearForces:
    """The forces of a gear with other records, by their names."""
    gears = forces.gears.copy()
    for name, record in records.items():
        gears[name] = record
    return replace(forces, gears=gears)
