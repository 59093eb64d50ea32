"""Load test, rack push and a free torque there and back of gears together, beside single runs.

Random gears as in `many_gears`. Both ways go one after the other in one process; CPU times are the least of
repeats. Errors are differences from single runs in steps of 1 degree: each gear's largest error of a
mean torque or force, over the larger of that mean and the free torque, of which a weight may leave little;
and that of a peak to peak in one direction.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.many_gears import REPEATS, SPANS, Gears, in_follower, least, singly
from benchmarks.topic import Topic, digits, load_data, markdown, save_data
from rps_exudyn.analysis.passes import Signals, passes
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.batch import Batch, batch

DATA = "many_gears_scenes.json"


@dataclass(frozen=True)
class Kind:
    """A scene under some settings, and the figures that are compared."""

    shown: str
    scene: str
    settings: dict[str, str]
    means: tuple[str, ...]
    beside: str = ""  # figure below which a mean is small


KINDS = {
    "light": Kind("load test, 10 kg", "load-test", {}, ("torque_forward", "torque_reverse"), "free_torque"),
    "heavy": Kind(
        "load test, 40 kg",
        "load-test",
        {"test.load_mass": "40 kg"},
        ("torque_forward", "torque_reverse"),
        "free_torque",
    ),
    "push": Kind("rack push", "rack-push", {}, ("push_force_mean",)),
    "both": Kind(
        "free torque, there and back",
        "free-pinion-torque",
        {"test.path": "there-and-back"},
        ("torque_mean_forward", "torque_mean_backward"),
    ),
}


def run(
    folder: Path,
    kinds: Sequence[str] = tuple(KINDS),
    laws: Sequence[str] = ("line", "teeth"),
    spans: Sequence[str] = tuple(SPANS),
    gears: int = 200,
    singles: int = 200,
) -> None:
    """Follow so many gears together, and the first of them singly."""
    rows = []
    for name in kinds:
        for law in laws:
            for span in spans:
                about = {"kind": name, "law": law, "span": span}
                rows.append(about | measured(KINDS[name], Gears.of(folder, law, span, gears), singles))
                print(rows[-1], flush=True)
    save_data(folder / DATA, {"load": os.getloadavg()[0], "rows": rows})


def measured(kind: Kind, gears: Gears, singles: int) -> dict[str, float]:
    """CPU time per gear [s] in the follower, all in and of single runs; share and errors."""
    gears = Gears(gears.gear.replace(kind.settings), gears.table)
    count = len(next(iter(gears.table.values())))
    singly(kind.scene, gears, 2)
    followed = in_follower(gears, kind.scene)
    seconds, found = least(lambda: batch(kind.scene, gears.gear, gears.table, keep="torque"), REPEATS)
    alone_seconds, alone = least(lambda: singly(kind.scene, gears, singles), 1)
    same = [found.statuses[i] is alone.statuses[i] for i in range(singles)]
    return {
        "gears": count,
        "singles": singles,
        "solver": followed["seconds"] / count,
        "evaluations": followed["evaluations"],
        "all_in": seconds / count,
        "single": alone_seconds / singles,
        "in_loop": float(found.in_loop.mean()),
        "ok": float(alone.ok.mean()),
        "statuses_differ": same.count(False),
        **errors(kind, found, alone, singles),
    }


def errors(kind: Kind, found: Batch, alone: Batch, singles: int) -> dict[str, float]:
    """Errors of means and of peaks to peaks where both know the gear: of 99 % of them, and the largest."""
    both = found.in_loop[:singles] & alone.ok
    of_means = []
    for name in kind.means:
        expected = alone.summary[name]
        size = np.abs(expected)
        if kind.beside:
            size = np.maximum(size, np.abs(alone.summary[kind.beside]))
        of_means.append((np.abs(found.summary[name][:singles] - expected) / size)[both])
    assert found.found is not None
    of_spreads = []
    for i in np.flatnonzero(both).tolist():
        result = alone.results[i]
        assert result is not None
        ours, theirs = (spreads(kind.scene, each) for each in (found.found.signals_of(i), result.signals))
        of_spreads.append(np.abs(ours / theirs - 1).max())
    chosen: dict[str, float] = {"compared": int(both.sum())}
    for name, values in (("mean", np.max(of_means, axis=0)), ("peak_to_peak", np.array(of_spreads))):
        quantile, largest = float(np.quantile(values, 0.99)), float(values.max())
        chosen |= {f"{name}_99": quantile, f"{name}_largest": largest}
    return chosen


def spreads(scene: str, signals: Signals) -> np.ndarray:
    """Peak to peak of the drive's torque or force, each way."""
    return np.array([np.ptp(each.signals[scene_named(scene).signal]) for each in passes(signals)])


def table(folder: Path) -> str:
    """Gears together beside single runs, by the default law."""
    head = (
        "scene, over a turn",
        "gears/s and core, together",
        "times a single run",
        "largest error of the mean [%]",
        "of peak to peak [%]",
    )
    rows = [
        (
            KINDS[row["kind"]].shown,
            digits(1 / row["all_in"], 3),
            digits(row["single"] / row["all_in"]),
            *(digits(100 * row[f"{name}_largest"]) for name in ("mean", "peak_to_peak")),
        )
        for row in load_data(folder / DATA)["rows"]
        if row["law"] == "line" and row["span"] == "turn"
    ]
    return markdown(head, rows)


TOPIC = Topic(
    "load test, rack push and both ways of many gears together beside single runs",
    "5 min",
    "study_runner",
    run,
    {"kinds": ("push",), "laws": ("line",), "spans": ("pitch",), "gears": 80, "singles": 2},
    {"many_gears_scenes": table},
)
