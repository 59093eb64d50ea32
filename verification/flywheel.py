"""The free pinion torque by Exudyn's own explicit solvers: what explicit steps cost.

    run = explicit_run(gear, "RK44", 2e-5)

These solvers hold the drive's constraint still. So a flywheel takes its place: the pinion gets an inertia so
large that the gear's torque changes its speed by less than a millionth, and starts at the test's speed. The
torque is read from the gear's force on the pinion. The constraint stays, on a body that nothing touches.
"""

from time import process_time
from typing import Any

import numpy as np

from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.multibody.model import build_model
from rps_exudyn.multibody.solve import LARGEST_STATE, silent
from rps_exudyn.multibody.steering_model import SteeringModel
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.checks.after_run import validated
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.record import Record, signals_of

STAGES = {"ExplicitEuler": 1, "VelocityVerlet": 1, "ExplicitMidpoint": 2, "RK44": 4}
"""Solver of Exudyn -> force evaluations in a step."""

FLYWHEEL = 1e6  # [kg m^2]
KEPT = np.deg2rad(0.2)  # pinion angle between two records


def explicit_run(gear: SteeringGear, fidelity: Fidelity, solver: str, step: float) -> SceneRun:
    """Run one way from the test's start, in steps of `step` [s]; a run that blew up says so."""
    maneuver = maneuvers_of_test(gear, "pinion", fidelity.step_angle)[0]
    model = build_model(gear, fidelity, maneuver.drive, approach=maneuver.approach)
    _drive_by_flywheel(model)
    end = float(maneuver.time[-1])
    steps = int(np.ceil(end / step))
    kept = _Kept(model, max(round(KEPT / gear.test.speed / (end / steps)), 1))
    model.mbs.Assemble()
    start = process_time()
    message = _integrate(model, solver, end, steps)
    cpu = process_time() - start
    outcome = Outcome(
        Status.OK,
        time_reached=kept.time[-1] if kept.time else 0.0,
        cpu_s=cpu,
        counters={"steps": steps, "force_evaluations": STAGES[solver] * steps},
        settings={"name": solver, "step": end / steps},
    )
    record = kept.record()
    model.release()
    if not message and not (np.abs(np.hstack([record.coordinates, record.rates])) < LARGEST_STATE).all():
        message = f"{solver} blew up in steps of {1e6 * step:g} us; Exudyn calls it a success"
    if message:
        outcome.status, outcome.message = Status.DIVERGED, message
        return SceneRun(outcome)
    record = record.since(maneuver.record_start)
    signals = signals_of(record)
    return SceneRun(validated(outcome, gear, record, signals), signals)


def _drive_by_flywheel(model: SteeringModel) -> None:
    from exudyn.itemInterface import MarkerNodeCoordinate, Node1D, NodePointGround, ObjectMass1D

    mbs = model.mbs
    mbs.SetObjectParameter(model.bodies["pinion"], "inertia", FLYWHEEL)
    idle, ground = mbs.AddNode(Node1D(referenceCoordinates=[0.0])), mbs.AddNode(NodePointGround())
    mbs.AddObject(ObjectMass1D(nodeNumber=idle, mass=1.0))
    markers = [mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in (ground, idle)]
    mbs.SetObjectParameter(model.constraint, "markerNumbers", markers)
    for law in ("offsetUserFunction", "offsetUserFunction_t"):
        mbs.SetObjectParameter(model.constraint, law, 0)


def _integrate(model: SteeringModel, solver: str, end: float, steps: int) -> str:
    """Integrate, and return why it failed if Exudyn says so."""
    import exudyn as exu

    settings = exu.SimulationSettings()
    settings.parallel.numberOfThreads = 1
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = end
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = end, steps
    settings.timeIntegration.verboseMode = 0
    try:
        with silent():
            model.mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, solver))
    except exu.ExudynError as error:
        return str(error).splitlines()[0]
    return ""


class _Kept:
    """Keeps every n-th step; `Recorder` would read the drive's constraint, which holds nothing here."""

    def __init__(self, model: SteeringModel, every: int) -> None:
        self.model, self.every, self.step = model, every, 0
        self.time: list[float] = []
        self.places: list[np.ndarray] = []
        self.rates: list[np.ndarray] = []
        model.mbs.SetPostStepUserFunction(self.keep)
        if model.contacts is not None:  # explicit solvers find by themselves what touches
            model.mbs.SetPreStepUserFunction(self.hold)

    def hold(self, mbs: Any, t: float) -> bool:
        """Called before every step."""
        angle = mbs.systemData.GetODE2Coordinates()[self.model.coordinates("pinion").start]
        self.model.contacts.hold(mbs, float(angle))  # type: ignore[union-attr]
        return True

    def keep(self, mbs: Any, t: float) -> bool:
        """Called after every step."""
        if self.step % self.every == 0:
            system = mbs.systemData
            self.time.append(t)
            self.places.append(np.array(system.GetODE2Coordinates()))
            self.rates.append(np.array(system.GetODE2Coordinates_t()))
        self.step += 1
        return True

    def record(self) -> Record:
        """Return the motion with the torque of the gear on the pinion."""
        model = self.model
        columns = model.columns([name for name in COORDINATE_BLOCKS if name in model.nodes])
        places, rates = (
            np.ascontiguousarray(np.array(each)[:, columns]) for each in (self.places, self.rates)
        )
        balance, column = model.forces, model.drive.coordinate
        torque = [-model.drive.sign * balance.force(q, v)[column] for q, v in zip(places, rates, strict=True)]
        time, no_energy = np.array(self.time), np.zeros(len(self.time))
        return Record(model.forces, time, places, rates, np.array(torque), "pinion", no_energy)
