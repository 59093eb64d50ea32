"""The default gear by every fidelity: torque, ripple, losses and what they cost.

    python studies/compare_fidelities.py

Prints the table of README.md and draws the full model against the flank contact. Processor time is the
solver's in a second run, so without compilation and setting up; the full model takes minutes.
"""

from pathlib import Path

from rps_exudyn.analysis.comparison import compare
from rps_exudyn.analysis.work_balance import work_shares
from rps_exudyn.charts.comparison import draw_comparison
from rps_exudyn.fidelity import Fidelity
from rps_exudyn.result import Result
from rps_exudyn.simulate import run

SCENE = "free-pinion-torque"
FIDELITIES = {
    "full": Fidelity.preset("full"),
    "flank": Fidelity.preset("flank"),
    "quasi-static": Fidelity.preset("quasi-static"),
    "closed-form": Fidelity.preset("closed-form"),
    "flank, mesh ratio": Fidelity.preset("flank").replace({"mesh": "ratio"}),
    "flank, mesh ratio-with-loss": Fidelity.preset("flank").replace({"mesh": "ratio-with-loss"}),
}
LOSSES = ("mesh", "seat", "bush", "bearing")
FOLDER = Path(__file__).parents[1] / "results" / "free_pinion_torque"


def main() -> None:
    results = {name: second_run(fidelity) for name, fidelity in FIDELITIES.items()}
    print("| fidelity | mean N m | peak to peak % | mesh | seat | bush | bearing | RMS from full % | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, result in results.items():
        print(row(name, result, results["full"]))
    FOLDER.mkdir(parents=True, exist_ok=True)
    draw("full", "flank", FOLDER / "full_and_flank.svg")


def draw(first: str, second: str, path: Path) -> None:
    """Two tooth pitches of both."""
    pair = compare(*(run(SCENE, fidelity=FIDELITIES[name], turns=1 / 3) for name in (first, second)))
    draw_comparison(pair, (first, second), path)


def second_run(fidelity: Fidelity) -> Result:
    """One turn, after a short run that had everything compiled and loaded."""
    run(SCENE, fidelity=fidelity, turns=1 / 120)
    return run(SCENE, fidelity=fidelity)


def row(name: str, result: Result, full: Result) -> str:
    mean, shares = result.summary["torque_mean"], work_shares(result.signals)
    torque = compare(full, result).signals["pinion_torque"]
    cells = [
        name,
        f"{mean:.4f}",
        f"{100 * result.summary['torque_peak_to_peak'] / mean:.2g}",
        *(f"{shares[f'work_{loss}_friction']:.1%}" if shares else "-" for loss in LOSSES),
        f"{100 * torque.rms / torque.mean:.2g}",
        f"{result.counters['solver_cpu']:.2g}",
    ]
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
