"""Rack lift: a torque on the pinion, the rack held; how far the teeth lift the rack off the pinion.

The teeth push it away by torque / s' tan(alpha_n) / cos(beta_r), s' the rack's travel per radian: more than
the yoke's spring holds, so that the plunger comes to rest on the yokenut.
"""

import numpy as np

from rps_exudyn.gears.local_gear import local_gear_at
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.at_rest import OutsideLoads, bending, run_at_rest, to_and_fro
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals
from rps_exudyn.solvers.yoke_stop import lift_of_torque

STEPS = 40  # from no torque to the largest


def rack_lift(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Turn the pinion against the held rack, one way and the other."""
    torque = to_and_fro(gear.test.lift_torque, options.finer(STEPS))
    loads = OutsideLoads(torque, end_force=np.zeros((len(torque), 2)))
    local = local_gear_at(gear, gear.test.start_angle)
    formula = {"rack_lift_closed_form": lift_of_torque(local, gear.test.lift_torque)}

    def metrics(signals: Signals) -> dict[str, float]:
        return lift_metrics(signals) | formula

    return run_at_rest(gear, bending(fidelity), "rack", loads, options, metrics)


def lift_metrics(signals: Signals) -> dict[str, float]:
    """Return the lift of the bar's axis above the pitch point under the largest torque each way. The larger
    of both follows, then the lift of the rack's end."""
    torque, lift, end = (signals[name] for name in ("pinion_torque", "rack_y", "rack_end_y"))
    metrics, largest = {}, float(np.abs(torque).max())
    for sense, name in ((1, "rack_lift_forward"), (-1, "rack_lift_backward")):
        turned = np.flatnonzero(torque == sense * largest)
        if largest and turned.size:
            metrics[name] = float(lift[turned[0]] - lift[0])
            metrics["rack_lift_end"] = max(
                float(end[turned[0]] - end[0]), metrics.get("rack_lift_end", -np.inf)
            )
    if len(metrics) == 3:
        metrics["rack_lift"] = max(metrics["rack_lift_forward"], metrics["rack_lift_backward"])
    return metrics


SCENE = Scene(
    name="rack-lift",
    title="Rack lift: the rack under a torque on the pinion",
    run=rack_lift,
    signal="rack_y",
    main_metric="rack_lift",
    chart="lift",
    at_rest=True,
    revolutions=None,
    at_test_speed=False,
)
