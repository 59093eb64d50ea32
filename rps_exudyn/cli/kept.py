"""The files that a run leaves, kept whatever the disk and the terminal do; and sentences for the user."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rps_exudyn.base.errors import InputError
from rps_exudyn.base.interrupts import unwrapped_interrupts

if TYPE_CHECKING:
    from rps_exudyn.results.result import Result


def say(sentence: str) -> None:
    """Tell the user something that is no result, on standard error."""
    print(f"rps-exudyn: {sentence}", file=sys.stderr)


def keep(result: "Result", out: Path, plot: Path) -> tuple[list[Path], bool]:
    """Write both files; return the paths of those written, and whether there were problems.

    A failed run is written beside existing files as NAME.failed, any other one keeps them as NAME.1, NAME.2,
    ... A result that cannot be written there goes to the folder of temporary files.

    Raises:
        KeyboardInterrupt: while the picture is drawn; it names the file that is written.
    """
    from rps_exudyn.base.files import number_existing
    from rps_exudyn.results.outcome import Status

    try:
        if result.status is not Status.OK and (out.exists() or plot.exists()):
            out, plot = (path.with_suffix(f".failed{path.suffix}") for path in (out, plot))
        elif older := [str(kept) for path in (out, plot) if (kept := number_existing(path))]:
            say(f"older files are kept: {', '.join(older)}.")
        result.save(out)
    except (InputError, OSError) as error:
        return _kept_elsewhere(result, out, str(error))
    if not result.signals:
        return [out], False
    try:
        with named_if_interrupted([out]):
            _draw(result, plot)
    except (OSError, ValueError) as error:  # also what matplotlib makes of a strange environment
        say(f"the picture is missing: {error}")
        return [out], True
    return [out, plot], False


def _draw(result: "Result", plot: Path) -> None:
    """Draw the picture; the result is safe by then."""
    from rps_exudyn.charts.scene import draw

    draw(result, plot)


def _kept_elsewhere(result: "Result", out: Path, problem: str) -> tuple[list[Path], bool]:
    """Write a result whose own place cannot be written, and say where; never fails."""
    from tempfile import mkdtemp

    folder = None
    try:
        folder = Path(mkdtemp(prefix="rps-exudyn-"))
        result.save(other := folder / out.name)
    except (InputError, OSError) as error:
        if folder:
            with suppress(OSError):
                folder.rmdir()
        say(f"{problem} Nor could the result be kept elsewhere: {error}")
        return [], True
    say(f"{problem} The result is kept in {other} instead.")
    return [other], True


@contextmanager
def named_if_interrupted(files: Sequence[Path]) -> Iterator[None]:
    """Name the files that are written by then where the block is interrupted; it may add to them.

    Raises:
        KeyboardInterrupt: it is.
    """
    try:
        with unwrapped_interrupts():
            yield
    except KeyboardInterrupt as interrupt:
        if str(interrupt) or not files:
            raise
        verb = "is" if len(files) == 1 else "are"
        names = ", ".join(map(str, files))
        raise KeyboardInterrupt(f"interrupted; {names} {verb} written, the rest is not.") from None


@contextmanager
def naming(files: Sequence[Path]) -> Iterator[None]:
    """Name the files of a result where its printing fails: it is not lost with what was printed of it.

    Raises:
        InputError: the output cannot be written.
        KeyboardInterrupt: the printing is interrupted.
    """
    try:
        with named_if_interrupted(files):
            yield
            sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        where = f" The result is kept in {files[0]}." if files else ""
        raise InputError(f"the output cannot be written: {error.strerror}.{where}") from None
