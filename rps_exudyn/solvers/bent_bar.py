"""The rack's bar where it is not straight: its modes of bending, its bow, and where the forces act on it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.compiled import called, record
from rps_exudyn.gears.bar_bow import BarBow
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.rack_beam import RackBeam, RackModes
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.bent_rack import BAR, bar_sections, local_poses

ALONG_BAR, ON_BAR = -1.0, 0.0  # what stands in the housing, along which the bar slides; what travels with it


@dataclass(frozen=True, eq=False)
class BentBar:
    """A bar with modes, a bow, or both.

    Attributes:
        record: its constants for compiled code.
        pool: the numbers that the record points to.
        places: element -> X in the housing and `ALONG_BAR`, or station of the bar and `ON_BAR`; an element
            that is not listed acts on the rigid body.
        end: station of the end beside the pinion [m].
    """

    record: np.record
    pool: np.ndarray
    places: Mapping[str, tuple[float, float]]
    end: float

    @property
    def modes(self) -> int:
        """Return the number of modes m, of both planes."""
        return int(self.record.modes)

    @property
    def stiffness(self) -> np.ndarray:
        """Return the stiffness of the modes, shape (m,) [N/m per kg]."""
        return self.pool[self.record.stiffness :][: self.modes]

    @property
    def damping(self) -> np.ndarray:
        """Return the damping of the modes, shape (m,) [N s/m per kg]."""
        return self.pool[self.record.damping :][: self.modes]

    def poses(
        self, coordinates: np.ndarray, rates: np.ndarray, place: tuple[float, float]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return coordinates and rates, (n, 6) each, of a straight rack that touches the bar at a place, from
        those of the whole gear, (n, 8 + m)."""
        q, v = (np.ascontiguousarray(rows) for rows in (coordinates, rates))
        bars = np.array([self.record], dtype=BAR)
        local = called(local_poses, q, v, *place, bars, self.pool)
        return local[:, 0], local[:, 1]

    def on_modes(self, station: float) -> np.ndarray:
        """Return the forces on the modes per force along X, Y, Z on a station of the bar, shape (m, 3)."""
        sections = np.empty((4, self.modes + 2))
        bar_sections.py_func(station, self.record, self.pool, sections)
        lift, turn = sections[:2, : self.modes]
        shapes, in_y = lift + station * turn, self.record.in_y
        forces = np.zeros((self.modes, 3))
        forces[:in_y, 1], forces[in_y:, 2] = shapes[:in_y], shapes[in_y:]
        return forces

    def elastic_energy(self, coordinates: np.ndarray) -> np.ndarray:
        """Return the energy of bending, shape (n,) [J]."""
        return 0.5 * coordinates[:, 8:] ** 2 @ self.stiffness

    def damping_power(self, rates: np.ndarray) -> np.ndarray:
        """Return what the bar's damping takes, shape (n,) [W]."""
        return rates[:, 8:] ** 2 @ self.damping


def bent_bar(
    gear: SteeringGear, fidelity: Fidelity, places: Mapping[str, tuple[float, float]]
) -> BentBar | None:
    """Return the bar as the fidelity models it; None where it is straight and rigid."""
    per_plane = gear.rack.modes if fidelity.rack == "flexible" else 0
    if not per_plane and not gear.rack.bow:
        return None
    return BentBar(*_tabulated(gear, RackBeam.of(gear).modes(per_plane)), places, RackBar.of(gear).x_min)


def _tabulated(gear: SteeringGear, modes: RackModes) -> tuple[np.record, np.ndarray]:
    """Tabulate the modes, those in plane y first, and the bow: the record, and its numbers."""
    bow = BarBow.of(gear)
    of_modes = np.stack([modes.shape, modes.gradient, modes.slope, modes.curvature])  # (4, m, nodes)
    of_bow = np.stack([bow.offset, bow.gradient, bow.gradient, bow.curvature])  # (4, 2, nodes)
    fields = np.concatenate([of_modes, of_bow], axis=1).transpose(2, 0, 1)
    damping = 2 * gear.rack.modal_damping * modes.frequencies
    count = len(modes.frequencies)
    made = record(
        BAR,
        is_bent=1,
        modes=count,
        in_y=int(np.sum(modes.plane == 0)),
        nodes=len(modes.nodes),
        first=float(modes.nodes[0]),
        spacing=float(modes.nodes[1] - modes.nodes[0]),
        fields=2 * count,
        stiffness=0,
        damping=count,
    )
    return made, np.concatenate([modes.frequencies**2, damping, fields.ravel()])
