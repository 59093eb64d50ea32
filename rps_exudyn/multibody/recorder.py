"""Keeps the motion of a dynamic run in Exudyn, step by step."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import exudyn as exu
import numpy as np

from rps_exudyn.base.progress import reached
from rps_exudyn.forces.bush import stored_in_chain
from rps_exudyn.forces.external_load import axis_velocity
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS, PINION, RACK
from rps_exudyn.forces.friction import TIME
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_limits import largest_lift
from rps_exudyn.multibody.solve import StepRefusedError
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.results.outcome import Code, Status
from rps_exudyn.solvers.balance import SIZE
from rps_exudyn.solvers.record import AT_MESH, Record, axis_at_pitch_point
from rps_exudyn.solvers.steering_column import WheelTorque

NOTHING = np.zeros(0)
MOST_STEPS, SPARE = 200, 500  # of the planned ones
LITTLE, STEEPER = 0.1, 1.02  # tilt [rad], and how much steeper than that the axis may be then
SAME_TIME = 1e-12  # of the time, by which Exudyn's last step may end beyond one that was reduced


class RecordedStep(NamedTuple):
    """One converged step."""

    time: float  # [s]
    coordinates: np.ndarray
    rates: np.ndarray
    drive: float  # multiplier of the drive's constraint
    mesh: np.ndarray | None  # Exudyn's own contact forces on pinion and rack
    begun: np.ndarray  # state of the bristles at its start


@dataclass
class Recorder:
    """Collects every converged step of one run, each as a whole: an interrupt leaves no part of one."""

    model: SteeringModel
    end: float = np.inf  # of the run, for its progress [s]
    planned: int | None = None  # steps, of which a run may need `MOST_STEPS` times as many and `SPARE` more
    steps: list[RecordedStep] = field(default_factory=list)
    _start: tuple[np.ndarray, np.ndarray] = (NOTHING, NOTHING)  # coordinates and rates of the model

    def attach(self) -> "Recorder":
        """Hook into the model's time steps, from where the model starts on; return itself."""
        system, initial = self.model.mbs.systemData, exu.ConfigurationType.Initial
        coordinates, rates = system.GetODE2Coordinates(initial), system.GetODE2Coordinates_t(initial)
        self._start = np.array(coordinates), np.array(rates)
        self.model.mbs.SetPostStepUserFunction(self._keep)
        return self

    def rewind(self, time: float) -> float:
        """Drop the steps that end after a time [s].

        The last one left, or the model's start, becomes the system's initial state; return its time.
        """
        left = [step for step in self.steps if step.time <= time]
        if len(left) < len(self.steps) and self.model.forces.has_bristles:
            self.model.forces.memory[0] = self.steps[len(left)].begun
        self.steps = left
        coordinates, rates = (left[-1].coordinates, left[-1].rates) if left else self._start
        system, initial = self.model.mbs.systemData, exu.ConfigurationType.Initial
        system.SetODE2Coordinates(coordinates.tolist(), initial)
        system.SetODE2Coordinates_t(rates.tolist(), initial)
        return self.reached

    def _keep(self, mbs: Any, t: float) -> bool:
        system = mbs.systemData
        if self.steps and t <= self.steps[-1].time * (1 + SAME_TIME):  # or a solver that goes on begins there
            return True
        drive, mesh = self._multiplier(system), None
        coordinates, rates = np.array(system.GetODE2Coordinates()), np.array(system.GetODE2Coordinates_t())
        if self.model.contacts is not None:
            # Newton's last evaluation was made before its last correction, on the contacts it began with
            mbs.sys["dynamicSolver"].ComputeODE2RHS(mbs)
            mesh = self.model.contacts.force()[self.model.columns(["pinion", "rack"])]
        self.steps.append(
            RecordedStep(t, coordinates, rates, drive, mesh, self._remembered(t, coordinates, rates))
        )
        reached(t / self.end, lambda: self.model.drive.shown(t))
        self._stop_out_of_mesh(t)
        if self.planned is not None and len(self.steps) > MOST_STEPS * self.planned + SPARE:
            raise StepRefusedError(
                f"{len(self.steps)} steps instead of {self.planned} led to {t:.4g} s of {self.end:.4g} s, "
                "because longer ones do not converge: choose shorter steps or a finer contact",
                Status.NO_CONVERGENCE,
                Code.STEPS_USED_UP,
            )
        return True

    def _stop_out_of_mesh(self, t: float) -> None:
        """End a run whose rack leaves the teeth: what follows is not the gear's motion.

        Teeth that touch alike are a pitch away. Where lines of contact begin or end at once, a step's first
        guess may part all flanks; from there Newton's method may run into another space between teeth.
        """
        coordinates, rates = (each[self._columns] for each in self.steps[-1][1:3])
        angle, along = coordinates[[PINION, RACK]].tolist()
        skipped, pitch = abs(along - float(self._pair.travel_at(-angle))), self._pair.rack_pitch
        if not skipped <= pitch / 2:
            raise StepRefusedError(
                f"a time step moved the rack {1e3 * skipped:.4g} mm against the pinion (limit "
                f"{1e3 * pitch / 2:.4g} mm, half a pitch) at {self.model.drive.shown(t)}: "
                "lower fidelity.step_angle",
                Status.DIVERGED,
                Code.OUT_OF_BOUNDS,
            )
        if self._lift_bound() <= self._allowed_lift:
            return
        bar, rack = self.model.forces.bar, coordinates[None, COORDINATE_BLOCKS["rack"]]
        if bar is not None:
            rack, _ = bar.poses(coordinates[None], rates[None], AT_MESH)
        lift = abs(float(axis_at_pitch_point(rack)[0, 0]) - self.model.gear.installation.axis_offset)
        allowed = self._allowed_lift
        if not lift <= allowed:
            raise StepRefusedError(
                f"the rack is {1e6 * lift:.4g} um out of its place, first above {1e6 * allowed:.4g} um "
                f"at {self.model.drive.shown(t)}",
                Status.CONTACT_LOST,
                Code.RACK_OUT_OF_MESH,
            )

    @cached_property
    def _pair(self) -> GearPair:
        return GearPair.of(self.model.gear)

    def _lift_bound(self) -> float:
        """Return more than the lift of a rack that tilts little, at little cost; inf of another one."""
        if self.model.forces.bar is not None:
            return np.inf
        x, y, _, _, b, c = self.steps[-1].coordinates[self._columns][COORDINATE_BLOCKS["rack"]].tolist()
        tilt = abs(b) + abs(c)
        if not tilt < LITTLE:
            return np.inf
        return abs(y - self.model.gear.installation.axis_offset) + STEEPER * abs(x) * tilt

    def _multiplier(self, system: Any) -> float:
        """That of the drive's constraint; 0 where a torque turns the wheel."""
        if self.model.constraint is None:
            return 0.0
        (multiplier,) = system.GetObjectLTGAE(self.model.constraint)
        return float(system.GetAECoordinates()[multiplier])

    def _remembered(self, t: float, coordinates: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Make the end of a step found the begin of the next; return what was the begin."""
        forces = self.model.forces
        if not forces.has_bristles:
            return NOTHING
        memory, columns = forces.memory, self._columns
        begun = memory[0].copy()
        memory[1, TIME] = t
        forces.force(coordinates[columns], rates[columns])
        memory[0] = memory[1]
        return begun

    @cached_property
    def _columns(self) -> np.ndarray:
        return self.model.columns(self.model.stack)

    @cached_property
    def _allowed_lift(self) -> float:
        return float(largest_lift(self.model.gear))

    @property
    def reached(self) -> float:
        """Time of the last step kept [s]."""
        return self.steps[-1].time if self.steps else 0.0

    def record(self) -> Record:
        """Return what was kept, in the order of time."""
        model = self.model
        time, coordinates, rates, drive = (
            np.array([step[column] for step in self.steps]) for column in range(4)
        )
        # at the end; all rotations but the pinion's are small
        mass = np.array(model.mbs.sys["dynamicSolver"].GetSystemMassMatrix())
        energy = 0.5 * np.einsum("ti,ij,tj->t", rates, mass, rates)
        if model.segments:
            energy += stored_in_chain(model.gear, model.forces.chain, coordinates[:, model.segment_columns()])
        columns, bar, has_bristles = self._columns, model.forces.bar, self.model.forces.has_bristles
        places, speeds = (np.ascontiguousarray(rows[:, columns]) for rows in (coordinates, rates))
        if bar is not None:
            energy += bar.elastic_energy(places)
        tyre = model.drive.tyre if isinstance(model.drive, WheelTorque) else None
        if tyre is not None:
            energy += tyre.energy(places[:, COORDINATE_BLOCKS["rack"].start])
        return Record(
            model.forces,
            time,
            places,
            speeds,
            self._overcome(time, coordinates, rates, drive),
            model.drive.body,
            energy,
            contact=None if model.contacts is None else np.array([step.mesh for step in self.steps]),
            pulse_power=self._pulse_power(time, places, speeds),
            begun=np.array([step.begun for step in self.steps]) if has_bristles else None,
            wheel=self._wheel(coordinates, rates),
            column=model.column,
            tyre=tyre,
        )

    def _overcome(
        self, time: np.ndarray, coordinates: np.ndarray, rates: np.ndarray, multiplier: np.ndarray
    ) -> np.ndarray:
        """Torque or force of the drive (n,): the multiplier is the gear's force on the driven coordinate.

        On the wheel, whose motion is given, it is the column's torque and that of the inertia: a multiplier
        swings wherever the length of the steps changes, by as much as the inertia's torque.
        """
        model, wheel = self.model, self._wheel(coordinates, rates)
        if isinstance(model.drive, WheelTorque):
            return model.drive.torque(time)
        if model.column is None or wheel is None:
            return np.asarray(-model.drive.sign * multiplier)
        pinion = model.coordinates("pinion").start
        ratio, *twist = model.column.twisted(wheel.T, coordinates[:, pinion], rates[:, pinion])
        torque = model.column.torque(*twist)
        return np.asarray(ratio * torque + model.column.inertia * model.drive.acceleration(time))

    def _wheel(self, coordinates: np.ndarray, rates: np.ndarray) -> np.ndarray | None:
        """Angle and rate of the wheel (n, 2), if there is one."""
        if self.model.column is None:
            return None
        place = self.model.coordinates("wheel").start
        return -np.column_stack([coordinates[:, place], rates[:, place]])

    def _pulse_power(self, time: np.ndarray, coordinates: np.ndarray, rates: np.ndarray) -> np.ndarray | None:
        pulse, bar, rack = self.model.pulse, self.model.forces.bar, COORDINATE_BLOCKS["rack"]
        if pulse is None:
            return None
        motions = zip(coordinates[:, rack], rates[:, rack], strict=True)
        velocity = np.array([axis_velocity(q, v, pulse.place) for q, v in motions])
        if bar is not None:
            velocity += rates[:, SIZE : SIZE + bar.modes] @ bar.on_modes(pulse.place)
        return np.einsum("ti,ti->t", np.array([pulse.force(t) for t in time]), velocity)
