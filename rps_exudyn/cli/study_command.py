"""The command `study`: what was asked, judged before anything runs; what came out, told."""

import json as json_text
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rps_exudyn.base import units
from rps_exudyn.base.errors import InputError
from rps_exudyn.parameters.declaration import Declared
from rps_exudyn.parameters.setup import Setup
from rps_exudyn.results.outcome import Status
from rps_exudyn.study.cases import count_of
from rps_exudyn.study.description import Axis, Case, Value
from rps_exudyn.study.estimate import estimate
from rps_exudyn.study.progress import duration
from rps_exudyn.study.runner import Plan, Tally, run_study
from rps_exudyn.study.study_file import read_study

MANY_CASES = 5000
"""More need `--yes`."""

SHOWN_SKIPPED = 5


@dataclass(frozen=True)
class Request:
    """The command's options."""

    file: Path
    out: Path
    jobs: int | None
    cluster: str | None
    toy: bool
    yes: bool

    @property
    def processes(self) -> int:
        """Raises InputError for a number that cannot be."""
        available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
        jobs = available if self.jobs is None else self.jobs
        if not 1 <= jobs <= 1024:
            raise InputError(f"--jobs is {jobs}; it must be a whole number from 1 to 1024.")
        return jobs

    def plan(self) -> Plan:
        """Raises InputError for all that is wrong."""
        study = read_study(self.file)
        if self.toy:
            study = study.toy()
        count = count_of(study)
        if count > MANY_CASES and not self.yes:
            raise InputError(
                f"{self.file} has {count} cases; more than {MANY_CASES} are run with --yes only "
                "(--dry-run --yes tells how long they take)."
            )
        return Plan.of(study, self.out)


def do_study(request: Request, json: bool) -> int:
    """Do what is missing and print how it went; 0, or 1 if cases failed."""
    jobs, plan = request.processes, request.plan()
    if request.cluster:
        from rps_exudyn.study.cluster import cluster

        def run_all() -> Tally:
            with cluster(request.cluster or "", plan.study.time_limit) as run:
                return run_study(plan, run, workers_write=False)
    else:
        from rps_exudyn.simulate.processes import Processes

        def run_all() -> Tally:
            with Processes(jobs, plan.study.time_limit, request.out / "messages.log") as processes:
                return run_study(plan, processes.run, workers_write=True)

    try:
        tally = run_all()
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished cases are kept in {request.out}, and the same command does the others."
        ) from None
    _tell(plan, tally, json)
    return 0 if set(tally.statuses) <= {Status.OK} else 1


def list_cases(request: Request, json: bool) -> int:
    """Print the cases, what is missing, and how long that will take."""
    plan = request.plan()
    jobs = request.processes
    time = estimate(plan, jobs)
    missing = {case.hash for case in plan.missing}
    cases = plan.description.cases
    if json:
        told = [{"hash": case.hash, "values": case.values, "missing": case.hash in missing} for case in cases]
        content = {"cases": told, "missing": len(missing), "jobs": jobs, "seconds": time.seconds}
        print(json_text.dumps(content, indent=2))
        return 0
    shown = {axis.name: _Shown.of(axis) for axis in plan.study.axes}
    for case in cases:
        state = "to do" if case.hash in missing else "done "
        print(f"{case.hash}  {state}  {_values(case, shown)}")
    print(
        f"{len(cases)} cases, {len(missing)} of them to be done: about {duration(time.seconds)} "
        f"with {jobs} {'process' if jobs == 1 else 'processes'} ({time.source})"
    )
    return 0


def _tell(plan: Plan, tally: Tally, json: bool) -> None:
    for path, sentence in tally.skipped[:SHOWN_SKIPPED]:
        print(f"rps-exudyn: {sentence} It was set aside as {path.stem}.set-aside.", file=sys.stderr)
    if len(tally.skipped) > SHOWN_SKIPPED:
        print(f"rps-exudyn: {len(tally.skipped) - SHOWN_SKIPPED} more files like these.", file=sys.stderr)
    folder, count = plan.store.path, sum(tally.statuses.values())
    if json:
        statuses = {status.value: number for status, number in tally.statuses.items()}
        content: dict[str, Any] = {"folder": str(folder), "cases": count, "statuses": statuses}
        print(json_text.dumps(content | {"done_now": tally.done_now}, indent=2))
        return
    statuses_told = ", ".join(f"{number} {status}" for status, number in sorted(tally.statuses.items()))
    print(
        f"{plan.study.title}: {count} cases in {folder} ({statuses_told}), {tally.done_now} of them done now"
    )


@dataclass(frozen=True)
class _Shown:
    """Values of an axis for a reader."""

    declared: Declared
    unit: str

    @classmethod
    def of(cls, axis: Axis) -> "_Shown":
        (declared,) = Setup.declared_at(axis.paths[0])
        return cls(declared, axis.unit)

    def text(self, value: Value) -> str:
        if isinstance(value, str | int) or not self.declared.unit:
            return str(value)
        return units.show(value, self.declared.unit.si, self.unit)


def _values(case: Case, shown: dict[str, _Shown]) -> str:
    return ", ".join(f"{name} = {shown[name].text(value)}" for name, value in case.values.items())
