"""One design: the numbers of its gear and of a series of gears about it, by runs at level 1 without bars.

All designs have the same random numbers, so that two of them differ by what they are, not by luck. A gear
that fails counts as worse than all others. A design without a number is refused, and its message is why.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import ceil, floor
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.optimisation.goals import Number
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes.scene import WITHOUT_BARS
from rps_exudyn.simulate.batch import Batch
from rps_exudyn.simulate.cases.task import Task, answer_to
from rps_exudyn.simulate.gear_table import table_of_metrics, unsupported_reason
from rps_exudyn.simulate.run_plan import Plan
from rps_exudyn.study.definition import Value

if TYPE_CHECKING:
    from rps_exudyn.optimisation.definition import Problem


def evaluate(problem: "Problem", values: Mapping[str, Value]) -> Result:
    """Return a design as a result: its nominal metrics, and in the findings all `numbers` of the problem."""
    wall, cpu, study = perf_counter(), process_time(), problem.study
    made, summary = study.base, dict[str, float]()
    try:
        made = problem.with_variables(values)
        made = problem.setup(values)
        numbers = _all_numbers(problem, made, summary, complete=not values)
    except InputError as error:
        gear, cause = made.steering_gear, " ".join(error.problems)
        result = failed(study.scene, gear, made.fidelity, Status.INVALID, cause)
    else:
        model, found = made.fidelity.model_dump(), {"numbers": numbers}
        kept: dict[str, Any] = {"fidelity": model, "solver": {}, "findings": found, "summary": summary}
        result = Result(
            scene=study.scene, gear=made.steering_gear, status=Status.OK, cpu_s=0.0, wall_s=0.0, **kept
        )
    return replace(result, cpu_s=process_time() - cpu, wall_s=perf_counter() - wall)


def _all_numbers(problem: "Problem", made: Setup, summary: dict[str, float], complete: bool) -> list[float]:
    """Return all numbers of a design; nan of objectives of its series where the gear without errors misses a
    limit and nothing else is asked for: the search compares such designs by what they miss alone."""
    of_series, nominal = (
        [each for each in problem.numbers if (each.quantile is None) == is_nominal]
        for is_nominal in (False, True)
    )
    found = dict(zip(nominal, numbers_of(problem, made, nominal, summary), strict=True))
    limits = problem.constraints
    complete |= any(each.number.quantile is not None for each in limits)
    if complete or all(each.excess(found[each.number]) <= 0 for each in limits):
        found |= zip(of_series, numbers_of(problem, made, of_series, summary), strict=True)
    return [found.get(each, np.nan) for each in problem.numbers]


def numbers_of(
    problem: "Problem", made: Setup, numbers: Sequence[Number], summary: dict[str, float] | None = None
) -> list[float]:
    """Return numbers of a gear, by a single run, and of its series; its metrics are added to `summary`.

    Raises:
        InputError: the gear, or too many of its series, have none.
    """
    gear, found = made.steering_gear, dict[Number, float]()
    runs: dict[tuple[Any, ...], list[Number]] = {}
    for each in numbers:
        if (value := each.by_formula(gear, problem.face_load_factor)) is not None:
            found[each] = value
        else:
            nominal = each.quantile is None
            runs.setdefault((nominal, each.scene, *each.settings_of(gear).items()), []).append(each)
    for (nominal, scene, *settings), asked in runs.items():
        tested = gear.replace(dict(settings))
        inputs = {} if nominal else problem.inputs_of(gear)
        table = table_of(tested, inputs, problem.samples, problem.study.seed)
        series = run_series(scene, tested, made.fidelity, table)
        found |= {each: number_in(series, each) for each in asked}
        if summary is not None and scene == problem.study.scene:
            summary |= {each.metric: float(series.summary[each.metric][-1]) for each in asked}
    return [found[each] for each in numbers]


def table_of(
    gear: SteeringGear, inputs: Mapping[str, Distribution], samples: int, seed: int
) -> dict[str, np.ndarray]:
    """Return path -> values (n + 1,) of gears with errors; the last gear has none. Without inputs n is 0."""
    drawn = Samples.drawn(inputs, samples, seed).values if inputs else {"test.turns": np.empty(0)}
    return with_given(gear, drawn)


def with_given(gear: SteeringGear, drawn: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the table (n + 1,) of drawn values (n,) and, last, those of the gear itself."""
    own = {path: float(gear.value_at(path)) for path in drawn}
    if not own.get("mesh.line_stiffness", 1.0):  # 0: from the gear
        own["mesh.line_stiffness"] = line_stiffness(gear)
    return {path: np.append(values, own[path]) for path, values in drawn.items()}


def run_series(scene: str, gear: SteeringGear, fidelity: Fidelity, table: Mapping[str, np.ndarray]) -> Batch:
    """Run the gears of a table, of which the last has no errors.

    Raises:
        InputError: that one fails.
    """
    supported = not unsupported_reason(scene, gear, fidelity, table)
    many = table_of_metrics(scene, gear, fidelity, table) if supported else None
    last = len(next(iter(table.values()))) - 1
    results: list[Result | None] = [None] * (last + 1)
    for row in (last, *range(last)):
        if many is not None and many.ended[row]:
            continue
        settings = {path: float(column[row]) for path, column in table.items()}
        alone = answer_to(Task(partial(_run, scene, gear, fidelity, settings))).result(scene, gear, fidelity)
        if row == last and alone.status is not Status.OK:
            raise InputError(f"the gear without errors fails: {alone.status}, {alone.message}")
        results[row] = alone
    return Batch(tuple(results), many)


def _run(scene: str, gear: SteeringGear, fidelity: Fidelity, settings: Mapping[str, float]) -> Result:
    plan = Plan(scene, gear.replace(settings), fidelity)
    return plan.refusal or plan.run(WITHOUT_BARS)


def number_in(series: Batch, asked: Number) -> float:
    """Return a metric of the last gear, or its quantile over all others: those that failed are the worst.

    Raises:
        InputError: there is none.
    """
    column, share, ok = series.summary.get(asked.metric), asked.quantile, series.ok
    if column is None or not np.isfinite(column[-1]):
        raise InputError(f"{asked.name}: a run of {asked.scene} gives no {asked.metric}.")
    if share is None or len(column) == 1:
        return float(column[-1])
    end, rounded = (np.inf, ceil) if share >= 0.5 else (-np.inf, floor)
    ordered = np.sort(np.where(ok & np.isfinite(column), column, end)[:-1])
    value = float(ordered[rounded(share * (ordered.size - 1))])
    if not np.isfinite(value):
        failures = [text for text, good in zip(series.messages, ok, strict=True) if not good]
        (text, _), *_ = Counter(failures).most_common(1)
        raise InputError(f"{len(failures)} of {len(column) - 1} gears of the series fail: {text}")
    return value
