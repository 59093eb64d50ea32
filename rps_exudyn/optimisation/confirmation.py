"""The best designs computed again: on gears with other random numbers, with error bars, by other models.

The search keeps what looks best among many: part of that is luck with its gears, and part may be its model's.
Here the gear as given and a few designs along the front meet fresh gears.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, read_json_tables, replacing
from rps_exudyn.base.screen import open_screen
from rps_exudyn.inference.uncertainty.statistics import RESAMPLES
from rps_exudyn.optimisation.definition import Problem
from rps_exudyn.optimisation.evaluation import number_in, table_of
from rps_exudyn.optimisation.goals import Number, face_load_factor
from rps_exudyn.optimisation.search import Design, Search
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.results.outcome import Status
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.cases.run_cases import CaseRunner
from rps_exudyn.simulate.cases.task import Task
from rps_exudyn.study.case_progress import CasesRow
from rps_exudyn.study.definition import Value

MOST = 4  # designs along the front
FRESH = 1  # added to the seed
FILE = "confirmed.json"
SEARCHED, TEETH, FLANK = "the search's model", "teeth that bend", "dynamics"
MODELS = (SEARCHED, TEETH, FLANK)


@dataclass(frozen=True)
class Confirmed:
    """The numbers of a design by one model on fresh gears, in the order of `Problem.numbers`, SI.

    Attributes:
        samples: fresh gears.
        values: numbers; nan where one is missing.
        errors: standard errors of quantiles; 0 of nominal numbers.
        bars: half widths of numerical error bars; nan: unknown.
        failed: fresh gears that failed.
        cause: why numbers are missing.
    """

    samples: int
    values: Sequence[float]
    errors: Sequence[float]
    bars: Sequence[float]
    failed: int = 0
    cause: str = ""


def finalists(found: Search) -> list[Design]:
    """Return designs spread evenly along the front, its ends among them."""
    front = found.front
    places = np.unique(np.linspace(0, len(front) - 1, min(MOST, len(front))).round().astype(int))
    return [front[i] for i in places]


def confirm(found: Search, runner: CaseRunner) -> dict[tuple[str, str], Confirmed]:
    """Return (hash of a design, model) -> its numbers; what the folder holds is not computed again.

    Raises:
        InputError: the folder cannot be written.
    """
    problem, path = found.problem, found.store.path / FILE
    known, tasks = _read(path), dict[Task, str]()
    wanted = {}
    for design in (found.given, *finalists(found)):
        for model, samples in zip(MODELS, (problem.confirm[0], *[problem.confirm[1]] * 2), strict=True):
            key = f"{design.case.hash} {samples} {model}"
            wanted[design.case.hash, model] = key
            if samples and key not in known:
                tasks[Task(partial(confirmed_numbers, problem, design.case.values, model, samples))] = key
    row = CasesRow(len(tasks))
    with open_screen() as screen, screen.row(row):
        for task, answer in runner.run(list(tasks)):
            if answer.value is None:  # beyond the time limit
                continue
            known[tasks[task]] = vars(answer.value)
            with replacing(path) as partial_file:
                partial_file.write_text(json.dumps(known, indent=1), encoding="utf-8")
            row.count([Status.OK])
    return {pair: Confirmed(**known[key]) for pair, key in wanted.items() if key in known}


def _read(path: Path) -> dict[str, Any]:
    try:
        return read_json_tables(content_of(path).decode("utf-8"), "its text")
    except (InputError, ValueError):
        return {}


def confirmed_numbers(problem: Problem, values: Mapping[str, Value], model: str, samples: int) -> Confirmed:
    """Return the numbers of a design by a model on so many fresh gears, stresses with its own face load."""
    made = problem.setup(values)
    gear, runs = made.steering_gear, dict[tuple[Any, ...], Batch]()
    fidelity = Fidelity.preset("flank" if model == FLANK else made.fidelity.based_on)
    factor = face_load_factor(gear) if problem.needs_face_load else 1.0
    rows, failed, causes = list[tuple[float, float, float]](), 0, dict[str, None]()
    for asked in problem.numbers:
        try:
            if (value := asked.by_formula(gear, factor)) is not None:
                rows.append((value, 0.0, 0.0))
                continue
            settings = asked.settings_of(gear) | ({"mesh.law": "teeth"} if model == TEETH else {})
            if (key := (asked.scene, *settings.items())) not in runs:
                tested = gear.replace(settings)
                table = table_of(tested, problem.inputs_of(gear), samples, problem.study.seed + FRESH)
                runs[key] = batch(asked.scene, tested, table, fidelity=fidelity, keep="torque")
            failed = max(failed, int((~runs[key].ok[:-1]).sum()))
            rows.append((number_in(runs[key], asked), *_errors(runs[key], asked)))
        except InputError as error:
            rows.append((np.nan, np.nan, np.nan))
            causes[" ".join(error.problems)] = None
    numbers, errors, bars = (list(column) for column in zip(*rows, strict=True))
    return Confirmed(samples, numbers, errors, bars, failed, "; ".join(causes))


def _errors(series: Batch, asked: Number) -> tuple[float, float]:
    """The standard error of a quantile, by bootstrap, and the median of the runs' bars."""
    column, bars = series.summary[asked.metric][:-1], series.errors.get(asked.metric, np.empty(0))
    values, known = column[np.isfinite(column)], bars[np.isfinite(bars)]
    bar = float(np.median(known)) if known.size else np.nan
    if asked.quantile is None or not values.size:
        return 0.0, bar
    again = np.random.default_rng(0).choice(values, (RESAMPLES, values.size))
    return float(np.quantile(again, asked.quantile, axis=1).std()), bar
