"""What a command shows on standard error while it works: rows with bars in a terminal, lines elsewhere.

    with open_screen() as screen, screen.row(TextRow("case 3 of 20", 0.15)):
        ...

A screen that is not asked for shows nothing outside a terminal but that machine code is made: what goes to a
file stays short, and nobody waits in silence.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from threading import Event, Thread
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol

from rps_exudyn.base.progress import Making, duration, following, listening
from rps_exudyn.base.progress import Progress as RunProgress

if TYPE_CHECKING:
    from rich.progress import Progress

EVERY = 2.0  # [s] between lines where they stay
PER_SECOND = 4  # pictures of a terminal
WIDTH = 30  # of a bar


class ScreenRow(Protocol):
    """Something that goes on; it is read now and then, by another thread."""

    @property
    def text(self) -> str:
        """What goes on, and how far it is."""

    @property
    def fraction(self) -> float | None:
        """How much of it is done, 0 to 1; None where that is not known."""


@dataclass(eq=False)
class TextRow:
    """A row that is written from outside."""

    text: str = ""
    fraction: float | None = None


class Screen:
    """Rows that are shown while a block runs."""

    def __init__(self, asked: bool = False) -> None:
        """`asked`: lines are wanted outside a terminal, too."""
        self._silent = bool(_silences)
        self._terminal = sys.stderr.isatty() and os.environ.get("TERM") != "dumb" and not self._silent
        self._shows = (asked or self._terminal) and not self._silent
        self._rows: list[ScreenRow] = []
        self._live: Progress | None = None
        self._tasks: dict[int, Any] = {}  # of rich, by the row's id
        self._ended = Event()
        self._lines: Thread | None = None

    @contextmanager
    def row(self, row: ScreenRow) -> Iterator[None]:
        """Show a row during a block."""
        self.add(row)
        try:
            yield
        finally:
            self.remove(row)

    def add(self, row: ScreenRow) -> None:
        """Show a row from now on, and as the one that is written where lines stay."""
        self._rows = [*(each for each in self._rows if each is not row), row]
        self._show()

    def remove(self, row: ScreenRow) -> None:
        """Show a row no longer."""
        self._rows = [each for each in self._rows if each is not row]
        if self._live and (task := self._tasks.pop(id(row), None)) is not None:
            self._live.remove_task(task)

    def say(self, sentence: str) -> None:
        """Write a line that stays."""
        if not self._silent:
            print(f"rps-exudyn: {sentence}", file=sys.stderr, flush=True)

    def close(self) -> None:
        """Show nothing any more."""
        self._ended.set()
        if self._live:
            self._live.stop()
        if self._lines:
            self._lines.join()

    def _show(self) -> None:
        if not (self._shows and self._rows):
            return
        if not self._terminal:
            if self._lines is None:
                self._lines = Thread(target=self._write_lines, daemon=True)
                self._lines.start()
            return
        if self._live is None:
            self._live = _live()
            self._live.start()
        for row in self._rows:
            if id(row) not in self._tasks:
                self._tasks[id(row)] = self._live.add_task("", total=None, row=row)

    def _write_lines(self) -> None:
        """Write the row added last where it has changed, in a thread of its own."""
        written = ""
        while True:
            rows = self._rows
            text = rows[-1].text if rows else "computing"
            if text != written:
                with suppress(OSError, ValueError):  # whoever reads the lines has ended
                    self.say(text)
            written = text
            if self._ended.wait(EVERY):
                return


def _live() -> "Progress":
    """Rows with bars that rich draws, again and again, at the same place."""
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn, Task
    from rich.progress_bar import ProgressBar
    from rich.text import Text

    class Bar(ProgressColumn):
        def render(self, task: Task) -> ProgressBar:
            done: float | None = task.fields["row"].fraction
            return ProgressBar(1.0, done or 0.0, WIDTH, pulse=done is None, animation_time=task.elapsed)

    class Words(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(task.fields["row"].text)

    return Progress(
        Bar(),
        Words(),
        console=Console(stderr=True),
        refresh_per_second=PER_SECOND,
        transient=True,
        redirect_stdout=False,  # standard output is for results
    )


_open: list[Screen] = []
_silences: list[bool] = []


@contextmanager
def silent() -> Iterator[None]:
    """Show nothing on the screens that are opened in a block."""
    _silences.append(True)
    try:
        yield
    finally:
        _silences.pop()


@contextmanager
def open_screen(asked: bool = False) -> Iterator[Screen]:
    """Return the screen of a block: the one that is open, or a new one."""
    if _open:
        yield _open[-1]
        return
    _open.append(Screen(asked))
    try:
        yield _open[-1]
    finally:
        _open.pop().close()


# --- progress of a command ----------------------------------------------------------------------

Show = Callable[[str, float | None], None]
"""Called with what is done now and how much of it, None where that is not known."""


@contextmanager
def shown_progress(asked: bool = False) -> Iterator[Show]:
    """Show how far a block is, in a terminal or where `asked` for, and everywhere what code it makes."""
    with open_screen(asked) as screen:
        doing, run = TextRow(), TextRow()

        began = monotonic()

        def show(text: str, fraction: float | None) -> None:
            doing.text, doing.fraction = with_time_left(text, fraction, monotonic() - began), fraction
            screen.remove(run)
            screen.add(doing)

        def show_run(progress: RunProgress) -> None:
            run.text, run.fraction = progress.sentence, progress.fraction
            if progress.fraction >= 1:
                screen.remove(run)
            elif not doing.text:  # a command of several runs shows more than how far each of them is
                screen.add(run)

        said = {""}

        def say_once(step: Making) -> None:
            if step.sentence not in said:
                said.add(step.sentence)
                screen.say(f"{step.sentence}.")

        with following(show_run), listening(say_once):
            try:
                yield show
            finally:
                screen.remove(doing)
                screen.remove(run)


def with_time_left(text: str, fraction: float | None, elapsed: float) -> str:
    """The text with the time left [s] where that follows from what is done."""
    if not fraction or fraction >= 1:
        return text
    return f"{text}, {duration(elapsed * (1 / fraction - 1))} left"
