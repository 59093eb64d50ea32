"""Radial play: a force across the rack's end, the pinion held; how far the end gives way.

The force acts away from the pinion and towards it (Y), then sideways (Z). What gives way is the bar, which
bends; the mesh, the yoke's spring and seat, the bush; and the clearance behind the plunger.
"""

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Code, Remark
from rps_exudyn.scenes.at_rest import OutsideLoads, bending, run_at_rest, to_and_fro
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals

STEPS = 10  # from no force to the largest
WAYS = {"y": ("up", "down"), "z": ("side", "other_side")}  # of the force along each axis: its plus, its minus
RIGID = Remark(
    Code.RACK_RIGID,
    "the rack is rigid (fidelity.rack): a rigid bar shows only the yielding of its guides, on the default "
    "gear a twentieth of the play; choose flexible",
)


def radial_play(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Press the rack's end to and fro along Y, then along Z."""
    chosen = bending(fidelity)
    force = to_and_fro(gear.test.play_force, options.finer(STEPS))
    still = np.zeros_like(force)
    along = np.concatenate([np.stack([force, still], 1), np.stack([still, force], 1)[1:]])
    loads = OutsideLoads(np.zeros(len(along)), along)
    run = run_at_rest(gear, chosen, "pinion", loads, options, play_metrics)
    return run.noting(None if chosen.rack == "flexible" else RIGID)


def play_metrics(signals: Signals) -> dict[str, float]:
    """Return how far the largest force each way moves the rack's end from rest; {} of a shorter record."""
    metrics = {}
    for axis, names in WAYS.items():
        force, place = signals[f"end_force_{axis}"], signals[f"rack_end_{axis}"]
        largest = np.abs(force).max()
        for sense, name in zip((1, -1), names, strict=True):
            pressed = np.flatnonzero(force == sense * largest)
            if largest and pressed.size:
                metrics[f"radial_play_{name}"] = float(abs(place[pressed[0]] - place[0]))
    for axis, names in WAYS.items():
        displacements = [metrics[f"radial_play_{name}"] for name in names if f"radial_play_{name}" in metrics]
        if len(displacements) == 2:
            metrics[f"radial_play_{axis}"] = max(displacements)
    return metrics


SCENE = Scene(
    name="radial-play",
    title="Radial play: the rack's end under a force across it",
    run=radial_play,
    signal="rack_end_y",
    main_metric="radial_play_y",
    chart="play",
    at_rest=True,
    revolutions=None,
    at_test_speed=False,
)
