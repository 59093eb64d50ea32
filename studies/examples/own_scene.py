"""An own scene: the pinion is steered to and fro while a tie rod pulls at the rack.

    python own_scene.py

A scene is a function that makes maneuvers and says which numbers matter. `rps.add_scene` makes it known to
this process, where `rps.run`, `rps.batch` and pictures then take it as any other.
"""

from dataclasses import replace

import rps_exudyn as rps
from rps_exudyn.analysis.hysteresis import describe_reversal
from rps_exudyn.scenes.maneuver import swing_maneuver
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.run_maneuver import run_maneuver

PULL = 200.0  # of the tie rod towards -X [N]


def pulled(gear, fidelity, options):
    """Steer to and fro by `test.amplitude` under the tie rod's pull, and record."""
    maneuver = replace(swing_maneuver(gear, fidelity.step_angle), rack_load=PULL)
    run = run_maneuver(gear, fidelity, maneuver, options)
    return run.described(lambda signals: {**describe_reversal(signals), **metrics_of_motion(signals, gear)})


rps.add_scene(
    rps.Scene(
        name="pulled-reversal",
        title="Reversal under the pull of a tie rod",
        run=pulled,
        signal="pinion_torque",
        main_metric="torque_jump",
        chart="reversal",
    )
)

gear = rps.SteeringGear().replace({"test.amplitude": "10 deg"})
result = rps.run("pulled-reversal", gear, fidelity="quasi-static")
free = rps.run("reversal", gear, fidelity="quasi-static")
for name, each in (("pulled", result), ("free", free)):
    middle = (each["pinion_torque"].max() + each["pinion_torque"].min()) / 2
    print(f"{name}: {each.status}, jump {each.summary['torque_jump']:.3f} N m around {middle:.3f} N m")
