"""Points of gears computed together: cost of one gear among many, error of the default one among them.

What is learned from the gears around the reference is counted, shared among all.
"""

from collections.abc import Iterator, Sequence
from functools import partial
from time import process_time

import numpy as np

from benchmarks.accuracy_speed.measurement import PlannedPoint
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Outcome, Status
from rps_exudyn.scenes.scene_run import SceneRun
from rps_exudyn.simulate.batch import batch
from rps_exudyn.simulate.shared_maneuver import SharedManeuver
from verification.runs import revolutions

FAMILY = "loop over gears, line"
GEARS = 512
STEPS = (2.0, 3.0, 4.0, 5.0)  # [deg]; in longer ones most gears are run singly
VARIED = {"yoke.preload": 0.1, "mesh.friction": 0.2, "bush.drag": 0.2}
"""Parameter -> by how much of its value it varies, either way."""


def loop_points(scene: str, steps: Sequence[float] = STEPS, gears: int = GEARS) -> Iterator[PlannedPoint]:
    """Plan the default gear among others, by the default contact law."""
    gear = SteeringGear().replace({"mesh.law": "line"})
    for step in steps:
        fidelity = Fidelity.preset("quasi-static").replace({"step_angle": f"{step} deg"})
        run = partial(loop_run, scene, gear, fidelity, gears)
        yield PlannedPoint("loop", f"step_angle {step:g} °", FAMILY, fidelity, revolutions(scene, gear), run)


def loop_run(scene: str, gear: SteeringGear, fidelity: Fidelity, gears: int) -> SceneRun:
    """Return the run of a gear that is one of many, its cost theirs over their number."""
    SharedManeuver._followed.__func__.cache_clear()  # type: ignore[attr-defined]
    table = gears_around(gear, gears)
    start = process_time()
    found = batch(scene, gear, table, fidelity=fidelity, keep="torque")
    cost = (process_time() - start) / gears
    if found.found is None or not found.in_loop[0]:
        return SceneRun(Outcome(Status.NO_CONVERGENCE, "this gear is left to a single run", cpu_s=cost))
    return SceneRun(Outcome(Status.OK, cpu_s=cost), found.found.signals_of(0))


def gears_around(gear: SteeringGear, count: int) -> dict[str, np.ndarray]:
    """Return a table of random gears around one, which is its first row."""
    random = np.random.default_rng(0)
    table = {}
    for path, share in VARIED.items():
        values = gear.value_at(path) * (1 + share * random.uniform(-1, 1, count))
        values[0] = gear.value_at(path)
        table[path] = values
    return table
