"""A bar that is bent before it is loaded: the bow of its toothed part.

    offset ^          ______                  `size` is the height of the middle over the chord of the
           |      .--'      '--.              toothed part; outside it the bar goes on straight along
           |    .'   size |     '.            the tangents
      -----+---/----------+-------\\-----> X
           .-'            0        '-.

The rack frame goes with the middle of the toothed part, where offset and gradient are 0: the ends lie `size`
and more behind it. A half wave is size cos(pi X / L), an arc of a circle, flat as it is, the parabola
size (1 - 4 X^2 / L^2), with L the length of the toothed part.

The bow is a displacement of the stress-free bar by station. It is the same for a rigid bar and for one that
bends: the deflections of modes add to it.
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.gears.rack_beam import ELEMENTS, RackBeam, hermite
from rps_exudyn.parameters.gear import SteeringGear


@dataclass(frozen=True, eq=False)
class BarBow:
    """Offset of the bar's line in the planes y and z by station, for cubic Hermite interpolation.

    The section turns with the line: offsets have `gradient` as derivative, rotations are `gradient` and have
    `curvature` as derivative; each of shape (2, nodes).
    """

    nodes: np.ndarray  # stations along the bar, those of its modes [m]
    offset: np.ndarray  # [m]
    gradient: np.ndarray  # [rad]
    curvature: np.ndarray  # [1/m]

    @classmethod
    def of(cls, gear: SteeringGear) -> "BarBow":
        """The bow of a gear's rack."""
        beam, rack = RackBeam.of(gear), gear.rack
        nodes = np.linspace(beam.stations[0], beam.stations[-1], ELEMENTS + 1)
        length = beam.stations[2] - beam.stations[1]
        line = {"half-wave": _half_wave, "arc": _arc}[rack.bow_shape]
        half = np.clip(nodes, -length / 2, length / 2)
        offset, gradient, curvature = rack.bow * line(half, length)
        offset = offset + gradient * (nodes - half)
        curvature = np.where(np.abs(nodes) < length / 2, curvature, 0)
        direction = np.array([[np.cos(rack.bow_angle)], [np.sin(rack.bow_angle)]])
        return cls(nodes, direction * offset, direction * gradient, direction * curvature)

    @property
    def straight(self) -> bool:
        return not self.offset.any()

    def at(self, station: float) -> np.ndarray:
        """Offset, its derivative, rotation, its derivative in both planes at a station, shape (4, 2)."""
        offset = hermite(self.nodes, self.offset, self.gradient, station)
        return np.concatenate([offset, hermite(self.nodes, self.gradient, self.curvature, station)])


def _half_wave(x: np.ndarray, length: float) -> np.ndarray:
    """Offset from the middle, gradient and curvature over the height of the bow, shape (3, n)."""
    phase = np.pi / length
    return np.stack([np.cos(phase * x) - 1, -phase * np.sin(phase * x), -(phase**2) * np.cos(phase * x)])


def _arc(x: np.ndarray, length: float) -> np.ndarray:
    """The same of an arc."""
    bend = 8 / length**2
    return np.stack([-bend * x**2 / 2, -bend * x, np.full_like(x, -bend)])
