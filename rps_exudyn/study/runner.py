"""Running a study: each missing case is simulated and becomes a file, a line of the log, a row of the index.

Stopped at any instant and started again, it does what is missing. A case is missing if its file does not
exist or cannot be read, if its process crashed (the machine may have been the cause), or if it exceeded a
time limit shorter than the present one. Other failures are properties of the case and are kept.
"""

import shlex
import sys
from base64 import b64decode
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.files import replacing
from rps_exudyn.results.block import CaseRecord
from rps_exudyn.results.case_file import FileForms
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.provenance import provenance
from rps_exudyn.simulate.isolated_run import result_of_ended_process
from rps_exudyn.simulate.processes import Done, Run
from rps_exudyn.study.cases import describe, setup_of
from rps_exudyn.study.definition import Study
from rps_exudyn.study.description import Case, Description
from rps_exudyn.study.handover import SECONDS, Handover
from rps_exudyn.study.messages import Group, groups
from rps_exudyn.study.progress import bar, case_line, log_lines
from rps_exudyn.study.store import CaseRow, Store


@dataclass(frozen=True)
class StudyWork:
    """A study in its folder, and the cases that are still missing there."""

    study: Study
    store: Store
    missing: tuple[Case, ...]

    @classmethod
    def of(cls, study: Study, folder: Path) -> "StudyWork":
        """The work that is left in a folder, which is not modified.

        Raises:
            InputError: cases with wrong parameters, or a folder of something else.
        """
        store = Store.of(folder, describe(study, {**provenance(), "command": shlex.join(sys.argv)}))
        return cls(study, store, _missing(study, store))

    @property
    def description(self) -> Description:
        """The description of the study with all its cases."""
        return self.store.description

    def measured(self) -> list[float]:
        """Elapsed times of the cases that ended ok [s]."""
        return [row.wall_s for _, row in self.store.rows() if row.status is Status.OK]


def _missing(study: Study, store: Store) -> tuple[Case, ...]:
    done = {case.hash for case, row in store.rows() if not to_be_done_again(row, study.time_limit)}
    return tuple(case for key, case in store.description.hashes.items() if key not in done)


def to_be_done_again(row: CaseRow, time_limit: float) -> bool:
    """Tell whether a finished case counts as missing under a time limit [s]."""
    if row.status is Status.TIMEOUT:
        return row.wall_s < time_limit
    return row.status is Status.CRASHED


@dataclass(frozen=True)
class Tally:
    """Outcome of a study: number of cases by status, and files that could not be used."""

    statuses: Mapping[Status, int]
    said: Sequence[Group]  # causes of failure and remarks
    done_now: int
    skipped: list[tuple[Path, str]]  # each with the reason
    through_batch: int = 0  # of those done now; the others were simulated singly
    in_loop: int = 0  # of those through the batch
    alone: str = ""  # why none is, of a study whose cases go in groups


def run_study(
    work: StudyWork, run: Run, workers_write: bool, workers: int = 2, seconds: float = SECONDS
) -> Tally:
    """Simulate the missing cases.

    Args:
        work: the study in its folder.
        run: does the tasks.
        workers_write: whether those who do the tasks write the files, too; else they return their contents.
        workers: how many do tasks at the same time.
        seconds: of work that is handed over at once, where cases go in groups.

    Raises:
        InputError: the folder cannot be written, or another runner is at work on it; finished cases are kept.
    """
    try:
        return _run(work, run, "file" if workers_write else "content", workers, seconds)
    except OSError as error:  # log or index
        raise InputError(f"{work.store.path} cannot be written: {error.strerror or error}.") from error


def _run(work: StudyWork, run: Run, form: str, workers: int, seconds: float) -> Tally:
    store = work.store
    in_blocks = store.in_blocks(work.study.blocks)
    store.make_folders(in_blocks)
    with store.locked():
        work = replace(work, missing=_missing(work.study, store))  # another runner may have worked until now
        skipped = store.skipped
        _begin(work)
        log, forms = store.path / "study.log", FileForms()
        log_lines(log, [f"{len(work.missing)} of {len(work.description.hashes)} cases to be done"])
        form = "record" if in_blocks else form
        tasks = Handover(work.study, store, work.missing, form, workers, seconds)
        try:
            with bar(len(work.missing)) as count:
                for done in run(tasks):
                    ended = [(case, _stored(work, case, one, forms)) for case, one in tasks.answers(done)]
                    store.add_to_index(ended)
                    log_lines(log, [case_line(work.description, *each) for each in ended])
                    count([row.status for _, row in ended])
        finally:
            store.blocks.flush()
        store.rebuild_index()
        store.write_description()
        rows = list(store.rows())
        statuses = Counter(row.status for _, row in rows)
        skipped = skipped + store.skipped
        ways = tasks.through_batch, tasks.in_loop, tasks.alone
        return Tally(statuses, groups(rows), len(work.missing), skipped, *ways)


def _begin(work: StudyWork) -> None:
    """Write what the folder holds before the first case, and set files aside that cannot be used."""
    store = work.store
    content = work.study.file.read_bytes()
    with replacing(store.path / "study.toml") as partial:
        partial.write_bytes(content)
    store.write_description()
    store.set_aside()
    store.rebuild_index()


def _stored(work: StudyWork, case: Case, done: Done, forms: FileForms) -> CaseRow:
    """The case's row; its file is written now, if the worker did not do it."""
    answer = done.answer
    if answer is None:
        return _stored_failure(work, case, done, forms)
    if "content" in answer:
        content = b64decode(answer["content"])
        if done.task["form"] == "record":
            work.store.blocks.add(CaseRecord.from_bytes(content))
        else:
            work.store.save(case.hash, content)
    return CaseRow(
        hash=case.hash,
        status=Status(answer["status"]),
        message=" ".join(answer["message"].split()),
        codes=tuple(answer["codes"]),
        cpu_s=answer["cpu_s"],
        wall_s=answer["wall_s"],
        summary=answer["summary"],
    )


def _stored_failure(work: StudyWork, case: Case, done: Done, forms: FileForms) -> CaseRow:
    """The row of a case whose process ended without an answer; its file is written now."""
    setup = setup_of(work.study, case)
    result = result_of_ended_process(
        done, work.description.scene, setup.steering_gear, setup.fidelity, work.study.time_limit
    )
    if done.task["form"] == "record":
        work.store.save_in_block(case.hash, result)
    else:
        work.store.save(case.hash, forms.content(result))
    return CaseRow.of(case.hash, result)
