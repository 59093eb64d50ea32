"""Keeps the motion of a dynamic run in Exudyn, step by step."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rps_exudyn.forces.bush import stored_in_chain
from rps_exudyn.forces.external_load import axis_velocity
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.solvers.gear_kernel import COORDINATE_BLOCKS
from rps_exudyn.solvers.record import Record


@dataclass
class Recorder:
    """Collects every converged step of one run."""

    model: SteeringModel
    time: list[float] = field(default_factory=list)
    coordinates: list[np.ndarray] = field(default_factory=list)
    rates: list[np.ndarray] = field(default_factory=list)
    drive: list[float] = field(default_factory=list)  # multiplier of the drive's constraint
    mesh: list[np.ndarray] = field(default_factory=list)  # Exudyn's own contact forces on pinion and rack

    def attach(self) -> "Recorder":
        """Hook into the model's time steps; return itself."""
        if self.model.contacts is not None:
            self.model.mbs.SetPreStepUserFunction(self._gate)
        self.model.mbs.SetPostStepUserFunction(self._keep)
        return self

    def _gate(self, mbs: Any, t: float) -> bool:
        angle = mbs.systemData.GetODE2Coordinates()[self.model.coordinates("pinion")][0]
        self.model.contacts.gate(float(angle))  # type: ignore[union-attr]
        return True

    def _keep(self, mbs: Any, t: float) -> bool:
        system = mbs.systemData
        self.time.append(t)
        self.coordinates.append(np.array(system.GetODE2Coordinates()))
        self.rates.append(np.array(system.GetODE2Coordinates_t()))
        (multiplier,) = system.GetObjectLTGAE(self.model.constraint)
        self.drive.append(float(system.GetAECoordinates()[multiplier]))
        if self.model.contacts is not None:
            # Newton's last evaluation was made before its last correction, on the contacts it began with
            mbs.sys["dynamicSolver"].ComputeODE2RHS(mbs)
            self.mesh.append(self.model.contacts.force()[self.model.columns(["pinion", "rack"])])
        return True

    @property
    def reached(self) -> float:
        """Time of the last step kept [s]."""
        return self.time[-1] if self.time else 0.0

    def record(self) -> Record:
        """Return what was kept, in the order of time."""
        model = self.model
        coordinates, rates = np.array(self.coordinates), np.array(self.rates)
        # at the end; all rotations but the pinion's are small
        mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
        energy = 0.5 * np.einsum("ti,ij,tj->t", rates, mass, rates)
        if model.segments:
            energy += stored_in_chain(model.gear, model.forces.chain, coordinates[:, model.segment_columns()])
        columns = model.columns([name for name in COORDINATE_BLOCKS if name in model.nodes])
        return Record(
            model.forces.elements,
            np.array(self.time),
            np.ascontiguousarray(coordinates[:, columns]),
            np.ascontiguousarray(rates[:, columns]),
            # the multiplier is the gear's force on the driven coordinate
            -model.drive.sign * np.array(self.drive),
            model.drive.body,
            energy,
            contact=np.array(self.mesh) if self.mesh else None,
            pulse_power=self._pulse_power(coordinates, rates),
        )

    def _pulse_power(self, coordinates: np.ndarray, rates: np.ndarray) -> np.ndarray | None:
        pulse, columns = self.model.pulse, self.model.columns(["rack"])
        if pulse is None:
            return None
        motions = zip(self.time, coordinates[:, columns], rates[:, columns], strict=True)
        return np.array([pulse.force(t) @ axis_velocity(q, v, pulse.place) for t, q, v in motions])
