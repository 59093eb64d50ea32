"""Input shaft play: forces on the end of the pinion's shaft, along Y, across Y and along the shaft.

The pinion is held against rotation, the rack is free to follow. Clearances and float give way, and so do
bearings, shaft, the housing's seat, and the mesh with the yoke behind it.
"""

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.at_rest import AT_SHAFT, OutsideLoads, run_at_rest, to_and_fro
from rps_exudyn.scenes.scene import RunOptions, Scene
from rps_exudyn.scenes.scene_run import SceneRun, Signals

STEPS = 10  # from no force to the largest
PLAYS = {"radial": AT_SHAFT[:2], "axial": AT_SHAFT[2:]}


def input_shaft_play(gear: SteeringGear, fidelity: Fidelity, options: RunOptions) -> SceneRun:
    """Press the input shaft's end to and fro along Y, across Y, and along the shaft."""
    chosen = fidelity.with_support(needed=True)
    if chosen.pinion != "supported":
        raise InputError(
            f"fidelity.pinion is {fidelity.pinion}, fidelity.mesh {fidelity.mesh} and fidelity.solver "
            f"{fidelity.solver}; input-shaft-play needs a supported pinion, flank contact and no closed form."
        )
    chosen = chosen.with_condensed_chain()
    across = to_and_fro(gear.test.shaft_force, options.finer(STEPS))
    along = to_and_fro(gear.test.shaft_axial_force, options.finer(STEPS))
    force = np.zeros((3 * len(across) - 1, 3))
    force[1 : 1 + len(across), 1] = across
    force[len(across) : 2 * len(across), 0] = across
    force[2 * len(across) - 1 :, 2] = along
    loads = OutsideLoads(np.zeros(len(force)), np.zeros((len(force), 2)), force)
    return run_at_rest(gear, chosen, "pinion", loads, options, shaft_metrics)


def shaft_metrics(signals: Signals) -> dict[str, float]:
    """Return how far the input shaft's end moves between the largest forces of both directions; the radial
    play is that of the worse axis. {} of a record that ends before."""
    metrics = {}
    for play, axes in PLAYS.items():
        moved = []
        for axis in axes:
            force, place = signals[f"shaft_force_{axis}"], signals[f"shaft_end_{axis}"]
            if force.max() > 0 > force.min():
                moved.append(float(place[force.argmax()] - place[force.argmin()]))
        if len(moved) == len(axes):
            metrics[f"input_shaft_play_{play}"] = max(moved)
    return metrics


SCENE = Scene(
    name="input-shaft-play",
    title="Input shaft play: forces on the end of the pinion's shaft",
    run=input_shaft_play,
    signal="shaft_end_y",
    main_metric="input_shaft_play_radial",
    chart="shaft_play",
    at_rest=True,
    revolutions=None,
    at_test_speed=False,
)
