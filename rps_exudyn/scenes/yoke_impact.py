"""Yoke impact: pulses of force on the rack's end, the pinion held; the plunger hits the yokenut.

A pulse is a half sine along `test.pulse_axis` on the bar's end beside the pinion; another period is recorded
after the last. The rack bends by default: its first modes swing as fast as the pulse.
"""

import numpy as np

from rps_exudyn.analysis.impacts import describe_impacts
from rps_exudyn.analysis.passes import passes
from rps_exudyn.analysis.rack_motion import describe_rack
from rps_exudyn.analysis.work_balance import describe_balance
from rps_exudyn.base.errors import InputError
from rps_exudyn.forces.external_load import Pulse
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.rack_bar import RackBar
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.checks.before_run import check_dynamics, check_travel
from rps_exudyn.scenes.maneuver import Maneuver, even
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.prescribed_motion import Steady

ZONE = 0.1  # of friction, halved with the steps: narrower ones only need shorter steps
STEPS_PER_SWING = 20  # of the plunger between seat and yokenut, the fastest motion: forces to 0.1 %
STEPS_PER_SWING_OF_A_BENDING_RACK = 12  # which is hit less hard at first: forces to 0.05 %
RIGID = Remark(
    Code.RACK_RIGID,
    "the rack is rigid (fidelity.rack): without bending the default gear's impulse is 45 % too small "
    "and its end moves a twentieth as far; choose flexible, with fidelity.mesh = flank "
    "and fidelity.bush = condensed",
)


def yoke_impact(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Shake the rack and record."""
    check_dynamics(fidelity, "yoke-impact", "impacts")
    chosen = fidelity.with_bending()
    chosen = chosen.replace({"zone_ratio": max(chosen.zone_ratio, ZONE / 2.0**options.halvings)})
    own = STEPS_PER_SWING_OF_A_BENDING_RACK if chosen.rack == "flexible" else STEPS_PER_SWING

    def metrics(signals: Signals) -> dict[str, float]:
        end = [
            signals[name] for name in ("rack_end_y", "rack_end_z") if name in signals
        ]  # of a bar that bends
        return {
            **describe_impacts(signals),
            **describe_rack(signals, passes(signals), GearPair.of(gear).travel_rule),
            **({"rack_end_deflection": float(np.hypot(*end).max())} if len(end) else {}),
            **describe_balance(signals),
        }

    run = run_maneuver(gear, chosen, shaken(gear, chosen.swing_steps or own), options).described(metrics)
    force = run.signals.get("yokenut_force", np.zeros(1))
    pressed = Remark(
        Code.CLEARANCE_CLOSED,
        f"yoke.clearance = {1e6 * gear.yoke.clearance:.4g} um is closed from the start; the yokenut carries "
        f"up to {force.max():.4g} N, and only contacts that open and close again count as impacts",
    )
    return run.noting(None if chosen.rack == "flexible" else RIGID, pressed if force[0] > 0 else None)


def shaken(gear: SteeringGear, steps_per_swing: int = STEPS_PER_SWING) -> Maneuver:
    """Return the maneuver: the pinion held at the test's start angle, the rack shaken.

    Raises:
        InputError: pulses that overlap, or a start beyond the rack's teeth.
    """
    test, yoke = gear.test, gear.yoke
    check_travel(gear, (test.start_angle,), "test.start_angle")
    if test.pulse_period < test.pulse_duration:
        raise InputError(
            f"test.pulse_period is {1e3 * test.pulse_period:g} ms; it must be at least test.pulse_duration = "
            f"{1e3 * test.pulse_duration:g} ms."
        )
    peak = test.pulse_force * np.eye(3)["xyz".index(test.pulse_axis)]
    pulse = Pulse(
        tuple(peak.tolist()), RackBar.of(gear).x_min, test.pulse_duration, test.pulse_period, test.pulses
    )
    swing = 2 * np.pi * np.sqrt(yoke.plunger_mass / (yoke.seat_stiffness + yoke.nut_stiffness))
    steps = even(test.pulse_period * (test.pulses + 1) / (swing / steps_per_swing))
    time_step = test.pulse_period * (test.pulses + 1) / steps
    return Maneuver(Steady("pinion", test.start_angle, 0.0), time_step, 0, steps, pulse=pulse)


SCENE = Scene(
    name="yoke-impact",
    title="Yoke impact: yokenut's force",
    run=yoke_impact,
    signal="yokenut_force",
    main_metric="impact_peak_force",
    chart="impact",
    needs_inertia=True,
    has_impacts=True,
    revolutions=None,
    at_test_speed=False,
    law="teeth",
)
