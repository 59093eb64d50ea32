"""A maneuver in closed form: mean values, losses, the runout's harmonic; no ripple, no elasticity."""

from time import process_time

import numpy as np

from rps_exudyn.analysis.work_balance import integral_from_start
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import law_of_formulas
from rps_exudyn.results.outcome import Code, Outcome, Remark, Status
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.scene import RunOptions
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import beyond_formulas, mean_state, pushing_force, runout_harmonics


def by_formula(gear: SteeringGear, fidelity: Fidelity, maneuver: Maneuver, options: RunOptions) -> SceneRun:
    """Fill the maneuver's record, without its run-in, with mean values.

    No check follows: the formulas state where they do not hold.

    Raises:
        InputError: the maneuver shakes the rack, or turns the steering wheel.
    """
    if maneuver.drive.body == "wheel":
        raise InputError(
            "fidelity.solver is closed-form, which has no steering column; use equilibrium or "
            "generalized-alpha."
        )
    if maneuver.pulse is not None:
        raise InputError("fidelity.solver is closed-form, which has no pulses; use generalized-alpha.")
    start = process_time()
    beyond = beyond_formulas(gear)
    if gear.bush.viscous_drag and np.ptp(np.abs(maneuver.drive.rate(maneuver.time))) > 0:
        beyond = beyond or "the formulas take bush.viscous_drag at a constant speed"
    signals = _turned(gear, maneuver) if maneuver.drive.body == "pinion" else _pushed(gear, maneuver)
    outcome = Outcome(
        Status.INVALID if beyond else Status.OK,
        beyond,
        (Code.BEYOND_FORMULAS,) if beyond else (),
        time_reached=float(signals["time"][-1]),
        cpu_s=process_time() - start,
        settings={"name": "closed-form"},
    )
    return SceneRun(outcome, signals).noting(_other_law(gear))


def _other_law(gear: SteeringGear) -> Remark | None:
    """Return a remark on the law that the formulas take instead of the gear's."""
    law = law_of_formulas(gear.mesh.law)
    if law == gear.mesh.law:
        return None
    taken = f"mesh.law is {gear.mesh.law}; the closed form takes loads per length as law {law} has them"
    return Remark(Code.OTHER_LAW, taken)


def _turned(gear: SteeringGear, maneuver: Maneuver) -> Signals:
    time = maneuver.time[maneuver.lead :]
    angle, rate = maneuver.drive.place(time), maneuver.drive.rate(time)
    cosine, sine = runout_harmonics(gear)
    phase = angle + gear.pinion.runout_angle
    signals = _mean_signals(gear, maneuver, angle, rate, dict.fromkeys((-1, 1), maneuver.rack_load))
    # what the runout does to friction turns with the direction, what it stores in the spring does not
    signals["pinion_torque"] += np.sign(rate) * cosine * np.cos(phase) + sine * np.sin(phase)
    signals["work_drive"] = integral_from_start(signals["pinion_torque"] * rate, time)
    return signals


def _pushed(gear: SteeringGear, maneuver: Maneuver) -> Signals:
    time, gain = maneuver.time[maneuver.lead :], float(GearPair.of(gear).gain)
    place, rate = maneuver.drive.place(time), maneuver.drive.rate(time)
    force = {sense: pushing_force(gear, sense, maneuver.rack_load) for sense in (-1, 1)}
    loads = {sense: maneuver.rack_load - force[sense] for sense in force}
    signals = _mean_signals(gear, maneuver, place / gain, rate / gain, loads)
    del signals["pinion_torque"]  # nothing but friction acts on the pinion
    signals["rack_force"] = np.where(rate > 0, force[1], force[-1])
    signals["work_drive"] = integral_from_start(signals["rack_force"] * rate, time)
    return signals


def _mean_signals(
    gear: SteeringGear, maneuver: Maneuver, angle: np.ndarray, rate: np.ndarray, loads: dict[int, float]
) -> Signals:
    """Signals of the mean forces, sense of motion by sense; `loads` pull the rack towards -X in each [N]."""
    time, gain = maneuver.time[maneuver.lead :], float(GearPair.of(gear).gain)
    states = {sense: mean_state(gear, sense, load) for sense, load in loads.items()}

    def mean(name: str) -> np.ndarray:
        return np.where(rate > 0, getattr(states[1], name), getattr(states[-1], name))

    def lost(name: str) -> np.ndarray:
        return integral_from_start(mean(name) * np.abs(rate), time)

    signals = {
        "time": time - time[0],
        "pinion_angle": angle,
        "pinion_torque": mean("torque"),
        "rack_displacement": gain * angle,
        "mesh_normal_force_drive": mean("normal_drive"),
        "mesh_normal_force_coast": mean("normal_coast"),
        "mesh_normal_force": mean("normal_drive") + mean("normal_coast"),
        "seat_force": mean("plunger_force"),
        "work_mesh_friction": lost("mesh_loss"),
        "work_seat_friction": lost("plunger_loss"),
        "work_bush_friction": lost("bush_loss"),
        "work_bearing_friction": lost("bearing_loss"),
    }
    if maneuver.rack_load:
        signals["load_force"] = np.full_like(angle, maneuver.rack_load)
        signals["work_load"] = -maneuver.rack_load * gain * (angle - angle[0])
    return signals
