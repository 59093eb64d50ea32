"""One design: the numbers of its gear and of a series of gears about it, by runs at level 1 without bars.

All designs have the same random numbers, so that two of them differ by what they are, not by luck. A gear
that fails counts as worse than all others. A design without a number is refused, and its message is why.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.tooth_stiffness import line_stiffness
from rps_exudyn.inference.uncertainty.samples import Samples
from rps_exudyn.optimisation.goals import Number, worst_first
from rps_exudyn.parameters.distribution import Distribution
from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.quantities import SUMMARY
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
        numbers = numbers_of(problem, made, problem.numbers, summary)
    except InputError as error:
        gear, cause = made.steering_gear, " ".join(error.problems)
        return failed(
            study.scene,
            gear,
            made.fidelity,
            Status.INVALID,
            cause,
            process_time() - cpu,
            perf_counter() - wall,
        )
    return Result(
        scene=study.scene,
        gear=made.steering_gear,
        fidelity=made.fidelity.model_dump(),
        solver={},
        findings={"numbers": numbers},
        status=Status.OK,
        summary=summary,
        cpu_s=process_time() - cpu,
        wall_s=perf_counter() - wall,
    )


def numbers_of(
    problem: "Problem", made: Setup, numbers: Sequence[Number], summary: dict[str, float] | None = None
) -> list[float]:
    """Return numbers of a gear and its series; its own metrics are added to `summary`.

    Raises:
        InputError: the gear, or too many of its series, have none.
    """
    gear, found = made.steering_gear, dict[Number, float]()
    runs: dict[tuple[Any, ...], list[Number]] = {}
    for each in numbers:
        if (value := each.by_formula(gear, problem.face_load_factor)) is not None:
            found[each] = value
        else:
            runs.setdefault((each.scene, *each.settings_of(gear).items()), []).append(each)
    for (scene, *settings), asked in runs.items():
        spread = any(each.quantile is not None for each in asked)
        inputs = problem.inputs_of(gear) if spread else {}
        series = Series.of(
            scene, gear.replace(dict(settings)), made.fidelity, inputs, problem.samples, problem.study.seed
        )
        found |= {each: series.number(each) for each in asked}
        if summary is not None and scene == problem.study.scene:
            summary |= {name: value for name, value in series.nominal.items() if name in SUMMARY}
    return [found[each] for each in numbers]


@dataclass(frozen=True)
class Series:
    """Gears of one drawing that ran a scene.

    Attributes:
        nominal: metrics of the gear without errors.
        spread: metrics of those with errors, (n,) each; nan where one has none.
        failures: messages of those that failed.
        bars: half widths of their error bars, (n,) each; {} of runs without bars.
    """

    nominal: Mapping[str, float]
    spread: Mapping[str, np.ndarray]
    failures: tuple[str, ...]
    bars: Mapping[str, np.ndarray]

    @classmethod
    def of(
        cls,
        scene: str,
        gear: SteeringGear,
        fidelity: Fidelity,
        inputs: Mapping[str, Distribution],
        samples: int,
        seed: int,
    ) -> "Series":
        """Run the gear, and so many with errors.

        Raises:
            InputError: the gear itself fails.
        """
        table = table_of(gear, inputs, samples, seed)
        many = None
        if inputs and not unsupported_reason(scene, gear, fidelity, table):
            many = table_of_metrics(scene, gear, fidelity, table)
        if many is None:
            nominal = _single(scene, gear, fidelity)
            _check_nominal(nominal)
        count = len(next(iter(table.values()))) if table else 1
        rows = [{path: float(column[i]) for path, column in table.items()} for i in range(count)]
        ended = [False] * count if many is None else many.ended.tolist()
        results = tuple(
            None
            if done
            else (nominal if many is None and i == count - 1 else _single(scene, gear, fidelity, row))
            for i, (row, done) in enumerate(zip(rows, ended, strict=True))
        )
        if results[-1] is not None:
            _check_nominal(results[-1])
        return cls.from_batch(Batch(results, many))

    @classmethod
    def from_batch(cls, batch: Batch) -> "Series":
        """Take apart runs of which the last is the gear without errors."""
        ok = batch.ok
        columns = {name: np.where(ok, values, np.nan) for name, values in batch.summary.items()}
        failures = tuple(text for text, good in zip(batch.messages, ok, strict=True) if not good)
        nominal = {name: float(values[-1]) for name, values in columns.items() if np.isfinite(values[-1])}
        spread = {name: values[:-1] for name, values in columns.items()}
        return cls(nominal, spread, failures, {name: each[:-1] for name, each in batch.errors.items()})

    def number(self, asked: Number) -> float:
        """Return a metric of the gear, or its quantile over the series.

        Raises:
            InputError: there is none.
        """
        name, share = asked.metric, asked.quantile
        if name not in self.nominal:
            raise InputError(f"{asked.name}: a run of {asked.scene} gives no {name}.")
        if share is None or not len(self.spread[name]):
            return self.nominal[name]
        values = worst_first(self.spread[name], 1 if share >= 0.5 else -1)
        value = float(np.quantile(values, share, method="higher" if share >= 0.5 else "lower"))
        if not np.isfinite(value):
            text, _ = Counter(self.failures).most_common(1)[0]
            raise InputError(f"{len(self.failures)} of {len(values)} gears of the series fail: {text}")
        return value


def table_of(
    gear: SteeringGear, inputs: Mapping[str, Distribution], samples: int, seed: int
) -> dict[str, np.ndarray]:
    """Return path -> values (n + 1,) of gears with errors; the last gear has none."""
    if not inputs:
        return {}
    drawn = Samples.drawn(inputs, samples, seed).values
    own = {path: float(gear.value_at(path)) for path in drawn}
    if not own.get("mesh.line_stiffness", 1.0):  # 0: from the gear
        own["mesh.line_stiffness"] = line_stiffness(gear)
    return {path: np.append(values, own[path]) for path, values in drawn.items()}


def _single(
    scene: str, gear: SteeringGear, fidelity: Fidelity, settings: Mapping[str, float] | None = None
) -> Result:
    def run() -> Result:
        plan = Plan(scene, gear.replace(settings or {}), fidelity)
        return plan.refusal or plan.run(WITHOUT_BARS)

    return answer_to(Task(run)).result(scene, gear, fidelity)


def _check_nominal(result: Result) -> None:
    if result.status is not Status.OK:
        raise InputError(f"the gear without errors fails: {result.status}, {result.message}")
