"""Gears computed together beside single runs: gears per second, how many are found, how far they differ.

The gears are random gears of the design of `studies/tolerance.toml`: over a turn with runout and a pitch
error, and without both over one tooth pitch. Both ways go one after the other in one process; CPU times are
the least of repeats. Differences are those from single runs at the same instants, 1 degree apart.
"""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from benchmarks.topic import ROOT, Topic, digits, load_data, markdown, save_data
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.family import SINGLE_OUT
from rps_exudyn.simulate.together import Common
from rps_exudyn.solvers.many_gears import RUNOUT_ANGLE
from rps_exudyn.study.definition import settings_of
from rps_exudyn.study.runner import StudyWork
from rps_exudyn.study.study_file import read_study
from verification.law_area import by_law

SCENE = "free-pinion-torque"
STUDY = ROOT / "studies" / "tolerance.toml"
DATA = "many_gears.json"
SPANS = {"turn": "a turn, runout and one pitch", "pitch": "one tooth pitch"}
REPEATS = 2
TIMES = "solver", "all_in", "all_signals", "single"
COUNTED = "force_evaluations", "steps"
Found = TypeVar("Found")


@dataclass(frozen=True)
class Gears:
    """Random gears of one law over one span."""

    gear: SteeringGear
    table: dict[str, np.ndarray]

    @classmethod
    def of(cls, folder: Path, law: str, span: str, count: int) -> "Gears":
        """Take the first `count` samples of the tolerance study."""
        file = folder / "many.toml"
        text = STUDY.read_text().replace("samples = 200", f"samples = {count}")
        file.write_text(text.replace('gear = "gears/paper.toml"\n', ""))  # the default gear is the paper's
        work = StudyWork.of(study := read_study(file), folder / "never")
        file.unlink()
        settings = [settings_of(study.axes, case.values) for case in work.missing]
        table = {path: np.array([each[path] for each in settings], dtype=float) for path in settings[0]}
        if span == "pitch":
            table = {path: each for path, each in table.items() if path not in (*SINGLE_OUT, RUNOUT_ANGLE)}
        return cls(by_law(SteeringGear(), law), table)

    def some(self, count: int) -> dict[str, np.ndarray]:
        """The table's first rows."""
        return {path: values[:count] for path, values in self.table.items()}


def run(
    folder: Path,
    laws: Sequence[str] = ("line", "teeth"),
    spans: Sequence[str] = tuple(SPANS),
    gears: int = 1000,
    singles: int = 300,
) -> None:
    """Follow so many gears together, and the first of them singly."""
    rows = []
    for law in laws:
        for span in spans:
            rows.append({"law": law, "span": span} | measured(Gears.of(folder, law, span, gears), singles))
            print(rows[-1], flush=True)
    save_data(folder / DATA, {"load": os.getloadavg()[0], "rows": rows})


def measured(gears: Gears, singles: int) -> dict[str, float]:
    """CPU time per gear [s] in the follower, all in, with all signals, singly; share and errors."""
    count = len(next(iter(gears.table.values())))
    singly(SCENE, gears, 2)
    followed = in_follower(gears)
    seconds, found = least(lambda: batch(SCENE, gears.gear, gears.table, keep="torque"), REPEATS)
    whole_seconds, _ = least(lambda: batch(SCENE, gears.gear, gears.table), REPEATS)
    alone_seconds, alone = least(lambda: singly(SCENE, gears, singles), REPEATS)
    both = found.in_loop[:singles] & alone.ok
    same = [found.statuses[i] is alone.statuses[i] for i in range(singles)]
    return {
        "gears": count,
        "singles": singles,
        "compared": int(both.sum()),
        "solver": followed["seconds"] / count,
        "evaluations": followed["evaluations"],
        "all_in": seconds / count,
        "all_signals": whole_seconds / count,
        "single": alone_seconds / singles,
        "in_loop": float(found.in_loop.mean()),
        "statuses_differ": same.count(False),
        **errors(found, alone, both),
    }


def singly(scene: str, gears: Gears, count: int) -> Batch:
    """Run the first gears one by one: tables of one gear are."""
    rows = [{path: values[i : i + 1] for path, values in gears.table.items()} for i in range(count)]
    return Batch(tuple(batch(scene, gears.gear, row).results[0] for row in rows))


def in_follower(gears: Gears, scene: str = SCENE) -> dict[str, float]:
    """CPU time [s] of following the gears alone, and evaluations of the forces per gear and instant."""
    common = Common.of(scene, gears.gear, Fidelity.preset("quasi-static"), gears.table)
    assert common is not None  # the gear in the middle is found
    seconds, ways = least(lambda: common.followed(np.arange(len(common.rows))), REPEATS)
    evaluations, steps = (sum(way.counts[name].sum() for way in ways) for name in COUNTED)
    return {"seconds": seconds, "evaluations": float(evaluations / steps)}


def least(work: Callable[[], Found], repeats: int) -> tuple[float, Found]:
    """CPU time of the process [s], the least of repeats, and what the last one found."""
    best = np.inf
    for _ in range(repeats):
        start = time.process_time()
        found = work()
        best = min(best, time.process_time() - start)
    return best, found


def errors(found: Batch, alone: Batch, both: np.ndarray) -> dict[str, float]:
    """Relative errors of mean and peak to peak where both know the gear: of 99 % of them, and the largest."""
    chosen = {}
    for name in ("torque_mean", "torque_peak_to_peak"):
        relative = np.abs(found.summary[name][: len(both)] / alone.summary[name] - 1)[both]
        chosen[f"{name}_99"], chosen[f"{name}_largest"] = (
            float(np.quantile(relative, 0.99)),
            float(relative.max()),
        )
    return chosen


def table(folder: Path) -> str:
    """Gears together beside single runs, by the default law."""
    head = (
        "law, motion",
        "gears/s and core, together",
        "times a single run",
        "found together [%]",
        "largest error of the mean [%]",
        "of peak to peak [%]",
    )
    rows = [
        (
            f"{row['law']}, {SPANS[row['span']]}",
            digits(1 / row["all_in"], 3),
            digits(row["single"] / row["all_in"]),
            digits(100 * row["in_loop"], 4),
            *(digits(100 * row[f"{name}_largest"]) for name in ("torque_mean", "torque_peak_to_peak")),
        )
        for row in load_data(folder / DATA)["rows"]
        if row["law"] == "line"
    ]
    return markdown(head, rows)


TOPIC = Topic(
    "many gears together beside single runs",
    "2 min",
    "study_runner",
    run,
    {"laws": ("line",), "spans": ("pitch",), "gears": 48, "singles": 2},
    {"many_gears": table},
)
