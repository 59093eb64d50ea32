"""Yoke setting: tighten the yokenut to a torque, turn it back by an angle, and measure the rotation torque.

That leaves a clearance and a preload; then the pinion turns from lock to lock and back. A torque T on the
thread presses with F = T / lever, the lever of a metric thread (VDI 2230) without friction under a head:

    lever = d_2 / 2 tan(lambda + rho'),  tan(lambda) = p / (pi d_2),  tan(rho') = mu / cos(30 deg)
"""

from dataclasses import dataclass

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.checks.before_run import largest_angle
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.metrics import metrics_of_turning
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.yoke_stop import stop_stiffness

PITCH_DIAMETER = 0.6495  # outer minus pitch diameter of a metric thread, in pitches (ISO 724)
FLANK_ANGLE = np.deg2rad(30)  # of a metric thread


@dataclass(frozen=True)
class YokeSetting:
    """What tightening the cap and turning it back makes of a gear; SI units."""

    cap_force: float  # along the yoke, under the tightening torque [N]
    compression: float  # of nut, seat and flanks by that force, beyond where the cap touches [m]
    clearance: float  # after turning back; below 0 the cap still presses [m]
    preload: float  # of the spring at the rest position [N]

    def of(self, gear: SteeringGear) -> SteeringGear:
        """Return the gear as it is set.

        Raises:
            InputError: the cap is turned back so far that its spring is loose, or beyond the limits.
        """
        if self.preload < 0:
            raise InputError(
                f"test.back_off unloads the yoke's spring: its force would be {self.preload:.4g} N; "
                "turn the cap back by less, or tighten it with more torque."
            )
        try:
            return gear.replace({"yoke.clearance": self.clearance, "yoke.preload": self.preload})
        except InputError as error:
            raise InputError(
                f"test.cap_torque and test.back_off give a gear outside the limits: {problem}"
                for problem in error.problems
            ) from None


def thread_lever(gear: SteeringGear) -> float:
    """Return torque over force of the cap's thread while it is tightened [m]."""
    yoke = gear.yoke
    diameter = yoke.nut_diameter - PITCH_DIAMETER * yoke.thread_pitch
    lead = np.arctan(yoke.thread_pitch / (np.pi * diameter))
    return float(diameter / 2 * np.tan(lead + np.arctan(yoke.thread_friction / np.cos(FLANK_ANGLE))))


def spring_at(gear: SteeringGear, clearance: float) -> float:
    """Return the spring's force where the cap leaves a clearance [N], by the line on which the gear lies."""
    yoke = gear.yoke
    return float(yoke.preload + yoke.spring_rate * (max(0.0, yoke.clearance) - max(0.0, clearance)))


def travel_of_turn(gear: SteeringGear, angle: float) -> float:
    """Return how far the thread moves the cap in a turn by an angle [m]."""
    return float(gear.yoke.thread_pitch * angle / (2 * np.pi))


def turned_back(gear: SteeringGear, angle: float) -> SteeringGear:
    """Return the gear after its cap is turned back by an angle [rad], below 0 in."""
    clearance = gear.yoke.clearance + travel_of_turn(gear, angle)
    return gear.replace({"yoke.clearance": clearance, "yoke.preload": spring_at(gear, clearance)})


def yoke_setting(gear: SteeringGear) -> YokeSetting:
    """Return what `test.cap_torque` and `test.back_off` make of the gear's yoke."""
    yoke, test = gear.yoke, gear.test
    force = test.cap_torque / thread_lever(gear)
    touching = spring_at(gear, 0.0)
    if force > touching or not yoke.spring_rate:
        pressed = max(0.0, force - touching)
        compression = pressed / stop_stiffness(gear, touching + pressed / 2)
        tightened = -compression
    else:  # the spring alone holds the cap
        compression, tightened = 0.0, yoke.clearance - (force - yoke.preload) / yoke.spring_rate
    clearance = tightened + travel_of_turn(gear, test.back_off)
    return YokeSetting(force, compression, clearance, spring_at(gear, clearance))


def yoke_set(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Set the yoke, then turn the pinion; `test.path` one-way is taken as lock-to-lock."""
    setting = yoke_setting(gear)
    path = "lock-to-lock" if gear.test.path == "one-way" else gear.test.path
    as_set = setting.of(gear).replace({"test.path": path})
    maneuvers = maneuvers_of_test(as_set, "pinion", fidelity.step_angle, options.least_steps)
    pressing = Remark(
        Code.CAP_PRESSES, "the cap still presses the plunger: test.back_off is smaller than its compression"
    )
    of_setting = {
        "cap_force": setting.cap_force,
        "clearance_set": setting.clearance,
        "preload_set": setting.preload,
    }

    def metrics(signals: Signals) -> dict[str, float]:
        return {**metrics_of_turning(signals, as_set), **of_setting}

    run = run_maneuver(as_set, fidelity, maneuvers, options)
    return run.noting(pressing if setting.clearance < 0 else None).described(metrics, as_set)


SCENE = Scene(
    name="yoke-setting",
    title="Yoke setting: rotation torque after tightening and turning back",
    run=yoke_set,
    signal="pinion_torque",
    main_metric="torque_on_centre",
    chart="torque",
    steady=True,
    revolutions=lambda gear: (
        gear.test.turns if gear.test.path == "there-and-back" else largest_angle(gear) / np.pi
    ),
)
