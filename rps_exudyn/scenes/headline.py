"""A scene's signal over the time of the rig's motion: what runs in different steps are compared by."""

from rps_exudyn.analysis.curve import Curve
from rps_exudyn.analysis.passes import Signals
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.maneuver import swing_maneuver


def curve_of(scene: str, signals: Signals, gear: SteeringGear, fidelity: Fidelity, name: str = "") -> Curve:
    """Return a signal over the time of the rig's motion, by default the scene's headline signal."""
    start = 0.0
    if scene_named(scene).swings:  # recording begins at another phase with every step
        maneuver = swing_maneuver(gear, fidelity.step_angle)
        start = maneuver.lead * maneuver.time_step
    return Curve(start + signals["time"], signals[name or scene_named(scene).signal])
