"""Rack on rollers: two rollers stand in the pinion's place; the rig moves the rack between them and the yoke.

Rollers press like the teeth and take no work: what is measured is the drag of the bush and the friction of
the plunger, D + mu_yoke kappa P. Friction of the rollers is left out.
"""

from dataclasses import replace

from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.metrics import metrics_of_motion
from rps_exudyn.scenes.rack_push import TEST as RACK_PUSH
from rps_exudyn.scenes.rack_push import push_metrics
from rps_exudyn.scenes.run_maneuver import run_steady
from rps_exudyn.scenes.scene import Scene, SteadyRecord

_WITHOUT = (
    "mesh.friction", "bearing.friction_torque", "pinion.runout", "pinion.pitch_error", "pinion.profile_slope",
    "pinion.lead_error",
)  # fmt: skip


def on_rollers(gear: SteeringGear) -> SteeringGear:
    """Return the gear with rollers in the pinion's place: teeth and bearings that do not rub, no errors."""
    return gear.replace(
        dict.fromkeys(_WITHOUT, 0.0) | {"pinion.pitch_errors": "none", "pinion.deviation": "none"}
    )


def _metrics(record: SteadyRecord) -> dict[str, float]:
    force = push_metrics(record.signals)["push_force_mean"]
    return {"roller_force_mean": force, **metrics_of_motion(record.signals, record.gear, record.gain)}


TEST = replace(RACK_PUSH, metrics=_metrics)


SCENE = Scene(
    name="rack-on-rollers",
    title="Rack on rollers: force",
    run=lambda gear, fidelity, options: run_steady(TEST, on_rollers(gear), fidelity, options),
    signal="rack_force",
    main_metric="roller_force_mean",
    chart="rack_push",
    steady=True,
)
