"""Stick-slip: the wheel turns at a slow constant speed from rest; the gear slides, or sticks and slips.

Metrics are those of the record's later half, beside two predictions: the speed below which the reduced gear
goes on sticking (`analysis.friction_oscillator`), and the damping of the column below which steady sliding
is unstable (`solvers.sliding_stability`).
"""

import numpy as np

from rps_exudyn.analysis.friction_oscillator import describe_stick_slip, sticking_speed
from rps_exudyn.analysis.work_balance import describe_balance
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.checks.before_run import check_dynamics, check_travel
from rps_exudyn.scenes.maneuver import Maneuver, even
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.prescribed_motion import SetOff
from rps_exudyn.solvers.sliding_stability import presliding_angle, reduced_gear, sliding_damping

PER_PERIOD = 40  # steps in a natural period of gear and column
CYCLES = 12  # of sticking and slipping that are recorded, and more where little damps
MOST_CYCLES = 40
MOST_STEPS = 20000  # fewer cycles are recorded of a gear that sticks for long ...
LEAST_CYCLES = 3  # ... but no fewer
AMPLITUDE = "stick_slip_amplitude"  # of a gear that never sticks: what the steps leave of the start


def stick_slip(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Turn the wheel from rest and record."""
    check_dynamics(fidelity, "stick-slip", "slip", "reduced")
    model = reduced_gear(gear)
    nothing = None if model.surplus > 0 else NOTHING_FALLS
    predicted = predictions(gear, fidelity)

    def metrics(signals: Signals) -> dict[str, float]:
        of_sticking = describe_stick_slip(signals, gear.test.direction * gear.test.speed)
        found = {**of_sticking, **predicted, **describe_balance(signals)}
        return found if nothing is None else {name: found[name] for name in found if name != AMPLITUDE}

    return run_maneuver(gear, fidelity, set_off(gear), options).described(metrics, gear).noting(nothing)


NOTHING_FALLS = Remark(
    Code.FRICTION_NEVER_FALLS,
    "the gear cannot stick and slip, because no part's friction is larger at rest than in motion: choose "
    "friction_law stribeck or bristle and a static_ratio above 1 for mesh, yoke, bush or bearing; "
    f"{AMPLITUDE} is omitted",
)


def set_off(gear: SteeringGear) -> Maneuver:
    """Return the motion of the wheel from rest."""
    test, model = gear.test, reduced_gear(gear)
    period = 2 * np.pi / model.frequency
    step = period / PER_PERIOD
    twisting = float(model.friction(0.0)) / (model.stiffness * test.speed)  # until it breaks away [s]
    cycle = 2 * model.surplus / (model.stiffness * test.speed) + period
    ratio = model.damping / (2 * np.sqrt(model.stiffness * model.inertia))
    cycles = min(MOST_CYCLES, CYCLES + 1 / (2 * np.pi * max(ratio, 1e-6)))
    affordable = (MOST_STEPS * step - twisting) / cycle
    cycles = max(min(cycles, affordable), LEAST_CYCLES)
    steps = even((twisting + cycles * cycle) / step)
    angles = test.start_angle, test.start_angle + test.direction * test.speed * steps * step
    check_travel(gear, angles, f"stick-slip over {cycles:.3g} cycles")
    return Maneuver(SetOff("wheel", test.start_angle, test.direction * test.speed), step, 0, steps)


def predictions(gear: SteeringGear, fidelity: Fidelity) -> dict[str, float]:
    """Return what is predicted: where the reduced gear sticks, and where the gear's steady sliding is stable;
    of that nothing where no equilibrium is found about which it could be said."""
    model = reduced_gear(gear)
    predicted = {"sticking_speed": sticking_speed(model)}
    damping = sliding_damping(gear, fidelity) if model.surplus > 0 else 0.0
    if np.isfinite(damping):
        predicted["sliding_damping"] = damping
    if presliding_angle(gear):
        predicted["bristle_margin"] = model.sliding_margin(gear.test.speed)
    return predicted


SCENE = Scene(
    name="stick-slip",
    title="Stick-slip: the gear behind a slowly turning wheel",
    run=stick_slip,
    signal="column_torque",
    main_metric="stick_slip_torque",
    chart="stick_slip",
    needs_inertia=True,
    revolutions=None,
)
