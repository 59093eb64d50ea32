"""Cost of a study over the number of its cases: random gears over a whole turn, in blocks, two processes.

The gears are those of `studies/tolerance.toml`: runout, single pitch error and six more errors, one turn in
steps of 1 degree. Elapsed times grow with what other processes do on the machine; the equilibria alone are
measured on some of the same gears.
"""

import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from benchmarks.study_runner import watched, written
from benchmarks.topic import ROOT, Topic, digits, load_data, markdown, save_data
from rps_exudyn.gears.gear_pair import GearPair
from rps_exudyn.pages.charts import style
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.scenes.maneuver import maneuvers_of_test
from rps_exudyn.solvers.equilibrium import equilibrium_path
from rps_exudyn.solvers.gear_forces import gear_forces
from rps_exudyn.study.cases import setup_of
from rps_exudyn.study.runner import StudyWork
from rps_exudyn.study.store import Store
from rps_exudyn.study.study_file import read_study

STUDY = ROOT / "studies" / "tolerance.toml"
DATA = "scaling.json"
PICTURE = "scaling.png"
KEEP = '[keep]\nsignals = "none"\nblocks = true\n'


def run(folder: Path, counts: Sequence[int] = (200, 1000, 10_000, 100_000), gears: int = 30) -> None:
    """Run studies of so many cases, and the solver alone on so many gears."""
    rows: list[dict[str, float]] = []
    with tempfile.TemporaryDirectory() as studies:
        solver = solvers(Path(studies), gears)
        print(solver, flush=True)
        for count in counts:
            rows.append(measured(Path(studies), count))
            print(rows[-1], flush=True)
            save_data(folder / DATA, {"load": os.getloadavg()[0], "rows": rows, "solver": solver})
            style.save(picture(rows), folder / PICTURE)


def measured(folder: Path, count: int) -> dict[str, float]:
    """Elapsed and CPU time [s], bytes and files of one study, start and storing included."""
    out = folder / f"of_{count}"
    seen = watched(study_of(folder, count), out, 2)
    store = Store.open(out)
    start = time.perf_counter()
    rows = list(store.rows())
    reading = time.perf_counter() - start
    files = store.blocks.paths
    return {
        "cases": count,
        "wall": seen["wall"],
        "cpu": seen["cpu"],
        "memory": seen["memory"],
        "bytes": sum(path.stat().st_size for path in files),
        "files": len(files),
        "reading": reading,
        "failed": sum(row.status != "ok" for _, row in rows),
    }


def study_of(folder: Path, count: int) -> Path:
    """Write the study with so many samples, without signals, in blocks."""
    text = STUDY.read_text().replace("samples = 200", f"samples = {count}")
    text = text.replace('gear = "gears/paper.toml"\n', "")  # the default gear is the paper's
    return written(folder, f"of_{count}", text.partition("[keep]")[0] + KEEP)


def solvers(folder: Path, gears: int) -> dict[str, float]:
    """CPU time per gear [ms] of the equilibria over a turn and over a pitch."""
    study = read_study(study_of(folder, gears))
    work = StudyWork.of(study, folder / "never")
    cost = dict.fromkeys(("turn", "pitch"), 0.0)
    for case in work.missing:
        for span, changes in (("turn", {}), ("pitch", {"pinion.runout": 0.0, "pinion.pitch_error": 0.0})):
            gear = setup_of(study, case).steering_gear.replace(changes)
            cost[span] += 1e3 * followed(gear) / gears
    return {**cost, "gears": gears}


def followed(gear: SteeringGear) -> float:
    """CPU time of a gear's first period [s], the less of two."""
    fidelity = Fidelity.preset("quasi-static")
    maneuver = maneuvers_of_test(gear, "pinion", fidelity.step_angle)[0].one_period()
    balance = gear_forces(gear, fidelity).statics
    best = np.inf
    for _ in range(2):
        start = time.process_time()
        equilibrium_path(balance, GearPair.of(gear), maneuver.drive, maneuver.time)
        best = min(best, time.process_time() - start)
    return best


def picture(rows: Sequence[dict[str, float]]) -> Figure:
    """Elapsed time, and CPU time per case, over the number of cases."""
    cases = [row["cases"] for row in rows]
    figure, (above, below) = style.panels([2.6, 2.2])
    above.loglog(cases, [row["wall"] for row in rows], "o-", color=style.COLOURS["torque"])
    above.set_ylabel("elapsed [s]")
    per_case = [1e3 * row["cpu"] / row["cases"] for row in rows]
    below.loglog(cases, per_case, "o-", color=style.COLOURS["other"])
    below.set_ylabel("CPU per case [ms]")
    below.set_xlabel("cases of a study, two processes, start and storing included")
    style.title(figure, "Random gears over a turn in steps of 1 degree")
    return figure


def scaling_table(folder: Path) -> str:
    """Studies over their number of cases."""
    head = (
        "cases",
        "elapsed [s]",
        "CPU per case [ms]",
        "kB per case",
        "summaries read in [s]",
        "failed",
    )
    rows = [
        (
            f"{row['cases']:,}".replace(",", " "),
            digits(row["wall"], 3),
            digits(1e3 * row["cpu"] / row["cases"], 3),
            digits(row["bytes"] / row["cases"] / 1e3),
            digits(row["reading"]),
            row["failed"],
        )
        for row in load_data(folder / DATA)["rows"]
    ]
    return markdown(head, rows)


TOPIC = Topic(
    "cost of a study over the number of its cases",
    "5 min",
    "study_runner",
    run,
    {"counts": (2, 4), "gears": 2},
    {"study_scaling": scaling_table},
)
