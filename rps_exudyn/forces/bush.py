"""The bush: a hollow cylinder as a chain of rigid segments held by connector springs.

    housing |=[ 1 ]=[ 2 ]= ... =[ N ]=  - - rack - -        '=' elastic connections
              far end              near end, free

Each connection carries the compliance of the beam between two segment centres (at the ends: from a
centre to the end face). Taken at the middle of that piece, a Timoshenko beam's stiffness is diagonal: a
lateral force there turns nothing, a moment shifts nothing. So the chain is made of springs that act at
one point of both neighbours, which balances forces and moments; its static deflection under loads at the
tip is exactly the beam's, whatever the number of segments.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from rps_exudyn.parameters.gear import SteeringGear

RIGID_END = np.array([1e8, 1e8, 1e8, 1e4, 1e4, 1e4])  # fit on a segment that is rigid to its end [N/m, N m]
THIN_TUBE_SHEAR = 2.0  # A / A_s of a thin-walled tube


@dataclass(frozen=True)
class Tube:
    """Section of the bush and its Timoshenko stiffness."""

    axial: float  # E A [N]
    shear: float  # G A_s [N]
    torsion: float  # G J [N m^2]
    bending: float  # E I [N m^2]

    @classmethod
    def of(cls, gear: SteeringGear) -> "Tube":
        """The gear's bush as a thin-walled tube."""
        bush = gear.bush
        outer, inner = bush.outer_diameter / 2, bush.inner_diameter / 2
        area = np.pi * (outer**2 - inner**2)
        inertia = np.pi / 4 * (outer**4 - inner**4)
        shear_modulus = bush.youngs_modulus / (2 * (1 + bush.poisson_ratio))
        return cls(
            axial=bush.youngs_modulus * area,
            shear=shear_modulus * area / THIN_TUBE_SHEAR,
            torsion=shear_modulus * 2 * inertia,
            bending=bush.youngs_modulus * inertia,
        )

    def connection(self, length: float) -> np.ndarray:
        """Stiffness of a piece at its middle, shape (6,): along x, y, z, about x, y, z.

        Lateral compliance at the middle: h^3 / (12 E I) + h / (G A_s); bending compliance h / (E I).
        """
        lateral = 1 / (length**3 / (12 * self.bending) + length / self.shear)
        bending = self.bending / length
        return np.array([self.axial / length, lateral, lateral, self.torsion / length, bending, bending])


@dataclass(frozen=True)
class Connection:
    """An elastic connection between neighbours of the chain; index -1 is the housing."""

    before: int
    after: int
    station: float  # distance from the held end [m]
    stiffness: np.ndarray  # diagonal at that station, shape (6,)


@dataclass(frozen=True)
class Chain:
    """A cantilever made of rigid segments; stations count from the held end [m]."""

    length: float
    centres: np.ndarray
    connections: tuple[Connection, ...]
    end: np.ndarray  # stiffness between the last centre and the end face, shape (6,)

    @classmethod
    def of(cls, tube: Tube, length: float, segments: int) -> "Chain":
        """A chain of connections from centre to centre, and half pieces at both ends."""
        h = length / segments
        centres = h * (np.arange(segments) + 0.5)
        root = Connection(-1, 0, h / 4, tube.connection(h / 2))
        inner = (Connection(i, i + 1, h * (i + 1), tube.connection(h)) for i in range(segments - 1))
        return cls(length, centres, (root, *inner), tube.connection(h / 2))

    @property
    def end_station(self) -> float:
        """Return where the connection to the end face sits: halfway from the last centre."""
        return (self.centres[-1] + self.length) / 2

    def compliance_at(self, station: float) -> np.ndarray:
        """Exact static compliance of the last segment at a station, shape (6, 6): x y z, about x y z."""
        total = np.zeros((6, 6))
        for connection in self.connections:
            carry = _carry(station - connection.station)
            total += carry @ np.diag(1 / connection.stiffness) @ carry.T
        return total

    @cached_property
    def lateral_stiffness(self) -> np.ndarray:
        """Stiffness of the free end with its fit, seen in the housing: forces along y, z and moments about
        y, z over displacements and tilts, shape (4, 4) [N/m, N, N m]."""
        compliance = self.compliance_at(self.end_station) + np.diag(1 / self.end)
        # the chain's stations run against X: lateral motion about y and z changes sign with the lever
        mirror = np.diag([1.0, 1.0, -1.0, -1.0])
        return np.linalg.inv(mirror @ compliance[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] @ mirror)


def _carry(lever: float) -> np.ndarray:
    """Displacement at x + lever from displacement and rotation at x, shape (6, 6)."""
    carry = np.eye(6)
    carry[1, 5], carry[2, 4] = lever, -lever
    return carry


def bush_chain(gear: SteeringGear) -> Chain:
    """The bush of the gear as a chain that converges quickly to a Timoshenko beam."""
    return _shared_chain(Tube.of(gear), gear.bush.length, gear.bush.segments)


@lru_cache(maxsize=16)
def _shared_chain(tube: Tube, length: float, segments: int) -> Chain:
    """Equal bushes of many gears are one chain, which keeps what it has computed."""
    return Chain.of(tube, length, segments)


def housing_station(gear: SteeringGear, station: float | np.ndarray) -> Any:
    """X in the housing of a station on the chain [m]; its free end faces the mesh."""
    return gear.bush.distance + gear.bush.length - station


def resting_segments(gear: SteeringGear, chain: Chain, wrench: np.ndarray, station: float) -> np.ndarray:
    """Displacements of the segments under a wrench on the last one, shape (N, 6): x y z, about x y z.

    `wrench` (6,) acts in housing directions at a station of the chain.
    """
    centres = housing_station(gear, chain.centres)
    load_x = housing_station(gear, station)
    rest = np.zeros((len(centres), 6))
    for connection in chain.connections:
        x = housing_station(gear, connection.station)
        strain = (_carry(load_x - x).T @ wrench) / connection.stiffness
        for i in range(connection.after, len(centres)):
            rest[i] += _carry(centres[i] - x) @ strain
    return rest


def stored_in_chain(gear: SteeringGear, chain: Chain, segments: np.ndarray) -> np.ndarray:
    """Elastic energy of the springs for segment displacements (t, N, 6), small rotations; shape (t,) [J]."""
    centres = housing_station(gear, chain.centres)
    energy = np.zeros(len(segments))
    for connection in chain.connections:
        x = housing_station(gear, connection.station)
        strain = segments[:, connection.after] @ _carry(x - centres[connection.after]).T
        if connection.before >= 0:
            strain = strain - segments[:, connection.before] @ _carry(x - centres[connection.before]).T
        energy += 0.5 * np.sum(connection.stiffness * strain**2, axis=1)
    return energy
