"""Progress of a running study: a bar with rate and time left, one line per case in a log."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from time import monotonic

from rps_exudyn.base.files import append
from rps_exudyn.base.progress import duration
from rps_exudyn.base.screen import open_screen
from rps_exudyn.results.outcome import Status
from rps_exudyn.study.description import Case, Description
from rps_exudyn.study.store import CaseRow
from rps_exudyn.study.table import show_value


def log_lines(path: Path, texts: Sequence[str]) -> None:
    """Append lines to a study's log, with the time before each."""
    now = datetime.now().astimezone().isoformat(timespec="seconds")
    append(path, "".join(f"{now} {text}\n" for text in texts))


def case_line(description: Description, case: Case, row: CaseRow) -> str:
    """The line of the log about a finished case of a study."""
    axes = ", ".join(f"{axis.name}={show_value(axis, case.values[axis.name])}" for axis in description.axes)
    return " ".join(filter(None, (case.hash, row.status, f"{row.wall_s:.3f} s", axes, row.message)))


@contextmanager
def bar(total: int) -> Iterator[Callable[[Sequence[Status]], None]]:
    """Show a bar over `total` cases; yields a function that counts some."""
    row = _Cases(total)
    with open_screen() as screen, screen.row(row):
        yield row.count


class _Cases:
    """Cases done and failed, cases per second or seconds per case, and the time left."""

    def __init__(self, total: int) -> None:
        self._total, self._done, self._failed = total, 0, 0
        self._first = self._counted_first = 0.0
        self._latest = 0.0

    def count(self, statuses: Sequence[Status]) -> None:
        """Count cases that have ended."""
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
