"""Progress of a running study: a bar with rate and time left in a terminal, one line per case in a log."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from rps_exudyn.base.atomic import append
from rps_exudyn.base.progress import duration
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
    """Show a bar over `total` cases if standard error is a terminal; yields a function that counts some."""
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
        task = progress.add_task("cases", total=total, failed=0)

        def count(statuses: Sequence[Status]) -> None:
            failed = sum(status is not Status.OK for status in statuses)
            failed += progress.tasks[0].fields["failed"]
            progress.update(task, advance=len(statuses), failed=failed)

        yield count


class _Rate(ProgressColumn):
    """Cases per second, or seconds per case, and the time left."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        if not speed:
            return Text("")
        rate = f"{speed:.3g} cases/s" if speed >= 1 else f"{1 / speed:.3g} s/case"
        left = "" if task.finished else f", {duration((task.remaining or 0) / speed)} left"
        return Text(rate + left)
