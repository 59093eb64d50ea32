"""What exact geometry costs: deviation from the helicoid and CPU time of each mesh.

    python studies/bench_geometry.py          # prints the table of results/README.md, section Geometry

Times are CPU seconds of one process, the least of several repeats.
"""

import time
from collections.abc import Callable

import numpy as np

from rps_exudyn.gears.deviation import flank_deviation
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import flank_patch, pinion_mesh
from rps_exudyn.gears.report import check_gear, geometry_report
from rps_exudyn.gears.shaping import shaped_pinion
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.parameters.gear import SteeringGear

GEAR = SteeringGear()
PAIR = GearPair.of(GEAR)


def least_time(work: Callable[[], object], repeats: int = 5) -> float:
    """CPU seconds of the fastest repeat."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def all_flanks(chord_error: float) -> None:
    for tooth in range(PAIR.teeth):
        for side in (-1, 1):
            flank_patch(Flank(PAIR, tooth, side), chord_error)


def row(name: str, seconds: float, faces: int, vertices: np.ndarray, mesh_faces: np.ndarray) -> str:
    deviation = flank_deviation(PAIR, vertices, mesh_faces)
    largest = max(deviation.maximum, deviation.minimum, key=abs)
    return f"| {name} | {seconds:.3g} | {faces} | {largest * 1e6:+.3g} | {deviation.rms * 1e6:.2g} |"


def main() -> None:
    print("| mesh of the pinion | CPU s | faces | largest deviation um | RMS um |")
    print("|---|---|---|---|---|")
    for steps in (100, 200, 400):
        vertices, faces = shaped_pinion(PAIR, steps)
        seconds = least_time(lambda steps=steps: shaped_pinion(PAIR, steps), repeats=3)  # type: ignore[misc]
        print(row(f"shaped, {steps} steps ({360 / steps:g} deg)", seconds, len(faces), vertices, faces))
    for chord_error in (1e-6, 1e-7, 1e-8):
        mesh = pinion_mesh(PAIR, chord_error)
        on_flanks = sum(len(patch.faces) for patch in mesh.flanks.values())
        flanks = least_time(lambda e=chord_error: all_flanks(e))  # type: ignore[misc]
        whole = least_time(lambda e=chord_error: pinion_mesh(PAIR, e))  # type: ignore[misc]
        wanted = f"{chord_error * 1e6:g} um"
        print(row(f"ruled, flanks only, {wanted}", flanks, on_flanks, mesh.vertices, mesh.faces))
        print(row(f"ruled, closed and checked, {wanted}", whole, len(mesh.faces), mesh.vertices, mesh.faces))
    print()
    print(f"rack bar, chord error 1 um: {least_time(lambda: rack_solid(GEAR)):.3g} s")
    print(f"check of a gear: {least_time(lambda: check_gear(GEAR)):.2g} s")
    print(f"geometry report with all solids: {least_time(lambda: geometry_report(GEAR)):.3g} s")


if __name__ == "__main__":
    main()
