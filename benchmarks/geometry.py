"""What exact geometry costs: deviation from the helicoid and CPU time of each mesh of the pinion."""

from collections.abc import Iterator
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from benchmarks.measure import least_time
from benchmarks.topic import Columns, Topic, digits, load_data, markdown, rows_table, save_data
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.gears.geometry_report import check_gear
from rps_exudyn.gears.helicoid import Flank
from rps_exudyn.gears.pinion_mesh import flank_patch, pinion_mesh
from rps_exudyn.gears.solids import rack_solid
from rps_exudyn.pages.animation.geometry_figure import draw_geometry
from rps_exudyn.parameters.gear import SteeringGear
from verification.flank_deviation import flank_deviation
from verification.shaping import shaped_pinion

GEAR = SteeringGear()
PAIR = GearPair.of(GEAR)
DATA = "meshes.json"


def run(
    folder: Path, cuts: tuple[int, ...] = (100, 200, 400), chords: tuple[float, ...] = (1e-6, 1e-7, 1e-8)
) -> None:
    """Measure pinions of these cuts per turn and of these chord errors [m], and draw the gear."""
    whole = {
        "rack bar, chord error 1 um": least_time(lambda: rack_solid(GEAR))[0],
        "check of a gear against all limits": least_time(lambda: check_gear(GEAR))[0],
    }
    save_data(folder / DATA, {"meshes": [*shaped(cuts), *ruled(chords)], "cpu_s": whole})
    draw_geometry(GEAR, folder / "paper_gear.png")


def shaped(cuts: tuple[int, ...]) -> Iterator[dict[str, Any]]:
    """Pinions as they are cut."""
    for number in cuts:
        seconds, (vertices, faces) = least_time(partial(shaped_pinion, PAIR, number), 3)
        yield measured(f"shaped, {number} steps ({360 / number:g} deg)", seconds, len(faces), vertices, faces)


def ruled(chords: tuple[float, ...]) -> Iterator[dict[str, Any]]:
    """Meshes of the exact surface: the flanks alone, and the closed and checked solid."""
    for chord in chords:
        solid, mesh = least_time(partial(pinion_mesh, PAIR, chord))
        flanks, _ = least_time(partial(all_flanks, chord))
        on_flanks = sum(len(patch.faces) for patch in mesh.flanks.values())
        surface, wanted = (mesh.vertices, mesh.faces), f"{1e6 * chord:g} um"
        yield measured(f"ruled, flanks only, {wanted}", flanks, on_flanks, *surface)
        yield measured(f"ruled, closed and checked, {wanted}", solid, len(mesh.faces), *surface)


def all_flanks(chord: float) -> None:
    """Mesh both flanks of every tooth."""
    for tooth, side in product(range(PAIR.teeth), (-1, 1)):
        flank_patch(Flank(PAIR, tooth, side), chord)


def measured(name: str, seconds: float, size: int, vertices: Any, faces: Any) -> dict[str, Any]:
    """One mesh: its cost, its number of faces, its deviation from the helicoid [m]."""
    deviation = flank_deviation(PAIR, vertices, faces)
    largest = max(deviation.maximum, deviation.minimum, key=abs)
    return {"mesh": name, "cpu_s": seconds, "faces": size, "largest": largest, "rms": deviation.rms}


MESHES: Columns = {
    "mesh of the pinion": "{mesh}",
    "CPU s": "{cpu_s:.2g}",
    "faces": "{faces}",
    "largest deviation um": lambda row: f"{1e6 * row['largest']:+.3g}",
}


def costs_table(folder: Path) -> str:
    """Other work on a gear."""
    rows = [(name, digits(1e3 * seconds)) for name, seconds in load_data(folder / DATA)["cpu_s"].items()]
    return markdown(("work", "CPU ms"), rows)


TOPIC = Topic(
    "20 s",
    "geometry",
    run,
    {"cuts": (50,), "chords": (1e-6,)},
    {"pinion_meshes": rows_table(DATA, "meshes", MESHES), "geometry_costs": costs_table},
)
