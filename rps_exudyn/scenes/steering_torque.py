"""Steering by torque: the hand gives the wheel a sinusoidal torque, and the tyres hold against it.

The tyres are a linear spring at the rack that carries nothing where the test starts. One cycle and a quarter
go before the record, which starts at a peak. With `test.steer_shape` ramp the torque grows from none at a
constant rate, to its peak in a quarter of a cycle: the wheel moves off where it overcomes the friction.
"""

import numpy as np

from rps_exudyn.analysis.wheel_metrics import describe_breakaway, describe_steering_torque
from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.friction_law import largest_surplus
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.results.quantities import EXTREMES, LOSS_SHARES, VARIATIONS
from rps_exudyn.scenes.checks.before_run import check_travel
from rps_exudyn.scenes.maneuver import Maneuver
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.run_maneuver import run_maneuver, run_swing
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.closed_form import free_torque
from rps_exudyn.solvers.steering_column import GrowingTorque, TyreSpring, WheelTorque

PER_CYCLE = 400  # steps
PER_RAMP = 2000  # steps of a torque that grows, each by 0.05 % of its peak
BRANCHES = Remark(
    Code.METRIC_NOT_CONFIRMED,
    "the errors of shares of losses, ranges, largest and smallest values are unknown: friction is larger "
    "at rest, so that equilibria have more than one state after breakaway; choose the solver "
    "generalized-alpha for them",
)
"""After breakaway the rack may come to rest rolled one way or the other, with shares of losses 6 % apart."""


def steering_torque(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Give the wheel a torque, to and fro or growing, and record.

    Friction's zone follows the largest speed that the pinion may have.
    """
    maneuver, test = torque_maneuver(gear), gear.test
    gain = float(GearPair.of(gear).gain_at(test.start_angle))
    grows = test.steer_shape == "ramp"
    # the largest speed with which the pinion would follow the torque without friction
    speed = float((4.0 if grows else 2 * np.pi) * test.steer_frequency * _largest_turn(gear))

    def metrics(signals: Signals) -> dict[str, float]:
        if grows:
            of_torque = describe_breakaway(signals, test.direction * speed, gain)
        else:
            of_torque = describe_steering_torque(signals, 1 / test.steer_frequency)
        return {**of_torque, **metrics_of_motion(signals, gear)}

    make = run_maneuver if grows else run_swing
    run = make(gear.replace({"test.speed": speed}), fidelity, maneuver, options).described(metrics, gear)
    friction = abs(free_torque(gear))
    if test.steer_torque <= friction:
        run = run.noting(
            Remark(
                Code.HELD_BY_FRICTION,
                f"test.steer_torque = {test.steer_torque:.4g} N m does not exceed the gear's friction of "
                f"{friction:.4g} N m: the column twists and the gear stays",
            )
        )
    falls = largest_surplus(gear) > 0
    if grows and falls and fidelity.solver == "equilibrium":
        run = run.noting(BRANCHES).unsure_of(VARIATIONS | EXTREMES | LOSS_SHARES)
    return run


def torque_maneuver(gear: SteeringGear) -> Maneuver:
    """Return a torque on the wheel over the test's cycles.

    Raises:
        InputError: nothing restores the wheel, or the torque leaves the rack's teeth.
    """
    test = gear.test
    if not test.tyre_stiffness:
        raise InputError(
            "test.tyre_stiffness is 0 N/mm; steering-torque needs a restoring load: without it a torque "
            "above friction turns the wheel without end."
        )
    turn = _largest_turn(gear)
    ends = test.start_angle - turn, test.start_angle + turn
    check_travel(gear, ends, f"test.steer_torque = {test.steer_torque:.4g} N*m against test.tyre_stiffness")
    tyre = TyreSpring(test.tyre_stiffness, float(GearPair.of(gear).travel_at(test.start_angle)))
    peak, cycle = test.direction * test.steer_torque, 1 / test.steer_frequency
    shape = GrowingTorque if test.steer_shape == "ramp" else WheelTorque
    drive = shape("wheel", test.start_angle, peak, cycle, tyre)
    if test.steer_shape == "ramp":
        return Maneuver(drive, drive.period / 4 / PER_RAMP, 0, PER_RAMP)
    return Maneuver(drive, drive.period / PER_CYCLE, PER_CYCLE * 5 // 4, PER_CYCLE * test.cycles)


def _largest_turn(gear: SteeringGear) -> float:
    """Angle of the pinion that the peak would reach without friction [rad]."""
    return gear.test.steer_torque / (gear.test.tyre_stiffness * GearPair.of(gear).least_gain ** 2)


SCENE = Scene(
    name="steering-torque",
    title="Steering by torque: the wheel against the tyres",
    run=steering_torque,
    signal="wheel_angle",
    main_metric="feel_area",
    chart="steering_feel",
    revolutions=None,
    at_test_speed=False,
)
