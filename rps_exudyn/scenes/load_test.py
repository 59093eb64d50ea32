"""Load test (IS 13476): the pinion raises a weight at the rack's end, and lowers it.

The weight pulls against `test.direction`. The same turns without it give the free torque, which the net
efficiencies tare. Forward means raising: the paper also states the opposite, but its equation (1) only makes
sense so.
"""

from dataclasses import replace

import numpy as np

from rps_exudyn.analysis.efficiency import LoadTest, describe_load_test, free_torque_of, measured_load_test
from rps_exudyn.analysis.load_distribution import face_loading
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Interrupted, Remark
from rps_exudyn.scenes.maneuver import Maneuver, StepLimits, maneuvers_of_test
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene, SteadyRecord, SteadyTest
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import GRAVITY, unloading_force


def load_test(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Raise and lower the weight; the signals are those of these two maneuvers."""
    weight = GRAVITY * gear.test.load_mass
    if not weight > 0:
        raise InputError("test.load_mass is 0 kg; the load test needs a weight, greater than 0.")
    weighted, free = TEST.maneuvers(gear, fidelity.step_angle, options.least_steps)
    assert free is not None
    loaded = run_maneuver(gear, fidelity, weighted, options)
    if not loaded.ok:
        return _blamed(loaded, weight, gear)
    try:
        unloaded = run_maneuver(gear, fidelity, free, options=options)
    except Interrupted as interrupt:
        raise Interrupted(replace(loaded, outcome=interrupt.recorded.outcome)) from None
    if not unloaded.ok:
        message = f"without the weight: {unloaded.outcome.message}"
        return replace(loaded, outcome=replace(unloaded.outcome, message=message))
    gain = GearPair.of(gear).travel_rule
    record = SteadyRecord(gear, loaded.signals, unloaded.signals, gain, weight)
    (further,) = _remarks(record)

    def metrics(signals: Signals) -> dict[str, float]:
        on_face = face_loading(gear, signals) if fidelity.bends_teeth else {}
        return _metrics(replace(record, signals=signals)) | on_face

    return loaded.described(metrics, gear).noting(*further)


def _maneuvers(
    gear: SteeringGear, step_angle: float, least: StepLimits
) -> tuple[list[Maneuver], Maneuver | None]:
    """Raising and lowering under the weight, and the first turn without it beside."""
    weight = gear.test.direction * GRAVITY * gear.test.load_mass
    to_and_fro = gear.replace({"test.path": "there-and-back"}) if gear.test.path == "one-way" else gear
    maneuvers = maneuvers_of_test(to_and_fro, "pinion", step_angle, least)
    return [maneuver.under(weight) for maneuver in maneuvers], maneuvers[0]


def _load_test(record: SteadyRecord) -> LoadTest:
    pitch, signals = 2 * np.pi / record.gear.pinion.teeth, oriented(record.signals, record.gear)
    free_torque = free_torque_of(record.beside, pitch)
    gain, sense = record.gain, record.gear.test.direction
    rule = (lambda angle: sense * gain(sense * angle)) if callable(gain) else gain
    return measured_load_test(signals, record.load, rule, free_torque, pitch)


def _metrics(record: SteadyRecord) -> dict[str, float]:
    """Efficiencies, and what any gear in motion shows."""
    of_motion = metrics_of_motion(record.signals, record.gear, record.gain)
    return {**describe_load_test(_load_test(record)), **of_motion}


def _remarks(record: SteadyRecord) -> list[list[Remark]]:
    """Remarks on numbers that are no efficiencies, a list for each gear."""
    test = _load_test(record)
    columns = test.load, test.ideal_torque, test.torque_forward, test.torque_reverse, test.free_torque
    rows = np.stack(np.broadcast_arrays(*columns), axis=-1).reshape(-1, len(columns))
    return [list(LoadTest(*row).remarks()) for row in rows.tolist()]


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


TEST = SteadyTest(
    maneuvers=_maneuvers,
    metrics=_metrics,
    curve=("time", "pinion_angle", "pinion_torque"),
    remarks=_remarks,
)

SCENE = Scene(
    name="load-test",
    title="Load test",
    run=load_test,
    signal="pinion_torque",
    main_metric="torque_forward",
    chart="load_test",
    steady=True,
    test=TEST,
    revolutions=lambda gear: 2 * gear.test.turns,
    law="teeth",
)
