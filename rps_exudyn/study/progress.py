"""Progress of a running study: a bar with rate and time left in a terminal, one line per case in a log."""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from rps_exudyn.base.atomic import append
from rps_exudyn.results.outcome import Status
from rps_exudyn.study.description import Case
from rps_exudyn.study.store import CaseRow


class Log:
    """The file study.log; each line is written in one piece."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def case(self, case: Case, row: CaseRow) -> None:
        """Write the line of a finished case."""
        values = " ".join(f"{name}={value:.6g}" if isinstance(value, float) else f"{name}={value}"
                          for name, value in case.values.items())  # fmt: skip
        self.line(" ".join(filter(None, (case.hash, row.status, f"{row.wall_s:.3f} s", values, row.message))))

    def line(self, text: str) -> None:
        """Write a line with the time before it."""
        append(self._path, f"{datetime.now().astimezone().isoformat(timespec='seconds')} {text}\n")


class Bar:
    """Counts finished and failed cases in a bar."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress = progress
        self._task = progress.add_task("cases", total=total, failed=0)
        self._failed = 0

    def count(self, status: Status) -> None:
        """Count one more case by its outcome."""
        self._failed += status is not Status.OK
        self._progress.update(self._task, advance=1, failed=self._failed)


@contextmanager
def bar(total: int) -> Iterator[Bar]:
    """A bar over `total` cases, shown on standard error if that is a terminal."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[failed]} failed"),
        _Rate(),
    )
    with Progress(
        *columns, console=console, disable=not console.is_terminal, refresh_per_second=4
    ) as progress:
        yield Bar(progress, total)


class _Rate(ProgressColumn):
    """Cases per second, or seconds per case, and the time left."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        if not speed:
            return Text("")
        rate = f"{speed:.3g} cases/s" if speed >= 1 else f"{1 / speed:.3g} s/case"
        left = "" if task.finished else f", {duration((task.remaining or 0) / speed)} left"
        return Text(rate + left)


def duration(seconds: float) -> str:
    """A duration as text: "45 s", "12 min", "3.5 h"."""
    if seconds < 90:
        return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
