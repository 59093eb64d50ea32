"""Repeats of six tests, fitted: how well preload and friction of the teeth are known after so many runs.

The made-up curves are those of `measured_fit`, with a repeatability of 2 % and a zero of 2 % in each run.
"""

from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.measured_fit import REPEATED, SET, least_deviations, measured, true_gear
from benchmarks.topic import Topic, load_data, markdown, save_data
from rps_exudyn.inference.fitting.bench_tests import BenchTest, measurement_of
from rps_exudyn.inference.fitting.fit import fit
from rps_exudyn.inference.fitting.fitted import Fit
from rps_exudyn.inference.fitting.identifiability import WANTED

DATA = "repeats.json"
RUNS = (1, 3, 6)


def run(
    folder: Path, sets: int = 20, runs: tuple[int, ...] = RUNS, tests: tuple[BenchTest, ...] = SET
) -> None:
    """Fit sets of tests, each run so many times; keep the errors and what the fit said."""
    cases: list[dict[str, Any]] = []
    for count in runs:
        for seed in range(sets):
            random = np.random.default_rng([2000, count, seed])
            files = [measured(test, REPEATED, random) for test in tests for _ in range(count)]
            cases.append({"runs": count} | of_fit(fit(measurement_of(files), other_law=False)))
        print(count, table_row(count, cases), flush=True)
        save_data(folder / DATA, {"cases": cases})


def of_fit(found: Fit) -> dict[str, Any]:
    """What is kept of a fit."""
    estimates = {}
    for path in WANTED:
        each, true = found.estimate(path), true_gear().value_at(path)
        low, high = each.interval
        estimates[path] = {
            "error": each.value / true - 1,
            "half": (high - low) / 2 / each.value,
            "holds": bool(low <= true <= high),
            "verdict": str(each.verdict),
        }
    said = found.repeats and dict(found.repeats.runs)
    return {"estimates": estimates, "said": said or {}, "converged": found.converged, "cpu_s": found.cpu_s}


def table_row(count: int, cases: list[dict[str, Any]]) -> list[str]:
    """Errors and intervals after so many runs of each test."""
    own, row = [each for each in cases if each["runs"] == count], [f"{count}"]
    bounds = least_deviations(REPEATED, count)
    for path, wanted in WANTED.items():
        estimates = [each["estimates"][path] for each in own]
        error = 100 * np.abs([each["error"] for each in estimates])
        row += [
            f"{np.sqrt(np.mean(error**2)):.1f} ({100 * bounds[path]:.1f})",
            f"{100 * np.mean(error <= 100 * wanted):.0f}",
            f"{100 * np.mean([each['holds'] for each in estimates]):.0f}",
        ]
    return row


def table(folder: Path) -> str:
    """A row for each number of runs."""
    cases = load_data(folder / DATA)["cases"]
    head = ["runs of each test"]
    for path, wanted in WANTED.items():
        head += [
            f"`{path}`: RMS error (least) %",
            f"within {100 * wanted:.0f} %: share %",
            "interval holds %",
        ]
    return markdown(head, [table_row(count, cases) for count in sorted({each["runs"] for each in cases})])


TOPIC = Topic(
    "repeats of six tests: how well preload and friction of the teeth are known after so many runs",
    "6 min",
    "fit",
    run,
    {"sets": 1, "runs": (1,), "tests": SET},
    {"fit_repeats": table},
)
