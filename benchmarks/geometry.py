"""What exact geometry costs: deviation from the helicoid and CPU time of each mesh of the pinion."""

from collections.abc import Callable, Iterator
from pathlib import Path
from time import process_time
from typing import Any

from benchmarks.flank_deviation import flank_deviation
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import flank_patch, pinion_mesh
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.pages.charts.geometry import draw_geometry
from rps_exudyn.parameters.gear import SteeringGear
from verification.shaping import shaped_pinion

GEAR = SteeringGear()
PAIR = GearPair.of(GEAR)
DATA = "meshes.json"


def run(
    folder: Path, cuts: tuple[int, ...] = (100, 200, 400), chords: tuple[float, ...] = (1e-6, 1e-7, 1e-8)
) -> None:
    """Measure pinions of these cuts per turn and of these chord errors [m], and draw the gear."""
    whole = {
        "rack bar, chord error 1 um": least_time(lambda: rack_solid(GEAR)),
        "check of a gear against all limits": least_time(lambda: check_gear(GEAR)),
    }
    meshes = [*shaped(cuts), *ruled(chords)]
    save_data(folder / DATA, {"meshes": meshes, "cpu_s": whole})
    draw_geometry(GEAR, folder / "paper_gear.png")


def shaped(cuts: tuple[int, ...]) -> Iterator[dict[str, Any]]:
    """Pinions as they are cut."""
    for number in cuts:
        vertices, faces = shaped_pinion(PAIR, number)
        seconds = least_time(lambda n=number: shaped_pinion(PAIR, n), repeats=3)  # type: ignore[misc]
        yield measured(f"shaped, {number} steps ({360 / number:g} deg)", seconds, len(faces), vertices, faces)


def ruled(chords: tuple[float, ...]) -> Iterator[dict[str, Any]]:
    """Meshes of the exact surface: the flanks alone, and the closed and checked solid."""
    for chord in chords:
        mesh, wanted = pinion_mesh(PAIR, chord), f"{1e6 * chord:g} um"
        on_flanks = sum(len(patch.faces) for patch in mesh.flanks.values())
        flanks = least_time(lambda e=chord: all_flanks(e))  # type: ignore[misc]
        solid = least_time(lambda e=chord: pinion_mesh(PAIR, e))  # type: ignore[misc]
        yield measured(f"ruled, flanks only, {wanted}", flanks, on_flanks, mesh.vertices, mesh.faces)
        yield measured(
            f"ruled, closed and checked, {wanted}", solid, len(mesh.faces), mesh.vertices, mesh.faces
        )


def all_flanks(chord: float) -> None:
    """Mesh both flanks of every tooth."""
    for tooth in range(PAIR.teeth):
        for side in (-1, 1):
            flank_patch(Flank(PAIR, tooth, side), chord)


def measured(name: str, seconds: float, size: int, vertices: Any, faces: Any) -> dict[str, Any]:
    """One mesh: its cost, its number of faces, its deviation from the helicoid [m]."""
    deviation = flank_deviation(PAIR, vertices, faces)
    largest = max(deviation.maximum, deviation.minimum, key=abs)
    return {
        "mesh": name,
        "cpu_s": seconds,
        "faces": size,
        "largest": float(largest),
        "rms": float(deviation.rms),
    }


def least_time(work: Callable[[], object], repeats: int = 5) -> float:
    """CPU seconds of the fastest repeat."""
    times = []
    for _ in range(repeats):
        start = process_time()
        work()
        times.append(process_time() - start)
    return min(times)


def meshes_table(folder: Path) -> str:
    """Every mesh."""
    rows = [
        (
            row["mesh"],
            f"{row['cpu_s']:.2g}",
            row["faces"],
            f"{1e6 * row['largest']:+.3g}",
            f"{1e6 * row['rms']:.2g}",
        )
        for row in load_data(folder / DATA)["meshes"]
    ]
    return markdown(("mesh of the pinion", "CPU s", "faces", "largest deviation um", "RMS um"), rows)


def costs_table(folder: Path) -> str:
    """Other work on a gear."""
    rows = [(name, digits(1e3 * seconds)) for name, seconds in load_data(folder / DATA)["cpu_s"].items()]
    return markdown(("work", "CPU ms"), rows)


TOPIC = Topic(
    "meshes of the pinion: deviation from the exact flank, faces, cost; picture of the gear",
    "20 s",
    "geometry",
    run,
    {"cuts": (50,), "chords": (1e-6,)},
    {"pinion_meshes": meshes_table, "geometry_costs": costs_table},
)
