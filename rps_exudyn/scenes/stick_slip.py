"""Stick-slip: the wheel turns at a slow constant speed from rest; the gear slides, or sticks and slips.

The column twists until static friction is overcome, which is the breakaway. If friction falls with speed the
gear may come to rest again, and again. The record begins at rest and goes on for so many cycles; figures are
those of its later half. Beside them stands what is predicted: the speed below which the reduced gear goes on
sticking (`analysis.friction_oscillator`), and the damping of the column below which steady sliding is
unstable (`solvers.sliding_stability`).

Near that speed little damping decides whether vibration dies away or stays, and time steps add some of their
own. There the motion is made again in half the steps until that changes nothing.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rps_exudyn.analysis.friction_oscillator import describe_stick_slip, sticking_speed
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.checks.before_run import check_travel
from rps_exudyn.scenes.maneuver import Maneuver, even
from rps_exudyn.scenes.metric_confirmation import run_and_confirm
from rps_exudyn.scenes.metrics import balance
from rps_exudyn.scenes.refine import refine
from rps_exudyn.scenes.remarks import remarks, wide_zone
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
WIDEST_ZONE = 0.01  # of friction: wider ones creep where they should stick
NEAR = 2.0  # times the sticking speed, up and down: so far it is not known without guides, and then some
SAME = 0.01  # of the largest torque, by which steps half as long may change the figures there
MOST_HALVED = 2  # times that steps are halved there
COMPARED = ("stick_slip_torque", "breakaway_torque")
AMPLITUDE = "stick_slip_amplitude"  # of a gear that never sticks: what the steps leave of the start


def stick_slip(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Turn the wheel from rest and record.

    Raises:
        InputError: a model without inertia, or a test that leaves the rack's teeth.
    """
    if fidelity.solver != "generalized-alpha":
        raise InputError(
            f"fidelity.solver is {fidelity.solver}; stick-slip needs generalized-alpha: equilibria have no "
            f"slip."
        )
    model = reduced_gear(gear)
    run = _resolved(gear, fidelity, options)
    nothing = None if model.surplus > 0 else NOTHING_FALLS
    judged = model.surplus > 0 and options.level is None
    zone = wide_zone(gear, fidelity, "sticking depends", WIDEST_ZONE) if judged else None
    predicted = predictions(gear, fidelity)

    def metrics(signals: Signals) -> dict[str, float]:
        found = {**_seen(signals, gear), **predicted, **balance(signals)}
        return found if nothing is None else {name: found[name] for name in found if name != AMPLITUDE}

    run = run_and_confirm(gear, fidelity, [set_off(gear)], options, metrics, SCENE.figure, run, always=True)
    return run.noting(*remarks(gear, run.signals), nothing, zone)


def _resolved(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Make the motion, near the sticking speed in steps that decide nothing; it is invalid if none are."""
    maneuver = set_off(gear)
    refined = refine(
        run_maneuver(gear, fidelity, maneuver, options=options),
        lambda _, times: run_maneuver(gear, fidelity, maneuver.halved(times), options=options),
        min(MOST_HALVED, options.least_steps.halvings) if _near_sticking(gear) else 0,
        usable=lambda run: run.ok,
        change=lambda coarse, fine: _change(_seen(coarse.signals, gear), _seen(fine.signals, gear)),
        allowed=SAME,
    )
    run = refined.finest
    if refined.times:
        cpu = sum(each.outcome.cpu_s for each in refined.runs)
        findings = {**run.outcome.findings, "halvings": refined.times}
        run = replace(run, outcome=replace(run.outcome, cpu_s=cpu, findings=findings))
    if refined.failed is not None:
        return run.unconfirmed(refined.failed)
    if refined.times and not refined.confirmed:
        return run.invalid(
            Code.STEPS_TOO_COARSE,
            f"the steps are too coarse: near the sticking speed steps half as long change the torque by "
            f"{refined.change:.1%} of its peak",
        )
    return run


def _near_sticking(gear: SteeringGear) -> bool:
    """Return whether the wheel turns about as fast as the reduced gear just sticks."""
    limit = sticking_speed(reduced_gear(gear))
    return limit / NEAR < gear.test.speed < limit * NEAR


def _change(coarse: Mapping[str, float], fine: Mapping[str, float]) -> float:
    """Return by how much figures differ, over the largest torque; 0 of a record too short for any."""
    peak = abs(fine.get("breakaway_torque", 0.0))
    return max(abs(fine[name] - coarse[name]) for name in COMPARED) / peak if peak and coarse else 0.0


NOTHING_FALLS = Remark(
    Code.FRICTION_NEVER_FALLS,
    "the gear cannot stick and slip, because no part's friction is larger at rest than in motion: choose "
    "friction_law stribeck or bristle and a static_ratio above 1 for mesh, yoke, bush or bearing; "
    f"{AMPLITUDE} is omitted",
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
    steps = even((twisting + cycles * cycle) / step)
    angles = test.start_angle, test.start_angle + test.direction * test.speed * steps * step
    check_travel(gear, angles, f"stick-slip over {cycles:.3g} cycles")
    return Maneuver(SetOff("wheel", test.start_angle, test.direction * test.speed), step, 0, steps)


def _seen(signals: Signals, gear: SteeringGear) -> dict[str, float]:
    """Return what the record shows."""
    return describe_stick_slip(signals, gear.test.direction * gear.test.speed)


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
    figure="stick_slip_torque",
    chart="stick_slip",
    needs_inertia=True,
    revolutions=None,
)
