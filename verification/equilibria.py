"""Equilibria along a maneuver under force laws of no fidelity: finer quadrature, a shaped pinion."""

from time import process_time

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.checks.after_run import validated
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.gear_forces import GearForces, accelerated
from rps_exudyn.solvers.prescribed_motion import Steady
from rps_exudyn.solvers.record import record_of_path, signals_of
from rps_exudyn.solvers.settled_start import settled_path


def equilibria(gear: SteeringGear, forces: GearForces, maneuver: Maneuver) -> SceneRun:
    """The maneuver with these forces, each instant at rest but for friction, and for inertia in a swing."""
    balance = forces.statics if isinstance(maneuver.drive, Steady) else accelerated(gear, forces)
    start = process_time()
    path = settled_path(
        balance,
        GearPair.of(gear),
        maneuver.drive,
        maneuver.approach,
        maneuver.time,
    )
    cpu = process_time() - start
    if not path.converged:
        reached = float(path.time[-1]) if path.time.size else 0.0
        message = f"no equilibrium after {reached:.4g} s: {path.residual:.3g} N remain unbalanced"
        return SceneRun(
            Outcome(Status.NO_CONVERGENCE, message, time_reached=reached, cpu_s=cpu, counters=path.counters)
        )
    record = record_of_path(forces, path, maneuver.drive).since(maneuver.record_start)
    signals = signals_of(record)
    outcome = Outcome(Status.OK, time_reached=float(path.time[-1]), cpu_s=cpu, counters=path.counters)
    return SceneRun(validated(outcome, gear, record, signals), signals)
