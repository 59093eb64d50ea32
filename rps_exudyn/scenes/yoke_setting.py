"""Yoke setting: tighten the cap to a torque, turn it back by an angle, and measure the rotation torque.

As a workshop sets a gear: what the cap's thread makes of the torque, the clearance and the preload that the
angle leaves (`solvers.yoke_stop`), then the pinion turned from lock to lock and back, near the centre and
beyond.
"""

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.free_pinion_torque import SCENE as FREE_PINION_TORQUE
from rps_exudyn.scenes.maneuver import largest_angle, maneuvers_of_test
from rps_exudyn.scenes.metrics import figures_of_turning
from rps_exudyn.scenes.remarks import remarks
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.solvers.yoke_stop import yoke_setting


def yoke_set(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Set the yoke, then turn the pinion; `test.path` one-way is taken as lock-to-lock.

    Raises:
        InputError: a setting that leaves the spring loose or the limits, or a test that leaves the teeth.
    """
    setting = yoke_setting(gear)
    path = "lock-to-lock" if gear.test.path == "one-way" else gear.test.path
    as_set = setting.of(gear).replace({"test.path": path})
    maneuvers = maneuvers_of_test(as_set, "pinion", fidelity.step_angle, options.least_steps)
    run = run_maneuver(as_set, fidelity, *maneuvers, options=options)
    pressing = Remark(
        Code.CAP_PRESSES,
        "the cap still presses the plunger: it is turned back by less than its compression",
    )
    figures = {
        "cap_force": setting.cap_force,
        "clearance_set": setting.clearance,
        "preload_set": setting.preload,
    }
    noted = run.noting(pressing if setting.clearance < 0 else None, *remarks(as_set, run.signals))
    return noted.described(lambda signals: {**figures_of_turning(signals, as_set), **figures})


def _revolutions(gear: SteeringGear) -> float:
    if gear.test.path == "there-and-back":
        return gear.test.turns
    return largest_angle(gear) / np.pi


SCENE = Scene(
    name="yoke-setting",
    title="Yoke setting: rotation torque after tightening and turning back",
    run=yoke_set,
    signal="pinion_torque",
    figure="torque_on_centre",
    chart="torque",
    steady=True,
    revolutions=_revolutions,
    short_path="there-and-back",
    promised_as=FREE_PINION_TORQUE.name,  # the pinion is turned in the same way, the yoke set anew
)
