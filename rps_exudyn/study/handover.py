"""Cases handed to those who do them: in groups where many gears go through `batch` at once, else singly.

A group is sized by what its predecessors took, so that it ends in some seconds and the last ones are small.
One that does not answer, because its process died or its time was over, is done again case by case: then each
has a time limit of its own, and what is wrong with one of them harms no other.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from rps_exudyn.simulate.processes import Done, Task
from rps_exudyn.study.definition import Study
from rps_exudyn.study.description import Case, settings_of
from rps_exudyn.study.store import Store
from rps_exudyn.study.ways import ways_of

SECONDS = 2.0  # of work in a group
LARGEST = 1024  # cases of a group
SMALLEST, SHARES = 8, 4  # least cases of a group; and of what is left, for each worker, one share is the most
SMALLEST_TOGETHER, SHARES_TOGETHER = 256, 2  # each group of gears begins by following some to learn from
OF_LIMIT = 4  # groups that fit into one case's time limit: a group has no more time than a case


class Handover(Iterator[Task]):
    """Yields tasks, also after it has ended, where an answer brought new ones."""

    def __init__(
        self,
        study: Study,
        store: Store,
        missing: Sequence[Case],
        form: str,
        workers: int = 2,
        seconds: float = SECONDS,
    ) -> None:
        """Prepare to hand over the missing cases.

        Args:
            study: what they belong to.
            store: its folder.
            missing: the cases.
            form: what becomes of a result: a "file", or what comes back: the file's "content", or a "record".
            workers: how many do them at the same time.
            seconds: of work in a group.
        """
        self._study, self._store, self._form = study, store, form
        self._cases = {case.hash: case for case in missing}
        self._alone: deque[Case] = deque()
        self._left = deque(missing)
        ways = ways_of(study, store.description, len(missing))
        self._grouped, self._ranges = ways.grouped, ways.ranges
        self.alone = ways.alone
        """Why no gears are followed together; or ""."""
        self._together = self._ranges is not None
        self._smallest = SMALLEST_TOGETHER if self._together else SMALLEST
        self._shares = (SHARES_TOGETHER if self._together else SHARES) * workers
        self._seconds = min(seconds, study.time_limit / OF_LIMIT)
        self._cost: float | None = None  # of a case in a group [s]
        self.through_batch = 0
        """Cases that were answered in groups; all others were done singly."""
        self.in_loop = 0
        """Those of them that were followed together."""

    def __next__(self) -> Task:
        if self._alone:
            return self._single(self._alone.popleft())
        if not self._left:
            raise StopIteration
        if not self._grouped:
            return self._single(self._left.popleft())
        cases = [self._left.popleft() for _ in range(min(self._size, len(self._left)))]
        return self._group(cases)

    @property
    def _size(self) -> int:
        if self._cost is None:
            return self._smallest
        most = min(LARGEST, max(self._smallest, len(self._left) // self._shares))
        least = self._smallest if self._together else 1  # fewer would be simulated one by one
        return max(least, min(most, int(self._seconds / self._cost)))

    def answers(self, done: Done) -> list[tuple[Case, Done]]:
        """Return each case of a task with its answer; a group without any is handed over again, singly."""
        members = done.task.get("members")
        if members is None:
            return [(self._cases[done.task["hash"]], done)]
        cases = [self._cases[member["hash"]] for member in members]
        answers = done.answer.get("cases") if done.answer else None
        if answers is None:
            self._alone.extend(cases)
            return []
        cost = done.wall_s / len(cases)
        self._cost = cost if self._cost is None else (self._cost + cost) / 2
        self.through_batch += len(cases)
        self.in_loop += sum(bool(answer.get("in_loop")) for answer in answers)
        form = {"form": done.task["form"]}
        return [
            (case, Done({"hash": case.hash, **form}, answer))
            for case, answer in zip(cases, answers, strict=True)
        ]

    def _common(self) -> dict[str, Any]:
        description = self._store.description
        return {"scene": description.scene, "keep": asdict(description.signals), "form": self._form}

    def _path(self, case: Case) -> str | None:
        return str(self._store.path_of(case.hash).resolve()) if self._form == "file" else None

    def _single(self, case: Case) -> Task:
        gear = self._study.tables_of(settings_of(self._study.axes, case.values))
        fidelity = gear.pop("fidelity")
        about = {"hash": case.hash, "gear": gear, "fidelity": fidelity, "path": self._path(case)}
        return self._common() | about

    def _group(self, cases: Sequence[Case]) -> Task:
        gear = self._study.tables_of({})
        fidelity = gear.pop("fidelity")
        members = [
            {
                "hash": case.hash,
                "settings": settings_of(self._study.axes, case.values),
                "path": self._path(case),
            }
            for case in cases
        ]
        name = f"{cases[0].hash} and {len(cases) - 1} more"
        ranges = {} if self._ranges is None else {"ranges": self._ranges}
        about = {"hash": name, "gear": gear, "fidelity": fidelity, "members": members}
        return self._common() | about | ranges
