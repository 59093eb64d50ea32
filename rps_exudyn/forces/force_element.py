"""What a part's force law returns: the order of its outputs.

A law reads coordinates q and rates v of its bodies, and fills the generalised forces on them, then the energy
terms (stored energy and dissipated powers), then values of its own.
"""

from dataclasses import dataclass

# The energy terms, behind the generalised forces in every part's output [J, W, W]
ELASTIC_ENERGY, FRICTION_POWER, DAMPING_POWER = 0, 1, 2
ENERGY_TERMS = 3

COORDINATES = {"pinion": 1, "rack": 6, "plunger": 1, "segment": 6}


@dataclass(frozen=True)
class Part:
    """A part of the gear that exerts forces.

    Attributes:
        name: of the part, as in the results.
        bodies: the bodies on whose coordinates it acts, in the order in which their forces are stacked.
        outputs: names of the values behind the energy terms.
    """

    name: str
    bodies: tuple[str, ...]
    outputs: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(COORDINATES[body] for body in self.bodies)

    @property
    def columns(self) -> int:
        """Number of its outputs: forces, energy terms, own values."""
        return self.size + ENERGY_TERMS + len(self.outputs)
