"""The motion of a dynamic run, kept step by step, and what it tells: signals, work, checks.

Exudyn integrates; this reads. The recorder keeps coordinates, rates and the drive's torque of every step.
From them the force elements (see `parts.force_element`) give normal forces, stored energy and what each
contact dissipates, independently of the sums that Exudyn used: a balance that closes is therefore evidence.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from rps_exudyn.model import SteeringModel
from rps_exudyn.parts.bush import stored_in_chain
from rps_exudyn.parts.force_element import (
    DAMPING_POWER,
    ELASTIC_ENERGY,
    FRICTION_POWER,
    LEDGER_SIZE,
    ForceElement,
)


@dataclass
class Recorder:
    """Collects every converged step of one run."""

    model: SteeringModel
    time: list[float] = field(default_factory=list)
    coordinates: list[np.ndarray] = field(default_factory=list)
    rates: list[np.ndarray] = field(default_factory=list)
    drive: list[float] = field(default_factory=list)  # torque on the pinion in the sense of its angle
    mesh: list[np.ndarray] = field(default_factory=list)  # Exudyn's own contact forces on pinion and rack

    def attach(self) -> "Recorder":
        """Hook into the model's time steps."""
        self.model.mbs.SetPreStepUserFunction(self._before)
        self.model.mbs.SetPostStepUserFunction(self._after)
        return self

    def _before(self, mbs: Any, t: float) -> bool:
        if self.model.contacts is not None:
            self.model.contacts.gate(
                float(mbs.systemData.GetODE2Coordinates()[self.model.coordinates("pinion")][0])
            )
        return True

    def _after(self, mbs: Any, t: float) -> bool:
        system = mbs.systemData
        self.time.append(t)
        self.coordinates.append(np.array(system.GetODE2Coordinates()))
        self.rates.append(np.array(system.GetODE2Coordinates_t()))
        (multiplier,) = system.GetObjectLTGAE(self.model.drive)
        self.drive.append(float(system.GetAECoordinates()[multiplier]))
        if self.model.contacts is not None:
            # Newton's last evaluation was made before its last correction, on the contacts it began with
            mbs.sys["dynamicSolver"].ComputeODE2RHS(mbs)
            self.mesh.append(self.model.contacts.force()[self.model.columns(["pinion", "rack"])])
        return True

    def record(self) -> "Record":
        """What was kept, in the order of time."""
        return Record(
            self.model,
            np.array(self.time),
            np.array(self.coordinates),
            np.array(self.rates),
            np.array(self.drive),
            np.array(self.mesh),
            np.array(self.model.mbs.sys["dynamicSolver"].GetSystemMassMatrix()),
        )


@dataclass(frozen=True, eq=False)
class Record:
    """A recorded motion; arrays have one row per step."""

    model: SteeringModel
    time: np.ndarray
    coordinates: np.ndarray
    rates: np.ndarray
    drive: np.ndarray
    mesh: np.ndarray
    mass_matrix: np.ndarray  # at the end; all rotations but the pinion's are small

    def since(self, time: float) -> "Record":
        """The part that covers what comes after a time [s]: it begins with the last step until then.

        A solver that had to reduce its step does not meet given times any more.
        """
        kept = self.time >= self.time[self.time <= time].max(initial=-np.inf)
        rows = {
            name: getattr(self, name)[kept]
            for name in ("time", "coordinates", "rates", "drive", "mesh")
            if len(getattr(self, name))
        }
        return replace(self, **rows)

    def of_bodies(self, element: ForceElement) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and rates that an element reads, one row per step."""
        columns = self.model.columns(element.bodies)
        return np.ascontiguousarray(self.coordinates[:, columns]), np.ascontiguousarray(
            self.rates[:, columns]
        )

    def outputs(self, element: ForceElement) -> np.ndarray:
        """An element's output at every step: forces, ledger, own values."""
        q, v = self.of_bodies(element)
        return np.array([element.evaluate(*state) for state in zip(q, v, strict=True)])


def signals_of(record: Record) -> dict[str, np.ndarray]:
    """All signals of a run, by the names of `quantities`."""
    model = record.model
    time = record.time
    pinion, rack = (record.coordinates[:, model.coordinates(name)] for name in ("pinion", "rack"))
    speed = -record.rates[:, model.coordinates("pinion")][:, 0]
    signals = {
        "time": time - time[0],
        "pinion_angle": -pinion[:, 0],
        "pinion_torque": record.drive,
        "rack_displacement": rack[:, 0],
        "rack_y": rack[:, 1],
        "rack_z": rack[:, 2],
        "rack_roll": rack[:, 3],
        "rack_yaw": rack[:, 4],
        "rack_pitch": rack[:, 5],
        "plunger_displacement": record.coordinates[:, model.coordinates("plunger")][:, 0],
        "work_drive": _work(record.drive * speed, time),
    }
    energy = _kinetic_energy(record)
    if model.segments:
        segments = record.coordinates[:, model.segment_columns()]
        energy = energy + stored_in_chain(model.gear, model.forces.chain, segments)
    for element in (model.forces.mesh, *model.elements):
        out = record.outputs(element)
        ledger = out[:, element.size : element.size + LEDGER_SIZE]
        own = dict(zip(element.outputs, out[:, element.size + LEDGER_SIZE :].T, strict=True))
        energy = energy + ledger[:, ELASTIC_ENERGY]
        for loss, column in (("friction", FRICTION_POWER), ("damping", DAMPING_POWER)):
            if f"work_{element.name}_{loss}" in WORK:
                signals[f"work_{element.name}_{loss}"] = _work(ledger[:, column], time)
        signals |= {name: own[source] for name, source in SHOWN.items() if source in own}
    signals["mesh_normal_force"] = signals["mesh_normal_force_drive"] + signals["mesh_normal_force_coast"]
    signals["stored_energy"] = energy - energy[0]
    return signals


WORK = {
    "work_mesh_friction",
    "work_mesh_damping",
    "work_seat_friction",
    "work_bush_friction",
    "work_bearing_friction",
}
# Signal -> the output of a force element that it shows
SHOWN = {
    "mesh_normal_force_drive": "mesh_normal_force_drive",
    "mesh_normal_force_coast": "mesh_normal_force_coast",
    "mesh_penetration": "mesh_penetration",
    "seat_force": "seat_force",
    "yokenut_force": "yokenut_force",
    "bush_force": "bush_lateral_force",
}


def mesh_disagreement(record: Record) -> float:
    """Largest difference between Exudyn's contact forces and the compiled samples', over the largest."""
    element = record.model.forces.mesh
    own = record.outputs(element)[:, : element.size]
    return float(np.abs(own - record.mesh).max() / np.abs(own).max())


def _work(power: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Trapezoidal integral from the start [J]."""
    return np.concatenate([[0.0], np.cumsum(np.diff(time) * (power[1:] + power[:-1]) / 2)])


def _kinetic_energy(record: Record) -> np.ndarray:
    return 0.5 * np.einsum("ti,ij,tj->t", record.rates, record.mass_matrix, record.rates)
