"""The free pinion torque of the default gear by every fidelity: torque, ripple, losses, distance, cost.

Distances are over the turn from `full`, all parts in Exudyn with general contact and a bush of 25 segments.
CPU time is the solver's in runs after a first short one, so without compilation and setting up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import rps_exudyn as rps
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.analysis.result_comparison import compare
from rps_exudyn.gears.gear_pair import GearPair
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
FULL, FLANK = "`full`", "`flank` (default)"
DRAWN = (FULL, FLANK)
LOSSES = ("mesh", "seat", "bush", "bearing")
COARSE = FIDELITIES[FULL].replace({"profile_samples": 14, "axial_samples": 10, "bush": "condensed"})
SLOW = 5.0  # CPU time of a run [s] that is not repeated
PITCH = 1 / SteeringGear().pinion.teeth  # [turns]
DATA = "fidelities.json"


def run(folder: Path, turns: float = 1.0, full: Fidelity = FIDELITIES[FULL], repeats: int = 5) -> None:
    """Measure `turns` by every fidelity, with this model as `full`, and draw two tooth pitches."""
    results = {
        name: measured(fidelity, turns, repeats) for name, fidelity in (FIDELITIES | {FULL: full}).items()
    }
    save_data(folder / DATA, {"turns": turns, "rows": [row(name, results) for name in results]})
    draw(results[FULL], folder / "full.png")
    pair = compare(*(shortened(results[name], 2 * PITCH) for name in DRAWN))
    draw_comparison(pair, ("full", "flank"), folder / "full_and_flank.svg")


def measured(fidelity: Fidelity, turns: float, repeats: int) -> Result:
    """The run with the least CPU time of several, after a short one that compiles and loads all."""
    rps.run("free-pinion-torque", fidelity=fidelity, turns=1 / 120)
    runs: list[Result] = []
    while not runs or (len(runs) < repeats and runs[0].counters["solver_cpu"] < SLOW):
        runs.append(rps.run("free-pinion-torque", fidelity=fidelity, turns=turns))
        if runs[-1].status != "ok":
            raise SystemExit(f"{fidelity.name}: {runs[-1].message}")
    return min(runs, key=lambda result: result.counters["solver_cpu"])


def shortened(result: Result, turns: float) -> Result:
    """The record's first turns."""
    kept = result["pinion_angle"] <= 2 * np.pi * turns * (1 + 1e-9)
    return replace(result, signals={name: values[kept] for name, values in result.signals.items()})


def row(name: str, results: dict[str, Result]) -> dict[str, Any]:
    """Numbers of one fidelity [SI], relative to its own mean or work."""
    result, summary = results[name], results[name].summary
    torque = compare(results[FULL], result).signals["pinion_torque"]
    gain = float(GearPair.of(SteeringGear()).gain)
    return {
        "fidelity": name,
        "mean": summary["torque_mean"],
        "peak_to_peak": _over_mean(summary, "torque_peak_to_peak"),
        "losses": {loss: summary.get(f"loss_share_{loss}") for loss in LOSSES},
        "distance": torque.rms / torque.mean,
        "cpu_s": result.counters["solver_cpu"],
        "counters": {name: result.counters.get(name) for name in ("steps", "newton_iterations", "jacobians")},
        "gain": summary["rack_gain"] / gain - 1 if "rack_gain" in summary else None,
        "energy_residual": summary.get("energy_residual"),
    }


def _over_mean(summary: Mapping[str, float], name: str) -> float | None:
    """A metric over the mean torque; None where the run leaves it out."""
    return summary[name] / summary["torque_mean"] if name in summary else None


def rows_of(folder: Path, names: Sequence[str] = tuple(FIDELITIES)) -> list[dict[str, Any]]:
    """Stored rows of these fidelities."""
    return [each for each in load_data(folder / DATA)["rows"] if each["fidelity"] in names]


def fidelities_table(folder: Path) -> str:
    """Every fidelity, as README.md shows it."""
    head = (
        "fidelity",
        "mean",
        "peak to peak",
        "RMS distance from `full`",
        "CPU time per turn",
    )
    turns = load_data(folder / DATA)["turns"]
    rows = [
        (
            each["fidelity"],
            f"{each['mean']:.4f} N m",
            "-" if each["peak_to_peak"] is None else f"{100 * each['peak_to_peak']:.2g} %",
            f"{100 * each['distance']:.2g} %" if each["distance"] else "-",
            f"{each['cpu_s'] / turns:.2g} s",
        )
        for each in rows_of(folder)
    ]
    return markdown(head, rows)


def losses_table(folder: Path) -> str:
    """Return where the work goes, and what is left of its balance."""
    head = ("fidelity", *LOSSES, "energy residual")
    rows = [
        (
            each["fidelity"],
            *(_share(each["losses"][loss]) for loss in LOSSES),
            "" if each["energy_residual"] is None else f"{100 * each['energy_residual']:.2g} %",
        )
        for each in rows_of(folder)
    ]
    return markdown(head, rows)


def _share(value: float | None) -> str:
    """A share in percent, "" if it is not known; rounding has no sign."""
    return "" if value is None else f"{100 * round(value, 3) + 0.0:.1f} %"


TOPIC = Topic(
    "one turn of the default gear by every fidelity: torque, losses, distance from the full model, cost",
    "2 min",
    "free_pinion_torque",
    run,
    {"turns": PITCH / 2, "full": COARSE, "repeats": 1},
    {"fidelities": fidelities_table, "fidelity_losses": losses_table},
)
