"""The scene's reference: equilibria by generators and by strips, and Exudyn's dynamics."""

from collections.abc import Mapping

import numpy as np

from benchmarks.peers.scene import GEAR, GUIDED
from verification.references import Method, as_run, by_strips, moving, over_generators, reference_of, still
from verification.work_precision import Reference, smoothly_over

SCENE = "free-pinion-torque"
FINE: dict[str, Method] = {
    "equilibria, 640 generators, 0.25 deg": over_generators(640, as_run(still("0.25 deg").replace(GUIDED))),
    "equilibria, strips of 12 x 6, 0.25 deg": as_run(by_strips("0.25 deg").replace(GUIDED)),
    "Exudyn, strips of 12 x 6, 0.5 deg": as_run(moving("0.5 deg", 1e-5).replace(GUIDED)),
}
COARSE: dict[str, Method] = {
    "equilibria, 1 deg": as_run(by_strips("1 deg").replace(GUIDED)),
    "equilibria, 2 deg": as_run(by_strips("2 deg").replace(GUIDED)),
}
"""For toy sizes, in which numbers say nothing."""

ANGLES = np.arange(361.0)
"""Where the reference is given [deg]."""


def reference(methods: Mapping[str, Method] = FINE) -> Reference:
    """Return the torque on which the methods agree."""
    return reference_of(SCENE, GEAR, methods).headline


def at_angles(found: Reference) -> np.ndarray:
    """Return the reference's torque at `ANGLES` [N m], (361,)."""
    time = np.deg2rad(ANGLES) / GEAR.test.speed
    return smoothly_over(found.curve, [time])
