"""Progress of a study: estimated duration, a bar and a log while it runs, messages of its cases in groups."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from time import monotonic

import numpy as np

from rps_exudyn.base.progress import duration
from rps_exudyn.results.block import CaseRow
from rps_exudyn.results.outcome import Status, alike
from rps_exudyn.study.cases import setup_of
from rps_exudyn.study.definition import Case, Description, Study
from rps_exudyn.study.table import show_value


def log_lines(path: Path, texts: Sequence[str]) -> None:
    """Append lines with the time to a study's log, in one write: those of several writers do not mix."""
    now = datetime.now().astimezone().isoformat(timespec="seconds")
    with path.open("ab", buffering=0) as file:
        file.write("".join(f"{now} {text}\n" for text in texts).encode())


def case_line(description: Description, case: Case, row: CaseRow) -> str:
    """The line of the log about a finished case of a study."""
    axes = ", ".join(f"{axis.name}={show_value(axis, case.values[axis.name])}" for axis in description.axes)
    return " ".join(filter(None, (case.hash, row.status, f"{row.wall_s:.3f} s", axes, row.message)))


class CasesRow:
    """A row of a screen: cases done and failed, cases per second or seconds per case, and the time left."""

    def __init__(self, total: int) -> None:
        self._total, self._done, self._failed = total, 0, 0
        self._first = self._counted_first = 0.0
        self._latest = 0.0

    def count(self, statuses: Sequence[Status]) -> None:
        self._latest = monotonic()
        if not self._done:
            self._first, self._counted_first = self._latest, len(statuses)
        self._done += len(statuses)
        self._failed += sum(status is not Status.OK for status in statuses)

    @property
    def fraction(self) -> float:
        return self._done / max(self._total, 1)

    @property
    def text(self) -> str:
        """For instance "cases: 3 of 20, 0 failed, 1.2 cases/s, 14 s left"."""
        text = f"cases: {self._done} of {self._total}, {self._failed} failed"
        if (since := self._done - self._counted_first) and self._latest > self._first:
            speed = since / (self._latest - self._first)
            text += f", {speed:.3g} cases/s" if speed >= 1 else f", {1 / speed:.3g} s/case"
            text += f", {duration((self._total - self._done) / speed)} left"
        return text


# --- Estimated duration: from the times of the finished cases, else from measured costs

# Elapsed seconds of a case on one core of a small cloud machine: fixed, and per step of the solver
COSTS = {
    ("closed-form", "flank"): (0.010, 0.0),
    ("equilibrium", "flank"): (0.013, 1e-5),
    ("reduced", "flank"): (1.5, 2e-4),
    ("equilibrium", "general-contact"): (1.0, 2e-3),
    ("equilibrium", "triangles"): (0.1, 3e-4),
    ("generalized-alpha", "flank"): (0.14, 2.2e-4),
    ("generalized-alpha", "general-contact"): (2.0, 0.03),
    ("generalized-alpha", "triangles"): (0.3, 5e-4),
}
DEARER_CHAIN = 3.0  # times, of a bush in segments with flank contact
STORING = 0.002  # [s] per case: file, index, log
STARTING = 4.0  # [s] of the processes, kernels compiled


def estimate(
    study: Study, missing: Sequence[Case], measured: Sequence[float], jobs: int
) -> tuple[float, str]:
    """Return the elapsed time of the missing cases with `jobs` processes [s], and what it is based on, in
    words; `measured` lists the times that finished cases took [s]."""
    if not missing:
        return 0.0, "nothing is missing"
    if measured:
        each = float(np.mean(measured))
        source = f"from the {len(measured)} finished cases, {each:.3g} s each"
    else:
        each = float(np.mean([_cost(study, case) for case in missing[:: max(1, len(missing) // 100)]]))
        source = f"from costs measured on one small machine, {each:.3g} s each; rough"
    return STARTING + len(missing) * (each + STORING) / min(jobs, len(missing)), source


def _cost(study: Study, case: Case) -> float:
    setup = setup_of(study, case)
    model = setup.fidelity
    fixed, per_step = COSTS[model.solver, model.mesh]
    if (model.solver, model.mesh, model.bush) == ("generalized-alpha", "flank", "chain"):
        per_step *= DEARER_CHAIN
    return float(fixed + per_step * (2 * np.pi * setup.test.turns / model.step_angle))


# --- Messages of the cases in groups: causes of failure, and remarks on cases that ended ok. Messages of the
# same codes are one group; without codes, those that differ only in their numbers.

SILENT = "no message"


@dataclass(frozen=True)
class Group:
    """Cases that ended alike, with the same message."""

    status: Status
    example: str  # the message of the first case
    cases: Sequence[Case]

    def line(self) -> str:
        """One line: how many, how they ended, and the first message."""
        count, ended = len(self.cases), "" if self.status is Status.OK else f" {self.status}"
        first = "" if count == 1 else "; for instance"
        return f"{count} case{'' if count == 1 else 's'}{ended}{first}: {self.example}"


def groups(ended: Iterable[tuple[Case, CaseRow]]) -> list[Group]:
    """The groups of cases with a message, or failed; the largest first."""
    found: dict[tuple[str, ...], list[tuple[Case, str]]] = {}
    for case, row in ended:
        if row.message or row.status is not Status.OK:
            key = alike(row.status, row.codes, row.message)
            found.setdefault(key, []).append((case, row.message or SILENT))
    made = [Group(Status(key[0]), pairs[0][1], [case for case, _ in pairs]) for key, pairs in found.items()]
    return sorted(made, key=lambda group: -len(group.cases))
