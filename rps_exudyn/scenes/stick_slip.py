"""Stick-slip: the wheel turns at a slow constant speed from rest; the gear slides, or sticks and slips.

The column twists until static friction is overcome, which is the breakaway. If friction falls with speed the
gear may come to rest again, and again. The record begins at rest and goes on for so many cycles; figures are
those of its later half. Beside them stands what is predicted (`analysis.stick_slip`): the speed below which
the reduced gear goes on sticking, and the damping of the column below which steady sliding is unstable.
"""

import numpy as np

from rps_exudyn.analysis.stick_slip import describe_stick_slip, sticking_speed, unstable_speed
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.figures import balance
from rps_exudyn.scenes.maneuver import Maneuver, check_travel
from rps_exudyn.scenes.remarks import remarks, wide_zone
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.run_options import RunOptions
from rps_exudyn.scenes.scene import Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.drive import SetOff
from rps_exudyn.solvers.reduced_gear import presliding_angle, reduced_gear

PER_PERIOD = 40  # steps in a natural period of gear and column
CYCLES = 12  # of sticking and slipping that are recorded, and more where little damps
MOST_CYCLES = 40
MOST_STEPS = 20000  # fewer cycles are recorded of a gear that sticks for long ...
LEAST_CYCLES = 3  # ... but no fewer
WIDEST_ZONE = 0.01  # of friction: wider ones creep where they should stick


def stick_slip(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Turn the wheel from rest and record.

    Raises:
        InputError: a model without inertia, or a test that leaves the rack's teeth.
    """
    if fidelity.solver != "generalized-alpha":
        raise InputError(
            f"fidelity.solver is {fidelity.solver}; stick-slip needs generalized-alpha: without inertia "
            "nothing slips."
        )
    model = reduced_gear(gear)
    run = run_maneuver(gear, fidelity, set_off(gear), options)
    nothing = "" if model.surplus > 0 else NOTHING_FALLS
    zone = wide_zone(fidelity, "sticking depends", WIDEST_ZONE) if model.surplus > 0 else ""
    return run.noting(*remarks(gear, run.signals), nothing, zone).described(
        lambda signals: {**stick_slip_figures(signals, gear), **balance(signals)}
    )


NOTHING_FALLS = (
    "no part's friction is larger at rest than in motion, so that the gear cannot stick and slip: choose "
    "friction_law stribeck or bristle and a static_ratio above 1 for mesh, yoke, bush or bearing"
)


def set_off(gear: SteeringGear) -> Maneuver:
    """Return the motion of the wheel from rest.

    Raises:
        InputError: it leaves the rack's teeth.
    """
    test, model = gear.test, reduced_gear(gear)
    period = 2 * np.pi / model.frequency
    step = period / PER_PERIOD
    twisting = float(model.friction(0.0)) / (model.stiffness * test.speed)  # until it breaks away [s]
    cycle = 2 * model.surplus / (model.stiffness * test.speed) + period
    ratio = model.damping / (2 * np.sqrt(model.stiffness * model.inertia))
    cycles = min(MOST_CYCLES, CYCLES + 1 / (2 * np.pi * max(ratio, 1e-6)))
    affordable = (MOST_STEPS * step - twisting) / cycle
    cycles = max(min(cycles, affordable), LEAST_CYCLES)
    steps = int(np.ceil((twisting + cycles * cycle) / step))
    angles = test.start_angle, test.start_angle + test.direction * test.speed * steps * step
    check_travel(gear, angles, f"stick-slip over {cycles:.3g} cycles")
    return Maneuver(SetOff("wheel", test.start_angle, test.direction * test.speed), step, 0, steps)


def stick_slip_figures(signals: Signals, gear: SteeringGear) -> dict[str, float]:
    """Return what the record shows, and what is predicted."""
    test, model, presliding = gear.test, reduced_gear(gear), presliding_angle(gear)
    predicted = {"sliding_damping": model.linear_limit(test.speed)}
    if presliding:
        predicted["sticking_speed"] = unstable_speed(model, presliding)
        predicted["bristle_margin"] = model.bristle_margin(test.speed, presliding)
    else:
        predicted["sticking_speed"] = sticking_speed(model)
    return describe_stick_slip(signals, test.direction * test.speed) | predicted


SCENE = Scene(
    name="stick-slip",
    title="Stick-slip: the gear behind a slowly turning wheel",
    run=stick_slip,
    signal="column_torque",
    figure="stick_slip_torque",
    chart="stick_slip",
    needs_inertia=True,
    revolutions=None,
)
