"""One part of a gear alone: what its law returns at coordinates of its bodies; a gear of that part alone."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rps_exudyn.forces.force_element import Part, stacked
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.gear_model import COLUMNS

FAR = 5e-3  # [m], by which rack and pinion, or plunger and rack, do not touch


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


def alone(forces: GearForces, name: str) -> GearForces:
    """The forces of a gear of which one part alone exerts any."""
    gears = forces.gears.copy()
    if name != "mesh":
        gears["mesh"]["flank"]["rack_reference"][:, 1] += FAR
        gears["mesh"]["spheres"]["gate"] = -1.0
    if name != "seat":
        gears["seat"]["rest_gap"] = -FAR
    if name != "bush":
        gears["fit"]["stiffness"] = gears["fit"]["drag"] = 0.0
    if name != "bearing":
        gears["bearing"]["torque"] = 0.0
    gears["spring"]["rate"] = gears["spring"]["preload"] = gears["nut"]["stiffness"] = 0.0
    return replace(forces, gears=gears)
