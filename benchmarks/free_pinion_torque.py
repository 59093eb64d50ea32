"""The default gear by every fidelity: torque, ripple, losses and what they cost.

    python studies/compare_fidelities.py

Prints the table of README.md, draws the full model against the flank contact and what the kinematic ratio
misses. CPU time is the solver's in a second run, so without compilation and setting up; the full
model takes minutes.
"""

from pathlib import Path

from matplotlib.figure import Figure

from rps_exudyn.analysis.comparison import compare
from rps_exudyn.charts import style
from rps_exudyn.charts.comparison import draw_comparison
from rps_exudyn.charts.several import torques_figure
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.result import Result
from rps_exudyn.simulate.run import run

SCENE = "free-pinion-torque"
FIDELITIES = {
    "full": Fidelity.preset("full"),
    "flank": Fidelity.preset("flank"),
    "quasi-static": Fidelity.preset("quasi-static"),
    "closed-form": Fidelity.preset("closed-form"),
    "flank, mesh ratio": Fidelity.preset("flank").replace({"mesh": "ratio"}),
    "flank, mesh ratio-with-loss": Fidelity.preset("flank").replace({"mesh": "ratio-with-loss"}),
}
RATIO = ("full", "flank", "flank, mesh ratio-with-loss", "flank, mesh ratio")
WITH_RATIO = "The kinematic ratio has the losses of the other parts, not of the teeth, and no ripple"
TWO_PITCHES = 1 / 3  # [turns]
LOSSES = ("mesh", "seat", "bush", "bearing")
FOLDER = Path(__file__).parents[1] / "results" / "free_pinion_torque"


def main() -> None:
    results = {name: second_run(fidelity) for name, fidelity in FIDELITIES.items()}
    print("| fidelity | mean N m | peak to peak % | mesh | seat | bush | bearing | RMS from full % | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, result in results.items():
        print(row(name, result, results["full"]))
    FOLDER.mkdir(parents=True, exist_ok=True)
    draw(FOLDER)


def draw(folder: Path) -> None:
    """Two tooth pitches: full model and flank contact with their difference, and with the kinematic ratio."""
    curves = {name: run(SCENE, fidelity=FIDELITIES[name], turns=TWO_PITCHES) for name in RATIO}
    pair = compare(curves["full"], curves["flank"])
    draw_comparison(pair, ("full", "flank"), folder / "full_and_flank.svg")
    style.save(from_zero(torques_figure(curves, WITH_RATIO)), folder / "ratio_and_flank.svg")


def from_zero(figure: Figure) -> Figure:
    """The ordinate from zero on, so that what is missing is seen in proportion."""
    figure.axes[0].set_ylim(0, None)
    return figure


def second_run(fidelity: Fidelity) -> Result:
    """One turn, after a short run that had everything compiled and loaded."""
    run(SCENE, fidelity=fidelity, turns=1 / 120)
    return run(SCENE, fidelity=fidelity)


def row(name: str, result: Result, full: Result) -> str:
    mean = result.summary["torque_mean"]
    torque = compare(full, result).signals["pinion_torque"]
    cells = [
        name,
        f"{mean:.4f}",
        f"{100 * result.summary['torque_peak_to_peak'] / mean:.2g}",
        *(f"{result.summary[f'loss_share_{loss}']:.1%}" for loss in LOSSES),
        f"{100 * torque.rms / torque.mean:.2g}",
        f"{result.counters['solver_cpu']:.2g}",
    ]
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
