"""The command `study`: options checked before anything runs, cases listed, outcome printed."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.progress import duration
from rps_exudyn.base.screen import shown_progress
from rps_exudyn.cli.options import Flag, Json
from rps_exudyn.cli.output import DONE, FAILED, present, say
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.sheet import Block, Line, Sheet, Text

if TYPE_CHECKING:
    from rps_exudyn.simulate.cases.task import Executor
    from rps_exudyn.study.case_progress import Group
    from rps_exudyn.study.runner import StudyWork, Tally

MANY_CASES = 5000
"""More need `--yes`."""

_NOT_TOGETHER = "  no cases computed together: {}"

SHOWN_SKIPPED = 5
SHOWN_GROUPS, SHOWN_RANGES = 2, 2


def study(
    file: Path,
    /,
    *,
    out: Path | None = None,
    jobs: int | None = None,
    cluster: str | None = None,
    dry_run: Flag = False,
    toy: Flag = False,
    yes: Flag = False,
    json: Json = False,
) -> int:
    """Simulate all cases of a study file. Run it again after an interruption: finished cases are kept.

    Args:
        file: Study file (TOML), see docs/studies.md.
        out: Folder of the study; default: the file's name, in the current folder.
        jobs: Number of worker processes; default: one per processor.
        cluster: Address of a Dask scheduler that runs the cases, for instance tcp://10.0.0.1:8786.
        dry_run: List the cases and estimate the time without simulating.
        toy: Try the study with two values of each axis, in a folder NAME-toy.
        yes: Also run a study of more than 5000 cases.
    """
    from rps_exudyn.simulate.cases.run_cases import checked_jobs

    processes = checked_jobs(jobs)
    work = _work(file, out or Path(f"{file.stem}-toy" if toy else file.stem), toy, yes)
    if dry_run:
        _list_cases(work, processes, json)
        return DONE
    from rps_exudyn.simulate.cases.processes import Processes, StartError
    from rps_exudyn.study.runner import StorageError, run_study

    executor: AbstractContextManager[Executor]
    limit = work.study.time_limit
    if cluster:
        from rps_exudyn.simulate.cases.cluster import Cluster

        executor = Cluster.at(cluster, limit)
    else:
        executor = Processes(processes, limit, work.store.path / "messages.log")
    try:
        with shown_progress(), executor as workers:
            tally = run_study(work, workers)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"interrupted; {_kept(work)}.") from None
    except (StorageError, StartError) as error:
        kept = _kept(work)
        raise InputError(f"{error} {kept[0].upper()}{kept[1:]}.") from None
    _present_tally(work, tally, json)
    return DONE if set(tally.statuses) <= {Status.OK} else FAILED


def _work(file: Path, folder: Path, toy: bool, yes: bool) -> "StudyWork":
    """The study in its folder.

    Raises:
        InputError: everything that is wrong with file and folder, or more cases than run without `yes`.
    """
    from rps_exudyn.study.cases import count_of
    from rps_exudyn.study.runner import StudyWork
    from rps_exudyn.study.study_file import read_study

    study = read_study(file)
    if toy:
        study = study.toy()
    count = count_of(study)
    if count > MANY_CASES and not yes:
        raise InputError(
            f"{file} has {count} cases; more than {MANY_CASES} are run with --yes only "
            "(--dry-run --yes estimates how long they take)."
        )
    with shown_progress(asked=False):
        return StudyWork.of(study, folder)


def _kept(work: "StudyWork") -> str:
    """What is kept of a study that ends early, and what the same command does."""
    if next(work.store.rows(), None) is None:
        return "no case is finished; the same command runs all of them"
    return f"finished cases are kept in {work.store.path}; the same command runs the others"


def _list_cases(work: "StudyWork", jobs: int, json: bool) -> None:
    from rps_exudyn.study.case_progress import estimate
    from rps_exudyn.study.table import show_value
    from rps_exudyn.study.task_queue import group_plan_of

    seconds, source = estimate(work.study, work.missing, work.measured(), jobs)
    with shown_progress():
        plan = group_plan_of(work.study, work.description)
    missing = {case.hash for case in work.missing}
    cases = work.description.cases

    def text() -> Iterator[Block]:
        for case in cases:
            state = "to do" if case.hash in missing else "done "
            values = (f"{axis.name} = {show_value(axis, case.values[axis.name])}" for axis in work.study.axes)
            yield Text(f"{case.hash}  {state}  {', '.join(values)}")
        yield Text(
            f"{len(cases)} cases, {len(missing)} of them to be done: about {duration(seconds)} "
            f"with {jobs} {'process' if jobs == 1 else 'processes'} ({source})"
        )
        if plan.ranges is not None:
            yield Text("  most of them computed together, several times as fast")
        elif plan.single_run_reason:
            yield Text(_NOT_TOGETHER.format(plan.single_run_reason))

    def data() -> dict[str, Any]:
        rows = [{"hash": case.hash, "values": case.values, "missing": case.hash in missing} for case in cases]
        counts = {"cases": rows, "missing": len(missing), "jobs": jobs, "seconds": seconds}
        return counts | {"in_loop": plan.ranges is not None, "not_in_loop": plan.single_run_reason}

    present(Sheet(text=text(), data=data), json=json)


def _present_tally(work: "StudyWork", tally: "Tally", json: bool) -> None:
    for path, sentence in tally.skipped[:SHOWN_SKIPPED]:
        say(f"{sentence} It was set aside as {path.stem}.set-aside.")
    if len(tally.skipped) > SHOWN_SKIPPED:
        say(f"{len(tally.skipped) - SHOWN_SKIPPED} more such files.")
    folder, count = work.store.path, sum(tally.statuses.values())

    def text() -> Iterator[Block]:
        from rps_exudyn.pages.report.study_rows import range_rows
        from rps_exudyn.study.table import CaseTable

        outcomes = ", ".join(f"{number} {status}" for status, number in sorted(tally.statuses.items()))
        loop = f", {tally.in_loop} computed together" if tally.in_loop else ""
        how = f" ({tally.through_batch} in groups{loop})" if tally.through_batch else ""
        done = f"{count} cases in {folder} ({outcomes}), {tally.done_now} of them done now{how}"
        yield Text(f"{work.study.title}: {done}")
        if tally.single_run_reason and tally.through_batch:
            yield Text(_NOT_TOGETHER.format(tally.single_run_reason))
        rows = list(range_rows(CaseTable.of(work.store)))[:SHOWN_RANGES]
        width = max((len(row.value) for row in rows), default=0)
        yield from (Line(f"  {row.value:{width}}  {row.words}", indent=width + 4) for row in rows)
        yield from group_lines(tally.causes)
        yield Text(f"one page of it: rps-exudyn report {folder}")

    def data() -> dict[str, Any]:
        said = [
            {"status": group.status.value, "cases": len(group.cases), "message": group.example}
            for group in tally.causes
        ]
        return {
            "folder": str(folder),
            "cases": count,
            "statuses": {status.value: number for status, number in tally.statuses.items()},
            "said": said,
            "done_now": tally.done_now,
            "in_groups": tally.through_batch,
            "in_loop": tally.in_loop,
            "not_in_loop": tally.single_run_reason,
        }

    present(Sheet(text=text(), data=data), json=json)


def group_lines(said: "Sequence[Group]") -> Iterator[Block]:
    """Causes of failure, then remarks, with the numbers of their cases; the commonest of each."""
    for failed in (True, False):
        lines = [f"  {group.line()}" for group in said if (group.status is not Status.OK) is failed]
        yield from map(Text, lines[:SHOWN_GROUPS])
        if (more := len(lines) - SHOWN_GROUPS) > 0:
            yield Text(f"  {more} more {'causes' if failed else 'kinds of remarks'}, see the report")
