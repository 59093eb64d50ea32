"""What commands print, and the exit statuses: sheets, sentences, tables, JSON, names of files.

In a terminal text and tables are in bold or dim, and broken between words. The library that prints the help
does this too, but takes longer for the list of all parameters than Python takes to begin.
"""

import json
import os
import shlex
import sys
import textwrap
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rps_exudyn.base.errors import InputError, unwrapped_interrupts
from rps_exudyn.base.files import number_existing, strict
from rps_exudyn.base.screen import silent
from rps_exudyn.results.outcome import Status
from rps_exudyn.results.sheet import INDENT, Block, Grid, Line, Sheet, Text

if TYPE_CHECKING:
    from rps_exudyn.results.result import Result

DONE, FAILED, WRONG_INPUT = 0, 1, 2
"""Exit statuses, beside that of Ctrl-C."""

UNBROKEN = ("quantity", "parameter", "value")
"""Columns that stay on one line, by their heads."""

GAP = 2  # blanks between columns
NARROWEST = 8  # letters in a line of a column that is broken
IN_FILES = 200  # letters in a line of a table that goes to a file or a pipe

_CODES = {"bold": "1", "dim": "2"}


def say(sentence: str) -> None:
    """Print a sentence that is no result on standard error."""
    print(f"rps-exudyn: {sentence}", file=sys.stderr)


def note(sentence: str) -> None:
    """Print on standard error what is no error, unless only errors are wanted."""
    if not _quiet:
        say(sentence)


def command_line() -> str:
    """The command that this process does, as it can be typed again."""
    return shlex.join(["rps-exudyn", *sys.argv[1:]])


@contextmanager
def printing(quiet: bool) -> Iterator[None]:
    """Print nothing but errors in a block, if so wanted."""
    if not quiet:
        yield
        return
    _quiet.append(True)
    try:
        with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere), silent():
            yield
    finally:
        _quiet.pop()


_quiet: list[bool] = []


def print_line(text: str = "", style: str = "", indent: int = 0) -> None:
    """Print a line, "bold" or "dim" in a terminal and broken there between words; what follows a break is
    indented by so many letters."""
    if sys.stdout.isatty():
        indent = indent if indent < _width() // 2 else 0
        lines = textwrap.wrap(
            text, _width(), subsequent_indent=" " * indent, break_long_words=False, break_on_hyphens=False
        ) or [""]
        text = "\n".join(_styled(line, style) for line in lines)
    print(text)


def print_table(heads: Sequence[str], rows: Iterable[Sequence[str]], dim: Collection[int] = ()) -> None:
    """Print rows of cells below their heads, without lines between them; long cells are broken. A terminal
    greys the rows at the places `dim`."""
    rows = list(rows)
    widths = column_widths(heads, rows, _width() if sys.stdout.isatty() else IN_FILES)
    style = "dim" if sys.stdout.isatty() else ""
    print("\n".join(_styled(line, style) for line in _row_lines(heads, widths)))
    for k, row in enumerate(rows):
        lines = _row_lines(row, widths)
        print("\n".join(_styled(line, style if k in dim else "") for line in lines))


def column_widths(heads: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> list[int]:
    """Return how many letters each column has, so that a line has at most `width` of them if that can be:
    the widest of the columns that may be broken become narrower first."""
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    breakable = [i for i, head in enumerate(heads) if head not in UNBROKEN]
    surplus = sum(widths) + GAP * (len(widths) - 1) - width
    while surplus > 0 and breakable:
        widest = max(widths[i] for i in breakable)
        if widest <= NARROWEST:
            break
        first = [i for i in breakable if widths[i] == widest]
        next_widest = max((widths[i] for i in breakable if widths[i] < widest), default=NARROWEST)
        less = min(widest - max(next_widest, NARROWEST), -(-surplus // len(first)))
        for i in first:
            widths[i] -= less
        surplus -= less * len(first)
    return widths


def _row_lines(cells: Sequence[str], widths: Sequence[int]) -> Iterator[str]:
    broken = [
        [cell] if len(cell) <= width else textwrap.wrap(cell, width, break_on_hyphens=False) or [""]
        for cell, width in zip(cells, widths, strict=True)
    ]
    for k in range(max(map(len, broken))):
        parts = [lines[k] if k < len(lines) else "" for lines in broken]
        yield (" " * GAP).join(f"{part:{width}}" for part, width in zip(parts, widths, strict=True)).rstrip()


def _styled(line: str, style: str) -> str:
    plain = not style or os.environ.get("TERM") == "dumb"
    return line if plain else f"\x1b[{_CODES[style]}m{line}\x1b[0m"


def _width() -> int:
    import shutil  # for terminals alone

    return shutil.get_terminal_size().columns


def print_json(content: Mapping[str, Any]) -> None:
    """Print strict JSON on standard output; numbers that are not finite become null."""
    print(json.dumps(strict(content), indent=2, default=str))


def present(
    sheet: Sheet,
    files: list[Path] | None = None,
    *,
    every: bool = True,
    json: bool = False,
    finish: Callable[[], None] = lambda: None,
) -> None:
    """Print a sheet: its data as JSON, every block of its text, or its head.

    Args:
        sheet: what was found.
        files: paths of the files that were written; a list even where none was.
        every, json: whether its text or its data are printed, not its head.
        finish: called once the sheet is printed, or cannot be, before the names of the files, to which it
            may add.

    Raises:
        InputError: the output cannot be written; it names a file.
    """
    names = [] if files is None else files
    with naming(names):
        try:
            if every and not json:
                _print_text(sheet.text)
            elif not json:
                title, *lines = sheet.lines()
                print_line(title, "bold", indent=INDENT)
                for line, row in zip(lines, sheet.rows, strict=True):
                    print_line(line, "dim" if row.is_vague else "", indent=INDENT + sheet.width + GAP)
            sys.stdout.flush()
        finally:
            finish()
        if json:
            kept = {} if files is None else {"files": [str(file) for file in files]}
            print_json({**sheet.data(), **kept})
        elif every:
            for file in names:
                print_line(f"written: {file}")
        else:
            written = ", ".join(map(str, names))
            print_line(f"{f'written: {written}' if names else 'nothing written'}  (--all: {sheet.more})")


def _print_text(blocks: Iterable[Block]) -> None:
    for block in blocks:
        if isinstance(block, Grid):
            if block.caption:
                print_line(block.caption)
            print_table(block.columns, [[str(cell) for cell in row] for row in block.rows], block.vague)
        elif isinstance(block, Line):
            print_line(block.text, "bold" if block.is_bold else "", block.indent)
        elif isinstance(block, Text):
            print_line(block.text)


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


def verdict(result: "Result") -> int:
    """Return the exit status of a simulation; of a failed one, print on standard error what to do."""
    if result.status is Status.OK:
        return DONE
    say(f"the simulation failed ({result.status}): {result.message.rstrip('.')}. {result.status.remedy}")
    return FAILED


# --- The files of a simulation, kept whatever the disk does


@dataclass(frozen=True)
class Files:
    """Where a result and its picture go."""

    out: Path
    plot: Path | None  # None: no picture
    overwrite: bool  # or existing files are renamed to NAME.1, NAME.2, ...

    def make_room(self, *others: Path) -> None:
        """Rename existing files of these names, with a note, unless they are to be replaced."""
        if not self.overwrite:
            paths = (path for path in (self.out, self.plot, *others) if path is not None)
            if older := [str(kept) for path in paths if (kept := number_existing(path))]:
                note(f"previous files renamed to {', '.join(older)}.")

    @property
    def of_failed(self) -> "Files":
        """The same as NAME.failed, where one of them exists."""
        if not any(path is not None and path.exists() for path in (self.out, self.plot)):
            return self
        out, plot = (path and path.with_suffix(f".failed{path.suffix}") for path in (self.out, self.plot))
        return Files(out or self.out, plot, overwrite=True)


def keep(result: "Result", files: Files, written: list[Path]) -> bool:
    """Write the result and its pictures, add the paths of those written to a list, and return whether all
    went well.

    A gear with surfaces has a picture of where they touch besides.

    A failed run is written beside existing files as NAME.failed. A result that cannot be written there goes
    to the folder of temporary files.

    Raises:
        KeyboardInterrupt: while the picture is drawn; it names the file that is written.
    """
    from rps_exudyn.parameters.gear import surfaces_of

    if result.status is not Status.OK:
        files = files.of_failed
    touching = files.plot and files.plot.with_name(f"{files.plot.stem}.surfaces{files.plot.suffix}")
    if not surfaces_of(result.gear) or result.status is not Status.OK:
        touching = None
    try:
        files.make_room(*([] if touching is None else [touching]))
        result.save(files.out)
    except (InputError, OSError) as error:
        written += _kept_elsewhere(result, files.out, str(error))
        return False
    written.append(files.out)
    if not result.signals or files.plot is None:
        return True
    try:
        with named_if_interrupted([files.out]):
            from rps_exudyn.pages.charts.scene_figures import draw

            draw(result, files.plot)
            written.append(files.plot)
            if touching is not None:
                from rps_exudyn.pages.animation.surfaces_figure import draw_surfaces

                draw_surfaces(result, touching)
                written.append(touching)
    except (OSError, ValueError) as error:  # also what matplotlib makes of a strange environment
        say(f"the picture is missing: {error}")
        return False
    return True


def _kept_elsewhere(result: "Result", out: Path, problem: str) -> list[Path]:
    """Write a result whose own place cannot be written, and print where; never fails."""
    from tempfile import mkdtemp

    folder = None
    try:
        folder = Path(mkdtemp(prefix="rps-exudyn-"))
        result.save(other := folder / out.name)
    except (InputError, OSError) as error:
        if folder:
            with suppress(OSError):
                folder.rmdir()
        say(f"{problem} The result could not be stored elsewhere either: {error}")
        return []
    say(f"{problem} The result is kept in {other} instead.")
    return [other]
