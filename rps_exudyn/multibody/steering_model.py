"""An assembled Exudyn system of the gear, and the numbers of its items."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import exudyn as exu
import numpy as np

from rps_exudyn.forces.external_load import TimedForce
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, COORDINATES
from rps_exudyn.multibody.general_contact import GeneralContacts
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.solvers.balance import eigenvalues, slopes
from rps_exudyn.solvers.equilibrium import EquilibriumPath
from rps_exudyn.solvers.gear_forces import GearForces
from rps_exudyn.solvers.prescribed_motion import Drive
from rps_exudyn.solvers.record import Record
from rps_exudyn.solvers.steering_column import ColumnModel


@dataclass
class SteeringModel:
    """An Exudyn system of the gear; nodes, bodies and sensors map names to the numbers of items."""

    gear: SteeringGear
    fidelity: Fidelity
    forces: GearForces
    drive: Drive
    SC: Any
    mbs: exu.MainSystem  # the system, to go on with as usual; SC is its container
    start: EquilibriumPath  # equilibrium in which it starts, in its only row
    contacts: GeneralContacts | None = None
    nodes: dict[str, Any] = field(default_factory=dict)
    bodies: dict[str, Any] = field(default_factory=dict)
    sensors: dict[str, Any] = field(default_factory=dict)
    segments: list[Any] = field(default_factory=list)  # nodes of the bush's segments, from the housing on
    pulse: TimedForce | None = None
    constraint: Any = None  # moves the driven body; its multiplier is the drive's torque or force
    column: ColumnModel | None = None  # where the rig turns the wheel; its node is "wheel"
    pictured: bool = True  # bodies have the shapes that Exudyn's viewer shows

    def coordinates(self, name: str) -> slice:
        """Return where a body's coordinates stand in the system's vector; the system must be assembled."""
        start = self.mbs.GetNodeODE2Index(self.nodes[name])
        sizes = {"modes": self.modes, "wheel": 1, "supports": len(self.forces.supported)}
        size = sizes.get(name) or COORDINATES[name]
        return slice(start, start + size)

    @property
    def modes(self) -> int:
        """Return the number of modes with which the rack bends; their node is "modes"."""
        return 0 if self.forces.bar is None else self.forces.bar.modes

    @property
    def stack(self) -> list[str]:
        """Return the bodies of the model in the order in which the kernels stack their coordinates."""
        return [name for name in (*COORDINATE_BLOCKS, "modes", "supports") if name in self.nodes]

    def columns(self, bodies: Sequence[str]) -> np.ndarray:
        """Return the same for several bodies, one after the other."""
        return np.concatenate([np.r_[self.coordinates(name)] for name in bodies])

    def release(self) -> None:
        """Free the system's memory: its items and the functions they call hold each other, out of reach of
        Python's collector. The model cannot be used any more."""
        self.mbs.sys.clear()
        self.mbs.variables.clear()
        self.SC.Reset()

    def segment_columns(self) -> np.ndarray:
        """Return the same for all segments of the bush, shape (N, 6)."""
        starts = [self.mbs.GetNodeODE2Index(node) for node in self.segments]
        return np.array(starts)[:, None] + np.arange(6)


# --- Whether a steadily driven gear vibrates by itself, or goes on vibrating: eigenvalues along its record
#
# Friction between parts that yield can feed a vibration; nothing else may damp it much. Implicit steps damp
# what is faster than they are, so that a record looks smooth in which the gear in truth shakes. The
# linearised motion shows.

INSTANTS = 12  # of a record at which the motion is linearised
SLOWEST = 0.5  # radians of a vibration in one step; slower ones the record shows itself


def vibration(model: SteeringModel, record: Record) -> dict[str, float]:
    """Return by how many powers of e the fastest growing vibration grows over a record, and by how many that
    one dies which dies most slowly; nothing of spheres, of a bush of segments and of bristles, whose
    tangents are others, and nothing behind a column, whose scenes look for themselves."""
    others = model.contacts is not None or bool(model.segments) or model.forces.has_bristles
    if others or model.column is not None or len(record.time) < 2:
        return {}
    some = np.unique(np.linspace(0, len(record.time) - 1, INSTANTS).astype(int))
    step, time = float(np.median(np.diff(record.time))), record.time[some]
    mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
    free = model.forces.free(model.drive.coordinate)
    by_place, by_rate = (
        each[:, free[:, None], free]
        for each in slopes(model.forces, record.coordinates[some], record.rates[some])
    )
    values = eigenvalues(mass[np.ix_(free, free)], by_place, by_rate)
    rates = np.where(np.abs(values.imag) * step > SLOWEST, values.real, -np.inf).max(axis=1)
    if not np.isfinite(rates).all():  # where nothing vibrates so fast
        return {}
    return {
        "vibration_grows": float(np.trapezoid(np.maximum(rates, 0.0), time)),
        "vibration_dies": float(-np.trapezoid(rates, time)),
    }
