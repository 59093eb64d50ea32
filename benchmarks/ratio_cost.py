"""Cost of a step of the solver with variable ratio beside constant ratio, over the same turns."""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import run_ok
from benchmarks.topic import Columns, Topic, rows_table, save_data
from rps_exudyn.parameters.gear import SteeringGear

DATA, SCENE = "ratio_cost.json", "free-pinion-torque"
CONSTANT = SteeringGear().replace(
    {
        "mesh.law": "line",
        "pinion.runout": "1 um",  # so that the whole turn is computed with constant ratio, too
        "test.start_angle": "-180 deg",  # the steep part of the course
        "test.turns": 1,
    }
)
COURSE = {
    "rack.ratio.centre": f"{2 * np.pi * 5.4} mm",
    "rack.ratio.lock": f"{2 * np.pi * 6.48} mm",
    "rack.ratio.to": "150 deg",
}
COUNTED = "solver_cpu", "steps", "newton_iterations"


def run(folder: Path, models: tuple[str, ...] = ("quasi-static", "flank"), repeats: int = 8) -> None:
    """Run both gears alternately; keep the least CPU time of the solver [s] and what it had to do."""
    rows, gears = [], {"constant": CONSTANT, "variable": CONSTANT.replace(COURSE)}
    for model in models:
        kept: dict[str, dict[str, float]] = {}
        for _ in range(repeats):
            for name, gear in gears.items():
                counters = run_ok(SCENE, gear, model).counters
                one = {each: float(counters[each]) for each in COUNTED}
                kept[name] = min(kept.get(name, one), one, key=lambda each: each["solver_cpu"])
        rows.append({"model": model, **kept})
        print(rows[-1], flush=True)
    save_data(folder / DATA, {"rows": rows})


def _ratio(row: Any, name: str, per: str = "") -> float:
    variable, constant = (
        row[kind][name] / (row[kind][per] if per else 1) for kind in ("variable", "constant")
    )
    return float(variable / constant)


COLUMNS: Columns = {
    "model": "`{model}`",
    "CPU time, times constant ratio": lambda row: f"{_ratio(row, 'solver_cpu'):.2f}",
    "steps": lambda row: f"{_ratio(row, 'steps'):.2f}",
    "CPU time of a step": lambda row: f"{_ratio(row, 'solver_cpu', 'steps'):.2f}",
    "iterations of a step": lambda row: f"{_ratio(row, 'newton_iterations', 'steps'):.2f}",
}
TOPIC = Topic(
    "1 min",
    "drawing",
    run,
    {"models": ("quasi-static",), "repeats": 1},
    {"ratio_cost": rows_table(DATA, "rows", COLUMNS)},
)
