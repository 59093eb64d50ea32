"""Free pinion torque: the rig turns the pinion at the test's speed, the rack carries no load.

One way over `test.turns`, there and back, or lock to lock and back (`test.path`).
"""

from functools import partial

from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.metrics import metrics_of_turning
from rps_exudyn.scenes.run_maneuver import run_steady
from rps_exudyn.scenes.scene import Scene, SteadyTest
from rps_exudyn.solvers.closed_form import beyond_formulas, mean_state

TEST = SteadyTest(
    maneuvers=lambda gear, step_angle, least: (maneuvers_of_test(gear, "pinion", step_angle, least), None),
    metrics=lambda record: metrics_of_turning(record.signals, record.gear, record.gain),
    curve=("time", "pinion_angle", "pinion_torque"),
    formulas=lambda gear: (
        {}
        if beyond_formulas(gear)
        else {"torque_closed_form": mean_state(gear, gear.test.direction, 0.0).torque}
    ),
)

SCENE = Scene(
    name="free-pinion-torque",
    title="Free pinion torque",
    run=partial(run_steady, TEST),
    signal="pinion_torque",
    main_metric="torque_mean",
    chart="torque",
    steady=True,
    test=TEST,
)
