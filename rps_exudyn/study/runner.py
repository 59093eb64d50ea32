"""A study, done: what is missing is simulated, each case a file, a line of the log and a row of the index.

Stopped at any instant and started again, it does what is missing. A case is missing if its file is not there
or cannot be read, if its process crashed (which may have been the machine's doing), or if it ran out of a
time limit shorter than today's. Other failures are facts about the case and are kept.
"""

import shlex
import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from rps_exudyn.base.atomic import replacing
from rps_exudyn.base.errors import InputError
from rps_exudyn.results.case_file import FileForms
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.provenance import provenance
from rps_exudyn.simulate.isolated_run import result_of_ended_process
from rps_exudyn.simulate.processes import Done, Run, Task
from rps_exudyn.study.cases import describe, setup_of
from rps_exudyn.study.definition import Study
from rps_exudyn.study.description import Case, Description
from rps_exudyn.study.progress import Log, bar
from rps_exudyn.study.store import CaseRow, Store


@dataclass(frozen=True)
class Plan:
    """A study and its folder: what is there, and what is still to be done."""

    study: Study
    store: Store
    missing: tuple[Case, ...]

    @classmethod
    def of(cls, study: Study, folder: Path) -> "Plan":
        """Looks, and changes nothing.

        Raises:
            InputError: cases that cannot be, or a folder of something else.
        """
        store = Store.of(folder, describe(study, {**provenance(), "command": shlex.join(sys.argv)}))
        return cls(study, store, _missing(study, store))

    @property
    def description(self) -> Description:
        return self.store.description

    def measured(self) -> list[float]:
        """What the finished cases took [s]."""
        return [row.wall_s for _, row in self.store.rows() if row.status is Status.OK]


def _missing(study: Study, store: Store) -> tuple[Case, ...]:
    done = {case.hash for case, row in store.rows() if not to_be_done_again(row, study.time_limit)}
    return tuple(case for key, case in store.description.hashes.items() if key not in done)


def to_be_done_again(row: CaseRow, time_limit: float) -> bool:
    """Whether a finished case counts as missing, see above."""
    if row.status is Status.TIMEOUT:
        return row.wall_s < time_limit
    return row.status is Status.CRASHED


@dataclass(frozen=True)
class Tally:
    """How a study went: cases by how they ended, and files that could not be used."""

    statuses: dict[Status, int]
    done_now: int
    skipped: list[tuple[Path, str]]


def run_study(plan: Plan, run: Run, workers_write: bool) -> Tally:
    """Do what is missing.

    `run` does the tasks; where `workers_write` they write their files themselves, else contents come back.

    Raises:
        InputError: the folder cannot be written, or another runner is at work on it; what was done is kept.
    """
    try:
        return _run(plan, run, workers_write)
    except OSError as error:  # log or index
        raise InputError(f"{plan.store.path} cannot be written: {error.strerror or error}.") from error


def _run(plan: Plan, run: Run, workers_write: bool) -> Tally:
    store = plan.store
    store.make_folders()
    with store.locked():
        plan = replace(plan, missing=_missing(plan.study, store))  # another may have worked until now
        skipped = store.skipped
        _begin(plan)
        log, forms = Log(store.path / "study.log"), FileForms()
        log.line(f"{len(plan.missing)} of {len(plan.description.hashes)} cases to be done")
        by_hash = {case.hash: case for case in plan.missing}
        tasks = (_task(plan, case, workers_write) for case in plan.missing)
        with bar(len(plan.missing)) as shown:
            for done in run(tasks):
                case = by_hash[done.task["hash"]]
                row = _kept(plan, case, done, forms)
                store.add_to_index(case, row)
                log.case(case, row)
                shown.count(row.status)
        store.rebuild_index()
        store.write_description()
        statuses: dict[Status, int] = {}
        for _, row in store.rows():
            statuses[row.status] = statuses.get(row.status, 0) + 1
        return Tally(statuses, len(plan.missing), skipped + store.skipped)


def _begin(plan: Plan) -> None:
    """What stands in the folder before the first case."""
    store = plan.store
    content = plan.study.file.read_bytes()
    with replacing(store.path / "study.toml") as partial:
        partial.write_bytes(content)
    store.write_description()
    for path, _ in store.skipped:  # in the way of a case that is done now, but perhaps dear to someone
        with suppress(OSError):
            path.replace(path.with_suffix(".set-aside"))
    store.rebuild_index()


def _task(plan: Plan, case: Case, write: bool) -> Task:
    setup = setup_of(plan.study, case)
    keep = plan.description.signals
    return {
        "hash": case.hash,
        "scene": plan.description.scene,
        "gear": setup.model_dump(exclude={"fidelity"}),
        "fidelity": setup.fidelity.model_dump(),
        "keep": {"signals": keep.signals, "samples": keep.samples},
        "path": str(plan.store.path_of(case.hash).resolve()) if write else None,
    }


def _kept(plan: Plan, case: Case, done: Done, forms: FileForms) -> CaseRow:
    """The case's row; its file is written by now, at the latest."""
    import base64

    answer = done.answer
    if answer is None:
        return _kept_failure(plan, case, done, forms)
    if "content" in answer:
        plan.store.save(case.hash, base64.b64decode(answer["content"]))
    return CaseRow(
        hash=case.hash,
        status=Status(answer["status"]),
        message=" ".join(answer["message"].split()),
        cpu_s=answer["cpu_s"],
        wall_s=answer["wall_s"],
        summary=answer["summary"],
    )


def _kept_failure(plan: Plan, case: Case, done: Done, forms: FileForms) -> CaseRow:
    """A case whose process came to an end over it, as a result with that status."""
    setup = setup_of(plan.study, case)
    result = result_of_ended_process(
        done, plan.description.scene, setup.steering_gear, setup.fidelity, plan.study.time_limit
    )
    plan.store.save(case.hash, forms.content(result))
    return CaseRow.of(case.hash, result)
