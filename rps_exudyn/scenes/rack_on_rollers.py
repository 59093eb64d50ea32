"""Rack on rollers: two rollers stand in the pinion's place; the rig moves the rack between them and the yoke.

Rollers press like the teeth and take no work: what is measured is D + mu_yoke kappa P, the drag of the bush
and the friction of the plunger, without that of the teeth. So the scene is a push of the rack with a pinion
that neither rubs, nor runs out, nor has bearings that rub (`on_rollers`); friction of the rollers is left
out.
"""

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.checks.rules import remarks
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.scenes.metrics import figures_of_motion
from rps_exudyn.scenes.rack_push import push_figures
from rps_exudyn.scenes.run_maneuver import run_maneuver
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals

_WITHOUT = (
    "mesh.friction", "bearing.friction_torque", "pinion.runout", "pinion.pitch_error", "pinion.profile_slope",
    "pinion.lead_error",
)  # fmt: skip


def on_rollers(gear: SteeringGear) -> SteeringGear:
    """Return the gear with rollers in the pinion's place: teeth and bearings that do not rub, no errors."""
    return gear.replace(dict.fromkeys(_WITHOUT, 0.0) | {"pinion.pitch_errors": "none"})


def rack_on_rollers(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Push the rack over the rollers and record.

    Raises:
        InputError: the test leaves the rack's teeth.
    """
    carried = on_rollers(gear)
    maneuvers = maneuvers_of_test(carried, "rack", fidelity.step_angle, options.least_steps)

    def metrics(signals: Signals) -> dict[str, float]:
        force = push_figures(signals)["push_force_mean"]
        return {"roller_force_mean": force, **figures_of_motion(signals, carried)}

    run = run_maneuver(carried, fidelity, maneuvers, options).described(metrics)
    return run.noting(*remarks(carried, run.signals))


SCENE = Scene(
    name="rack-on-rollers",
    title="Rack on rollers: force",
    run=rack_on_rollers,
    signal="rack_force",
    figure="roller_force_mean",
    chart="rack_push",
    steady=True,
)
