"""What one evaluation of the flank contact costs, and how far it is from the converged integral.

    python studies/bench_flank_contact.py

Cost is CPU time of one thread, the least of several repeats over one tooth pitch, compilation apart.
Errors are at a given place of the rack (no equilibrium, which would balance most of it out): of the torque
RMS over a pitch in % of its mean, and of the whole wrench the largest in % of the sum of normal forces (times
the base radius). Reference: 1280 generators with exact ends (2560 change the torque by less than 0.0001 %).
"""

import time
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from scipy.spatial.transform import Rotation

from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.mesh_contact.flank_contact import flank_contact
from rps_exudyn.mesh_contact.flank_data import FlankData, pack
from rps_exudyn.parameters.gear import SteeringGear

ANGLES = np.linspace(0, np.pi / 3, 25)[:-1]
PRESS = 12e-6  # by which the rack is pressed into the mesh [m]

EVALUATORS: dict[str, tuple[Callable[..., Any], Callable[[SteeringGear], FlankData]]] = {
    "strip, 2 stations x 2": (flank_contact, lambda gear: pack(gear, along=2)),
    "strip, 3 x 2": (flank_contact, lambda gear: pack(gear, along=3)),
    "strip, 4 x 2 (default)": (flank_contact, pack),
    "strip, 6 x 3": (flank_contact, lambda gear: pack(gear, along=6, across=3)),
    "20 generators": (flank_contact, lambda gear: pack(gear, generators=20)),
    "40 generators": (flank_contact, lambda gear: pack(gear, generators=40)),
    "160 generators": (flank_contact, lambda gear: pack(gear, generators=160)),
}
CASES: dict[str, tuple[dict[str, object], tuple[float, float, float]]] = {
    "the paper's gear": ({}, (0, 0, 0)),
    "line law": ({"mesh.law": "line"}, (0, 0, 0)),
    "roll 1 mrad": ({}, (1e-3, 0, 0)),
    "yaw 0.05 deg": ({}, (0, 8.7e-4, 0)),
    "yaw 0.5 deg": ({}, (0, 8.7e-3, 0)),
    "damping 1e-4 s": ({"mesh.damping": 1e-4}, (0, 0, 0)),
    "bar's axis 10 mm below the reference line": ({"rack.reference_height": "10 mm"}, (0, 0, 0)),
    "tip relief 10 um": ({"pinion.tip_relief": "10 um"}, (0, 0, 0)),
    "tip relief 30 um": ({"pinion.tip_relief": "30 um"}, (0, 0, 0)),
    "crowning 5 um": ({"pinion.crowning": "5 um"}, (0, 0, 0)),
    "profile shift 0.65, strips at the form circle": (
        {"pinion.profile_shift": 0.65, "pinion.tip_diameter": "17.6 mm"},
        (0, 0, 0),
    ),
    "helix 0": ({"pinion.helix_angle": 0.0, "rack.tooth_angle": 0.0}, (0, 0, 0)),
    "parallel axes": ({"pinion.helix_angle": "10 deg"}, (0, 0, 0)),
}


def states(gear: SteeringGear, turn: tuple[float, float, float]) -> list[tuple[Any, ...]]:
    """A kernel's arguments over a pitch, the rack pressed, and turned about the mesh."""
    pair, rotation = GearPair.of(gear), Rotation.from_rotvec(turn).as_matrix()
    to_mesh = np.array([0, pair.reference_radius - pair.bar_axis_height, 0])
    place = np.array([0, pair.bar_axis_height - PRESS, 0]) + to_mesh - rotation @ to_mesh
    x, v = np.array([pair.gain, 0, 0]), np.array([pair.gain, 0, 0])
    return [(-angle, -1.0, place + angle * x, rotation, v, np.zeros(3)) for angle in ANGLES]


def microseconds(kernel: Callable[..., Any], arguments: list[tuple[Any, ...]], data: FlankData) -> float:
    """CPU time of one evaluation."""
    angles = np.array([args[0] for args in arguments])
    places = np.array([args[2] for args in arguments])

    @numba.njit
    def sweep(repeats, rotation, velocity, spin):  # type: ignore[no-untyped-def]
        for _ in range(repeats):
            for i in range(len(angles)):
                kernel(angles[i], -1.0, places[i], rotation, velocity, spin, data)

    rest = arguments[0][3:]
    sweep(1, *rest)
    times, repeats = [], 40
    for _ in range(7):
        start = time.process_time()
        sweep(repeats, *rest)
        times.append(time.process_time() - start)
    return min(times) / (repeats * len(angles)) * 1e6


def errors(
    kernel: Callable[..., Any], gear: SteeringGear, turn: tuple[float, float, float], data: FlankData
) -> tuple[float, float]:
    """Torque RMS and largest of the wrench, both in %."""
    reference = pack(gear, generators=1280)
    exact = np.array([flank_contact(*args, reference) for args in states(gear, turn)])
    found = np.array([kernel(*args, data) for args in states(gear, turn)])
    off = found[:, :7] - exact[:, :7]
    normal, radius = exact[:, 7:9].sum(axis=1).mean(), GearPair.of(gear).base_radius
    torque = np.sqrt(np.mean(off[:, 0] ** 2)) / abs(exact[:, 0].mean())
    scale = normal * np.array([radius, 1, 1, 1, radius, radius, radius])
    return 100 * float(torque), 100 * float(np.abs(off / scale).max())


def main() -> None:
    paper = SteeringGear()
    aligned = states(paper, (0, 0, 0))
    print(
        "| evaluator, the paper's gear | us per evaluation | torque RMS % | wrench, largest % |\n"
        "|---|---|---|---|"
    )
    for name, (kernel, packed) in EVALUATORS.items():
        data = packed(paper)
        torque, wrench = errors(kernel, paper, (0, 0, 0), data)
        print(f"| {name} | {microseconds(kernel, aligned, data):.2g} | {torque:.2g} | {wrench:.2g} |")
    print(
        "\n| case, default strip | us per evaluation | torque RMS % | wrench, largest % |\n|---|---|---|---|"
    )
    for name, (settings, turn) in CASES.items():
        gear = paper.replace(settings)
        data = pack(gear)
        cost = microseconds(flank_contact, states(gear, turn), data)
        if gear.mesh.law == "line":
            print(f"| {name} | {cost:.2g} | - | - |")
            continue
        torque, wrench = errors(flank_contact, gear, turn, data)
        print(f"| {name} | {cost:.2g} | {torque:.2g} | {wrench:.2g} |")


if __name__ == "__main__":
    main()
