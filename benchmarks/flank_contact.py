"""What one evaluation of the flank contact costs, and how far it is from the converged integral.

Cost is CPU time of one thread, the least of several repeats over one tooth pitch, compilation apart.
Errors are at a given place of the rack (no equilibrium, which would balance most of it out): of the torque
RMS over a pitch in % of its mean, and of the whole wrench the largest in % of the sum of normal forces (times
the base radius). Reference: 1280 generators with exact ends (2560 change the torque by less than 0.0001 %);
they know law "area" alone, and of other laws only the cost is measured.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numba
import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.tooth_contact.elastic_teeth import teeth_contact
from rps_exudyn.tooth_contact.flank_contact import line_contact
from rps_exudyn.tooth_contact.flank_data import pack
from rps_exudyn.tooth_contact.laws import SCRATCH
from verification.area_contact import area_contact
from verification.contact_at import flank_contact, mesh_of_teeth
from verification.law_area import by_law

GEAR = by_law(SteeringGear(), "area")
TIP = {"pinion.tip_diameter": "18.2 mm"}  # which would follow from the helix angle
ANGLES = np.linspace(0, np.pi / 3, 25)[:-1]
PRESS = 12e-6  # by which the rack is pressed into the mesh [m]

EVALUATORS: dict[str, dict[str, int]] = {
    "strip, 2 stations x 2": {"along": 2},
    "strip, 3 x 2": {"along": 3},
    "strip, 4 x 2 (default)": {},
    "strip, 6 x 3": {"along": 6, "across": 3},
    "20 generators": {"generators": 20},
    "40 generators": {"generators": 40},
    "160 generators": {"generators": 160},
}
"""Name -> arguments of `pack`."""

DATA = "evaluations.json"
Row = tuple[str, float, float | None, float | None]
CASES: dict[str, tuple[dict[str, object], tuple[float, float, float]]] = {
    "the paper's gear": ({}, (0, 0, 0)),
    "law line": ({"mesh.law": "line"}, (0, 0, 0)),
    "law teeth": ({"mesh.law": "teeth"}, (0, 0, 0)),
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
    "helix 0": ({"pinion.helix_angle": 0.0, "rack.tooth_angle": 0.0, **TIP}, (0, 0, 0)),
    "parallel axes": ({"pinion.helix_angle": "10 deg", **TIP}, (0, 0, 0)),
}


def states(gear: SteeringGear, turn: tuple[float, float, float]) -> list[tuple[Any, ...]]:
    """A kernel's arguments over a pitch, the rack pressed, and turned about the mesh."""
    pair, rotation = GearPair.of(gear), Rotation.from_rotvec(turn).as_matrix()
    to_mesh = np.array([0, pair.reference_radius - pair.bar_axis_height, 0])
    place = np.array([0, pair.bar_axis_height - PRESS, 0]) + to_mesh - rotation @ to_mesh
    x, v = np.array([pair.gain, 0, 0]), np.array([pair.gain, 0, 0])
    return [(-angle, -1.0, place + angle * x, rotation, v, np.zeros(3)) for angle in ANGLES]


def microseconds(gear: SteeringGear, arguments: list[tuple[Any, ...]], flank: np.record) -> float:
    """CPU time of one evaluation."""
    contact = {"line": line_contact, "area": area_contact, "teeth": teeth_contact}[gear.mesh.contact_law]
    constants = mesh_of_teeth(gear, flank) if gear.mesh.contact_law == "teeth" else flank

    @numba.njit
    def sweep(repeats, angles, places, rotation, velocity, spin, records, works):  # type: ignore[no-untyped-def]
        for _ in range(repeats):
            for i in range(len(angles)):
                at = angles[i], -1.0, places[i], rotation, velocity, spin
                contact(*at, records[0], works[0], 0.0, 0.0)

    rest = (
        np.array([args[0] for args in arguments]),
        np.array([args[2] for args in arguments]),
        *arguments[0][3:],
        np.array([constants], dtype=constants.dtype),
        np.zeros(1, SCRATCH),
    )
    sweep(1, *rest)
    times, repeats = [], 40
    for _ in range(7):
        start = process_time()
        sweep(repeats, *rest)
        times.append(process_time() - start)
    return min(times) / (repeats * len(arguments)) * 1e6


def errors(gear: SteeringGear, turn: tuple[float, float, float], data: np.record) -> tuple[float, float]:
    """Torque RMS and largest of the wrench, both in %."""
    reference = pack(gear, generators=1280)
    exact = np.array([flank_contact(*args, reference) for args in states(gear, turn)])
    found = np.array([flank_contact(*args, data) for args in states(gear, turn)])
    off = found[:, :7] - exact[:, :7]
    normal, radius = exact[:, 7:9].sum(axis=1).mean(), GearPair.of(gear).base_radius
    torque = np.sqrt(np.mean(off[:, 0] ** 2)) / abs(exact[:, 0].mean())
    scale = normal * np.array([radius, 1, 1, 1, radius, radius, radius])
    return 100 * float(torque), 100 * float(np.abs(off / scale).max())


def run(
    folder: Path, evaluators: Sequence[str] = tuple(EVALUATORS), cases: Sequence[str] = tuple(CASES)
) -> None:
    """Measure evaluators on the paper's gear, and the default strip in harder cases."""
    rows = {"evaluators": list(by_evaluator(evaluators)), "cases": list(by_case(cases))}
    save_data(folder / DATA, rows)


def by_evaluator(names: Sequence[str]) -> Iterator[Row]:
    """Name, cost [us], errors of torque and wrench [%] on the paper's gear."""
    aligned = (0, 0, 0)
    for name in names:
        data = pack(GEAR, **EVALUATORS[name])  # type: ignore[arg-type]
        yield name, microseconds(GEAR, states(GEAR, aligned), data), *errors(GEAR, aligned, data)


def by_case(names: Sequence[str]) -> Iterator[Row]:
    """The same of the default strip; of other laws than "area" the cost."""
    for name in names:
        settings, turn = CASES[name]
        gear = GEAR.replace(settings)
        data, known = pack(gear), gear.mesh.contact_law == "area"
        cost = microseconds(gear, states(gear, turn), data)
        yield name, cost, *(errors(gear, turn, data) if known else (None, None))


def table(kind: str) -> Callable[[Path], str]:
    """The table of evaluators or of cases."""
    first = {"evaluators": "evaluator, the paper's gear", "cases": "case, default strip of 4 x 2"}[kind]

    def content(folder: Path) -> str:
        rows = [
            (name, *("-" if each is None else digits(each) for each in numbers))
            for name, *numbers in load_data(folder / DATA)[kind]
        ]
        return markdown((first, "us per evaluation", "torque RMS %", "wrench, largest %"), rows)

    return content


TOPIC = Topic(
    "one evaluation of the flank contact: cost, and error against the converged integral",
    "2 min",
    "flank_contact",
    run,
    {"evaluators": ("strip, 4 x 2 (default)",), "cases": ()},
    {"flank_evaluators": table("evaluators"), "flank_cases": table("cases")},
)
