"""Cases of one design as one task: simulated one by one, or computed together where ranges are given.

Results of gears that were computed together are those of single runs within the finding "together". How a
case is done, and how it ends, depends on the case and the ranges, not on other cases.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter, process_time
from typing import Any, Literal

import numpy as np

from rps_exudyn.base.errors import InputError
from rps_exudyn.gears.geometry_report import geometry_report
from rps_exudyn.parameters.gear import Setup, SteeringGear
from rps_exudyn.results.block import CaseRecord, Keep
from rps_exudyn.results.outcome import Status, each_once, joined_text
from rps_exudyn.results.result import Result, failed
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.batch import Batch, batch
from rps_exudyn.simulate.by_accuracy import AccuracyGoal, climb
from rps_exudyn.simulate.cases.task import Task, answer_to
from rps_exudyn.simulate.cases.time_limit import TimeLimit
from rps_exudyn.simulate.gear_table import LEVEL
from rps_exudyn.simulate.run import simulate
from rps_exudyn.solvers.settling import TOLERANCE

FINDING = "many gears computed together: mean within 1e-5, other metrics mostly within 1e-3 of a single run"
WARM_UP = {"test.turns": 0.05}


@dataclass(frozen=True, eq=False)
class CaseGroup:
    """Cases that differ in some parameters, and what is kept of each."""

    scene: str
    base: Setup
    settings: Mapping[str, Mapping[str, Any]]  # hash -> path -> SI value; the same paths in each
    keep: Keep
    # path -> over what it varies in the whole study, whose cases are computed together; None: one by one
    ranges: Mapping[str, Sequence[float]] | None = None
    # what each climbs the ladder to, and its time limit [s]; None: one run with bars
    goal: tuple[AccuracyGoal, float] | None = None

    def records(self) -> list[CaseRecord]:
        """Return the record of each case."""
        results = map(self._single, self.settings.values()) if self.ranges is None else self._batch()
        return [
            CaseRecord.of(name, self.keep.of(result))
            for name, result in zip(self.settings, results, strict=True)
        ]

    def warm_up(self) -> None:
        """Run the default gear over a few degrees in the same way: loads what the cases need."""
        first = next(iter(self.settings.values()))
        fidelity = self.base.replace(first).fidelity.model_dump()
        small = Setup.from_tables(SteeringGear().replace(WARM_UP).model_dump() | {"fidelity": fidelity})
        alone = replace(self, base=small, settings={"": {}}, ranges=None)
        few = replace(self, base=small, settings={"": first})
        for group in (alone, few) if self.ranges else (alone,):
            with suppress(Exception):  # which the cases themselves report
                group.records()

    def _single(self, settings: Mapping[str, Any]) -> Result:
        try:
            setup = self.base.replace(settings)
        except InputError as error:
            base, why = self.base, " ".join(error.problems)
            return failed(self.scene, base.steering_gear, base.fidelity, Status.INVALID, why)
        run = partial(simulate, self.scene, setup.steering_gear, setup.fidelity)
        if self.goal is not None:
            goal, seconds = self.goal
            run = partial(climb, self.scene, setup.steering_gear, goal, TimeLimit(seconds))
        return answer_to(Task(run)).result(self.scene, setup.steering_gear, setup.fidelity)

    def _batch(self) -> list[Result]:
        wall, cpu = perf_counter(), process_time()
        settings = list(self.settings.values())
        table = {path: [each[path] for each in settings] for path in settings[0]}
        kept = self.keep.signals
        test = scene_named(self.scene).test
        torque_only = test is not None and kept is not None and set(kept) <= {*test.curve}
        keep: Literal["torque", "signals"] = "torque" if torque_only else "signals"
        gear, fidelity = self.base.steering_gear, self.base.fidelity
        found = batch(self.scene, gear, table, fidelity=fidelity, keep=keep, ranges=self.ranges)
        each_cpu = (process_time() - cpu) / len(settings)
        each_wall = (perf_counter() - wall) / len(settings)
        together = self._together(found, settings, each_cpu, each_wall)
        return [next(together) if result is None else result for result in found.results]

    def _together(
        self, batch: Batch, settings: Sequence[Mapping[str, Any]], cpu: float, wall: float
    ) -> Iterator[Result]:
        """Yield the results of those gears that were computed together, in their order."""
        found, gear = batch.found, self.base.steering_gear
        if found is None:
            return
        rows, fidelity = np.flatnonzero(batch.in_loop).tolist(), self.base.fidelity.model_dump()
        columns = (_rows(each, rows) for each in (found.summary, found.errors, found.counters))
        for row, own, errors, counted in zip(rows, *columns, strict=True):
            varied = gear.replace(settings[row])
            yield Result(
                scene=self.scene,
                gear=varied,
                fidelity=fidelity,
                solver={"name": "equilibrium", "tolerance": TOLERANCE},
                findings={"together": FINDING, "level": LEVEL},
                status=Status.OK,
                message=joined_text(found.remarks[row]),
                codes=each_once(remark.code for remark in found.remarks[row]),
                signals=found.signals_of(row),
                summary=own,
                errors={name: errors.get(name, np.nan) for name in own if name in found.errors},
                counters={name: int(count) for name, count in counted.items()},
                geometry=geometry_report(varied).numbers,
                cpu_s=cpu,
                wall_s=wall,
            )


def _rows(columns: Mapping[str, np.ndarray], rows: Sequence[int]) -> Iterator[dict[str, float]]:
    """Yield the numbers of rows, without those that are nan."""
    for numbers in np.array([values[rows] for values in columns.values()]).T.tolist():
        yield {name: value for name, value in zip(columns, numbers, strict=True) if value == value}
