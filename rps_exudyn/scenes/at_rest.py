"""A gear at rest under loads from outside: equilibria one after the other, nothing sliding.

Loads change so slowly that friction creeps away, as a mechanic taps the gear before reading the gauge. Time
counts the loads only.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import process_time

import numpy as np

from rps_exudyn.analysis.work_balance import describe_balance
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.force_element import COORDINATE_BLOCKS
from rps_exudyn.forces.pinion_support import ShaftLoad
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.gears.rack_beam import RackBeam
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import PLAIN_LAW, RUBBING_PARTS
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Interrupted, Outcome, Status
from rps_exudyn.scenes.checks.before_run import check_travel
from rps_exudyn.scenes.ladder import MOST_MODES
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals, lost, outcome_of_path
from rps_exudyn.solvers.balance import SIZE, Balance
from rps_exudyn.solvers.equilibrium import EquilibriumPath, PathInterrupted, equilibrium_path
from rps_exudyn.solvers.gear_forces import GearForces, gear_forces
from rps_exudyn.solvers.prescribed_motion import Drive, DrivenBody, Steady, travel_per_radian
from rps_exudyn.solvers.record import Record, record_of_path, signals_of, work_along

PAUSE = 1e7  # from load to load [s]: friction of a rack that moves by 0.1 mm meanwhile is 1e-5 of sliding
LEAST_MODES = 20  # per plane of a bar that bends: its end yields by 0.3 % less with 8
FREE_RACK_MODELS = ("by-scene", "free", "flexible")  # models of a rack that yields across its guides


@dataclass(frozen=True, eq=False)
class OutsideLoads:
    """Loads one after the other: a torque on the pinion, a force across the rack's end beside it, a force on
    the input shaft of a supported pinion."""

    torque: np.ndarray  # (n,) in the sense of the pinion angle [N m]
    end_force: np.ndarray  # (n, 2) along Y and Z [N]
    shaft: np.ndarray | None = None  # (n, 3) along e, Y and k [N], none at the first two instants

    @property
    def time(self) -> np.ndarray:
        """Instants of the loads [s]."""
        return PAUSE * np.arange(len(self.torque))

    def generalised(
        self, place: float, bent: np.ndarray, behind: int = 0
    ) -> Callable[[np.ndarray], np.ndarray]:
        """Forces on the coordinates over time, shape (t, 8 + m + behind): the force acts at `place` on the
        bar [m]; that on the input shaft is left to the supports, `behind` coordinates.

        `bent` (2, m) is how far unit modes move that place along Y and Z. Turns of the rack, at most a
        milliradian, leave the force's lever alone.
        """
        size, rack = SIZE + bent.shape[1] + behind, COORDINATE_BLOCKS["rack"].start
        forces = np.zeros((len(self.torque), size))
        forces[:, COORDINATE_BLOCKS["pinion"].start] = -self.torque  # the coordinate counts about the axis
        across, sideways = self.end_force.T
        forces[:, rack + 1], forces[:, rack + 5] = across, place * across
        forces[:, rack + 2], forces[:, rack + 4] = sideways, -place * sideways
        forces[:, SIZE : size - behind] = self.end_force @ bent

        def at(time: np.ndarray) -> np.ndarray:
            return np.stack([np.interp(time, self.time, forces[:, i]) for i in range(size)], axis=1)

        return at


def to_and_fro(largest: float, steps: int) -> np.ndarray:
    """Return 0, up to the largest, back through 0 to its negative, and back to 0: 4 `steps` + 1 values."""
    quarter = np.linspace(0, largest, steps, endpoint=False)
    back = largest - quarter
    return np.concatenate([quarter, back, -quarter, -back, [0.0]])


def bending(fidelity: Fidelity) -> Fidelity:
    """Return the model of a rack that yields across its guides: it bends unless another is chosen.

    Raises:
        InputError: a model in which the rack has no freedom in its guides.
    """
    if fidelity.solver == "closed-form" or fidelity.rack not in FREE_RACK_MODELS:
        raise InputError(
            f"fidelity.solver is {fidelity.solver} and fidelity.rack is {fidelity.rack}; this scene needs "
            f"equilibria of a free or flexible rack."
        )
    return fidelity.with_condensed_chain().with_bending()


def run_at_rest(
    gear: SteeringGear,
    fidelity: Fidelity,
    body: DrivenBody,
    loads: OutsideLoads,
    options: RunOptions,
    metrics: Callable[[Signals], dict[str, float]],
) -> SceneRun:
    """Find the equilibria under the loads, a body held at the test's start angle.

    Raises:
        InputError: the start lies beyond the rack's teeth, or a model that has no rest.
    """
    start = gear.test.start_angle
    check_travel(gear, (start,), "test.start_angle")
    if fidelity.solver == "reduced":
        raise InputError("fidelity.solver is reduced, which has no gear at rest; choose equilibrium.")
    drive = Steady(body, travel_per_radian(body, float(GearPair.of(gear).gain)) * start, 0.0)
    # bristles and the shaft's axial friction would hold what tapping lets go
    laws: dict[str, object] = {f"{part}.friction_law": PLAIN_LAW for part in RUBBING_PARTS}
    tapped = gear.replace(laws | {"pinion.axial_friction": 0.0, "yoke.bore_friction": 0.0})
    run = _equilibria(tapped, fidelity, drive, loads, options)
    return run.described(lambda signals: {**metrics(signals), **describe_balance(signals)}, gear)


def _equilibria(
    gear: SteeringGear, fidelity: Fidelity, drive: Drive, loads: OutsideLoads, options: RunOptions
) -> SceneRun:
    """Find the equilibria under the loads by modes enough to show small motions."""
    if gear.rack.modes:
        gear = gear.replace({"rack.modes": max(gear.rack.modes, min(options.finer(LEAST_MODES), MOST_MODES))})
    place, start, interrupted = RackBar.of(gear).x_min, process_time(), False
    forces = gear_forces(gear, fidelity)
    bent = moved_by_modes(gear, fidelity, place)
    outside = loads.generalised(place, bent, len(forces.supported))
    balance = replace(forces.statics, outside=outside)
    try:
        if loads.shaft is None:
            path = equilibrium_path(balance, GearPair.of(gear), drive, loads.time)
        else:
            path = _under_shaft_loads(gear, balance, drive, loads)
    except PathInterrupted as interrupt:
        path, interrupted = interrupt.path, True
    except np.linalg.LinAlgError as error:
        message = f"the gear has no stiffness against a force: {error}"
        return SceneRun(Outcome(Status.NO_CONVERGENCE, message, (Code.NO_RESISTANCE,)))
    outcome = _outcome(path, loads, process_time() - start, interrupted)
    if len(path.time) < 2:
        return SceneRun(outcome)
    record = record_of_path(forces, path, drive)
    still = np.zeros(len(path.time))
    energy = forces.bar.elastic_energy(path.coordinates) if forces.bar else still
    on_shaft = _shaft_signals(gear, forces, path, loads) if loads.shaft is not None else {}
    energy = energy + on_shaft.pop(SHAFT_ENERGY, still)
    record = replace(record, energy=energy, pulse_power=still)
    signals = _signals(record, loads, outside(path.time), place)
    signals |= on_shaft | {"work_load": signals["work_load"] + on_shaft.get("work_load", 0.0)}
    if outcome.status is Status.OK:
        outcome = options.check(outcome, gear, record, signals)
    if interrupted:
        raise Interrupted(SceneRun(outcome, signals))
    return SceneRun(outcome, signals)


SHAFT_ENERGY = "shaft_energy"  # of `_shaft_signals`, no signal of a result
AT_SHAFT = ("across", "y", "axial")  # along e, Y and k


def _under_shaft_loads(
    gear: SteeringGear, balance: Balance, drive: Drive, loads: OutsideLoads
) -> EquilibriumPath:
    """Follow the equilibria under forces on the input shaft, each of which bends it off the upper bearing."""
    assert loads.shaft is not None
    pair, path = GearPair.of(gear), None
    for k in range(1, len(loads.shaft)):
        gears = balance.gears.copy()
        ShaftLoad.of(gear, loads.shaft[k]).on(gears[0]["support"])
        path = equilibrium_path(replace(balance, gears=gears), pair, drive, loads.time[: k + 1], path)
        if not path.converged:
            break
    assert path is not None
    return path


def _shaft_signals(
    gear: SteeringGear, forces: GearForces, path: EquilibriumPath, loads: OutsideLoads
) -> Signals:
    """Signals of forces on the input shaft, their work along its end, the energy of the shaft's end."""
    assert loads.shaft is not None
    support, applied = forces.gear.support.copy(), loads.shaft[: len(path.time)]
    rows = [
        ShaftLoad.of(gear, force).end(support, place[-len(forces.supported) :])
        for force, place in zip(applied, path.coordinates, strict=True)
    ]
    ends, energy = np.array([end for end, _ in rows]), np.array([energy for _, energy in rows])
    signals = {f"shaft_force_{axis}": values for axis, values in zip(AT_SHAFT, applied.T, strict=True)}
    signals |= {f"shaft_end_{axis}": ends[:, i] for i, axis in enumerate(AT_SHAFT)}
    return signals | {"work_load": work_along(applied, ends), SHAFT_ENERGY: energy}


def moved_by_modes(gear: SteeringGear, fidelity: Fidelity, place: float) -> np.ndarray:
    """Return how far unit modes of the bar's bending move a place on it along Y and Z, shape (2, m)."""
    modes = RackBeam.of(gear).modes(gear.rack.modes if fidelity.rack == "flexible" else 0)
    shape = modes.at(place)[0] if modes.count else np.zeros(0)
    return np.stack([np.where(modes.plane == plane, shape, 0.0) for plane in (0, 1)])


def _outcome(path: EquilibriumPath, loads: OutsideLoads, cpu_s: float, interrupted: bool) -> Outcome:
    outcome, found = outcome_of_path(path, cpu_s), len(path.time)
    if interrupted:
        message = f"interrupted after {found} loads"
        return replace(outcome, status=Status.TIMEOUT, codes=(Code.INTERRUPTED,), message=message)
    if path.converged:
        return outcome
    (across, sideways), torque = loads.end_force[found], loads.torque[found]
    if loads.shaft is not None:
        shown = ", ".join(f"{force:.4g} N" for force in loads.shaft[found]) + " on the input shaft"
    else:
        shown = f"{across:.4g} N along Y and {sideways:.4g} N along Z at the rack's end, {torque:.4g} N m"
    return lost(path, f"under {shown}", outcome)


def _signals(record: Record, loads: OutsideLoads, outside: np.ndarray, place: float) -> Signals:
    """Signals of the record, the loads, the bar's end, and the loads' work along the path."""
    n = len(record.time)
    # rates mean nothing where time only counts: works are integrals over them, but for that of the loads
    signals = {name: values for name, values in signals_of(record).items() if not name.startswith("work_")}
    rack = record.of("rack")
    signals |= {
        "end_force_y": loads.end_force[:n, 0],
        "end_force_z": loads.end_force[:n, 1],
        "work_load": work_along(outside, record.coordinates),
    }
    signals.setdefault("rack_end_y", rack[:, 1] + place * np.sin(rack[:, 5]))
    signals.setdefault("rack_end_z", rack[:, 2] - place * np.sin(rack[:, 4]))
    if record.driven == "rack":
        signals["pinion_torque"] = loads.torque[:n]
    return signals
