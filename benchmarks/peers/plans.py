"""The settings that are run: the package's presets, and those among which a peer's best are searched for."""

from itertools import product

from benchmarks.peers.by_drake import Drake
from benchmarks.peers.by_mujoco import MuJoCo
from benchmarks.peers.by_newton import Newton
from benchmarks.peers.by_package import Package
from benchmarks.peers.scene import Method

FULL = (
    (8, 8, 8), (10, 8, 8), (10, 8, 6), (12, 8, 5), (14, 10, 4), (19, 13, 4), (27, 18, 3), (36, 24, 3),
    (27, 18, 1),
)  # fmt: skip
"""Spheres along the profile and the face, steps in degrees."""

OF_PACKAGE: list[Method] = [
    *(Package("quasi-static", {"step_angle": f"{step:g} deg"}) for step in (10, 5, 2.5, 1)),
    Package("flank", {"step_angle": "10 deg", "strip_stations": 1}),  # as coarse as the coarsest peers
    Package("flank", {"step_angle": "10 deg", "strip_stations": 2, "strip_points": 1}),
    Package("flank", {"step_angle": "10 deg", "strip_stations": 2}),
    *(Package("flank", {"step_angle": f"{step:g} deg"}) for step in (10, 5, 3, 1)),
    *(
        Package("full", {"profile_samples": n, "axial_samples": m, "step_angle": f"{step:g} deg"})
        for n, m, step in FULL
    ),
]

SPHERES = (10, 4), (20, 8), (27, 18), (40, 16)  # along the profile and the face
PIECES = (16, 16), (24, 16)
STEPS = 2e-3, 1e-3, 4e-4  # [s]
DAMPINGS = 1e-4, 2e-4, 4e-4  # [s]

SEARCHED: list[Method] = [
    *(MuJoCo("spheres", n, m, step, damping) for (n, m), step, damping in product(SPHERES, STEPS, DAMPINGS)),
    *(MuJoCo("spheres", 27, 18, 4e-4, 1e-4, impratio) for impratio in (1.0, 10.0, 1000.0)),
    MuJoCo("spheres", 27, 18, 4e-4, 1e-4, cone="pyramidal"),
    *(
        MuJoCo("convex pieces", n, m, step, damping)
        for (n, m), step, damping in product(PIECES, STEPS[1:], DAMPINGS)
    ),
    *(Drake(chord, step) for chord, step in product((3e-6, 1e-6), (4e-3, 2e-3, 1e-3))),
    Drake(0.3e-6, 1e-3),
    *(Drake(3e-6, 1e-3, approximation) for approximation in ("similar", "sap", "tamsi")),
    *(Drake(chord, 1e-3, surface="triangle") for chord in (3e-6, 1e-6)),
    Drake(3e-6, 1e-3, longest=2e-3),
    *(Newton(n, m, 1e-4) for n, m in SPHERES),
    *(Newton(20, 8, step, damping) for step, damping in ((2e-4, 2e-5), (5e-5, 2e-5), (1e-4, 1e-4))),
]
"""Candidates, each run over one tooth pitch; those on the front of their family go into the rounds."""

MOST = 4  # settings of a peer's family in the rounds
