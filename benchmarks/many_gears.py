"""Gears computed together beside single runs: gears per second, how many are found, how far they differ.

The gears are random gears of the design of `studies/tolerance.toml`: over a turn with runout and a pitch
error, and without both over one tooth pitch. Both ways go one after the other in one process; CPU times are
the least of repeats. Errors are differences from single runs in steps of 1 degree: each gear's largest error
of a mean torque or force, over the larger of that mean and the free torque, of which a weight may leave
little; and that of all metrics that are peaks to peaks or ranges.
"""

import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.measure import least_time
from benchmarks.study_scaling import tolerance_study
from benchmarks.topic import Columns, Topic, digits, rows_table, save_data
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.shared_maneuver import SINGLE_OUT
from rps_exudyn.solvers.many_gears import RUNOUT_ANGLE
from rps_exudyn.study.definition import settings_of
from rps_exudyn.study.runner import StudyWork
from rps_exudyn.study.study_file import read_study
from verification.law_area import by_law

DATA = "many_gears.json"
REPEATS = 2
VARIATIONS = "_peak_to_peak", "_range", "_variation"  # metrics that the largest and least values give


@dataclass(frozen=True)
class Kind:
    """A scene under some settings, and the means that are compared."""

    shown: str
    scene: str = "free-pinion-torque"
    means: tuple[str, ...] = ("torque_mean",)
    settings: dict[str, str] = field(default_factory=dict)
    beside: str = ""  # figure below which a mean is small
    is_periodic: bool = False  # without what differs from tooth to tooth: one tooth pitch is computed


BOTH_TORQUES = ("torque_forward", "torque_reverse")
KINDS = {
    "free": Kind("free torque, runout and one pitch"),
    "pitch": Kind("free torque, one tooth pitch", is_periodic=True),
    "heavy": Kind("load test, 40 kg", "load-test", BOTH_TORQUES, {"test.load_mass": "40 kg"}, "free_torque"),
    "push": Kind("rack push", "rack-push", ("push_force_mean",)),
}


@dataclass(frozen=True)
class Gears:
    """Random gears of one law in one scene."""

    kind: Kind
    gear: SteeringGear
    table: dict[str, np.ndarray]

    @classmethod
    def of(cls, kind: Kind, law: str, count: int) -> "Gears":
        """Take the first `count` samples of the tolerance study."""
        with tempfile.TemporaryDirectory() as place:
            study = read_study(tolerance_study(Path(place), count))
            work = StudyWork.of(study, Path(place) / "never")
        settings = [settings_of(study.axes, case.values) for case in work.missing]
        table = {path: np.array([each[path] for each in settings], dtype=float) for path in settings[0]}
        if kind.is_periodic:
            table = {path: each for path, each in table.items() if path not in (*SINGLE_OUT, RUNOUT_ANGLE)}
        return cls(kind, by_law(SteeringGear(), law).replace(kind.settings), table)

    def together(self) -> Batch:
        """Compute all gears at once."""
        return batch(self.kind.scene, self.gear, self.table, keep="torque")

    def singly(self, count: int) -> Batch:
        """Run the first gears one by one: tables of one gear are."""
        rows = [{path: values[i : i + 1] for path, values in self.table.items()} for i in range(count)]
        return Batch(tuple(batch(self.kind.scene, self.gear, row).results[0] for row in rows))


def run(
    folder: Path,
    kinds: Sequence[str] = tuple(KINDS),
    laws: Sequence[str] = ("line", "teeth"),
    gears: int = 200,
    singles: int = 24,
) -> None:
    """Follow so many gears together, and the first of them singly."""
    rows = []
    for name in kinds:
        for law in laws:
            rows.append({"kind": name, "law": law} | measured(Gears.of(KINDS[name], law, gears), singles))
            print(rows[-1], flush=True)
            save_data(folder / DATA, {"load": os.getloadavg()[0], "rows": rows})


def measured(gears: Gears, singles: int) -> dict[str, float]:
    """CPU time per gear [s] together and of single runs; share that is found together, and errors."""
    gears.singly(2)
    count = len(next(iter(gears.table.values())))
    seconds, found = least_time(gears.together, REPEATS)
    alone_seconds, alone = least_time(lambda: gears.singly(singles), REPEATS)
    return {
        "gears": count,
        "singles": singles,
        "together": seconds / count,
        "single": alone_seconds / singles,
        "in_loop": float(found.in_loop.mean()),
        **errors(gears.kind, found, alone, singles),
    }


def errors(kind: Kind, found: Batch, alone: Batch, singles: int) -> dict[str, float]:
    """The largest error of means and of spreads where both ways find a gear."""
    both = found.in_loop[:singles] & alone.ok
    of_means = []
    for name in kind.means:
        expected = alone.summary[name]
        size = np.abs(expected)
        if kind.beside:
            size = np.maximum(size, np.abs(alone.summary[kind.beside]))
        of_means.append((np.abs(found.summary[name][:singles] - expected) / size)[both])
    of_spreads = [
        np.abs(found.summary[name][:singles] / alone.summary[name] - 1)[both]
        for name in found.summary.keys() & alone.summary.keys()
        if name.endswith(VARIATIONS)
    ]
    return {"mean_largest": float(np.nanmax(of_means)), "spread_largest": float(np.nanmax(of_spreads))}


COLUMNS: Columns = {
    "over a turn": lambda row: KINDS[row["kind"]].shown,
    "law": "{law}",
    "gears/s and core, together": lambda row: digits(1 / row["together"], 3),
    "times a single run": lambda row: digits(row["single"] / row["together"]),
    "found together [%]": lambda row: digits(100 * row["in_loop"], 3),
    "largest error of the mean [%]": lambda row: digits(100 * row["mean_largest"]),
    "of peaks to peaks, ranges [%]": lambda row: digits(100 * row["spread_largest"]),
}
TOPIC = Topic(
    "5 min",
    "study_runner",
    run,
    {"kinds": ("pitch", "push"), "laws": ("line",), "gears": 48, "singles": 2},
    {"many_gears": rows_table(DATA, "rows", COLUMNS)},
)
