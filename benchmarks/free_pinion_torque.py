"""The free pinion torque of the default gear by every fidelity: torque, ripple, losses, distance, cost.

Distances are over the turn from `full`, all parts in Exudyn with general contact and a bush of 25 segments.
CPU time is the solver's in runs after a first short one, so without compilation and setting up.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measure import quickest, run_ok
from benchmarks.topic import Columns, Topic, load_data, markdown, save_data, table_of
from rps_exudyn.analysis.result_comparison import compare
from rps_exudyn.pages.charts.analyses import draw_comparison
from rps_exudyn.pages.charts.scene_figures import draw
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.result import Result

FIDELITIES = {
    "`full`": Fidelity.preset("full"),
    "`flank` (default)": Fidelity.preset("flank"),
    "`quasi-static`": Fidelity.preset("quasi-static"),
    "`closed-form`": Fidelity.preset("closed-form"),
}
FULL, FLANK = list(FIDELITIES)[:2]
LOSSES = ("mesh", "seat", "bush", "bearing")
COARSE = FIDELITIES[FULL].replace({"profile_samples": 14, "axial_samples": 10, "bush": "condensed"})
SLOW = 5.0  # CPU time of a run [s] that is not repeated
PITCH = 1 / SteeringGear().pinion.teeth  # [turns]
DATA = "fidelities.json"


def run(folder: Path, turns: float = 1.0, full: Fidelity = FIDELITIES[FULL], repeats: int = 5) -> None:
    """Measure `turns` by every fidelity, with this model as `full`, and draw two tooth pitches."""
    models = FIDELITIES | {FULL: full}
    results = {name: measured(fidelity, turns, repeats) for name, fidelity in models.items()}
    save_data(folder / DATA, {"turns": turns, "rows": [row(name, results) for name in results]})
    draw(results[FULL], folder / "full.png")
    pair = compare(*(shortened(results[name], 2 * PITCH) for name in (FULL, FLANK)))
    draw_comparison(pair, ("full", "flank"), folder / "full_and_flank.svg")


def measured(fidelity: Fidelity, turns: float, repeats: int) -> Result:
    """The run with the least CPU time of several, after a short one that compiles and loads all."""

    def over(turns: float) -> Result:
        return run_ok("free-pinion-torque", SteeringGear().replace({"test.turns": turns}), fidelity)

    over(1 / 120)
    return quickest(lambda: over(turns), repeats, SLOW)


def shortened(result: Result, turns: float) -> Result:
    """The record's first turns."""
    kept = result["pinion_angle"] <= 2 * np.pi * turns * (1 + 1e-9)
    return replace(result, signals={name: values[kept] for name, values in result.signals.items()})


def row(name: str, results: dict[str, Result]) -> dict[str, Any]:
    """Numbers of one fidelity [SI], relative to its own mean or work; None where the run leaves them out."""
    result, summary = results[name], results[name].summary
    torque = compare(results[FULL], result).signals["pinion_torque"]
    ripple = summary.get("torque_peak_to_peak")
    return {
        "fidelity": name,
        "mean": summary["torque_mean"],
        "peak_to_peak": None if ripple is None else ripple / summary["torque_mean"],
        "losses": {loss: summary.get(f"loss_share_{loss}") for loss in LOSSES},
        "distance": torque.rms / torque.mean,
        "cpu_s": result.counters["solver_cpu"],
        "energy_residual": summary.get("energy_residual"),
    }


def fidelities_table(folder: Path) -> str:
    """Every fidelity, as README.md shows it."""
    data = load_data(folder / DATA)
    columns: Columns = {
        "fidelity": "{fidelity}",
        "mean": "{mean:.4f} N m",
        "peak to peak": lambda row: _percent(row["peak_to_peak"], "-"),
        "RMS distance from `full`": lambda row: _percent(row["distance"] or None, "-"),
        "CPU time per turn": lambda row: f"{row['cpu_s'] / data['turns']:.2g} s",
    }
    return table_of(data["rows"], columns)


def losses_table(folder: Path) -> str:
    """Return where the work goes, and what is left of its balance; rounding has no sign."""
    rows = []
    for each in load_data(folder / DATA)["rows"]:
        shares = [each["losses"][loss] for loss in LOSSES]
        texts = ["" if share is None else f"{100 * round(share, 3) + 0.0:.1f} %" for share in shares]
        rows.append([each["fidelity"], *texts, _percent(each["energy_residual"], "")])
    return markdown(("fidelity", *LOSSES, "energy residual"), rows)


def _percent(value: float | None, none: str) -> str:
    return none if value is None else f"{100 * value:.2g} %"


TOPIC = Topic(
    "2 min",
    "free_pinion_torque",
    run,
    {"turns": PITCH / 2, "full": COARSE, "repeats": 1},
    {"fidelities": fidelities_table, "fidelity_losses": losses_table},
)
