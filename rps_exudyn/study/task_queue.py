"""Cases handed to an executor: in groups where many gears go through `batch` at once, else singly.

A group is sized by what its predecessors took: it ends in some seconds, and the last ones are small.
One that does not answer, because its process died or its time was over, is done again case by case: then each
has a time limit of its own, and what is wrong with one of them harms no other.

Whether cases are computed together follows from the whole design, and what comes of a case from the case: one
that is left over, or done again, is computed as all others are, without their company.
"""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from rps_exudyn.parameters.fidelity import Fidelity
from rps_exudyn.parameters.gear import SteeringGear
from rps_exudyn.results.block import CaseRecord
from rps_exudyn.scenes import scene_named
from rps_exudyn.simulate.cases.case_group import CaseGroup
from rps_exudyn.simulate.cases.task import Answer, Executor, Task
from rps_exudyn.simulate.gear_table import UNSUPPORTED, can_exist, fewest, unsupported_reason
from rps_exudyn.study.definition import FIDELITY, Case, Description, Study, settings_of

FEWEST = 64  # cases of a design, from which groups pay
QUANTILES = 65  # of a parameter's values, which describe how it varies
LARGEST = 1024  # cases of a group
SMALLEST, SHARES = 8, 4  # least cases of a group; and of what is left, for each worker, one share is the most
SMALLEST_TOGETHER, SHARES_TOGETHER = 256, 2  # each group of gears begins by following a few
OF_LIMIT = 4  # groups that fit into one case's time limit: a group has no more time than a case


@dataclass(frozen=True)
class GroupPlan:
    """How the cases of a study are done."""

    grouped: bool  # in groups, by `batch`; else singly
    # path -> over what it varies in the whole design; None where no gears are computed together. All are
    # given the same, so that a case ends the same in whichever group it is.
    ranges: Mapping[str, list[float]] | None = field(default=None)
    # why none are computed together; "" if they are, or for so few cases or such a model that they are done
    # singly
    single_run_reason: str = ""


def group_plan_of(study: Study, description: Description) -> GroupPlan:
    """Return how the cases of a design are done, however many of them are missing."""
    gear, fidelity, scene = study.base.steering_gear, study.base.fidelity, description.scene
    paths = [path for axis in study.axes for path in (*axis.paths, *axis.along)]
    if not (  # many cases of one model, each of them steady and cheap
        study.accuracy_goal is None
        and len(description.hashes) >= FEWEST
        and scene_named(scene).steady
        and fidelity.solver in ("equilibrium", "closed-form")
        and fidelity.mesh == "flank"
        and not any(path.startswith(FIDELITY) for path in paths)
    ):
        return GroupPlan(False)
    if reason := unsupported_reason(scene, gear, fidelity, {}):
        return GroupPlan(True, single_run_reason=reason)
    settings = [settings_of(study.axes, case.values) for case in description.cases]
    table = {path: np.array([each[path] for each in settings]) for path in settings[0]}
    if reason := unsupported_reason(scene, gear, fidelity, table):
        return GroupPlan(True, single_run_reason=reason)
    ranges = {path: _allowed(gear, fidelity, path, values) for path, values in table.items()}
    if not all(ranges.values()) or len(settings) < fewest(table):
        return GroupPlan(True, single_run_reason=UNSUPPORTED["few"])
    return GroupPlan(True, ranges)


def _allowed(gear: SteeringGear, fidelity: Fidelity, path: str, values: np.ndarray) -> list[float]:
    """Quantiles of a parameter's values, without those at the ends that no gear can have."""
    some = deque(np.unique(np.quantile(values, np.linspace(0, 1, QUANTILES))).tolist())
    while some and not can_exist(gear, fidelity, {path: some[0]}):
        some.popleft()
    while some and not can_exist(gear, fidelity, {path: some[-1]}):
        some.pop()
    return list(some)


class TaskQueue(Iterator[Task]):
    """Yields tasks, also after it has ended, where an answer brought new ones.

    Attributes:
        plan: how the cases are done.
        through_batch: number of cases that were answered in groups; all others were done singly.
        in_loop: number of those that were computed together.
    """

    def __init__(
        self, study: Study, description: Description, missing: Sequence[Case], executor: Executor
    ) -> None:
        self._study, self._description = study, description
        self._given: dict[Task, list[Case]] = {}
        self._again: deque[Case] = deque()  # one by one
        self._apart: set[str] = set()  # hashes of cases that are simulated without others
        self._left = deque(missing)
        self.plan = group_plan_of(study, description)
        together = self.plan.ranges is not None
        self._smallest = SMALLEST_TOGETHER if together else SMALLEST
        self._least = self._smallest if together else 1  # fewer would be simulated one by one
        self._shares = (SHARES_TOGETHER if together else SHARES) * executor.workers
        self._seconds = min(executor.group_seconds, study.time_limit / OF_LIMIT)
        self._cost: float | None = None  # of a case in a group [s]
        self.through_batch = self.in_loop = 0

    def __next__(self) -> Task:
        if self._again:
            return self._task([self._again.popleft()])
        if not self._left:
            raise StopIteration
        size = min(self._size, len(self._left)) if self.plan.grouped else 1
        return self._task([self._left.popleft() for _ in range(size)])

    @property
    def _size(self) -> int:
        if self._cost is None:
            return self._smallest
        most = min(LARGEST, max(self._smallest, len(self._left) // self._shares))
        return max(self._least, min(most, int(self._seconds / self._cost)))

    def _task(self, cases: list[Case]) -> Task:
        study, about = self._study, self._description
        settings = {case.hash: settings_of(study.axes, case.values) for case in cases}
        ranges = None if cases[0].hash in self._apart else self.plan.ranges
        goal = None if study.accuracy_goal is None else (study.accuracy_goal, study.time_limit)
        group = CaseGroup(about.scene, study.base, settings, about.signals, ranges, goal)
        task = Task(group.records, group.warm_up)
        self._given[task] = cases
        return task

    def records(self, task: Task, answer: Answer) -> list[tuple[Case, CaseRecord]]:
        """Return each case of a task with its record; a group without any is handed over again, singly.

        A single case that failed by itself, its motion predicted from others, is simulated without them.
        """
        cases = self._given.pop(task)
        records: list[CaseRecord] | None = answer.value
        if records is not None:
            if len(cases) > 1:
                cost = answer.wall_s / len(cases)
                self._cost = cost if self._cost is None else (self._cost + cost) / 2
                self.through_batch += len(cases)
            self.in_loop += sum(record.in_loop for record in records)
            return list(zip(cases, records, strict=True))
        first, *others = cases
        together = self.plan.ranges is not None and first.hash not in self._apart
        if others or (together and answer.failed_by_itself):
            self._again.extend(cases)
            self._apart.update([] if others else [first.hash])
            return []
        setup = self._study.setup(settings_of(self._study.axes, first.values))
        result = answer.failure(self._description.scene, setup.steering_gear, setup.fidelity)
        return [(first, CaseRecord.of(first.hash, self._description.signals.of(result)))]
