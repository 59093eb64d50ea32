"""Load test (IS 13476): the pinion raises a weight at the rack's end, and lowers it.

The weight pulls against `test.direction`. The same turns without it give the free torque, which the net
efficiencies tare. Forward means raising: the paper also says the opposite, but its equation (1) only makes
sense so.
"""

from dataclasses import replace

import numpy as np

from rps_exudyn.analysis.efficiency import describe_load_test, free_torque_of, measured_load_test
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted
from rps_exudyn.scenes.figures import figures_of_motion
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.remarks import remarks
from rps_exudyn.scenes.run_maneuver import run_maneuver, run_maneuvers
from rps_exudyn.scenes.run_options import RunOptions
from rps_exudyn.scenes.scene import Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import GRAVITY, unloading_force


def load_test(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Raise and lower the weight; the signals are those of these two maneuvers.

    Raises:
        InputError: no weight, or the test leaves the rack's teeth.
    """
    weight = GRAVITY * gear.test.load_mass
    if not weight > 0:
        raise InputError("test.load_mass is 0 kg; the load test needs a weight, greater than 0.")
    to_and_fro = gear.replace({"test.path": "there-and-back"}) if gear.test.path == "one-way" else gear
    maneuvers = maneuvers_of_test(to_and_fro, "pinion", fidelity.step_angle, options.least_steps)
    weighted = [maneuver.under(gear.test.direction * weight) for maneuver in maneuvers]
    loaded = run_maneuvers(gear, fidelity, weighted, options)
    if not loaded.ok:
        return _blamed(loaded, weight, gear)
    try:
        unloaded = run_maneuver(gear, fidelity, maneuvers[0], options)
    except Interrupted as interrupt:
        raise Interrupted(replace(loaded, outcome=interrupt.recorded.outcome)) from None
    if not unloaded.ok:
        message = f"without the weight: {unloaded.outcome.message}"
        return replace(loaded, outcome=replace(unloaded.outcome, message=message))
    pitch = 2 * np.pi / gear.pinion.teeth
    test = measured_load_test(
        oriented(loaded.signals, gear),
        weight,
        float(GearPair.of(gear).gain),
        free_torque_of(unloaded.signals, pitch),
        pitch,
    )
    return loaded.noting(*remarks(gear, loaded.signals), *test.remarks()).described(
        lambda signals: {**describe_load_test(test), **figures_of_motion(signals, gear)}
    )


def _blamed(failed: SceneRun, weight: float, gear: SteeringGear) -> SceneRun:
    """The failed run, with the limit of the gear in its message if the weight is beyond it."""
    raised, lowered = (unloading_force(gear, sense) / GRAVITY for sense in (+1, -1))
    if weight / GRAVITY <= min(raised, lowered):
        return failed
    beyond = (
        f"; a weight lifts one flank off above {raised:.4g} kg while raised, {lowered:.4g} kg while lowered"
    )
    return replace(failed, outcome=replace(failed.outcome, message=failed.outcome.message + beyond))


def oriented(signals: Signals, gear: SteeringGear) -> Signals:
    """Return angle and torque as if the weight were raised by positive angles, and the time."""
    sense = gear.test.direction
    return {
        "time": signals["time"],
        **{name: sense * signals[name] for name in ("pinion_angle", "pinion_torque")},
    }


SCENE = Scene(
    name="load-test",
    title="Load test",
    run=load_test,
    signal="pinion_torque",
    figure="torque_forward",
    chart="load_test",
    steady=True,
    revolutions=lambda gear: 2 * gear.test.turns,
)
