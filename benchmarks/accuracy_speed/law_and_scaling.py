"""What limits accuracy besides numerics, and how cost grows: the contact law's band, cost against size.

Spheres and segments are read from the measured points of the free pinion torque.
"""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from benchmarks.accuracy_speed.chart import law_band_figure, scaling_figure
from benchmarks.accuracy_speed.measurement import Measurement, load_measurement
from benchmarks.accuracy_speed.tables import LIMITS
from benchmarks.measure import least_time, run_ok
from benchmarks.topic import Topic, save_data
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.law_error import MEASURED
from verification.runs import run_scene

GEAR = SteeringGear()
PITCH = 1 / GEAR.pinion.teeth
DEFAULT = "load per length, c' of ISO 6336-1"
BENDING = "teeth that bend together"
LAWS: dict[str, dict[str, object]] = {
    DEFAULT: {"mesh.law": "line", "mesh.line_stiffness": 13.8265e9},
    "the same, 10 N/mm/um": {"mesh.law": "line", "mesh.line_stiffness": 10e9},
    "the same, 20 N/mm/um": {"mesh.law": "line", "mesh.line_stiffness": 20e9},
    BENDING: {"mesh.law": "teeth"},
}
BANDS = {DEFAULT: MEASURED["line"], BENDING: MEASURED["teeth"]}
"""Laws that are drawn with what they are off by."""

Series = dict[str, tuple[np.ndarray, np.ndarray]]
"""What grows -> sizes and CPU seconds, (n,) each."""


def run(
    folder: Path,
    angles: int = 61,
    turns: Sequence[float] = (0.25, 0.5, 0.95, 1.9),  # no whole turns, of which one would stand for all
    cases: Sequence[int] = (1, 3, 10, 30),
    step: str = "1 deg",
) -> None:
    """Compute the torque by every law at `angles` angles of a tooth pitch, and measure cost over size."""
    angle = np.linspace(0, 2 * np.pi * PITCH, angles)
    torques = {name: torque(angle, settings, step) for name, settings in LAWS.items()}
    file = folder / "free-pinion-torque.h5"
    measured = of_points(load_measurement(file)) if file.exists() else {}
    series = measured | of_turns(turns) | of_cases(cases)
    style.save(law_band_figure(angle, torques, DEFAULT, BANDS), folder / "contact_law.png")
    style.save(scaling_figure(series), folder / "scaling.png")
    content = {
        "angle": np.round(angle, 6).tolist(),
        "torques": {name: np.round(values, 7).tolist() for name, values in torques.items()},
        "default": DEFAULT,
        "scaling": {name: [size.tolist(), cost.tolist()] for name, (size, cost) in series.items()},
    }
    save_data(folder / LIMITS, content)


def torque(angle: np.ndarray, law: dict[str, object], step: str) -> np.ndarray:
    """Torque in equilibrium over one tooth pitch [N m]."""
    model = Fidelity.preset("quasi-static").replace({"step_angle": step})
    run = run_ok("free-pinion-torque", GEAR.replace({**law, "test.turns": PITCH}), model)
    return CubicSpline(run["pinion_angle"], run["pinion_torque"])(angle)


def of_points(measurement: Measurement) -> Series:
    """Cost per revolution over the spheres of general contact, and over the segments of the bush."""
    found: dict[str, list[tuple[float, float]]] = {}
    for point in (each for each in measurement.points if each.ok):
        if point.study == "general_contact":
            spheres = float(point.fidelity.profile_samples * point.fidelity.axial_samples)
            found.setdefault("spheres of a flank, general contact", []).append((spheres, point.cost))
        if point.study == "bush" and "step_angle 1 " in point.label:
            segments = float(point.label.split()[1].strip(","))
            found.setdefault("segments of the bush, flank contact", []).append((segments, point.cost))
    return {name: tuple(np.array(rows).T) for name, rows in found.items() if len(rows) > 2}


def of_turns(counts: Sequence[float]) -> Series:
    """Cost over the turns of a gear with runout, so that none stands for another."""
    return {
        f"turns, {preset}": (np.array(counts), np.array([solver_cost(preset, each) for each in counts]))
        for preset in ("quasi-static", "flank")
    }


def solver_cost(preset: str, turns: float) -> float:
    """Least CPU time of the solver of five runs [s]."""
    gear, fidelity = GEAR.replace({"test.turns": turns, "pinion.runout": 1e-5}), Fidelity.preset(preset)
    return min(run_scene("free-pinion-torque", gear, fidelity).outcome.cpu_s for _ in range(5))


def of_cases(counts: Sequence[int]) -> Series:
    """Cost of whole cases one after the other, with all that is set up for each."""

    def work(count: int) -> None:
        for number in range(count):
            gear = GEAR.replace({"yoke.preload": 300.0 + number})
            run_scene("free-pinion-torque", gear, Fidelity.preset("quasi-static"))

    costs = [least_time(partial(work, count), 1)[0] for count in counts]
    return {"cases, quasi-static, with their setting up": (np.array(counts, dtype=float), np.array(costs))}


TOPIC = Topic(
    "1 min",
    "accuracy_speed",
    run,
    {"angles": 7, "turns": (0.05, 0.1), "cases": (1, 2), "step": "10 deg"},
)
