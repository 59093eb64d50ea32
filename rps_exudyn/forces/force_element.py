"""What a part's force law returns, and the order in which the coordinates of the bodies are stacked.

A law reads coordinates q and rates v of its bodies, and fills the generalised forces on them, then the energy
terms (stored energy and dissipated powers), then values of its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

# The energy terms, behind the generalised forces in every part's output [J, W, W]
ELASTIC_ENERGY, FRICTION_POWER, DAMPING_POWER = 0, 1, 2
ENERGY_TERMS = 3
# What parts that rub return behind all others [J]: what friction with a state has lost so far, and what it
# stores, which is part of the elastic energy
FRICTION_STATE = "friction_lost", "friction_stored"

COORDINATES = {"pinion": 1, "rack": 6, "plunger": 1, "segment": 6}


@dataclass(frozen=True)
class Part:
    """A part of the gear that exerts forces."""

    name: str  # of the part, as in the results
    # the bodies on whose coordinates it acts, in the order in which their forces are stacked
    bodies: tuple[str, ...]
    outputs: tuple[str, ...] = ()  # names of the values behind the energy terms

    @cached_property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(COORDINATES[body] for body in self.bodies)

    @cached_property
    def stacked(self) -> np.ndarray:
        """Indices of its coordinates in the stack, (size,)."""
        return stacked(self.bodies)

    @property
    def columns(self) -> int:
        """Number of its outputs: forces, energy terms, own values."""
        return self.size + ENERGY_TERMS + len(self.outputs)


# --- The order in which the coordinates of the bodies are stacked

COORDINATE_BLOCKS = {
    "pinion": slice(0, 1),
    "rack": slice(1, 7),
    "plunger": slice(7, 8),
    "segment": slice(8, 14),
}
PINION, RACK, PLUNGER = (COORDINATE_BLOCKS[body].start for body in ("pinion", "rack", "plunger"))


def stacked(bodies: Sequence[str]) -> np.ndarray:
    """Indices of some bodies' coordinates in the stack, in the order of the bodies."""
    return np.concatenate([np.r_[COORDINATE_BLOCKS[body]] for body in bodies]).astype(int)
