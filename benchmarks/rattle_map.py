"""Rattle over force and frequency of the road: from which force on the yokenut is hit, and how hard."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import rps_exudyn as rps
from benchmarks.charts import map_to_scale
from benchmarks.topic import Topic, save_data, shown
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY

FORCES = (500.0, 750.0, 1000.0, 1500.0, 2000.0)  # [N]
FREQUENCIES = (30.0, 20.0, 10.0)  # [Hz]
BASE: dict[str, object] = {"rack.modes": 4, "test.road_phases": 1, "test.road_cycles": 1}
FIGURES = ("rattle_force_rms", "rattle_speed_rms", "rattle_impulse_per_cycle", "rattle_acceleration_rms")
LABELS = {"rattle_force_rms": "yokenut force RMS", "rattle_speed_rms": "impact speed RMS"}
DATA = "rattle.json"


def run(
    folder: Path, forces: tuple[float, ...] = FORCES, frequencies: tuple[float, ...] = FREQUENCIES
) -> None:
    """Shake with these forces [N] at these frequencies [Hz], draw and keep what came out."""
    cases = []
    for frequency in frequencies:
        cases += shown(measured(force, frequency) for force in forces)
        save_data(folder / DATA, {"cases": cases})
        style.save(picture(cases), folder / "rattle_map.png")


def measured(force: float, frequency: float) -> dict[str, Any]:
    """One case: the figures of the summary."""
    road = {"test.road_force": force, "test.road_frequency": frequency}
    result = rps.run("rattle", SteeringGear().replace({**BASE, **road}))
    case: dict[str, Any] = {"force": force, "frequency": frequency}
    if result.status is not Status.OK:
        return case | {"message": f"{result.status}: {result.message}"}
    return case | {name: value for name, value in result.summary.items() if name.startswith("rattle_")}


def picture(cases: list[dict[str, Any]]) -> Figure:
    """RMS of the yokenut's force and of the impact speed; white: none, or not confirmed."""
    forces = sorted({case["force"] for case in cases})
    frequencies = sorted({case["frequency"] for case in cases})
    with mpl.rc_context({"font.size": 10}):
        figure = Figure(figsize=(8, 3.6), layout="constrained")
        panels = figure.subplots(1, 2)
    for axes, name in zip(panels, FIGURES[:2], strict=True):
        quantity = SUMMARY[name]
        shown = np.full((len(forces), len(frequencies)), np.nan)
        for case in cases:
            if case.get(name, 0.0) > 0:
                at = forces.index(case["force"]), frequencies.index(case["frequency"])
                shown[at] = quantity.displayed(case[name])
        image = map_to_scale(axes, np.array(frequencies), np.array(forces), shown, "{:.0f}", "-")
        axes.set_xlabel("frequency [Hz]")
        axes.set_ylabel("road force [N]")
        figure.colorbar(image, ax=axes, label=quantity.axis_label(LABELS[name]))
    style.title(figure, "Rattle of the default gear, tie rod at 10 deg, clearance 50 µm; -: none, or unsure")
    return figure


TOPIC = Topic("2 min", "flexible_rack", run, {"forces": (1500.0,), "frequencies": (100.0,)})
