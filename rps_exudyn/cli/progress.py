"""What a command shows while it works: kernels that are compiled, and how far its run is."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rps_exudyn.base.compiling import Step, listening
from rps_exudyn.base.progress import Progress, following
from rps_exudyn.base.screen import Screen, TextRow, open_screen

Show = Callable[[str, float | None], None]
"""Called with what is done now and how much of it, None where that is not known."""


@contextmanager
def shown_progress(asked: bool = False) -> Iterator[Show]:
    """Show how far a block is, in a terminal or where asked for, and everywhere what it compiles.

    Args:
        asked: lines are wanted outside a terminal.
    """
    with open_screen(asked) as screen:
        doing, run = TextRow(), TextRow()

        def show(text: str, fraction: float | None) -> None:
            doing.text, doing.fraction = text, fraction
            screen.remove(run)
            screen.add(doing)

        def show_run(progress: Progress) -> None:
            run.text, run.fraction = progress.sentence, progress.fraction
            if progress.fraction >= 1:
                screen.remove(run)
            elif not doing.text:  # a command of several runs says more than how far each of them is
                screen.add(run)

        compiling = _Compiling(screen)
        with following(show_run), listening(compiling.take):
            try:
                yield show
            finally:
                screen.remove(doing)
                screen.remove(run)
                compiling.end()


class _Compiling:
    """The row about kernels."""

    def __init__(self, screen: Screen) -> None:
        from rps_exudyn.base.compiling import CompilingProgress

        self._screen, self._row, self._shown = screen, CompilingProgress(), False

    def take(self, step: Step) -> None:
        """Count a step; show the row where it takes long."""
        self._row.take(step)
        if self._row.is_done:
            self._screen.remove(self._row)
            return
        self._screen.add(self._row)
        if not self._shown:
            self._shown = True
            self._screen.speak()

    def end(self) -> None:
        """Say what was compiled, and where it is kept."""
        self._screen.remove(self._row)
        if self._shown:
            from rps_exudyn.base.kernel_cache import cache_folders

            step = self._row.step
            sentence = f"{step.done} force laws compiled in {step.seconds:.0f} s, once; later runs load them"
            folders = cache_folders()
            place = f" from {os.path.commonpath(folders)}" if folders else ""
            self._screen.say(f"{sentence}{place}.")
