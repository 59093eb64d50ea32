"""What an accuracy is about: the scene's signal over time, or a number of its summary.

    error_between("pinion_torque", "reversal", gear, (coarse, fidelity), (fine, finer))

A signal's error is the RMS over the motion in % of its mean, the larger of joining its instants by straight
lines and smoothly; a number's is in % of the number.
"""

from rps_exudyn.analysis.curve import difference
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result
from rps_exudyn.scenes import scene_named
from rps_exudyn.scenes.scene_run import SceneRun

Recorded = SceneRun | Result
"""A run of a scene, with its signals and summary."""


def is_signal(scene: str, quantity: str) -> bool:
    """Return whether a quantity is the scene's signal; the others are numbers of its summary."""
    return quantity == scene_named(scene).signal


def error_between(
    quantity: str,
    scene: str,
    gear: SteeringGear,
    run: tuple[Recorded, Fidelity],
    truer: tuple[Recorded, Fidelity],
) -> float:
    """Return how far a quantity of a run lies from that of a truer one [%]; nan where only one has it."""
    if is_signal(scene, quantity):
        own, true = (
            scene_named(scene).curve(each.signals, gear, fidelity) for each, fidelity in (run, truer)
        )
        return difference(own, true)
    own_value, value = (each.summary.get(quantity) for each, _ in (run, truer))
    if own_value == value:  # or neither has one: where nothing is hit, there is no peak
        return 0.0
    if own_value is None or value is None:
        return float("nan")
    return 100 * abs(own_value - value) / abs(value) if value else float("nan")
