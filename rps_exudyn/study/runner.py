"""Running a study: each missing case is simulated and becomes a record in its folder, and a line of the log.

Stopped at any instant and started again, it does what is missing. A case is missing if its file does not
exist or cannot be read, or if its process crashed: the machine may have been the cause. It is missing, too,
if it exceeded a time limit shorter than the present one. Other failures are properties of the case and are
kept.
"""

import shlex
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import content_of, replacing
from rps_exudyn.base.screen import open_screen
from rps_exudyn.results.block import CaseRow
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.provenance import provenance
from rps_exudyn.simulate.cases.task import Executor
from rps_exudyn.study.case_progress import CasesRow, Group, case_line, groups, log_lines
from rps_exudyn.study.cases import describe
from rps_exudyn.study.definition import Case, Description, Study
from rps_exudyn.study.store import Store
from rps_exudyn.study.task_queue import TaskQueue


@dataclass(frozen=True)
class StudyWork:
    """A study in its folder, and the cases that are still missing there."""

    study: Study
    store: Store
    missing: tuple[Case, ...]

    @classmethod
    def of(cls, study: Study, folder: Path) -> "StudyWork":
        """The work that is left in a folder, which is not modified."""
        store = Store.of(folder, describe(study, {**provenance(), "command": shlex.join(sys.argv)}))
        return cls(study, store, _missing(study, store))

    @property
    def description(self) -> Description:
        return self.store.description

    def measured(self) -> list[float]:
        """Elapsed times of the cases that ended ok [s]."""
        return [row.wall_s for _, row in self.store.rows() if row.status is Status.OK]


def _missing(study: Study, store: Store) -> tuple[Case, ...]:
    again = {Status.CRASHED: float("inf"), Status.TIMEOUT: study.time_limit}  # if it took less [s]
    done = {case.hash for case, row in store.rows() if not row.wall_s < again.get(row.status, -1.0)}
    return tuple(case for key, case in store.description.hashes.items() if key not in done)


@dataclass(frozen=True)
class Tally:
    """Outcome of a study: number of cases by status, and files that could not be used."""

    statuses: Mapping[Status, int]
    causes: Sequence[Group]  # causes of failure and remarks
    done_now: int
    skipped: list[tuple[Path, str]]  # each with the reason
    through_batch: int = 0  # of those done now; the others were simulated singly
    in_loop: int = 0  # of those through the batch
    single_run_reason: str = ""  # why none is, of a study whose cases go in groups


class StorageError(InputError):
    """Raised where a result could not be written, so that there is no use in going on."""


def run_study(work: StudyWork, executor: Executor) -> Tally:
    """Simulate the missing cases.

    Raises:
        InputError: the folder cannot be written, or another runner is at work on it.
        StorageError: a result cannot be written; finished cases are kept.
    """
    study, store = work.study, work.store
    with _writing(store.path):
        store.make_folders(study.blocks)
    with _writing(store.path), store.locked():
        missing = _missing(study, store)  # another runner may have worked until now
        skipped, log = store.skipped, store.path / "study.log"
        content = content_of(study.file)
        with replacing(store.path / "study.toml") as partial:
            partial.write_bytes(content)
        store.write_description()
        store.set_aside()
        log_lines(log, [f"{len(missing)} of {len(work.description.hashes)} cases to be done"])
        tasks = TaskQueue(study, store.description, missing, executor)
        try:
            row = CasesRow(len(missing))
            with open_screen() as screen, screen.row(row):
                for task, answer in executor.run(tasks):
                    ended = []
                    for case, record in tasks.records(task, answer):
                        with _storing():
                            store.add(record)
                        ended.append((case, CaseRow.of(record)))
                    log_lines(log, [case_line(work.description, *each) for each in ended])
                    row.count([each.status for _, each in ended])
        finally:
            with _storing():
                store.blocks.flush()
        store.write_description()
        rows = list(store.rows())
        statuses = Counter(row.status for _, row in rows)
        done = tasks.through_batch, tasks.in_loop, tasks.plan.single_run_reason
        return Tally(statuses, groups(rows), len(missing), skipped + store.skipped, *done)


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror or error}.") from error


@contextmanager
def _storing() -> Iterator[None]:
    try:
        yield
    except InputError as error:
        raise StorageError(f"A result cannot be stored: {error}") from error
